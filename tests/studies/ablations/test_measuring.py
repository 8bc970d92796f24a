"""An ablation changes one thing, from as late a table as it allows."""

import numpy as np
import pyarrow as pa
import pytest
import pywt
import trimesh
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.attention.parameters import CHANNELS
from visuohaptic.exploration.exploring import TouchableObject
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.geometry.surface import Surface, write_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.summary import select
from visuohaptic.scene.parameters import Scene
from visuohaptic.studies.ablations.measuring import (
    Sources,
    _fixated,
    changed_scene,
    make_ablation,
    name_objects,
    nonsubsampled_deviations,
    remake_features,
    wavelet_deviations,
)
from visuohaptic.studies.ablations.settings import ABLATIONS, WHOLE
from visuohaptic.tables.phases import (
    CONTOURLET_FEATURES,
    FEATURES,
    FIXATIONS,
    TOUCHES,
)
from visuohaptic.tables.schema import (
    images,
    matrix,
    read_table,
    write_table,
)
from visuohaptic.tables.studies import ABLATION

PARAMETERS = ExperimentParameters.from_mapping(
    {
        "viewpoints": {"count": 2},
        "rendering": {"resolution": 48},
        "recognition": {"best": {"waves": 20}, "intervals": {"bootstrap_samples": 100}},
    }
)
SOLIDS = {
    "ball/large": trimesh.creation.icosphere(2, radius=0.9),
    "ball/small": trimesh.creation.icosphere(2, radius=0.7),
    "box/cube": trimesh.creation.box((1.0, 1.0, 1.0)),
    "box/brick": trimesh.creation.box((1.2, 0.7, 0.9)),
}


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ablation")
    tables = {"fixations": FIXATIONS, "touches": TOUCHES, "features": FEATURES}
    found = {name: [] for name in ("meshes", *tables)}
    for key, mesh in SOLIDS.items():
        vertices = np.asarray(mesh.vertices, np.float32).astype(np.float64)
        surface = Surface(
            vertices, mesh.faces.astype(np.int64), (7 * mesh.faces % 255).astype(np.uint8)
        )
        path = folder / f"{key}.ply"
        write_surface(surface, path)
        found["meshes"].append(path)
        explored = TouchableObject(key, surface, 0.0).touch(parameters=PARAMETERS)
        for name, schema in tables.items():
            part = folder / name / f"{key}.parquet"
            write_table(schema, getattr(explored, name), part)
            found[name].append(part)
    return Sources(**found)


def remade(name, sources):
    return remake_features(ABLATIONS[name], sources, PARAMETERS)


def own(sources):
    return read_table(FEATURES, sources.features)


def in_order(table):
    return table.sort_by([(key, "ascending") for key in FEATURES.keys]).combine_chunks()


def test_every_part_of_the_method_has_an_ablation():
    assert next(iter(ABLATIONS)) == WHOLE.name
    assert {f"without_{channel}" for channel in CHANNELS} < set(ABLATIONS)
    assert {"ideal", "fsr400", "worn_fsr", "fixed_sensor_size", "without_map"} < set(ABLATIONS)


@pytest.mark.slow
def test_what_changes_recognition_alone_takes_the_runs_features(sources):
    only_features = Sources(features=sources.features)
    for name in (
        "whole_method",
        "cutaneous_only",
        "kinesthetic_only",
        "contourlet_only",
        "without_map",
    ):
        assert remade(name, only_features).equals(own(sources))


def test_descriptors_are_those_of_the_runs_imprints(sources):
    files = Sources(touches=sources.touches, features=sources.features)
    imprints = images(read_table(TOUCHES, sources.touches))
    for name, described in (
        ("wavelet", wavelet_deviations(imprints)),
        ("nonsubsampled_contourlet", nonsubsampled_deviations(imprints)),
        ("image_statistics", describe_imprint_shape(imprints)),
    ):
        table = remade(name, files)
        columns = [column for column in table.column_names if column.startswith("contourlet_")]
        np.testing.assert_allclose(matrix(table, columns), described, atol=1e-12)
        assert table.column("x").equals(own(sources).column("x"))


def test_wavelet_descriptors_are_deviations_of_detail_bands():
    imprints = np.random.default_rng(0).random((2, 32, 32), dtype=np.float32)
    horizontal = pywt.wavedec2(imprints[1].astype(float), "db2", "periodization", 3)[3][0]
    assert wavelet_deviations(imprints)[1, 6] == pytest.approx(horizontal.std(ddof=1))


def test_nonsubsampled_descriptors_do_not_change_where_the_imprint_is_shifted():
    imprint = np.random.default_rng(1).random((1, 32, 32), dtype=np.float32)
    shifted = np.roll(imprint, (3, 5), axis=(1, 2))
    found = nonsubsampled_deviations(np.concatenate([imprint, shifted]))
    assert found.shape == (2, 16)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-6)


