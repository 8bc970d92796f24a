"""Every strategy gives locations on the surface, outwards, the same whatever else is asked for."""

import numpy as np
import pyarrow.compute as pc
import pytest
import trimesh
from numerics.surfaces import build_plain_surface, of_trimesh

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.locations import candidate_table, locate
from visuohaptic.fixations.object_views import ObjectViews
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.places import draw_by_area, face_outwards
from visuohaptic.fixations.probing import PLANNED
from visuohaptic.fixations.strategies.farthest_point import spread_far
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.parameters import VisualModes
from visuohaptic.tables.phases import FIXATIONS, SPARE
from visuohaptic.tables.schema import check_table, matrix

ATTENTION = AttentionParameters(fixations=6)
RENDERING = RenderingParameters(resolution=64)


@pytest.fixture(scope="module")
def caster():
    mesh = trimesh.creation.box((1.2, 0.8, 0.6)).subdivide()
    mesh.faces[::2] = mesh.faces[::2, ::-1]  # wound either way
    colours = np.random.default_rng(0).integers(0, 255, (len(mesh.faces), 3))
    return RayCaster(of_trimesh(mesh, colours))


def sight_of(caster, block=(0, 1, 2), attention=ATTENTION, strategies=()):
    subject = Subject("box/brick", lambda: caster, block)
    viewpoints = ViewpointParameters(count=4)
    return ObjectViews(subject, viewpoints, RENDERING, attention, strategies, VisualModes(), 3)


@pytest.fixture(scope="module")
def looks(caster):
    return sight_of(caster).attended_views


def places_of(table):
    """Return points and normals."""
    return (matrix(table, [f"{prefix}{axis}" for axis in "xyz"]) for prefix in ("", "normal_"))


@pytest.mark.parametrize("strategy", PLANNED.names)
def test_locations_lie_on_their_faces_and_face_outwards(caster, looks, strategy):
    table = locate(looks, [strategy], ATTENTION, 3)
    check_table(FIXATIONS, table)
    asked = table.filter(pc.less(table.column("touch"), ATTENTION.fixations))
    assert asked.num_rows == 18
    assert 18 < table.num_rows <= 18 + 3 * SPARE
    points, normals = places_of(table)
    flat = caster.surface.face_normals[table.column("face").to_numpy()]
    corners = caster.surface.triangles[table.column("face").to_numpy()]
    offsets = np.einsum("nk,nk->n", points - corners[:, 0], flat)
    np.testing.assert_allclose(offsets, 0, atol=1e-6)
    for row in table.filter(pc.is_valid(table.column("pixel_row"))).to_pylist():
        seen = looks[row["viewpoint"]].views.point[row["viewpoint"]]
        assert tuple(seen[row["pixel_row"], row["pixel_column"]]) == (row["x"], row["y"], row["z"])
    # A convex box: outwards is away from its centre.
    assert (np.abs(np.sum(flat * normals, axis=1)) > 0.7).all()
    assert (np.sum(points * normals, axis=1) > 0).all()


@pytest.mark.parametrize("strategy", PLANNED.names)
def test_locations_depend_on_their_own_viewpoint_alone_and_fewer_are_the_first_of_more(
    caster, looks, strategy
):
    many = locate([looks[1]], [strategy], ATTENTION, 3)
    assert many.equals(locate(sight_of(caster, (1,)).attended_views, [strategy], ATTENTION, 3))
    shorter = AttentionParameters(fixations=3)
    few = locate(sight_of(caster, (1,), shorter).attended_views, [strategy], shorter, 3)
    assert few.num_rows > 3
    assert few.equals(many.slice(0, 3 + SPARE))


@pytest.mark.parametrize("strategy", [*PLANNED], ids=lambda strategy: strategy.name)
def test_places_change_with_seed_viewpoint_and_view_as_their_entry_says(looks, strategy):
    first, seeded, other = (
        locate([looks[place]], [strategy.name], ATTENTION, seed)
        for place, seed in ((0, 3), (0, 4), (1, 3))
    )
    assert first.equals(seeded) != strategy.random
    assert first.column("x").to_pylist() != other.column("x").to_pylist()
    one = looks[0]
    blind = Viewpoint(one.key, one.number, one.caster, one.camera)
    if strategy.needs_view:
        with pytest.raises(AttributeError, match="Viewpoint"):
            locate([blind], [strategy.name], ATTENTION, 3)
    else:
        assert locate([blind], [strategy.name], ATTENTION, 3).equals(first)


