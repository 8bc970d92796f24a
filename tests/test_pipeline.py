"""From a mesh file to features, file to file: what each phase writes is what its table promises."""

from dataclasses import replace

import numpy as np
import pyarrow.compute as pc
import pytest
import trimesh
from phases_by_files import run_phases

from visuohaptic import phases
from visuohaptic.attention.scanpath import INWARD_WEIGHT, TIE_TOLERANCE
from visuohaptic.fixations import object_views, rendering
from visuohaptic.fixations import parameters as fixation_parameters
from visuohaptic.geometry.subject import Subject
from visuohaptic.io.phase_files import check_arguments
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import OF_OBJECT, PHASES, inputs_needed_from, phases_after
from visuohaptic.pipeline import WORK, run, run_phase, touch_all_locations
from visuohaptic.scene.parameters import VISUAL_EFFECTS
from visuohaptic.tables.phases import FIXATIONS, NORMAL_NAMES, POINT_NAMES, SPARE, TOUCHES
from visuohaptic.tables.schema import write_table
from visuohaptic.touches.choosing import touched_locations

RING = {
    "seed": 7,
    "viewpoints": {"count": 3},
    "rendering": {"resolution": 64},
    "attention": {"fixations": 4},
    "recognition": {"touches": 4},
}


def ring(**changes):
    return ExperimentParameters.from_mapping({**RING, **changes})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("phases")
    trimesh.creation.torus(1, 0.4).export(folder / "torus.obj")
    mesh = folder / "torus.ply"
    make_mesh("ring/torus", Model("ring", "torus"), folder / "torus.obj", mesh, MeshParameters())
    return folder


@pytest.fixture(scope="module")
def tables(folder):
    return run_phases("ring/torus", folder / "torus.ply", folder, ring())


def test_a_phase_takes_what_a_phase_before_it_gives():
    given = set()
    for phase in PHASES:
        assert given >= set(phase.inputs), phase.name
        given |= set(phase.writes)


def test_a_run_in_memory_gives_the_tables_of_a_run_by_files(folder, tables):
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply", range(3))
    found = run(subject, ring())
    for name in ("fixations", "touches", "features"):
        assert found[name].equals(tables[name])


def test_a_run_goes_on_behind_the_tables_that_are_known(tables):
    known = {"touches": tables["touches"]}
    assert [phase.name for phase in phases_after(known)] == ["features"]
    found = run(Subject("ring/torus", None), ring(), known)
    assert found["features"].equals(tables["features"])


def test_what_is_needed_from_a_phase_on_was_made_before_it_also_where_one_is_put_between(
    monkeypatch,
):
    found = [inputs_needed_from(table) for table in ("views", "touches", "features")]
    assert found == [("meshes",), ("meshes", "fixations"), ("touches",)]
    looking, touching, describing = OF_OBJECT
    smoothing = replace(
        touching, name="smoothing", inputs=("touches",), writes={"smoothed": "smoothed"}
    )
    between = (looking, touching, smoothing, replace(describing, inputs=("smoothed",)))
    monkeypatch.setattr(phases, "OF_OBJECT", between)
    assert inputs_needed_from("smoothed") == ("touches",)
    assert inputs_needed_from("features") == ("smoothed",)


def test_every_probing_location_is_touched_where_everywhere_is_asked_for(folder, tables):
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply")
    located = tables["fixations"].slice(0, 4 + SPARE)
    changed = ring(probing={"when_exhausted": "begin_again"})
    found = run(subject, touch_all_locations(changed, located), {"fixations": located})
    assert found["touches"].num_rows == located.num_rows


def test_what_a_job_is_given_says_what_a_run_in_memory_takes():
    parameters = ring(scene={"preset": "worn_fsr"})
    for phase in OF_OBJECT:
        work = WORK[phase.name]
        written = check_arguments(work, phase.written_values(parameters))
        assert written == check_arguments(work, phase.values(parameters))


def test_every_viewpoint_and_strategy_gives_its_sequence_of_places_with_some_to_spare(tables):
    table = tables["fixations"].to_pandas()
    found = table.groupby(["viewpoint", "strategy"]).touch.agg(["count", "max"])
    assert len(found) == 3 * 2
    assert (found["count"] == found["max"] + 1).all()
    assert found["count"].between(4, 4 + SPARE).all()


def test_fixations_were_looked_at_and_random_points_were_not(tables):
    frame = tables["fixations"].to_pandas()
    looked = frame[frame.strategy == "fixation"]
    assert looked.saliency.notna().all()
    # Within the tie window the first pixel wins, or the one farther from the outline.
    first = looked.groupby("viewpoint").saliency.first()
    np.testing.assert_allclose(first, 1, rtol=TIE_TOLERANCE + INWARD_WEIGHT)
    blind = frame[frame.strategy == "random"]
    assert blind[["pixel_row", "pixel_column", "saliency"]].isna().all(axis=None)


def test_views_are_pictures_and_say_what_ran(tables):
    import cv2

    rows = tables["views"].to_pylist()
    assert len(rows) == 3
    for row in rows:
        view, saliency = (
            cv2.imdecode(np.frombuffer(row[name], np.uint8), cv2.IMREAD_UNCHANGED)
            for name in ("view", "saliency")
        )
        assert view.shape == (64, 64, 3)
        assert saliency.shape == (64, 64)
        assert saliency.max() == 255
        skipped = dict(row["skipped"])
        assert len(row["conspicuity"]) + len(skipped) == 8
        # The torus has one colour.
        assert "colour" in skipped


