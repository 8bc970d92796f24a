"""What effects cost and move is measured for every scene, and is 0 where nothing needs them."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from studies.surfaces import RUN, run_tables, surface_of, write_meshes

from visuohaptic.fixations import rendering
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.scene.parameters import PRESETS, VISUAL_EFFECTS, EffectModes, Scene
from visuohaptic.studies.effects.influence import (
    make_effect_influence,
    measured_scenes,
    sum_influences,
    touch_influence,
    view_influence,
)
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FIXATIONS
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import EFFECT_INFLUENCE


@pytest.fixture(scope="module")
def surface():
    torus = surface_of(trimesh.creation.torus(0.6, 0.3, major_sections=24, minor_sections=16))
    return replace(torus, face_colours=np.full_like(torus.face_colours, 120))


@pytest.fixture(scope="module")
def fixations(surface):
    return run_tables({"ring/torus": surface})[0]


def test_every_preset_is_measured_and_the_run_stands_for_its_own():
    scene = Scene(preset="fsr400", noise=0.2)
    scenes = measured_scenes(scene, "square")
    assert set(scenes) == set(PRESETS)
    assert scenes["fsr400"] is scene
    assert scenes["ideal"] == Scene()


def test_an_effect_moves_images_where_it_is_needed_and_only_there(surface, fixations):
    off = Scene.model_validate({"preset": "fsr400", "effects": {"noise": "never"}})
    scenes = {**measured_scenes(Scene(), "square"), "without noise": off}
    found = touch_influence(RayCaster(surface), fixations, RUN.sensor, scenes, RUN.seed)
    shifts, needed = (
        {(part["scene"], part["effect"]): part[name] for part in found}
        for name in ("image_shift", "needed")
    )
    assert len(shifts) == len(scenes) * (len(EffectModes.model_fields) - len(VISUAL_EFFECTS))
    moved = {effect for (scene, effect), shift in shifts.items() if scene == "ideal" and shift > 0}
    assert moved == {"adaptive_size"}
    assert shifts["worn_fsr", "dead_cells"] > 0 == shifts["fsr400", "dead_cells"]
    assert shifts["worn_fsr", "noise"] > shifts["fsr400", "noise"] > 0
    assert needed["ideal", "noise"] == needed["fsr400", "dead_cells"] == 0
    assert needed["worn_fsr", "dead_cells"] == fixations.num_rows
    assert {part["touches"] for part in found} == {fixations.num_rows}
    # Leaving out what no touch needs changes no bit.
    equal = {part["scene"]: part["equal_to_always"] for part in found}
    assert equal == {**dict.fromkeys(PRESETS, True), "without noise": None}


def test_shadows_are_measured_even_where_none_are_cast(surface, monkeypatch):
    cameras = list(place_cameras(RUN.viewpoints))[:2]
    monkeypatch.setattr(rendering, "LIGHT_ELEVATION_DEGREES", 60.0)
    found = view_influence(RayCaster(surface), cameras, RUN.rendering, EffectModes())
    parts = {part["effect"]: part for part in found}
    assert list(parts) == list(VISUAL_EFFECTS)
    assert parts["cast_shadows"]["image_shift"] > 0
    assert parts["cast_shadows"]["seconds_always"] > 0 == parts["cast_shadows"]["seconds"]
    # All of the object has one grey.
    assert parts["colour"]["image_shift"] == parts["texture"]["image_shift"] == 0
    assert parts["shading"]["image_shift"] > parts["cast_shadows"]["image_shift"]


def test_objects_add_up_by_their_touches():
    names = [column.name for column in EFFECT_INFLUENCE.columns]
    values = [
        ("ideal", "noise", 10, 4, 1.0, 2.0, 0.1, True),
        ("ideal", "noise", 30, 5, 3.0, 4.0, 0.5, False),
    ]
    (row,) = sum_influences([dict(zip(names, one, strict=True)) for one in values]).to_pylist()
    assert tuple(row.values()) == ("ideal", "noise", 40, 9, 4, 6, pytest.approx(0.4), False)


def test_the_table_holds_effects_of_eye_and_hand(surface, fixations, tmp_path):
    files = {
        "meshes": write_meshes(tmp_path, {"ring/torus": surface}),
        "fixations": [tmp_path / "fixations.parquet"],
    }
    write_table(FIXATIONS, fixations, files["fixations"][0])
    make_effect_influence(StepInputs("influence", files, [tmp_path / "table"], RUN))
    rows = read_table(EFFECT_INFLUENCE, tmp_path / "table").to_pylist()
    assert {row["effect"] for row in rows if row["scene"] == "any"} == set(VISUAL_EFFECTS)
    assert {row["scene"] for row in rows} == {"any", *PRESETS}
