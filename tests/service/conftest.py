from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from tests.service.live import serving


@pytest.fixture(scope="session", autouse=True)
def state_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where applications of this process keep their jobs, unless a test says otherwise."""
    folder = tmp_path_factory.mktemp("state")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(folder))
        yield folder


@pytest.fixture(scope="session")
def live() -> Iterator[httpx2.Client]:
    """A client of the real service, one a session."""
    with serving(environment={"MAT_MAX_BODY_BYTES": "4000000"}) as client:
        yield client
