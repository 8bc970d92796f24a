"""The columns of the data set, and how rows of touches become its rows."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from visuohaptic.meshes.catalogue import Credit
from visuohaptic.tables.phases import TOUCHES, keys_of
from visuohaptic.tables.schema import TEXT, Column, images

IMAGE = pa.struct([("bytes", pa.binary()), ("path", TEXT)])
"""What `datasets` takes for a picture in Parquet."""

_SAMPLES = 10
"""Imprints of a class in the sample."""

IMPRINT = pa.list_(pa.list_(pa.float32()))

_COPIED = [column for column in TOUCHES.columns if column.name != "image"]
LITE_COLUMNS = (
    Column("image", IMAGE, "tactile imprint, 8-bit grey PNG: 255 contact, 0 out of reach"),
    Column("label", pa.int64(), "number of the class"),
    *_COPIED,
    Column("licence", TEXT, "licence of the object's model; empty where none is known"),
    Column("author", TEXT, "author of the object's model; empty where none is known"),
)
COLUMNS = (
    *LITE_COLUMNS,
    Column("imprint", IMPRINT, "the same imprint without rounding", "1 contact, 0 out of reach"),
)


def data_rows(
    touches: pa.Table, classes: Sequence[str], credited: Mapping[str, Credit]
) -> pa.Table:
    """Turn rows of `tables.TOUCHES` into rows of `COLUMNS`; a label is a place in `classes`.

    Raises `TableError` if the imprints differ in size, or are no squares.
    """
    imprints = images(touches)
    found = [credited[key] for key in keys_of(touches).to_pylist()]
    values = {
        "image": [
            {"bytes": _png(255.0 * imprint), "path": None}
            for imprint in imprints.astype(np.float64)
        ],
        "label": pc.index_in(touches.column("class"), pa.array(classes)).cast(pa.int64()),
        **{column.name: touches.column(column.name) for column in _COPIED},
        "licence": [credit.licence for credit in found],
        "author": [credit.author for credit in found],
        "imprint": _nested(imprints),
    }
    return pa.table(values, schema=arrow_schema(COLUMNS))


def _png(grey: NDArray[np.float64]) -> bytes:
    """Give a picture, 0 to 255, as an 8-bit grey PNG file."""
    from PIL import Image

    stored = io.BytesIO()
    Image.fromarray(np.rint(grey).astype(np.uint8)).save(stored, "png")
    return stored.getvalue()


def sample_png(rows: pa.Table) -> bytes:
    """Draw the first imprints of each class, a row each, at twice their size as a grey PNG file."""
    from PIL import Image

    kinds, lines = rows.column("class"), []
    for name in sorted(pc.unique(kinds).to_pylist()):
        stored = rows.filter(pc.equal(kinds, name)).column("image").slice(0, _SAMPLES).to_pylist()
        pictures = [np.asarray(Image.open(io.BytesIO(one["bytes"]))) for one in stored]
        line = np.hstack([np.pad(picture, 1) for picture in pictures])
        width = _SAMPLES * (pictures[0].shape[1] + 2)
        lines.append(np.pad(line, ((0, 0), (0, width - line.shape[1]))))
    return _png(np.vstack(lines).repeat(2, axis=0).repeat(2, axis=1))


def arrow_schema(columns: Sequence[Column]) -> pa.Schema:
    """Give the Parquet schema of columns, descriptions and units as metadata."""
    return pa.schema(
        [
            pa.field(
                column.name,
                column.dtype,
                metadata={"description": column.description, "unit": column.unit},
            )
            for column in columns
        ]
    )


def _nested(imprints: NDArray[np.float32]) -> pa.Array:
    count, rows, columns = imprints.shape
    lines = pa.ListArray.from_arrays(
        np.arange(count * rows + 1, dtype=np.int32) * columns, imprints.reshape(-1)
    )
    return pa.ListArray.from_arrays(np.arange(count + 1, dtype=np.int32) * rows, lines)
