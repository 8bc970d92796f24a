"""`visuohaptic press`: sensors at given poses on a mesh, in the frame of its file."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, Literal

import typer

from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import LayoutWarning
from visuohaptic.base.quick_imports import keep_pandas_out, quick_imports
from visuohaptic.cli.printing import file_to_read, folder_to_write, say

MOST_ALONG_EDGE = 1024
"""Limit of rows and of columns of an imprint: that of `exploration.pressing`, which is imported later."""


def press(
    mesh: Annotated[
        Path, typer.Argument(metavar="MESH", parser=file_to_read, help="The mesh file.")
    ],
    poses: Annotated[
        Path,
        typer.Option(
            parser=file_to_read,
            help="CSV file of poses: x, y, z in the mesh's unit, and qw, qx, qy, qz, or normal_x, normal_y, normal_z and roll in degrees.",
        ),
    ],
    size: Annotated[
        float | None,
        typer.Option(
            help="Width of the sensors, in the mesh's unit.",
            show_default="the layout's width",
        ),
    ] = None,
    layout: Annotated[
        str | None,
        typer.Option(
            help="Taxels instead of a grid: round, dome, finger, gripper, or a CSV file with x, y, z and direction_x, direction_y, direction_z.",
        ),
    ] = None,
    layout_unit: Annotated[
        Literal["mm", "cm", "m", "in"] | None,
        typer.Option(help="Unit of length of the CSV file of --layout."),
    ] = None,
    height: Annotated[
        float | None,
        typer.Option(help="Height of the sensors, in the mesh's unit.", show_default="the width"),
    ] = None,
    resolution: Annotated[
        int, typer.Option(min=2, max=MOST_ALONG_EDGE, help="Sensing points along the width.")
    ] = 32,
    depth: Annotated[
        float | None,
        typer.Option(
            help="Largest depth below its plane that a sensor feels, in the mesh's unit.",
            show_default="a third of the larger side",
        ),
    ] = None,
    scene: Annotated[
        str | None, typer.Option(help="Preset of simulated effects: ideal, fsr400 or worn_fsr.")
    ] = None,
    unit: Annotated[
        Literal["mm", "cm", "m", "in"] | None,
        typer.Option(
            help="Unit of length of the mesh, for --scene and for --layout without --size."
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option(parser=folder_to_write, help="Folder for the imprints and the picture.")
    ] = Path("pressed"),
) -> None:
    """Press sensors on a mesh at given poses.

    Writes imprints.npy, heights.npy and picture.png, and with --layout the picture layout.png of the first imprint,
    coloured by its readings. The file poses.csv of `visuohaptic touch` can be used as
    --poses.

    Example: visuohaptic press mug.stl --poses poses.csv --size 10

    Example: visuohaptic press mug.stl --poses poses.csv --layout dome --unit mm
    """
    with quick_imports():
        import numpy as np

        from visuohaptic.exploration.pose_files import read_poses
        from visuohaptic.exploration.pressing import press as press_sensors
        from visuohaptic.geometry.pads import PADS
        from visuohaptic.io.layout_files import read_layout
        from visuohaptic.meshes.model_files import read_mesh
    keep_pandas_out()

    surface = read_mesh(mesh)
    options: dict[str, Any] = {"depth": depth, "scene": scene, "unit": unit}
    if layout is not None:
        if height is not None:
            raise typer.BadParameter("a layout has no --height.", param_hint="--height")
        taxels = layout if layout in PADS else read_layout(layout, layout_unit)
        options |= {"layout": taxels, "size": size, "resolution": resolution}
    elif size is None:
        raise typer.BadParameter("a width is needed without --layout.", param_hint="--size")
    else:
        sensor_height = size if height is None else height
        rows = _rows(resolution, size, sensor_height)
        options |= {"size": (size, sensor_height), "resolution": (rows, resolution)}
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", LayoutWarning)
        pressed = press_sensors(surface, poses=read_poses(poses), **options)
    for name, array in (("imprints.npy", pressed.images), ("heights.npy", pressed.heights)):
        with atomic_file(out / name) as unfinished, unfinished.open("wb") as stream:
            # NumPy writes to a file itself, with errors that give no reason; it writes to other objects by `write`.
            np.save(SimpleNamespace(write=stream.write), array, allow_pickle=False)
    pictures = {"picture.png": pressed.picture()}
    if layout is not None and len(pressed.poses):
        pictures["layout.png"] = pressed.layout_picture()
    for name, picture in pictures.items():
        with atomic_file(out / name) as unfinished:
            picture.save(unfinished, "png")
    say(f"{mesh}: {pressed!r}")
    for note in (*surface.notes, *(str(warning.message) for warning in said)):
        say(f"  note: {note}")
    for name in ("imprints.npy", "heights.npy", *pictures):
        say(f"  {out / name}")


def _rows(columns: int, width: float, height: float) -> int:
    """Return the rows of square cells; lengths that are no positive numbers are left to `press`."""
    if not 0 < width < math.inf or not 0 < height < math.inf:
        return columns
    rows = columns * height / width
    if rows > MOST_ALONG_EDGE + 1:
        raise typer.BadParameter(
            f"square cells need {rows:g} rows at this --size and --resolution; {MOST_ALONG_EDGE} are allowed.",
            param_hint="--height",
        )
    return max(2, round(rows))
