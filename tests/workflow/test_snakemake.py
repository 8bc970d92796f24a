"""A whole run of the real scripts, and what objects of the user change in it."""

import html
import re

import pandas as pd
import pyarrow.compute as pc
import pytest
import trimesh
from small_experiment import SMALL_OBJECTS

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.geometry.surface import object_of
from visuohaptic.recognition.stored_models import load_model
from visuohaptic.report.run import find_run
from visuohaptic.scene.parameters import VISUAL_EFFECTS, EffectModes
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

pytestmark = pytest.mark.workflow

# A tolerance of the code, for which no error at all is allowed in a test.
FRAMES = '32 * U64, "1",'
TOUCHES = 4 * 2 * 2 * 5  # objects, viewpoints, strategies, touches in a sequence


def test_pandas_reads_each_table_whole(finished):
    for name in ("fixations", "touches", "features"):
        frame = pd.read_parquet(finished.folder / "results" / name)
        # Views also list places to touch where others are out of reach.
        assert len(frame) > TOUCHES if name == "fixations" else len(frame) == TOUCHES
        keys = ["class", "object", "viewpoint", "strategy", "touch"]
        assert list(frame.columns[:5]) == keys
        assert not frame.duplicated(keys).any()
    scores = pd.read_parquet(finished.folder / "results" / "scores")
    # Strategies, classifiers, splits of two objects in two classes. kNN asks five neighbours, and four sequences train.
    assert len(scores) == 2 * 4 * 4
    assert "k_nearest_neighbours" not in set(scores["classifier"])


def test_a_finished_run_is_found_with_the_mesh_of_each_object(finished):
    files, _, objects = find_run(finished.folder)
    assert sorted(object_of(mesh).partition("/")[2] for mesh in files.meshes) == sorted(
        SMALL_OBJECTS
    )
    assert len(objects) == len(SMALL_OBJECTS)


def test_the_books_of_the_effects_read_as_one_table(finished):
    frame = pd.read_parquet(finished.folder / "results" / "effects")
    assert not frame.duplicated(["class", "object", "first_viewpoint", "effect"]).any()
    counted = {name: 8 if name in VISUAL_EFFECTS else TOUCHES for name in EffectModes.model_fields}
    assert frame.groupby("effect").touches.sum().to_dict() == counted


def test_every_run_checks_its_objects_and_quotes_the_hard_cases_of_the_code(finished):
    own = read_table(STABILITY, finished.folder / "results/stability")
    assert set(own["object"].to_pylist()) == set(SMALL_OBJECTS)
    assert pc.all(pc.less_equal(own["worst_error"], own["tolerance"])).as_py()
    page = (finished.folder / "reports/report.html").read_text()
    for said in ("Objects of this run: ", "The code itself was tried on "):
        assert said in page


@pytest.mark.long
def test_own_objects_and_touches_by_a_policy_reach_models_checks_and_the_report(experiment):
    """A broken mesh of the user and an exceeded tolerance are named, and fail no job."""
    models = ("results/models/recogniser.skops", "results/models/recogniser_seek_relief.skops")
    strategies = ("fixation", "seek_relief")
    experiment.set(
        probing={"strategies": [*strategies]}, recognition={"order_free": {"cues": ["pose"]}}
    )
    of_all = "results/models/all_strategies.skops"
    # The report is of other parameters then, so its path is not printed.
    assert "The report is at" not in experiment.snakemake("--", *models, of_all).stdout
    assert load_model(experiment.folder / of_all).strategies == strategies
    own = experiment.folder / "meshes/own/chair"
    own.mkdir()
    trimesh.creation.box((1, 2, 1)).export(own / "stool.stl")
    (own / "broken.obj").write_text("v 0 0 0\nv 1 0 nonsense\nf 1 2 3\n")
    reason = "chair/broken was left out: meshes/own/chair/broken.obj can't be read as OBJ"
    tolerances = experiment.folder / "src/visuohaptic/stability/tolerances.py"
    assert tolerances.read_text().count(FRAMES) == 1
    tolerances.write_text(tolerances.read_text().replace(FRAMES, '0.0, "1",'))
    output = experiment.snakemake().stdout
    assert reason in output
    assert "Pipeline paper, " in output
    assert "The report is at reports/report.html." in output
    assert re.search(r"warning: \S+: frames of touches: the worst", output)
    assert experiment.planned() == {}
    results = experiment.folder / "results"
    tries = pd.read_parquet(results / "policy_fixations")
    assert set(tries["strategy"]) == {"seek_relief"}
    assert len(tries) >= TOUCHES // 2
    for table in ("touches", "features", "scores"):
        assert set(pd.read_parquet(results / table)["strategy"]) == {*strategies}
    objects = set(pd.read_parquet(results / "touches")["object"])
    assert "stool" in objects
    assert "broken" not in objects
    timed = pd.read_parquet(results / "frontier.parquet")
    assert set(timed["strategy"]) == {*strategies}
    page = (experiment.folder / "reports/report.html").read_text()
    assert "stool" in page
    assert STRATEGIES["seek_relief"].label in page
    assert html.escape(reason, quote=True).replace("&#x27;", "&#39;") in page
    assert ": frames of touches</a>: the worst error is" in page
    experiment.run("visuohaptic", "evaluate", *models)
    rows = pd.read_parquet(experiment.folder / "reports/evaluation.parquet")
    assert set(rows["object"]) == {"stool"}
    assert set(rows["strategy"]) == {*strategies}
    assert set(rows["learnt"]) == {4}
