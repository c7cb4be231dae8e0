"""What an operator can set, all of it by ``MAT_*`` environment variables.

The port is deliberately not among them: Kubernetes sets ``<SERVICE>_PORT`` by itself, so a service called ``mat`` would
find an address in ``MAT_PORT``. The port belongs to the command that starts the server.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

from service.http.keys import ApiKeys, read_keys

KIB = 1024
MIB = 1024 * KIB

_ORIGIN = re.compile(r"https?://[a-z0-9.-]+(:\d{1,5})?|null")


class InvalidSetting(ValueError):
    """A ``MAT_*`` variable holds something that cannot be used; the message names it and says what is expected."""


def _integer(low: int, high: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        value = int(text)
        if not low <= value <= high:
            raise ValueError
        return value

    read.__doc__ = f"a whole number from {low} to {high}"
    return read


def _seconds(low: float, high: float) -> Callable[[str], float]:
    def read(text: str) -> float:
        value = float(text)
        if not low <= value <= high:
            raise ValueError
        return value

    read.__doc__ = f"a number of seconds from {low:g} to {high:g}"
    return read


def _level(text: str) -> str:
    """debug, info, warning or error"""
    if text.lower() not in ("debug", "info", "warning", "error"):
        raise ValueError
    return text.lower()


def _role(text: str) -> str:
    """all, api or worker"""
    if text.lower() not in ("all", "api", "worker"):
        raise ValueError
    return text.lower()


def _priority(text: str) -> str:
    """idle, low or normal"""
    if text.lower() not in ("idle", "low", "normal"):
        raise ValueError
    return text.lower()


def _name(text: str) -> str:
    """up to 64 letters, digits, dots, hyphens and underscores, or nothing at all"""
    if not re.fullmatch(r"[A-Za-z0-9._-]{0,64}", text):
        raise ValueError
    return text


def _database(text: str) -> str:
    """postgresql://USER:PASSWORD@HOST/DATABASE, sqlite:////PATH, or nothing at all"""
    if text and not re.match(r"(postgresql|sqlite)://", text):
        raise ValueError
    return text


def _state_folder() -> Path:
    """Where programs keep what should outlive a restart (XDG base directories); compose and the image say otherwise."""
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state") / "mat-core"


def _required_folder(text: str) -> Path:
    """A folder"""
    if not text:
        raise ValueError
    return Path(text)


def _truth(text: str) -> bool:
    """true or false"""
    if text.lower() not in ("true", "false"):
        raise ValueError
    return text.lower() == "true"


def _keys(text: str) -> ApiKeys:
    """sha256 digests in hexadecimal, each with a name before it if wanted (name:digest), separated by commas"""
    return read_keys(text)


def _origins(text: str) -> tuple[str, ...]:
    """origins such as https://tools.example.org, separated by commas, or * for every origin"""
    origins = tuple(part.strip() for part in text.split(",") if part.strip())
    if not all(origin == "*" or _ORIGIN.fullmatch(origin) for origin in origins):
        raise ValueError
    return origins


def _folder(text: str) -> Path | None:
    """A folder, or nothing at all"""
    return Path(text) if text else None


