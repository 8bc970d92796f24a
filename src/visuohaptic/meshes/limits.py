"""Limits on what a model's file may hold or claim, and XML within them.

A short file can ask a parser for any amount of time and memory: by a count in its header, by
parts that stand for others, or by very many small parts. With the limits here, and
`meshes.largest_megabytes`, reading takes at most about 5 µs and 400 bytes a byte of the file, and a
second a thousand parts.
"""

from __future__ import annotations

from typing import Any

from lxml import etree

from visuohaptic.base.errors import MeshError

MOST_LINES = 20_000_000
"""Lines of a text format."""

MOST_PARTS = 5_000
"""Parts, such as the nodes of a scene or the materials of an OBJ: each takes its time."""

MOST_CORNERS = 60_000_000
"""Vertices and corners of faces, each part counted where it stands."""

MOST_XML_BYTES = 128 * 10**6
"""XML of one model, unpacked; a tree of it takes some 30 bytes a byte."""


def check_lines(data: bytes) -> None:
    """Refuse, with the reason alone, a text of too many lines."""
    lines = data.count(b"\n")
    if lines > MOST_LINES:
        raise MeshError(f"it has {lines} lines; {MOST_LINES} are allowed: save it as binary")


def check_parts(parts: int, what: str, corners: int = 0) -> None:
    """Refuse, with the reason alone, too many parts, or of vertices and corners, each counted wherever it stands."""
    if parts > MOST_PARTS:
        raise MeshError(f"it has {parts} {what}; {MOST_PARTS} are allowed: join some of them")
    if corners > MOST_CORNERS:
        raise MeshError(
            f"it shows {corners} vertices and corners, counted wherever a part stands; {MOST_CORNERS} "
            "are allowed"
        )


def check_xml_size(unpacked: int) -> None:
    """Refuse, with the reason alone, XML of more bytes than `MOST_XML_BYTES`."""
    if unpacked > MOST_XML_BYTES:
        raise MeshError(
            f"it unpacks to {unpacked / 1e6:.0f} MB of XML, and {MOST_XML_BYTES / 1e6:.0f} are allowed; "
            "export it as .glb"
        )


def parse_xml(data: bytes) -> Any:
    """Give the root of an XML document, an ``lxml`` element without comments; no text may be above 10 MB.

    No entity is expanded, and nothing else is read: a document that declares a type, where entities
    could stand, is refused.
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
