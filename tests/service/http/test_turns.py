"""Whose turn it is, with a loop that only counts."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Callable
from typing import Any

from service.http.turns import REQUESTS, Turns


class Loop(asyncio.AbstractEventLoop):
    """Its time stands still."""

    def __init__(self) -> None:
        self.calls: list[tuple[Callable[..., Any], tuple[Any, ...]]] = []

    def time(self) -> float:
        return 0.0

    def call_soon(self, callback: Callable[..., Any], *args: Any, **_: Any) -> Any:
        self.calls.append((callback, args))

    def turn(self) -> bool:
        """One pass; whether there was something to do."""
        calls, self.calls = self.calls, []
        for callback, args in calls:
            callback(*args)
        return bool(calls)


class Client:
    """One that has so many slices, with a request in each or none."""

    def __init__(self, name: str, told: list[str], slices: int = 1, begins: bool = True) -> None:
        self.name, self.told, self.slices, self.begins = name, told, slices, begins

    def take_slice(self) -> tuple[bool, bool]:
        self.told.append(self.name)
        self.slices -= 1
        return self.slices > 0, self.begins


def test_all_have_their_turns_and_no_pass_begins_many() -> None:
    loop, turns, told = Loop(), Turns(), []
    for name in "abcde":
        turns.wait(Client(name, told, slices=2), loop)
    passes = [len(told)]
    while loop.turn():
        passes.append(len(told))
    assert told == list("abcdeabcde")
    assert max(b - a for a, b in itertools.pairwise(passes)) == REQUESTS


def test_what_begins_nothing_goes_on_in_the_same_pass() -> None:
    loop, turns, told = Loop(), Turns(), []
    turns.wait(Client("a", told, slices=50, begins=False), loop)
    assert loop.turn()
    assert told == ["a"] * 50
    assert not loop.turn()


def test_the_urgent_take_turns_with_the_others() -> None:
    loop, turns, told = Loop(), Turns(), []
    for name in "abc":
        turns.wait(Client(name, told), loop)
    for name in "XYZ":
        turns.wait(Client(name, told), loop, urgent=True)
    while loop.turn():
        pass
    assert told == list("XaYbZc")


def test_each_waits_once_and_may_leave() -> None:
    loop, turns, told = Loop(), Turns(), []
    a, b, c = (Client(name, told) for name in "abc")
    for client in (a, b, c, a, b):
        turns.wait(client, loop)
    turns.wait(c, loop, urgent=True)
    turns.wait(c, loop)
    turns.leave(b)
    assert turns.waits(a) and turns.waits(c) and not turns.waits(b)  # noqa: PT018
    while loop.turn():
        pass
    assert told == ["c", "a"]
    assert not turns.waits(a)
