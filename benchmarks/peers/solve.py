"""One case solved by ours and by each peer, in turn: times, what was kept, distances from the true axis."""

from __future__ import annotations

import json
import signal
import subprocess
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.peers import quality
from benchmarks.peers.cases import Case
from benchmarks.peers.environment import HOME, ROOT, Peer
from benchmarks.peers.exports import grid_of, write_chords, write_cubics, write_curves
from benchmarks.timing import BUDGET, MOST_RUNS, timed
from mat_core import Domain, MatError, MedialAxis, medial_axis

RIGHT = 1e-3  # of the size: an axis that strays or misses more is counted as wrong
TRUTH = 1e-10  # tolerance of the axis that others are held against
PEER_LIMIT = 30.0  # seconds for one process of a peer, start and writing included
PEER_BUDGET = 0.6  # seconds of runs
COMPILING = {"flo-mat": 1.5}  # more for an engine that compiles while it runs


@dataclass
class Answer:
    """Of ours or of one peer. `failed` is empty, or says how it ended."""

    who: str
    ms: float | None = None
    runs: int = 0
    kept: int | None = None
    given: int | None = None
    stray: float | None = None
    missed: float | None = None
    failed: str = ""

    @property
    def wrong(self) -> bool:
        """Nothing usable, or off the true axis by more than RIGHT. What was not measured is not wrong."""
        return bool(self.failed) or self.kept == 0 and self.stray is None or max(self.stray or 0.0, self.missed or 0.0) > RIGHT


@dataclass
class Row:
    """One case: ours with the ends of the whole stated apart, and the peers."""

    group: str
    name: str
    tolerance: float
    edges: int
    ours: Answer
    from_dict_ms: float | None = None
    to_dict_ms: float | None = None
    to_json_ms: float | None = None
    closed_form: float | None = None
    peers: list[Answer] = field(default_factory=list)

    def ratio(self, who: str) -> float | None:
        """How many times a peer's time is of ours."""
        ms = next((p.ms for p in self.peers if p.who == who), None)
        return ms / self.ours.ms if ms is not None and self.ours.ms else None


def solve(case: Case, peers: list[Peer]) -> Row:
    """Ours is timed before the peers and again after them, so that a slow minute of the machine favours none."""
    shaped = case.build()
    sent = {"outer": shaped["outer"], "holes": shaped["holes"]}
    edges = sum(map(len, [shaped["outer"], *shaped["holes"]]))
    row = Row(case.group, case.name, case.tolerance, edges, Answer("mat-core", given=edges))
    row.from_dict_ms, _, domain = timed(lambda: Domain.from_dict(sent), 0.5 * BUDGET)
    try:
        before = timed(lambda: medial_axis(domain, tolerance=case.tolerance))
    except MatError as error:
        row.ours.failed = str(error)
        return row
    axis = before.result
    truth = _describe(row, axis, case, shaped)
    row.peers = [_peer(peer, domain, case, truth) for peer in peers if peer.name in case.peers]
    after = timed(lambda: medial_axis(domain, tolerance=case.tolerance))
    row.ours.ms, row.ours.runs = 0.5 * (before.ms + after.ms), before.runs + after.runs
    return row


def _describe(row: Row, axis: MedialAxis, case: Case, shaped: dict[str, Any]) -> MedialAxis | None:
    """What is stated of ours beside its time; gives the true axis where distances from it are wanted."""
    row.ours.kept = len(axis.curves.degree)
    # views are made on demand and kept: each run writes an axis that was not yet looked at
    row.to_dict_ms = timed(lambda: axis.with_certificate(axis.certificate).to_dict(), 0.5 * BUDGET).ms
    row.to_json_ms = timed(lambda: axis.with_certificate(axis.certificate).to_json(), 0.5 * BUDGET).ms
    if not case.judged:
        return None
    truth = medial_axis(axis.domain, tolerance=TRUTH)
    row.ours.stray, row.ours.missed = quality.own(truth, axis)
    row.closed_form = quality.from_closed_form(truth, shaped)
    return truth


def _peer(peer: Peer, domain: Domain, case: Case, truth: MedialAxis | None) -> Answer:
    answer = Answer(peer.name)
    given, lines = HOME / "given", HOME / "lines"
    lines.unlink(missing_ok=True)
    if peer.reads == "chords":
        write_chords(given, domain, case.tolerance)
    elif peer.reads == "curves":
        write_curves(given, domain)
    else:
        write_cubics(given, domain, case.tolerance)
    command = [*peer.command, str(given), str(COMPILING.get(peer.name, PEER_BUDGET)), str(MOST_RUNS)]
    printed = _run([*command, str(lines)] if truth is not None else command, answer)
    if printed is None:
        return answer
    for name, value in json.loads(printed).items():
        setattr(answer, name, value)
    if truth is not None and lines.exists():
        found = quality.read_polylines(lines)
        if not all(np.isfinite(line).all() for line in found):
            answer.failed = "points that are not finite"
            return answer
        if peer.reads == "chords":
            found = [grid_of(domain).back(line) for line in found]
        answer.stray, answer.missed = quality.distances(truth, found)
    return answer


def _run(command: list[str], answer: Answer) -> str | None:
    """The last line that a program prints; None where it crashes, complains or takes too long, with the reason in `answer`."""
    try:
        ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=PEER_LIMIT)
    except subprocess.TimeoutExpired:
        answer.failed = f"over {PEER_LIMIT:g} s"
        return None
    if ended.returncode < 0:
        answer.failed = f"crash, {signal.Signals(-ended.returncode).name}"
    elif ended.returncode:
        lines = [line for line in ended.stderr.strip().splitlines() if line.strip()]
        answer.failed = f"error, {lines[-1].strip()[:80]}" if lines else "error"
    else:
        return ended.stdout.strip().splitlines()[-1]
    return None
