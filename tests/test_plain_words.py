"""Docstrings and comments use the field's words: phrases that readers had to decode become fewer, never more."""

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
    for folder in ("src", "packages/contourlets/src", "workflow/lib", "workflow/scripts", "studies")
    for file in sorted((ROOT / folder).rglob("*.py"))
]

# How often each phrase stands today. Lower the number with the phrase; CONTRIBUTING.md says what to write instead.
PHRASES = {
    r"\bGives? ": 2,
    r" alone\b": 4,
    r"\bthose that\b": 0,
    r"\bwhat is\b": 1,
    r"\bof which\b": 0,
    r", whose ": 1,
    r"\bas it is\b": 0,
    r"\bis none of\b": 0,
    r"\b(?:row|column|line|job|file|number|time|value|name)s? an? (?:view|object|touch|row|job|classifier|strategy)\b": 0,
    r"\brightly\b|\bcalled for\b|\btaken for\b|\bhand(?:s|ed)? on\b|\bgoes on\b|\bon its way\b": 0,
    r"\bmade of\b|\bstands? for\b": 1,
    r" but for ": 0,
}


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
def texts() -> str:
    """Return all docstrings and comments, with one blank between words."""
    sources = [file.read_text(encoding="utf-8") for file in FILES]
    return "\n".join(
        " ".join(text.split())
        for source in sources
        for text in (*docstrings(source), *comments(source))
    )


@pytest.mark.parametrize("phrase", PHRASES)
def test_phrases_that_have_to_be_decoded_become_fewer(texts, phrase):
    count = len(re.findall(phrase, texts))
    assert count <= PHRASES[phrase], f"{count} times; write it as CONTRIBUTING.md says"
    assert count == PHRASES[phrase], f"only {count} times now: lower the number in PHRASES"
