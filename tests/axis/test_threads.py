"""Large domains are solved on several threads, as many as are allowed, and the answer does not depend on how many."""

from __future__ import annotations

import os
import threading
from typing import Any

import numpy as np
import pytest

from benchmarks.shapes import LARGE
from mat_core import Domain, MedialAxis, NotCertified, UnsupportedOption, medial_axis, threads
from mat_core.pipeline import STAGES
from mat_core.threads import VARIABLE, Bounds, cut, cut_between, each, threads_allowed
from mat_core.topology import solving
from mat_core.topology.discs import NO_PARTNER
from tests.families import CATALOGUE, ngon

Json = dict[str, Any]
FAMILIES = (*LARGE, "ngon")


def domain(shaped: Json) -> Domain:
    return Domain.from_dict({"outer": shaped["outer"], "holes": shaped["holes"]})


def large(family: str, edges: int) -> Domain:
    return domain(ngon(edges) if family == "ngon" else LARGE[family](edges))


def shape_of(axis: MedialAxis) -> list[int]:
    """What parts must not change: how many nodes of each kind, segments, cycles, faces."""
    kinds = [int((axis.runs.node_kind == kind).sum()) for kind in range(5)]
    return [*kinds, len(axis.curves.degree), axis.runs.cycles, axis.skeleton.faces]


@pytest.mark.parametrize("family", FAMILIES)
def test_the_answer_is_the_same_on_any_number_of_threads(family: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where stages end in the middle of a part, and a part is one large face."""
    d = large(family, 600)
    whole = medial_axis(d, 1e-5)
    for size in (37, 256):
        monkeypatch.setattr(threads, "PART", size)
        alone = medial_axis(d, 1e-5, threads=1)
        assert shape_of(alone) == shape_of(whole)
        answer = alone.to_json(samples=True)
        for count in (2, 3):
            assert medial_axis(d, 1e-5, threads=count).to_json(samples=True) == answer


@pytest.mark.parametrize("family", ["comb", "plate with round holes", "wave of smooth curves"])
def test_domains_of_many_parts_as_they_come(family: str) -> None:
    d = large(family, 2 * threads.PART)
    answers = {medial_axis(d, 1e-5, threads=count).to_json() for count in (1, 2, 3)}
    assert len(answers) == 1


def test_a_small_domain_starts_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "ThreadPoolExecutor", None)
    assert medial_axis(domain(CATALOGUE["gear"]()), threads=8).certificate["passed"]


def test_one_thread_is_the_callers_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "PART", 16)
    monkeypatch.setattr(threads, "ThreadPoolExecutor", None)
    d = domain(CATALOGUE["gear"]())
    assert medial_axis(d, threads=1).certificate["passed"]
    monkeypatch.setenv(VARIABLE, "1")
    assert medial_axis(d).certificate["passed"]
    with pytest.raises(TypeError):  # there is no pool to ask
        medial_axis(d, threads=2)


def test_parts_run_at_a_time_on_no_more_threads_than_allowed() -> None:
    meeting = threading.Barrier(3, timeout=30.0)
    names = set()

    def work(part: Bounds) -> int:
        names.add(threading.current_thread().name)
        meeting.wait()  # passed only when three are here
        return part[0]

    before = threading.active_count()
    assert each(work, [(begin, begin + 1) for begin in range(9)], 3) == list(range(9))
    assert len(names) == 3
    assert threading.active_count() == before


def test_what_bounds_the_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert 1 <= threads_allowed(None) <= (os.cpu_count() or 1)
    monkeypatch.setenv(VARIABLE, " 3 ")
    assert threads_allowed(None) == 3
    assert threads_allowed(2) == 2
    for wrong in ("0", "-1", "two", "1.5"):
        monkeypatch.setenv(VARIABLE, wrong)
        with pytest.raises(UnsupportedOption, match=VARIABLE):
            threads_allowed(None)
    for given in (0, -1, True, 1.5, "2"):
        with pytest.raises(UnsupportedOption) as refused:
            medial_axis(domain(CATALOGUE["rectangle"]()), threads=given)  # type: ignore[arg-type]
        assert refused.value.option == "threads"


def test_an_error_of_a_thread_is_raised_and_leaves_nothing_running() -> None:
    before = threading.active_count()
    done = []

    def work(part: Bounds) -> None:
        if part[0] == 1:
            raise MemoryError
        done.append(part[0])

    with pytest.raises(MemoryError):
        each(work, [(begin, begin + 1) for begin in range(100)], 2)
    assert threading.active_count() == before
    assert 1 not in done


def test_a_part_that_fails_names_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "PART", 64)
    failing = 11

    def fails_there(steps: int, *rest: Any) -> Any:
        told = solve(steps, *rest)
        return (NO_PARTNER, *told[1:5], failing, told[6]) if steps == solving.SOLVE else told

    solve = solving.solve_faces
    monkeypatch.setattr(solving, "solve_faces", fails_there)
    d = large("comb", 400)
    before = threading.active_count()
    with pytest.raises(NotCertified, match="branch point was not found") as failed:
        medial_axis(d, threads=3)
    assert failed.value.place is not None
    assert threading.active_count() == before


def test_progress_is_told_on_the_callers_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "PART", 64)
    told = []

    def progress(stage: str, share: float) -> None:
        assert threading.current_thread() is threading.main_thread()
        told.append((stage, share))

    medial_axis(large("comb", 400), progress=progress, threads=3)
    assert told == list(STAGES.items())


def test_a_process_that_has_solved_on_threads_may_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "PART", 64)
    d = large("comb", 400)
    answer = medial_axis(d, threads=2).to_json()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            status = 0 if medial_axis(d, threads=2).to_json() == answer else 2
        finally:
            os._exit(status)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_parts_cover_everything_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "PART", 10)
    assert cut(0) == [(0, 0)]
    assert cut(10) == [(0, 10)]
    assert cut(25) == [(0, 10), (10, 20), (20, 25)]
    rng = np.random.default_rng(1)
    for n in (1, 10, 11, 40, 1000):
        for many in (1, n // 7 + 1, n):
            begins = np.unique(np.append(0, rng.integers(0, n, many)))
            parts = cut_between(begins, n)
            assert [part[0] for part in parts] == [0, *(part[1] for part in parts[:-1])]
            assert parts[-1][1] == n
            assert {part[0] for part in parts} <= set(begins.tolist())
            assert n > 10 or len(parts) == 1
