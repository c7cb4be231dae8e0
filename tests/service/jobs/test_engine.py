"""Addresses of databases: what the service adds, and what it leaves alone."""

from __future__ import annotations

import pytest
import sqlalchemy as sa

from service.jobs.engine import watched


def test_the_kernel_watches_connections_to_a_database_elsewhere() -> None:
    given = "postgresql://mat:p%40ss%2Fword@db.example:5433/jobs"
    made, before = sa.make_url(watched(given)), sa.make_url(given)
    assert made.set(query={}) == before
    assert set(made.query) == {"tcp_user_timeout", "keepalives_idle", "keepalives_interval"}


def test_what_the_address_says_itself_is_kept() -> None:
    made = sa.make_url(watched("postgresql://db.example/jobs?sslmode=require&keepalives_idle=60"))
    assert (made.query["sslmode"], made.query["keepalives_idle"]) == ("require", "60")


@pytest.mark.parametrize("url", ["sqlite:////var/lib/mat/jobs.sqlite", "sqlite:////data with spaces/100%/jobs.sqlite"])
def test_a_file_stays_as_it_is(url: str) -> None:
    assert watched(url) == url
