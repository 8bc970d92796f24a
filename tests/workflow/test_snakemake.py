"""Snakemake runs what changed and what follows from it, and nothing else."""

import html
import json
import os

import pandas as pd
import pyarrow.parquet as pq
import pytest
import trimesh
from golden import golden_tables

from visuohaptic.scene.parameters import VISUAL_EFFECTS, EffectModes

pytestmark = pytest.mark.workflow

TABLES = ("views", "fixations", "touches", "features", "scores", "predictions")
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
    assert len(scores) == 2 * 5 * 4  # strategies, classifiers, splits of two objects in two classes


def test_nothing_is_left_to_do_after_a_run(finished):
    assert finished.planned() == {}


def test_a_touched_file_reruns_nothing(experiment):
    for name in (
        "params.yaml",
        "meshes/paper/chair/bsby_chair3.ply.gz",
        "src/visuohaptic/features/describing.py",
    ):
        os.utime(experiment.folder / name)
    assert experiment.planned() == {}


def test_a_parameter_of_recognition_reruns_no_touch(experiment):
    experiment.set(recognition={"classifier": {"neighbours": 3}})
    assert experiment.planned() == {
        "recognition": 2, "metrics": 1, "block_of_study": 1, "frontier_seconds": 1, "frontier": 1, "report": 1, "guards": 1, "guards_hold": 1,
    }  # fmt: skip


def test_a_parameter_of_the_sensor_reruns_no_fixation(experiment):
    experiment.set(sensor={"largest_size": 0.25})
    planned = experiment.planned()
    assert planned["touches"] == planned["features"] == 4
    assert "fixations" not in planned
    assert "meshes" not in planned


def test_a_scene_to_feel_reruns_no_fixation(experiment):
    experiment.set(scene={"preset": "fsr400", "effects": {"noise": "never"}})
    planned = experiment.planned()
    assert planned["touches"] == 4
    assert "fixations" not in planned


def test_a_scene_to_see_reruns_the_eye(experiment):
    experiment.set(scene={"effects": {"shading": "never"}})
    assert experiment.planned()["fixations"] == 4


def test_the_books_of_the_effects_read_as_one_table(finished):
    frame = pd.read_parquet(finished.folder / "results" / "effects")
    assert not frame.duplicated(["class", "object", "first_viewpoint", "effect"]).any()
    assert frame.groupby("effect").touches.sum().to_dict() == {
        effect: 4 * 2 if effect in VISUAL_EFFECTS else TOUCHES
        for effect in EffectModes.model_fields
    }


@pytest.mark.long
def test_accuracy_by_effect_is_measured_on_request_and_then_kept(experiment):
    experiment.snakemake("effects_all")
    assert experiment.planned() == {}
    experiment.set(sensor={"largest_size": 0.25})
    planned = experiment.planned()
    assert planned["effect_influence"] == 1
    assert planned["features_of_study"] == 22
    assert planned["block_of_study"] == 1 + 1


def test_a_changed_mesh_reruns_its_object_and_what_follows(experiment):
    meshes = experiment.folder / "meshes" / "paper"
    other = (meshes / "chair" / "bs0_chair2.ply.gz").read_bytes()
    (meshes / "chair" / "bsby_chair3.ply.gz").write_bytes(other)
    planned = experiment.planned()
    assert {name: planned[name] for name in ("meshes", "fixations", "touches", "features")} == {
        "meshes": 1, "fixations": 1, "touches": 1, "features": 1,
    }  # fmt: skip
    assert planned["recognition"] == 2


@pytest.mark.parametrize(
    ("module", "first"),
    [
        ("src/visuohaptic/meshes/preparing.py", "meshes"),
        ("src/visuohaptic/attention/saliency.py", "fixations"),
        ("src/visuohaptic/sensor/placing.py", "touches"),
        ("packages/contourlets/src/contourlets/directional.py", "features"),
        ("src/visuohaptic/recognition/classifiers.py", "recognition"),
        ("src/visuohaptic/recognition/metrics.py", "metrics"),
    ],
)
def test_an_edited_module_reruns_the_phases_that_use_it(experiment, module, first):
    with (experiment.folder / module).open("a") as stream:
        stream.write("\n# edited\n")
    phases = ["meshes", "fixations", "touches", "features", "recognition", "metrics", "report"]
    planned = experiment.planned()
    assert first in planned
    assert not set(planned) & set(phases[: phases.index(first)])
    assert "report" in planned


def assert_same_results(experiment, other):
    for name in TABLES:
        assert other.table(name).equals(experiment.table(name)), name
    metrics = "reports/metrics.json"
    assert (other.folder / metrics).read_bytes() == (experiment.folder / metrics).read_bytes()


@pytest.mark.long
def test_one_process_and_two_give_the_same_tables(fresh, finished, tmp_path):
    other = fresh.copy(tmp_path / "experiment")
    other.run("snakemake", "-j1")
    assert_same_results(finished, other)


