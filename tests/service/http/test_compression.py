from __future__ import annotations

import gzip
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.errors import RequestError
from service.http.compression import MOST_MEMBERS, Expander, compress

LIMIT = 1 << 20


def expand(stream: bytes, piece: int = 64, limit: int = LIMIT) -> bytes:
    expander = Expander(limit)
    found = b"".join(expander.feed(stream[i : i + piece]) for i in range(0, len(stream), piece))
    expander.finish()
    return found


def refused(stream: bytes, limit: int = LIMIT) -> str:
    with pytest.raises(RequestError) as refusal:
        expand(stream, limit=limit)
    return refusal.value.code


@given(contents=st.lists(st.binary(max_size=500), min_size=1, max_size=4), piece=st.integers(1, 300))
def test_what_was_compressed_comes_back_whatever_the_pieces(contents: list[bytes], piece: int) -> None:
    """Several members in a row are one file (RFC 1952)."""
    assert expand(b"".join(map(gzip.compress, contents)), piece) == b"".join(contents)


def test_the_same_content_is_the_same_stream() -> None:
    assert compress(b"abc" * 1000) == compress(b"abc" * 1000)
    assert gzip.decompress(compress(b"abc" * 1000)) == b"abc" * 1000


def test_the_limit_is_exact() -> None:
    assert len(expand(gzip.compress(bytes(1000)), limit=1000)) == 1000
    assert refused(gzip.compress(bytes(1001)), limit=1000) == "body-too-large"


def test_a_bomb_is_never_expanded_beyond_its_limit() -> None:
    bomb = gzip.compress(bytes(200 << 20), 9)
    expander = Expander(LIMIT)
    with pytest.raises(RequestError):
        expander.feed(bomb)
    assert len(expander._member.unconsumed_tail) > len(bomb) // 2


def test_many_small_bombs_count_together() -> None:
    assert refused(gzip.compress(bytes(LIMIT // 10)) * 11) == "body-too-large"


@pytest.mark.parametrize(
    "stream",
    [
        b"",
        b"{}",
        b"\x1f\x8b",
        gzip.compress(b"{}")[:-1],
        gzip.compress(b"{}")[:-8] + bytes(8),
        gzip.compress(b"{}") + b"{}",
        gzip.compress(b"{}") + bytes(5),
        zlib.compress(b"{}"),
        gzip.compress(b"") * (MOST_MEMBERS + 1),
    ],
    ids=["nothing", "plain", "a header", "cut off", "wrong sum", "followed", "padded", "zlib", "crumbs"],
)
def test_what_is_no_gzip(stream: bytes) -> None:
    assert refused(stream) == "not-gzip"