def test_touching_again_in_the_runs_own_scene_gives_the_runs_features(sources):
    files = Sources(meshes=sources.meshes, fixations=sources.fixations)
    assert in_order(remade("ideal", files)).equals(own(sources))


def test_the_sensor_of_fixed_size_keeps_it(sources):
    files = Sources(meshes=sources.meshes, fixations=sources.fixations)
    sizes = remade("fixed_sensor_size", files).column("sensor_size").to_numpy()
    assert set(sizes) == {PARAMETERS.sensor.largest_size}
    # The run's own sensor shrinks somewhere; else the test would say nothing.
    noisy = remade("fsr400", files)
    assert not np.allclose(
        matrix(noisy, CONTOURLET_FEATURES), matrix(own(sources), CONTOURLET_FEATURES)
    )


def test_a_preset_replaces_the_whole_scene_and_the_fixed_size_one_effect():
    scene = Scene(noise=0.01)
    assert changed_scene("fsr400", scene) == Scene.model_validate({"preset": "fsr400"})
    fixed = changed_scene("fixed_sensor_size", scene)
    assert fixed.effects.adaptive_size == "never"
    assert fixed.model_copy(update={"effects": scene.effects}) == scene


def test_leaving_out_a_channel_that_never_ran_changes_nothing(sources):
    # The boxes and balls here are lit alike all over except where colour differs.
    weights = PARAMETERS.attention.weights.model_copy(update={"colour": 0.0})
    attention = PARAMETERS.attention.model_copy(update={"weights": weights})
    blind = PARAMETERS.model_copy(update={"attention": attention})
    key = "box/cube"
    mesh = next(path for path in sources.meshes if str(path).endswith(f"{key}.ply"))
    from visuohaptic.geometry.surface import read_surface

    expected = TouchableObject(key, read_surface(mesh), 0.0).touch(parameters=blind).features
    found = remade("without_colour", Sources(meshes=[mesh]))
    assert in_order(found).equals(in_order(expected))


def test_a_row_is_the_accuracy_of_each_object(sources, tmp_path):
    for name in ("kinesthetic_only", "without_map"):
        make_ablation(name, Sources(features=sources.features), tmp_path / name, PARAMETERS)
        table = read_table(ABLATION, tmp_path / name)
        pipelines = table.column("pipeline").to_pylist()
        assert set(pipelines) == set(ABLATIONS[name].pipelines)
        assert table.num_rows == 4 * len(set(pipelines))


SMALL = RecognitionParameters.model_validate(
    {"protocol": {"maximum_splits": 6}, "best": {"waves": 20}}
)


def named(name, table, pipeline):
    return name_objects(ABLATIONS[name], table, SMALL, 1, pipeline, 0.0)


@pytest.mark.parametrize("pipeline", ["paper", "best"])
def test_the_whole_method_is_the_run_of_the_pipeline(pipeline):
    table = features_table(viewpoints=2, separation=2.0)
    found = named("whole_method", table, pipeline)
    best = SMALL.best.model_copy(update={"classifiers": ("support_vector_machine",)})
    alone = SMALL.model_copy(update={"classifiers": ("support_vector_machine",), "best": best})
    scores, predictions = recognition.run_pipeline(table, alone, 1, pipeline)
    expected = recognition.summarise(scores, predictions, seed=1)["results"][pipeline]["fixation"]
    accuracy, weights = matrix(found, ["accuracy", "weight"]).T
    mean = expected["support_vector_machine"]["accuracy"]["mean"]
    assert np.average(accuracy, weights=weights) == pytest.approx(mean)


@pytest.mark.parametrize("pipeline", ["paper", "best"])
@pytest.mark.parametrize(
    ("name", "prefixes"),
    [
        ("cutaneous_only", ("x", "y", "z", "normal_")),
        ("kinesthetic_only", ("contourlet_", "imprint_")),
    ],
)
def test_cues_that_are_left_out_have_no_say(name, prefixes, pipeline):
    table = features_table(viewpoints=2, separation=0.5)
    generator = np.random.default_rng(0)
    changed = table
    for place, field in enumerate(table.schema):
        if field.name.startswith(prefixes):
            values = np.abs(np.tanh(generator.normal(size=table.num_rows)))
            changed = changed.set_column(place, field, pa.array(values))
    first, second = (named(name, one, pipeline) for one in (table, changed))
    assert first.column("accuracy").equals(second.column("accuracy"))
    whole = [named("whole_method", one, pipeline).column("accuracy") for one in (table, changed)]
    assert not whole[0].equals(whole[1])


def test_only_touches_by_fixation_count():
    both = pa.concat_tables([features_table(), features_table("random")])
    assert select(both, strategy="random").num_rows
    assert set(_fixated(both).column("strategy").to_pylist()) == {"fixation"}
