"""A triangle surface with colours, and its file; every phase after the meshes starts from it."""

from __future__ import annotations

import gzip
import io
import json
import tempfile
import zlib
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyParseError

from meshreaders.base.mesh import Mesh
from meshreaders.base.ply_header import LONGEST, check_ply_size, read_ply_header
from meshreaders.base.regular_files import open_regular
from meshreaders.base.texture import NO_IMAGE, WRAPS, Texture
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import MeshError

_BLOCK_BYTES = 1 << 20

_SET_ASIDE = "set aside: "
_NOTE = "note: "
_LONGEST_HEADER = 1 << 14  # bytes

_CHANNELS = ("red", "green", "blue")
_COORDINATES = ("u0", "v0", "u1", "v1", "u2", "v2")
_COLOUR = [(name, "u1") for name in _CHANNELS]
_IMAGE = [("width", "<i4"), ("height", "<i4"), ("wrap_u", "u1"), ("wrap_v", "u1")]


@dataclass(frozen=True, eq=False, repr=False)
class Surface(Mesh):
    """A triangle mesh with colours and images on its faces, with the attributes of `meshreaders.Mesh`.

    Vertices are right-handed coordinates, y up; in the object frame the bounding sphere has its centre at the origin
    and radius 1. `up_axis` is None also if the surface has been turned. Surfaces are compared by identity.
    """

    def stored_colours(self) -> NDArray[np.uint8]:
        """Return the colours of all faces and of all texels, shape (n, 3)."""
        if self.texture is None:
            return self.face_colours
        return np.concatenate([self.face_colours, self.texture.texels()])

    @cached_property
    def centroid(self) -> FloatArray:
        """Mean of all points of the surface, weighted by area, shape (3,)."""
        return np.average(self.triangles.mean(axis=1), axis=0, weights=self.face_areas)


def as_stored(surface: Surface) -> Surface:
    """Return a surface with vertices rounded to float32, the precision of its file."""
    vertices = surface.vertices.astype(np.float32).astype(np.float64)
    return replace(surface, vertices=vertices)


def write_set_aside(path: str | Path, reason: str) -> None:
    """Write an empty surface for a model that can't be used, with the reason, one sentence."""
    empty = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 3), np.uint8))
    _write(empty, path, [f"{_SET_ASIDE}{json.dumps(reason)}"])


def set_aside_reason(path: str | Path) -> str | None:
    """Return why the object of a mesh file was set aside; None for an object that takes part."""
    return next(_sentences_in_header(path, _SET_ASIDE), None)


def notes_of(path: str | Path) -> list[str]:
    """Read only the notes of a mesh file."""
    return list(_sentences_in_header(path, _NOTE))


def _sentences_in_header(path: str | Path, kind: str) -> Iterator[str]:
    start = f"comment {kind}"
    with open_regular(path) as stream:
        header = stream.read(_LONGEST_HEADER).partition(b"\nend_header")[0].decode(errors="replace")
    for line in header.splitlines():
        if line.startswith(start):
            yield str(json.loads(line[len(start) :]))


def object_of(mesh: str | Path) -> str:
    """Return the key `class/name` of a mesh file ``<class>/<name>.ply``."""
    mesh = Path(mesh)
    return f"{mesh.parent.name}/{mesh.stem}"


def meshes_in(
    folders: Iterable[str | Path], objects: Collection[str] | None = None
) -> dict[str, Path]:
    """Return the mesh file of each object by key `class/name`, sorted.

    Files are looked for in `folders`, as ``<folder>/<class>/<name>.ply``. If `objects` is not None, only these keys are
    returned.
    """
    paths = (file for folder in folders for file in Path(folder).glob("*/*.ply"))
    files = {object_of(path): path for path in paths}
    return {key: files[key] for key in sorted(files) if objects is None or key in objects}


def usable_meshes(paths: Iterable[str | Path]) -> list[Path]:
    """Return the mesh files of objects that were not set aside, in the order of `paths`."""
    return [path for path in map(Path, paths) if set_aside_reason(path) is None]


def write_surface(surface: Surface, path: str | Path) -> None:
    """Write a surface as binary PLY, compressed with gzip if the name ends in ``.gz``. Missing folders are created.

    Vertices are stored as float32, the precision of the ray caster. With a texture, each face has the index of its
    image and the texture coordinates of its corners. Elements `image` and `texel`, which other programs ignore, follow.
    Notes are comments of the header. The bytes depend only on the surface.
    """
    _write(surface, path, [f"{_NOTE}{json.dumps(note)}" for note in surface.notes])


