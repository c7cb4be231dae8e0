from __future__ import annotations

from collections.abc import Iterator

import httpx2
import pytest

from tests.service.live import serving


@pytest.fixture(scope="session")
def live() -> Iterator[httpx2.Client]:
    """A client of the real service, one a session."""
    with serving(environment={"MAT_MAX_BODY_BYTES": "4000000"}) as client:
        yield client
