from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

from service.http.keys import ApiKey
from service.settings import InvalidSetting, Settings, variable

DIGEST = "0123456789abcdef" * 4


def test_an_empty_environment_gives_the_defaults() -> None:
    assert Settings.from_environment({}) == Settings()


def test_every_field_is_read_from_its_variable() -> None:
    given = {
        "MAT_WORKERS": "3",
        "MAT_LONG_PRIORITY": "Low",
        "MAT_MAX_BODY_BYTES": " 2048 ",
        "MAT_DEADLINE_SECONDS": "1.5",
        "MAT_HEAD_SECONDS": "1.5",
        "MAT_UPLOAD_SECONDS": "2.5",
        "MAT_DOWNLOAD_SECONDS": "3.5",
        "MAT_MAX_CONNECTIONS": "50",
        "MAT_TRAFFIC_BYTES": "100000",
        "MAT_QUEUE_LIMIT": "0",
        "MAT_WORKER_MEMORY_BYTES": "100000000",
        "MAT_WORKER_RECYCLE_BYTES": "200000000",
        "MAT_WORKER_RECYCLE_REQUESTS": "300",
        "MAT_SHUTDOWN_NOTICE_SECONDS": "3",
        "MAT_SHUTDOWN_DRAIN_SECONDS": "4",
        "MAT_MAX_EDGES": "10",
        "MAT_MAX_CONTROL_POINTS": "20",
        "MAT_RESULT_CACHE_BYTES": "0",
        "MAT_API_KEYS": f"cam:{DIGEST}, {'1' * 64}",
        "MAT_KEY_CONCURRENCY": "4",
        "MAT_METRICS_OPEN": "True",
        "MAT_CORS_ORIGINS": "https://a.example, http://localhost:5173",
        "MAT_LOG_LEVEL": "Warning",
        "MAT_KEEP_FAILED_DIR": "/var/failed",
        "MAT_DATA_DIR": "/var/jobs",
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
        workers=3,
        long_priority="low",
        max_body_bytes=2048,
        deadline_seconds=1.5,
        head_seconds=1.5,
        upload_seconds=2.5,
        download_seconds=3.5,
        max_connections=50,
        traffic_bytes=100_000,
        queue_limit=0,
        worker_memory_bytes=100_000_000,
        worker_recycle_bytes=200_000_000,
        worker_recycle_requests=300,
        shutdown_notice_seconds=3.0,
        shutdown_drain_seconds=4.0,
        max_edges=10,
        max_control_points=20,
        result_cache_bytes=0,
        api_keys=(ApiKey("cam", bytes.fromhex(DIGEST)), ApiKey("11111111", b"\x11" * 32)),
        key_concurrency=4,
        metrics_open=True,
        cors_origins=("https://a.example", "http://localhost:5173"),
        log_level="warning",
        keep_failed_dir=Path("/var/failed"),
        data_dir=Path("/var/jobs"),
        database_url="postgresql://mat@localhost/mat",
        role="api",
        executor_id="mat-1",
        job_deadline_seconds=100.0,
        job_retention_seconds=1000.0,
        batch_chunk=10,
        max_batch_bytes=4096,
    )


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("MAT_WORKERS", "0"),
        ("MAT_WORKERS", "two"),
        ("MAT_WORKERS", ""),
        ("MAT_LONG_PRIORITY", "high"),
        ("MAT_HEAD_SECONDS", "0"),
        ("MAT_UPLOAD_SECONDS", "0"),
        ("MAT_QUEUE_LIMIT", "-1"),
        ("MAT_DEADLINE_SECONDS", "nan"),
        ("MAT_DEADLINE_SECONDS", "inf"),
        ("MAT_LOG_LEVEL", "loud"),
        ("MAT_MAX_BODY_BYTES", "1e6"),
        ("MAT_DATA_DIR", ""),
        ("MAT_DATABASE_URL", "mysql://localhost/mat"),
        ("MAT_ROLE", "boss"),
        ("MAT_EXECUTOR_ID", "a b"),
        ("MAT_METRICS_OPEN", "1"),
        ("MAT_CORS_ORIGINS", "example.org"),
        ("MAT_CORS_ORIGINS", "https://example.org/path"),
        ("MAT_API_KEYS", "not-a-digest"),
        ("MAT_API_KEYS", f"{DIGEST[:-1]}"),
        ("MAT_API_KEYS", f"a b:{DIGEST}"),
        ("MAT_API_KEYS", f"cam:{DIGEST},cam:{'0' * 64}"),
    ],
)
def test_a_bad_value_is_named_together_with_what_is_expected(name: str, value: str) -> None:
    with pytest.raises(InvalidSetting, match=f"{name} is .*; expected "):
        Settings.from_environment({name: value})


def test_a_port_variable_set_by_a_cluster_is_not_a_setting() -> None:
    assert Settings.from_environment({"MAT_PORT": "tcp://10.0.0.1:8000"}) == Settings()
