"""Addresses of databases: what the service adds, and what it leaves alone."""

from __future__ import annotations

import pytest
import sqlalchemy as sa

from service.jobs.engine import completed


def test_connections_to_a_database_elsewhere_are_watched_and_speak_utf_8() -> None:
    given = "postgresql://mat:p%40ss%2Fword@db.example:5433/jobs"
    made, before = sa.make_url(completed(given)), sa.make_url(given)
    assert made.set(query={}) == before
    assert set(made.query) == {"client_encoding", "tcp_user_timeout", "keepalives_idle", "keepalives_interval"}


def test_what_the_address_says_itself_is_kept() -> None:
    made = sa.make_url(completed("postgresql://db.example/jobs?sslmode=require&keepalives_idle=60"))
    assert (made.query["sslmode"], made.query["keepalives_idle"]) == ("require", "60")


@pytest.mark.parametrize("url", ["sqlite:////var/lib/mat/jobs.sqlite", "sqlite:////data with spaces/100%/jobs.sqlite"])
def test_a_file_stays_as_it_is(url: str) -> None:
    assert completed(url) == url
