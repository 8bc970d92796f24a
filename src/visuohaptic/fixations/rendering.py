"""Rendering of views of a surface by ray casting."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshreaders.base.srgb import dim_srgb, encode_srgb
from meshreaders.base.texture import Texture
from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.fixations.visual_effects import VisualPlan, plan_visual, seen_colours, seen_texture
from visuohaptic.geometry.curvature import SurfaceShape, shape_of
from visuohaptic.geometry.elementary import sin_cos
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.vectors import dot, dot_rows
from visuohaptic.scene.parameters import VisualModes
from visuohaptic.scene.records import EffectRecord

SHADOW_OFFSET = 1e-4
"""Height above the surface at which shadow rays start, object radii; float32 rays need about 1e-5 to miss the face they start from."""

# The light moves with the camera: brightness depends on the slope only, and both sides are equally bright.
LIGHT_ELEVATION_DEGREES = 25.0
"""Angle from the viewing axis up to the light, which shines from the camera's side. Our choice."""


@dataclass(frozen=True)
class Views:
    """Views of n cameras with h rows and w columns. Vectors are in the object frame, lengths in object radii.

    On the background each array is 0 unless its entry names another value.

    Attributes
    ----------
    colour : ndarray of shape (n, h, w, 3), float32
        sRGB, 0 to 1; the background has the grey level `RenderingParameters.background`.
    mask : ndarray of shape (n, h, w), bool
        True on the object.
    depth : ndarray of shape (n, h, w), float32
        Distance from the camera along the viewing axis, not along the ray; infinite on the background.
    point : ndarray of shape (n, h, w, 3), float64
        The visible point of the surface.
    normal : ndarray of shape (n, h, w, 3), float64
        The interpolated unit normal, towards the camera. If it points away, the normal of the face replaces it.
    face : ndarray of shape (n, h, w), int64
        Index of the visible face; -1 on the background.
    curvature : ndarray of shape (n, h, w), float32
        Curvedness of the surface, 1 / object radius.
    lit : ndarray of shape (n, h, w), bool
        False where a simulated cast shadow falls. True elsewhere: on the background and where the surface itself
        faces away from the light.
    effects : tuple of EffectRecord
        One record per visual effect. The fields that count touches count views here.
    """

    colour: NDArray[np.float32]
    mask: BoolArray
    depth: NDArray[np.float32]
    point: FloatArray
    normal: FloatArray
    face: IntArray
    curvature: NDArray[np.float32]
    lit: BoolArray
    effects: tuple[EffectRecord, ...]

    def __len__(self) -> int:
        return len(self.mask)

    def attend_arguments(self, indices: slice = slice(None)) -> dict[str, Any]:
        """Return the six array arguments of `attention.attend`, as name: array, for the views at `indices`.

        The dict lacks `parameters`, `eye` and `terms`: ``attend(**views.attend_arguments(), parameters=...)``.
        """
        names = ("colour", "mask", "point", "normal", "face", "curvature")
        return {name: getattr(self, name)[indices] for name in names}


def render_views(
    caster: RayCaster,
    cameras: Sequence[Camera],
    parameters: RenderingParameters,
    modes: VisualModes | None = None,
) -> Views:
    """Render a surface from several cameras; each view depends only on its own camera.

    One ray goes through the centre of each pixel. Where the face has a texture, the texture is averaged over the
    area of the face's plane that the pixel covers (`Texture.light`). The light moves with the camera
    (`light_direction`). Simulating an effect that is not needed changes no bit.

    Parameters
    ----------
    caster : RayCaster
        The surface, prepared for rays.
    cameras : sequence of Camera
    parameters : RenderingParameters
        Rows and columns of a view, share of ambient light, and grey level of the background.
    modes : VisualModes, optional
        The mode per visual effect. By default shadows are never cast, and other effects are simulated if needed.

    Returns
    -------
    Views
        One view per camera, in the order of the cameras, with `resolution` rows and columns.
    """
    hits = cast_pixel_rays(caster, cameras, parameters)
    return colour_views(caster, cameras, hits, parameters, modes)


