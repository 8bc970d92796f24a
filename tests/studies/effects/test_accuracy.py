"""Accuracy is told for whole scenes and without one effect at a time, all else unchanged."""

import numpy as np
import trimesh

from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface, write_surface
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.studies.effects.accuracy import effect_accuracy, make_effect_accuracy
from visuohaptic.tables.phases import FIXATIONS
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import EFFECT_ACCURACY

SENSOR = SensorParameters()
RECOGNITION = RecognitionParameters.model_validate({"intervals": {"bootstrap_samples": 100}})
VIEWPOINTS, TOUCHES = 3, 5


def surface_of(mesh):
    faces = np.asarray(mesh.faces, dtype=np.int64)
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    return Surface(vertices, faces, np.full((len(faces), 3), 120, dtype=np.uint8))


SURFACES = {
    ("ball", "large"): surface_of(trimesh.creation.icosphere(3, radius=0.9)),
    ("ball", "small"): surface_of(trimesh.creation.icosphere(3, radius=0.7)),
    ("box", "cube"): surface_of(trimesh.creation.box((1.0, 1.0, 1.0))),
    ("box", "brick"): surface_of(trimesh.creation.box((1.2, 0.7, 0.9))),
}


def fixations_of(key, surface):
    count = VIEWPOINTS * TOUCHES
    generator = np.random.default_rng(len(surface.faces))
    faces = generator.integers(len(surface.faces), size=count)
    weights = generator.dirichlet(np.ones(3), size=count)
    points = np.einsum("nk,nkd->nd", weights, surface.triangles[faces])
    columns = dict(zip("xyz", points.T, strict=True))
    normals = surface.face_normals[faces]
    columns |= dict(zip(("normal_x", "normal_y", "normal_z"), normals.T, strict=True))
    nothing = [None] * count
    columns |= {"class": key[0], "object": key[1], "strategy": "random", "face": faces}
    columns |= {"viewpoint": np.repeat(np.arange(VIEWPOINTS), TOUCHES)}
    columns |= {"touch": np.tile(np.arange(TOUCHES), VIEWPOINTS)}
    columns |= {"pixel_row": nothing, "pixel_column": nothing, "saliency": nothing}
    return build_table(FIXATIONS, columns)


def accuracies(scenes):
    objects = [
        (RayCaster(surface), fixations_of(key, surface)) for key, surface in SURFACES.items()
    ]
    table = effect_accuracy(objects, scenes, SENSOR, FeatureParameters(), RECOGNITION, 7)
    return table.to_pylist()


def test_every_effect_that_ran_is_left_out_once():
    scene = Scene(noise=0.5, bits=2)
    rows = accuracies({"ideal": scene})
    assert [row["without"] for row in rows[:1]] == ["nothing"]
    assert {"noise", "quantisation"} <= {row["without"] for row in rows}
    assert "drift" not in {row["without"] for row in rows}
    assert all(row["low"] <= row["accuracy"] <= row["high"] for row in rows)


def test_leaving_out_the_only_effect_gives_the_scene_without_it():
    rows = accuracies({"noisy": Scene(noise=0.5), "plain": Scene()})
    found = {(row["scene"], row["without"]): row for row in rows}
    for figure in ("accuracy", "low", "high"):
        assert found["noisy", "noise"][figure] == found["plain", "nothing"][figure]


def test_a_table_is_made_of_files_in_any_order(tmp_path, monkeypatch):
    monkeypatch.setattr("visuohaptic.studies.effects.accuracy.PRESETS", ["ideal"])
    meshes, parts = [], []
    for key, surface in SURFACES.items():
        meshes.append(tmp_path / key[0] / f"{key[1]}.ply")
        write_surface(surface, meshes[-1])
        parts.append(tmp_path / f"{key[1]}.parquet")
        write_table(FIXATIONS, fixations_of(key, surface), parts[-1])
    output = tmp_path / "effect_accuracy.parquet"
    make_effect_accuracy(meshes, parts[::-1], output, SENSOR, FeatureParameters(), RECOGNITION, 7)
    rows = read_table(EFFECT_ACCURACY, output).to_pylist()
    assert {row["scene"] for row in rows} == {"ideal"}
    assert {row["classifier"] for row in rows} == {"support_vector_machine"}
