"""Model files as people have them (OBJ, PLY, STL, GLB, OFF), read into a coloured surface."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from visuohaptic.errors import MeshError
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.catalogue import MODEL_SUFFIXES

if TYPE_CHECKING:
    from PIL.Image import Image

GREY = (160, 160, 160)
"""Colour, sRGB, of a face whose file names none."""

_LARGEST_TEXTURE_BYTES = 50 * 10**6

# Centroid and three points half-way to the corners: what a texture looks like over a face.
_TEXTURE_SAMPLES = np.array(
    [[1 / 3, 1 / 3, 1 / 3], [2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]]
)


def read_model(path: str | Path, largest_megabytes: float = 512.0) -> Surface:
    """Read a model file with trimesh, all its parts as one surface, a colour for each face.

    Materials give a face its diffuse colour; a texture is averaged over the face;
    vertex colours are averaged over the corners. Textures are looked for beside
    the file and below, never elsewhere; a missing one leaves the diffuse colour.

    Parameters
    ----------
    path : path
        An OBJ, PLY, STL, GLB or OFF file.
    largest_megabytes : float
        Files above this size, in 10⁶ bytes, are refused.

    Returns
    -------
    Surface
        In the file's own frame and unit, polygons cut into triangles.

    Raises
    ------
    MeshError
        If the file can't be read, is too large, or has no triangle.
    """
    path = Path(path)
    if path.suffix.lower() not in MODEL_SUFFIXES:
        raise MeshError(
            f"{path} ends in {path.suffix or 'nothing'!r}; {', '.join(MODEL_SUFFIXES)} are allowed."
        )
    _check_size(path, largest_megabytes)
    from trimesh.resolvers import FilePathResolver

    with path.open("rb") as stream:
        return _surface(stream, str(path), FilePathResolver(path))


def surface_from_stream(stream: BinaryIO, name: str, archive: ZipFile) -> Surface:
    """Read a model that lies in a zip archive, without unpacking it.

    Parameters
    ----------
    stream : binary file
        The model's content.
    name : str
        Its name in the archive; tells the format, and where its textures lie.
    archive : zipfile.ZipFile
        Where materials and textures are looked for, in the model's own folder.

    Returns
    -------
    Surface
        As `read_model` gives it.

    Raises
    ------
    MeshError
        If the content is no mesh, or has no triangle.
    """
    from trimesh.resolvers import ZipResolver

    folder, _, _ = name.rpartition("/")
    beside = {
        info.filename.removeprefix(f"{folder}/"): io.BytesIO(archive.read(info))
        for info in archive.infolist()
        if info.filename.startswith(f"{folder}/") and info.file_size <= _LARGEST_TEXTURE_BYTES
    }
    return _surface(stream, name, ZipResolver(beside))


def _surface(stream: BinaryIO, name: str, resolver: Any) -> Surface:
    parts = [part for part in _load_parts(stream, name, resolver) if len(part.faces)]
    if not parts:
        raise MeshError(f"{name} has no faces; a surface of triangles or polygons is needed.")
    flat = [part.vertices.shape for part in parts if part.vertices.shape[1:] != (3,)]
    if flat:
        raise MeshError(
            f"{name} has vertices of shape {flat[0]}; three coordinates for each are needed."
        )
    offsets = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    return Surface(
        np.concatenate([np.asarray(part.vertices, dtype=np.float64) for part in parts]),
        np.concatenate(
            [
                np.asarray(part.faces, dtype=np.int64) + o
                for part, o in zip(parts, offsets, strict=True)
            ]
        ),
        np.concatenate([_face_colours(part) for part in parts]),
    )


def _check_size(path: Path, largest_megabytes: float) -> None:
    try:
        size = path.stat().st_size
    except OSError as error:
        raise MeshError(f"{path} can't be read: {error.strerror}.") from error
    if size == 0:
        raise MeshError(f"{path} is empty.")
    if size > largest_megabytes * 1e6:
        raise MeshError(
            f"{path} has {size / 1e6:.0f} MB; {largest_megabytes:g} MB are allowed (meshes.largest_megabytes)."
        )


def _load_parts(stream: BinaryIO, name: str, resolver: Any) -> list[Any]:
    import trimesh

    suffix = Path(name).suffix[1:].lower()
    try:
        scene = trimesh.load_scene(stream, file_type=suffix, resolver=resolver, process=False)
        return [part for part in scene.dump() if isinstance(part, trimesh.Trimesh)]
    # A parser fed with a broken file may fail in any way; the file is what is wrong.
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise MeshError(f"{name} can't be read as {suffix.upper()}: {reason}.") from error


def _face_colours(part: Any) -> NDArray[np.uint8]:
    visual, count = part.visual, len(part.faces)
    if visual.kind == "texture":
        return _material_colours(visual, np.asarray(part.faces))
    if visual.kind == "vertex":
        corners = np.asarray(visual.vertex_colors)[part.faces][..., :3]
        return np.rint(corners.mean(axis=1)).astype(np.uint8)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return np.tile(np.array(GREY, dtype=np.uint8), (count, 1))


def _material_colours(visual: Any, faces: NDArray[np.int64]) -> NDArray[np.uint8]:
    material = visual.material
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    if image is not None and visual.uv is not None:
        return _sample_texture(image, np.asarray(visual.uv, dtype=np.float64)[faces])
    colour = np.asarray(material.main_color)[:3].astype(np.uint8)
    return np.tile(colour, (len(faces), 1))


def _sample_texture(image: Image, corner_uv: NDArray[np.float64]) -> NDArray[np.uint8]:
    pixels = np.asarray(image.convert("RGB"))
    height, width = pixels.shape[:2]
    uv = np.nan_to_num(np.einsum("sc,fck->fsk", _TEXTURE_SAMPLES, corner_uv)) % 1.0
    column = np.minimum((uv[..., 0] * width).astype(np.int64), width - 1)
    row = np.minimum(((1.0 - uv[..., 1]) * height).astype(np.int64), height - 1)
    return np.rint(pixels[row, column].mean(axis=1)).astype(np.uint8)
