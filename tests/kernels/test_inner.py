"""Kernels that have no entry for Python are called by kernels only: a call from Python would end the process."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent


def decorators(node: ast.FunctionDef) -> set[str]:
    return {d.id for d in node.decorator_list if isinstance(d, ast.Name)}


def trees() -> Iterator[ast.Module]:
    for folder in ("mat_core", "service", "tests", "benchmarks", "tools"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            yield ast.parse(file.read_text())


def names_outside_kernels(tree: ast.AST) -> Iterator[str]:
    """Every name and attribute that interpreted code mentions; imports do not count."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef) and decorators(node) & {"jit", "inner"}:
            continue
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        yield from names_outside_kernels(node)


def test_no_python_code_mentions_an_inner_kernel() -> None:
    parsed = list(trees())
    inner = {
        node.name
        for tree in parsed
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and "inner" in decorators(node)
    }
    assert len(inner) > 50
    assert inner & {name for tree in parsed for name in names_outside_kernels(tree)} == set()
