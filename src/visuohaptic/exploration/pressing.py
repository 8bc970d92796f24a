"""Press tactile pads at given poses on a mesh, without views and without an experiment."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from meshreaders.reading import name_of
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import LayoutWarning, MeshError, ParameterError
from visuohaptic.base.units import UNITS
from visuohaptic.exploration.checking import FARTHEST, numbers, point_rows, unit_rows
from visuohaptic.exploration.pose_files import matrices, turned
from visuohaptic.exploration.showing import png_of
from visuohaptic.geometry.layouts import Layout, grid_layout
from visuohaptic.geometry.pads import PADS, layout_of
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.io.layout_files import read_layout
from visuohaptic.meshes.model_files import Source, read_mesh
from visuohaptic.parameters import as_parameters
from visuohaptic.pictures.taxels import draw_layout, draw_taxels
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.effect_pipeline import TouchBatch
from visuohaptic.sensor.effects import simulate
from visuohaptic.sensor.imprints import Poses, cast_heights, make_poses
from visuohaptic.sensor.parameters import Orientation
from visuohaptic.sensor.random_fields import RandomFields

ORIENTATIONS = ("upright", "transported")
MOST_ALONG_EDGE = 1024
"""Limit of sensing points along an edge."""

MOST_POINTS = 1 << 26
"""Limit of sensing points per call, for which heights and images take 0.8 GB."""

_FARTHEST_RADII = 1e30  # of the mesh: rays are of float32
_POINTS_AT_ONCE = 1 << 20  # some 150 bytes each
_MOST_PICTURED = 64
_PIXELS = 96


@dataclass(frozen=True, eq=False)
class Pressed:
    """Imprints of n sensors. Two results are never equal.

    Imprints of rectangles have the shape (n, r, c) with r rows and c columns of sensing points, imprints of all other
    layouts the shape (n, taxels).

    Attributes
    ----------
    images : numpy.ndarray
        Shape (n, r, c) or (n, taxels), float32: 1 where the surface is at the taxel or behind it, 0 where the surface
        is `depth` or more before it. With a scene: the readings of the simulated sensor.
    heights : numpy.ndarray
        The same shape, float64, in the mesh's unit: height of the surface above the taxel, against the direction in
        which the taxel looks. Negative for a gap, minus infinity where a ray meets no surface.
    poses : numpy.ndarray
        Shape (n, 4, 4), float64, in the mesh's frame: origin at the plane's centre, x along the columns,
        y against the rows, z away from the object.
    sizes : numpy.ndarray
        Shape (n, 2), float64, in the mesh's unit: width and height of the planes; of other layouts twice the width.
    layout : Layout
        The taxels.
    """

    images: NDArray[np.float32]
    heights: FloatArray
    poses: FloatArray
    sizes: FloatArray
    layout: Layout

    def __repr__(self) -> str:
        count, *shape = self.images.shape
        points = " x ".join(map(str, shape)) if len(shape) == 2 else f"{shape[0]} taxels"
        touching = int(self.images.reshape(-1, len(self.layout)).any(axis=1).sum())
        return f"<Pressed: {count} imprints of {points}, {touching} of which feel something>"

    def _repr_png_(self) -> bytes:
        return png_of(self.picture())

    @property
    def points(self) -> FloatArray:
        """Points of the surface before each taxel, (n, r, c, 3) or (n, taxels, 3), mesh frame. NaN without a surface."""
        half = 0.5 * self.sizes
        scales = np.stack([half[:, 0], half[:, 1], half[:, 0]], axis=1)
        heights = self.heights.reshape(-1, len(self.layout), 1)
        # A ray without a hit has the height minus infinity.
        heights = np.where(np.isfinite(heights), heights, np.nan)
        local = scales[:, None] * self.layout.positions - heights * self.layout.directions
        turned = np.einsum("nij,ntj->nti", self.poses[:, :3, :3], local)
        points: FloatArray = turned + self.poses[:, None, :3, 3]
        return points.reshape(*self.heights.shape, 3)

    def picture(self) -> Image.Image:
        """Draw the first 64 imprints side by side. Light is 1, and dark is 0 (`images`).

        Rectangles are drawn as images. Taxels of other layouts are drawn as discs, as if the pad were unrolled, seen as
        an imprint is: from outside the object.

        Returns
        -------
        PIL.Image.Image
        """
        shown = self.images[:_MOST_PICTURED]
        tiles = [
            _tile(image) if image.ndim == 2 else draw_taxels(self.layout, image, 2 * _PIXELS)
            for image in shown
        ]
        across = max(1, int(np.ceil(np.sqrt(len(shown)))))
        down = max(1, -(-len(shown) // across))
        wide, high = tiles[0].size if tiles else (_PIXELS, _PIXELS)
        picture = Image.new("L", (across * (wide + 4) + 4, down * (high + 4) + 4), 64)
        for number, tile in enumerate(tiles):
            row, column = divmod(number, across)
            picture.paste(tile, (4 + column * (wide + 4), 4 + row * (high + 4)))
        return picture

    def layout_picture(self, number: int = 0) -> Image.Image:
        """Draw the layout coloured by the readings of one imprint: the unrolled pad, and the pad from its side.

        Parameters
        ----------
        number : int
            Index of the imprint.

        Returns
        -------
        PIL.Image.Image
            The picture: dark violet is 0 and yellow is 1 (`images`).
        """
        return draw_layout(self.layout, self.images[number].ravel())


def _tile(image: NDArray[np.float32]) -> Image.Image:
    """Return a rectangular imprint in grey, `_PIXELS` along its longer edge."""
    rows, columns = image.shape
    step = _PIXELS / max(rows, columns)
    size = (max(1, round(columns * step)), max(1, round(rows * step)))
    grey = Image.fromarray(np.round(255 * image).astype(np.uint8))
    return grey.resize(size, Image.Resampling.NEAREST)


def press(
    mesh: Source,
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
    layout: Layout | str | Path | None = None,
    scene: Scene | Mapping[str, Any] | str | None = None,
    unit: str | None = None,
    seed: int = 0,
) -> Pressed:
    """Press rectangular sensors, or pads of any layout, on a mesh, all in one batch.

    Lengths and positions are in the unit and frame of the mesh, which is not turned, moved or scaled.

    Parameters
    ----------
    mesh : path, binary file, trimesh.Trimesh or Scene, open3d TriangleMesh, pyvista.PolyData, (vertices, faces) or Surface
        The object, as `load` takes it; arrays of the shapes (v, 3) and (f, 3).
    points : array_like, optional
        Shape (n, 3): centres of the sensors' planes, on the surface or anywhere else.
    normals : array_like, optional
        Shape (n, 3): directions away from the object, of any length above 0.
    size : array_like
        Squares: the edge, a number or shape (n,). Rectangles: width (along columns) and height, a tuple
        (width, height), shape (1, 2) for all sensors, or (n, 2). Other layouts: the width of the pad, a number or
        shape (n,); by default the pad's own width, which needs `unit` and a layout with a unit.
    resolution : int or (int, int)
        Sensing points along an edge, or rows and columns: 2 to 1024 each, at most 2²⁶ for all sensors together.
    depth : float, optional
        Depth below its plane that a sensor feels. Default: a third of the largest size.
    above : float, optional
        Height above the plane from which sensors approach. A surface above that height is not felt. Default: the
        largest size.
    orientation : {"upright", "transported"}
        Orientation of the planes about their normals. Poses have their own.
    poses : array_like, optional
        Shape (n, 4, 4), instead of points and normals: origin at the plane's centre, x along the columns
        of the imprint, y against its rows, z away from the object, as `Exploration.poses` gives them.
    roll : array_like
        Turn of the planes about their normals (degrees), counterclockwise seen from outside: a number, or
        shape (n,).
    layout : Layout, str or path, optional
        The taxels instead of a grid: a layout of `Layout.of` or `read_layout`, ``"round"``, ``"dome"``, ``"finger"``,
        ``"gripper"``, or a CSV file. The pad stands at the pose, without an approach. Rays of a curved pad start behind
        its taxels, at most as deep as the pad's radius.
    scene : Scene, mapping or str, optional
        Effects of the sensor to simulate: a preset such as ``"fsr400"``, or section `scene` of the parameters.
        A scene needs `unit`, and for a grid square cells.
    unit : {"mm", "cm", "m", "in"}, optional
        Unit of length of the mesh, for a scene and for a layout without `size`.
    seed : int
        Random seed of a scene with noise, scattered gains or dead cells.

    Returns
    -------
    Pressed
        The imprints. Seen from outside, rows count downwards and columns to the right.

    Raises
    ------
    MeshError
        If the mesh has no surface.
    ParameterError
        If a pose, a length, a count or a layout is not allowed.

    Warns
    -----
    LayoutWarning
        If a pad is wider than the object, because its lengths may be of another unit.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ParameterError(f"seed is {seed!r}; a whole number of at least 0 is needed.")
    stands = turned(_stand(points, normals, poses, orientation), roll)
    pad = _pad(layout, resolution)
    sizes = _sizes(_own_width(pad, unit) if size is None else size, len(stands))
    if layout is not None and (sizes[:, 0] != sizes[:, 1]).any():
        raise ParameterError("size has a width and a height; a layout needs one width.")
    largest = float(sizes.max(initial=0.0)) or 1.0
    deep = _length(largest / 3 if depth is None else depth, "depth")
    high = _length(largest if above is None else above, "above")
    _check_count(len(stands), pad)
    surface, centre, radius = _unit_surface(mesh)
    _check_lengths(stands, sizes, deep, high, radius)
    if layout is not None and largest > 2 * radius:
        warnings.warn(
            f"Pads of layout {pad.name} are {largest:g} wide, and the object is {2 * radius:g} wide, in the mesh's unit; check "
            "the units of both.",
            LayoutWarning,
            stacklevel=2,
        )
    caster = RayCaster(surface)
    heights = np.empty((len(stands), *pad.shape))
    images = np.empty((len(stands), *pad.shape), dtype=np.float32)
    step = max(1, _POINTS_AT_ONCE // len(pad))
    for start in range(0, len(stands), step):
        block = slice(start, start + step)
        part = stands[block]
        within = replace(part, points=(part.points - centre) / radius)
        lifts = np.full(len(part), high / radius)
        felt = radius * cast_heights(caster, within, sizes[block, ::-1] / radius, lifts, pad)
        contact = np.clip(1 + felt / deep, 0, 1)
        if scene is not None:
            fields = RandomFields(seed, [("press", start + number) for number in range(len(part))])
            contact = _readings(contact, felt, sizes[block], pad, scene, unit, fields)
        heights[block], images[block] = felt, contact
    return Pressed(images, heights, matrices(stands), sizes, pad)


def _check_lengths(
    stands: Poses, sizes: FloatArray, deep: float, high: float, radius: float
) -> None:
    longest = max(np.abs(stands.points).max(initial=0.0), sizes.max(initial=0.0), deep, high)
    if longest > _FARTHEST_RADII * radius:
        raise ParameterError(
            f"A point, a size, depth or above is {longest:g}, and the mesh has the radius {radius:g}; up to "
            f"{_FARTHEST_RADII:g} radii are allowed."
        )


def _check_count(count: int, pad: Layout) -> None:
    points = count * len(pad)
    if points > MOST_POINTS:
        each = " x ".join(map(str, pad.shape)) + (" taxels" if len(pad.shape) == 1 else "")
        raise ParameterError(
            f"{count} sensors of {each} have {points} sensing points; {MOST_POINTS} are "
            "allowed: press them in several calls."
        )


def _pad(layout: Layout | str | Path | None, resolution: int | tuple[int, int]) -> Layout:
    """Return the layout of the taxels."""
    if layout is None:
        return grid_layout(*_grid(resolution))
    if isinstance(layout, Layout):
        return layout
    if not isinstance(layout, str | Path):
        raise ParameterError(
            f"layout is of type {type(layout).__name__}; a Layout, a name or a CSV file is needed."
        )
    if str(layout) in PADS:
        return layout_of(str(layout), _grid(resolution)[0])
    return read_layout(layout)


def _own_width(pad: Layout, unit: str | None) -> float | None:
    """Return the width of a layout with a unit, in the mesh's unit."""
    if pad.half_width_m is None:
        return None
    if unit not in UNITS:
        raise ParameterError(
            f"Layout {pad.name} has real lengths and unit is {unit!r}; the unit of the mesh, {', '.join(UNITS)}, or a size "
            "is needed."
        )
    return 2 * pad.half_width_m / UNITS[unit]


def _readings(
    contact: FloatArray,
    heights: FloatArray,
    sizes: FloatArray,
    pad: Layout,
    scene: Scene | Mapping[str, Any] | str,
    unit: str | None,
    fields: RandomFields,
) -> FloatArray:
    """Simulate the scene's sensor and return the readings, as fractions of full scale."""
    if unit not in UNITS:
        raise ParameterError(
            f"A scene has real lengths and unit is {unit!r}; {', '.join(UNITS)} are allowed."
        )
    cells = sizes / pad.counts[::-1]
    if len(pad.shape) == 2 and not np.allclose(cells[:, 0], cells[:, 1], rtol=1e-9):
        raise ParameterError(
            f"A scene needs square sensors and the first is {sizes[0, 0]:g} x {sizes[0, 1]:g} with {pad.shape[0]} rows and "
            f"{pad.shape[1]} columns."
        )
    if not isinstance(scene, Scene):
        named = {"preset": scene} if isinstance(scene, str) else dict(scene)
        scene = as_parameters({"scene": named}).scene
    metres = UNITS[unit]
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
        raise ParameterError("Sensors need points with normals, or poses; pass one of the two.")
    if poses is not None:
        given = numbers(poses, "poses")
        _check_poses(given)
        columns, upwards, outward = (given[:, :3, axis] for axis in range(3))
        return Poses(given[:, :3, 3], outward, columns, -upwards)
    centres = point_rows(points, "points")
    return make_poses(centres, unit_rows(normals, "normals", len(centres)), orientation)


def _check_poses(poses: FloatArray) -> None:
    if poses.shape[1:] != (4, 4):
        raise ParameterError(f"poses has the shape {poses.shape}; (n, 4, 4) is needed.")
    bent = np.flatnonzero((poses[:, 3] != (0.0, 0.0, 0.0, 1.0)).any(axis=1))
    if len(bent):
        raise ParameterError(
            f"Pose {bent[0]} has the bottom row {poses[bent[0], 3].tolist()}; [0, 0, 0, 1] is needed, and the position in "
            "the last column."
        )
    point_rows(poses[:, :3, 3], "poses[:, :3, 3]")
    if not (np.abs(poses[:, :3, :3]) < 2).all():
        raise ParameterError(
            "poses has axes that are not finite, or no unit axes; rotations are needed."
        )
    axes = poses[:, :3, :3]
    skew = np.abs(np.swapaxes(axes, 1, 2) @ axes - np.eye(3)).max(axis=(1, 2), initial=0.0)
    wrong = np.flatnonzero((skew > 1e-6) | (np.linalg.det(axes) < 0))
    if len(wrong):
        raise ParameterError(
            f"Pose {wrong[0]} turns by no rotation; three right-angled unit axes, right-handed, are needed."
        )


def _grid(resolution: int | tuple[int, int]) -> tuple[int, int]:
    """Return the numbers of rows and columns."""
    counts = np.atleast_1d(numbers(resolution, "resolution"))
    allowed = (counts >= 2) & (counts <= MOST_ALONG_EDGE) & (np.floor(counts) == counts)
    if counts.shape not in ((1,), (2,)) or not allowed.all():
        raise ParameterError(
            f"resolution is {resolution}; a whole number from 2 to {MOST_ALONG_EDGE}, or two of them, is "
            "allowed."
        )
    return int(counts[0]), int(counts[-1])


def _sizes(size: ArrayLike | None, count: int) -> FloatArray:
    """Return width and height of each sensor: (n, 2)."""
    if size is None:
        raise ParameterError("size is missing: the edge of the sensors, in the mesh's unit.")
    given = numbers(size, "size")
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


def _unit_surface(mesh: Source) -> tuple[Surface, FloatArray, float]:
    """Return the mesh scaled into the unit ball, where float32 rays are exact enough, with its centre and radius."""
    surface, name = read_mesh(mesh), name_of(mesh)
    vertices = surface.vertices
    if not (np.abs(vertices) < FARTHEST).all():
        raise MeshError(
            f"{name} has vertices that are not finite, or at {FARTHEST:g} and beyond; a surface is needed."
        )
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    radius = float(np.linalg.norm(vertices - centre, axis=1).max())
    if not radius > 1 / FARTHEST:
        raise MeshError(
            f"{name} has all its vertices at one point, or within {1 / FARTHEST:g}; there is nothing to "
            "touch."
        )
    return replace(surface, vertices=(vertices - centre) / radius), centre, radius


def _length(value: Any, name: str) -> float:
    length = numbers(value, name)
    if length.shape:
        raise ParameterError(f"{name} has the shape {length.shape}; one number is needed.")
    return float(_positive(length, name))


def _positive(values: FloatArray, name: str) -> FloatArray:
    wrong = values[~((values > 0) & (values < FARTHEST))]
    if wrong.size:
        raise ParameterError(
            f"{name} holds {wrong.flat[0]:g}; positive lengths below {FARTHEST:g} are allowed."
        )
    return values
