from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

from service.settings import InvalidSetting, Settings, variable


def test_an_empty_environment_gives_the_defaults() -> None:
    assert Settings.from_environment({}) == Settings()


def test_every_field_is_read_from_its_variable() -> None:
    given = {
        "MAT_WORKERS": "3",
        "MAT_MAX_BODY_BYTES": " 2048 ",
        "MAT_DEADLINE_SECONDS": "1.5",
        "MAT_QUEUE_LIMIT": "0",
        "MAT_WORKER_MEMORY_BYTES": "100000000",
        "MAT_WORKER_RECYCLE_BYTES": "200000000",
        "MAT_WORKER_RECYCLE_REQUESTS": "300",
        "MAT_SHUTDOWN_NOTICE_SECONDS": "3",
        "MAT_SHUTDOWN_DRAIN_SECONDS": "4",
        "MAT_LOG_LEVEL": "Warning",
        "MAT_KEEP_FAILED_DIR": "/tmp/failed",
        "MAT_DATA_DIR": "/tmp/jobs",
        "MAT_DATABASE_URL": "postgresql://mat@localhost/mat",
        "MAT_ROLE": "API",
        "MAT_EXECUTOR_ID": "mat-1",
        "MAT_JOB_DEADLINE_SECONDS": "100",
        "MAT_JOB_RETENTION_SECONDS": "1000",
        "MAT_BATCH_CHUNK": "10",
        "MAT_MAX_BATCH_BYTES": "4096",
    }
    assert set(given) == {variable(item.name) for item in fields(Settings)}
    assert Settings.from_environment(given) == Settings(
        *(3, 2048, 1.5, 0, 100_000_000, 200_000_000, 300, 3.0, 4.0, "warning", Path("/tmp/failed")),
        *(Path("/tmp/jobs"), "postgresql://mat@localhost/mat", "api", "mat-1", 100.0, 1000.0, 10, 4096),
    )


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("MAT_WORKERS", "0"),
        ("MAT_WORKERS", "two"),
        ("MAT_WORKERS", ""),
        ("MAT_QUEUE_LIMIT", "-1"),
        ("MAT_DEADLINE_SECONDS", "nan"),
        ("MAT_DEADLINE_SECONDS", "inf"),
        ("MAT_LOG_LEVEL", "loud"),
        ("MAT_MAX_BODY_BYTES", "1e6"),
        ("MAT_DATA_DIR", ""),
        ("MAT_DATABASE_URL", "mysql://localhost/mat"),
        ("MAT_ROLE", "boss"),
        ("MAT_EXECUTOR_ID", "a b"),
    ],
)
def test_a_bad_value_is_named_together_with_what_is_expected(name: str, value: str) -> None:
    with pytest.raises(InvalidSetting, match=f"{name} is .*; expected "):
        Settings.from_environment({name: value})


def test_a_port_variable_set_by_a_cluster_is_not_a_setting() -> None:
    assert Settings.from_environment({"MAT_PORT": "tcp://10.0.0.1:8000"}) == Settings()
