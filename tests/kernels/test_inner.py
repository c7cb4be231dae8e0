"""Kernels that have no entry for Python are called by kernels only: a call from Python would end the process."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent


def decorators(node: ast.FunctionDef) -> set[str]:
    return {d.id for d in node.decorator_list if isinstance(d, ast.Name)}


def modules() -> dict[str, ast.Module]:
    """Every module of the checkout by its dotted name."""
    found = {}
    for folder in ("mat_core", "service", "tests", "benchmarks", "tools"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            found[".".join(file.relative_to(ROOT).with_suffix("").parts)] = ast.parse(file.read_text())
    return found


def inner_kernels(tree: ast.Module) -> set[str]:
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef) and "inner" in decorators(node)}


def mentioned(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """(name, "") and (name, attribute) for all that interpreted code mentions; imports do not count."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef) and decorators(node) & {"jit", "inner"}:
            continue
        if isinstance(node, ast.Name):
            yield node.id, ""
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            yield node.value.id, node.attr
        yield from mentioned(node)


def bound(tree: ast.Module, inner: dict[str, set[str]]) -> tuple[set[str], dict[str, set[str]]]:
    """Names that mean an inner kernel in a module, and names that mean a module with the inner kernels of that."""
    kernels, others = inner_kernels(tree), {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                name = alias.asname or alias.name
                if alias.name in inner.get(node.module, set()):
                    kernels.add(name)
                others[name] = inner.get(f"{node.module}.{alias.name}", set())
        elif isinstance(node, ast.Import):
            others.update({alias.asname: inner.get(alias.name, set()) for alias in node.names if alias.asname})
    return kernels, others


def test_no_python_code_mentions_an_inner_kernel() -> None:
    trees = modules()
    inner = {name: inner_kernels(tree) for name, tree in trees.items()}
    assert sum(map(len, inner.values())) > 50
    wrong = []
    for name, tree in trees.items():
        kernels, others = bound(tree, inner)
        wrong += [(name, a, b) for a, b in mentioned(tree) if (a in kernels if not b else b in others.get(a, set()))]
    assert wrong == []
