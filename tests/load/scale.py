"""How much of everything."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Scale:
    """How much is asked of the service.

    Attributes
    ----------
    folder : Path
        For the log and the data of the service.
    workers : int
    seconds : float
        Of each measurement.
    rate : float
        Small requests a second where they come at a pace.
    huge_edges : int
    events : int
        Faults: clients that leave, bodies that are cut off, and the like.
    lines : int
        Domains of a batch.
    rounds : int
        How often a share of bare processes is measured; the median counts.
    slack : float
        Factor on the promised times: a machine that runs other things is no judge of milliseconds.
    """

    folder: Path
    workers: int = 2
    seconds: float = 15.0
    rate: float = 25.0
    huge_edges: int = 40_000
    events: int = 1000
    lines: int = 20_000
    rounds: int = 3
    slack: float = 1.0


def short(folder: Path) -> Scale:
    """What the tests run."""
    return Scale(folder, seconds=2.0, rate=15.0, huge_edges=4_000, events=60, lines=300, rounds=1, slack=20.0)
