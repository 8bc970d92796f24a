"""Objects and explorations as a model that a reader turns: in a notebook, or as a page in the browser."""

from __future__ import annotations

import re
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np
import pyarrow as pa

from visuohaptic.active.registry import strategy_of
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import ParameterError
from visuohaptic.exploration.recognising import GIVEN
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.encoding import imprint_sheet, webp_address
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.pictures.model_figure import ModelFigure, model_page
from visuohaptic.pictures.models import pack_model
from visuohaptic.pictures.object_pictures import PACKED
from visuohaptic.pictures.taxels import imprint_images
from visuohaptic.tables.phases import NORMAL_NAMES
from visuohaptic.tables.schema import matrix

FACES_SHOWN = 20_000
"""Largest number of faces of a model that is shown; a surface with more faces is simplified by `merge_cells`."""

_EYE = ("eye_x", "eye_y", "eye_z")

_FRAME = (
    '<iframe srcdoc="{page}" title="{title}" loading="lazy" '
    'style="width:100%;max-width:60rem;height:36rem;border:0"></iframe>'
)


def object_figure(key: str, surface: Surface) -> ModelFigure:
    """Return the figure of an object without touches."""
    return ModelFigure(key, _model(surface, np.zeros((0, len(PACKED)))), has_focus=True)


def exploration_figure(
    key: str,
    surface: Surface,
    parameters: ExperimentParameters,
    strategy: str,
    views: pa.Table,
    touches: pa.Table,
) -> ModelFigure:
    """Return the figure of an object with its touches; the first viewpoint with touches is shown first.

    `views` and `touches` are tables of an `Exploration`. Touches at given points are seen from the mean of their
    normals.
    """
    columns = ("viewpoint", "touch", "contact_state")
    viewpoints, numbers, states = (touches.column(name).to_pylist() for name in columns)
    cells = (touches.column(name).to_numpy().astype(np.int64) for name in ("viewpoint", "touch"))
    eyes = matrix(views, _EYE) if views.num_rows else _mean_normal(touches)[None]
    seen_from = views.column("viewpoint").to_pylist() if views.num_rows else [0]
    return ModelFigure(
        name=key,
        model=_model(surface, matrix(touches, PACKED)),
        touch_keys=[
            (strategy, viewpoint, number + 1, state)
            for viewpoint, number, state in zip(viewpoints, numbers, states, strict=True)
        ],
        sheets={
            strategy: webp_address(
                imprint_sheet(imprint_images(touches, parameters.sensor.taxels), *cells)
            )
        },
        strategies={strategy: "given points" if strategy == GIVEN else strategy_of(strategy).label},
        views=[
            (viewpoint, azimuth, elevation)
            for viewpoint, (azimuth, elevation) in zip(seen_from, _angles(eyes), strict=True)
            if viewpoint in set(viewpoints)
        ],
        shown=min(viewpoints),
        imprint_words=imprint_scale(parameters.sensor, parameters.scene).sentence,
        has_focus=True,
    )


def show_figure(figure: ModelFigure, line: str, path: str | Path | None) -> Path | None:
    """Show a figure with the caption `line`: in a notebook inline, otherwise as a page in the browser.

    `path`, the result and the errors are as in `TouchableObject.show`.
    """
    if path is not None and Path(path).is_dir():
        raise ParameterError(
            f"{path} is a folder; show needs a file, such as {Path(path) / 'model.html'}."
        )
    if path is not None:
        atomic_write_text(path, model_page(figure, line))
        return Path(path)
    publish = _publisher()
    if publish is not None:
        # A cell that is run again is not to take the keys from the notebook.
        page = model_page(replace(figure, has_focus=False), line)
        frame = _FRAME.format(page=escape(page), title=escape(line))
        publish({"text/html": frame, "text/plain": f"{figure.name}: {line}"})
        return None
    name = re.sub(r"[^\w.-]+", "_", figure.name.split("/")[-1])[:100]
    file = Path(tempfile.mkdtemp(prefix="visuohaptic-")) / f"{name}.html"
    atomic_write_text(file, model_page(figure, line))
    webbrowser.open(file.as_uri())
    return file


def merge_cells(surface: Surface, faces: int) -> Surface:
    """Return a surface with at most `faces` faces, by vertex clustering (Rossignac & Borrel 1993).

    Vertices within a cubic cell become one vertex, their mean. A face with two corners in the same cell is left out. A
    surface with at most `faces` faces is returned unchanged.
    """
    # Surface per cell: a plane through a grid of cells meets one to two cells per square, two faces per cell.
    edge = float(np.sqrt(2.0 * surface.face_areas.sum() / faces))
    merged = surface
    while len(merged.faces) > faces:
        merged, edge = _merged(surface, edge), 1.2 * edge
    return merged


def _merged(surface: Surface, edge: float) -> Surface:
    """Merge the vertices within each cube of an edge."""
    # The corner of the grid is outside, so that a large edge has all vertices in one cube.
    cubes = np.floor((surface.vertices - surface.vertices.min(axis=0)) / edge).astype(np.int64)
    _, cell_of, counts = np.unique(cubes, axis=0, return_inverse=True, return_counts=True)
    cell_of = cell_of.reshape(-1)
    sums = [np.bincount(cell_of, surface.vertices[:, axis]) for axis in range(3)]
    corners = cell_of[surface.faces]
    ordered = np.sort(corners, axis=1)
    whole = np.flatnonzero((ordered[:, 0] < ordered[:, 1]) & (ordered[:, 1] < ordered[:, 2]))
    _, first = np.unique(ordered[whole], axis=0, return_index=True)
    kept = whole[np.sort(first)]
    return Surface(
        np.stack(sums, axis=1) / counts[:, None], corners[kept], surface.face_colours[kept]
    )


def _model(surface: Surface, touches: FloatArray) -> dict[str, bytes | int]:
    """Return the packed model of a surface with at most `FACES_SHOWN` faces."""
    model = pack_model(merge_cells(surface, FACES_SHOWN), touches, FACES_SHOWN)
    return {**model, "original_faces": len(surface.faces)}


def _mean_normal(touches: pa.Table) -> FloatArray:
    """Return the mean normal (3,) of touches; the direction +z if the normals cancel out."""
    mean = matrix(touches, NORMAL_NAMES).mean(axis=0)
    return mean if np.linalg.norm(mean) > 0.1 else np.array([0.0, 0.0, 1.0])


def _angles(eyes: FloatArray) -> list[tuple[float, float]]:
    """Return azimuth and elevation in degrees of directions (n, 3)."""
    azimuths = np.degrees(np.arctan2(eyes[:, 0], eyes[:, 2])) % 360.0
    elevations = np.degrees(np.arcsin(eyes[:, 1] / np.linalg.norm(eyes, axis=1)))
    return list(zip(azimuths.tolist(), elevations.tolist(), strict=True))


def _publisher() -> Callable[[dict[str, str]], None] | None:
    """Return the function that displays data in the running notebook; None outside of a notebook."""
    ipython = sys.modules.get("IPython")
    if ipython is None:
        return None
    shell = ipython.get_ipython()
    # IPython in a terminal has no kernel.
    return shell.display_pub.publish if hasattr(shell, "kernel") else None
