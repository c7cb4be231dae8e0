"""A compiled kernel is never older than anything it was made from.

A copy of the library gets two kernels of its own, one calling the other through a third file. Each step changes a source
and asks in a new process for the result and for how many kernels came from the cache.
"""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import mat_core
from mat_core.kernels.jit import sources

PACKAGE = Path(mat_core.__file__).parent

CONSTANT = "SCALE = {}\n"
CALLEE = """from mat_core.kernels.jit import jit
{}

@jit
def scaled(x):
    return SCALE * x
"""
CALLER = """from mat_core.kernels.jit import jit
{}

@jit
def solve(x):
    return {}scaled(x) + 1.0
"""
ASK = """
import json
from mat_core.topology.trial_caller import solve
value = solve(3.0)
print(json.dumps([value, sum(solve.stats.cache_hits.values())]))
"""


class Copy:
    """The library with the trial kernels, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.package = folder / "mat_core"
        shutil.copytree(PACKAGE, self.package, ignore=shutil.ignore_patterns("__pycache__"))

    def write(self, name: str, text: str) -> None:
        """Write one source file."""
        (self.package / name).write_text(text)

    def ask(self) -> tuple[float, int]:
        """Result of the calling kernel, and how many times it was loaded instead of compiled, in a new process."""
        environment = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"}
        environment["PYTHONPATH"] = str(self.folder)
        command = [sys.executable, "-c", ASK]
        ended = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, check=True)
        value, hits = json.loads(ended.stdout)
        return value, hits


@pytest.mark.parametrize(
    ("of_constant", "of_callee", "prefix"),
    [
        ("from mat_core.trial_constant import SCALE", "from mat_core.kernels.trial_callee import scaled", ""),
        ("from mat_core.trial_constant import (\n    SCALE,\n)", "from mat_core.kernels import curve, trial_callee as c", "c."),
    ],
    ids=["functions", "modules"],
)
def test_a_change_two_files_away_is_compiled_in(tmp_path: Path, of_constant: str, of_callee: str, prefix: str) -> None:
    copy = Copy(tmp_path)
    copy.write("trial_constant.py", CONSTANT.format(2.0))
    copy.write("kernels/trial_callee.py", CALLEE.format(of_constant))
    copy.write("topology/trial_caller.py", CALLER.format(of_callee, prefix))
    assert copy.ask() == (7.0, 0)
    copy.write("trial_constant.py", CONSTANT.format(5.0))
    assert copy.ask() == (16.0, 0)
    copy.write("trial_stranger.py", CONSTANT.format(9.0))
    assert copy.ask() == (16.0, 1)


def modules() -> list[ModuleType]:
    """Every module of the library."""
    found = pkgutil.walk_packages([str(PACKAGE)], "mat_core.")
    return [importlib.import_module(info.name) for info in found]


def test_a_fingerprint_covers_every_file_that_a_kernel_takes_anything_from() -> None:
    kernels = 0
    for module in modules():
        assert module.__file__
        covered = sources(Path(module.__file__))
        for thing in vars(module).values():
            function = getattr(thing, "py_func", None)
            home = getattr(function or thing, "__module__", None)
            if function is None or not str(home).startswith("mat_core."):
                continue
            kernels += 1
            assert Path(sys.modules[str(home)].__file__ or "") in covered, f"{module.__name__} uses {function.__name__}"
    assert kernels > 50


def test_only_kernels_that_python_calls_are_kept(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    copy.write("trial_constant.py", CONSTANT.format(2.0))
    callee = (
        CALLEE.format("from mat_core.trial_constant import SCALE").replace("jit", "inner").replace("kernels.inner", "kernels.jit")
    )
    copy.write("kernels/trial_callee.py", callee)
    copy.write("topology/trial_caller.py", CALLER.format("from mat_core.kernels.trial_callee import scaled", ""))
    assert copy.ask() == (7.0, 0)
    assert copy.ask() == (7.0, 1)
    (kept,) = copy.folder.rglob("*.kernel")
    assert kept.name.startswith("trial_caller.solve-")
    copy.write("kernels/trial_callee.py", callee.replace("SCALE * x", "SCALE * x * x"))
    assert copy.ask() == (19.0, 0)


def test_a_kernel_is_compiled_where_nothing_can_be_kept(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    copy.write("trial_constant.py", CONSTANT.format(2.0))
    copy.write("kernels/trial_callee.py", CALLEE.format("from mat_core.trial_constant import SCALE"))
    copy.write("topology/trial_caller.py", CALLER.format("from mat_core.kernels.trial_callee import scaled", ""))
    (copy.package / "__pycache__").mkdir()
    (copy.package / "__pycache__" / "kernels").write_text("a file where the folder would be")
    assert copy.ask() == (7.0, 0)
    assert copy.ask() == (7.0, 0)