def test_touches_keep_the_keys_of_the_fixations_and_features_keys_place_and_normal(tables):
    fixations = touched_locations(tables["fixations"], tables["touches"])
    assert tables["touches"].num_rows == 3 * 2 * 4
    assert tables["touches"].select(TOUCHES.keys).equals(fixations.select(TOUCHES.keys))
    kept = [*TOUCHES.keys, *POINT_NAMES, *NORMAL_NAMES]
    assert tables["features"].select(kept).equals(tables["touches"].select(kept))


def test_the_books_count_every_touch_and_view_and_say_what_ran(tables):
    felt, seen = ({row["effect"]: row for row in tables[f"effects/{name}"].to_pylist()}
                  for name in ("touches", "views"))  # fmt: skip
    assert all(row["touches"] == 24 >= row["needed"] and row["reason"] for row in felt.values())
    # The plain scene needs geometry alone.
    assert {name for name, row in felt.items() if row["runs"]} == {"adaptive_size"}
    assert set(seen) == set(VISUAL_EFFECTS)
    assert {row["touches"] for row in seen.values()} == {3}
    # A grey torus has neither hues nor parts; the light has a direction, but casts no shadows.
    assert {name for name, row in seen.items() if row["needed"]} == {"shading", "cast_shadows"}
    assert {name for name, row in seen.items() if row["runs"]} == {"shading"}


def test_the_eye_looks_without_shading_where_the_scene_says_so(folder, tables):
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply", range(3))
    flat = run_phase(OF_OBJECT[0], subject, {}, ring(scene={"effects": {"shading": "never"}})).views
    pairs = zip(tables["views"]["view"], flat["view"], strict=True)
    assert all(shaded != other for shaded, other in pairs)


def test_a_scene_with_chance_in_it_repeats_with_its_seed(folder, tables):
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply")
    given = {"fixations": tables["fixations"]}
    worn = {"preset": "worn_fsr"}
    one, two, three = (
        run(subject, ring(seed=seed, scene=worn), given)["touches"] for seed in (7, 7, 8)
    )
    assert one.equals(two)
    assert not one.equals(three)


def test_a_run_of_a_policy_only_gives_in_memory_what_it_gives_by_files(folder, tmp_path):
    parameters = ring(probing={"strategies": ["seek_relief"]})
    assert (parameters.probing.planned, parameters.probing.policies) == ((), ("seek_relief",))
    found = run_phases("ring/torus", folder / "torus.ply", tmp_path, parameters)
    assert found["fixations"].num_rows == 0
    assert found["policy_fixations"].num_rows >= found["touches"].num_rows == 3 * 4
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply", range(3))
    assert run(subject, parameters)["features"].equals(found["features"])


def test_a_policy_changes_nothing_of_the_strategies_beside_it(folder, tables, tmp_path):
    strategies = ["fixation", "seek_relief", "random"]
    found = run_phases(
        "ring/torus", folder / "torus.ply", tmp_path, ring(probing={"strategies": strategies})
    )
    assert found["fixations"].equals(tables["fixations"])
    others = pc.not_equal(found["features"]["strategy"], "seek_relief")
    assert found["features"].filter(others).combine_chunks().equals(tables["features"])


def test_an_object_without_a_place_to_touch_has_no_rows(folder, tables, tmp_path):
    write_table(FIXATIONS, tables["fixations"].slice(0, 0), tmp_path / "fixations.parquet")
    found = run_phases("ring/torus", folder / "torus.ply", tmp_path, ring(), phases=OF_OBJECT[1:])
    assert {name: table.num_rows for name, table in found.items()} == {
        "touches": 0, "policy_fixations": 0, "effects/touches": 0, "features": 0,
    }  # fmt: skip


@pytest.fixture
def rendered_at_once(monkeypatch):
    """The numbers of views that are rendered together; at most two views of this size are."""
    monkeypatch.setattr(fixation_parameters, "PIXELS_AT_ONCE", 2 * 64**2 + 1)
    numbers = []

    def render(caster, cameras, *arguments):
        numbers.append(len(cameras))
        return rendering.render_views(caster, cameras, *arguments)

    monkeypatch.setattr(object_views, "render_views", render)
    return numbers


def test_a_run_in_memory_holds_few_views_and_finds_the_same(folder, rendered_at_once, tables):
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply", range(3))
    assert run(subject, ring())["features"].equals(tables["features"])
    assert rendered_at_once == [2, 1]


def test_a_job_holds_few_views_and_writes_the_same_tables(folder, rendered_at_once):
    subject = Subject.of_mesh("ring/torus", folder / "torus.ply", range(3))
    values = check_arguments(object_views.ObjectViews, PHASES[1].values(ring()))
    whole = object_views.ObjectViews(subject, **values)
    few = object_views.look(subject, **values)
    for name in ("fixations", "views"):
        assert getattr(few, name).equals(getattr(whole, name)), name
    assert few.effects.drop_columns("seconds").equals(whole.effects.drop_columns("seconds"))
    assert rendered_at_once == [2, 1, 3]
