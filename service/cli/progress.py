"""What a person at a terminal sees while it takes long; nothing where standard error goes elsewhere."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Iterator

PATIENCE_SECONDS = 2.0
"""What takes less needs no words."""


@contextlib.contextmanager
def waiting(what: str) -> Iterator[None]:
    """Show for how long something has been going on; kernels run without the interpreter's lock, so this thread may."""
    if not sys.stderr.isatty():
        yield
        return
    done = threading.Event()
    thread = threading.Thread(target=_count, args=(what, done), daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _count(what: str, done: threading.Event) -> None:
    begun = time.monotonic()
    if done.wait(PATIENCE_SECONDS):
        return
    while not done.wait(0.5):
        sys.stderr.write(f"\r{what} {time.monotonic() - begun:.0f} s")
        sys.stderr.flush()
    sys.stderr.write("\r\x1b[K")
