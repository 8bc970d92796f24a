"""Numerical checks on an object of the run: its mesh, its fixations and its touches."""

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
from visuohaptic.touches.choosing import touched_locations
from visuohaptic.touches.touch_table import touch_part

RAYS = 2000
RAYS_BY_BRUTE_FORCE = 48
TOUCHED_AGAIN = 4


class SensedObject(NamedTuple):
    """An object of the run with its tables and parameters.

    Attributes
    ----------
    surface : Surface
        The object's mesh.
    fixations : pyarrow.Table
        The touched locations, n rows of `tables.FIXATIONS`.
    touches : pyarrow.Table
        The touches there, n rows of `tables.TOUCHES` in the same order.
    attention, sensor, scene, seed
        The parameters of the run.
    """

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
    """Check every touched object and write `tables.STABILITY`.

    Parameters
    ----------
    meshes : mapping of str to path
        The mesh of each object, by `class/name`.
    fixations, touches : path or sequence of paths
        Files of `tables.FIXATIONS` and `tables.TOUCHES`. Objects without touches have no rows in the output.
    output : path
        The file to write.
    attention, sensor, scene, seed
        The parameters of the run.
    """
    located = dict(by_object(read_table(FIXATIONS, fixations)))
    tables = [STABILITY.arrow.empty_table()]
    for key, felt in by_object(read_table(TOUCHES, touches)):
        touched = touched_locations(located[key], felt)
        surface = read_surface(meshes[key])
        sensed = SensedObject(surface, touched, felt, attention, sensor, scene, seed)
        results = check_object(sensed, spawn_generator(seed, "stability", key))
        tables.append(result_table(results.values(), key))
    write_table(STABILITY, pa.concat_tables(tables), output)


def check_object(sensed: SensedObject, generator: np.random.Generator) -> dict[str, Result]:
    """Run every check on an object and return the worst case by the name of its tolerance.

    A check that raises an error has an infinite worst error, as in `measure`.
    """
    return merge_results(
        result
        for check, names in _CHECKS
        for result in measure(
            partial(check, sensed, generator), {name: TOLERANCES[name] for name in names}
        )
    )


def rays(sensed: SensedObject, generator: np.random.Generator) -> Iterator[Finding]:
    """Check the ray caster on `RAYS` rays aimed at vertices, edges and faces.

    Every hit has to lie on the plane of its face. The first `RAYS_BY_BRUTE_FORCE` rays are compared with
    brute force (`oracles.first_hits`).
    """
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
        """Return the indices of faces with a bounding sphere that the ray's line meets."""
        offset = centres - origins[row]
        along = offset @ (directions[row] / np.linalg.norm(directions[row]))
        aside = np.einsum("fd,fd->f", offset, offset) - along**2
        return np.flatnonzero(aside <= (radii + 1e-6) ** 2)

    def describe(row: int) -> str:
        return f"ray from {origins[row]} along {directions[row]}"

    for cast in (hits, caster.first_hits(origins, directions)):
        errors = plane_errors(surface, origins, directions, cast)
        yield Finding("hits lie on their face's plane", errors, describe)
    wrong = []
    for row in range(RAYS_BY_BRUTE_FORCE):
        ray = origins[row, None], directions[row, None]
        (exact,), (unsure,) = oracles.first_hits(surface.triangles[faces_near(row)], *ray)
        same = hits.distance[row] == exact or abs(hits.distance[row] - exact) <= 1e-9
        wrong.append(not same and not unsure)
    yield Finding("rays against brute force in float64", wrong, describe)


def probing_locations(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Check that every probing location lies on the plane of its face."""
    points = matrix(sensed.fixations, ("x", "y", "z"))
    faces = sensed.fixations.column("face").to_numpy()
    corners = sensed.surface.triangles[faces]
    offsets = points - corners[:, 0]
    yield Finding(
        "probing locations lie on their face's plane",
        np.abs(np.einsum("nd,nd->n", offsets, sensed.surface.face_normals[faces])),
        lambda row: _describe_row(sensed.fixations, row),
    )


def frames(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Check that the sensor's normal and its +column axis are orthonormal."""
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
    """Check that fixations of a view are at least a focus radius apart; only with inhibition on the surface."""
    if sensed.attention.inhibition != "surface":
        return
    nearest = sensed.attention.focus_radius * (1 - 1e-6)
    rows = sensed.fixations
    # Only fixations have a pixel; other probing locations have none.
    in_view = np.flatnonzero(np.asarray(rows.column("pixel_row").is_valid()))
    points = matrix(rows, ("x", "y", "z"))
    pixels = matrix(rows.take(in_view), ("viewpoint", "pixel_row", "pixel_column"))
    for viewpoint in np.unique(pixels[:, 0]):
        # A view with too few fixations repeats its first fixations; one row per fixation is enough.
        first = np.unique(pixels[pixels[:, 0] == viewpoint], axis=0, return_index=True)[1]
        fixated = points[in_view[pixels[:, 0] == viewpoint][first]]
        distances = np.linalg.norm(fixated[:, None] - fixated[None], axis=2)
        distances[np.diag_indices(len(distances))] = np.inf
        yield Finding(
            "fixations of a view are a focus apart",
            distances.min(axis=1, initial=np.inf) < nearest,
            f"viewpoint {viewpoint:.0f}",
        )


def imprints(sensed: SensedObject, _: np.random.Generator) -> Iterator[Finding]:
    """Check that the contourlet transform reconstructs every imprint of a square grid."""
    if sensed.sensor.layout != "square":
        return
    felt = images(sensed.touches).astype(np.float64)
    yield Finding(
        "contourlet reconstruction of imprints",
        reconstruction_errors(felt),
        lambda row: _describe_row(sensed.touches, row),
    )


def reconstruction_errors(images: FloatArray) -> FloatArray:
    """Compute the reconstruction error (n,) of the contourlet transform on images (n, side, side).

    The error is the largest difference of a pixel, in units of the image's largest absolute pixel. The error
    of an image of zeros is absolute.
    """
    transform = Contourlet(levels=(4,))
    reconstructed = transform.inverse(transform.forward(images))
    largest = np.abs(images).max(axis=(1, 2))
    return np.abs(reconstructed - images).max(axis=(1, 2)) / np.where(largest > 0, largest, 1.0)


def repeated_touches(sensed: SensedObject, generator: np.random.Generator) -> Iterator[Finding]:
    """Check that a touch does not depend on the other touches: some are repeated without the rest, bit for bit."""
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
    touch = table.select(["viewpoint", "strategy", "touch"]).slice(row, 1).to_pylist()[0]
    return f"viewpoint {touch['viewpoint']}, {touch['strategy']}, touch {touch['touch']}"


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
