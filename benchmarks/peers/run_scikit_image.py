"""scikit-image's medial_axis on a picture: `python -m benchmarks.peers.run_scikit_image CHORDS BUDGET RUNS [POLYLINES]`.

The shape is PIXELS across, with a margin round it; what is kept are pixels, written as polylines of one point.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from skimage.morphology import medial_axis

from benchmarks.timing import timed

PIXELS = 1024
MARGIN = 2  # pixels: what lies beyond the picture is not taken as outside
GRID = 2**31  # steps of the chords' grid across the domain, nearly


def main() -> None:
    path, budget, most = Path(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    data = path.read_bytes()
    at = 8
    drawn = Image.new("1", 2 * (PIXELS + 2 * MARGIN,))
    pen = ImageDraw.Draw(drawn)
    for loop in range(int(np.frombuffer(data, np.int64, 1)[0])):
        count = int(np.frombuffer(data, np.int64, 1, at)[0])
        rows = np.frombuffer(data, np.int32, 3 * count, at + 8).reshape(-1, 3)
        at += 8 + 12 * count
        corners = (rows[:, 1::-1] / GRID + 0.5) * PIXELS - 0.5 + MARGIN  # its first axis, rows, is x
        pen.polygon([tuple(c) for c in corners.tolist()], fill=int(loop == 0))
    picture = np.asarray(drawn)
    measured = timed(lambda: medial_axis(picture, rng=0), budget, most)
    kept = np.argwhere(measured.result)
    if len(sys.argv) > 4:
        places = ((kept + 0.5 - MARGIN) / PIXELS - 0.5) * GRID
        Path(sys.argv[4]).write_bytes(np.column_stack([np.ones(len(places)), places]).tobytes())
    print(json.dumps({"ms": measured.ms, "runs": measured.runs, "kept": len(kept), "given": PIXELS}))


if __name__ == "__main__":
    main()
