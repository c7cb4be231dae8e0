"""The lock files, the first commands and the version."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import tomllib
import urllib.request
from pathlib import Path

import pytest

import mat_core
import service
from tests.service.live import free_port
from tests.service.processes import alive, descendants, eventually

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LOCKS = ["requirements.lock", "requirements-dev.lock"]


def pins(name: str) -> dict[str, set[str]]:
    """Package to the versions that a lock file pins (more than one where they differ by Python version)."""
    found: dict[str, set[str]] = {}
    for line in (ROOT / name).read_text().splitlines():
        if match := re.match(r"([a-z0-9-]+)==([^ ;\\]+)", line):
            found.setdefault(match[1], set()).add(match[2])
    return found


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_has_only_pins_and_hashes_and_no_address(name: str) -> None:
    lines = (ROOT / name).read_text().splitlines()
    pin = re.compile(r"[a-z0-9-]+==[^ ;]+( ; [a-z_]+ .*)? \\|    --hash=sha256:[0-9a-f]{64}( \\)?")
    assert all(pin.fullmatch(line) for line in lines)
    assert not any(
        lines[i].startswith(" ") is False and not lines[i + 1].startswith(" ") for i in range(len(lines) - 1)
    )


def test_the_locks_cover_the_project_and_agree() -> None:
    run, develop = (pins(name) for name in LOCKS)
    optional = [line for extra in ("service", "telemetry") for line in PROJECT["project"]["optional-dependencies"][extra]]
    runtime = {re.split("[>=]", line)[0] for line in PROJECT["project"]["dependencies"] + optional}
    assert runtime <= set(run)
    assert {re.split("[>=]", line)[0] for line in PROJECT["dependency-groups"]["dev"]} <= set(develop)
    assert {name: develop.get(name) for name in run} == run


def test_the_service_is_not_locked_to_what_only_tests_need() -> None:
    assert not {"pytest", "hypothesis", "mypy", "ruff", "httpx2"} & set(pins("requirements.lock"))


def test_an_old_interpreter_is_refused_with_a_clear_line(tmp_path: Path) -> None:
    old = "import sys; sys.version_info = (3, 10, 0); sys.argv[1:] = ['requirements.lock']\n"
    program = old + (ROOT / "tools" / "environment.py").read_text().replace(
        "__file__", repr(str(tmp_path / "t" / "e.py"))
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert ended.returncode == 1
    assert ended.stderr.startswith("Python 3.11 or later is needed, this is 3.10 (")
    assert not list(tmp_path.iterdir())


def test_a_taken_port_gets_a_clear_line_before_anything_slow_happens() -> None:
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = str(holder.getsockname()[1])
        environment = {**os.environ, "PORT": port}
        command = [sys.executable, "tools/run.py"]
        ended = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=10)
    assert ended.returncode == 2
    assert f"Port {port} of 127.0.0.1 cannot be used" in ended.stdout


def test_make_run_shows_an_answer_serves_and_ends_cleanly() -> None:
    port = free_port()
    environment = {**os.environ, "PORT": str(port)}
    command = [sys.executable, "-u", "tools/run.py"]
    picture = ROOT / "out" / "example.svg"
    picture.unlink(missing_ok=True)
    with subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as driver:
        try:
            assert driver.stdout is not None
            lines = []
            for line in driver.stdout:
                lines.append(line.strip())
                if "the shapes to begin with" in line:
                    break
            assert urllib.request.urlopen(f"http://127.0.0.1:{port}/docs", timeout=10).status == 200
            served = descendants(driver.pid)
            assert len(served) >= 3
        finally:
            driver.send_signal(signal.SIGINT)
        assert driver.wait(20) == 0
    told = dict(
        line.split(maxsplit=1) for line in lines if re.match(r"(nodes|segments|cycles|certificate|time) ", line)
    )
    assert int(told["nodes"]) > 0
    assert int(told["segments"]) > 0
    assert (told["cycles"], told["certificate"]) == ("1", "passed")
    assert re.fullmatch(r"[0-9.]+ ms, .*", told["time"])
    assert picture.read_text().startswith("<svg")
    eventually(lambda: not any(alive(pid) for pid in served))


def test_the_version_stands_in_one_file_and_heads_the_changelog() -> None:
    version = (ROOT / "mat_core" / "VERSION").read_text().strip()
    assert re.fullmatch(r"\d+\.\d+\.\d+", version)
    assert PROJECT["tool"]["hatch"]["version"]["path"] == "mat_core/VERSION"
    assert (mat_core.__version__, service.__version__) == (version, version)
    headings = re.findall(r"^## (\S+?),? ", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert headings[0] == version
    for package in ("mat_core", "service", "tools"):
        for path in (ROOT / package).rglob("*.py"):
            assert version not in path.read_text(encoding="utf-8"), path
