"""Long sequences by every strategy begin as the run's own."""

import pytest
import trimesh

from visuohaptic.exploration.exploring import TouchableObject
from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.geometry.surface import Surface, write_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.summary import select
from visuohaptic.studies.curves.features import CANDIDATES, make_curve_features
from visuohaptic.studies.curves.settings import LONGEST_SEQUENCE
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

PARAMETERS = ExperimentParameters.from_mapping(
    {"viewpoints": {"count": 2}, "rendering": {"resolution": 48}, "seed": 5}
)
KEY = "ball/capsule"


@pytest.fixture(scope="module")
def surface():
    mesh = trimesh.creation.capsule(height=0.8, radius=0.4, count=[12, 12])
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    vertices = mesh.vertices.astype("float32").astype("float64")
    faces = mesh.faces.astype("int64")
    return Surface(vertices, faces, (mesh.faces % 255).astype("uint8"))


@pytest.fixture(scope="module")
def features(surface, tmp_path_factory):
    folder = tmp_path_factory.mktemp("curves")
    write_surface(surface, folder / "mesh.ply")
    sections = ("viewpoints", "rendering", "attention", "sensor", "scene", "features", "seed")
    make_curve_features(
        KEY,
        folder / "mesh.ply",
        folder / "features.parquet",
        **{name: getattr(PARAMETERS, name) for name in sections},
    )
    return read_table(FEATURES, folder / "features.parquet")


@pytest.mark.parametrize("strategy", STRATEGIES.names)
def test_every_viewpoint_has_a_long_sequence(features, strategy):
    found = select(features, strategy=strategy)
    assert found.num_rows == 2 * LONGEST_SEQUENCE
    assert select(found, viewpoint=1).column("touch").to_pylist() == list(range(LONGEST_SEQUENCE))


@pytest.mark.parametrize("strategy", STRATEGIES.names)
def test_long_sequences_begin_as_those_of_the_run(features, surface, strategy):
    run = TouchableObject(KEY, surface, 0.0).touch(strategy=strategy, parameters=PARAMETERS)
    for viewpoint in (0, 1):
        own = select(run.features, viewpoint=viewpoint)
        long = select(features, strategy=strategy, viewpoint=viewpoint).slice(0, own.num_rows)
        assert long.equals(own)


def test_candidates_are_some_of_the_objects_places(features):
    for viewpoint in (0, 1):
        count = select(features, strategy="adaptive", viewpoint=viewpoint).num_rows
        assert CANDIDATES // 8 < count < CANDIDATES
