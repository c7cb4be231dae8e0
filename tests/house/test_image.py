"""The image and the compose file, held as far as they can be without a daemon: linted, parsed, their steps run as processes."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import compose_spec
import pytest
import yaml

from service.cli.arguments import parser
from service.http.connections import Connections
from service.http.traffic import Traffic
from service.observability.metrics import Metrics
from service.operations import OPERATIONS
from service.server import ENDING_SECONDS
from service.settings import MIB, Settings, variable
from tests.families import CATALOGUE
from tests.service.live import ROOT, serving

DOCKER = ROOT / "docker"
PLACE = "/opt/mat"
COMPOSE_TEXT = (ROOT / "compose.yaml").read_text(encoding="utf-8")


NEAREST = {"points": [[0.0, 0.0], [0.1, 0.3]]}
BOW = [{"degree": 1, "control_points": p} for p in ([[0, 0], [1, 1]], [[1, 1], [1, 0]], [[1, 0], [0, 1]], [[0, 1], [0, 0]])]


# The Dockerfile ------------------------------------------------------------------------------------------------------
def stages() -> list[list[tuple[str, str]]]:
    """The instructions of each stage of the Dockerfile."""
    text = re.sub(r"\\\n\s*", "", re.sub(r"^#.*\n", "", (ROOT / "Dockerfile").read_text(), flags=re.MULTILINE))
    found: list[list[tuple[str, str]]] = []
    for line in filter(None, text.splitlines()):
        instruction, _, rest = line.partition(" ")
        if instruction == "FROM":
            found.append([])
        found[-1].append((instruction, rest))
    return found


def environment(stage: list[tuple[str, str]], place: Path) -> dict[str, str]:
    """What a stage sets, with another folder in the place of its own, and this interpreter."""
    pairs = (entry.split("=", 1) for instruction, rest in stage if instruction == "ENV" for entry in shlex.split(rest))
    given = {name: value.replace(PLACE, str(place)) for name, value in pairs}
    return {**os.environ, **given, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}


def test_the_dockerfile_has_nothing_that_a_linter_minds() -> None:
    lint = shutil.which("hadolint", path=str(Path(sys.executable).parent))
    assert lint, "hadolint comes with the development requirements"
    ended = subprocess.run([lint, "Dockerfile"], cwd=ROOT, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (0, "")


def test_the_image_is_built_in_two_stages_and_runs_unprivileged() -> None:
    build, final = stages()
    assert any("mat_core.warm" in rest for instruction, rest in build if instruction == "RUN")
    assert not any("pip install" in rest for _, rest in final)
    last = dict(final)
    assert last["USER"] == "10001"
    assert f"--uid {last['USER']}" in last["RUN"]
    assert "/readyz" in last["HEALTHCHECK"]
    assert "ENTRYPOINT" not in last


def test_the_command_of_the_image_is_one_that_the_command_line_knows() -> None:
    command = json.loads(dict(stages()[1])["CMD"])
    assert command[:3] == ["python", "-m", "service.cli"]
    asked = parser().parse_args(command[3:])
    assert (asked.command, asked.host) == ("serve", "0.0.0.0")
    assert str(asked.port) == dict(stages()[1])["EXPOSE"]
    assert f":{asked.port}/readyz" in dict(stages()[1])["HEALTHCHECK"]


def test_what_the_image_copies_exists_and_is_let_through() -> None:
    ignore = (ROOT / ".dockerignore").read_text().split()
    kept = [line[1:] for line in ignore if line.startswith("!")]
    copied = set()
    for stage in stages():
        for instruction, rest in stage:
            if instruction == "COPY" and not rest.startswith("--from"):
                source = rest.split()[0].strip("/")
                assert (ROOT / source).exists(), source
                assert any(fnmatch(source.split("/")[0], name) for name in kept), source
                copied.add(source)
    assert set(kept) == copied


COUNT = """
import json, pkgutil, sys
from importlib import import_module
import mat_core
from service.operations import OPERATIONS
from service.workers.solve import handle
codes = {}
for work in json.load(sys.stdin):
    header, body = work["header"], json.dumps(work["body"]).encode()
    code = handle(header, body)[0].get("error", {}).get("code", "ok")
    codes[code] = codes.get(code, 0) + 1