def test_no_view_is_rendered_for_strategies_that_need_none(caster):
    for strategies, is_seen in ((("random", "random_walk"), False), (("random", "human"), True)):
        sight = sight_of(caster, strategies=strategies)
        assert set(sight.fixations.column("strategy").to_pylist()) == set(strategies)
        assert ("rendered" in vars(sight)) == is_seen


def test_random_probing_draws_by_area_and_random_probing_anywhere_the_same(caster, looks):
    """Earlier figures come from these draws, by a generator named random."""
    one = looks[1]
    generator = spawn_generator(3, "random", "box/brick", 1)
    (expected,) = face_outwards(caster, [draw_by_area(caster.surface, 6, generator)])
    reached, anywhere = (
        locate([one], [name], ATTENTION, 3) for name in ("random", "random_anywhere")
    )
    table = anywhere.slice(0, 6)
    points, normals = places_of(table)
    np.testing.assert_array_equal(points, expected.points)
    np.testing.assert_array_equal(normals, expected.normals)
    assert set(table.column("random_stream").to_pylist()) == {"random"}
    names = ["strategy", "unreachable"]
    assert reached.drop_columns(names).equals(anywhere.drop_columns(names))
    for found, unreachable in ((reached, "replace"), (anywhere, "keep")):
        assert set(found.column("unreachable").to_pylist()) == {unreachable}


def test_the_most_curved_places_of_a_box_are_its_edges(looks):
    for one in looks:
        points = next(places_of(locate([one], ["curvature"], ATTENTION, 3)))[:6]
        at_border = np.sum(np.abs(np.abs(points) - [0.6, 0.4, 0.3]) < 0.05, axis=1)
        assert (at_border >= 2).all()
        apart = np.linalg.norm(points[:, None] - points, axis=2) + 9 * np.eye(len(points))
        assert apart.min() > ATTENTION.focus_radius


def test_a_surface_without_curvature_has_places_too():
    flat = build_plain_surface([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    one = sight_of(RayCaster(flat), block=(0,)).attended_views[0]
    assert locate([one], ["curvature"], ATTENTION, 3).num_rows >= 6


def test_candidates_are_what_the_viewpoint_sees(caster, looks):
    crowd = spread_far(caster.surface, 60, np.random.default_rng(0))
    for one in looks:
        table = candidate_table(one, crowd)
        points, normals = places_of(table)
        assert 0 < len(points) < 60
        assert (np.sum(normals * (one.camera.eye - points), axis=1) > 0).all()
        assert table.column("touch").to_pylist() == list(range(len(points)))


@pytest.mark.parametrize("strategy", [one.name for one in PLANNED if one.random])
def test_a_draw_has_its_own_places_and_its_own_name_in_every_generator(caster, looks, strategy):
    first, *further = (
        locate([looks[0]], [name], ATTENTION, 3)
        for name in (strategy, f"{strategy}#1", f"{strategy}#2")
    )
    points = [matrix(table, ("x", "y", "z")) for table in (first, *further)]
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert not np.isclose(
            points[one][: ATTENTION.fixations], points[other][: ATTENTION.fixations]
        ).all()
    random_stream = first["random_stream"][0].as_py()
    assert [table["random_stream"][0].as_py() for table in further] == [
        f"{random_stream}#1",
        f"{random_stream}#2",
    ]
    assert further[0]["unreachable"][0].as_py() == first["unreachable"][0].as_py()


def test_the_first_draw_is_drawn_as_it_was_before_there_were_draws(caster, looks):
    generator = spawn_generator(3, "random", "box/brick", 0)
    (expected,) = face_outwards(caster, [draw_by_area(caster.surface, 6 + SPARE, generator)])
    found = locate([looks[0]], ["random"], ATTENTION, 3)
    np.testing.assert_array_equal(matrix(found, ("x", "y", "z")), expected.points)
    again = spawn_generator(3, "random#2", "box/brick", 0)
    (expected,) = face_outwards(caster, [draw_by_area(caster.surface, 6 + SPARE, again)])
    found = locate([looks[0]], ["random#2"], ATTENTION, 3)
    np.testing.assert_array_equal(matrix(found, ("x", "y", "z")), expected.points)


@pytest.mark.parametrize(
    "name", ["fixation#1", "random#0", "random#-1", "random#", "random#1#2", "none#1"]
)
def test_what_is_no_draw_of_a_random_strategy_is_refused(looks, name):
    with pytest.raises(RegistryError, match="is no"):
        locate([looks[0]], [name], ATTENTION, 3)
