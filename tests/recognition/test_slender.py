"""A pen, a wire and a needle take part: a view that shows too little of one stops nothing."""

import pyarrow as pa
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import MeshError, RecognitionError
from visuohaptic.evaluation.summary import select, summarise
from visuohaptic.recognition import files
from visuohaptic.recognition.model import fit_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES, PREDICTIONS, SCORES
from visuohaptic.tables.schema import read_table, write_table

pytestmark = pytest.mark.slow
QUICK = RecognitionParameters.model_validate(
    {
        "classifiers": ["naive_bayes", "k_nearest_neighbours"],
        "order_free": {"classifiers": ["naive_bayes"], "waves": 20},
    }
)


SHAPES = {
    "slender/pen": trimesh.creation.cylinder(0.03, 2),
    "slender/wire": trimesh.creation.cylinder(0.004, 2),
    "slender/needle": trimesh.creation.cone(0.002, 2),
    "round/ball": trimesh.creation.icosphere(3),
    "round/egg": trimesh.creation.icosphere(3).apply_scale([1, 1.4, 1]),
}


@pytest.fixture(scope="module")
def table():
    parts = [
        vh.load(mesh, key=key).touch(viewpoints=8, strategy=strategy).features
        for key, mesh in SHAPES.items()
        for strategy in ("fixation", "random")
    ]
    return pa.concat_tables(parts)


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_recognition_goes_on_without_those_views(table, tmp_path, caplog, pipeline):
    write_table(FEATURES, table, tmp_path / "features.parquet")
    made = {
        name: {one: tmp_path / f"{name}/{one}.parquet" for one in ("fixation", "random")}
        for name in ("scores", "predictions")
    }
    files.make_scores(
        [tmp_path / "features.parquet"], **made, pipeline=pipeline, parameters=QUICK, seed=1
    )
    scores, predictions = (
        read_table(schema, tmp_path / schema.name) for schema in (SCORES, PREDICTIONS)
    )
    tested = set(predictions.column("object").to_pylist())
    assert {"pen", "wire", "ball", "egg"} <= tested
    assert "slender/wire is left out of recognition by fixation from viewpoints" in caplog.text
    assert summarise(scores, predictions)["comparisons"][pipeline]["naive_bayes"]


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_a_model_names_by_the_views_that_show_enough(pipeline, table):
    of_needle = select(table, object="needle", strategy="fixation")
    model = fit_model(select(table, strategy="fixation"), pipeline, "naive_bayes", QUICK, 1)
    assert sum(model.recognise(of_needle).values()) == pytest.approx(1)
    four = of_needle.filter(pa.compute.less(of_needle["touch"], 4))
    if pipeline == "order_free":
        assert sum(model.recognise(four).values()) == pytest.approx(1)
        return
    with pytest.raises(RecognitionError, match="No viewpoint has 5 touches"):
        model.recognise(four)


def test_what_no_view_shows_is_one_sentence():
    hair = vh.load(trimesh.creation.cylinder(1e-5, 2))
    with pytest.raises(MeshError, match=r"No viewpoint sees a location .* strategy random"):
        hair.touch(viewpoints=2)
    assert hair.touch(viewpoints=2, strategy="random").touches.num_rows == 10
