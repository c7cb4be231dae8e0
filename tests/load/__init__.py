"""Load and faults: the service under everything at once, and whether it keeps its promises.

::

    make load                                      everything, some minutes
    python -m tests.load --only calm faults        some of the parts
    python -m tests.load --short                   what the tests run

The command starts the service itself, as its operators do, on a free port of this machine, and drives it with glyphs, icons,
parts and huge domains. Every answer is compared, byte for byte, with what the library says. All parts are bounded in number
and time, and whatever was started is stopped.

At the end stands a table of figures and promises; the exit code is 1 when a promise was broken: a wrong answer, a request without
an answer, a lost job, a process that stayed behind, an answer that came too late.

    calm        small requests alone: throughput, latency, and the share that is not solving
    huge        small requests while four huge domains are being solved, health checks throughout
    endless     small requests beside a flow of small bodies that would take half a minute each
    flood       health checks beside clients that send as much as they can
    overload    more requests than may wait
    deadlines   work that takes longer than it may
    faults      workers killed, memory hogs, slow clients, clients that leave or do not read, bodies that are cut off
    batch       domains by the thousand: bare processes, the pool, and over HTTP
    resumed     a batch whose server is killed on the way, and what of it is computed again
    dismissed   running jobs dismissed: how soon their processors are free
    killed      the server killed again and again with jobs in flight
    machines    jobs by three machines on one PostgreSQL, all killed again and again and one of them for good
    database    PostgreSQL stopped for ten seconds with jobs in flight, where it is installed
    disk        the disk of bodies and results full for a while, where a small file system may be mounted
"""