@dataclass(frozen=True)
class PixelHits:
    """First hits of one camera's rays on the surface, for the p pixels that show the surface.

    Vectors are in the object frame, lengths in object radii.

    Attributes
    ----------
    pixels : ndarray of shape (p,), int64
        Index of each pixel: row times `resolution` plus column.
    directions : ndarray of shape (p, 3), float64
        Directions of the rays, of length 1 along the viewing axis, as in `Camera.rays`; not unit vectors.
    faces : ndarray of shape (p,), int64
        Index of each hit face.
    points : ndarray of shape (p, 3), float64
        The hit points.
    weights : ndarray of shape (p, 3), float64
        Barycentric weights of the points in their faces.
    normals : ndarray of shape (p, 3), float64
        Unit normals towards the camera, as in `Views`.
    curvature : ndarray of shape (p,), float64
        Curvedness of the surface, 1 / object radius.
    """

    pixels: IntArray
    directions: FloatArray
    faces: IntArray
    points: FloatArray
    weights: FloatArray
    normals: FloatArray
    curvature: FloatArray


def cast_pixel_rays(
    caster: RayCaster, cameras: Sequence[Camera], parameters: RenderingParameters
) -> Iterator[PixelHits]:
    """Cast the rays of each camera and yield one `PixelHits` per camera, in the order of the cameras.

    Hits do not depend on the visual effects: the same list may be passed to `colour_views` with several modes.
    Only the resolution of `parameters` is used.
    """
    shape = shape_of(caster.surface)
    for camera in cameras:
        pixels = camera.window(caster.surface.vertices, parameters.resolution)
        origins, directions = camera.rays(parameters.resolution, pixels)
        hits = caster.first_hits(origins, directions)
        rows = np.flatnonzero(hits.hit)
        faces = hits.face.take(rows)
        # Components are separate arrays here and below, so that NumPy's inner loops run along the pixels.
        towards = directions.T.take(rows, axis=1).T
        points = (origins.T.take(rows, axis=1) + hits.distance.take(rows) * towards.T).T
        weights = caster.weights(points, faces)
        normals = _normals_towards(shape, caster, faces, weights, towards)
        curvature = shape.curvature(faces, weights)
        yield PixelHits(pixels.take(rows), towards, faces, points, weights, normals, curvature)


def colour_views(
    caster: RayCaster,
    cameras: Sequence[Camera],
    hits: Iterable[PixelHits],
    parameters: RenderingParameters,
    modes: VisualModes | None = None,
) -> Views:
    """Render views like `render_views`, but from hits that `cast_pixel_rays` computed before.

    `hits` has one item per camera, in the same order, from the same surface and resolution. The result and the other
    arguments are those of `render_views`. Raises `ValueError` if there are more or fewer hits than cameras.
    """
    modes = modes or VisualModes()
    surface = caster.surface
    plans = plan_visual(modes, surface.stored_colours(), parameters.ambient)
    with plans["texture" if modes.texture == "never" else "colour"].clock():
        colours = seen_colours(surface.face_colours, surface.face_areas, modes).T / 255.0
        texture = surface.texture if plans["texture"].simulated else None
        texture = None if texture is None else seen_texture(texture, modes)
    views = _background(len(cameras), parameters)
    for index, (camera, camera_hits) in enumerate(zip(cameras, hits, strict=True)):
        pixel_values = _render_hits(
            caster, camera_hits, colours, texture, camera, parameters, plans
        )
        for name, values in pixel_values.items():
            view = views[name][index].reshape(parameters.resolution**2, -1).T
            for component, component_values in zip(view, np.atleast_2d(values.T), strict=True):
                component[camera_hits.pixels] = component_values
    return Views(**views, effects=tuple(plan.record(len(cameras)) for plan in plans.values()))


def light_direction(camera: Camera) -> FloatArray:
    """Compute the unit vector (3,), object frame, from the object towards the infinitely distant light of a camera."""
    (rise,), (level,) = sin_cos(np.radians([LIGHT_ELEVATION_DEGREES]))
    _, up, back = camera.axes
    return level * back + rise * up


def _background(views: int, parameters: RenderingParameters) -> dict[str, NDArray[Any]]:
    """Return the arrays of `Views`, as name: array, for views that show only background."""
    shape = (views, parameters.resolution, parameters.resolution)
    return {
        "colour": np.full((*shape, 3), parameters.background, dtype=np.float32),
        "mask": np.zeros(shape, dtype=bool),
        "depth": np.full(shape, np.inf, dtype=np.float32),
        "point": np.zeros((*shape, 3)),
        "normal": np.zeros((*shape, 3)),
        "face": np.full(shape, -1, dtype=np.int64),
        "curvature": np.zeros(shape, dtype=np.float32),
        "lit": np.ones(shape, dtype=bool),
    }


