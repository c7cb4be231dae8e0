"""Which processes are counted."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from service.observability.processes import resident_bytes

THREADS = 100


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="there is no /proc here")
def test_a_thread_that_ends_meanwhile_hides_no_process() -> None:
    over = [threading.Event() for _ in range(THREADS)]
    waiting = [threading.Thread(target=event.wait) for event in over]
    for thread in waiting:
        thread.start()
    started, done = threading.Event(), threading.Event()

    def start_a_process() -> None:
        with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as child:
            started.set()
            done.wait()
            child.kill()

    parent = threading.Thread(target=start_a_process)  # the last of the threads to be looked at
    parent.start()
    try:
        started.wait()
        counts = []
        for event in over:
            event.set()
            counts.append(len(resident_bytes()["nursery"]))
    finally:
        done.set()
        for event in over:
            event.set()
        for thread in (parent, *waiting):
            thread.join()
    assert min(counts) >= 1
