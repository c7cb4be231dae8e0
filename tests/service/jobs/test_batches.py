"""How a body of lines is cut into chunks."""

from __future__ import annotations

import asyncio
import hashlib
import tempfile
import time
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.jobs import batches
from service.jobs.batches import LAST_PARTS, LEAST_BYTES, LEAST_DOMAINS, Reader
from service.jobs.blobs import Blobs
from service.jobs.calls import Calls
from service.jobs.port import BatchRefused, StoreUnavailable
from service.jobs.store import Chunk
from service.settings import KIB, MIB, Settings


def cut(pieces: Sequence[bytes], folder: Path, **settings: int) -> tuple[str, list[tuple[Chunk, bytes]]]:
    """The digest of a body, and its chunks with what is stored of each."""

    async def run() -> tuple[str, list[tuple[Chunk, bytes]]]:
        blobs = Blobs(folder)
        blobs.open()
        with blobs.folder() as incoming:
            reader = Reader(Settings(**{"workers": 2, **settings}), blobs, Calls(), incoming)
            digest = await reader.read(_body(pieces))
            await reader.store()
        return digest, [(chunk, blobs.read(chunk.body)) for chunk in reader.chunks]

    return asyncio.run(run())


async def _body(pieces: Sequence[bytes]) -> AsyncIterator[bytes]:
    for piece in pieces:
        yield piece


LINES = st.lists(st.sampled_from([b"", b" ", b"\r", b"{}", b'{"a": 1}\r', b"x" * 30]), max_size=40)


@given(LINES, st.booleans(), st.integers(1, 9), st.integers(1, 7))
def test_every_line_is_in_one_chunk_at_its_number(lines: list[bytes], ended: bool, chunk: int, step: int) -> None:
    body = b"\n".join(lines) + b"\n" * ended
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(batches, "LEAST_DOMAINS", 2)
        patch.setattr(batches, "LEAST_BYTES", 10)
        pieces = [body[k : k + step] for k in range(0, len(body), step)]
        if not body.strip():
            with pytest.raises(BatchRefused):
                cut(pieces, Path(folder), batch_chunk=chunk)
            return
        digest, chunks = cut(pieces, Path(folder), batch_chunk=chunk)
    assert digest == hashlib.sha256(body).hexdigest()
    assert [part.number for part, _ in chunks] == list(range(len(chunks)))
    placed: dict[int, bytes] = {}
    for part, content in chunks:
        found = {part.first + k: line for k, line in enumerate(content.split(b"\n")) if line.strip()}
        assert not placed.keys() & found.keys()
        assert part.domains == len(found) <= chunk
        assert hashlib.sha256(content).hexdigest() == part.body
        placed |= found
    assert placed == {k: line for k, line in enumerate(body.split(b"\n")) if line.strip()}


def domains(of: list[tuple[Chunk, bytes]]) -> list[int]:
    return [chunk.domains for chunk, _ in of]


def test_the_end_is_cut_finer_for_every_worker(tmp_path: Path) -> None:
    _, chunks = cut([b"{}\n" * 2530], tmp_path, batch_chunk=500)
    assert domains(chunks) == [500] * 4 + [67] * 7 + [61]
    _, chunks = cut([b"{}\n" * 400], tmp_path, batch_chunk=500, workers=4)
    assert domains(chunks) == [25] * 16
    assert len(chunks) == LAST_PARTS * 4


def test_a_small_batch_is_not_cut_to_pieces(tmp_path: Path) -> None:
    _, chunks = cut([b"{}\n" * (LEAST_DOMAINS + 1)], tmp_path, batch_chunk=500)
    assert domains(chunks) == [LEAST_DOMAINS, 1]


def test_few_large_domains_are_shared_out_by_their_bytes(tmp_path: Path) -> None:
    line = b"x" * (LEAST_BYTES - 1) + b"\n"
    _, chunks = cut([line * 16], tmp_path, batch_chunk=500)
    assert domains(chunks) == [2] * 8


def test_chunks_are_closed_by_their_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batches, "CHUNK_BYTES", 10 * KIB)
    line = b"x" * (KIB - 1) + b"\n"
    _, chunks = cut([line * 45], tmp_path, batch_chunk=500)
    assert domains(chunks) == [10] * 4 + [5]
    assert max(len(content) for _, content in chunks) <= 10 * KIB


def test_a_disk_that_is_full_is_told_once_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write(blobs: Blobs, file: Path, content: bytes) -> str:
        if file.name == "000002":
            raise OSError(28, "No space left on device")
        time.sleep(0.05)
        file.write_bytes(content)
        return "0" * 64

    monkeypatch.setattr(Blobs, "write", write)
    with pytest.raises(StoreUnavailable, match="No space"):
        cut([b"{}\n" * 20] * 10, tmp_path, batch_chunk=10)
    assert not list((tmp_path / "incoming").iterdir())


def test_a_body_of_empty_lines_leaves_the_loop_to_others(tmp_path: Path) -> None:
    """Others have their turns between its lines, however many come at once."""
    turns = 0

    async def count() -> None:
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    async def run() -> None:
        counting = asyncio.create_task(count())
        blobs = Blobs(tmp_path)
        blobs.open()
        reader = Reader(Settings(), blobs, Calls(), tmp_path)
        with pytest.raises(BatchRefused):
            await reader.read(_body([b"\n" * MIB]))
        counting.cancel()

    asyncio.run(run())
    assert turns >= MIB // batches.TURN_LINES
