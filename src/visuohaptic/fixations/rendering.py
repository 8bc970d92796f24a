"""Rendering of views of a surface by ray casting."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.fixations.visual_effects import VisualPlan, plan_visual, seen_colours, seen_texture
from visuohaptic.geometry.curvature import SurfaceShape, shape_of
from visuohaptic.geometry.elementary import sin_cos
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.srgb import dim_srgb, encode_srgb
from visuohaptic.geometry.texture import Texture
from visuohaptic.geometry.vectors import dot, dot_rows
from visuohaptic.scene.parameters import VisualModes
from visuohaptic.scene.records import EffectRecord

SHADOW_OFFSET = 1e-4
"""Height above the surface at which shadow rays start, object radii; float32 rays need some 1e-5."""

# The light moves with the camera: brightness depends on the slope only, and both sides are equally bright.
LIGHT_ELEVATION_DEGREES = 25.0
"""Height of the light above the viewing axis. Our choice."""


@dataclass(frozen=True)
class Views:
    """Views of n cameras with h rows and w columns, object frame; lengths are in object radii.

    Background pixels are 0 if nothing else is said.

    Attributes
    ----------
    colour : ndarray of shape (n, h, w, 3), float32
        sRGB, 0 to 1; the background has a grey level.
    mask : ndarray of shape (n, h, w), bool
        True on the object.
    depth : ndarray of shape (n, h, w), float32
        Distance along the viewing axis from the camera's plane; infinite on the background.
    point : ndarray of shape (n, h, w, 3), float64
        The visible point of the surface.
    normal : ndarray of shape (n, h, w, 3), float64
        The interpolated unit normal, towards the camera.
    face : ndarray of shape (n, h, w), int64
        The visible face; -1 on the background.
    curvature : ndarray of shape (n, h, w), float32
        Curvedness of the surface.
    lit : ndarray of shape (n, h, w), bool
        False in simulated cast shadows, true elsewhere.
    effects : tuple of EffectRecord
        Records of the visual effects, with views in place of touches.
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

    def arrays(self, indices: slice = slice(None)) -> dict[str, Any]:
        """Return the arguments of `attention.attend` for the views at `indices`, by name."""
        names = ("colour", "mask", "point", "normal", "face", "curvature")
        return {name: getattr(self, name)[indices] for name in names}


def render_views(
    caster: RayCaster,
    cameras: Sequence[Camera],
    parameters: RenderingParameters,
    modes: VisualModes | None = None,
) -> Views:
    """Render a surface from several cameras; each view depends only on its own camera.

    One ray goes through the centre of each pixel. A textured pixel has the mean light of the texture over the
    pixel's area on the plane of the face (`Texture.light`). The light turns with the camera. Simulating an effect
    that is not needed changes no bit.

    Parameters
    ----------
    caster : RayCaster
        The surface, prepared for rays.
    cameras : sequence of Camera
        The cameras.
    parameters : RenderingParameters
        Resolution, light and background.
    modes : VisualModes, optional
        When each visual effect is simulated.

    Returns
    -------
    Views
        One view per camera.
    """
    hits = cast_pixel_rays(caster, cameras, parameters)
    return colour_views(caster, cameras, hits, parameters, modes)


@dataclass(frozen=True)
class PixelHits:
    """Hits of one camera's rays on the surface; p pixels see the surface.

    Attributes
    ----------
    pixels : ndarray of shape (p,), int64
        The pixels, counted row by row.
    directions : ndarray of shape (p, 3), float64
        Directions of the rays, as in `Camera.rays`.
    faces : ndarray of shape (p,), int64
        The hit faces.
    points : ndarray of shape (p, 3), float64
        The hit points, object frame.
    weights : ndarray of shape (p, 3), float64
        Barycentric weights of the points in their faces.
    normals : ndarray of shape (p, 3), float64
        Interpolated unit normals towards the camera.
    curvature : ndarray of shape (p,), float64
        Curvedness of the surface.
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
    """Cast the rays of each camera and yield the hits, which do not depend on the visual effects."""
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
    """Render views from hits of `cast_pixel_rays`; the other arguments are as for `render_views`."""
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
    """Compute the unit vector (3,), object frame, towards the infinitely distant light of a camera."""
    (rise,), (level,) = sin_cos(np.radians([LIGHT_ELEVATION_DEGREES]))
    _, up, back = camera.axes
    return level * back + rise * up


def _background(views: int, parameters: RenderingParameters) -> dict[str, NDArray[Any]]:
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
    """Return the values of the pixels that hit the surface, by the names of `Views`."""
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
    """Compute the interpolated unit normals (n, 3), flipped towards the camera."""
    flat = caster.face_normal_rows.take(faces, axis=1)
    away = np.where(dot_rows(flat, directions.T) > 0.0, -1.0, 1.0)
    normals = away * shape.normals(faces, weights).T
    # Near the outline an interpolated normal may point away although its facet is visible. Take the facet's normal.
    averted = np.flatnonzero(dot_rows(normals, directions.T) >= 0.0)
    normals[:, averted] = away[averted] * flat[:, averted]
    return normals.T


def _weight_steps(
    caster: RayCaster, faces: IntArray, directions: FloatArray, sides: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Compute the changes (n, 2, 2) of the second and third weight along both sides of a pixel."""
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
    """Cast shadow rays and return whether each point (n, 3) is lit; points that face away count as lit."""
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
    """Dim sRGB colours (n, 3) by Lambert's law."""
    lambert = np.maximum(dot_rows(normals.T, light[:, None]), 0.0) * lit
    return dim_srgb(colours, ambient + (1.0 - ambient) * lambert)
