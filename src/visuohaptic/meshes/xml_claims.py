"""XML as models bring it (3MF, COLLADA): bounded, free of entities, and with a bounded number of parts."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import Any, TypeVar

from visuohaptic.errors import MeshError
from visuohaptic.meshes.claims import MOST_CORNERS, MOST_PARTS

Part = TypeVar("Part", bound=Hashable)

MOST_BYTES = 128 * 10**6
"""XML of one model, unpacked; a tree of it takes some 30 bytes a byte."""


def parse_xml(data: bytes) -> Any:
    """Give the root of an XML document, an ``lxml`` element without comments.

    No entity is expanded, and nothing else is read. Raises `MeshError` if the document is above
    `MOST_BYTES`, holds a text above 10 MB, or declares a type, where entities could stand;
    ``lxml.etree.XMLSyntaxError`` if it is no XML.
    """
    from lxml import etree

    check_size(len(data))
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False,
        remove_comments=True, remove_pis=True,
    )  # fmt: skip
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        if "XML_PARSE_HUGE" not in str(error):
            raise
        raise MeshError(
            "one of its texts is longer than 10 MB, or it is too deep; export it as .glb"
        ) from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise MeshError("it has a DOCTYPE, which could name other files; none is allowed")
    return root


def check_size(unpacked: int) -> None:
    """Refuse XML of more bytes than `MOST_BYTES`."""
    if unpacked > MOST_BYTES:
        raise MeshError(
            f"it unpacks to {unpacked / 1e6:.0f} MB of XML, and {MOST_BYTES / 1e6:.0f} are allowed; "
            "export it as .glb"
        )


def check_placed(
    inside: Mapping[Part, Collection[Part]], sizes: Mapping[Part, tuple[int, int]], whole: Part
) -> None:
    """Refuse a model whose parts stand for too many: each may hold others, and these again others.

    `inside` are the parts within each part, each as often as it stands there; `sizes` the shapes
    that each has of its own, and their vertices and corners of faces; `whole` is the part that is
    the model. Raises `MeshError` if a part holds itself, or there are more than `MOST_PARTS` or
    `MOST_CORNERS`.
    """
    parts: dict[Part, int] = {}
    corners: dict[Part, int] = {}
    try:
        for part in TopologicalSorter(inside).static_order():
            shapes, own = sizes.get(part, (0, 0))
            held = inside.get(part, ())
            parts[part] = 1 + shapes + sum(parts[one] for one in held)
            corners[part] = own + sum(corners[one] for one in held)
    except CycleError:
        raise MeshError("one of its parts holds itself") from None
    if parts[whole] > MOST_PARTS:
        raise MeshError(
            f"it has more than {MOST_PARTS} parts, counted wherever one stands; join some of them"
        )
    if corners[whole] > MOST_CORNERS:
        raise MeshError(
            f"it shows more than {MOST_CORNERS} vertices and corners, counted wherever a part stands"
        )
