"""docs/runbook.md is held to what it tells of: codes, metrics, alerts, variables, exit codes."""

from __future__ import annotations

import re
from typing import get_args

import yaml

from service.cli.arguments import parser
from service.cli.exits import EXITS
from service.errors import ERRORS
from service.http import connections
from service.http.connections import Connections
from service.http.traffic import Traffic
from service.jobs.leases import LEASE_SECONDS
from service.observability.metrics import Metrics
from service.server import ENDING_SECONDS
from service.settings import Settings, variable
from service.workers.crew import Reason
from tests.house.test_documents import README, ROOT, rows
from tests.house.test_image import DOCKER, SERVICES, NoPool

RUNBOOK = (ROOT / "docs" / "runbook.md").read_text(encoding="utf-8")


def names(header: str, text: str = RUNBOOK) -> list[str]:
    return [row[0].strip("`") for row in rows(text, header)]


def test_every_error_code_has_its_row() -> None:
    assert names("code") == list(ERRORS)
    for code, advice in rows(RUNBOOK, "code"):
        assert advice.startswith(("no", "yes", "if ", "when ", "only ")), code


def test_every_metric_has_its_row_with_its_labels() -> None:
    there = {}
    for family in Metrics(NoPool(), Connections(Settings()), Traffic(0)).registry.collect():
        if family.name.startswith("mat_"):
            name = family.name + ("_total" if family.type == "counter" else "")
            there[name] = family
    told = {row[0].strip("`"): row for row in rows(RUNBOOK, "metric")}
    assert set(told) == set(there)
    for name, family in there.items():
        labels = {label for sample in family.samples for label in sample.labels} - {"le"}
        if family.samples:
            assert labels == set(filter(None, re.split(r",\s*", told[name][1]))), name
    for metric, kinds in (("mat_worker_kills_total", Reason), ("mat_connections_ended_total", connections.Reason)):
        reasons = told[metric][2].split(": ")[1]
        assert set(reasons.split(", ")) == set(get_args(kinds))


def test_every_alert_has_its_row() -> None:
    groups = yaml.safe_load((DOCKER / "alerts.yaml").read_text(encoding="utf-8"))["groups"]
    assert names("alert") == [rule["alert"] for group in groups for rule in group["rules"]]


def test_every_setting_that_is_named_is_one() -> None:
    known = {variable(name) for name in Settings.__dataclass_fields__}
    limits = {"MAT_MEMORY", "MAT_CPUS"}  # of the compose file
    assert set(re.findall(r"\bMAT_[A-Z_]+\b", RUNBOOK)) <= known | limits
    assert {f"${{{name}:-" for name in limits} <= set(re.findall(r"\$\{\w+:-", (ROOT / "compose.yaml").read_text()))


def test_every_service_of_a_command_is_one() -> None:
    for command in re.findall(r"docker compose (?:--profile \w+ )?(?:up|exec|logs --no-log-prefix) ([a-z ]+)[`\n]?", RUNBOOK):
        assert command.split()[0] in SERVICES, command
    profiles = {profile for service in SERVICES.values() for profile in service.get("profiles", ())}
    assert set(re.findall(r"--profile (\w+)", RUNBOOK)) <= profiles


def test_the_bound_of_the_end_is_the_bound() -> None:
    assert f"gone {ENDING_SECONDS:g} s after the time for draining" in RUNBOOK
    assert f"lease of {LEASE_SECONDS:g} s" in RUNBOOK
    assert f"gone {ENDING_SECONDS:g} s later" in README


def test_the_table_of_exit_codes_is_the_table() -> None:
    assert {int(row[0]): row[1] for row in rows(README, "exit code")} == EXITS


def test_every_command_line_of_the_documents_is_one() -> None:
    command = re.compile(r"(?:^|`)mat ((?:solve|batch|check|serve) [^`#|>\n]+)", re.MULTILINE)
    lines = [line for text in (README, RUNBOOK) for line in command.findall(text)]
    assert len(lines) >= 6
    for line in lines:
        parser().parse_args(line.replace("'", "").split())
