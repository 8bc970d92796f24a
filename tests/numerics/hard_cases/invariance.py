"""What must not matter: the unit, the place and the description of a mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numerics.surfaces import lopsided, of_trimesh, pick
from numpy.typing import NDArray

from visuohaptic.attention.model import Attention, attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import INWARD
from visuohaptic.features.describing import describe_imprints
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch
from visuohaptic.stability import drawings
from visuohaptic.stability.findings import Finding

Floats = NDArray[np.float64]

RESOLUTION = 128


@dataclass(frozen=True)
class Sensed:
    """What is seen and felt of a surface from some viewpoints."""

    triangles: Floats
    views: Views
    attended: list[Attention]
    points: Floats
    images: NDArray[np.float32]
    features: Floats

    @property
    def saliency(self) -> Floats:
        """The saliency maps, shape (v, rows, columns)."""
        return np.stack([found.saliency for found in self.attended])

    @property
    def lengths(self) -> list[int]:
        """Number of distinct fixations of each view."""
        return [found.scanpath.distinct for found in self.attended]


def look(
    surface: Surface, cameras: Sequence[Camera], resolution: int = RESOLUTION
) -> tuple[Views, list[Attention]]:
    """Render views of a surface, and attend to them."""
    views = render_views(RayCaster(surface), cameras, RenderingParameters(resolution=resolution))
    names = ("colour", "mask", "point", "normal", "face", "curvature")
    arrays = {name: getattr(views, name) for name in names}
    return views, list(attend(**arrays, parameters=AttentionParameters()))


def sense(surface: Surface, resolution: int = RESOLUTION) -> Sensed:
    """Go from a raw surface to what is sensed of it from four viewpoints."""
    made = normalise(surface, "object", merge_tolerance=0)
    views, attended = look(made, place_cameras(ViewpointParameters(count=4)), resolution)
    points, normals, faces = (
        np.concatenate([getattr(found.scanpath, name) for found in attended])
        for name in ("points", "normals", "faces")
    )
    felt = touch(RayCaster(made), points, normals, SensorParameters(), Scene(), faces=faces)
    deviations = describe_imprints(felt.images, FeatureParameters())
    features = np.column_stack([deviations, points, felt.normals])
    return Sensed(made.triangles, views, attended, points, felt.images, features)


@cache
def bases() -> dict[str, Surface]:
    """Give the objects that are described in other ways, by name."""
    import trimesh

    return {
        "lopsided": lopsided(),
        "box": of_trimesh(trimesh.creation.box((1.0, 0.7, 0.4))),
        "cone": of_trimesh(trimesh.creation.cone(0.6, 1.2, sections=64)),
        "torus": of_trimesh(trimesh.creation.torus(0.6, 0.25)),
    }


@cache
def sense_base(name: str) -> Sensed:
    """Give what is sensed of one of the `bases` as it is."""
    return sense(bases()[name])


KINDS = (
    "vertices in another order", "faces in another order", "faces wound at random",
    "corners in another order", "vertices doubled",
)  # fmt: skip


def describe_otherwise(surface: Surface, generator: np.random.Generator, kind: str) -> Surface:
    """Describe the same surface in another way, one of `KINDS`."""
    count = len(surface.faces)
    vertices, faces, colours = surface.vertices, surface.faces, surface.face_colours
    if kind == "vertices in another order":
        order = generator.permutation(len(vertices))
        return Surface(vertices[order], np.argsort(order)[faces], colours)
    if kind == "faces in another order":
        order = generator.permutation(count)
        return Surface(vertices, faces[order], colours[order])
    if kind == "faces wound at random":
        turn = generator.random(count) < 0.5
        return Surface(vertices, np.where(turn[:, None], faces[:, ::-1], faces), colours)
    if kind == "corners in another order":
        shift = generator.integers(0, 3, count)
        corners = (np.arange(3) + shift[:, None]) % 3
        return Surface(vertices, faces[np.arange(count)[:, None], corners], colours)
    return Surface(vertices[faces].reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), colours)


def drive_of(points: Floats, attended: Attention, mask: NDArray[np.bool_], upto: int) -> Floats:
    """Give what drives the eye after some fixations, in float64, by the model's definition."""
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1]
    drive = attended.saliency.astype(float) + INWARD * depth / depth.max()
    parameters = AttentionParameters()
    for point in attended.scanpath.points[:upto]:
        distance = np.linalg.norm(points - point, axis=-1) / parameters.focus_radius
        progress = np.clip((distance - 1) / parameters.inhibition_falloff, 0, 1)
        drive = np.where(distance <= 1, -1.0, drive * progress**2 * (3 - 2 * progress))
    return np.where(mask, drive, -1.0)


