"""Every error this library raises on purpose.

    MatError
    |-- InvalidDomain (also ValueError)       the input breaks rules of a valid domain: .problems, all of them
    |-- UnreadableInput (also ValueError)     a file or text of outlines or an answer is not what it should be
    |-- UnsupportedOption (also ValueError)   an option of the call is unknown or out of its range: .option
    `-- NotCertified                          an axis was found but failed its own check: .place, .certificate, .detail

Anything else that escapes is a defect of the library.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields


class MatError(Exception):
    """Base of all errors of this library; catch it to catch them all."""


@dataclass(frozen=True, slots=True)
class Problem:
    """One broken rule of the input: what is wrong, where, and how to mend it.

    Parameters
    ----------
    code : str
        Stable name of the rule, one of `mat_core.model.problems.CODES`.
    pointer : str
        JSON pointer (RFC 6901) into the domain object, such as ``/holes/0/2/weights/1``.
    message : str
        A sentence for people: what was found, where, and what to do.
    loop, edge : int, optional
        Loop (0 outer, i is ``holes[i-1]``) and edge in that loop.
    u : float, optional
        Parameter on that edge, in the edge's own knots.
    x, y : float, optional
        The place in the caller's coordinates.
    other : str, optional
        JSON pointer of the second edge or loop when two are in each other's way.
    """

    code: str
    pointer: str
    message: str
    loop: int | None = None
    edge: int | None = None
    u: float | None = None
    x: float | None = None
    y: float | None = None
    other: str | None = field(default=None)

    def to_dict(self) -> dict[str, object]:
        """The members that are known, ready for JSON."""
        values = ((f.name, getattr(self, f.name)) for f in fields(self))
        return {name: value for name, value in values if value is not None}


class InvalidDomain(MatError, ValueError):
    """The input is not a valid domain.

    Parameters
    ----------
    problems : iterable of Problem
        Every broken rule that was found, in the order of the document.

    Attributes
    ----------
    problems : tuple of Problem
        The same, at least one.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = tuple(problems)
        super().__init__(self.problems)

    def __str__(self) -> str:
        shown = [f"{p.pointer or '/'} [{p.code}] {p.message}" for p in self.problems[:5]]
        more = len(self.problems) - len(shown)
        if more > 0:
            shown.append(f"and {more} more in .problems")
        return "\n".join(shown)

    def __reduce__(self) -> tuple[type[InvalidDomain], tuple[tuple[Problem, ...]]]:
        return InvalidDomain, (self.problems,)


class UnreadableInput(MatError, ValueError):
    """A file or text that outlines or an answer are read from is not what it should be; the message says what, and where."""


class UnsupportedOption(MatError, ValueError):
    """An option of a call is unknown or out of its range.

    Parameters
    ----------
    option : str
        Name of the option.
    message : str
        What was given and what is allowed.
    """

    def __init__(self, option: str, message: str) -> None:
        self.option = option
        super().__init__(option, message)

    def __str__(self) -> str:
        return f"{self.option}: {self.args[1]}"


class NotCertified(MatError):
    """An axis was computed but did not pass its certificate, so it is not returned.

    Parameters
    ----------
    detail : str
        Which check failed and by how much.
    place : tuple of float, optional
        Where, (x, y) in the caller's coordinates.
    certificate : mapping, optional
        The failing certificate: each check with its figure and its limit.
    """

    def __init__(
        self,
        detail: str,
        place: tuple[float, float] | None = None,
        certificate: Mapping[str, object] | None = None,
    ) -> None:
        self.detail = detail
        self.place = place
        self.certificate: dict[str, object] = dict(certificate or {})
        super().__init__(detail, place, self.certificate)

    def __str__(self) -> str:
        where = f" at ({self.place[0]:.9g}, {self.place[1]:.9g})" if self.place is not None else ""
        return f"the axis failed its certificate{where}: {self.detail}"
