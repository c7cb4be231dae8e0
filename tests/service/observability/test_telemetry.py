"""Spans go to a collector where one is configured, and nothing of it is loaded where none is."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import httpx2
import pytest
from opentelemetry.proto.collector.trace.v1.trace_service_pb2 import ExportTraceServiceRequest
from opentelemetry.proto.trace.v1.trace_pb2 import Span

from tests.service.live import ROOT
from tests.service.test_server import serving

JSON = {"Content-Type": "application/json"}
TRACE, PARENT = "0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331"


class Collector(ThreadingHTTPServer):
    """Takes what a collector takes at /v1/traces."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Receiver)
        self.spans: list[Span] = []
        self.services: set[str] = set()


class Receiver(BaseHTTPRequestHandler):
    """One export."""

    server: Collector

    def do_POST(self) -> None:
        assert self.path == "/v1/traces"
        export = ExportTraceServiceRequest.FromString(self.rfile.read(int(self.headers["content-length"])))
        for resource in export.resource_spans:
            self.server.services |= {a.value.string_value for a in resource.resource.attributes if a.key == "service.name"}
            self.server.spans += [span for scope in resource.scope_spans for span in scope.spans]
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@pytest.fixture
def collector() -> Iterator[Collector]:
    with Collector() as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def test_requests_their_waiting_and_their_stages_are_spans_of_the_caller_s_trace(tmp_path: Path, collector: Collector) -> None:
    endpoint = f"http://127.0.0.1:{collector.server_port}"
    with serving(tmp_path, OTEL_EXPORTER_OTLP_ENDPOINT=endpoint) as (process, address):
        headers = JSON | {"traceparent": f"00-{TRACE}-{PARENT}-01"}
        assert httpx2.post(f"{address}/v1/mat", content=b'{"do": "echo"}', headers=headers).status_code == 200
        refused = httpx2.post(f"{address}/v1/mat", content=b'{"do": "refuse", "code": "not-certified"}', headers=JSON)
        assert refused.status_code == 500
        process.terminate()
        assert process.wait(30) == 0
    assert collector.services == {"mat"}
    good, bad = (span for span in collector.spans if span.name == "POST /v1/mat")
    assert (good.trace_id.hex(), good.parent_span_id.hex()) == (TRACE, PARENT)
    assert bad.trace_id.hex() != TRACE
    assert {a.key: a.value.string_value for a in bad.attributes}["mat.code"] == "not-certified"
    ours = {span.name: span for span in collector.spans if span.trace_id == good.trace_id}
    assert set(ours) == {"POST /v1/mat", "queue", "work", "solve"}
    assert ours["queue"].parent_span_id == ours["work"].parent_span_id == good.span_id
    assert ours["solve"].parent_span_id == ours["work"].span_id
    assert good.start_time_unix_nano <= ours["work"].start_time_unix_nano <= ours["work"].end_time_unix_nano
    assert ours["queue"].end_time_unix_nano == ours["work"].start_time_unix_nano
    assert not any("readyz" in span.name for span in collector.spans)


def test_without_a_collector_nothing_of_it_is_loaded(tmp_path: Path) -> None:
    program = f"""
import sys
from pathlib import Path
from starlette.testclient import TestClient
from service.app import create_app
from service.settings import Settings
with TestClient(create_app(Settings(workers=1, data_dir=Path({str(tmp_path)!r})), "tests.service.handlers")) as client:
    client.get("/version")
sys.exit(any(name.startswith(("opentelemetry.sdk", "opentelemetry.exporter")) for name in sys.modules))
"""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("OTEL_")}
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, env=environment, check=False).returncode == 0
