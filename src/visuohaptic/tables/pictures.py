"""The table of pictures of each object in the report, small enough to be part of the page."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import OBJECT_KEYS
from visuohaptic.tables.schema import COUNT, TEXT, Column, Schema, count

_OF_VIEWS = pa.map_(COUNT, pa.binary())

PICTURES = Schema(
    "pictures",
    OBJECT_KEYS,
    (
        Column("views", _OF_VIEWS, "view of each viewpoint, lossy WebP"),
        Column("saliency", _OF_VIEWS, "saliency map of each viewpoint at half the size, lossy WebP"),
        Column("imprints", _OF_VIEWS, "imprints of strategy fixation by viewpoint, side by side in order, WebP"),
        Column("sheets", pa.map_(TEXT, pa.binary()), "imprints by strategy, one row per viewpoint and one column per touch, lossy WebP"),
        Column("model", pa.binary(), "thinned mesh and touches as packed by `pictures.models.pack_model`, gzip; missing without a mesh", nullable=True),
        count("vertices", "vertices of the thinned mesh", nullable=True),
        count("faces", "faces of the thinned mesh", nullable=True),
        count("touches", "touches packed with the mesh", nullable=True),
        count("original_faces", "faces of the object's mesh", nullable=True),
    ),
)  # fmt: skip
