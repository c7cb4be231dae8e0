"""Fonts, folders of icons and files of domains give the same named domains whenever they are asked."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib

from tests.hunt.outlines import glyphs, icons, lines


def test_svg_files(tmp_path: Path) -> None:
    head = '<svg xmlns="http://www.w3.org/2000/svg"'
    (tmp_path / "a.svg").write_text(f'{head}><path d="M0 0h4v4h-4z"/><circle r="3" style="fill: none"/></svg>')
    (tmp_path / "b.svg").write_text(f'{head} fill="none"><path d="M0 0h1v1z"/></svg>')
    (tmp_path / "c.svg").write_text(f'{head}><path d="M0 0h"/></svg>')
    (tmp_path / "d.svg").write_text("no svg")
    assert [name for name, _ in icons(str(tmp_path), 0, 0)] == [f"icons_{tmp_path.name}/a#0"]


def test_a_font() -> None:
    file = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    found = list(glyphs(file, 5, 1))
    assert found == list(glyphs(file, 5, 1))
    assert all(name.startswith("font_DejaVuSans/") and d["outer"] for name, d in found)


def test_lines_of_domains(tmp_path: Path) -> None:
    file = tmp_path / "some.jsonl"
    file.write_text(json.dumps({"name": "one", "outer": [], "holes": []}) + "\n\n" + json.dumps({"outer": []}) + "\n")
    assert [name for name, _ in lines(file)] == ["lines_some/one", "lines_some/3"]
