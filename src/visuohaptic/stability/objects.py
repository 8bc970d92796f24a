"""Checks on an object of the run: its own mesh, where it was looked at, and what was felt there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from contourlets import Contourlet
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.stability import oracles
from visuohaptic.stability.findings import Finding, Result, measure, merge_results
from visuohaptic.stability.rays import FloatArray, aim, everything, plane_errors
from visuohaptic.stability.rows import result_table
from visuohaptic.stability.tolerances import TOLERANCES
from visuohaptic.tables.phases import FIXATIONS, TOUCHES, by_object
from visuohaptic.tables.schema import images, matrix, read_table, write_table
from visuohaptic.tables.stability import STABILITY
from visuohaptic.touches.choosing import touched_places
from visuohaptic.touches.touching import touch_part

RAYS = 2000
RAYS_BY_BRUTE_FORCE = 48
TOUCHED_AGAIN = 4


class SensedObject(NamedTuple):
    """An object and what the run has of it: fixations and touches are n rows in one order, the places touched."""

    surface: Surface
    fixations: pa.Table
    touches: pa.Table
    attention: AttentionParameters
    sensor: SensorParameters
    scene: Scene
    seed: int


def make_object_stability(
    meshes: Mapping[str, str | Path],
    fixations: str | Path | Sequence[str | Path],
    touches: str | Path | Sequence[str | Path],
    output: str | Path,
    attention: AttentionParameters,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
) -> None:
    """Make the checks on some objects, by `class/name`, and write the table; one that was not touched has no rows."""
    located = dict(by_object(read_table(FIXATIONS, fixations)))
    parts = [STABILITY.arrow.empty_table()]
    for key, felt in by_object(read_table(TOUCHES, touches)):
        places = touched_places(located[key], felt)
        surface = read_surface(meshes[key])
        sensed = SensedObject(surface, places, felt, attention, sensor, scene, seed)
        found = check_object(sensed, spawn_generator(seed, "stability", key))
        parts.append(result_table(found.values(), key))
    write_table(STABILITY, pa.concat_tables(parts), output)


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
    centres = surface.triangles.mean(axis=1)
    radii = np.linalg.norm(surface.triangles - centres[:, None], axis=2).max(axis=1)

    def faces_near(row: int) -> NDArray[np.intp]:
        """Find the faces within whose bounding spheres a ray's line passes."""
        offset = centres - origins[row]
        along = offset @ (directions[row] / np.linalg.norm(directions[row]))
        aside = np.einsum("fd,fd->f", offset, offset) - along**2
        return np.flatnonzero(aside <= (radii + 1e-6) ** 2)

    def describe(row: int) -> str:
        return f"ray from {origins[row]} along {directions[row]}"

    for some in (hits, caster.first_hits(origins, directions)):
        errors = plane_errors(surface, origins, directions, some)
        yield Finding("hits lie on their face's plane", errors, describe)
    wrong = []
    for row in range(RAYS_BY_BRUTE_FORCE):
        ray = origins[row, None], directions[row, None]
        (right,), (unsure,) = oracles.first_hits(surface.triangles[faces_near(row)], *ray)
        same = hits.distance[row] == right or abs(hits.distance[row] - right) <= 1e-9
        wrong.append(not same and not unsure)
    yield Finding("rays against brute force in float64", wrong, describe)


def probing_locations(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Want every probing location on its face."""
    points = matrix(sensed.fixations, ("x", "y", "z"))
    faces = sensed.fixations.column("face").to_numpy()
    corners = sensed.surface.triangles[faces]
    apart = points - corners[:, 0]
    yield Finding(
        "probing locations lie on their face's plane",
        np.abs(np.einsum("nd,nd->n", apart, sensed.surface.face_normals[faces])),
        lambda row: _describe_row(sensed.fixations, row),
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
        "frames of touches",
        np.max(errors, axis=0),
        lambda row: _describe_row(sensed.touches, row),
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
            "fixations of a view are a focus apart",
            apart.min(axis=1, initial=np.inf) < nearest,
            f"viewpoint {viewpoint:.0f}",
        )


def imprints(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Decompose the imprints into contourlets and put them together again."""
    felt = images(sensed.touches).astype(np.float64)
    yield Finding(
        "contourlet reconstruction of imprints",
        reconstruction_errors(felt),
        lambda row: _describe_row(sensed.touches, row),
    )


def reconstruction_errors(images: FloatArray) -> FloatArray:
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
    again, _ = touch_part(caster, located, sensed.sensor, sensed.scene, sensed.seed, ranks)
    yield Finding(
        "touches by themselves",
        [not again.slice(row, 1).equals(before.slice(row, 1)) for row in range(count)],
        lambda row: _describe_row(before, row),
    )


def _describe_row(table: pa.Table, row: int) -> str:
    found = table.select(["viewpoint", "strategy", "touch"]).slice(row, 1).to_pylist()[0]
    return f"viewpoint {found['viewpoint']}, {found['strategy']}, touch {found['touch']}"


_CHECKS = (
    (
        rays,
        ("hits lie on their face's plane", "rays against brute force in float64"),
    ),
    (probing_locations, ("probing locations lie on their face's plane",)),
    (frames, ("frames of touches",)),
    (fixations, ("fixations of a view are a focus apart",)),
    (imprints, ("contourlet reconstruction of imprints",)),
    (repeated_touches, ("touches by themselves",)),
)