def compare(found: Sensed, wanted: Sensed, label: str) -> Iterator[Finding]:
    """Want the same sensations; where peaks tie, another one of them may be fixated."""
    same_shape = found.lengths == wanted.lengths
    both = found.views.mask & wanted.views.mask
    yield Finding(
        "invariance/saliency map",
        np.abs(found.saliency - wanted.saliency)[both].max() if same_shape else np.inf,
        label,
        drawings.image(wanted.saliency[0], "the saliency map"),
        cases=len(both),
    )
    if not same_shape:
        return
    felt: list[int] = []
    start = 0
    for view, length in enumerate(wanted.lengths):
        rows = np.arange(start, start + length)
        start += length
        apart = np.linalg.norm(found.points[rows] - wanted.points[rows], axis=1)
        same = next((step for step, gap in enumerate(apart) if gap > 1e-3), length)
        felt += rows[:same].tolist()
        yield Finding(
            "invariance/fixated points",
            apart[:same],
            f"{label}, view {view}",
            drawings.image(wanted.saliency[view], "the saliency map"),
        )
        if same < length:
            # Peaks that tie may change places; then the place chosen is as salient as the best.
            yield Finding(
                "invariance/tied peaks: fixations are those of a map within its error",
                _deficit(wanted, found, view, same),
                f"{label}, view {view}, fixation {same + 1}",
                drawings.image(wanted.saliency[view], "the saliency map"),
            )
    yield from compare_imprints(found.images[felt], wanted.images[felt], label)
    yield Finding(
        "invariance/features",
        np.abs(found.features - wanted.features).max(axis=1)[felt],
        lambda row: f"{label}, touch {felt[row]}",
        lambda row: drawings.image(wanted.images[felt[row]], "the imprint"),
    )


def compare_imprints(
    found: NDArray[np.float32], wanted: NDArray[np.float32], label: str
) -> Iterator[Finding]:
    """Want the same imprints, shape (n, r, r), but for a mean difference a pixel."""
    yield Finding(
        "invariance/images",
        np.abs(found - wanted).mean(axis=(1, 2)),
        lambda row: f"{label}, touch {row}",
        lambda row: drawings.image(wanted[row], "the imprint"),
    )


def _deficit(wanted: Sensed, found: Sensed, view: int, step: int) -> float:
    """How much less the eye is driven to where it went than to the best place."""
    best = wanted.attended[view].scanpath
    went = found.attended[view].scanpath
    points, mask = wanted.views.point[view], wanted.views.mask[view]
    drive = drive_of(points, wanted.attended[view], mask, step)
    there = drive[went.rows[step], went.columns[step]]
    return max(float(drive[best.rows[step], best.columns[step]] - there), 0.0)


def compare_vertices(found: Floats, wanted: Floats, name: str, label: str) -> Iterator[Finding]:
    """Want triangles in one order at the same places; their corners may be in any order."""
    apart = np.linalg.norm(np.sort(found, axis=1) - np.sort(wanted, axis=1), axis=2)
    picture = drawings.triangles(wanted, "the object")
    yield Finding(f"invariance/{name}", apart, label, picture, cases=1)


def descriptions_of(*names: str) -> Callable[[np.random.Generator], Iterator[Finding]]:
    """Give the check that describes one of some `bases` in another way."""

    def measure(generator: np.random.Generator) -> Iterator[Finding]:
        base, kind = str(generator.choice(names)), str(generator.choice(KINDS))
        found = sense(describe_otherwise(bases()[base], generator, kind))
        wanted = sense_base(base)
        label = f"{base}: {kind}"
        if kind != "faces in another order":
            requirement = "order, winding, corners, doubled vertices: vertices"
            yield from compare_vertices(found.triangles, wanted.triangles, requirement, label)
        yield from compare(found, wanted, label)

    return measure


def units(generator: np.random.Generator) -> Iterator[Finding]:
    """Scale a mesh, by any number and by a power of two."""
    surface, wanted = lopsided(), sense_base("lopsided")
    exponent = pick(generator, -6, 6)
    found = sense(Surface(surface.vertices * 10.0**exponent, surface.faces, surface.face_colours))
    label = f"size 1e{exponent:.2f}"
    yield from compare_vertices(found.triangles, wanted.triangles, "vertices, any scale", label)
    yield from compare(found, wanted, label)
    power = int(generator.integers(-20, 21))
    scaled = np.ldexp(surface.vertices, power)
    found = sense(Surface(scaled, surface.faces, surface.face_colours))
    yield Finding(
        "invariance/scale by a power of two",
        [
            not np.array_equal(getattr(found, name), getattr(wanted, name))
            for name in ("triangles", "saliency", "points", "images", "features")
        ],
        f"scale 2^{power}",
        drawings.triangles(wanted.triangles, "the object"),
        cases=1,
    )


def places(generator: np.random.Generator) -> Iterator[Finding]:
    """Move a mesh far from the origin."""
    surface = lopsided()
    size, offset = pick(generator, -6, 6), pick(generator, 0, 6)
    towards = generator.normal(size=3)
    towards *= 10.0**offset / np.linalg.norm(towards)
    moved = Surface(10.0**size * (surface.vertices + towards), surface.faces, surface.face_colours)
    found, wanted = (
        normalise(each, "object", merge_tolerance=0).triangles for each in (moved, surface)
    )
    yield Finding(
        "invariance/vertices, offset up to 1e6 sizes",
        np.linalg.norm(found - wanted, axis=2),
        f"size 1e{size:.1f}, 1e{offset:.2f} sizes off",
        drawings.triangles(wanted, "the object"),
        cases=1,
    )
