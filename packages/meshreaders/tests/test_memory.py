"""The memory that reading a mesh takes, in multiples of the file's unpacked size."""

import tracemalloc

import numpy as np
import pytest
import trimesh
from mesh_files.generated import (
    as_dae,
    as_gltf,
    as_obj,
    as_off,
    as_ply,
    exported,
    model,
    object_of,
    three_mf,
)

import meshreaders

PARTS = 20


def grid(side):
    """A square of side x side cells, two triangles each."""
    across = np.linspace(-1, 1, side + 1).astype(np.float32)
    x, y = np.meshgrid(across, across)
    points = np.column_stack([x.ravel(), y.ravel(), np.sin(3 * x.ravel())])
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    halves = [first, first + 1, first + side + 2], [first, first + side + 2, first + side + 1]
    return points, np.concatenate([np.column_stack(half) for half in halves])


def quads_of(faces):
    """The squares that the triangles of a grid are halves of."""
    first, second = np.split(faces, 2)
    return np.column_stack([first, second[:, 2]])


def half_quads_of(faces):
    """The triangles of half the squares, and the other squares."""
    first, second = np.split(faces, 2)
    half = len(first) // 2
    return [*first[:half], *second[:half], *quads_of(faces)[half:]]


def with_pentagons_of(faces):
    """The rows of a grid in turn as squares, as triangles, and as pentagons beside a triangle each."""
    side = int((len(faces) / 2) ** 0.5)
    squares = quads_of(faces).reshape(side, side, 4)
    polygons = []
    for number, row in enumerate(squares.tolist()):
        if number % 3 == 0:
            polygons += row
        elif number % 3 == 1:
            polygons += [[a, *pair] for a, b, c, d in row for pair in ((b, c), (c, d))]
        else:
            pairs = zip(row[::2], row[1::2], strict=True)
            for (a, b, c, d), (_, e, f, _) in pairs:
                polygons += [[a, b, f, c, d], [b, e, f]]
    return polygons


def as_uneven_ply(points, faces):
    """Text with a colour behind each vertex, and faces of 3, 4 and 5 corners."""
    plain = as_ply(points, with_pentagons_of(faces), "ascii")
    head, body = plain.split(b"element face")
    names = b"".join(b"property uchar %s\n" % name for name in (b"red", b"green", b"blue"))
    header, rows = body.split(b"end_header\n")
    rows = rows.split(b"\n")
    coloured = [row + b" 10 20 30" for row in rows[: len(points)]]
    return b"".join(
        [
            head,
            names,
            b"element face",
            header,
            b"end_header\n",
            b"\n".join(coloured + rows[len(points) :]),
        ]
    )


def wrapped(text, line_feeds):
    """The words behind the first two lines in lines of 1 to 11 words, or all on one line."""
    *head, body = text.split(b"\n", 2)
    words = body.split()
    if not line_feeds:
        return b"\n".join([*head, b" ".join(words)])
    ends = np.cumsum(np.random.default_rng(0).integers(1, 12, len(words)))
    starts = [0, *ends[ends < len(words)].tolist()]
    lines = [b" ".join(words[a:b]) for a, b in zip(starts, [*starts[1:], None], strict=True)]
    return b"\n".join([*head, *lines])


def as_parts(points, faces):
    # trimesh writes equal arrays once.
    parts = [
        trimesh.Trimesh(points + part, np.roll(faces, part, axis=0), process=False)
        for part in range(PARTS)
    ]
    return trimesh.Scene(parts).export(file_type="glb")


def as_3mf(points, faces):
    vertices = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*point) for point in points.tolist())
    triangles = "".join(
        '<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in faces.tolist()
    )
    shape = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
    return model(object_of(shape))


# Three times the file, as docs/README.md says, and what blocks of text add in a small file.
WRITERS = {
    "binary.ply": (250, 3.1, as_ply),
    "text.ply": (190, 3.1, lambda points, faces: as_ply(points, faces, "ascii")),
    "quads.ply": (290, 3.1, lambda points, faces: as_ply(points, quads_of(faces))),
    "mixed.ply": (280, 3.1, lambda points, faces: as_ply(points, half_quads_of(faces))),
    "uneven.ply": (186, 3.1, as_uneven_ply),
    "a.off": (190, 3.1, as_off),
    "wrapped.off": (190, 3.1, lambda *mesh: wrapped(as_off(*mesh), line_feeds=True)),
    "one_line.off": (190, 3.1, lambda *mesh: wrapped(as_off(*mesh), line_feeds=False)),
    "binary.stl": (170, 3.1, lambda *mesh: exported(*mesh, "stl")),
    "text.stl": (75, 3.1, lambda *mesh: exported(*mesh, "stl_ascii")),
    "a.glb": (290, 3.1, lambda *mesh: exported(*mesh, "glb")),
    "parts.glb": (65, 3.1, as_parts),
    "inline.gltf": (240, 3.1, as_gltf),
    "quads.obj": (210, 3.1, lambda points, faces: as_obj(points, quads_of(faces))),
    "mixed.obj": (198, 3.1, lambda points, faces: as_obj(points, with_pentagons_of(faces))),
    "a.obj": (190, 3.1, as_obj),
    "a.dae": (190, 3.1, lambda *mesh: as_dae(*mesh, "polylist")),
    "a.3mf": (140, 3.1, as_3mf),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WRITERS)
def test_reading_takes_a_small_multiple_of_the_unpacked_file(name, tmp_path):
    side, most, write = WRITERS[name]
    content = write(*grid(side))
    size = len(content)
    assert 2.5e6 < size < 4.5e6
    path = tmp_path / name
    path.write_bytes(three_mf(content) if name == "a.3mf" else content)
    # Imports of the first reading take memory of their own.
    meshreaders.read((np.eye(3), np.array([[0, 1, 2]])))
    tracemalloc.start()
    surface = meshreaders.read(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(surface.faces) == 2 * side * side * (PARTS if name == "parts.glb" else 1)
    assert peak < most * size
