"""The command `meshreaders`, which prints what a mesh file holds."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.base.mesh import Mesh
from meshreaders.base.texture import NO_IMAGE
from meshreaders.parts import join_parts
from meshreaders.reading import notes_on_vertices, read_parts


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command with arguments, by default those of the process; return its exit status, 1 after an error."""
    options = make_parser().parse_args(arguments)
    status = 0
    for file in options.files:
        try:
            lines = [*describe(file, options.largest_megabytes)]
        except MeshError as error:
            sys.stderr.write(f"error: {error}\n")
            status = 1
        else:
            sys.stdout.write("\n".join([*lines, ""]))
    return status


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command's arguments."""
    parser = argparse.ArgumentParser(prog="meshreaders", description="Read meshes.")
    parser.add_argument("--version", action="version", version=meshreaders.__version__)
    commands = parser.add_subparsers(dest="command", required=True)
    about = "Print format, parts, triangles, area, extents, colours and notes of meshes."
    info = commands.add_parser("info", help=about, description=about)
    info.add_argument("files", nargs="+", metavar="FILE")
    info.add_argument(
        "--largest-megabytes", type=float, default=512.0, help="largest size of a file (512)"
    )
    return parser


def describe(path: str | Path, largest_megabytes: float = 512.0) -> Iterator[str]:
    """Yield the lines of `meshreaders info` for a file.

    Area and extents have the unit of the file. Raises `MeshError` as `read` does.
    """
    given = read_parts(path, largest_megabytes=largest_megabytes)
    kind = Path(path).suffix[1:].upper()
    try:
        mesh = join_parts(given.parts)
    except MeshError as error:
        raise MeshError(f"{path} can't be read as {kind}: {error}.") from error
    # Infinite vertices have no area; a note counts them.
    with np.errstate(invalid="ignore"):
        extents, area = np.ptp(mesh.triangles.reshape(-1, 3), axis=0), mesh.face_areas.sum()
    yield str(path)
    yield f"  format     {kind}"
    yield f"  parts      {len(given.parts):,}"
    yield f"  triangles  {len(mesh.faces):,}"
    yield f"  area       {area:.6g}"
    yield f"  extents    {' × '.join(f'{extent:.6g}' for extent in extents)} (x × y × z)"
    yield f"  up axis    {given.up_axis or 'the file states none'}"
    yield f"  colours    {_colours(mesh)}"
    for note in (*notes_on_vertices(mesh, str(path)), *given.notes):
        yield f"  note       {note}"


def _colours(mesh: Mesh) -> str:
    """Return the number of colours of faces without an image, and the sizes of images with their shares of faces."""
    if mesh.texture is None:
        return f"{_counted(mesh.face_colours)} on {_triangles(len(mesh.faces))}"
    sizes = [f"{image.shape[1]} × {image.shape[0]}" for image in mesh.texture.images]
    numbers = [int((mesh.texture.image == index).sum()) for index in range(len(sizes))]
    texts = [
        f"an image of {size} pixels on {_triangles(number)}"
        for size, number in zip(sizes, numbers, strict=True)
    ]
    plain = mesh.face_colours[mesh.texture.image == NO_IMAGE]
    if len(plain):
        texts.append(f"{_counted(plain)} on {_triangles(len(plain))}")
    return "; ".join(texts)


def _counted(colours: NDArray[np.uint8]) -> str:
    number = len(np.unique(colours, axis=0))
    return f"{number:,} colour{'' if number == 1 else 's'}"


def _triangles(number: int) -> str:
    return f"{number:,} triangle{'' if number == 1 else 's'}"