kernels = {
    (thing.py_func.__module__, name): thing.stats
    for info in pkgutil.walk_packages(mat_core.__path__, "mat_core.")
    for name, thing in vars(import_module(info.name)).items() if hasattr(thing, "py_func")
}
missed = [".".join(name) for name, stats in kernels.items() if sum(stats.cache_misses.values())]
print(json.dumps([sum(sum(stats.cache_hits.values()) for stats in kernels.values()), missed, codes]))
"""


def work() -> str:
    """Every operation in every format on the examples, and the tests' whole catalogue of shapes, by both methods."""
    asked = []
    for path in sorted((ROOT / "openapi" / "examples").glob("*.json")):
        for operation in OPERATIONS.values():
            arguments = {"arguments": operation.arguments} if operation.arguments else {}
            asked += [(operation.name, form, json.loads(path.read_text()) | arguments) for form in operation.formats]
    for build in CATALOGUE.values():
        shape = build()
        loops = {name: shape[name] for name in ("outer", "holes") if name in shape}
        asked += [("mat", "json", loops | {"options": {"samples": True}}), ("nearest", "json", loops | {"arguments": NEAREST})]
    plate = json.loads((ROOT / "openapi" / "examples" / "rectangle.json").read_text())
    asked.append(("mat", "json", plate | {"options": {"method": "march"}}))
    headers = ({"operation": name, "format": form, "keep": None, "precision": None} for name, form, _ in asked)
    return json.dumps([{"header": header, "body": body} for header, (_, _, body) in zip(headers, asked, strict=True)])


def counted(folder: Path, place: dict[str, str], asked: str) -> tuple[int, list[str], dict[str, int]]:
    """Kernels found in the cache, the names of those that were not, and how the requests ended."""
    command = [sys.executable, "-c", COUNT]
    ended = subprocess.run(command, cwd=folder, env=place, input=asked, capture_output=True, text=True, check=True)
    hits, missed, codes = json.loads(ended.stdout)
    return hits, missed, codes


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the image, made by the build's own steps in one place and copied to another, as its last stage does."""
    build, _ = stages()
    place = tmp_path_factory.mktemp("build") / "mat"
    place.mkdir()
    for instruction, rest in build:
        if instruction == "COPY" and rest.split()[0].endswith("/"):
            source = rest.split()[0].strip("/")
            shutil.copytree(ROOT / source, place / source, ignore=shutil.ignore_patterns("__pycache__", "*.kernel"))
        elif instruction == "RUN" and "mat_core.warm" in rest:
            subprocess.run(rest, shell=True, cwd=place, env=environment(build, place), check=True, stdout=subprocess.DEVNULL)
    final = tmp_path_factory.mktemp("final") / "mat"
    shutil.copytree(place, final)
    shutil.rmtree(place)
    for path in (final, *final.rglob("*")):
        path.chmod(path.stat().st_mode & ~0o222)
    return final


def files(folder: Path) -> set[Path]:
    return {path.relative_to(folder) for path in folder.rglob("*") if path.is_file()}


def test_no_kernel_is_compiled_in_the_image(image: Path) -> None:
    """Whatever is asked, all kernels are found: no miss in the cache, and nothing written."""
    before = files(image)
    hits, missed, codes = counted(image, environment(stages()[1], image), work())
    assert missed == []
    assert hits > 20
    assert set(codes) == {"ok"}
    assert files(image) == before
    assert any(path.suffix == ".kernel" for path in before)


def test_a_kernel_for_another_processor_is_a_miss(image: Path, tmp_path: Path) -> None:
    """What the count would say if the image were built for one processor and run on another."""
    elsewhere = environment(stages()[1], image) | {"NUMBA_CPU_FEATURES": "+sse4.2"}
    invalid = [{"header": {"operation": "mat", "format": "json", "keep": None}, "body": {"outer": BOW}}]
    copy = tmp_path / "mat"
    shutil.copytree(image, copy)
    hits, missed, codes = counted(copy, elsewhere, json.dumps(invalid))
    assert hits == 0
    assert missed
    assert codes == {"invalid-domain": 1}


def test_the_command_of_the_image_serves(image: Path, tmp_path: Path) -> None:
    before = files(image)
    command = json.loads(dict(stages()[1])["CMD"])
    for option in ("--host", "--port"):
        at = command.index(option)
        del command[at : at + 2]
    final = environment(stages()[1], image) | {"MAT_DATA_DIR": str(tmp_path), "PYTHONPATH": str(image)}
    with serving((sys.executable, *command[1:]), final) as client:
        example = (ROOT / "openapi" / "examples" / "plate.json").read_bytes()
        answer = client.post("/v1/mat", content=example, headers={"Content-Type": "application/json"})
        assert answer.status_code == 200
    assert files(image) == before


