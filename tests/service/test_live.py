"""The whole service, as it is started in production, with the real library behind it."""

from __future__ import annotations

import gzip
import json
import os
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import httpx2
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from service.errors import MEDIA_TYPE
from service.schemas import DomainRequest, MatAnswer, ProblemDocument
from tests.service.domains import anything, damaged_domains, valid_domains
from tests.service.live import ROOT, serving

EXAMPLES = sorted((ROOT / "openapi" / "examples").glob("*.json"))
JSON = {"Content-Type": "application/json"}
RELAXED = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


def post(live: httpx2.Client, body: Any) -> httpx2.Response:
    content = body if isinstance(body, bytes) else json.dumps(body).encode()
    return live.post("/v1/mat", content=content, headers=JSON)


def refused(response: httpx2.Response, status: int) -> ProblemDocument:
    """Hold that a body was refused with a status and a problem document."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == MEDIA_TYPE
    return ProblemDocument.model_validate_json(response.text)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_is_solved(live: httpx2.Client, path: Path) -> None:
    domain = json.loads(path.read_text())
    response = post(live, domain)
    assert response.status_code == 200, response.text
    answer = MatAnswer.model_validate_json(response.text)
    holes = len(domain.get("holes", []))
    assert answer.certificate.passed
    assert answer.graph.cycles == holes
    assert answer.graph.components == 1
    assert answer.domain.loops == 1 + holes
    assert [node.id for node in answer.graph.nodes] == list(range(len(answer.graph.nodes)))
    assert sorted(answer.graph.topological_order) == list(range(len(answer.graph.nodes)))
    assert answer.version.service == live.get("/version").json()["service"]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_is_drawn(live: httpx2.Client, path: Path) -> None:
    by_header = live.post("/v1/mat", content=path.read_bytes(), headers=JSON | {"Accept": "image/svg+xml"})
    by_query = live.post("/v1/mat", params={"f": "svg"}, content=path.read_bytes(), headers=JSON)
    assert by_header.headers["content-type"] == "image/svg+xml"
    assert by_header.content == by_query.content
    assert ElementTree.fromstring(by_header.content).tag.endswith("svg")


@given(domain=valid_domains())
@RELAXED
def test_valid_domains_are_solved(live: httpx2.Client, domain: dict[str, Any]) -> None:
    DomainRequest.model_validate_json(json.dumps(domain))
    response = post(live, domain)
    assert response.status_code == 200, response.text
    answer = MatAnswer.model_validate_json(response.text)
    assert answer.graph.cycles == len(domain.get("holes", []))
    assert answer.domain.edges == len(domain["outer"]) + len(domain.get("holes", []))


def test_one_request_at_a_time_gives_the_same_bytes(live: httpx2.Client) -> None:
    body = EXAMPLES[0].read_bytes()
    assert len({post(live, body).content for _ in range(4)}) == 1


NOT_JSON = {
    "nothing": b"",
    "blank": b"  \n",
    "a word": b"domain",
    "an open list": b'{"outer": [',
    "two documents": b"{} {}",
    "a trailing comma": b'{"outer": [],}',
    "a byte order mark": b"\xef\xbb\xbf{}",
    "UTF-16": '{"outer": []}'.encode("utf-16"),
    "invalid UTF-8": b'{"outer": "\xff"}',
    "a lone surrogate": rb'{"outer": "\ud800"}',
    "single quotes": b"{'outer': []}",
    "a comment": b"{} // comment",
    "a leading zero": b'{"outer": [01]}',
    "a deep nest": b"[" * 100_000,
    "a deep nest, closed": b'{"outer":' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    "a deep nest of objects": b'{"a":' * 100_000 + b"1" + b"}" * 100_000,
    "a NaN where nothing is read": b'{"a": NaN, "b": [}',
}


@pytest.mark.parametrize("body", NOT_JSON.values(), ids=NOT_JSON)
def test_what_is_not_json_is_refused_with_its_place(live: httpx2.Client, body: bytes) -> None:
    document = refused(post(live, body), 400)
    assert document.code == "not-json"
    assert document.model_extra is not None
    assert document.model_extra["line"] >= 1
    assert document.model_extra["column"] >= 1


def test_the_place_is_right(live: httpx2.Client) -> None:
    document = refused(post(live, b'{"outer": [\n  1,\n  ,2]}'), 400)
    assert document.model_extra is not None
    assert (document.model_extra["line"], document.model_extra["column"]) == (3, 3)


SQUARE = [
    {"degree": 1, "control_points": [a, b]}
    for a, b in zip(([0, 0], [1, 0], [1, 1], [0, 1]), ([1, 0], [1, 1], [0, 1], [0, 0]), strict=True)
]


def raw(text: str) -> bytes:
    """The square with its first coordinate spelled in a certain way."""
    return json.dumps({"outer": SQUARE}).replace("[[0, 0]", f"[[{text}, 0]", 1).encode()


@pytest.mark.parametrize("text", ["NaN", "Infinity", "-Infinity", "1e400", "-1e999", "1" + "0" * 400])
def test_numbers_that_are_none_are_found_and_named(live: httpx2.Client, text: str) -> None:
    document = refused(post(live, raw(text)), 422)
    assert document.code == "invalid-domain"
    found = [problem for problem in document.problems if problem.code == "non-finite"]
    assert found[0].pointer.startswith("/outer/0/control_points/0")


@pytest.mark.parametrize("text", ["true", "null", '"0"', "[0]", "{}", "1e300", "123456789012345678901234567890"])
def test_values_of_the_wrong_kind_or_size(live: httpx2.Client, text: str) -> None:
    document = refused(post(live, raw(text)), 422)
    assert document.problems


def test_the_papers_march_gives_the_same_axis(live: httpx2.Client) -> None:
    answers = [
        post(live, {"outer": SQUARE, "options": options}).json()
        for options in ({"method": "discs"}, {"method": "march", "step": 0.01, "check_step": 5})
    ]
    points = [sorted(node["point"] for node in answer["graph"]["nodes"]) for answer in answers]
    assert points[0] == [pytest.approx(point) for point in points[1]]
    assert [len(answer["segments"]) for answer in answers] == [4, 4]


def test_a_march_that_has_no_start_names_its_option(live: httpx2.Client) -> None:
    half = 0.5**0.5
    corners = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    disc = [{"degree": 2, "control_points": corners[k : k + 3], "weights": [1, half, 1]} for k in (0, 2, 4, 6)]
    problem = refused(post(live, {"outer": disc, "options": {"method": "march"}}), 422).problems[0]
    assert problem.pointer == "/options/method"
    assert "discs" in problem.message


@pytest.mark.parametrize(("name", "value"), [("smooth_angle", 0.5), ("check_step", 0), ("method", "voronoi")])
def test_options_out_of_their_range(live: httpx2.Client, name: str, value: Any) -> None:
    response = post(live, {"outer": SQUARE, "options": {name: value}})
    assert refused(response, 422).problems[0].pointer == f"/options/{name}"


def test_a_duplicate_member_does_no_harm(live: httpx2.Client) -> None:
    body = json.dumps({"outer": SQUARE}).encode()
    assert post(live, b'{"outer": 3, ' + body[1:]).status_code == 200


def test_all_problems_come_at_once_each_with_its_place(live: httpx2.Client) -> None:
    outer = [dict(edge) for edge in SQUARE]
    outer[1] = outer[1] | {"weights": [1, 0]}
    outer[3] = outer[3] | {"knots": [0, 1]}
    document = refused(post(live, {"outer": outer}), 422)
    codes = {problem.pointer.split("/weights")[0].split("/knots")[0]: problem.code for problem in document.problems}
    assert codes["/outer/1"] == "non-positive-weight"
    assert codes["/outer/3"] == "invalid-spline"


def test_a_flood_of_problems_is_answered_by_a_short_list(live: httpx2.Client) -> None:
    body = b'{"outer": [' + b",".join([b"0"] * 200_000) + b"]}"
    response = post(live, body)
    refused(response, 422)
    assert len(response.content) < 1_000_000


def test_a_body_over_the_limit(live: httpx2.Client) -> None:
    assert refused(post(live, b" " * 4_000_001), 413).code == "body-too-large"


def test_a_body_in_another_coding_is_refused_and_told_which_one_is_read(live: httpx2.Client) -> None:
    response = live.post("/v1/mat", content=b"{}", headers=JSON | {"Content-Encoding": "br"})
    refused(response, 415)
    assert response.headers["accept-encoding"] == "gzip"


def test_a_compressed_body_is_solved_as_the_plain_one(live: httpx2.Client) -> None:
    body = EXAMPLES[0].read_bytes()
    response = live.post("/v1/mat", content=gzip.compress(body), headers=JSON | {"Content-Encoding": "gzip"})
    assert response.content == post(live, body).content


def test_a_bomb_is_too_large(live: httpx2.Client) -> None:
    bomb = gzip.compress(b" " * 50_000_000, 9)
    assert len(bomb) < 100_000
    response = live.post("/v1/mat", content=bomb, headers=JSON | {"Content-Encoding": "gzip"})
    assert refused(response, 413).code == "body-too-large"


def expected(response: httpx2.Response) -> None:
    """Hold that whatever was sent was solved or refused as the sender's fault."""
    if response.status_code != 200:
        assert response.status_code in (400, 422), response.text
        document = ProblemDocument.model_validate_json(response.text)
        assert document.problems or document.code in ("not-json", "too-complex")


