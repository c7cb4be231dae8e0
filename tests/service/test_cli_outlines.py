"""``mat outlines``: files that people have become lines that every other command takes."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import ezdxf
import matplotlib
import pytest

from service.cli import main
from service.cli.exits import INVALID_INPUT, OK, USAGE
from service.cli.outlines import MOST, READERS

FONT = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
RING = '<svg><path id="ring" d="M0 0h9v9h-9z M1 1v7h7v-7z"/><text/></svg>'
LAKE = '{"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 4], [0, 0]]]}'


@pytest.fixture
def plate(tmp_path: Path) -> Path:
    drawing = ezdxf.new()
    drawing.layers.add("cut")
    drawing.modelspace().add_circle((0, 0), 5, dxfattribs={"layer": "cut"})
    drawing.modelspace().add_circle((0, 0), 2)
    drawing.saveas(tmp_path / "plate.dxf")
    return tmp_path / "plate.dxf"


def test_lines_go_on_to_the_other_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "ring.svg").write_text(RING)
    domains = tmp_path / "ring.json"
    assert main(["outlines", str(tmp_path / "ring.svg"), "-o", str(domains)]) == OK
    assert capsys.readouterr().err == f"mat: {tmp_path / 'ring.svg'}: left out: text 2: <text> has no outline\n"
    assert main(["check", str(domains)]) == OK
    assert "valid, 8 edges in 2 loops, area 32" in capsys.readouterr().out
    assert main(["solve", str(domains)]) == OK
    assert json.loads(capsys.readouterr().out)["graph"]["cycles"] == 1


def test_each_kind_of_file(tmp_path: Path, plate: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with gzip.open(tmp_path / "lake.geojson.gz", "wt") as file:
        file.write(LAKE)
    for arguments, count in [([plate], 1), ([tmp_path / "lake.geojson.gz"], 1), ([FONT, "--characters", "Qi"], 3)]:
        assert main(["outlines", *map(str, arguments)]) == OK
        lines = capsys.readouterr().out.splitlines()
        assert len(lines) == count
        assert all(json.loads(line)["outer"] for line in lines)


def test_options_reach_the_reader(tmp_path: Path, plate: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["outlines", str(plate), "--layer", "cut", "--gap", "1e-4"]) == OK
    assert json.loads(capsys.readouterr().out)["holes"] == []
    (tmp_path / "ring.svg").write_text(RING)
    assert main(["outlines", str(tmp_path / "ring.svg"), "--flip"]) == OK
    assert json.loads(capsys.readouterr().out)["outer"][1]["control_points"] == [[9, 0], [9, -9]]


@pytest.mark.parametrize(
    ("name", "content", "options", "code", "told"),
    [
        ("a.txt", "", [], USAGE, "one of .svg .dxf"),
        ("-", "", [], USAGE, "one of .svg .dxf"),
        ("none.svg", None, [], USAGE, "cannot read"),
        ("none.dxf", None, [], USAGE, "cannot read"),
        ("a.svg", "<svg/>", ["--characters", "a"], USAGE, "--characters is for .ttf"),
        ("a.svg", "<svg/>", [], INVALID_INPUT, "no outline was found"),
        ("a.svg", "<svg><path id='p' d='M0'/></svg>", [], INVALID_INPUT, "p: path data: M wants a number"),
        ("a.dxf", "no", [], INVALID_INPUT, "not a DXF drawing"),
        ("a.geojson", "{", [], INVALID_INPUT, "not JSON"),
        ("a.ttf", "no", ["--characters", "a"], INVALID_INPUT, "not a font"),
        ("a.ttf", "no", [], USAGE, "--characters 'Qa&'"),
    ],
)
def test_what_cannot_be_read_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, content: str | None, options: list[str], code: int, told: str
) -> None:
    path = str(tmp_path / name) if name != "-" else name
    if content is not None and name != "-":
        Path(path).write_text(content)
    assert main(["outlines", path, *options]) == code
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_a_layer_that_is_not_there(plate: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["outlines", str(plate), "--layer", "nope"]) == USAGE
    assert "has no layer 'nope'" in capsys.readouterr().err


def test_much_that_is_left_out_is_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.svg").write_text(f'<svg><circle r="1"/>{"<text/>" * (MOST + 5)}</svg>')
    assert main(["outlines", str(tmp_path / "a.svg")]) == OK
    told = capsys.readouterr().err.splitlines()
    assert len(told) == MOST + 1
    assert told[-1].endswith("left out: and 5 more")


def test_the_help_names_every_ending(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["outlines", "--help"])
    told = capsys.readouterr().out
    assert [ending for ending in READERS if ending not in told and ending != ".json"] == []
