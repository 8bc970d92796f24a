"""Views of a surface: what a camera sees of it, pixel by pixel, by ray casting."""

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

# How far a shadow ray starts above the surface, object radii; float32 rays need some 1e-5.
SHADOW_OFFSET = 1e-4
# Height of the light above the viewing axis. Our choice: it moves with the camera, so that brightness depends on
# the slope only, and both sides are lit alike.
LIGHT_ELEVATION_DEGREES = 25.0


@dataclass(frozen=True)
class Views:
    """What n cameras see, each over h rows and w columns, object frame; lengths are in object radii.

    `colour` (n, h, w, 3), float32, is sRGB, 0 to 1; the other arrays are zero on the background, but `face`,
    int64, -1, and `depth`, float32, along the viewing axis from the camera's plane, infinite. `point` and
    `normal` (n, h, w, 3), float64, are the seen point and the interpolated unit normal towards the camera;
    `curvature`, float32, is the surface's curvedness. `lit` is true but where a cast shadow is simulated
    and falls. In the records of `effects` a view counts as a touch.
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

    def arrays(self, places: slice = slice(None)) -> dict[str, Any]:
        """Give what `attention.attend` takes of some of the views, by its names."""
        names = ("colour", "mask", "point", "normal", "face", "curvature")
        return {name: getattr(self, name)[places] for name in names}


def render_views(
    caster: RayCaster,
    cameras: Sequence[Camera],
    parameters: RenderingParameters,
    modes: VisualModes | None = None,
) -> Views:
    """Render a surface from several cameras; each view depends on its own camera alone.

    One ray goes through the centre of each pixel, and an image gives the mean light of the part that the
    pixel covers, on the plane of the face that its ray meets (`Texture.light`). The light turns with the
    camera. Simulating an effect that is not needed changes no bit.
    """
    return colour_views(
        caster, cameras, meet_surface(caster, cameras, parameters), parameters, modes
    )


@dataclass(frozen=True)
class PixelHits:
    """Where the rays of one camera meet the surface: p pixels see it.

    `pixels` and `faces` (p,) are int64, `curvature` (p,) and the rest (p, 3) float64; `weights` are barycentric.
    """

    pixels: IntArray
    directions: FloatArray
    faces: IntArray
    points: FloatArray
    weights: FloatArray
    normals: FloatArray
    curvature: FloatArray


def meet_surface(
    caster: RayCaster, cameras: Sequence[Camera], parameters: RenderingParameters
) -> Iterator[PixelHits]:
    """Cast the rays of each camera; no effect counts, so views under other effects need no other cast."""
    shape = shape_of(caster.surface)
    for camera in cameras:
        pixels = camera.window(caster.surface.vertices, parameters.resolution)
        origins, directions = camera.rays(parameters.resolution, pixels)
        hits = caster.first_hits(origins, directions)
        seen = np.flatnonzero(hits.hit)
        faces = hits.face.take(seen)
        # Component by component here and below, so that NumPy's inner loops run along the pixels.
        towards = directions.T.take(seen, axis=1).T
        points = (origins.T.take(seen, axis=1) + hits.distance.take(seen) * towards.T).T
        weights = caster.weights(points, faces)
        normals = _normals_towards(shape, caster, faces, weights, towards)
        curvature = shape.curvature(faces, weights)
        yield PixelHits(pixels.take(seen), towards, faces, points, weights, normals, curvature)


def colour_views(
    caster: RayCaster,
    cameras: Sequence[Camera],
    met: Iterable[PixelHits],
    parameters: RenderingParameters,
    modes: VisualModes | None = None,
) -> Views:
    """Colour what each camera's rays have met: the rest of `render_views`, which says what it takes."""
    modes = modes or VisualModes()
    surface = caster.surface
    plans = plan_visual(modes, surface.stored_colours(), parameters.ambient)
    with plans["texture" if modes.texture == "never" else "colour"].clock():
        colours = seen_colours(surface.face_colours, surface.face_areas, modes).T / 255.0
        texture = surface.texture if plans["texture"].simulated else None
        texture = None if texture is None else seen_texture(texture, modes)
    views = _background(len(cameras), parameters)
    for number, (camera, one) in enumerate(zip(cameras, met, strict=True)):
        seen = _seen_surface(caster, one, colours, texture, camera, parameters, plans)
        for name, values in seen.items():
            view = views[name][number].reshape(parameters.resolution**2, -1).T
            for shown, component in zip(view, np.atleast_2d(values.T), strict=True):
                shown[one.pixels] = component
    return Views(**views, effects=tuple(plan.record(len(cameras)) for plan in plans.values()))


