"""Rays where they go wrong: at vertices and edges, along faces, through slivers, far off centre."""

import functools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numerics import drawings, oracles
from numerics.shapes import closed_shapes, float32_exact, soup, surface_of

from visuohaptic.geometry.raycasting import MISS, Hits, RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.preparing import normalise

SEEDS = st.integers(0, 2**32 - 1)


def everything(distances):
    return np.ones(len(distances), dtype=bool)


def lost(distances):
    return ~np.isfinite(distances)


def residuals(surface, origins, directions, hits):
    """Distance of each hit point from the plane of its face; the error along the normal."""
    corners = surface.triangles[hits.face]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    points = origins + hits.distance[:, None] * directions
    return np.abs(((points - corners[:, 0]) * normals).sum(axis=1)) / np.where(
        lengths > 0, lengths, 1
    )


def drawn(surface, origins, directions, label):
    def draw(row):
        ray = np.stack([origins[row], origins[row] + 3 * directions[row]])
        return drawings.triangles(surface.triangles, label, ray)

    return draw


def random_rays(generator, count):
    origins = generator.normal(size=(count, 3))
    origins *= 1.8 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = generator.uniform(-0.6, 0.6, (count, 3)) - origins
    return (
        origins.astype(np.float32).astype(np.float64),
        directions.astype(np.float32).astype(np.float64),
    )


@given(seed=SEEDS, count=st.integers(1, 60))
def test_random_triangles_are_met_as_by_brute_force(hold, seed, count):
    generator = np.random.default_rng(seed)
    surface = soup(generator, count)
    origins, directions = random_rays(generator, 400)
    caster = RayCaster(surface)
    hits = caster.settled_hits(origins, directions, everything)
    distance, _, unsure = oracles.first_hits(surface.triangles, origins, directions)
    # Coplanar hits may name either face; what must agree is whether and where something is met.
    apart = np.abs(
        np.where(hits.hit, hits.distance, 9) - np.where(np.isfinite(distance), distance, 9)
    )
    wrong = (apart > 1e-9) & ~unsure
    draw = drawn(surface, origins, directions, "random triangles and a ray")
    hold(
        "rays/face chosen against brute force in float64",
        wrong,
        lambda row: f"{count} random triangles, slivers among them (seed {seed}, ray {row})",
        draw,
    )
    # A sliver's plane is as uncertain as its corners' rounding over its height.
    for kind, some in (("settled", hits), ("first", caster.first_hits(origins, directions))):
        met = np.flatnonzero(some.hit)
        met = met[surface.face_areas[some.face[met]] > 1e-6]
        kept = Hits(some.distance[met], some.face[met], some.barycentric[met])
        hold(
            "rays/hits lie on their face's plane",
            residuals(surface, origins[met], directions[met], kept),
            lambda row, kind=kind, met=met: (
                f"{count} random triangles (seed {seed}, {kind} hit of ray {met[row]})"
            ),
            lambda row, met=met: draw(met[row]),
        )


def aimed_targets(surface, generator, count):
    """Points at vertices, at edges and within faces, a third each."""
    corners = surface.triangles[generator.integers(0, len(surface.faces), count)]
    share = np.rint(generator.random((count, 1)) * 64) / 64
    share[::3] = 0
    targets = corners[:, 0] * (1 - share) + corners[:, 1] * share
    targets[2::3] = corners[2::3].mean(axis=1)
    return targets


@pytest.mark.parametrize("shape", ["ball", "torus", "box", "needle"])
@pytest.mark.parametrize("count", [60, pytest.param(1500, marks=pytest.mark.hard)])
def test_rays_aimed_at_vertices_and_edges_agree_with_exact_rationals(hold, shape, count):
    generator = np.random.default_rng(5)
    surface = closed_shapes()[shape]
    targets = aimed_targets(surface, generator, count)
    origins = np.rint(generator.uniform(-2, 2, (count, 3)) * 256) / 256
    directions = targets - origins
    hits = RayCaster(surface).settled_hits(origins, directions, everything)
    exact = [
        oracles.exact_first_hit(surface.triangles, origin, direction)
        for origin, direction in zip(origins, directions, strict=True)
    ]
    expected = np.array([np.inf if value is None else float(value) for value in exact])
    length = np.linalg.norm(directions, axis=1)
    both = np.isfinite(expected) & hits.hit
    error = np.abs(np.where(both, hits.distance, 0) - np.where(both, expected, 0)) * length
    # The direction was rounded: rays at a silhouette may pass on either side of it in rationals,
    # and float64 may keep what rationals lose by 1e-16; such a hit must still touch the surface.
    normals = surface.face_normals[np.where(hits.hit, hits.face, 0)]
    cosine = np.abs((normals * directions).sum(axis=1)) / length
    error = np.where(both, error * cosine, 0)
    hold(
        "rays/against exact rationals, aimed at vertices and edges",
        error,
        lambda row: f"{shape}, ray {row} from {origins[row]}",
        drawn(surface, origins, directions, f"{shape} and a ray at a vertex or edge"),
    )
    differ = np.isfinite(expected) & ~hits.hit
    hold(
        "rays/leaks out of closed surfaces",
        differ,
        lambda row: f"{shape}: rationals meet it, the caster does not (ray {row})",
        drawn(surface, origins, directions, f"{shape} and a lost ray"),
    )


