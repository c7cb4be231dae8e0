"""The hunt: jobs to workers, outcomes to the journal, failures to the reducer, the smallest of each to a file."""

from __future__ import annotations

import json
import re
import time
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.hunt.journal import Journal
from tests.hunt.judge import Outcome
from tests.hunt.reduce import Steps, steps
from tests.hunt.report import Progress, family
from tests.hunt.team import Job, Team
from tests.transforms import scaled, shifted

Json = dict[str, Any]
Named = tuple[str, Json]


@dataclass
class Reduction:
    """A failing domain on its way to a smaller one.

    Parameters
    ----------
    name, domain
        Where it began.
    outcome : Outcome
        How it failed.
    passes : generator
        Of `reduce.steps`.
    until : float
        When to be content with what there is, on the monotonic clock.
    candidate : dict, optional
        What is to be tried next.
    best, text
        The smallest domain that failed, and how it did.
    """

    name: str
    domain: Json
    outcome: Outcome
    passes: Steps
    until: float
    candidate: Json | None = None
    best: Json | None = None
    text: str = ""
    in_flight: bool = False

    def advance(self, outcome: Outcome | None) -> None:
        """Take what came of the candidate (None: nothing was tried yet) and have the next one ready."""
        failing = outcome is not None and outcome.same(self.outcome)
        if failing and outcome is not None:
            self.best, self.text = self.candidate, outcome.text
        try:
            self.candidate = next(self.passes) if outcome is None else self.passes.send(failing)
        except StopIteration:
            self.candidate = None


class Hunt:
    """One run over domains.

    Parameters
    ----------
    team : Team
    journal : Journal
    folder : Path
        Where failures are written, one file each.
    oracle : float
        Share of the domains that are compared with the oracle; the name decides.
    reductions : int
        How many failures of one family and kind are reduced; the others are written as they are.
    seconds : float
        Longest time for one reduction.
    """

    def __init__(
        self, team: Team, journal: Journal, folder: Path, oracle: float = 0.1, reductions: int = 3, seconds: float = 60.0
    ) -> None:
        self.team, self.journal, self.folder = team, journal, folder
        self.oracle, self.reductions, self.seconds = oracle, reductions, seconds
        self.active: list[Reduction] = []
        self.reduced: Counter[tuple[str, str]] = Counter()

    def run(self, domains: Iterable[Named], progress: Progress) -> None:
        """Solve them all; ends when the last reduction has."""
        waiting = (item for item in domains if item[0] not in self.journal)
        try:
            while True:
                self._feed(waiting)
                if not self.team.busy():
                    break
                for job, outcome in self.team.finished(0.5):
                    if isinstance(job.purpose, Reduction):
                        self._tried(job.purpose, outcome)
                    else:
                        self._judged(job, outcome)
                progress.show(self.journal.outcomes, len(self.active))
        finally:
            for reduction in self.active:
                self._write(reduction)
            progress.end()

    def _feed(self, waiting: Iterator[Named]) -> None:
        """Give every idle worker something: a candidate of a reduction before a new domain."""
        while (worker := self.team.idle()) is not None:
            reduction = next((r for r in self.active if not r.in_flight), None)
            if reduction is not None and reduction.candidate is not None:
                reduction.in_flight = True
                self.team.give(worker, Job(reduction.name, reduction.candidate, reduction.outcome.oracle, reduction))
                continue
            item = next(waiting, None)
            if item is None:
                return
            share = zlib.crc32(item[0].encode()) / 2**32
            self.team.give(worker, Job(*item, oracle=share < self.oracle))

    def _judged(self, job: Job, outcome: Outcome) -> None:
        """A domain was solved, or was not."""
        self.journal.add(job.name, outcome)
        if not outcome.bad:
            return
        cause = (family(job.name), outcome.kind)
        self.reduced[cause] += 1
        domain = {k: job.domain[k] for k in ("outer", "holes", "note") if k in job.domain}
        begun = Reduction(job.name, domain, outcome, steps(domain), time.monotonic() + self.seconds, text=outcome.text)
        self._write(begun)
        if self.reduced[cause] <= self.reductions:
            begun.advance(None)
            if begun.candidate is not None:
                self.active.append(begun)

    def _tried(self, reduction: Reduction, outcome: Outcome) -> None:
        """A candidate was solved, or was not."""
        reduction.in_flight = False
        reduction.advance(outcome)
        if reduction.candidate is None or time.monotonic() > reduction.until:
            self.active.remove(reduction)
            self._write(reduction)

    def _write(self, reduction: Reduction) -> None:
        """A line as the corpus of regressions has them."""
        self.folder.mkdir(parents=True, exist_ok=True)
        note = f"{reduction.outcome.category}: {reduction.text}".replace("\n", "; ")
        origin = f"reduced from {reduction.name}" if reduction.best else f"{reduction.name} as it was drawn"
        more = reduction.domain.get("note")
        name = reduction.name.replace("/", "-")
        found = reduction.best or reduction.domain
        entry = {"name": name, "note": f"{note} ({origin}{', ' + more if more else ''})"}
        entry |= {"outer": found["outer"], "holes": found.get("holes", [])}
        file = self.folder / (re.sub(r"[^\w.+#-]", "_", name) + ".jsonl")
        file.write_text(json.dumps(entry) + "\n", encoding="utf-8")


def placed(domains: Iterable[Named], scale: float, shift: tuple[float, float]) -> Iterator[Named]:
    """The same domains in another unit and then moved; their names say so."""
    suffix = (f"*{scale:g}" if scale != 1 else "") + (f"@{shift[0]:g},{shift[1]:g}" if any(shift) else "")
    for name, domain in domains:
        if suffix:
            moved = shifted(scaled({k: v for k, v in domain.items() if k != "truth"}, scale), *shift)
            yield name + suffix, {**moved, "name": name + suffix}
        else:
            yield name, domain
