"""The commands of docs/jobs.md, run against a server of their own."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import urlsplit

import httpx2
import pytest

from service.jobs.calls import ANSWER_SECONDS, MUCH_SECONDS
from tests.service.live import ROOT

PAGE = (ROOT / "docs" / "jobs.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)


def test_the_limits_of_a_database_that_hangs_are_the_limits() -> None:
    assert f"after {ANSWER_SECONDS:g} s (a new job, {MUCH_SECONDS:g} s" in PAGE


def test_its_commands_run(live: httpx2.Client, tmp_path: Path) -> None:
    if shutil.which("curl") is None:
        pytest.skip("curl is not installed here: the commands of docs/jobs.md were not run")
    (tmp_path / "openapi").symlink_to(ROOT / "openapi")
    assert len(BLOCKS) == 3
    port = urlsplit(str(live.base_url)).port
    commands = "set -eu\n" + "\n".join(BLOCKS).replace("127.0.0.1:8000", f"127.0.0.1:{port}")
    ended = subprocess.run(["bash", "-c", commands], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert ended.returncode == 0, ended.stderr
    assert "HTTP/1.1 201 Created" in ended.stdout
    assert json.loads((tmp_path / "plate.json").read_text())["certificate"]["passed"]
    axes = (tmp_path / "axes.jsonl").read_text().splitlines()
    assert len(axes) == 3
    assert len({json.dumps(json.loads(axis)["segments"]) for axis in axes}) == 1


def test_its_figures_are_those_of_the_code() -> None:
    from service.jobs.batches import MAX_DOMAINS
    from service.jobs.executor import MAX_ATTEMPTS
    from service.jobs.leases import LEASE_SECONDS
    from service.jobs.work import CRASHES, STORING_SECONDS
    from service.routes.jobs import LONGEST_WAIT

    assert (MAX_DOMAINS, MAX_ATTEMPTS, LEASE_SECONDS, CRASHES, STORING_SECONDS, LONGEST_WAIT) == (1_000_000, 100, 15, 3, 60, 600)
    for told in ("up to a million domains", "after 100 attempts", "15 to 30 seconds later", "for a minute", "counts up to 600"):
        assert told in " ".join(PAGE.split()), told
