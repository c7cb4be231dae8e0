"""The one place where a function becomes a compiled kernel.

Compiled kernels are kept on disk (`mat_core.kernels.cache`). Each module's lie in a folder named by a digest of its source and of
all sources of ours that it imports, directly or not. A stale kernel is therefore never loaded, and a change recompiles what
depends on it and nothing else. Only kernels that Python calls are kept: those that kernels call are in them
(`mat_core.kernels.libraries`).

Strict IEEE arithmetic is kept (no ``fastmath``): sign tests near zero decide topology.
"""

from __future__ import annotations

import functools
import hashlib
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config, ir
from numba.core.base import BaseContext
from numba.core.compiler_lock import global_compiler_lock
from numba.core.types.functions import BaseFunction
from numba.core.types.misc import unliteral

from mat_core.kernels.cache import KernelCache
from mat_core.kernels.indexing import item_access
from mat_core.kernels.libraries import KernelCompiler

F = TypeVar("F", bound=Callable[..., object])

PACKAGE = Path(__file__).resolve().parent.parent
_IMPORT = re.compile(r"^import (mat_core[\w.]*)|^from (mat_core[\w.]*) import (?:\(([^)]*)\)|(.*))", re.MULTILINE)


@functools.cache
def _module_file(name: str) -> Path | None:
    """Source file of one of our modules; None for what a module has in it."""
    path = PACKAGE.parent.joinpath(*name.split("."))
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return file if file.exists() else None


@functools.cache
def _imports(path: Path) -> tuple[str, frozenset[Path]]:
    """Digest of a source file and the files of ours that it imports."""
    source = path.read_bytes()
    names: set[str] = set()
    for module, package, *members in _IMPORT.findall(source.decode()):
        names.add(module or package)
        names.update(f"{package}.{member.split()[0]}" for member in "".join(members).split(",") if member.strip())
    return hashlib.sha256(source).hexdigest(), frozenset(filter(None, map(_module_file, names)))


@functools.cache
def sources(path: Path) -> frozenset[Path]:
    """A source file together with everything of ours that it imports, directly or not."""
    seen: set[Path] = set()
    waiting = {path}
    while waiting:
        file = waiting.pop()
        seen.add(file)
        waiting |= _imports(file)[1] - seen
    return frozenset(seen)


@functools.cache
def fingerprint(path: Path) -> str:
    """Digest of the `sources` of a file, of the compiler's version and the interpreter's."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.implementation.cache_tag}".encode())
    for file in sorted(sources(path)):
        digest.update(_imports(file)[0].encode())
    return digest.hexdigest()[:16]


@functools.cache
def cache_root() -> Path:
    """Where compiled kernels are kept: NUMBA_CACHE_DIR, else beside the sources, else the user's cache, else a temporary one."""
    if config.CACHE_DIR:
        return Path(config.CACHE_DIR)
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for folder in (PACKAGE / "__pycache__", user / "mat_core"):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return folder / "kernels"
    return Path(tempfile.gettempdir()) / "mat_core-kernels"


@functools.cache
def cache_folder(path: Path) -> Path:
    """Where the compiled kernels of a source file are kept."""
    return cache_root() / fingerprint(path.resolve())


_entries: list[tuple[Path, str]] = []  # source file and name of each kernel that Python calls


def all_kept() -> bool:
    """True when every kernel that Python calls is on disk already, for the types it is called with first or for others."""
    return all(any(cache_folder(file).glob(f"{name}-*.kernel")) for file, name in _entries)


def jit(function: F) -> F:
    """Compile `function` without the interpreter, cached on disk; its Python signature is kept for the type checker."""
    return _compiled(function, True)


def inner(function: F) -> F:
    """The same for a kernel that only kernels call: no entry for Python, no machine code and no file of its own."""
    return _compiled(function, False)


def pasted(function: F) -> F:
    """The same as `inner`, for the few that are called so often that a call costs as much as they do: a copy in each caller."""
    return _compiled(function, False, True)


