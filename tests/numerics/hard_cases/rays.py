"""Rays where they go wrong: at vertices and edges, along faces, through slivers, far off centre."""

import numpy as np
import trimesh
from numerics import oracles
from numerics.surfaces import (
    build_plain_surface,
    closed_shapes,
    draw_triangles,
    far_off,
    float32_exact,
    of_trimesh,
    pick,
    random_vectors,
)

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.meshes.preparing import normalise
from visuohaptic.stability.findings import Finding
from visuohaptic.stability.oracles import first_hits
from visuohaptic.stability.rays import aim, everything, plane_errors


def lost(distances):
    """Name the rays that met nothing as those to be settled."""
    return ~np.isfinite(distances)


def draw_rays(generator, count):
    """Draw rays from outside of the unit sphere to its inside; float32 holds them exactly."""
    origins = random_vectors(generator, count, 1.8)
    directions = generator.uniform(-0.6, 0.6, (count, 3)) - origins
    return tuple(each.astype(np.float32).astype(np.float64) for each in (origins, directions))


def random_triangles(generator):
    """Cast rays at random triangles, and compare with brute force."""
    count = int(generator.integers(1, 61))
    surface = draw_triangles(generator, count)
    origins, directions = draw_rays(generator, 400)
    caster = RayCaster(surface)
    hits = caster.first_hits(origins, directions, everything)
    distance, unsure = first_hits(surface.triangles, origins, directions)
    # Coplanar hits may name either face; what must agree is whether and where something is met.
    wanted = np.where(np.isfinite(distance), distance, 9)
    wrong = (np.abs(np.where(hits.hit, hits.distance, 9) - wanted) > 1e-9) & ~unsure

    def describe(row):
        return f"{count} random triangles, slivers among them, ray {row}"

    yield Finding("rays/face chosen against brute force in float64", wrong, describe)
    for some in (hits, caster.first_hits(origins, directions)):
        # A sliver's plane is as uncertain as its corners' rounding over its height.
        sliver = surface.face_areas[some.face] <= 1e-6
        errors = np.where(sliver, 0, plane_errors(surface, origins, directions, some))
        yield Finding("rays/hits lie on their face's plane", errors, describe)


def vertices_and_edges(generator):
    """Aim rays at vertices and edges, and compare with exact rationals."""
    count = 60
    shape = str(generator.choice(["ball", "torus", "box", "needle"]))
    surface = closed_shapes()[shape]
    targets = aim(surface, generator, count)
    origins = np.rint(generator.uniform(-2, 2, (count, 3)) * 256) / 256
    directions = targets - origins
    hits = RayCaster(surface).first_hits(origins, directions, everything)
    expected = oracles.exact_first_hits(surface.triangles, origins, directions)
    length = np.linalg.norm(directions, axis=1)
    both = np.isfinite(expected) & hits.hit
    error = np.abs(np.subtract(hits.distance, expected, where=both, out=np.zeros(count))) * length
    # The direction was rounded: rays at a silhouette may pass on either side of it in rationals,
    # and float64 may keep what rationals lose by 1e-16; such a hit must still touch the surface.
    normals = surface.face_normals[np.where(hits.hit, hits.face, 0)]
    cosine = np.abs((normals * directions).sum(axis=1)) / length
    yield Finding(
        "rays/against exact rationals, aimed at vertices and edges",
        error * cosine,
        lambda row: f"{shape}, ray {row} from {origins[row]}",
    )
    yield Finding(
        "rays/leaks out of closed surfaces",
        np.isfinite(expected) & ~hits.hit,
        lambda row: f"{shape}: rationals meet it, the caster does not (ray {row})",
    )


def leaks(generator):
    """Cast rays from within closed surfaces, half of them at vertices and edges."""
    count = 5000
    shape = str(generator.choice(["ball", "fine ball", "box", "needle"]))
    surface = closed_shapes()[shape]
    caster = RayCaster(surface)
    middle = surface.vertices.mean(axis=0)
    towards = surface.vertices[generator.integers(0, len(surface.vertices), count)] - middle
    origins = middle + generator.uniform(-0.5, 0.5, (count, 1)) * towards
    directions = generator.normal(size=(count, 3))
    aimed = np.arange(count) % 2 == 0
    directions[aimed] = aim(surface, generator, count)[aimed] - origins[aimed]
    first_lost = int((~caster.first_hits(origins, directions).hit).sum())
    without = f"of {count} rays {first_lost} are lost where misses are not settled in float64"
    yield Finding(
        "rays/leaks out of closed surfaces",
        ~caster.first_hits(origins, directions, lost).hit,
        lambda row: f"{shape}, from {origins[row]} along {directions[row]}; {without}",
    )


SQUARE = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1.0]])


