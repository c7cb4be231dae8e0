"""What has been tried, one JSON line each, only ever appended: a hunt that was stopped goes on where it was."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

from tests.hunt.judge import Outcome

Json = dict[str, Any]


class Journal:
    """Names and outcomes, in memory and on disk.

    Parameters
    ----------
    file : Path
        Its folder is made.
    resume : bool
        Keep what the file holds; otherwise it begins empty.
    """

    def __init__(self, file: Path, resume: bool = False) -> None:
        self.outcomes: dict[str, Outcome] = read(file) if resume and file.exists() else {}
        file.parent.mkdir(parents=True, exist_ok=True)
        self._file = file.open("a" if resume else "w", encoding="utf-8")
        if resume and file.stat().st_size and not file.read_bytes().endswith(b"\n"):
            self._file.write("\n")  # stopped in the middle of a line

    def __contains__(self, name: str) -> bool:
        return name in self.outcomes

    def add(self, name: str, outcome: Outcome) -> None:
        """Write one line, at once."""
        self.outcomes[name] = outcome
        self._file.write(json.dumps({"name": name, **outcome.to_dict()}) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Nothing more will be added."""
        self._file.close()


def read(file: Path) -> dict[str, Outcome]:
    """The outcomes in a file; lines cut short are skipped."""
    known = {f.name for f in fields(Outcome)}
    outcomes = {}
    for row in file.read_text(encoding="utf-8").splitlines():
        try:
            entry: Json = json.loads(row)
            outcomes[entry["name"]] = Outcome(**{k: v for k, v in entry.items() if k in known})
        except (ValueError, KeyError, TypeError):
            continue
    return outcomes
