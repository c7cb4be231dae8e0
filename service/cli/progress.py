"""What a person at a terminal sees while it takes long; nothing where standard error goes elsewhere."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator

PATIENCE_SECONDS = 2.0
"""What takes less needs no words."""

SHOWN_SECONDS = 0.5


@contextlib.contextmanager
def waiting(what: str) -> Iterator[Callable[[str], None]]:
    """Show what is going on and for how long; kernels run without the interpreter's lock, so this thread may.

    Yields a function that takes what is going on now.
    """
    stage = _Stage(what)
    if not sys.stderr.isatty():
        yield stage.enter
        return
    thread = threading.Thread(target=stage.show, daemon=True)
    thread.start()
    try:
        yield stage.enter
    finally:
        stage.done.set()
        thread.join()


class _Stage:
    """What is going on, and the thread that shows it."""

    def __init__(self, what: str) -> None:
        self._what = what
        self.done = threading.Event()

    def enter(self, what: str) -> None:
        """Something else begins."""
        self._what = what

    def show(self) -> None:
        """Write one line again and again, and take it away in the end."""
        begun = time.monotonic()
        if self.done.wait(PATIENCE_SECONDS):
            return
        while not self.done.wait(SHOWN_SECONDS):
            sys.stderr.write(f"\r{self._what} {time.monotonic() - begun:.0f} s\x1b[K")
            sys.stderr.flush()
        sys.stderr.write("\r\x1b[K")