@pytest.mark.parametrize("shape", ["ball", "fine ball", "box", "needle"])
@pytest.mark.parametrize("count", [20_000, pytest.param(250_000, marks=pytest.mark.hard)])
def test_no_ray_leaves_a_closed_surface_from_inside(hold, recorder, shape, count):
    generator = np.random.default_rng(11)
    surface = closed_shapes()[shape]
    caster = RayCaster(surface)
    first_casts_lost = 0
    for start in range(0, count, 50_000):
        size = min(50_000, count - start)
        middle = surface.vertices.mean(axis=0)
        inner = generator.uniform(-0.5, 0.5, (size, 1))
        towards = surface.vertices[generator.integers(0, len(surface.vertices), size)] - middle
        origins = middle + inner * towards
        directions = generator.normal(size=(size, 3))
        targets = aimed_targets(surface, generator, size)
        aimed = np.arange(size) % 2 == 0
        directions[aimed] = targets[aimed] - origins[aimed]
        first_casts_lost += int((~caster.first_hits(origins, directions).hit).sum())
        hits = caster.settled_hits(origins, directions, lost)
        hold(
            "rays/leaks out of closed surfaces",
            ~hits.hit,
            lambda row, o=origins, d=directions: f"{shape}, from {o[row]} along {d[row]}",
            drawn(surface, origins, directions, f"{shape} and a leak"),
        )
    recorder.tell(
        "leaks",
        {
            "surface": shape,
            "rays": count,
            "lost_by_float32": first_casts_lost,
            "lost_after_settling": 0,
        },
    )


@given(
    exponent=st.floats(-9, -1),
    share=st.floats(0.01, 0.99),
    offset=st.floats(-0.4, 0.4),
)
def test_grazing_rays_meet_a_plane_where_they_should(hold, exponent, share, offset):
    plate = surface_of([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], [[0, 2, 1], [0, 3, 2]])
    slope = 10.0**exponent
    height = slope * share * 1.8
    origins, directions = np.array([[-0.9, height, offset]]), np.array([[1.0, -slope, 0.0]])
    hits = RayCaster(plate).settled_hits(origins, directions, everything)
    expected = height / slope
    assert hits.hit.all()
    hold(
        "rays/grazing",
        np.abs(hits.distance - expected) * slope,
        f"slope {slope:.2g}, met at {expected:.6f}",
        drawn(plate, origins, directions, "a plate and a grazing ray"),
    )


@pytest.mark.parametrize("height", [0.0, 0.25, 0.5, -0.5])
@pytest.mark.parametrize("angle", np.linspace(0, 2 * np.pi, 17))
def test_rays_within_a_plane_of_faces_end_at_a_rim_or_miss(hold, height, angle):
    box = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    surface = surface_of(box, faces)
    direction = np.array([np.cos(angle), 0.0, np.sin(angle)])
    origins, directions = (-2 * direction + [0, height, 0])[None], direction[None]
    for hits in (
        RayCaster(surface).settled_hits(origins, directions, everything),
        RayCaster(surface).first_hits(origins, directions),
    ):
        if not hits.hit[0]:
            continue
        point = origins[0] + hits.distance[0] * direction
        off = np.abs(np.abs(point).max() - 0.5)
        hold(
            "rays/within a face's plane",
            not (np.isfinite(hits.distance[0]) and off < 1e-6),
            f"box, height {height}, {np.degrees(angle):.1f} degrees",
        )
    inside = abs(height) < 0.5
    assert hits.hit[0] or not inside


