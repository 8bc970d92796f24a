"""Limits on the size of models, and reading of XML within the limits.

A short file can take any amount of time and memory: by a count in its header, or by many references to a part. With these limits and `largest_megabytes`, reading takes at most about 5 µs and 400
bytes per byte of the file, and a second per thousand parts.
"""

from __future__ import annotations

from typing import Any

from lxml import etree

from meshreaders.base.errors import MeshError

MOST_LINES = 20_000_000
"""Largest number of lines of a text format."""

MOST_PARTS = 5_000
"""Largest number of parts, such as nodes of a scene or materials of an OBJ file."""

MOST_CORNERS = 60_000_000
"""Largest number of vertices and corners of faces, counted per instance of a part."""

MOST_XML_BYTES = 128 * 10**6
"""Largest size of the unpacked XML of a model; its tree takes some 30 bytes per byte."""


def check_lines(data: bytes) -> None:
    """Raise `MeshError` with the reason if a text has more than `MOST_LINES` lines."""
    lines = data.count(b"\n")
    if lines > MOST_LINES:
        raise MeshError(f"it has {lines} lines; {MOST_LINES} are allowed: save it as binary")


def check_parts(parts: int, kind: str, corners: int = 0) -> None:
    """Raise `MeshError` with the reason for too many parts of a kind, or too many vertices and corners, counted per instance."""
    if parts > MOST_PARTS:
        raise MeshError(f"it has {parts} {kind}; {MOST_PARTS} are allowed: join some of them")
    if corners > MOST_CORNERS:
        raise MeshError(
            f"it has {corners} vertices and corners, counted per instance of a part; {MOST_CORNERS} "
            "are allowed"
        )


def check_xml_size(unpacked: int) -> None:
    """Raise `MeshError` with the reason if XML has more than `MOST_XML_BYTES` bytes."""
    if unpacked > MOST_XML_BYTES:
        raise MeshError(
            f"it unpacks to {unpacked / 1e6:.0f} MB of XML; {MOST_XML_BYTES / 1e6:.0f} MB are allowed: "
            "export it as .glb"
        )


def parse_xml(data: bytes) -> Any:
    """Return the root of an XML document, an ``lxml`` element, without comments and processing instructions.

    Entities are not expanded and no other files are read. Raises `MeshError` if the document has a DOCTYPE or is too
    large, and ``lxml.etree.XMLSyntaxError`` if it is broken or a text is above 10 MB.
    """
    check_xml_size(len(data))
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False,
        remove_comments=True, remove_pis=True,
    )  # fmt: skip
    root = etree.fromstring(data, parser)
    if root.getroottree().docinfo.internalDTD is not None:
        raise MeshError("it has a DOCTYPE, which could name other files; none is allowed")
    return root
