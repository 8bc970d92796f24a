"""Convert meshes to meshes of trimesh, with their colours and images."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from meshreaders.base.arrays import IntArray
from meshreaders.base.errors import MissingPackageError
from meshreaders.base.mesh import Mesh
from meshreaders.base.texture import NO_IMAGE, Texture

if TYPE_CHECKING:
    from trimesh import Scene, Trimesh


def to_trimesh(mesh: Mesh) -> Trimesh | Scene:
    """Convert a mesh to trimesh, with colours of faces and images.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    trimesh.Trimesh or trimesh.Scene
        A `Trimesh` if no face has an image, or all faces have the same. Otherwise a `Scene` with one `Trimesh` per
        image, and one of the faces without an image. Faces keep their order within each. A vertex whose corners have
        several image coordinates is repeated. `metadata["notes"]` has the notes. trimesh repeats images beyond their
        edges; `material.wraps` has how an image continues, and `read` uses it.

    Raises
    ------
    MissingPackageError
        If trimesh is not installed.
    """
    if find_spec("trimesh") is None:
        raise MissingPackageError(
            "trimesh is not installed; `pip install 'meshreaders[trimesh]'` brings it."
        )
    trimesh = import_module("trimesh")
    shapes = [*_shapes(trimesh, mesh)]
    converted = shapes[0] if len(shapes) == 1 else trimesh.Scene(shapes)
    converted.metadata["notes"] = list(mesh.notes)
    return converted


def _shapes(trimesh: Any, mesh: Mesh) -> Iterator[Any]:
    """Yield a mesh of trimesh per image, and one of the faces without an image."""
    texture = mesh.texture
    if texture is None:
        yield _coloured(trimesh, mesh, np.arange(len(mesh.faces)))
        return
    for image in np.unique(texture.image):
        chosen = np.flatnonzero(texture.image == image)
        if image == NO_IMAGE:
            yield _coloured(trimesh, mesh, chosen)
        else:
            yield _with_image(trimesh, mesh, texture, chosen)


def _coloured(trimesh: Any, mesh: Mesh, chosen: IntArray) -> Any:
    used, faces = np.unique(mesh.faces[chosen], return_inverse=True)
    colours = np.column_stack([mesh.face_colours[chosen], np.full(len(chosen), 255, np.uint8)])
    return trimesh.Trimesh(
        mesh.vertices[used], faces.reshape(-1, 3), face_colors=colours, process=False
    )


def _with_image(trimesh: Any, mesh: Mesh, texture: Texture, chosen: IntArray) -> Any:
    """Return the faces of one image; corners that share vertex and image coordinates become a vertex."""
    from PIL.Image import fromarray

    image = int(texture.image[chosen[0]])
    corners = np.column_stack(
        [mesh.faces[chosen].reshape(-1), texture.corners[chosen].reshape(-1, 2)]
    )
    rows, faces = np.unique(corners, axis=0, return_inverse=True)
    visual = import_module("trimesh.visual")
    material = visual.material.PBRMaterial(baseColorTexture=fromarray(texture.images[image]))
    material.wraps = tuple(map(int, texture.wraps[image]))
    return trimesh.Trimesh(
        mesh.vertices[rows[:, 0].astype(np.int64)],
        faces.reshape(-1, 3),
        visual=visual.TextureVisuals(uv=rows[:, 1:], material=material),
        process=False,
    )