def light_direction(camera: Camera) -> FloatArray:
    """Compute the unit vector (3,), object frame, towards the light of a camera, which is infinitely far."""
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


def _seen_surface(
    caster: RayCaster,
    met: PixelHits,
    face_colours: FloatArray,
    texture: Texture | None,
    camera: Camera,
    parameters: RenderingParameters,
    plans: Mapping[str, VisualPlan],
) -> dict[str, NDArray[Any]]:
    """Give what the pixels see that see the surface, by the names of `Views`."""
    faces, points, weights, normals = met.faces, met.points, met.weights, met.normals
    light = light_direction(camera)
    colours = face_colours.take(faces, axis=1).T
    if texture is not None:
        with plans["texture"].clock():
            on = np.flatnonzero(texture.textured.take(faces))
            depths = dot(camera.eye - points[on], camera.axes[2][None])
            sides = camera.pixel_sides(parameters.resolution, depths)
            steps = _weight_steps(caster, faces[on], met.directions[on], sides)
            colours[on] = encode_srgb(texture.light(faces[on], weights[on], steps))
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
        "curvature": met.curvature,
        "lit": lit | (not plans["cast_shadows"].needed),
    }


def _normals_towards(
    shape: SurfaceShape,
    caster: RayCaster,
    faces: IntArray,
    weights: FloatArray,
    directions: FloatArray,
) -> FloatArray:
    flat = caster.face_normal_rows.take(faces, axis=1)
    away = np.where(dot_rows(flat, directions.T) > 0.0, -1.0, 1.0)
    normals = away * shape.normals(faces, weights).T
    # Close to its outline a facet can be seen while the rounding that it stands for turns away.
    beyond = np.flatnonzero(dot_rows(normals, directions.T) >= 0.0)
    normals[:, beyond] = away[beyond] * flat[:, beyond]
    return normals.T


def _weight_steps(
    caster: RayCaster, faces: IntArray, directions: FloatArray, sides: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Give how the second and third weight change along both sides of a pixel, shape (n, 2, 2)."""
    # The pixel's sides at the depth of the face are carried along the ray on to the face's plane.
    normals = caster.surface.face_crosses.take(faces, axis=0)
    second, third = np.moveaxis(caster.slopes.take(faces, axis=0), 1, 0)
    towards = dot(normals, directions)
    # Only a ray within the face's plane would divide by zero, and such a ray meets no face.
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
    towards = np.flatnonzero(dot_rows(normals.T, light[:, None]) > 0.0)
    origins = SHADOW_OFFSET * normals.T.take(towards, axis=1)
    origins = (points.T.take(towards, axis=1) + origins).T
    blocked = caster.first_hits(origins, np.broadcast_to(light, origins.shape)).hit
    lit = np.ones(len(points), dtype=bool)
    lit[towards] = ~blocked
    return lit


def _shade(
    colours: FloatArray, normals: FloatArray, lit: BoolArray, light: FloatArray, ambient: float
) -> FloatArray:
    lambert = np.maximum(dot_rows(normals.T, light[:, None]), 0.0) * lit
    return dim_srgb(colours, ambient + (1.0 - ambient) * lambert)