def grazing(generator):
    """Cast a ray that meets a plate at a very small angle."""
    plate = build_plain_surface(SQUARE, [[0, 2, 1], [0, 3, 2]])
    slope = 10.0 ** pick(generator, -9, -1)
    height = slope * pick(generator, 0.01, 0.99) * 1.8
    origins = np.array([[-0.9, height, pick(generator, -0.4, 0.4)]])
    directions = np.array([[1.0, -slope, 0.0]])
    hits = RayCaster(plate).first_hits(origins, directions, everything)
    expected = height / slope
    errors = np.where(hits.hit, np.abs(hits.distance - expected) * slope, np.inf)
    label = f"slope {slope:.2g}, met at {expected:.6f}"
    yield Finding("rays/grazing", errors, label)


def within_a_plane(generator):
    """Cast rays within the planes of a box's faces: they end at a rim or miss."""
    surface = of_trimesh(trimesh.creation.box((1, 1, 1)))
    height = float(generator.choice([0.0, 0.25, 0.5, -0.5]))
    angles = np.append(np.linspace(0, 2 * np.pi, 17), generator.uniform(0, 2 * np.pi, 16))
    directions = np.column_stack([np.cos(angles), np.zeros(len(angles)), np.sin(angles)])
    origins = [0, height, 0] - 2 * directions
    caster = RayCaster(surface)
    for suspects in (everything, None):
        hits = caster.first_hits(origins, directions, suspects)
        ends = origins + np.where(hits.hit, hits.distance, 0)[:, None] * directions
        at_rim = np.isfinite(ends).all(axis=1) & (np.abs(np.abs(ends).max(axis=1) - 0.5) < 1e-6)
        may_miss = abs(height) == 0.5
        yield Finding(
            "rays/within a face's plane",
            ~np.where(hits.hit, at_rim, may_miss),
            lambda row: f"box, height {height}, {np.degrees(angles[row]):.1f} degrees",
        )


def slivers(generator):
    """Cast rays at a floor with a very narrow strip of two triangles."""
    width = float(generator.choice([1e-3, 1e-6, 1e-9, 2e-12]))
    edge, count = 0.125, 1500
    vertices = [[x, 0.0, z] for x in (-0.5, edge, edge + width, 0.5) for z in (-0.5, 0.5)]
    halves = np.array([[0, 1, 3], [0, 3, 2]])
    surface = build_plain_surface(vertices, [halves + 2 * k for k in range(3)])
    near = generator.random(count) < 0.5
    strip = edge + width * generator.uniform(-3, 4, count)
    x = np.where(near, strip, edge + 1e-6 * generator.normal(size=count))
    origins = np.column_stack([x, np.ones(count), generator.uniform(-0.45, 0.45, count)])
    hits = RayCaster(surface).first_hits(origins, np.tile([0, -1.0, 0], (count, 1)), lost)
    label = f"a floor with a strip of width {width:g}"
    yield Finding(
        "rays/through slivers of 1e-12 area",
        np.where(hits.hit, np.abs(hits.distance - 1.0), np.inf),
        lambda row: f"{label}, ray at {x[row] - edge:.3g} from it",
    )


def coplanar(generator):
    """Cast rays at squares in one plane, in two orders: the lower face is met in both."""
    count = 1000
    vertices = np.vstack([SQUARE, 0.5 * SQUARE, 0.7 * SQUARE @ np.diag([1, 1, 0.3])])
    faces = [[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6], [8, 10, 9], [8, 11, 10]]
    surface = float32_exact(build_plain_surface(vertices, faces))
    caster = RayCaster(surface)
    x, z = generator.uniform(-0.6, 0.6, (2, count))
    origins = np.column_stack([x, np.ones(count), z])
    directions = np.tile([0, -1.0, 0], (count, 1))
    together = caster.first_hits(origins, directions, everything)
    order = generator.permutation(count)
    apart = caster.first_hits(origins[order], directions[order], everything)
    wrong = (together.face != np.where(x > z, 0, 1)) & (np.abs(x - z) > 1e-9)
    wrong |= together.distance != 1.0
    wrong |= (apart.face != together.face[order])[np.argsort(order)]
    yield Finding(
        "rays/coplanar faces on top of each other",
        wrong,
        lambda row: f"three squares in one plane, ray at {origins[row, [0, 2]]}",
    )


def off_centre(generator):
    """Cast the same rays at a ball and at the same ball far off, both prepared as meshes are."""
    home = closed_shapes()["ball"]
    away, size, offset = far_off(generator, home)
    casters = [
        RayCaster(normalise(surface, "ball", merge_tolerance=0).surface) for surface in (home, away)
    ]
    targets = random_vectors(generator, 200, 0.8)
    near, far = (caster.first_hits(2.5 * targets, -targets) for caster in casters)
    apart = np.abs(near.distance - far.distance) * 0.8
    errors = np.where(near.hit & far.hit, apart, np.inf)
    label = f"a ball of size 1e{size:.1f}, 1e{offset:.1f} sizes off"
    yield Finding("rays/meshes far off centre", errors, label)
