"""The docstring of a private function or class is one line; public ones say more."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]
FILES = [
    file
    for folder in (
        "src",
        "packages/contourlets/src",
        "packages/meshreaders/src",
        "workflow/lib",
        "studies",
    )
    for file in sorted((ROOT / folder).rglob("*.py"))
]


def definitions(node, is_within_function=False):
    """Yield functions and classes, and whether each is private; what a function holds is."""
    for child in ast.iter_child_nodes(node):
        is_function = isinstance(child, ast.FunctionDef)
        if is_function or isinstance(child, ast.ClassDef):
            is_private = child.name.startswith("_") and not child.name.endswith("__")
            yield child, is_private or is_within_function
        yield from definitions(child, is_within_function or is_function)


def test_docstrings_of_private_functions_and_classes_are_one_line():
    assert [
        f"{file.relative_to(ROOT)}: {one.name}"
        for file in FILES
        for one, is_private in definitions(ast.parse(file.read_text(encoding="utf-8")))
        if is_private and "\n" in (ast.get_docstring(one) or "")
    ] == []
