"""Writes the docstrings of the compiled engine into its type stubs, where editors look for them.

    python python/tools/document_stubs.py

The texts are those of `crates/python`; a test holds the stubs to them.
"""

from __future__ import annotations

import ast
import inspect
from pathlib import Path
from typing import Any

import kinetarium._engine as engine

STUBS = Path(__file__).parents[1] / "kinetarium/_engine.pyi"


def documented(stubs: str) -> str:
    """Stubs with the docstrings of all that the module has."""
    lines = stubs.splitlines()
    for node, thing in reversed(list(documentable(ast.parse(stubs), engine))):
        document(node, thing.__doc__, lines)
    return "\n".join(lines) + "\n"


def documentable(tree: ast.Module | ast.ClassDef, owner: Any) -> list[tuple[ast.ClassDef | ast.FunctionDef, Any]]:
    """Classes, methods, getters and functions in the order of the text, and what they are in the module."""
    found: list[tuple[ast.ClassDef | ast.FunctionDef, Any]] = []
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not (is_setter(node) or node.name.startswith("__")):
            found.append((node, getattr(owner, node.name)))
        if isinstance(node, ast.ClassDef):
            kind = getattr(owner, node.name)
            found += [(node, kind), *documentable(node, kind)]
    return found


def is_setter(node: ast.FunctionDef) -> bool:
    """Whether it sets a property, whose getter is documented."""
    return any(isinstance(d, ast.Attribute) and d.attr == "setter" for d in node.decorator_list)


def document(node: ast.ClassDef | ast.FunctionDef, doc: str | None, lines: list[str]) -> None:
    """Puts a docstring in place of the one that a definition has, or of its dots, or before all else in it."""
    indent = " " * (node.col_offset + 4)
    text = [indent + line if line else "" for line in quoted(doc)] if doc else [f"{indent}..."]
    first = node.body[0]
    dots = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and first.value.value is ...
    begin = min([first.lineno, *(d.lineno for d in getattr(first, "decorator_list", []))]) - 1
    if dots and lines[begin].strip() != "...":
        if doc:
            lines[begin : begin + 1] = [lines[begin][: first.col_offset].rstrip(), *text]
    elif dots or ast.get_docstring(node) is not None:
        lines[begin : first.end_lineno] = text
    elif doc:
        lines[begin:begin] = text


def quoted(doc: str) -> list[str]:
    """The lines of a docstring."""
    begin, *rest = inspect.cleandoc(doc).splitlines()
    return [f'"""{begin}', *rest, '"""'] if rest else [f'"""{begin}"""']


if __name__ == "__main__":
    STUBS.write_text(documented(STUBS.read_text()))
