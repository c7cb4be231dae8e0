from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.jobs.engine import engine_for
from service.jobs.store import Store


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    engine = engine_for(f"sqlite:///{tmp_path / 'jobs.sqlite'}")
    made = Store(engine)
    made.create_tables()
    yield made
    engine.dispose()
