"""A sound object passes every check, and each planted error is found by the check that is about it."""

import numpy as np
import pyarrow as pa
import pytest
import trimesh
from numerics.surfaces import of_trimesh
from recognition.synthetic import with_column
from stability.errors import plant

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.meshes.preparing import normalise
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import run
from visuohaptic.stability import objects
from visuohaptic.stability.objects import SensedObject, check_object, make_object_stability
from visuohaptic.tables.phases import FIXATIONS, TOUCHES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY
from visuohaptic.touches.choosing import touched_locations

PARAMETERS = ExperimentParameters.from_mapping(
    {"viewpoints": {"count": 2}, "rendering": {"resolution": 64}}
)

AGAIN = ["touches by themselves"]


@pytest.fixture(scope="module")
def sensed():
    surface = normalise(of_trimesh(trimesh.creation.torus(0.6, 0.25, 24, 16)), "torus").surface
    made = run(Subject("ring/torus", lambda: RayCaster(surface), range(2)), PARAMETERS)
    touches = made["touches"]
    located = touched_locations(made["fixations"], touches)
    attention, sensor, scene = PARAMETERS.attention, PARAMETERS.sensor, PARAMETERS.scene
    return SensedObject(surface, located, touches, attention, sensor, scene, PARAMETERS.seed)


def broken(sensed, **changes):
    found = check_object(sensed._replace(**changes), np.random.default_rng(1))
    assert len(found) == 7
    return [name for name, result in found.items() if not result.held]


def test_a_sound_object_passes_every_check(sensed):
    assert broken(sensed) == []


@pytest.mark.parametrize(
    ("part", "found"),
    [
        ("RayCaster", ["hits lie on their face's plane", "rays against brute force in float64"]),
        ("Contourlet", ["contourlet reconstruction of imprints"]),
    ],
)
def test_an_error_of_the_library_is_found(sensed, monkeypatch, part, found):
    plant(monkeypatch, objects, part)
    assert broken(sensed)[:2] == found


@pytest.mark.parametrize(
    ("table", "column", "change", "found"),
    [
        (
            "fixations",
            "x",
            lambda x: x + 1e-9,
            ["probing locations lie on their face's plane", *AGAIN],
        ),
        ("touches", "normal_y", lambda y: y * (1 + 1e-9), ["frames of touches", *AGAIN]),
        ("touches", "penetration", lambda depth: depth + 1e-12, AGAIN),
    ],
)
def test_an_error_in_a_table_is_found(sensed, table, column, change, found):
    own = getattr(sensed, table)
    other = with_column(own, column, pa.array(change(own[column].to_numpy())))
    assert broken(sensed, **{table: other}) == found


def test_fixations_that_are_too_close_are_found(sensed):
    wider = AttentionParameters(focus_radius=PARAMETERS.attention.focus_radius * 3)
    assert broken(sensed, attention=wider) == ["fixations of a view are a focus apart"]


def test_a_check_that_breaks_off_is_named(sensed):
    without = sensed._replace(touches=sensed.touches.drop_columns(["image"]))
    found = check_object(without, np.random.default_rng(1))
    result = found["contourlet reconstruction of imprints"]
    assert not result.held
    assert "KeyError" in result.hardest


def test_an_object_that_was_set_aside_has_a_table_without_rows(tmp_path):
    for schema in (FIXATIONS, TOUCHES):
        write_table(schema, schema.arrow.empty_table(), tmp_path / f"{schema.name}.parquet")
    files = [tmp_path / f"{name}.parquet" for name in ("fixations", "touches", "found")]
    sections = (PARAMETERS.attention, PARAMETERS.sensor, PARAMETERS.scene)
    make_object_stability({"cup/mug": tmp_path / "none.ply"}, *files, *sections, seed=1)
    assert read_table(STABILITY, files[-1]).num_rows == 0
