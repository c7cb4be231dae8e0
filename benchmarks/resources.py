"""Memory of large domains, and the first use with and without compiled kernels: each in a process of its own."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from benchmarks.shapes import LARGE

ROOT = Path(__file__).parents[1]
RUNS = 9
EDGES = 100_000
BASE = 100.0  # megabytes of a process, whatever it solves, that are not counted
FAMILIES = ("comb", "coastline")

WATCHED = """
import gc, json, re, sys
from mat_core import Domain, medial_axis
from mat_core.warm import example

def megabytes(what):
    with open("/proc/self/status") as status:
        return int(re.search(what + r":\\s+(\\d+) kB", status.read())[1]) / 1024

medial_axis(Domain.from_dict(example()))
before = megabytes("VmRSS")
with open(sys.argv[1]) as text:
    domain = Domain.from_dict(json.load(text))
gc.collect()
read = megabytes("VmRSS")
axis = medial_axis(domain, threads=1)
print(json.dumps({"edges": len(domain.arrays.degree), "before": before, "read": read, "peak": megabytes("VmHWM")}))
"""

FIRST = """
import time
from mat_core import Domain, medial_axis
from mat_core.warm import example
medial_axis(Domain.from_dict(example()))
print(time.process_time())
"""


class Memory(NamedTuple):
    """Resident megabytes of a process: after a small solution, with a large domain read, at most until it is solved."""

    name: str
    edges: int
    before: float
    read: float
    peak: float

    @property
    def solving(self) -> float:
        """Kilobytes an edge, on top of a process that has read the domain."""
        return (self.peak - self.read) * 1024 / self.edges

    @property
    def whole(self) -> float:
        """Kilobytes an edge beyond BASE: what the libraries take above that and what reading JSON leaves are in it, too."""
        return (self.peak - BASE) * 1024 / self.edges


class FirstUse(NamedTuple):
    """Seconds: CPU time of Python, import and first solution with compiled kernels; all and CPU time of compiling them."""

    cached: float
    cold: float
    cold_cpu: float


def memory(name: str) -> Memory:
    """Of a process that reads a domain of EDGES edges from a file and solves it on one thread."""
    shaped = LARGE[name](EDGES)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "domain.json"
        file.write_text(json.dumps({"outer": shaped["outer"], "holes": shaped["holes"]}), encoding="utf-8")
        return Memory(name, **json.loads(_python("-c", WATCHED, str(file))))


def first_use() -> FirstUse:
    """Compiled into an empty folder by the command for images, then used from there RUNS times: the median of these."""
    with tempfile.TemporaryDirectory() as folder:
        place = {"NUMBA_CACHE_DIR": folder, "PYTHONPYCACHEPREFIX": folder, "PYTHONDONTWRITEBYTECODE": ""}
        begun, spent = time.monotonic(), os.times()
        _python("-W", "ignore", "-m", "mat_core.warm", **place)
        wall, after = time.monotonic() - begun, os.times()
        cpu = after.children_user + after.children_system - spent.children_user - spent.children_system
        _python("-c", FIRST, **place)
        return FirstUse(statistics.median(float(_python("-c", FIRST, **place)) for _ in range(RUNS)), wall, cpu)


def _python(*arguments: str, **variables: str) -> str:
    """What Python prints with these arguments, in an environment with these variables."""
    settings = {**os.environ, "PYTHONPATH": str(ROOT), **variables}
    return subprocess.run([sys.executable, *arguments], cwd=ROOT, env=settings, capture_output=True, text=True, check=True).stdout


def tables(memories: list[Memory], first: FirstUse) -> list[str]:
    beyond = f"beyond {BASE:.0f} MB, KB an edge"
    lines = [f"| domain | edges | before, MB | domain read, MB | largest, MB | solving, KB an edge | {beyond} |"]
    lines.append("|---|" + "---:|" * 6)
    for m in memories:
        megabytes = f"{m.before:.0f} | {m.read:.0f} | {m.peak:.0f}"
        lines.append(f"| {m.name} | {m.edges:,} | {megabytes} | {m.solving:.2f} | {m.whole:.2f} |")
    lines += [
        "",
        f"With compiled kernels Python, the import and the first solution take {first.cached:.2f} s of CPU time together.",
    ]
    lines.append(f"`python -m mat_core.warm` compiles all of them in {first.cold:.0f} s ({first.cold_cpu:.0f} s of CPU time).")
    return lines