# The compose file ----------------------------------------------------------------------------------------------------
def interpolated(text: str, given: dict[str, str] | None = None) -> str:
    """The compose file as it is with these variables; every other takes its default, and has one."""
    given = given or {}
    filled = re.sub(r"\$\{(\w+):-([^}]*)\}", lambda match: given.get(match[1]) or match[2], text)
    assert "${" not in filled
    return filled


COMPOSE: dict[str, Any] = yaml.safe_load(interpolated(COMPOSE_TEXT))
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("mat", "api", "worker")


def test_the_compose_file_is_one_by_its_specification() -> None:
    options = compose_spec.PyOptions()
    options.apply_merge = True
    assert set(options.from_yaml(interpolated(COMPOSE_TEXT)).services) == set(SERVICES)
    with pytest.raises(ValueError, match="readonly"):
        options.from_yaml(interpolated(COMPOSE_TEXT).replace("read_only:", "readonly:"))


def test_without_a_profile_there_is_one_service_and_a_volume() -> None:
    assert [name for name, service in SERVICES.items() if "profiles" not in service] == ["mat"]
    assert SERVICES["mat"]["volumes"] == ["data:/var/lib/mat"]
    profiles: dict[str, set[str]] = {}
    for name, service in SERVICES.items():
        for profile in service.get("profiles", ()):
            profiles.setdefault(profile, set()).add(name)
    assert profiles == {"scale": {"api", "worker", "postgres"}, "observability": {"prometheus", "grafana"}}
    for name, service in SERVICES.items():
        for needed in service.get("depends_on", ()):
            assert SERVICES[needed]["profiles"] == service["profiles"], name


@pytest.mark.parametrize("name", SERVICES)
def test_every_service_is_confined(name: str) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    limits = service["deploy"]["resources"]["limits"]
    assert set(limits) == {"cpus", "memory", "pids"}
    assert float(limits["cpus"]) <= 1.0, "a machine of one processor would not start it"
    assert all(port.startswith("127.0.0.1:") for port in service.get("ports", ()))
    assert "build" in service or re.search(r":v?\d", service["image"])
    for volume in service.get("volumes", ()):
        source = volume.split(":")[0]
        assert (ROOT / source).is_file() if source.startswith(".") else source in COMPOSE["volumes"]


@pytest.mark.parametrize("name", OURS)
def test_our_services_fit_the_image_and_the_settings(name: str) -> None:
    service = SERVICES[name]
    final = stages()[1]
    assert service["build"] == "."
    assert service["init"] is True
    data = environment(final, Path(PLACE))["MAT_DATA_DIR"]
    assert f"data:{data}" in service["volumes"]
    assert dict(final)["VOLUME"] == data
    assert service["env_file"] == [{"path": "mat.env", "required": False}]
    known = {variable(name) for name in Settings.__dataclass_fields__} | {"OTEL_EXPORTER_OTLP_ENDPOINT"}
    given = {key: str(value) for key, value in service["environment"].items()}
    assert set(given) <= known
    settings = Settings.from_environment(given)
    assert settings.role == {"mat": "all"}.get(name, name)
    assert bool(settings.database_url) == (name != "mat")
    defaults = Settings()
    for name_ in ("workers", "deadline_seconds", "log_level", "shutdown_drain_seconds"):
        assert getattr(settings, name_) == getattr(defaults, name_), name_


def test_the_limits_leave_room_for_the_workers_and_the_end_for_the_draining() -> None:
    settings = Settings()
    service = SERVICES["mat"]
    limits = service["deploy"]["resources"]["limits"]
    each = settings.worker_memory_bytes + 256 * MIB
    assert int(limits["memory"].removesuffix("m")) * MIB >= settings.workers * each + 1024 * MIB
    longest = settings.shutdown_notice_seconds + settings.shutdown_drain_seconds
    assert float(service["stop_grace_period"].removesuffix("s")) >= longest + 15 > longest + ENDING_SECONDS


