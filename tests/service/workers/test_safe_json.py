"""Reading JSON where memory is denied, in processes that may come to harm."""

from __future__ import annotations

import os

import orjson
import pytest

from service.settings import MIB
from service.workers.process import limit_memory
from service.workers.safe_json import SMALL_BYTES, loads

REFUSED = 7

TEXTS = {
    "numbers": b"[" + b",".join([b"1.5"] * 400_000) + b"]",
    "large numbers": b"[" + b",".join([b"12345"] * 300_000) + b"]",
    "empty lists": b"[" + b",".join([b"[]"] * 400_000) + b"]",
    "short lists": b"[" + b",".join([b"[1]"] * 300_000) + b"]",
    "empty objects": b"[" + b",".join([b"{}"] * 400_000) + b"]",
    "short objects": b"[" + b",".join([b'{"":0}'] * 200_000) + b"]",
    "objects": b"[" + b",".join([b'{"degree":1,"control_points":[[0.1,0.2],[0.3,0.4]]}'] * 30_000) + b"]",
    "strings": b"[" + b",".join([b'"%d"' % k for k in range(200_000)]) + b"]",
    "other letters": b"[" + b",".join(['"ä日"'.encode()] * 200_000) + b"]",
    "other planes": b"[" + b",".join(['"😀%d"'.encode() % k for k in range(100_000)]) + b"]",
    "many keys": b"{" + b",".join([b'"%d":0' % k for k in range(100_000)]) + b"}",
}


def read_with(text: bytes, extra_bytes: int) -> int:
    """The exit code of a process that may claim so much while it reads."""
    child = os.fork()
    if child == 0:
        limit_memory(extra_bytes)
        try:
            loads(text)
        except MemoryError:
            os._exit(REFUSED)
        except BaseException:
            os._exit(1)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_memory_that_is_denied_is_an_error_and_never_an_end(text: bytes) -> None:
    codes = [read_with(text, megabytes * MIB) for megabytes in (1, 2, 4, 8, 16, 24, 32, 48, 64, 96, 256)]
    assert codes[0] == REFUSED
    assert codes[-1] == 0
    assert set(codes) == {0, REFUSED}


@pytest.mark.parametrize("text", [b"{}", b" [1] ", b"[1" * SMALL_BYTES, b"[" + b"1," * SMALL_BYTES + b"1]", b"", b"nul"])
def test_otherwise_it_is_the_reader_itself(text: bytes) -> None:
    try:
        expected = orjson.loads(text)
    except orjson.JSONDecodeError:
        with pytest.raises(orjson.JSONDecodeError, match="line"):
            loads(text)
    else:
        assert loads(text) == expected
