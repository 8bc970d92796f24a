"""Make the table of the page's pictures of objects from views, touches and meshes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.pads import Taxels, layout_of
from visuohaptic.geometry.surface import read_surface
from visuohaptic.pictures.encoding import imprint_sheet, imprint_strip, shrink_picture
from visuohaptic.pictures.models import pack_model
from visuohaptic.pictures.taxels import imprint_images
from visuohaptic.tables.phases import (
    NORMAL_NAMES,
    POINT_NAMES,
    TANGENT_NAMES,
    TOUCHES,
    VIEWS,
    by_object,
    keys_of,
)
from visuohaptic.tables.pictures import PICTURES
from visuohaptic.tables.schema import build_rows, matrix, read_table, write_table
from visuohaptic.tables.stability import STABILITY

MODEL = ("model", "vertices", "faces", "touches", "original_faces")
"""Columns of `tables.PICTURES` that are None for an object without a mesh."""

PACKED = (*POINT_NAMES, *NORMAL_NAMES, *TANGENT_NAMES, "sensor_size")
"""Columns of a touch in a packed model."""


def make_pictures(
    meshes: Mapping[str, str | Path],
    views: Sequence[str | Path],
    touches: Sequence[str | Path],
    stability: str | Path,
    output: str | Path,
    shown: Collection[str],
    faces: int,
    layout: str | Taxels = "square",
) -> None:
    """Write `tables.PICTURES` of shown objects, and of objects that exceeded a tolerance.

    Parameters
    ----------
    meshes : mapping of str to path
        Mesh files by object, `class/name`.
    views, touches : sequence of paths
        Files of `tables.VIEWS` and `tables.TOUCHES`.
    stability : path
        A file of `tables.STABILITY`.
    output : path
        The file to write.
    shown : collection of str
        The objects to show, `class/name`.
    faces : int
        The number of faces per model.
    layout : str or sequence of rows
        Parameter `sensor.layout`.
    """
    # The resolution of a square is that of its imprints.
    pad = layout_of(layout, 2)
    wanted = {*shown, *_broken(read_table(STABILITY, stability))}
    felt = dict(by_object(read_table(TOUCHES, touches)))
    untouched = TOUCHES.arrow.empty_table()
    rows = [
        {
            **{name: seen.column(name)[0].as_py() for name in ("class", "object")},
            **_pictures_of_views(seen, _chosen(felt.get(key, untouched), strategy="fixation"), pad),
            **_model(meshes.get(key), felt.get(key, untouched), faces, pad),
        }
        for key, seen in by_object(read_table(VIEWS, views))
        if key in wanted
    ]
    write_table(PICTURES, build_rows(PICTURES, rows), output)


def _broken(checks: pa.Table) -> list[str]:
    """Return the objects, `class/name`, that exceeded a tolerance."""
    error = pc.field("worst_error")
    return keys_of(checks.filter(error.is_null() | (error > pc.field("tolerance")))).to_pylist()


def _pictures_of_views(seen: pa.Table, fixated: pa.Table, layout: Layout) -> dict[str, Any]:
    viewpoints = seen.column("viewpoint").to_pylist()
    views, maps = (seen.column(name).to_pylist() for name in ("view", "saliency"))
    felt = {viewpoint: _chosen(fixated, viewpoint=viewpoint) for viewpoint in viewpoints}
    return {
        "views": [*zip(viewpoints, map(shrink_picture, views), strict=True)],
        "saliency": [
            *zip(viewpoints, [shrink_picture(png, factor=2) for png in maps], strict=True)
        ],
        "imprints": [
            (viewpoint, imprint_strip(imprint_images(rows, layout)))
            for viewpoint, rows in felt.items()
            if rows.num_rows
        ],
    }


def _model(mesh: str | Path | None, felt: pa.Table, faces: int, layout: Layout) -> dict[str, Any]:
    """Return the columns of the thinned model, and the sheets of the imprints at its touches."""
    if mesh is None:
        return {"sheets": [], **dict.fromkeys(MODEL)}
    model = pack_model(read_surface(mesh), matrix(felt, PACKED), faces)
    return {"sheets": list(_sheets(felt, layout)), **model}


def _sheets(felt: pa.Table, layout: Layout) -> Iterator[tuple[str, bytes]]:
    for strategy in sorted(set(felt.column("strategy").to_pylist())):
        rows = _chosen(felt, strategy=strategy)
        cells = (rows.column(name).to_numpy().astype(np.int64) for name in ("viewpoint", "touch"))
        yield strategy, imprint_sheet(imprint_images(rows, layout), *cells)


def _chosen(table: pa.Table, **value: object) -> pa.Table:
    ((column, wanted),) = value.items()
    return table.filter(pc.field(column) == pc.scalar(wanted))