def _write(surface: Surface, path: str | Path, comments: list[str]) -> None:
    vertex = np.zeros(len(surface.vertices), dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4")])
    for axis, name in enumerate("xyz"):
        vertex[name] = surface.vertices[:, axis]
    face = np.zeros(
        len(surface.faces),
        dtype=[("vertex_indices", "<i4", (3,)), *_COLOUR, *_face_columns(surface.texture)],
    )
    face["vertex_indices"] = surface.faces
    for channel, name in enumerate(_CHANNELS):
        face[name] = surface.face_colours[:, channel]
    images = {} if surface.texture is None else _image_elements(surface.texture, face)
    elements = [
        PlyElement.describe(rows, name)
        for name, rows in {"vertex": vertex, "face": face, **images}.items()
    ]
    header = PlyData(elements, byte_order="<", comments=comments).header
    # plyfile writes lists one by one. All lists have three indices, so that one array holds all faces.
    lists = np.zeros(len(face), dtype=[("length", "u1"), ("face", face.dtype)])
    lists["length"], lists["face"] = 3, face
    blocks = (vertex, lists, *images.values())
    data = f"{header}\n".encode() + b"".join(block.tobytes() for block in blocks)
    with atomic_file(path) as unfinished:
        is_packed = Path(path).suffix == ".gz"
        unfinished.write_bytes(gzip.compress(data, 9, mtime=0) if is_packed else data)


def read_surface(path: str | Path, largest_megabytes: float = 512.0) -> Surface:
    """Read a surface that `write_surface` wrote.

    Raises `MeshError` if the file is no coloured triangle mesh, is shorter than its header claims, or unpacks to more
    than `largest_megabytes`, in 10⁶ bytes.
    """
    try:
        with _plain_file(Path(path), largest_megabytes) as stream:
            _check_header(stream)
            data = PlyData.read(stream, known_list_len={"face": {"vertex_indices": 3}})
        vertex, face = data["vertex"], data["face"]
        vertices = np.column_stack([vertex[name] for name in "xyz"]).astype(np.float64)
        faces = np.asarray(face["vertex_indices"], dtype=np.int64).reshape(-1, 3)
        colours = np.column_stack([face[name] for name in _CHANNELS]).astype(np.uint8)
        texture = _read_texture(data) if "image" in data else None
    except (OSError, EOFError, zlib.error, PlyParseError, KeyError, ValueError) as error:
        if isinstance(error, OSError) and error.strerror:
            raise MeshError(f"{path} can't be read: {error.strerror}.") from error
        raise MeshError(
            f"{path} is no coloured triangle mesh of this workflow: {error}."
        ) from error
    notes = [
        json.loads(comment[len(_NOTE) :]) for comment in data.comments if comment.startswith(_NOTE)
    ]
    return Surface(vertices, faces, colours, texture, tuple(notes))


def _face_columns(texture: Texture | None) -> list[tuple[str, str]]:
    return [] if texture is None else [("image", "<i4"), *((name, "<f4") for name in _COORDINATES)]


def _image_elements(texture: Texture, face: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Fill the texture columns of `face`, and return the rows of the elements `image` and `texel`."""
    face["image"] = texture.image
    for column, name in enumerate(_COORDINATES):
        face[name] = texture.corners.reshape(-1, 6)[:, column]
    rows = np.array(
        [
            (*image.shape[1::-1], *wraps)
            for image, wraps in zip(texture.images, texture.wraps, strict=True)
        ],
        dtype=_IMAGE,
    )
    return {"image": rows, "texel": texture.texels().view(_COLOUR)[:, 0]}


def _read_texture(data: Any) -> Texture:
    """Read the texture of a file; raise `ValueError` if `write_surface` can't have written it."""
    face, image, texel = data["face"], data["image"], data["texel"]
    sizes = np.column_stack([image[name] for name in ("height", "width")]).astype(np.int64)
    wraps = np.column_stack([image[name] for name in ("wrap_u", "wrap_v")]).astype(np.uint8)
    numbers = np.asarray(face["image"], dtype=np.int32)
    corners = np.column_stack([face[name] for name in _COORDINATES]).astype(np.float32)
    texels = np.column_stack([texel[name] for name in _CHANNELS]).astype(np.uint8)
    if numbers.min(initial=0) < NO_IMAGE or numbers.max(initial=NO_IMAGE) >= len(sizes):
        raise ValueError(f"a face has an image index outside of {NO_IMAGE} to {len(sizes) - 1}")
    if wraps.max(initial=0) >= len(WRAPS) or not np.isfinite(corners).all():
        raise ValueError(f"a texture coordinate is not finite, or a wrap is above {len(WRAPS) - 1}")
    ends = np.cumsum(sizes.prod(axis=1))[:-1]
    images = tuple(
        block.reshape(*size, 3) for block, size in zip(np.split(texels, ends), sizes, strict=True)
    )
    return Texture(corners.reshape(-1, 3, 2), numbers, images, wraps)


def _check_header(stream: BinaryIO) -> None:
    """Raise `ValueError`, before any row is read, for a header that `write_surface` can't have written."""
    header = read_ply_header(stream.read(LONGEST))
    if header.ascii:
        raise ValueError(
            "its rows are text; binary rows are needed (your own PLY files must not end in .gz)"
        )
    check_ply_size(header, stream.seek(0, io.SEEK_END))
    stream.seek(0)


@contextmanager
def _plain_file(path: Path, largest_megabytes: float) -> Iterator[BinaryIO]:
    """Open a file, or a temporary file with its unpacked content: plyfile reads arrays only from real files."""
    if path.suffix != ".gz":
        with open_regular(path) as plain:
            yield plain
        return
    with (
        open_regular(path) as stream,
        gzip.open(stream) as packed,
        tempfile.TemporaryFile() as unpacked,
    ):
        while block := packed.read(_BLOCK_BYTES):
            unpacked.write(block)
            if unpacked.tell() > largest_megabytes * 1e6:
                raise MeshError(
                    f"{path} unpacks to more than {largest_megabytes:g} MB, which is the largest allowed size "
                    "(meshes.largest_megabytes)."
                )
        unpacked.seek(0)
        yield unpacked
