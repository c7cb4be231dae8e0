"""Compiled kernels on disk: one file for each kernel, types of arguments, and processor.

Numba's own cache looks into two files for each kernel, and prepares the whole compiler before it does. Here the name of the file
says all there is to know: it stands in a folder that is named by the digest of every source the kernel is made from
(`mat_core.kernels.jit`), and is itself named by the types and the processor. What is found is right, what is not is compiled.
"""

from __future__ import annotations

import hashlib
import pickle
import uuid
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core import config
from numba.core.compiler import CompileResult, compile_result
from numba.core.serialize import dumps

from mat_core.kernels.libraries import EntryLibrary


class KernelCache:
    """The cache of one kernel, in the form in which Numba's dispatcher asks for it.

    Parameters
    ----------
    folder : callable
        The folder; asked for when it is first needed, because that reads the sources.
    name : str
        The kernel's name in that folder.
    """

    def __init__(self, folder: Callable[[], Path], name: str) -> None:
        self._folder = folder
        self._name = name

    @property
    def cache_path(self) -> str:
        """The folder, for the dispatcher's statistics."""
        return str(self._folder())

    def load_overload(self, signature: Any, context: Any) -> CompileResult | None:
        """The kernel for arguments of these types, or None if it has to be compiled."""
        try:
            content = self._file(signature, context.codegen()).read_bytes()
        except OSError:
            return None
        state, fndesc, environment, signature = pickle.loads(content)
        library = EntryLibrary.restored(context.codegen(), state)
        entry = context.get_executable(library, fndesc, environment)
        return compile_result(
            typing_context=context.typing_context, target_context=context, library=library, environment=environment,
            entry_point=entry, fndesc=fndesc, signature=signature, objectmode=False, lifted=(), reload_init=(),
        )  # fmt: skip

    def save_overload(self, signature: Any, compiled: CompileResult) -> None:
        """Keep a compiled kernel, if the folder can be written to."""
        if compiled.library.has_dynamic_globals:
            return  # it holds addresses of this process
        descriptor = compiled.fndesc
        descriptor.typemap = descriptor.calltypes = None  # large, and of use to the compiler alone
        content = dumps((compiled.library.state(), descriptor, compiled.environment, compiled.signature))
        with suppress(OSError):
            _write(self._file(signature, compiled.codegen), content)

    def _file(self, signature: Any, codegen: Any) -> Path:
        key = repr((signature, codegen.magic_tuple(), config.BOUNDSCHECK)).encode()
        return self._folder() / f"{self._name}-{hashlib.sha256(key).hexdigest()[:16]}.kernel"


def _write(file: Path, content: bytes) -> None:
    """All of a file or nothing: another process never reads half of it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    draft = file.with_suffix(f".{uuid.uuid4().hex}")
    try:
        draft.write_bytes(content)
        draft.replace(file)
    finally:
        draft.unlink(missing_ok=True)
