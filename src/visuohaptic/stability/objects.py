"""Checks on an object of the run: its own mesh, where it was looked at, and what was felt there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from contourlets import Contourlet
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.raycasting import Hits, RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.stability import drawings, oracles
from visuohaptic.stability.findings import Finding, Result, measure, merge_results
from visuohaptic.stability.rays import Floats, aim, draw_ray, everything, plane_errors
from visuohaptic.stability.tolerances import TOLERANCES
from visuohaptic.tables.schema import images, matrix
from visuohaptic.touches.touching import touch_tables

RAYS = 2000
RAYS_BY_BRUTE_FORCE = 48
TOUCHED_AGAIN = 4


@dataclass(frozen=True)
class SensedObject:
    """An object and what the run has of it: fixations and touches are n rows in one order, the places touched."""

    surface: Surface
    fixations: pa.Table
    touches: pa.Table
    attention: AttentionParameters
    sensor: SensorParameters
    scene: Scene
    seed: int


def check_object(sensed: SensedObject, generator: np.random.Generator) -> dict[str, Result]:
    """Make every check on an object, and give the worst case by tolerance, as `measure` does."""
    return merge_results(
        result
        for check, names in _CHECKS
        for result in measure(
            partial(check, sensed, generator), {name: TOLERANCES[name] for name in names}
        )
    )


def rays(sensed: SensedObject, generator: np.random.Generator) -> Iterator[Finding]:
    """Aim rays at vertices, edges and faces; a part of them is compared with brute force."""
    surface = sensed.surface
    targets = aim(surface, generator, RAYS)
    origins = generator.normal(size=(RAYS, 3))
    origins *= 2.0 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = targets - origins
    caster = RayCaster(surface)
    hits = caster.first_hits(origins, directions, everything)
    faces_near = _face_finder(surface)

    def draw(row: int) -> str:
        near = faces_near(origins[row], directions[row])
        part = Surface(surface.vertices, surface.faces[near], surface.face_colours[near])
        return draw_ray(part, origins, directions, "a ray and the faces near it")(row)

    def describe(row: int) -> str:
        return f"ray from {origins[row]} along {directions[row]}"

    for some in (hits, caster.first_hits(origins, directions)):
        # A ray that meets nothing has no error: it is brute force that looks for it.
        met = Hits(np.where(some.hit, some.distance, 0), np.maximum(some.face, 0))
        errors = np.where(some.hit, plane_errors(surface, origins, directions, met), 0)
        yield Finding("objects/hits lie on their face's plane", errors, describe, draw)
    wrong = []
    for origin, direction, distance in zip(
        origins[:RAYS_BY_BRUTE_FORCE], directions, hits.distance, strict=False
    ):
        triangles = surface.triangles[faces_near(origin, direction)]
        right, _, unsure = oracles.first_hits(triangles, origin[None], direction[None])
        same = distance == right[0] or abs(distance - right[0]) <= 1e-9
        wrong.append(not same and not unsure[0])
    yield Finding("objects/rays against brute force in float64", wrong, describe, draw)


def _face_finder(surface: Surface) -> Callable[[Floats, Floats], NDArray[np.intp]]:
    """Give what finds the faces within whose bounding spheres a line passes."""
    centres = surface.triangles.mean(axis=1)
    radii = np.linalg.norm(surface.triangles - centres[:, None], axis=2).max(axis=1)

    def faces_near(origin: Floats, direction: Floats) -> NDArray[np.intp]:
        offset = centres - origin
        along = offset @ (direction / np.linalg.norm(direction))
        aside = np.einsum("fd,fd->f", offset, offset) - along**2
        return np.flatnonzero(aside <= (radii + 1e-6) ** 2)

    return faces_near


def probing_locations(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Want every probing location on its face."""
    points = matrix(sensed.fixations, ("x", "y", "z"))
    faces = sensed.fixations.column("face").to_numpy()
    corners = sensed.surface.triangles[faces]
    apart = points - corners[:, 0]
    yield Finding(
        "objects/probing locations lie on their face's plane",
        np.abs(np.einsum("nd,nd->n", apart, sensed.surface.face_normals[faces])),
        lambda row: _describe_row(sensed.fixations, row),
        lambda row: drawings.triangles(corners[row][None], "the face"),
    )