@pytest.mark.long
def test_other_blocks_of_viewpoints_change_no_table_and_leave_no_stale_part(finished, experiment):
    experiment.set(workflow={"views_per_job": 1})
    planned = experiment.planned()
    assert planned["fixations"] == planned["touches"] == planned["features"] == 4 * 2
    experiment.snakemake()
    assert_same_results(finished, experiment)
    assert experiment.planned() == {}


@pytest.mark.long
def test_blocks_of_objects_change_no_number(fresh, finished, tmp_path):
    other = fresh.copy(tmp_path / "experiment")
    other.set(workflow={"objects_per_job": 4})
    planned = other.planned()
    assert planned["meshes"] == planned["features"] == planned["stability_of_object"] == 2
    other.snakemake()
    assert golden_tables.main("compare", str(other.folder), str(finished.folder)) == 0
    assert other.planned() == {}


@pytest.mark.long
def test_an_own_object_takes_part_and_leaves_without_trace(experiment):
    own = experiment.folder / "meshes" / "own" / "chair"
    own.mkdir()
    trimesh.creation.box((1, 2, 1)).export(own / "stool.stl")
    experiment.snakemake()
    objects = set(pd.read_parquet(experiment.folder / "results" / "touches")["object"])
    assert "stool" in objects
    assert "stool" in (experiment.folder / "reports" / "report.html").read_text()
    (own / "stool.stl").unlink()
    experiment.snakemake()
    objects = set(pd.read_parquet(experiment.folder / "results" / "touches")["object"])
    assert "stool" not in objects


@pytest.mark.long
def test_a_model_of_each_strategy_names_an_object_that_came_later(experiment):
    models = ("results/models/best.skops", "results/models/best_random.skops")
    experiment.snakemake("--", *models)
    own = experiment.folder / "meshes" / "own" / "chair"
    own.mkdir()
    trimesh.creation.box((1, 2, 1)).export(own / "stool.stl")
    experiment.snakemake("--", "features_all")
    experiment.run("visuohaptic", "evaluate", *models)
    rows = pd.read_parquet(experiment.folder / "reports" / "evaluation.parquet")
    assert set(rows["object"]) == {"stool"}
    assert set(rows["strategy"]) == {"fixation", "random"}
    assert set(rows["learnt"]) == {4}


@pytest.mark.long
def test_a_corrupt_mesh_is_named_and_spares_the_others(fresh, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    broken = experiment.folder / "meshes" / "own" / "x" / "broken.obj"
    broken.parent.mkdir()
    broken.write_text("v 0 0 0\nv 1 0 nonsense\nf 1 2 3\n")
    reason = "x/broken was left out: meshes/own/x/broken.obj can't be read as OBJ"
    assert reason in experiment.snakemake().stdout
    for name in ("touches", "features"):
        assert len(pd.read_parquet(experiment.folder / "results" / name)) == TOUCHES
    page = experiment.folder / "reports/report.html"
    assert html.escape(reason, quote=True).replace("&#x27;", "&#39;") in page.read_text()
    broken.unlink()
    experiment.snakemake()
    assert "x/broken" not in page.read_text()
    assert experiment.planned() == {}


def test_a_wrong_parameter_is_one_sentence(experiment):
    experiment.set(sensor={"largest_size": -1, "shape": "round"})
    result = experiment.snakemake("-n", check=False)
    assert result.returncode != 0
    assert "sensor.largest_size is -1: input should be greater than 0" in result.stdout
    assert "sensor.shape is no parameter" in result.stdout
    assert "Traceback" not in result.stdout


@pytest.mark.long
def test_a_job_that_was_killed_leaves_no_part_that_counts(experiment):
    part = experiment.folder / "results/touches/chair/bsby_chair3/00-01.parquet"
    part.unlink()
    (part.parent / ".00-01.parquet-tmp").write_bytes(b"half")
    experiment.snakemake()
    assert pq.read_table(part).num_rows == 20
    assert len(pd.read_parquet(experiment.folder / "results" / "touches")) == TOUCHES


def test_metrics_hold_every_classifier_with_its_interval(finished):
    metrics = json.loads((finished.folder / "reports/metrics.json").read_text())
    for strategy in ("fixation", "random"):
        figures = metrics["results"]["paper"][strategy]
        assert len(figures) == 5
        for classifier in figures.values():
            accuracy = classifier["accuracy"]
            assert 0 <= accuracy["low"] <= accuracy["mean"] <= accuracy["high"] <= 1


@pytest.mark.long
def test_a_run_ends_with_the_figures_where_the_report_was_written(experiment):
    experiment.set(recognition={"intervals": {"confidence": 0.9}})
    output = experiment.snakemake().stdout
    assert "Pipeline paper, " in output
    assert "The report is at reports/report.html." in output
    # A page of an earlier state is not this run's.
    experiment.set(recognition={"best": {"cues": ["pose"]}})
    assert "The report is at" not in experiment.snakemake("--", "model_all").stdout
