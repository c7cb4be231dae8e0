"""Every figure that the service gives to Prometheus, in a registry of its own.

Counters and histograms are fed as requests end; what is a state (the queue, the workers, memory) is read when it is asked for.
Label values are bounded: routes are templates of the router, never paths of clients, codes are those of `service.errors`, and
sizes fall into few classes. docs/runbook.md has the table of all names, and docker/alerts.yaml the alerts on them.
"""

from __future__ import annotations

import platform
from collections.abc import Iterator, Mapping
from typing import Protocol, get_args

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, ProcessCollector
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric

from service import __version__
from service.jobs.port import State
from service.observability.processes import resident_bytes
from service.settings import KIB, MIB

REQUEST_SECONDS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 300.0)
WORK_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 300.0)
SIZE_CLASSES = ((4 * KIB, "4KiB"), (64 * KIB, "64KiB"), (256 * KIB, "256KiB"), (4 * MIB, "4MiB"))
"""Bodies up to a size, by the name of the class; about 8, 130, 500 and 8,000 edges. The third is where the large lane begins."""

LARGEST = "larger"
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
"""Other methods are counted as OTHER: a client may invent as many as it likes."""

SUCCESS = "ok"
"""What stands for the code of an answer that is no problem."""


class PoolFigures(Protocol):
    """What the pool says of itself (`service.workers.pool`)."""

    @property
    def busy(self) -> int:
        """Workers with a request."""

    @property
    def idle(self) -> int:
        """Workers that wait for one."""

    @property
    def running(self) -> Mapping[str, int]:
        """Requests at work, by lane."""

    @property
    def waiting(self) -> Mapping[str, int]:
        """Requests that wait for a worker, by lane."""

    @property
    def kills(self) -> Mapping[str, int]:
        """Workers that were ended or ended by themselves, by reason, since the start."""


class ConnectionFigures(Protocol):
    """What is told of connections (`service.http.connections`)."""

    @property
    def open(self) -> int:
        """How many there are."""

    @property
    def ended(self) -> Mapping[str, int]:
        """How many the service ended, by reason, since the start."""


class TrafficFigures(Protocol):
    """What is told of bodies and answers on their way (`service.http.traffic`)."""

    @property
    def held(self) -> int:
        """Bytes that they take."""


class Watched(Protocol):
    """The pool, as far as its figures go."""

    @property
    def about(self) -> Mapping[str, str]:
        """Versions, once the workers are loaded."""

    @property
    def ready(self) -> bool:
        """Whether the workers are loaded."""

    def stats(self) -> PoolFigures:
        """The figures of this moment."""


