"""The peers' own environment under `.bench/`: a virtual environment, npm packages, a C++ program.

What cannot be installed on this machine is left out with the reason: a compiler or headers that are missing, a package index
that cannot be reached. Nothing is installed twice.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
HOME = ROOT / ".bench"
VENV = HOME / "venv"
PYTHON = VENV / "bin" / "python"
NPM = HOME / "npm"
BOOST = HOME / "boost_voronoi"
INSTALL_LIMIT = 600  # seconds for one installation

# The newest versions of two packages that flo-mat's own packages ask for are not in every registry.
PACKAGE_JSON = {
    "private": True,
    "dependencies": {"flo-mat": "3.0.3"},
    "overrides": {"big-float-ts": "4.0.1", "double-double": "3.0.2"},
}


class Peer(NamedTuple):
    """Name as documents print it, how it is started, what it reads ("chords", "curves", "cubics")."""

    name: str
    command: tuple[str, ...]
    reads: str
    version: str


class Unavailable(Exception):
    """A peer cannot be had on this machine; the text says why."""


def peers() -> tuple[list[Peer], dict[str, str]]:
    """Those that can be run, installed where they are not; and of the others the reason."""
    HOME.mkdir(exist_ok=True)
    made: list[Peer] = []
    missing: dict[str, str] = {}
    for name, build in BUILDERS.items():
        try:
            made.append(build(name))
        except (Unavailable, OSError, subprocess.TimeoutExpired) as error:
            missing[name] = " ".join(str(error).split())[:200]
    return made, missing


def run(command: Sequence[str | Path], cwd: Path = ROOT) -> str:
    """What a command prints; Unavailable with the end of its complaint where it fails."""
    ended = subprocess.run([*map(str, command)], cwd=cwd, capture_output=True, text=True, timeout=INSTALL_LIMIT)
    if ended.returncode:
        lines = [line for line in (ended.stderr or ended.stdout).strip().splitlines() if line.strip()]
        raise Unavailable(next((line for line in reversed(lines) if "rror" in line), lines[-1] if lines else "it failed"))
    return ended.stdout.strip()


# Each peer -----------------------------------------------------------------------------------------------------------
def boost(name: str) -> Peer:
    source = HERE / "boost_voronoi.cpp"
    compiler = shutil.which("g++") or shutil.which("c++")
    if compiler is None:
        raise Unavailable("no C++ compiler (Debian: g++)")
    if not BOOST.exists() or BOOST.stat().st_mtime < source.stat().st_mtime:
        try:
            run([compiler, "-O3", "-march=native", "-std=c++17", "-o", BOOST, source])
        except Unavailable as error:
            raise Unavailable(f"{error} (Debian: libboost-dev)") from None
    return Peer(name, (str(BOOST),), "chords", run([BOOST, "--version"]).replace("_", "."))


def package(module: str, project: str, reads: str) -> Callable[[str], Peer]:
    """A builder for a program of ours on a package of the Python index."""

    def build(name: str) -> Peer:
        if not PYTHON.exists():
            run([sys.executable, "-m", "venv", VENV])
        ask = f"import importlib.metadata as m; print(m.version('{project}'))"
        try:
            version = run([PYTHON, "-c", ask])
        except Unavailable:
            print(f"installing {project} into {VENV.relative_to(ROOT)}", flush=True)
            run([PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:", project])
            version = run([PYTHON, "-c", ask])
        return Peer(name, (str(PYTHON), "-m", f"benchmarks.peers.{module}"), reads, version)

    return build


def flo_mat(name: str) -> Peer:
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        raise Unavailable("no node and npm (Debian: nodejs, npm)")
    manifest = NPM / "node_modules" / "flo-mat" / "package.json"
    if not manifest.exists():
        print(f"installing flo-mat into {NPM.relative_to(ROOT)}", flush=True)
        NPM.mkdir(exist_ok=True)
        (NPM / "package.json").write_text(json.dumps(PACKAGE_JSON), encoding="utf-8")
        run([npm, "install", "--no-audit", "--no-fund", "--ignore-scripts"], cwd=NPM)
    version = json.loads(manifest.read_text(encoding="utf-8"))["version"]
    return Peer(name, (node, str(HERE / "run_flo_mat.mjs"), str(NPM / "node_modules")), "cubics", version)


BUILDERS: dict[str, Callable[[str], Peer]] = {
    "Boost.Polygon": boost,
    "pyvoronoi": package("run_pyvoronoi", "pyvoronoi", "chords"),
    "Open CASCADE": package("run_open_cascade", "cadquery-ocp-novtk", "curves"),
    "flo-mat": flo_mat,
    "scikit-image": package("run_scikit_image", "scikit-image", "chords"),
}
