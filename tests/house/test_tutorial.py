"""The pages in docs run, print what they say they print, and draw the pictures that are committed with them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely

import mat_core
from mat_core.analysis.operations import OPERATIONS as LIBRARY
from mat_core.axis import MedialAxis
from mat_core.model.curve import RationalBSpline
from service.operations import OPERATIONS
from service.workers.solve import handle
from tools.pages import BLOCK, DOCS, PICTURES, ROOT, Ran, pages, rewritten, run

PAGES = pages()
LARGEST_PICTURE = 150_000  # bytes
PIXELS = 0.05  # coordinates are written to a hundredth; another machine may round otherwise
NUMBER = re.compile(r"-?\d+\.?\d*")
COLOUR = re.compile(r"#[0-9a-f]{6}")
REQUEST = re.compile(r"```sh\ncurl -H 'Content-Type: application/json' -d '(?P<body>[^']+)' \\\n +\S+/v1/(?P<name>\S+)\n```\n")

_ran: dict[str, tuple[Ran, Path]] = {}


@pytest.fixture
def ran(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Ran, Path]:
    """A page by its name, run once for all tests of a process."""
    name: str = request.param
    if name not in _ran:
        folder = tmp_path_factory.mktemp(name)
        _ran[name] = run(DOCS / f"{name}.md", folder), folder
    return _ran[name]


each = pytest.mark.parametrize("ran", [page.stem for page in PAGES], indirect=True)


def only(name: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("ran", [name], indirect=True)


@each
def test_a_page_prints_what_it_says(ran: tuple[Ran, Path]) -> None:
    page, _ = ran
    assert page.printed == page.told


@each
def test_the_pictures_are_those_committed(ran: tuple[Ran, Path], request: pytest.FixtureRequest) -> None:
    page, folder = ran
    drawn = sorted(path.name for path in folder.glob("*.svg"))
    text = (DOCS / f"{request.node.callspec.params['ran']}.md").read_text(encoding="utf-8")
    assert drawn == sorted(re.findall(r"!\[[^\]]+\]\(pictures/([^)]+)\)", text))
    for name in drawn:
        fresh, kept = ((place / name).read_text(encoding="utf-8") for place in (folder, PICTURES))
        assert NUMBER.sub("0", fresh) == NUMBER.sub("0", kept), f"{name}: run make docs"
        numbers = [np.array(NUMBER.findall(picture), dtype=float) for picture in (fresh, kept)]
        assert np.abs(numbers[0] - numbers[1]).max() <= PIXELS, f"{name}: run make docs"


def test_no_picture_is_large_or_left_over() -> None:
    named = {name for page in PAGES for name in re.findall(r"\(pictures/([^)]+)\)", page.read_text(encoding="utf-8"))}
    assert {path.name for path in PICTURES.iterdir()} == named
    assert all(path.stat().st_size < LARGEST_PICTURE for path in PICTURES.iterdir())


def test_the_index_names_every_page() -> None:
    index = (DOCS / "README.md").read_text(encoding="utf-8")
    assert {page.stem for page in PAGES} <= set(re.findall(r"\]\(([a-z-]+)\.md\)", index))


def test_a_page_is_written_anew_as_it_is() -> None:
    page = DOCS / "walls.md"
    told = [block["told"] or "" for block in BLOCK.finditer(page.read_text(encoding="utf-8"))]
    assert rewritten(page, told) == page.read_text(encoding="utf-8")


# Every operation, over HTTP and in Python ----------------------------------------------------------------------------
@only("operations")
def test_requests_and_their_twins_in_python_give_the_same(ran: tuple[Ran, Path]) -> None:
    page, _ = ran
    text = (DOCS / "operations.md").read_text(encoding="utf-8")
    starts = [block.start() for block in BLOCK.finditer(text)]
    found = set()
    for request in REQUEST.finditer(text):
        name, body = request["name"], request["body"].encode()
        OPERATIONS[name].request.model_validate_json(body)
        meta, content = handle({"operation": name, "format": "json", "keep": None}, body)
        assert "error" not in meta, meta
        OPERATIONS[name].answer.model_validate_json(content)
        twin = page.names[next(i for i, start in enumerate(starts) if start > request.end())]["result"]
        answer = json.loads(content)
        if name == "mat":
            answer["version"].pop("service")
        assert json.loads(json.dumps(twin.to_dict())) == (answer if name == "mat" else answer["result"]), name
        found.add(name)
    assert found == set(OPERATIONS)


def test_the_tables_of_arguments_are_the_arguments() -> None:
    text = (DOCS / "operations.md").read_text(encoding="utf-8")
    for name, operation in LIBRARY.items():
        section = text.split(f"\n## {name}\n")[1].split("\n## ")[0]
        told = re.findall(r"^\| `(\w+)` \| ([^|]+) \|", section, re.MULTILINE)
        assert {a: default == "must be given" for a, default in told} == {a: r.required for a, r in operation.arguments.items()}


# What the pages claim, by other means --------------------------------------------------------------------------------
def flattened(path: list[RationalBSpline]) -> shapely.LinearRing:
    steps = np.linspace(0.0, 1.0, 60)
    return shapely.LinearRing(np.vstack([c.evaluate(c.domain[0] + steps[:-1] * (c.domain[1] - c.domain[0])) for c in path]))


@only("pocketing")
def test_the_passes_leave_what_the_page_says_and_nothing_between_them(ran: tuple[Ran, Path]) -> None:
    page, folder = ran
    names = page.names[-1]
    radius = names["radius"]
    covered = shapely.union_all([flattened(path).buffer(radius, 64) for p in names["passes"] for path in p.paths])
    loops = [flattened(list(loop)) for loop in names["pocket"].loops]
    pocket = shapely.Polygon(loops[0], loops[1:])
    rest = pocket.difference(covered)
    left = names["pocket"].area - sum(c.area for c in names["cleared"])
    assert rest.area == pytest.approx(left, rel=2e-3)
    reach = shapely.union_all([shapely.Polygon(flattened(r.outer.curves), [flattened(h.curves) for h in r.holes])
                               for c in names["cleared"] for r in c.regions])
    assert rest.symmetric_difference(pocket.difference(reach)).area < 2e-3 * left
    drawing = ezdxf.readfile(folder / "pocketing.dxf")
    assert {e.dxf.layer for e in drawing.modelspace()} >= {f"pass {p.distance:g}" for p in names["passes"]}


@only("walls")
def test_the_thinnest_wall_is_as_shapely_has_it(ran: tuple[Ran, Path]) -> None:
    names = ran[0].names[-1]
    loops = [flattened(list(loop)) for loop in names["part"].loops]
    gap = min(a.distance(b) for i, a in enumerate(loops) for b in loops[:i])
    assert names["thinnest"].thickness == pytest.approx(gap, abs=1e-3)


@only("strokes")
def test_the_share_that_strokes_cover_is_as_shapely_has_it(ran: tuple[Ran, Path]) -> None:
    names = ran[0].names[-1]
    loops = [flattened(list(loop)) for loop in names["glyph"].loops]
    glyph = shapely.Polygon(loops[0], loops[1:])
    brush = shapely.union_all([shapely.Point(x, y).buffer(r, 32) for line in names["lines"] for x, y, r in line])
    assert brush.intersection(glyph).area / glyph.area == pytest.approx(names["covered"].mean(), abs=5e-3)
    assert brush.difference(glyph).area < 1e-4 * glyph.area


@only("mesh-sizing")
def test_the_size_field_is_graded_and_below_the_size_function_it_is_compared_with(ran: tuple[Ran, Path]) -> None:
    names = ran[0].names[-1]
    axis: MedialAxis = names["axis"]
    found, inside = names["found"], names["inside"].ravel()
    loops = [flattened(list(loop)) for loop in names["part"].loops]
    depth = shapely.distance(shapely.points(found.points), shapely.union_all(loops))
    bound = 1e-3 + max(s.max_error for s in axis.segments)
    assert (found.radii <= depth + found.distance + bound)[inside].all()
    assert (names["size"] <= names["h"]).all()


@only("curves")
def test_the_lines_that_evaluate_a_segment_do_so_on_other_shapes(ran: tuple[Ran, Path]) -> None:
    evaluate: Any = ran[0].names[-1]["evaluate"]
    for name in ("plate", "ampersand", "ring"):
        axis = mat_core.medial_axis(mat_core.Domain.from_dict(json.loads((ROOT / f"openapi/examples/{name}.json").read_text())))
        t = np.linspace(0.0, 1.0, 23)
        for document, segment in zip(axis.to_dict()["segments"], axis.segments, strict=True):
            own = np.array([evaluate(document, v) for v in t.tolist()])
            assert np.abs(own - segment.evaluate(t)).max() <= 1e-12 * axis.domain.size
