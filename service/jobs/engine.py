"""Connections to the database of jobs: a SQLite file, or PostgreSQL."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import event

CONNECT_SECONDS = 2
STATEMENT_SECONDS = 10
"""No question of this module takes long; a longer wait means that the database is in trouble."""

SILENCE_SECONDS = 5
"""After so long without a word on a connection the kernel asks its other end, which is taken for gone if it is still silent some
seconds later. Without this an answer is waited for two hours if the machine was switched off or cut off after it was asked."""

PROBE_SECONDS = 2
"""Pause between two such questions of the kernel."""


def completed(url: str) -> str:
    """The address of a database with what its connections must be told; what the address says itself is kept.

    The kernel is to notice that the database is gone. And text is UTF-8: a database made without an encoding (SQL_ASCII, as
    initdb makes them where no locale is set) names none, and psycopg would then hand out bytes.
    """
    parsed = sa.make_url(url)
    if parsed.get_backend_name() == "sqlite":
        return url
    told = {
        "client_encoding": "utf8",
        "tcp_user_timeout": str(1000 * SILENCE_SECONDS),
        "keepalives_idle": str(SILENCE_SECONDS),
        "keepalives_interval": str(PROBE_SECONDS),
    }
    return parsed.set(query={**told, **parsed.query}).render_as_string(hide_password=False)


def engine_for(url: str) -> sa.Engine:
    """An engine whose calls fail soon rather than hang when the database is gone."""
    parsed = sa.make_url(url)
    if parsed.get_backend_name() == "sqlite":
        engine = sa.create_engine(parsed, connect_args={"timeout": STATEMENT_SECONDS})
        event.listen(engine, "connect", _set_up_sqlite)
        return engine
    options = f"-c statement_timeout={1000 * STATEMENT_SECONDS} -c lock_timeout={1000 * STATEMENT_SECONDS}"
    return sa.create_engine(
        parsed.set(drivername="postgresql+psycopg"),
        pool_pre_ping=True,
        pool_timeout=CONNECT_SECONDS,
        connect_args={"connect_timeout": CONNECT_SECONDS, "options": options},
    )


def _set_up_sqlite(connection: Any, _record: Any) -> None:
    """Readers beside one writer, commits that are on disk, and a write lock from the start of a transaction that writes."""
    connection.isolation_level = "IMMEDIATE"
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")