@dataclass(frozen=True, slots=True)
class Settings:
    """Every setting with its default; `from_environment` reads ``MAT_`` plus the field's name in capitals.

    Attributes
    ----------
    workers : int
        Domains solved at a time, so the number of cores to use. While jobs or long requests use all of them, one more process
        works for the requests that go before (`service.workers.lanes`), and one more is kept warm.
    long_priority : str
        How workers with long work (large bodies, jobs, all that takes more than a twentieth of a second of processor time) share
        processors with everything else.
        idle: they get what is left, so that small requests are as fast as ever; low: at least a tenth, which suits a machine
        whose processors other programs keep busy; normal: as much as the others.
    max_body_bytes : int
        Largest request body, counted as it arrives and, if it is compressed, again as it expands; a larger one is answered 413.
    max_edges, max_control_points : int
        Largest domain; a larger one is answered 422 too-complex.
    deadline_seconds : float
        Longest time from a request's arrival to its answer, waiting included; then its worker is killed.
    head_seconds : float
        How long a request's head may take, from the connection's beginning or from the answer before it; then the connection is
        closed, after a 408 where a part of a head has come.
    upload_seconds : float
        How long a request's body is waited for that comes at less than 16 KiB a second; then the answer is 408.
    download_seconds : float
        How long a client is waited for that takes its answer at less than 16 KiB a second; then its connection is closed.
    max_connections : int
        Connections that may be open. One more ends the one that has waited longest for a request; where none waits, it is
        answered 503 itself.
    traffic_bytes : int
        Memory for bodies and answers on their way. While all others hold more, no body is taken in and no answer handed on: both
        are a 503.
    queue_limit : int
        Requests that may wait for a worker in each lane but that of jobs; one more is answered 503 at once.
    worker_memory_bytes : int
        Address space a worker may claim beyond what it starts with; a larger demand is answered 422 too-complex.
    worker_recycle_bytes : int
        A worker whose resident size is above this after an answer is replaced, so that one big domain leaves no trace.
    worker_recycle_requests : int
        A worker that has answered so many requests or lines of a batch is replaced; 0: never.
    shutdown_notice_seconds : float
        How long requests are still taken after SIGTERM while /readyz says no: what a load balancer needs to notice.
    shutdown_drain_seconds : float
        Longest time that requests in flight are then given to end; whole seconds. The process is gone 12 s later at the latest
        (`service.server.ENDING_SECONDS`), whatever hangs.
    result_cache_bytes : int
        Memory for answers that are given again to the same request without solving; 0: none are kept.
    api_keys : tuple of ApiKey
        Who may use the service; nobody is asked where there are none.
    key_concurrency : int
        Requests that one key may have under way at a time; one more is answered 429; 0: as many as it likes.
    metrics_open : bool
        Whether /metrics is answered without a key, too.
    cors_origins : tuple of str
        Pages of these origins may use the service from a browser; ``*``: any page.
    log_level : str
        What is logged: debug (health checks, too), info (a line a request), warning or error.
    keep_failed_dir : Path or None
        Where the request bodies of not-certified answers are kept, named by content hash; empty: they are not kept.
    data_dir : Path
        Where jobs keep bodies and results, and the database unless there is another. All machines need the same one.
    database_url : str
        A PostgreSQL database for the rows of jobs; empty: a SQLite file in `data_dir`.
    role : str
        all: answers requests and runs jobs; api: makes jobs for others to run; worker: runs jobs for others.
    executor_id : str
        The name under which jobs are run; no two machines may have the same. Empty: the host's name.
    job_deadline_seconds : float
        Longest time that a job which is no batch may be worked on.
    job_retention_seconds : float
        How long jobs are kept after they ended, with their files.
    batch_chunk : int
        Most domains of a batch that are worked on at a time, and done again after a crash.
    max_batch_bytes : int
        Largest body of a batch; each of its lines is held to `max_body_bytes`.
    """

    workers: int = field(default=2, metadata={"read": _integer(1, 256)})
    long_priority: str = field(default="idle", metadata={"read": _priority})
    max_body_bytes: int = field(default=16 * MIB, metadata={"read": _integer(KIB, 1024 * MIB)})
    deadline_seconds: float = field(default=30.0, metadata={"read": _seconds(0.05, 86_400)})
    head_seconds: float = field(default=15.0, metadata={"read": _seconds(0.05, 86_400)})
    upload_seconds: float = field(default=30.0, metadata={"read": _seconds(0.05, 86_400)})
    download_seconds: float = field(default=30.0, metadata={"read": _seconds(0.05, 86_400)})
    max_connections: int = field(default=1000, metadata={"read": _integer(1, 1_000_000)})
    traffic_bytes: int = field(default=256 * MIB, metadata={"read": _integer(KIB, 1024 * 1024 * MIB)})
    queue_limit: int = field(default=64, metadata={"read": _integer(0, 100_000)})
    worker_memory_bytes: int = field(default=1024 * MIB, metadata={"read": _integer(64 * MIB, 1024 * 1024 * MIB)})
    worker_recycle_bytes: int = field(default=512 * MIB, metadata={"read": _integer(64 * MIB, 1024 * 1024 * MIB)})
    worker_recycle_requests: int = field(default=10_000, metadata={"read": _integer(0, 1_000_000_000)})
    shutdown_notice_seconds: float = field(default=0.0, metadata={"read": _seconds(0, 3600)})
    shutdown_drain_seconds: float = field(default=20.0, metadata={"read": _seconds(0, 86_400)})
    max_edges: int = field(default=500_000, metadata={"read": _integer(1, 10**8)})
    max_control_points: int = field(default=2_000_000, metadata={"read": _integer(2, 10**8)})
    result_cache_bytes: int = field(default=32 * MIB, metadata={"read": _integer(0, 1024 * 1024 * MIB)})
    api_keys: ApiKeys = field(default=(), metadata={"read": _keys})
    key_concurrency: int = field(default=0, metadata={"read": _integer(0, 100_000)})
    metrics_open: bool = field(default=False, metadata={"read": _truth})
    cors_origins: tuple[str, ...] = field(default=(), metadata={"read": _origins})
    log_level: str = field(default="info", metadata={"read": _level})
    keep_failed_dir: Path | None = field(default=None, metadata={"read": _folder})
    data_dir: Path = field(default_factory=_state_folder, metadata={"read": _required_folder})
    database_url: str = field(default="", metadata={"read": _database}, repr=False)  # it may hold a password
    role: str = field(default="all", metadata={"read": _role})
    executor_id: str = field(default="", metadata={"read": _name})
    job_deadline_seconds: float = field(default=3600.0, metadata={"read": _seconds(0.05, 7 * 86_400)})
    job_retention_seconds: float = field(default=7 * 86_400.0, metadata={"read": _seconds(1.0, 3650 * 86_400)})
    batch_chunk: int = field(default=500, metadata={"read": _integer(1, 100_000)})
    max_batch_bytes: int = field(default=1024 * MIB, metadata={"read": _integer(KIB, 1024 * 1024 * MIB)})

    @classmethod
    def from_environment(cls, environment: Mapping[str, str] | None = None) -> Settings:
        """Read the settings.

        Parameters
        ----------
        environment : mapping of str to str, optional
            Where to read them; the process's own environment when left out.

        Raises
        ------
        InvalidSetting
            Naming the first variable that cannot be used, and what it should hold.
        """
        source = os.environ if environment is None else environment
        given = {}
        for item in fields(cls):
            name = variable(item.name)
            if name not in source:
                continue
            read = item.metadata["read"]
            try:
                given[item.name] = read(source[name].strip())
            except ValueError:
                raise InvalidSetting(f"{name} is {source[name]!r}; expected {read.__doc__}") from None
        return cls(**given)


def variable(field_name: str) -> str:
    """The environment variable of a field of `Settings`."""
    return f"MAT_{field_name.upper()}"
