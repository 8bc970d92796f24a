"""Recognise what a file holds by its beginning, for errors about files with a wrong suffix."""

from __future__ import annotations

import re

BEGINNING = 2048
"""Number of bytes at the beginning of a file that are looked at."""

# By suffix of a model file: what begins it, and its name in errors.
_MODELS = {
    "ply": (re.compile(rb"\Aply\s*[\r\n]"), "PLY"),
    "glb": (re.compile(rb"\AglTF"), "binary glTF"),
    "gltf": (re.compile(rb'\A\s*\{.*"asset"\s*:', re.DOTALL), "glTF"),
    "dae": (re.compile(rb"\A\s*<.*?\bCOLLADA\b", re.DOTALL), "COLLADA"),
    "3mf": (re.compile(rb"\APK\x03\x04"), "a ZIP archive, such as 3MF"),
    "stl": (re.compile(rb"\A\s*solid\b.*?\bfacet\s", re.DOTALL), "STL as text"),
    "off": (re.compile(rb"\A(ST)?C?N?4?n?OFF\b"), "OFF"),
    "obj": (re.compile(rb"^[ \t]*v[ \t]+[-+.0-9]+[ \t]+[-+.0-9]", re.MULTILINE), "OBJ"),
}
_PAGE = rb"\A\s*(<!doctype\s+html|<html[\s>]|<.*?<html[\s>])"
_SUBSTITUTES = (
    (
        re.compile(rb"\Aversion https://git-lfs"),
        "a pointer of Git LFS, which `git lfs pull` replaces",
    ),
    (re.compile(_PAGE, re.DOTALL | re.IGNORECASE), "a web page"),
)
_OTHERS = (
    *_SUBSTITUTES,
    (re.compile(rb"\A(\x89PNG|\xff\xd8\xff|GIF8|II\*\x00|MM\x00\*)"), "an image"),
    (re.compile(rb"\A%PDF-"), "a PDF"),
    (re.compile(rb"\A\x1f\x8b"), "packed with gzip"),
    (re.compile(rb"\A(7z\xbc\xaf|Rar!)"), "a packed archive"),
)


def substitute(beginning: bytes) -> str | None:
    """Return what stands in for a file by its beginning: a pointer of Git LFS or a web page; None for another content."""
    return next((name for pattern, name in _SUBSTITUTES if pattern.search(beginning)), None)


def other_content(beginning: bytes, kind: str) -> str | None:
    """Return the end of an error about a file of another kind, such as "its content is PLY, not STL".

    Parameters
    ----------
    beginning : bytes
        The first `BEGINNING` bytes of the file, without byte order mark.
    kind : str
        The suffix by which the file was read, such as ``stl``.

    Returns
    -------
    str or None
        None if the beginning is that of the kind, or of no known kind.
    """
    own = _MODELS.get(kind)
    if own is not None and own[0].search(beginning):
        return None
    for pattern, name in _OTHERS:
        if pattern.search(beginning):
            return f"its content is {name}, no {kind.upper()}"
    for suffix, (pattern, name) in _MODELS.items():
        if suffix != kind and pattern.search(beginning):
            return f"its content is {name}, no {kind.upper()}; rename it to .{suffix}"
    return None
