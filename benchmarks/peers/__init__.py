"""Side by side with other medial axis programs: `python -m benchmarks.peers`, or `make bench-peers`.

    cases ──> exports ──> a process per peer, shape and tolerance ──> quality ──> document
    shapes    chords,      boost_voronoi.cpp, run_pyvoronoi.py,        distance    docs/performance.md
              curves       run_open_cascade.py, run_flo_mat.mjs,       from the
                           run_scikit_image.py                         true axis

Peers live in an environment of their own under `.bench/` (`environment.py`); neither the library nor its tests need them.
"""
