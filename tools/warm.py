"""Compiles every kernel into Numba's cache, with a line for each step; the image runs it when it is built."""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import mat_core


def main() -> None:
    """Compile, and say how long it took."""
    begun = time.monotonic()
    mat_core.warm(progress=lambda name, done, total: print(f"kernels: {done} of {total} ({name})", flush=True))
    print(f"kernels ready after {time.monotonic() - begun:.1f} s")


if __name__ == "__main__":
    main()
