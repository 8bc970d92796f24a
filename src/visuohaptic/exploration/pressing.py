"""A tactile array at any pose on a mesh: one call, many poses, no experiment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError, ParameterError
from visuohaptic.exploration.checking import LARGEST, check_magnitudes, point_rows, unit_rows
from visuohaptic.exploration.pose_files import matrices, turned
from visuohaptic.exploration.showing import png_of
from visuohaptic.exploration.sources import surface_in_memory
from visuohaptic.exploration.units import UNITS
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import as_parameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.effect_pipeline import TouchBatch
from visuohaptic.sensor.effects import simulate
from visuohaptic.sensor.imprints import Poses, cast_heights, sensing_offsets, stand_on
from visuohaptic.sensor.parameters import Orientation
from visuohaptic.sensor.random_fields import RandomFields

if TYPE_CHECKING:
    from trimesh import Trimesh

    Mesh: TypeAlias = Trimesh | tuple[ArrayLike, ArrayLike]

MOST_RADII = 1e30
"""Rays are cast in float32, which ends at 3e38."""
ORIENTATIONS = ("upright", "transported")
_MOST_PICTURED = 64
_PIXELS = 96


@dataclass(frozen=True, eq=False)
class Pressed:
    """What n sensors feel with r rows and c columns of sensing points; it is equal to itself alone.

    Attributes
    ----------
    images : numpy.ndarray
        Shape (n, r, c), float32: 1 where the surface is at the sensor's plane or above it, 0 where it
        is `depth` or more below; with a scene, its readings.
    heights : numpy.ndarray
        Shape (n, r, c), float64, in the mesh's unit: the surface above the sensor's plane, negative
        below it, minus infinity where there is none.
    poses : numpy.ndarray
        Shape (n, 4, 4), float64, in the mesh's frame: origin at the plane's centre, x along the columns,
        y against the rows, z away from the object.
    sizes : numpy.ndarray
        Shape (n, 2), float64, in the mesh's unit: width and height of the planes.
    """

    images: NDArray[np.float32]
    heights: FloatArray
    poses: FloatArray
    sizes: FloatArray

    def __repr__(self) -> str:
        count, rows, columns = self.images.shape
        touching = int((self.images > 0).any(axis=(1, 2)).sum())
        return (
            f"<Pressed: {count} imprints of {rows} x {columns}, {touching} of which feel something>"
        )

    def _repr_png_(self) -> bytes:
        return png_of(self.picture())

    @property
    def points(self) -> FloatArray:
        """Points of the surface that are felt, shape (n, r, c, 3), mesh frame; NaN where there is none."""
        _, rows, columns = self.heights.shape
        aside = 0.5 * self.sizes[:, :1] * sensing_offsets(columns)
        down = 0.5 * self.sizes[:, 1:] * sensing_offsets(rows)
        heights = np.where(np.isfinite(self.heights), self.heights, np.nan)
        x, y, z = (self.poses[:, None, None, :3, axis] for axis in range(3))
        found: FloatArray = (
            self.poses[:, None, None, :3, 3]
            + aside[:, None, :, None] * x
            - down[:, :, None, None] * y
            + heights[..., None] * z
        )
        return found

    def picture(self) -> Image.Image:
        """Draw the imprints side by side, white where they touch; of many the first 64.

        Returns
        -------
        PIL.Image.Image
            The picture.
        """
        shown = self.images[:_MOST_PICTURED]
        across = max(1, int(np.ceil(np.sqrt(len(shown)))))
        down = max(1, -(-len(shown) // across))
        _, rows, columns = self.images.shape
        step = _PIXELS / max(rows, columns)
        tile = (max(1, round(columns * step)), max(1, round(rows * step)))
        picture = Image.new("L", (across * (tile[0] + 4) + 4, down * (tile[1] + 4) + 4), 64)
        for number, image in enumerate(shown):
            place = divmod(number, across)
            part = Image.fromarray(np.round(255 * image).astype(np.uint8))
            corner = (4 + place[1] * (tile[0] + 4), 4 + place[0] * (tile[1] + 4))
            picture.paste(part.resize(tile, Image.Resampling.NEAREST), corner)
        return picture


def press(
    mesh: Mesh,
    points: ArrayLike | None = None,
    normals: ArrayLike | None = None,
    size: ArrayLike | None = None,
    resolution: int | tuple[int, int] = 32,
    depth: float | None = None,
    above: float | None = None,
    orientation: Orientation = "upright",
    *,
    poses: ArrayLike | None = None,
    roll: ArrayLike = 0.0,
    scene: Scene | Mapping[str, Any] | str | None = None,
    unit: str | None = None,
    seed: int = 0,
) -> Pressed:
    """Press rectangular sensors on a mesh, all in one batch.

    Lengths and positions are those of the mesh; nothing is turned, moved or scaled.

    Parameters
    ----------
    mesh : trimesh.Trimesh or (vertices, faces)
        The object; arrays of the shapes (v, 3) and (f, 3).
    points : array_like, optional
        Shape (n, 3): centres of the sensors' planes, on the surface or anywhere else.
    normals : array_like, optional
        Shape (n, 3): away from the object; any length but 0.
    size : array_like
        Edge of the squares: a number, or shape (n,). Of rectangles the width (along columns) and the
        height: shape (1, 2) for all, or (n, 2); a tuple of two numbers is (width, height), too.
    resolution : int or (int, int)
        Sensing points along an edge, or rows and columns.
    depth : float, optional
        How deep below its plane a sensor feels; a third of the largest size by default.
    above : float, optional
        How far above the plane the sensors come from; what is higher is not met. The largest size by
        default.
    orientation : {"upright", "transported"}
        How planes are turned about their normals; poses say it themselves.
    poses : array_like, optional
        Shape (n, 4, 4), instead of points and normals: origin at the plane's centre, x along the columns
        of the imprint, y against its rows, z away from the object, as `Exploration.poses` gives them.
    roll : array_like
        By how many degrees planes are turned about their normals, counterclockwise seen from outside: a
        number, or shape (n,).
    scene : Scene, mapping or str, optional
        What is simulated beside the geometry: a preset such as ``"fsr400"``, or section `scene` of the
        parameters. Cells must be square then, and the unit be given.
    unit : {"mm", "cm", "m", "in"}, optional
        The mesh's unit of length, for a scene.
    seed : int
        Random seed, for a scene with noise, scattered gains or dead cells.

    Returns
    -------
    Pressed
        Rows count downwards and columns to the right, seen from outside.

    Raises
    ------
    MeshError
        If the mesh has nothing to touch.
    ParameterError
        If a pose or a measure is not allowed.
    """
    stands = turned(_stand(points, normals, poses, orientation), roll)
    grid = _grid(resolution)
    sizes = _sizes(size, len(stands))
    largest = float(sizes.max(initial=0.0)) or 1.0
    deep = float(_positive(np.array(largest / 3 if depth is None else depth), "depth"))
    high = float(_positive(np.array(largest if above is None else above), "above"))
    surface, centre, radius = _unit_surface(mesh)
    farthest = max(np.abs(stands.points).max(initial=0.0), largest, high)
    if farthest > MOST_RADII * radius:
        raise ParameterError(
            f"Points or lengths are up to {farthest:g} and the mesh's radius is {radius:g}; at most "
            f"{MOST_RADII:g} radii are allowed."
        )
    within = replace(stands, points=(stands.points - centre) / radius)
    lifts = np.full(len(stands), high / radius)
    heights = radius * cast_heights(
        RayCaster(surface), within, sizes[:, ::-1] / radius, lifts, grid
    )
    images = np.clip(1 + heights / deep, 0, 1)
    if scene is not None:
        images = _readings(images, heights, sizes, scene, unit, seed)
    return Pressed(images.astype(np.float32), heights, matrices(stands), sizes)


def _readings(
    contact: FloatArray,
    heights: FloatArray,
    sizes: FloatArray,
    scene: Scene | Mapping[str, Any] | str,
    unit: str | None,
    seed: int,
) -> FloatArray:
    """Give the readings of sensors in a scene, of full scale."""
    if unit not in UNITS:
        raise ParameterError(
            f"A scene has real lengths and unit is {unit!r}; {', '.join(UNITS)} are allowed."
        )
    _, rows, columns = contact.shape
    cells = sizes / [columns, rows]
    if rows != columns or not np.allclose(cells[:, 0], cells[:, 1], rtol=1e-9):
        raise ParameterError(
            f"A scene needs square sensors and the first is {sizes[0, 0]:g} x {sizes[0, 1]:g} with {rows} rows and "
            f"{columns} columns."
        )
    if not isinstance(scene, Scene):
        named = {"preset": scene} if isinstance(scene, str) else dict(scene)
        scene = as_parameters({"scene": named}).scene
    metres = UNITS[unit]
    fields = RandomFields(seed, [("press", number) for number in range(len(contact))])
    gaps = metres * np.maximum(-heights, 0.0)
    return simulate(TouchBatch(scene, gaps, metres * cells[:, 0], fields), contact)[0]


def _stand(
    points: ArrayLike | None,
    normals: ArrayLike | None,
    poses: ArrayLike | None,
    orientation: Orientation,
) -> Poses:
    if orientation not in ORIENTATIONS:
        raise ParameterError(
            f"orientation is {orientation!r}; {', '.join(ORIENTATIONS)} are allowed."
        )
    if (poses is None) == (points is None) or (points is None) != (normals is None):
        raise ParameterError("Sensors stand at points with normals, or at poses: give either.")
    if poses is not None:
        found = np.asarray(poses, dtype=np.float64)
        _check_poses(found)
        columns, upwards, outward = (found[:, :3, axis] for axis in range(3))
        return Poses(found[:, :3, 3], outward, columns, -upwards)
    where = point_rows(points, "points")
    return stand_on(where, unit_rows(normals, "normals", len(where)), orientation)


def _check_poses(poses: FloatArray) -> None:
    if poses.ndim != 3 or poses.shape[1:] != (4, 4) or not np.isfinite(poses).all():
        raise ParameterError(
            f"poses has the shape {poses.shape}; (n, 4, 4), all finite, is needed."
        )
    check_magnitudes(poses, "poses")
    axes = poses[:, :3, :3]
    skew = np.abs(np.swapaxes(axes, 1, 2) @ axes - np.eye(3)).max(axis=(1, 2), initial=0.0)
    wrong = np.flatnonzero((skew > 1e-6) | (np.linalg.det(axes) < 0))
    if len(wrong):
        raise ParameterError(
            f"Pose {wrong[0]} turns by no rotation; three right-angled unit axes, right-handed, are needed."
        )


def _grid(resolution: int | tuple[int, int]) -> tuple[int, int]:
    """Give rows and columns."""
    counts = np.atleast_1d(np.asarray(resolution, dtype=np.float64))
    if counts.shape not in ((1,), (2,)) or (counts % 1 != 0).any() or counts.min() < 2:
        raise ParameterError(
            f"resolution is {resolution}; a whole number of 2 or more, or two of them, is allowed."
        )
    return int(counts[0]), int(counts[-1])


def _sizes(size: ArrayLike | None, count: int) -> FloatArray:
    """Give width and height of each sensor, shape (n, 2)."""
    if size is None:
        raise ParameterError("size is missing: the edge of the sensors, in the mesh's unit.")
    given = np.asarray(size, dtype=np.float64)
    if isinstance(size, tuple) and given.shape == (2,):
        given = given[None]
    if given.ndim < 2:
        given = np.repeat(np.reshape(given, (-1, 1)), 2, axis=1)
    if given.shape not in ((1, 2), (count, 2)):
        raise ParameterError(
            f"size has the shape {np.shape(size)}; a number, (width, height), or one of these for each of {count} "
            "poses is needed."
        )
    return _positive(np.broadcast_to(given, (count, 2)), "size").copy()


def _unit_surface(mesh: Mesh) -> tuple[Surface, FloatArray, float]:
    """Give the mesh within the unit ball, where rays are exact enough, its centre and radius."""
    surface = surface_in_memory(mesh, "mesh")
    if surface is None:
        raise MeshError(
            f"The mesh is of type {type(mesh).__name__}; a trimesh.Trimesh or (vertices, faces) is needed."
        )
    vertices, faces = surface.vertices, surface.faces
    if not len(faces) or not np.isfinite(vertices).all():
        raise MeshError(
            "The mesh has no faces, or vertices that are not finite; a surface is needed."
        )
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshError(f"The mesh has {len(vertices)} vertices and faces that name others.")
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    radius = float(np.linalg.norm(vertices - centre, axis=1).max())
    if not radius > 0:
        raise MeshError("All vertices of the mesh are one point; there is nothing to touch.")
    return replace(surface, vertices=(vertices - centre) / radius), centre, radius


def _positive(values: FloatArray, name: str) -> FloatArray:
    wrong = values[~((values > 0) & (values <= LARGEST))]
    if wrong.size:
        raise ParameterError(
            f"{name} holds {wrong[0]:g}; lengths above 0 and up to {LARGEST:g} are allowed."
        )
    return values