class Metrics:
    """The figures of one application.

    Attributes
    ----------
    registry : prometheus_client.CollectorRegistry
        Where they are collected from.
    """

    def __init__(self, pool: Watched, connections: ConnectionFigures, traffic: TrafficFigures) -> None:
        self.registry = CollectorRegistry()
        self._requests = Counter(
            "mat_requests", "Requests answered.", ("route", "method", "status", "code"), registry=self.registry
        )
        self._seconds = Histogram(
            "mat_request_duration_seconds", "Seconds from a request's first byte to its answer's last.", ("route",),
            buckets=REQUEST_SECONDS, registry=self.registry,
        )  # fmt: skip
        self._in_flight = Gauge("mat_requests_in_flight", "Requests that are being answered now.", registry=self.registry)
        self._bytes_in = Counter("mat_request_body_bytes", "Bytes of request bodies read.", registry=self.registry)
        self._bytes_out = Counter("mat_response_body_bytes", "Bytes of answers sent.", registry=self.registry)
        self._queue = Histogram(
            "mat_queue_wait_seconds", "Seconds that requests waited for a worker.",
            buckets=WORK_SECONDS, registry=self.registry,
        )  # fmt: skip
        self._solve = Histogram(
            "mat_solve_duration_seconds", "Seconds of solving, by the size of the body.", ("size",),
            buckets=WORK_SECONDS, registry=self.registry,
        )  # fmt: skip
        self._jobs = Gauge("mat_jobs", "Jobs that are kept, by state.", ("state",), registry=self.registry)
        self.registry.register(StateCollector(pool, connections, traffic))
        ProcessCollector(registry=self.registry)

    def begin(self) -> None:
        """Count a request that has come in."""
        self._in_flight.inc()

    def observe_request(self, route: str, method: str, status: int, code: str, seconds: float) -> None:
        """Count a request that has been answered."""
        self._in_flight.dec()
        self._requests.labels(route, method if method in METHODS else "OTHER", status, code).inc()
        self._seconds.labels(route).observe(seconds)

    def observe_transfer(self, bytes_in: int, bytes_out: int) -> None:
        """Count what was read and written."""
        self._bytes_in.inc(bytes_in)
        self._bytes_out.inc(bytes_out)

    def observe_work(self, queue_seconds: float, solve_seconds: float | None, body_bytes: int) -> None:
        """Count what a worker did; a request that was refused by its worker has no solving."""
        self._queue.observe(queue_seconds)
        if solve_seconds is not None:
            self._solve.labels(size_class(body_bytes)).observe(solve_seconds)

    def set_jobs(self, counts: Mapping[str, int]) -> None:
        """Note how many jobs there are in each state; one that is not named has none."""
        for state in get_args(State):
            self._jobs.labels(state).set(counts.get(state, 0))


def size_class(body_bytes: int) -> str:
    """The class that a body falls into."""
    return next((name for limit, name in SIZE_CLASSES if body_bytes <= limit), LARGEST)


class StateCollector:
    """The figures that are read when they are asked for."""

    def __init__(self, pool: Watched, connections: ConnectionFigures, traffic: TrafficFigures) -> None:
        self._pool, self._connections, self._traffic = pool, connections, traffic

    def collect(self) -> Iterator[Metric]:
        """All of them, once."""
        figures = self._pool.stats()
        yield _gauge("mat_queue_depth", "Requests that wait for a worker.", "lane", figures.waiting)
        yield _gauge("mat_workers_busy", "Workers at work.", "lane", figures.running)
        yield GaugeMetricFamily("mat_workers_idle", "Workers that wait for a request.", figures.idle)
        kills = CounterMetricFamily("mat_worker_kills", "Workers that were ended, or ended by themselves.", labels=("reason",))
        for reason, count in figures.kills.items():
            kills.add_metric((reason,), count)
        yield kills
        yield GaugeMetricFamily("mat_connections", "Connections that are open.", self._connections.open)
        ended = CounterMetricFamily("mat_connections_ended", "Connections that the service ended early.", labels=("reason",))
        for reason, count in self._connections.ended.items():
            ended.add_metric((reason,), count)
        yield ended
        yield GaugeMetricFamily("mat_traffic_bytes", "Bodies and answers that are held in memory.", self._traffic.held)
        yield GaugeMetricFamily("mat_ready", "1 when the workers are loaded.", int(self._pool.ready))
        memory = resident_bytes()
        yield _gauge("mat_processes", "Processes of the service.", "role", {role: len(all_) for role, all_ in memory.items()})
        total = {role: sum(sizes) for role, sizes in memory.items()}
        yield _gauge("mat_resident_memory_bytes", "Resident memory of all processes of a role.", "role", total)
        build = GaugeMetricFamily("mat_build_info", "1; its labels say what runs.", labels=("service", "algorithm", "python"))
        build.add_metric((__version__, self._pool.about.get("algorithm", "unknown"), platform.python_version()), 1)
        yield build

    def describe(self) -> Iterator[Metric]:
        """Nothing: what is registered is not asked before the pool runs."""
        return iter(())


def _gauge(name: str, text: str, label: str, values: Mapping[str, int]) -> GaugeMetricFamily:
    """A gauge with one label."""
    family = GaugeMetricFamily(name, text, labels=(label,))
    for value, figure in values.items():
        family.add_metric((value,), figure)
    return family
