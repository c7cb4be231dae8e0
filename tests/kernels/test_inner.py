"""Kernels that have no entry for Python are called by kernels only: a call from Python would end the process."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent


def decorators(node: ast.FunctionDef) -> set[str]:
    return {d.id for d in node.decorator_list if isinstance(d, ast.Name)}


def trees() -> dict[str, ast.Module]:
    """Every module by its dotted name."""
    files = (file for folder in ("mat_core", "service", "tests", "benchmarks", "tools") for file in (ROOT / folder).rglob("*.py"))
    return {".".join(file.relative_to(ROOT).with_suffix("").parts): ast.parse(file.read_text()) for file in sorted(files)}


def inner_kernels(tree: ast.Module) -> set[str]:
    """Names of the inner kernels that a module defines."""
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef) and "inner" in decorators(node)}


def names_outside_kernels(tree: ast.AST) -> Iterator[str]:
    """Every name that interpreted code mentions, members of modules with the module's name; imports do not count."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef) and decorators(node) & {"jit", "inner"}:
            continue
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield f"{node.value.id}.{node.attr}"
        yield from names_outside_kernels(node)


def known_as(tree: ast.Module, name: str, inner: dict[str, set[str]]) -> set[str]:
    """What a module calls the inner kernels that it defines or imports."""
    known = set(inner[name])
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                here = alias.asname or alias.name
                if alias.name in inner.get(str(node.module), ()):
                    known.add(here)
                known |= {f"{here}.{kernel}" for kernel in inner.get(f"{node.module}.{alias.name}", ())}
    return known


def test_no_python_code_mentions_an_inner_kernel() -> None:
    parsed = trees()
    inner = {name: inner_kernels(tree) for name, tree in parsed.items()}
    assert sum(map(len, inner.values())) > 50
    for name, tree in parsed.items():
        assert known_as(tree, name, inner) & set(names_outside_kernels(tree)) == set(), name
