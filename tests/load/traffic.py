"""What is sent: small domains of three kinds and what the library answers to them, huge ones, and such as cannot be solved."""

from __future__ import annotations

import gzip
import json
import math
import random
from dataclasses import dataclass
from typing import Any

import numpy as np

from service.workers import solve
from tests.families import comb, gear, hole_grid, polyline
from tests.service.live import ROOT

Json = dict[str, Any]

MEMBERS = ("outer", "holes", "options")


@dataclass(frozen=True)
class Piece:
    """A request and its answer.

    Attributes
    ----------
    name : str
    kind : str
        glyph, icon or part.
    body, answer : bytes
    """

    name: str
    kind: str
    body: bytes
    answer: bytes


def small(tolerance: float | None = None) -> list[Piece]:
    """Glyphs and icons of the corpus, the examples, and parts with many holes or teeth; other bodies for each tolerance."""
    with gzip.open(ROOT / "tests" / "corpus" / "outlines.jsonl.gz") as file:
        outlines = [json.loads(line) for line in file]
    named = [("glyph" if domain["name"].startswith("a/") else "icon", domain["name"], domain) for domain in outlines]
    examples = sorted((ROOT / "openapi" / "examples").glob("*.json"))
    named += [("part", path.stem, json.loads(path.read_text())) for path in examples]
    named += [("part", shape["name"], shape) for shape in (gear(12), comb(9), hole_grid(2, 2))]
    return [_piece(kind, name, domain, tolerance) for kind, name, domain in named]


def _piece(kind: str, name: str, domain: Json, tolerance: float | None) -> Piece:
    content = {member: domain[member] for member in MEMBERS if member in domain}
    if tolerance is not None:
        content["options"] = content.get("options", {}) | {"tolerance": tolerance}
    body = json.dumps(content).encode()
    outcome, answer = solve.handle({"operation": "mat", "format": "json", "keep": None}, body)
    assert "error" not in outcome, f"{name}: {outcome}"
    return Piece(name, kind, body, answer)


def huge(edges: int) -> bytes:
    """A rough disc: a closed polygon about the origin, every corner moved by up to the length of a side."""
    rng = np.random.default_rng(edges)
    angles = np.linspace(0.0, 2.0 * math.pi, edges, endpoint=False)
    radii = 1.0 + rng.uniform(0.0, 2.0 * math.pi / edges, edges)
    points = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)]).round(9).tolist()
    return json.dumps({"outer": polyline(points)}).encode()


def endless(seed: int = 0) -> bytes:
    """A small body that takes half a minute: the march with a tiny step."""
    rng = random.Random(seed)
    corners = [(math.cos(a), math.sin(a)) for a in sorted(rng.uniform(0.0, 2.0 * math.pi) for _ in range(12))]
    return json.dumps({"outer": polyline(corners), "options": {"method": "march", "step": 2e-6, "check_step": 1}}).encode()


BROKEN = {
    "not JSON": (b'{"outer": [', 400, "not-json"),
    "an open loop": (
        json.dumps({"outer": [{"degree": 1, "control_points": [[0, 0], [1, 0]]}]}).encode(),
        422,
        "invalid-domain",
    ),
}
"""What is refused: body, status and code."""
