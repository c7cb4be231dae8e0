"""Several machines on one PostgreSQL: what one of them had begun goes on elsewhere, and a database that is away stops no work."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from service.server import ENDING_SECONDS
from tests.service.jobs.postgres import Postgres, programs
from tests.service.jobs.servers import NOISE_SECONDS, Server, code
from tests.service.processes import eventually

Away = tuple[Callable[[], None], Callable[[], None]]


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
    return Server(folder, MAT_DATABASE_URL=postgres.url, MAT_ROLE=role, MAT_EXECUTOR_ID=name)


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
        eventually(lambda: one.status(running)["message"] == "Being worked on: solve.", seconds=60)  # a worker has it
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


def test_a_database_that_names_no_encoding_does_as_well(tmp_path: Path, postgres: Postgres) -> None:
    with Server(tmp_path, MAT_DATABASE_URL=postgres.without_encoding(), MAT_ROLE="all", MAT_EXECUTOR_ID="plain") as one:
        jobs = [one.job({"name": "größer"}), one.batch({"name": f"{k} ≥ 0"} for k in range(3))]
        for job in jobs:
            one.until(job, "successful")
        assert one.client.get(f"/v1/jobs/{jobs[0]}/results").json()["did"]["name"] == "größer"


@pytest.fixture
def away(request: pytest.FixtureRequest, postgres: Postgres) -> Iterator[Away]:
    """How to make the database be away, stopped or frozen, and to have it back; it is back afterwards."""
    leave, come = (postgres.stop, postgres.start) if request.param == "stopped" else (postgres.freeze, postgres.thaw)
    with contextlib.ExitStack() as gone:

        def be_away() -> None:
            leave()
            gone.callback(come)

        yield be_away, gone.close


@pytest.mark.parametrize(
    ("away", "seconds"), [("stopped", 0.0), ("stopped", 0.03), ("frozen", 0.01)], indirect=["away"]
)
def test_a_server_ends_in_time_while_its_database_is_away_and_loses_nothing(
    tmp_path: Path, postgres: Postgres, away: Away, seconds: float
) -> None:
    be_away, be_back = away
    one = server(tmp_path, postgres, "all", "leaving")
    with one:
        jobs = [one.job({"name": "running", "seconds": 1.0}), one.batch({"name": k, "seconds": 0.05} for k in range(20))]
        jobs.append(one.job({"name": "waiting"}))  # is claimed, begun or neither when the database goes
        time.sleep(seconds)
        be_away()
        assert one.stop() < ENDING_SECONDS + NOISE_SECONDS  # there is nothing to drain
        be_back()
        one.start()
        for job in jobs:
            assert one.until(job, "successful", "failed")["status"] == "successful"


@pytest.mark.parametrize("away", ["frozen"], indirect=True)
@pytest.mark.parametrize("role", ["api", "worker"])
def test_a_server_of_one_role_ends_in_time_while_its_database_is_away(
    tmp_path: Path, postgres: Postgres, away: Away, role: str
) -> None:
    be_away, _ = away
    with server(tmp_path, postgres, role, "leaving") as one:
        be_away()
        assert one.stop() < ENDING_SECONDS + NOISE_SECONDS


@pytest.mark.parametrize("away", ["stopped", "frozen"], indirect=True)
def test_a_server_that_has_not_found_its_database_yet_ends_in_time(tmp_path: Path, postgres: Postgres, away: Away) -> None:
    be_away, _ = away
    be_away()
    one = server(tmp_path, postgres, "all", "early").start(ready=False)
    try:
        eventually(lambda: code(one) == "store-unavailable", seconds=60)
        assert one.stop() < ENDING_SECONDS + NOISE_SECONDS
    finally:
        one.kill()