def _compiled(function: F, entry: bool, forceinline: bool = False) -> F:
    compiled: Any = numba.njit(
        error_model="numpy", nogil=True, _nrt=False, no_cpython_wrapper=not entry, no_cfunc_wrapper=True,
        pipeline_class=KernelCompiler, forceinline=forceinline,
    )(function)  # fmt: skip
    if not config.DISABLE_JIT:
        if entry:
            file = Path(function.__code__.co_filename)
            name = f"{file.stem}.{function.__qualname__}"
            compiled._cache = KernelCache(functools.partial(cache_folder, file), name)
            _entries.append((file, name))
        _forget_literals(compiled)
        _remember_operators(compiled)
    return cast(F, compiled)


def _forget_literals(compiled: Any) -> None:
    """Let kernels that call this one with a constant use the version for any number, instead of one for each constant."""
    resolve = compiled.get_call_template

    def resolve_plain(args: Any, kws: Any) -> Any:
        return resolve(tuple(unliteral(a) for a in args), {k: unliteral(a) for k, a in kws.items()})

    compiled.get_call_template = resolve_plain


_functions: Any = BaseFunction
_resolve_anew = _functions.get_call_type
_resolved: dict[object, object] = {}


def _resolve_once(function: Any, context: Any, args: Any, kws: Any) -> Any:
    """The compiler's own answer to "which version of this operator serves these types", asked once for each."""
    if kws:
        return _resolve_anew(function, context, args, kws)
    key = function, args
    if key not in _resolved:
        _resolved[key] = _resolve_anew(function, context, args, kws)
    return _resolved[key]


_contexts: Any = BaseContext
_find_anew = _contexts.get_function


def _find_but_arrays(context: Any, function: Any, signature: Any, _firstcall: bool = True) -> Any:
    """The compiler's own answer, but for items of arrays, and for what makes an array of something like one.

    Arrays are all that kernels know. The compiler asks for the latter at every index of every array, in vain, and looks for new
    declarations before it gives up.
    """
    if function == "__array__":
        raise NotImplementedError(function)
    return item_access(context, function, signature) or _find_anew(context, function, signature, _firstcall)


_instructions: Any = ir.Inst
_list_anew = _instructions._rec_list_vars
_NO_VARIABLES = frozenset({ir.Loc, ir.Const, ir.Global, ir.Arg, ir.UndefinedType, str, int, float, bool, type(None)})


def _list_variables(instruction: Any, value: Any) -> Any:
    """The compiler's own answer to "which variables does this mention", quicker for most of what instructions are made of.

    It is asked two million times, and tries a list of kinds each time: a twentieth of a first start.
    """
    kind = type(value)
    if kind in _NO_VARIABLES:
        return []
    if kind is ir.Var:
        return [value]
    return _list_anew(instruction, value)


@contextmanager
def _compiling_quickly() -> Iterator[None]:
    """While one of our kernels is compiled, and by no other thread, the compiler uses the functions above."""
    with global_compiler_lock:
        before = _functions.get_call_type, _contexts.get_function, _instructions._rec_list_vars
        _functions.get_call_type, _contexts.get_function = _resolve_once, _find_but_arrays
        _instructions._rec_list_vars = _list_variables
        try:
            yield
        finally:
            _functions.get_call_type, _contexts.get_function, _instructions._rec_list_vars = before


def _remember_operators(compiled: Any) -> None:
    """Let a kernel be compiled with the types of operators remembered.

    The kernels apply some four hundred combinations of operator and types some twenty-four thousand times, and the compiler
    tries its whole list of candidates anew each time: a fifth of the time of a first start.
    """
    compile_kernel = compiled.compile

    def compile_remembering(signature: Any) -> Any:
        with _compiling_quickly():
            return compile_kernel(signature)

    compiled.compile = compile_remembering
