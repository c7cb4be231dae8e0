"""The pages in docs: run what stands in them, and write their pictures and printed lines anew (``make docs``).

The Python blocks of a page are run in order, in one namespace and an empty folder that holds the examples. What a block prints
stands in the ``text`` block right after it; files named .svg that are left in the folder are the page's pictures.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PICTURES = DOCS / "pictures"
BLOCK = re.compile(r"```python\n(?P<code>.*?)```\n(?:\n```text\n(?P<told>.*?)```\n)?", re.DOTALL)


@dataclass(frozen=True)
class Ran:
    """A page that was run: the names after each block, and what it printed beside what the page says it prints."""

    names: list[dict[str, Any]]
    printed: list[str]
    told: list[str]


def pages() -> list[Path]:
    """Those that have Python to run."""
    return [page for page in sorted(DOCS.glob("*.md")) if BLOCK.search(page.read_text(encoding="utf-8"))]


def run(page: Path, folder: Path) -> Ran:
    """Run a page in a folder, which gets its files."""
    (folder / "openapi").symlink_to(ROOT / "openapi")
    (folder / "tests").symlink_to(ROOT / "tests")
    names: dict[str, Any] = {"__name__": page.stem}
    after, printed, told = [], [], []
    text = page.read_text(encoding="utf-8")
    with _inside(folder):
        for block in BLOCK.finditer(text):
            above = text.count("\n", 0, block.start("code"))
            code = compile("\n" * above + block["code"], str(page), "exec")  # so that errors name the page's own line
            stream = io.StringIO()
            with contextlib.redirect_stdout(stream):
                exec(code, names)
            after.append(dict(names))
            printed.append(stream.getvalue())
            told.append(block["told"] or "")
    return Ran(after, printed, told)


@contextlib.contextmanager
def _inside(folder: Path) -> Iterator[None]:
    """Work in a folder for a while (contextlib.chdir, which is for one thread, as this is)."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def rewritten(page: Path, printed: list[str]) -> str:
    """The text of a page with its printed lines anew."""
    lines = iter(printed)

    def block(match: re.Match[str]) -> str:
        output = next(lines)
        return f"```python\n{match['code']}```\n" + (f"\n```text\n{output}```\n" if output else "")

    return BLOCK.sub(block, page.read_text(encoding="utf-8"))


def main() -> int:
    """Run the pages named, or all; write what they print and draw."""
    named = [DOCS / f"{name}.md" for name in sys.argv[1:]] or pages()
    PICTURES.mkdir(exist_ok=True)
    for page in named:
        with tempfile.TemporaryDirectory() as folder:
            ran = run(page, Path(folder))
            page.write_text(rewritten(page, ran.printed), encoding="utf-8")
            drawn = sorted(Path(folder).glob("*.svg"))
            for picture in drawn:
                (PICTURES / picture.name).write_bytes(picture.read_bytes())
        print(f"{page.relative_to(ROOT)}: {len(ran.printed)} blocks, {len(drawn)} pictures")
    return 0


if __name__ == "__main__":
    sys.exit(main())
