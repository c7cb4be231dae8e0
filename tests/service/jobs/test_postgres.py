"""Several machines on one PostgreSQL: what one of them had begun goes on elsewhere, and a database that is away stops no work."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.service.jobs.postgres import Postgres, programs
from tests.service.jobs.servers import Server
from tests.service.processes import eventually


@pytest.fixture(scope="module")
def postgres() -> Iterator[Postgres]:
    folder = programs()
    if folder is None:
        pytest.skip("PostgreSQL is not installed here: jobs on several machines were not tested")
    cluster = Postgres(folder)
    try:
        cluster.start()
        yield cluster
    finally:
        cluster.remove()


def server(folder: Path, postgres: Postgres, role: str, name: str) -> Server:
    # jobs that give way would wait for the tests beside them
    return Server(folder, MAT_DATABASE_URL=postgres.url, MAT_ROLE=role, MAT_EXECUTOR_ID=name, MAT_LONG_PRIORITY="normal")


def test_the_jobs_of_a_machine_that_does_not_come_back_are_taken_over(tmp_path: Path, postgres: Postgres) -> None:
    with server(tmp_path, postgres, "api", "door") as api:
        doomed = server(tmp_path, postgres, "worker", "doomed").start()
        try:
            jobs = {api.job({"name": k, "seconds": 0.5}): k for k in range(8)}
            first = next(iter(jobs))
            api.until(first, "running", "successful")
            with server(tmp_path, postgres, "worker", "heir") as heir:
                doomed.kill()
                batch = heir.batch({"name": f"line {k}"} for k in range(20))
                for job, name in jobs.items():
                    assert api.until(job, "successful", "failed", seconds=120)["status"] == "successful"
                    assert heir.client.get(f"/v1/jobs/{job}/results").json()["did"]["name"] == name
                api.until(batch, "successful")
        finally:
            doomed.kill()


def test_while_the_database_is_away_work_goes_on_and_is_recorded_when_it_is_back(tmp_path: Path, postgres: Postgres) -> None:
    with server(tmp_path, postgres, "all", "patient") as one:
        running = one.job({"name": "running", "seconds": 1.5})
        waiting = one.job({"name": "waiting"})
        one.until(running, "running")
        postgres.stop()
        refused = one.post({})
        assert (refused.status_code, refused.json()["code"]) == (503, "store-unavailable")
        assert "retry-after" in refused.headers
        assert one.client.get("/readyz").json()["code"] == "store-unavailable"
        sync = one.client.post("/v1/mat", content=b"{}", headers={"Content-Type": "application/json"})
        assert sync.status_code == 200
        eventually(lambda: "running" in one.done(), seconds=60)
        postgres.start()
        eventually(lambda: one.client.get("/readyz").status_code == 200, seconds=60)
        for job in (running, waiting):
            assert one.until(job, "successful")["progress"] == 100
        assert sorted(one.done()) == ["None", "running", "waiting"]
