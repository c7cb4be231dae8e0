"""All figures of a run, kept in .bench/results.json so that the document can be written anew without measuring."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from benchmarks.fonts import Font
from benchmarks.growth import Family
from benchmarks.peers.environment import HOME
from benchmarks.peers.solve import Answer, Row
from benchmarks.resources import FirstUse, Memory

KEPT = HOME / "results.json"


@dataclass
class Results:
    """Rows of cases, growth of families, stages of some cases by label, fonts, memory, first use; and under which conditions."""

    rows: list[Row]
    families: list[Family]
    profiles: dict[str, dict[str, float]]
    peers: dict[str, str]  # name to version
    missing: dict[str, str]  # name to reason
    left_out: list[str]
    fonts: list[Font]
    memories: list[Memory]
    first: FirstUse
    load: float = 0.0
    processors: int = 0

    def __post_init__(self) -> None:
        self.load = self.load or os.getloadavg()[2]
        self.processors = self.processors or os.cpu_count() or 1

    def save(self, path: Path = KEPT) -> None:
        named = {name: [item._asdict() for item in getattr(self, name)] for name in ("families", "fonts", "memories")}
        kept = {**asdict(self), **named, "first": self.first._asdict()}
        path.write_text(json.dumps(kept, indent=1), encoding="utf-8")

    @classmethod
    def load_from(cls, path: Path = KEPT) -> Results:
        kept = json.loads(path.read_text(encoding="utf-8"))
        rows = [
            Row(**{**row, "ours": Answer(**row["ours"]), "peers": [Answer(**answer) for answer in row["peers"]]})
            for row in kept["rows"]
        ]
        kinds: dict[str, type[Any]] = {"families": Family, "fonts": Font, "memories": Memory}
        named = {name: [kind(**item) for item in kept[name]] for name, kind in kinds.items()}
        return cls(**{**kept, **named, "rows": rows, "first": FirstUse(**kept["first"])})
