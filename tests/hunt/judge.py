"""One domain solved and judged: what came of it, how long it took, how much memory, and what kind of failure it is."""

from __future__ import annotations

import re
import resource
import sys
import time
import traceback
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.transforms import knots_of

Json = dict[str, Any]
CATEGORIES = ("certified", "invalid", "failed", "wrong", "slow")
BAD = ("failed", "wrong", "slow")


@dataclass
class Outcome:
    """What came of one domain.

    Parameters
    ----------
    category : str
        One of CATEGORIES.
    kind : str
        The problem's codes, the failed check, or the exception and its place: equal for failures of one cause, mostly.
    text : str
        The whole message.
    ms : float
        Processor time to solve, reading the domain included, in milliseconds: a busy machine makes no domain slow.
    mb : float
        Largest memory of the worker during it, in megabytes.
    pieces : int
        Knot spans of the domain.
    oracle : bool
        Compared with the oracle, too.
    """

    category: str
    kind: str = ""
    text: str = ""
    ms: float = 0.0
    mb: float = 0.0
    pieces: int = 0
    oracle: bool = False

    def to_dict(self) -> Json:
        """All members, for the journal."""
        return asdict(self)

    @property
    def bad(self) -> bool:
        """True for what must not happen."""
        return self.category in BAD

    def same(self, other: Outcome) -> bool:
        """True when both failed in the same way."""
        return (self.category, self.kind) == (other.category, other.kind)


def pieces(domain: Json) -> int:
    """Number of knot spans."""
    return sum(len(np.unique(knots_of(e))) - 1 for loop in [domain["outer"], *domain.get("holes", [])] for e in loop)


def solved(domain: Json) -> tuple[Outcome, Json | None]:
    """Solve a domain; the answer document is given when it is certified."""
    from mat_core import Domain, InvalidDomain, medial_axis

    sent = {"outer": domain["outer"], "holes": domain.get("holes", [])}
    size = pieces(sent)
    _forget_peak()
    begun = time.process_time()
    answer: Json | None = None
    try:
        axis = medial_axis(Domain.from_dict(sent))
        spent = time.process_time() - begun
        answer = axis.to_dict()
        outcome = _plain_faults(answer, len(sent["holes"]))
    except InvalidDomain as error:
        spent = time.process_time() - begun
        outcome = Outcome("invalid", ",".join(sorted({p.code for p in error.problems})), str(error))
    except Exception as error:
        spent = time.process_time() - begun
        outcome = Outcome("failed", failure_kind(error), f"{type(error).__name__}: {error}")
    outcome.ms, outcome.mb, outcome.pieces = 1e3 * spent, _peak(), size
    return outcome, answer if outcome.category == "certified" else None


def _plain_faults(answer: Json, holes: int) -> Outcome:
    """What needs no oracle: certified, connected, as many cycles as holes."""
    graph = answer["graph"]
    if answer["certificate"]["passed"] is not True:
        return Outcome("wrong", "certificate", "returned without a certificate that passed")
    if graph["cycles"] != holes or graph["components"] != 1:
        return Outcome("wrong", "graph", f"{graph['cycles']} cycles and {graph['components']} components, {holes} holes")
    return Outcome("certified")


def compared(domain: Json, answer: Json, outcome: Outcome) -> Outcome:
    """The outcome after the oracle has looked at the answer, too."""
    from tests.assertions import measure, node_counts
    from tests.leaves import count_leaves, nearly_circular
    from tests.reference import Reference

    sent = {"outer": domain["outer"], "holes": domain.get("holes", [])}
    faults = list(measure(sent, answer).problems)
    reference = Reference(sent, answer["certificate"]["smooth_angle"])
    leaves, found = count_leaves(reference), node_counts(answer)[0]
    if not leaves.certain <= found <= leaves.certain + leaves.doubtful + nearly_circular(reference):
        faults.append(f"leaves: {found}, but {leaves.certain} and {leaves.doubtful} doubtful ones by the oracle")
    told: Json = {**outcome.to_dict(), "oracle": True}
    if faults:
        told.update(category="wrong", kind=_name(faults[0]), text="; ".join(faults))
    return Outcome(**told)


def failure_kind(error: Exception) -> str:
    """The check that failed, or the exception and the function it came from."""
    from mat_core import NotCertified

    if isinstance(error, NotCertified):
        return _name(error.detail)
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__} in {Path(last.filename).name} {last.name}"


def _name(text: str) -> str:
    """The beginning of a message, without figures and places."""
    return re.sub(r"[-+]?\d[\d.e+-]*", "#", text.split(":")[0].split(" at [")[0])[:60].strip()


def _forget_peak() -> None:
    """Begin the peak of the memory anew, where the system lets us."""
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError:
        return


def _peak() -> float:
    """The peak of this process's memory, in megabytes."""
    try:
        found = re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text(encoding="ascii"))
    except OSError:
        found = None
    if found:
        return int(found[1]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 1024)