def _render_hits(
    caster: RayCaster,
    hits: PixelHits,
    face_colours: FloatArray,
    texture: Texture | None,
    camera: Camera,
    parameters: RenderingParameters,
    plans: Mapping[str, VisualPlan],
) -> dict[str, NDArray[Any]]:
    """Compute the values of the p pixels of `hits`, as name of an array of `Views`: (p,) or (p, 3)."""
    faces, points, weights, normals = hits.faces, hits.points, hits.weights, hits.normals
    light = light_direction(camera)
    colours = face_colours.take(faces, axis=1).T
    if texture is not None:
        with plans["texture"].clock():
            rows = np.flatnonzero(texture.textured.take(faces))
            depths = dot(camera.eye - points[rows], camera.axes[2][None])
            sides = camera.pixel_sides(parameters.resolution, depths)
            steps = _weight_steps(caster, faces[rows], hits.directions[rows], sides)
            colours[rows] = encode_srgb(texture.light(faces[rows], weights[rows], steps))
    lit = np.ones(len(faces), dtype=bool)
    if plans["cast_shadows"].simulated:
        with plans["cast_shadows"].clock():
            lit = _lit(caster, points, normals, light)
    if plans["shading"].simulated:
        with plans["shading"].clock():
            colours = _shade(colours, normals, lit, light, parameters.ambient)
    return {
        "colour": colours,
        "mask": np.ones(len(faces), dtype=bool),
        "depth": dot_rows(camera.eye[:, None] - points.T, camera.axes[2][:, None]),
        "point": points,
        "normal": normals,
        "face": faces,
        "curvature": hits.curvature,
        "lit": lit | (not plans["cast_shadows"].needed),
    }


def _normals_towards(
    shape: SurfaceShape,
    caster: RayCaster,
    faces: IntArray,
    weights: FloatArray,
    directions: FloatArray,
) -> FloatArray:
    """Compute unit normals (n, 3) towards the camera: interpolated, or of the face where those point away."""
    flat = caster.face_normal_rows.take(faces, axis=1)
    away = np.where(dot_rows(flat, directions.T) > 0.0, -1.0, 1.0)
    normals = away * shape.normals(faces, weights).T
    # Near the outline an interpolated normal may point away although its facet is visible.
    averted = np.flatnonzero(dot_rows(normals, directions.T) >= 0.0)
    normals[:, averted] = away[averted] * flat[:, averted]
    return normals.T


def _weight_steps(
    caster: RayCaster, faces: IntArray, directions: FloatArray, sides: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Compute changes (n, 2 sides, 2 weights) of the second and third barycentric weight along a pixel's sides."""
    # Project the pixel's sides along the ray onto the plane of the face.
    normals = caster.surface.face_crosses.take(faces, axis=0)
    second, third = np.moveaxis(caster.weight_gradients.take(faces, axis=0), 1, 0)
    towards = dot(normals, directions)
    # Avoid a division by zero for rays inside the face's plane, which hit no face.
    towards[towards == 0.0] = np.inf
    steps = np.empty((len(faces), 2, 2))
    for number, side in enumerate(sides):
        on_plane = side - (dot(normals, side) / towards)[:, None] * directions
        steps[:, number, 0] = dot(on_plane, second)
        steps[:, number, 1] = dot(on_plane, third)
    return steps


def _lit(
    caster: RayCaster, points: FloatArray, normals: FloatArray, light: FloatArray
) -> BoolArray:
    """Return (n,), False where the surface blocks the light of a point; points that face away count as lit."""
    facing = np.flatnonzero(dot_rows(normals.T, light[:, None]) > 0.0)
    offsets = SHADOW_OFFSET * normals.T.take(facing, axis=1)
    origins = (points.T.take(facing, axis=1) + offsets).T
    blocked = caster.first_hits(origins, np.broadcast_to(light, origins.shape)).hit
    lit = np.ones(len(points), dtype=bool)
    lit[facing] = ~blocked
    return lit


def _shade(
    colours: FloatArray, normals: FloatArray, lit: BoolArray, light: FloatArray, ambient: float
) -> FloatArray:
    """Multiply the linear light of sRGB colours (n, 3) by ambient + (1 - ambient) * Lambert's cosine where lit."""
    lambert = np.maximum(dot_rows(normals.T, light[:, None]), 0.0) * lit
    return dim_srgb(colours, ambient + (1.0 - ambient) * lambert)
