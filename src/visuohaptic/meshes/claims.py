"""What a model's file claims to hold, checked against its size before it is parsed.

A short file can ask a parser for any amount of time and memory: by a count in its header, by
parts that stand for others, or by very many small parts. With the limits here, and
`meshes.largest_megabytes`, reading takes at most about 2 µs and 400 bytes a byte of the file, and a
second a thousand parts.
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Iterator
from typing import Any

from visuohaptic.errors import MeshError
from visuohaptic.geometry.ply_header import LONGEST, check_ply_size, read_ply_header

MOST_LINES = 20_000_000
"""Lines of a text format."""

MOST_PARTS = 5_000
"""Parts, such as the nodes of a scene or the materials of an OBJ: each takes its time."""

MOST_CORNERS = 60_000_000
"""Vertices and corners of faces, each part counted where it stands."""

_MOST_BLANK_LINES = 100_000
_MATERIAL = re.compile(rb"^usemtl[ \t]+(.*?)[ \t\r]*$", re.MULTILINE)
_SOLID = re.compile(rb"^[ \t]*solid\b", re.MULTILINE)
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}


def check_claims(data: bytes, name: str, kind: str) -> None:
    """Refuse a file that claims more than it holds, or asks for more than is bounded.

    `kind` is its format, such as ``obj``. Raises `MeshError`, which says what was claimed and what
    is allowed.
    """
    match kind:
        case "ply":
            _check_ply(data, name)
        case "off":
            _check_lines(data, name)
        case "obj":
            _check_lines(data, name)
            _check_parts(len(set(_MATERIAL.findall(data))), "materials", name)
        case "stl":
            _check_lines(data, name)
            _check_parts(len(_SOLID.findall(data)), "solids", name)
        case "glb" | "gltf":
            _check_gltf(data, name, kind)


def _check_ply(data: bytes, name: str) -> None:
    try:
        header = read_ply_header(data[:LONGEST])
        check_ply_size(header, len(data))
    except ValueError as error:
        raise MeshError(f"{name} can't be read as PLY: {error}.") from None
    if not header.ascii:
        return
    _check_lines(data, name)
    lines = data.count(b"\n", header.length)
    if lines > header.rows + _MOST_BLANK_LINES:
        raise MeshError(
            f"{name} can't be read as PLY: its header claims {header.rows} rows, and {lines} lines "
            "follow."
        )


def _check_lines(data: bytes, name: str) -> None:
    # A binary STL holds this byte where it likes, and no more than its size allows.
    lines = data.count(b"\n")
    if lines > MOST_LINES:
        raise MeshError(f"{name} has {lines} lines; {MOST_LINES} are allowed: save it as binary.")


def _check_parts(count: int, what: str, name: str) -> None:
    if count > MOST_PARTS:
        raise MeshError(f"{name} has {count} {what}; {MOST_PARTS} are allowed: join some of them.")


def _check_gltf(data: bytes, name: str, kind: str) -> None:
    try:
        document = json.loads(gltf_json(data, kind))
        nodes, corners = len(document.get("nodes", ())), sum(_corners(document))
        parts = max(nodes, sum(len(mesh["primitives"]) for mesh in document.get("meshes", ())))
        held = sum(_accessor_bytes(one) for one in document.get("accessors", ()))
    # What is no glTF may fail anywhere here.
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError, struct.error):
        raise MeshError(f"{name} can't be read as {kind.upper()}: its JSON is no glTF.") from None
    _check_parts(parts, "nodes or primitives", name)
    if corners > MOST_CORNERS:
        raise MeshError(
            f"{name} shows {corners} vertices and corners, counted wherever a mesh stands; "
            f"{MOST_CORNERS} are allowed."
        )
    if held > 16 * len(data):
        raise MeshError(
            f"{name} can't be read as {kind.upper()}: it claims {held} bytes without data in a file "
            f"of {len(data)} bytes."
        )


def gltf_json(data: bytes, kind: str) -> bytes:
    """Give the JSON of a glTF file; raises `ValueError` or `struct.error` if there is none."""
    if kind == "gltf":
        return data
    length, chunk = struct.unpack("<I4s", data[12:20])
    if data[:4] != b"glTF" or chunk != b"JSON":
        raise ValueError(chunk)
    return data[20 : 20 + length]


def _corners(document: dict[str, Any]) -> Iterator[int]:
    accessors = document.get("accessors", ())
    meshes = [
        sum(
            int(accessors[place]["count"])
            for primitive in mesh["primitives"]
            for place in (*primitive["attributes"].values(), primitive.get("indices"))
            if place is not None
        )
        for mesh in document.get("meshes", ())
    ]
    yield sum(meshes)
    for node in document.get("nodes", ()):
        if "mesh" in node:
            yield meshes[node["mesh"]]


def _accessor_bytes(accessor: dict[str, Any]) -> int:
    """Give the bytes that stand for nothing in the file."""
    if "bufferView" in accessor:
        return 0
    size = _COMPONENTS[accessor["type"]] * _COMPONENT_BYTES[accessor["componentType"]]
    return int(accessor["count"]) * size
