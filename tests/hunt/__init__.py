"""The machine that looks for the next failure.

    python -m tests.hunt                                   all generated families, 100 domains each
    python -m tests.hunt --only 'noise_*' --count 500      some of them (quoted patterns)
    python -m tests.hunt --only star --seed 17 --count 1   one domain: its family and its seed say all of it
    python -m tests.hunt --fonts FOLDER --icons FOLDER     glyphs and icons: --count of each font file and icon folder
    python -m tests.hunt --lines FILE                      domains, one a line, .gz or not
    make hunt ARGS="--count 500 --worst"                   the same by make

Every domain is solved in a process that is killed after --limit seconds. It must come out certified, with as many cycles as
holes; a share of them (--oracle) is compared with the slow oracle of `tests.assertions`.

    certified   as it must be
    invalid     refused by `Domain`: no failure, but for generated families worth a look (crossings by large noise apart)
    failed      not certified, an exception, or a worker that died
    wrong       certified, but the oracle says otherwise
    slow        over the time limit

A failure is made smaller while it fails in the same way, and written to out/hunt as a line for tests/corpus/regressions.jsonl.gz.
out/hunt/journal.jsonl has the outcome of every domain; --resume skips what is in it. The exit code is 1 when anything failed.

`draw` (with `noise`, `trades` and `curves`) makes the domains, `outlines` reads them; `judge` solves one, `team` does so in
processes, `run` leads, `reduce` makes smaller, `journal` remembers, `report` tells. `invariance` is another hunt: for shapes
whose axis depends on how they are placed and described.
"""