@given(body=st.binary(max_size=200))
@RELAXED
def test_any_bytes(live: httpx2.Client, body: bytes) -> None:
    expected(post(live, body))


@given(body=anything)
@RELAXED
def test_any_json(live: httpx2.Client, body: Any) -> None:
    expected(post(live, body))


def fits_the_model(body: Any) -> bool:
    try:
        DomainRequest.model_validate_json(json.dumps(body))
    except ValidationError:
        return False
    return True


@given(body=damaged_domains())
@settings(RELAXED, max_examples=150)
def test_any_damage_to_a_domain_is_refused_at_least_where_the_model_refuses(live: httpx2.Client, body: Any) -> None:
    response = post(live, body)
    expected(response)
    if not fits_the_model(body):
        assert response.status_code == 422, response.text


def test_the_service_stays_small_and_answers_while_it_solves() -> None:
    """All of its processes together, shared pages counted once, stay under 400 MB after some work."""
    with serving() as client:
        for path in EXAMPLES:
            assert post(client, path.read_bytes()).status_code == 200
        begun = time.monotonic()
        assert client.get("/healthz").status_code == 200
        assert time.monotonic() - begun < 0.1
        mine = [pid for pid in service_processes() if owns_port(pid, client)]
        assert sum(proportional_bytes(pid) for pid in mine) < 400e6


def service_processes() -> dict[int, int]:
    """Processes of this machine and their parents."""
    from tests.service.processes import status

    return {int(e.name): status(int(e.name))[1] for e in Path("/proc").iterdir() if e.name.isdigit()}


def owns_port(pid: int, client: httpx2.Client) -> bool:
    """Whether a process is the server on the client's port, or belongs to it."""
    from tests.service.processes import status

    while pid > 1:
        try:
            if f"--port\0{client.base_url.port}\0" in Path(f"/proc/{pid}/cmdline").read_text():
                return True
        except OSError:
            return False
        pid = status(pid)[1]
    return False


def proportional_bytes(pid: int) -> int:
    """Resident memory of a process, shared pages divided among those that share them."""
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return 1024 * int(line.split()[1])
    raise AssertionError(f"{os.getpid()} may not read the memory of {pid}")
