"""The documents cannot drift: what they say is held to the code."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
from dataclasses import fields
from pathlib import Path

import pytest

from mat_core.analysis import operations as library
from service.errors import ERRORS
from service.http.negotiation import FORMATS
from service.operations import OPERATIONS
from service.settings import Settings, variable

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
DOCUMENTS = ["README.md", "ARCHITECTURE.md", "GLOSSARY.md", "CHANGELOG.md", "docs/paper.md", "docs/performance.md"]


def blocks(language: str) -> list[str]:
    """The fenced blocks of README in a language."""
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def written() -> list[str]:
    """Every document, pages included."""
    return sorted({*DOCUMENTS, *(str(page.relative_to(ROOT)) for page in (ROOT / "docs").glob("*.md"))})


def rows(text: str, header: str) -> list[list[str]]:
    """The cells of the table that begins with a header cell."""
    table = text[text.index(f"| {header} |") :].split("\n\n")[0]
    return [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in table.splitlines()[2:]]


def test_every_link_to_a_heading_leads_to_one() -> None:
    for name in written():
        for target, heading in re.findall(r"\]\(([^)#:]*)#([^)]+)\)", (ROOT / name).read_text(encoding="utf-8")):
            page = (ROOT / name).parent / target if target else ROOT / name
            headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
            anchors = {re.sub(r"[^\w -]", "", text.lower()).replace(" ", "-") for text in headings}
            assert heading in anchors, f"{name}: {target}#{heading}"


def test_every_make_command_exists() -> None:
    texts = [(ROOT / name).read_text(encoding="utf-8") for name in DOCUMENTS]
    named = {name for text in texts for name in re.findall(r"(?:^|[`(])make ([a-z-]+)", text, re.MULTILINE)}
    targets = set(re.findall(r"^([a-z-]+):", MAKEFILE, re.MULTILINE))
    assert named >= {"run", "test"}
    assert named <= targets


def test_make_itself_reads_every_target() -> None:
    for target in re.findall(r"^([a-z-]+):.*##", MAKEFILE, re.MULTILINE):
        subprocess.run(["make", "--dry-run", target], cwd=ROOT, check=True, capture_output=True)


def test_the_two_first_commands_are_the_first_block() -> None:
    commands = [line.split("#")[0].strip() for line in blocks("sh")[0].splitlines()]
    assert commands == ["make run", "make test"]


def test_the_error_table_is_the_table() -> None:
    told = {row[0].strip("`"): int(row[1]) for row in rows(README, "code")}
    assert told == {code: kind.status for code, kind in ERRORS.items()}


def test_the_table_of_routes_is_the_table() -> None:
    told = {}
    for route, arguments, formats, answer in rows(README, "route"):
        names = {name: bool(bold) for bold, name in re.findall(r"(\*\*)?`([a-z_]+)`", arguments)}
        told[route.strip("`").removeprefix("/v1/")] = (names, tuple(formats.split(", ")))
        assert answer
    required = {name: {a: rule.required for a, rule in own.arguments.items()} for name, own in library.OPERATIONS.items()}
    assert told == {name: (required.get(name, {}), operation.formats) for name, operation in OPERATIONS.items()}


def test_the_table_of_formats_is_the_table() -> None:
    assert {row[0].strip("`"): row[1].strip("`") for row in rows(README, "format")} == FORMATS


def test_the_docstring_of_the_error_table_is_the_table() -> None:
    assert importlib.util.find_spec("service.errors")
    text = (ROOT / "service" / "errors.py").read_text(encoding="utf-8").split('"""')[1]
    assert dict(re.findall(r"^    ([a-z-]+) +(\d{3}) ", text, re.MULTILINE)) == {
        code: str(kind.status) for code, kind in ERRORS.items()
    }


def test_the_settings_table_is_the_settings() -> None:
    told = {row[0].strip("`"): row[1] for row in rows(README, "variable")}
    assert told.pop("MAT_DATA_DIR") == "~/.local/state/mat-core"  # XDG_STATE_HOME says otherwise where it is set
    assert told == {variable(item.name): shown(item.default) for item in fields(Settings) if item.name != "data_dir"}


def shown(default: object) -> str:
    """A default as the table has it."""
    if default in (None, (), ""):
        return "(none)"
    if isinstance(default, bool):
        return str(default).lower()
    return f"{default:.10g}" if isinstance(default, float) else str(default)


def test_every_link_leads_somewhere() -> None:
    for name in written():
        for target in re.findall(r"\]\(([^)#:]+)\)", (ROOT / name).read_text(encoding="utf-8")):
            assert ((ROOT / name).parent / target).exists(), f"{name}: {target}"


def test_every_file_that_a_command_of_the_readme_reads_exists() -> None:
    for name in re.findall(r"@(openapi/\S+)", README):
        assert (ROOT / name).is_file()


def test_the_json_of_the_readme_is_json() -> None:
    domain, problem = (json.loads(block) for block in blocks("json"))
    assert domain["outer"] == json.loads((ROOT / "openapi/examples/rectangle.json").read_text())["outer"]
    assert problem["status"] == ERRORS[problem["code"]].status
    assert problem["title"] == ERRORS[problem["code"]].title


def test_the_python_of_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "openapi").symlink_to(ROOT / "openapi")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks("python"):
        exec(compile(block, "README.md", "exec"), names)
    for picture in ("rectangle.svg", "offset.svg"):
        assert (tmp_path / picture).read_text().startswith("<svg")


def test_modules_and_packages_named_by_the_architecture_exist() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    for name in re.findall(r"`((?:mat_core|service)(?:\.[a-z_]+)*)`", text):
        assert importlib.util.find_spec(name), name
    for name in re.findall(r"`((?:mat_core|service)/[a-z_/]+\.py)`", text):
        assert (ROOT / name).is_file(), name


def test_the_glossary_has_one_row_a_word_and_the_words_of_the_answers() -> None:
    words = [
        row[0]
        for header in ("word",)
        for part in (ROOT / "GLOSSARY.md").read_text(encoding="utf-8").split("## ")[1:]
        for row in rows(part, header)
    ]
    assert len(words) == len(set(words))
    members = {"domain", "loop", "edge", "u", "degree", "knots", "control_points", "weights"}
    assert members | {"node", "segment", "t", "radius", "footpoint", "certificate"} <= set(words)