def test_variables_reach_the_services() -> None:
    given = {"MAT_WORKERS": "7", "PORT": "9000", "POSTGRES_PASSWORD": "secret", "MAT_MEMORY": "9g"}
    services = yaml.safe_load(interpolated(COMPOSE_TEXT, given))["services"]
    assert services["mat"]["environment"]["MAT_WORKERS"] == 7
    assert services["mat"]["ports"] == services["api"]["ports"] == ["127.0.0.1:9000:8000"]
    assert services["worker"]["deploy"]["resources"]["limits"]["memory"] == "9g"
    assert services["postgres"]["environment"]["POSTGRES_PASSWORD"] == "secret"
    assert services["worker"]["environment"]["MAT_DATABASE_URL"] == "postgresql://mat:secret@postgres/mat"


# What is observed ----------------------------------------------------------------------------------------------------
SUFFIXES = ("_total", "_bucket", "_count", "_sum", "_created")


@dataclass(frozen=True)
class NoPool:
    """As much of a pool as has figures before it runs; its own figures, too."""

    ready: bool = False
    about: dict[str, str] = field(default_factory=dict)
    busy: int = 0
    idle: int = 0
    running: dict[str, int] = field(default_factory=lambda: {"small": 0})
    waiting: dict[str, int] = field(default_factory=lambda: {"small": 0})
    kills: dict[str, int] = field(default_factory=lambda: {"crash": 0})

    def stats(self) -> NoPool:
        return self


def families() -> set[str]:
    """The names of all metrics, without the suffixes of their samples."""
    return {metric.name for metric in Metrics(NoPool(), Connections(Settings()), Traffic(0)).registry.collect()}


def named(text: str) -> set[str]:
    """The metrics that expressions name."""
    return {re.sub(f"({'|'.join(SUFFIXES)})$", "", name) for name in re.findall(r"\bmat_[a-z_]+", text)}


def test_alerts_and_dashboard_name_metrics_that_there_are() -> None:
    rules = [rule for group in yaml.safe_load((DOCKER / "alerts.yaml").read_text())["groups"] for rule in group["rules"]]
    assert all(rule["annotations"]["summary"] for rule in rules)
    panels = json.loads((DOCKER / "grafana" / "dashboard.json").read_text())["panels"]
    shown = named(" ".join(target["expr"] for panel in panels for target in panel["targets"]))
    alerted = named(" ".join(rule["expr"] for rule in rules))
    there = families()
    assert shown <= there
    assert alerted <= there
    assert len({panel["id"] for panel in panels}) == len(panels)
    ours = {name for name in there if name.startswith("mat_")}
    assert ours - shown - alerted == set()


def test_prometheus_asks_the_services_and_reads_the_alerts() -> None:
    config = yaml.safe_load((DOCKER / "prometheus.yaml").read_text())
    (scrape,) = config["scrape_configs"]
    (found,) = scrape["dns_sd_configs"]
    assert tuple(found["names"]) == OURS
    assert str(found["port"]) == dict(stages()[1])["EXPOSE"]
    targets = {volume.split(":")[0]: volume.split(":")[1] for volume in SERVICES["prometheus"]["volumes"]}
    folder = targets["./docker/prometheus.yaml"].rsplit("/", 1)[0]
    assert [f"{folder}/{name}" for name in config["rule_files"]] == [targets["./docker/alerts.yaml"]]


def test_grafana_finds_prometheus_and_the_dashboard() -> None:
    (source,) = yaml.safe_load((DOCKER / "grafana" / "datasources.yaml").read_text())["datasources"]
    assert source["url"] == "http://prometheus:9090"
    panels = json.loads((DOCKER / "grafana" / "dashboard.json").read_text())["panels"]
    assert {panel["datasource"]["uid"] for panel in panels} == {source["uid"]}
    (provider,) = yaml.safe_load((DOCKER / "grafana" / "dashboards.yaml").read_text())["providers"]
    assert any(f":{provider['options']['path']}/" in volume for volume in SERVICES["grafana"]["volumes"])


@pytest.mark.skipif(shutil.which("promtool") is None, reason="promtool comes with Prometheus, which is not here")
@pytest.mark.parametrize("command", [["check", "rules", "alerts.yaml"], ["check", "config", "prometheus.yaml"]])
def test_prometheus_itself_reads_its_files(command: list[str]) -> None:
    subprocess.run(["promtool", *command], cwd=DOCKER, check=True, capture_output=True)
