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
    """Turn touches, one or more rows of `tables.TOUCHES`, into rows of `COLUMNS` in the same order.

    A label is a place in `classes`, which are all. `credited` goes by `class/name`; an object without
    a credit gets empty texts. Raises `TableError` if the imprints differ in size, or are no squares.
    """
    imprints = images(touches)
    found = [credited.get(key) for key in keys_of(touches).to_pylist()]
    values = {
        "image": [{"bytes": png, "path": None} for png in grey_pngs(imprints)],
        "label": pc.index_in(touches.column("class"), pa.array(classes)).cast(pa.int64()),
        **{column.name: touches.column(column.name) for column in _COPIED},
        "licence": [credit.licence if credit else "" for credit in found],
        "author": [credit.author if credit else "" for credit in found],
        "imprint": _nested(imprints),
    }
    return pa.table(values, schema=arrow_schema(COLUMNS))


def grey_pngs(imprints: NDArray[np.float32]) -> list[bytes]:
    """Give imprints, shape (n, r, r) and 0 to 1, as 8-bit grey PNG files."""
    from PIL import Image

    grey = np.rint(255 * imprints.astype(np.float64)).astype(np.uint8)
    pngs = []
    for picture in grey:
        stored = io.BytesIO()
        Image.fromarray(picture).save(stored, "png")
        pngs.append(stored.getvalue())
    return pngs


def sample_png(rows: pa.Table) -> bytes:
    """Draw the first imprints of each class, a row each, as a grey PNG file."""
    from PIL import Image

    kinds = rows.column("class")
    lines = []
    for name in sorted(pc.unique(kinds).to_pylist()):
        stored = rows.filter(pc.equal(kinds, name)).column("image").slice(0, _SAMPLES).to_pylist()
        pictures = [np.asarray(Image.open(io.BytesIO(one["bytes"]))) for one in stored]
        line = np.hstack([np.pad(picture, 1) for picture in pictures])
        lines.append(
            np.pad(line, ((0, 0), (0, _SAMPLES * (pictures[0].shape[1] + 2) - line.shape[1])))
        )
    whole = Image.fromarray(np.vstack(lines))
    drawn = io.BytesIO()
    whole.resize((2 * whole.width, 2 * whole.height), Image.Resampling.NEAREST).save(drawn, "png")
    return drawn.getvalue()


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
