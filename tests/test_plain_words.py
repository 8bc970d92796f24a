"""Docstrings and comments use the field's words, and no phrase that readers had to decode."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = [
    file
    for folder in (
        "src",
        "packages/contourlets/src",
        "packages/meshreaders/src",
        "workflow/lib",
        "workflow/scripts",
        "studies",
    )
    for file in sorted((ROOT / folder).rglob("*.py"))
]

# CONTRIBUTING.md says what to write instead.
PHRASES = (
    r"\bGives? ",
    r" alone\b",
    r"\bthose that\b",
    r"\bwhat is\b",
    r"\bof which\b",
    r", whose ",
    r"\bas it is\b",
    r"\bis none of\b|\bcounts nothing\b|\bat work\b|\bthe more so\b|\bif it likes\b",
    r"\b(?:row|column|line|job|file|number|time|value|name)s? an? (?:view|object|touch|row|job|classifier|strategy)\b",
    r"\brightly\b|\bcalled for\b|\btaken for\b|\bhand(?:s|ed)? on\b|\bgoes on\b|\bon its way\b",
    r"\bmade of\b|\bstands? for\b",
    r" but for ",
)


def comments(source: str) -> Iterator[str]:
    """Yield the comments of a module."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.string


def docstrings(source: str) -> Iterator[str]:
    """Yield the docstrings of a module, and the texts below constants and fields."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Expr(value=ast.Constant(value=str(text))):
                yield text


@pytest.fixture(scope="module")
def texts() -> dict[Path, str]:
    """Return the docstrings and comments of each file, with one blank between words."""
    sources = {file: file.read_text(encoding="utf-8") for file in FILES}
    return {
        file: "\n".join(" ".join(text.split()) for text in (*docstrings(source), *comments(source)))
        for file, source in sources.items()
    }


@pytest.mark.parametrize("phrase", PHRASES)
def test_no_docstring_or_comment_has_to_be_decoded(texts, phrase):
    lines = [
        f"{file.relative_to(ROOT)}: {line}"
        for file, text in texts.items()
        for line in text.splitlines()
        if re.search(phrase, line)
    ]
    assert not lines, "write it as CONTRIBUTING.md says"
