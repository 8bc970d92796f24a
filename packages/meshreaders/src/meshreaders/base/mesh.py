"""A triangle mesh with colours and images on its faces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.arrays import FloatArray, IntArray
from meshreaders.base.texture import Texture


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh with colours and images on its faces. Meshes are compared by identity.

    Attributes
    ----------
    vertices : ndarray of shape (v, 3), float64
        Coordinates in the frame and unit of the file.
    faces : ndarray of shape (f, 3), int64
        Indices of vertices.
    face_colours : ndarray of shape (f, 3), uint8
        sRGB colour of each face; the mean colour for a face with an image.
    texture : Texture, optional
        None if no face has an image.
    notes : tuple of str
        Sentences for the user about the file, such as that an image was missing.
    up_axis : {"x", "y", "z"}, optional
        Axis that points up according to the file; None if the file names none.
    """

    vertices: FloatArray
    faces: IntArray
    face_colours: NDArray[np.uint8]
    texture: Texture | None = None
    notes: tuple[str, ...] = ()
    up_axis: Literal["x", "y", "z"] | None = None

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self.vertices):,} vertices, {len(self.faces):,} triangles>"

    @cached_property
    def triangles(self) -> FloatArray:
        """Corners of each face, shape (f, 3, 3)."""
        return self.vertices[self.faces]

    @cached_property
    def face_crosses(self) -> FloatArray:
        """Cross product of two edges of each face, shape (f, 3); its length is twice the area."""
        corners = self.triangles
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    @cached_property
    def face_areas(self) -> FloatArray:
        """Area of each face in squared units of the vertices, shape (f,)."""
        return 0.5 * np.linalg.norm(self.face_crosses, axis=1)

    @cached_property
    def face_normals(self) -> FloatArray:
        """Unit normal of each face on the side of its winding, shape (f, 3); zero for a face without area."""
        crosses = self.face_crosses
        lengths = np.linalg.norm(crosses, axis=1, keepdims=True)
        return np.divide(crosses, lengths, out=np.zeros_like(crosses), where=lengths > 0)
