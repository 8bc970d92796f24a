"""A sound object passes every check, and each planted error is found by the check that is about it."""

import dataclasses

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
import trimesh
from numerics.surfaces import of_trimesh
from stability.errors import plant

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.meshes.preparing import normalise
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import run
from visuohaptic.stability import objects
from visuohaptic.stability.object_files import make_object_stability
from visuohaptic.stability.objects import SensedObject, check_object
from visuohaptic.tables.phases import FIXATIONS, TOUCHES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY
from visuohaptic.touches.choosing import touched_places

PARAMETERS = ExperimentParameters.from_mapping(
    {"viewpoints": {"count": 2}, "rendering": {"resolution": 64}}
)


@pytest.fixture(scope="module")
def sensed():
    surface = normalise(of_trimesh(trimesh.creation.torus(0.6, 0.25, 24, 16)), "torus")
    made = run(Subject("ring/torus", lambda: RayCaster(surface), range(2)), PARAMETERS)
    touches = made["touches"]
    located = touched_places(made["fixations"], touches)
    attention, sensor, scene = PARAMETERS.attention, PARAMETERS.sensor, PARAMETERS.scene
    return SensedObject(surface, located, touches, attention, sensor, scene, PARAMETERS.seed)


def broken(sensed):
    found = check_object(sensed, np.random.default_rng(1))
    return [name.removeprefix("objects/") for name, result in found.items() if not result.held]


def with_column(table, name, change):
    place = table.schema.get_field_index(name)
    return table.set_column(place, table.schema.field(name), pa.array(change(table.column(name))))


def test_a_sound_object_passes_every_check(sensed):
    found = check_object(sensed, np.random.default_rng(1))
    assert len(found) == 7
    assert all(result.held for result in found.values())


def test_a_caster_that_errs_is_found(sensed, monkeypatch):
    plant(monkeypatch, objects, "RayCaster")
    assert broken(sensed)[:2] == [
        "hits lie on their face's plane",
        "rays against brute force in float64",
    ]


def test_a_location_off_its_face_is_found(sensed):
    moved = with_column(sensed.fixations, "x", lambda x: x.to_numpy() + 1e-9)
    found = broken(dataclasses.replace(sensed, fixations=moved))
    assert "probing locations lie on their face's plane" in found


def test_a_normal_that_is_too_long_is_found(sensed):
    longer = with_column(sensed.touches, "normal_y", lambda y: y.to_numpy() * (1 + 1e-9))
    found = broken(dataclasses.replace(sensed, touches=longer))
    assert found == ["frames of touches", "touches by themselves"]


def test_fixations_that_are_too_close_are_found(sensed):
    wider = AttentionParameters(focus_radius=PARAMETERS.attention.focus_radius * 3)
    found = broken(dataclasses.replace(sensed, attention=wider))
    assert found == ["fixations of a view are a focus apart"]


def test_an_imprint_that_is_not_given_back_is_found(sensed, monkeypatch):
    plant(monkeypatch, objects, "Contourlet")
    assert broken(sensed) == ["contourlet reconstruction of imprints"]


def test_another_imprint_in_the_table_is_found(sensed):
    turned = with_column(
        sensed.touches, "penetration", lambda depth: pc.add(depth, 1e-12).to_numpy()
    )
    assert broken(dataclasses.replace(sensed, touches=turned)) == ["touches by themselves"]


def test_a_check_that_breaks_off_is_named(sensed):
    found = check_object(
        dataclasses.replace(sensed, touches=sensed.touches.drop_columns(["image"])),
        np.random.default_rng(1),
    )
    result = found["objects/contourlet reconstruction of imprints"]
    assert not result.held
    assert "KeyError" in result.hardest


def test_an_object_that_was_set_aside_has_a_table_without_rows(tmp_path):
    for schema in (FIXATIONS, TOUCHES):
        write_table(schema, schema.arrow.empty_table(), tmp_path / f"{schema.name}.parquet")
    make_object_stability(
        {"cup/mug": tmp_path / "none.ply"},
        tmp_path / "fixations.parquet",
        tmp_path / "touches.parquet",
        tmp_path / "found.parquet",
        PARAMETERS.attention,
        PARAMETERS.sensor,
        PARAMETERS.scene,
        1,
    )
    assert read_table(STABILITY, tmp_path / "found.parquet").num_rows == 0