def frames(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Want the sensor's normal and its +column axis of unit length and at a right angle."""
    normal, tangent = (
        matrix(sensed.touches, [f"{name}_{axis}" for axis in "xyz"])
        for name in ("normal", "tangent")
    )
    errors = [np.abs(np.linalg.norm(vectors, axis=1) - 1) for vectors in (normal, tangent)]
    errors.append(np.abs(np.einsum("nd,nd->n", normal, tangent)))
    yield Finding(
        "objects/frames of touches",
        np.max(errors, axis=0),
        lambda row: _describe_row(sensed.touches, row),
        lambda row: drawings.image(images(sensed.touches.slice(row, 1))[0], "the imprint"),
    )


def fixations(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Want the fixations of a view a focus apart, where inhibition is on the surface."""
    if sensed.attention.inhibition != "surface":
        return
    nearest = sensed.attention.focus_radius * (1 - 1e-6)
    rows = sensed.fixations
    looked = np.flatnonzero(np.asarray(rows.column("pixel_row").is_valid()))
    points = matrix(rows, ("x", "y", "z"))
    pixels = matrix(rows.take(looked), ("viewpoint", "pixel_row", "pixel_column"))
    for viewpoint in np.unique(pixels[:, 0]):
        # A view with too few fixations begins again with its first; one row for each is enough.
        first = np.unique(pixels[pixels[:, 0] == viewpoint], axis=0, return_index=True)[1]
        places = points[looked[pixels[:, 0] == viewpoint][first]]
        apart = np.linalg.norm(places[:, None] - places[None], axis=2)
        apart[np.diag_indices(len(apart))] = np.inf
        yield Finding(
            "objects/fixations of a view are a focus apart",
            apart.min(axis=1, initial=np.inf) < nearest,
            f"viewpoint {viewpoint:.0f}",
        )


def imprints(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Decompose the imprints into contourlets and put them together again."""
    felt = images(sensed.touches).astype(np.float64)
    yield Finding(
        "objects/contourlet reconstruction of imprints",
        reconstruction_errors(felt),
        lambda row: _describe_row(sensed.touches, row),
        lambda row: drawings.image(felt[row], "the imprint"),
    )


def reconstruction_errors(images: Floats) -> Floats:
    """Decompose images, shape (n, side, side), put them together again, and give each one's error.

    Errors are in units of the image's largest pixel; an image of zeros counts as one of ones.
    """
    transform = Contourlet(levels=(4,))
    again = transform.inverse(transform.forward(images))
    largest = np.abs(images).max(axis=(1, 2))
    return np.abs(again - images).max(axis=(1, 2)) / np.where(largest > 0, largest, 1.0)


def repeated_touches(sensed: SensedObject, generator: np.random.Generator) -> Iterator[Finding]:
    """Touch some places again, without the others: every bit is the same."""
    count = min(TOUCHED_AGAIN, len(sensed.fixations))
    rows = np.sort(generator.choice(len(sensed.fixations), count, replace=False))
    located, before = sensed.fixations.take(rows), sensed.touches.take(rows)
    caster = RayCaster(sensed.surface)
    ranks = before.column("rank").to_numpy()
    again, _ = touch_tables(caster, located, sensed.sensor, sensed.scene, sensed.seed, ranks)
    yield Finding(
        "objects/touches by themselves",
        [not again.slice(row, 1).equals(before.slice(row, 1)) for row in range(count)],
        lambda row: _describe_row(before, row),
        lambda row: drawings.image(images(before.slice(row, 1))[0], "the imprint"),
    )


def _describe_row(table: pa.Table, row: int) -> str:
    found = table.select(["viewpoint", "strategy", "touch"]).slice(row, 1).to_pylist()[0]
    return f"viewpoint {found['viewpoint']}, {found['strategy']}, touch {found['touch']}"


_CHECKS = (
    (
        rays,
        (
            "objects/hits lie on their face's plane",
            "objects/rays against brute force in float64",
        ),
    ),
    (probing_locations, ("objects/probing locations lie on their face's plane",)),
    (frames, ("objects/frames of touches",)),
    (fixations, ("objects/fixations of a view are a focus apart",)),
    (imprints, ("objects/contourlet reconstruction of imprints",)),
    (repeated_touches, ("objects/touches by themselves",)),
)
