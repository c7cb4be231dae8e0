"""Writes openapi/openapi.json from the code; a test holds the committed file to it.

``--release`` keeps it beside, as openapi/released/VERSION.json without its examples: what clients of that version rely on. A test
holds later documents to the last one that was kept, see `tools/breaking.py`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from service import __version__  # noqa: E402
from service.app import create_app  # noqa: E402
from service.settings import Settings  # noqa: E402

DOCUMENT = ROOT / "openapi" / "openapi.json"
RELEASED = ROOT / "openapi" / "released"


def text() -> str:
    """The document as it should stand in the file."""
    return json.dumps(create_app(Settings()).openapi(), indent=1, ensure_ascii=False) + "\n"


def without_examples(node: Any) -> Any:
    """The document without what only people read."""
    if isinstance(node, dict):
        return {name: without_examples(value) for name, value in node.items() if name not in ("examples", "example")}
    return [without_examples(value) for value in node] if isinstance(node, list) else node


if __name__ == "__main__":
    DOCUMENT.write_text(text(), encoding="utf-8")
    print(f"wrote {DOCUMENT.relative_to(ROOT)}")
    if "--release" in sys.argv:
        kept = RELEASED / f"{__version__}.json"
        kept.write_text(json.dumps(without_examples(json.loads(text())), ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"wrote {kept.relative_to(ROOT)}")
