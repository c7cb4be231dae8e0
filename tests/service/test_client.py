"""A typed client, made from the OpenAPI document by a tool that knows nothing else of this service, and used."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import httpx2
import pytest

from tests.service.live import ROOT

CONFIGURATION = "package_name_override: mat_client\npost_hooks: []\n"
LEFT_OUT = ["POST /v1/batches"]
"""Operations that the tool cannot write a call for: it knows no JSON lines."""


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The client, generated from the committed document."""
    folder = tmp_path_factory.mktemp("client")
    (folder / "config.yaml").write_text(CONFIGURATION)
    source, target = ROOT / "openapi" / "openapi.json", folder / "mat_client"
    command = [sys.executable, "-m", "openapi_python_client", "generate", "--meta", "none", "--config", "config.yaml"]
    done = subprocess.run(
        [*command, "--path", str(source), "--output-path", str(target)],
        cwd=folder, check=True, capture_output=True, text=True, encoding="utf-8",
    )  # fmt: skip
    warnings = [line for line in (done.stdout + done.stderr).splitlines() if "parsing" in line]
    assert [line for line in warnings if not any(name in line for name in LEFT_OUT)] == []
    sys.path.insert(0, str(folder))
    try:
        yield importlib.import_module("mat_client")
    finally:
        sys.path.remove(str(folder))
        for name in [name for name in sys.modules if name.split(".")[0] == "mat_client"]:
            del sys.modules[name]


@pytest.fixture(scope="module")
def client(package: ModuleType, live: httpx2.Client) -> Iterator[Any]:
    with package.Client(base_url=str(live.base_url), timeout=90, raise_on_unexpected_status=True) as client:
        yield client


def call(name: str) -> ModuleType:
    """The module of an operation."""
    return importlib.import_module(f"mat_client.api.{name}")


def domain(name: str, **more: Any) -> Any:
    """An example as the client's own type."""
    kind = {"": "Domain"}.get(name, "".join(part.title() for part in name.split("-")) + "Request")
    body = json.loads((ROOT / "openapi" / "examples" / "plate.json").read_text())
    return getattr(importlib.import_module("mat_client.models"), kind).from_dict(body | more)


def test_every_operation_has_a_call(package: ModuleType) -> None:
    document = json.loads((ROOT / "openapi" / "openapi.json").read_text())
    described = {
        description["operationId"].replace("-", "_")
        for path, methods in document["paths"].items()
        for method, description in methods.items()
        if f"{method.upper()} {path}" not in LEFT_OUT
    }
    assert package.__file__ is not None
    assert {path.stem for path in (Path(package.__file__).parent / "api").glob("*/*.py")} - {"__init__"} == described


def test_a_solved_domain_is_typed(client: Any) -> None:
    answer = call("medial_axis.solve").sync(client=client, body=domain(""), precision=8)
    assert type(answer).__name__ == "MatAnswer"
    assert answer.certificate.passed is True
    assert answer.graph.cycles == 1
    assert answer.rounding.digits == 8
    assert all(len(point) == 2 for segment in answer.segments for point in segment.axis.control_points)


def test_an_analysis_takes_its_arguments(client: Any) -> None:
    answer = call("medial_axis.offset").sync(client=client, body=domain("offset", arguments={"distance": 0.25}))
    assert answer.operation == "offset"
    assert answer.result.regions


def test_a_refusal_is_typed_too(client: Any) -> None:
    body = domain("")
    body.outer = body.outer[:1]
    answer = call("medial_axis.solve").sync(client=client, body=body)
    assert type(answer).__name__ == "ProblemDocument"
    assert answer.code == "invalid-domain"
    assert any(problem.pointer == "/outer" or problem.pointer.startswith("/outer/") for problem in answer.problems)


def test_a_job_from_its_creation_to_its_end(client: Any) -> None:
    job = call("medial_axis.solve").sync(client=client, body=domain(""), prefer="respond-async")
    assert type(job).__name__ == "JobStatus"
    end = time.monotonic() + 60
    while (status := call("jobs.job").sync(job.job_id, client=client)).status not in ("successful", "failed"):
        assert time.monotonic() < end
        time.sleep(0.05)
    assert status.status == "successful"
    results = call("jobs.results").sync_detailed(job.job_id, client=client)
    assert results.status_code == 200
    assert json.loads(results.content)["certificate"]["passed"]
    assert call("jobs.dismiss").sync(job.job_id, client=client).status == "dismissed"