@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9, 2e-12])
def test_rays_through_slivers_meet_a_closed_floor(hold, width):
    generator = np.random.default_rng(3)
    edge = 0.125
    xs = np.array([-0.5, edge, edge + width, 0.5])
    vertices = np.array([[x, 0.0, z] for x in xs for z in (-0.5, 0.5)])
    faces = [
        f for k in range(3) for f in ([2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2])
    ]
    surface = surface_of(vertices, faces)
    count = 3000
    x = np.where(
        generator.random(count) < 0.5,
        edge + width * generator.uniform(-3, 4, count),
        edge + 1e-6 * generator.normal(size=count),
    )
    origins = np.column_stack([x, np.ones(count), generator.uniform(-0.45, 0.45, count)])
    hits = RayCaster(surface).settled_hits(origins, np.tile([0, -1.0, 0], (count, 1)), lost)
    hold(
        "rays/through slivers of 1e-12 area",
        np.where(hits.hit, np.abs(hits.distance - 1.0), np.inf),
        lambda row: f"a floor with a strip of width {width:g}, ray at {x[row] - edge:.3g} from it",
        drawings.triangles(
            surface.triangles[:, :, [0, 2, 1]], f"a floor with a strip of width {width:g}"
        ),
    )


def test_faces_on_top_of_each_other_give_the_lower_one_in_any_batch(hold):
    generator = np.random.default_rng(4)
    corners = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1.0]])
    vertices = np.vstack([corners, 0.5 * corners, 0.7 * corners @ np.diag([1, 1, 0.3])])
    surface = float32_exact(
        surface_of(vertices, [[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6], [8, 10, 9], [8, 11, 10]])
    )
    caster = RayCaster(surface)
    origins = np.column_stack(
        [generator.uniform(-0.6, 0.6, 2000), np.ones(2000), generator.uniform(-0.6, 0.6, 2000)]
    )
    directions = np.tile([0, -1.0, 0], (2000, 1))
    together = caster.settled_hits(origins, directions, everything)
    order = generator.permutation(2000)
    apart = caster.settled_hits(origins[order], directions[order], everything)
    wrong = (together.face != np.where(origins[:, 0] > origins[:, 2], 0, 1)) & (
        np.abs(origins[:, 0] - origins[:, 2]) > 1e-9
    )
    wrong |= together.distance != 1.0
    hold(
        "rays/coplanar faces on top of each other",
        wrong | (apart.face != together.face[order])[np.argsort(order)],
        lambda row: f"three squares in one plane, ray at {origins[row, [0, 2]]}",
        drawings.triangles(surface.triangles[:, :, [0, 2, 1]], "three squares in one plane"),
    )


@given(seed=SEEDS, size=st.floats(-6, 6), offset=st.floats(0, 6))
def test_a_mesh_far_off_centre_is_met_as_the_same_mesh_at_home(hold, seed, size, offset):
    generator = np.random.default_rng(seed)
    home = closed_ball()
    towards = generator.normal(size=3)
    shift = 10.0**size * 10.0**offset * towards / np.linalg.norm(towards)
    away = Surface(10.0**size * home.vertices + shift, home.faces, home.face_colours)
    casters = [RayCaster(normalise(surface, "ball", merge_tolerance=0)) for surface in (home, away)]
    targets = generator.normal(size=(200, 3))
    targets *= 0.8 / np.linalg.norm(targets, axis=1, keepdims=True)
    origins = 2.5 * targets
    near, far = (caster.settled_hits(origins, -targets) for caster in casters)
    hold(
        "rays/meshes far off centre",
        np.where(near.hit & far.hit, np.abs(near.distance - far.distance) * 0.8, np.inf),
        f"a ball of size 1e{size:.1f}, 1e{offset:.1f} sizes off",
    )


@functools.cache
def closed_ball():
    return closed_shapes()["ball"]


def test_a_miss_keeps_no_number_of_a_face(hold):
    ball = closed_ball()
    origins = np.array([[3.0, 0, 0], [0, 0, 0]])
    hits = RayCaster(ball).settled_hits(origins, np.array([[1.0, 0, 0], [0, 0, 0.0]]), everything)
    # A direction of length 0 goes nowhere and meets nothing.
    assert (hits.face == MISS).all()
    assert np.isinf(hits.distance).all()
