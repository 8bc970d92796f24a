"""A user's own study is one file and one command, and only what is unfinished runs again."""

import json
import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import yaml

ROOT = Path(__file__).parents[2]

pytestmark = [pytest.mark.workflow, pytest.mark.long]

MINE = {
    "title": "Does <b>it</b> matter?",
    "conditions": {
        "palm 0.2": {"sensor.largest_size": 0.2},
        "palm 0.2, penalty 2": {
            "sensor.largest_size": 0.2,
            "recognition.classifier.svm_penalty": 2.0,
        },
        "too small": {"sensor.resolution": 4},
        "penalty 2": {"recognition.classifier.svm_penalty": 2.0},
    },
}
# An empty frontier, for which nothing is measured, but which is written.
FRONTIER = {"frontier_seconds": 1, "frontier": 1}
RECOGNISED = {"recognition": 1}
AFTER = {"metrics": 1, "report": 1}
TITLE = "Does &lt;b&gt;it&lt;/b&gt; matter?"
FIGURES = "results/studies/mine.parquet"


def write(experiment, values):
    text = yaml.safe_dump(values, sort_keys=False)
    (experiment.folder / "studies").mkdir(exist_ok=True)
    (experiment.folder / "studies/mine.yaml").write_text(text)


def planned(experiment, target="study_mine"):
    return experiment.planned("--", target)


@pytest.fixture(scope="module")
def studied(finished, open_folder, tmp_path_factory):
    folder = finished.copy(tmp_path_factory.mktemp("studied") / "experiment").folder
    experiment = open_folder(folder, has_stand_ins=False)
    experiment.set(workflow={"conditions_per_job": 2}, cost={"frontier_touches": []})
    write(experiment, MINE)
    experiment.snakemake("--", "study_mine")
    return experiment


def rows_of(experiment):
    rows = pq.read_table(experiment.folder / FIGURES).to_pylist()
    return {(row["condition"], row["strategy"]): row for row in rows}


def test_every_condition_has_a_row_a_strategy_and_the_broken_one_its_reason(studied):
    rows = rows_of(studied)
    assert {name for name, _ in rows} == {"as run", *MINE["conditions"]}
    assert {name for (name, _), row in rows.items() if row["error"]} == {"too small"}
    assert rows["palm 0.2", "random"]["recomputed"] == "touches"
    assert rows["penalty 2", "fixation"]["recomputed"] == "recognition"
    assert rows["penalty 2", "fixation"]["compared_with"] == "as run"
    made = list((studied.folder / "results/study_features/mine").glob("*.parquet"))
    assert len(made) == 2


def test_the_run_itself_has_the_accuracy_of_its_metrics(studied):
    metrics = json.loads((studied.folder / "reports/metrics.json").read_text())
    for strategy in ("fixation", "random"):
        figures = metrics["results"]["paper"][strategy]["support_vector_machine"]["accuracy"]
        found = rows_of(studied)["as run", strategy]["accuracy"]
        assert found == pytest.approx(figures["mean"], abs=1e-5)


def test_the_report_shows_it_after_the_same_call_and_nothing_is_left_to_do(studied):
    page = (studied.folder / "reports/report.html").read_text()
    assert TITLE in page
    assert studied.planned("--", "study_mine", "all") == {}


def test_what_was_lost_added_or_changed_is_measured_again_and_nothing_else(studied, tmp_path):
    experiment = studied.copy(tmp_path / "experiment")
    blocks = sorted((experiment.folder / "results/study_blocks/mine").glob("*.parquet"))
    assert len(blocks) == 3
    lost = blocks[1].read_bytes()
    blocks[1].unlink()
    # It comes out the same, so the figures and the page that shows the study are current.
    assert planned(experiment) == {"block_of_study": 1}
    blocks[1].write_bytes(lost)
    more = {**MINE["conditions"], "palm 0.4": {"sensor.largest_size": 0.4}}
    write(experiment, {**MINE, "conditions": more})
    assert planned(experiment)["features_of_study"] == 1
    write(experiment, MINE)
    experiment.set(recognition={"intervals": {"confidence": 0.9}})
    assert planned(experiment) == {**AFTER, "figures_of_study": 1, "frontier": 1}
    experiment.set(recognition={"classifier": {"svm_penalty": 3.0}})
    # Three blocks of the study, and the block of random places in sight.
    follows = {**RECOGNISED, "figures_of_study": 1, "block_of_study": 4}
    assert planned(experiment) == {**FRONTIER, **AFTER, **follows}


def test_every_run_has_further_draws_and_touches_them_once(experiment):
    experiment.set(probing={"random_draws": 3}, cost={"frontier_touches": []})
    measured = {"features_of_study": 1, "block_of_study": 1}
    assert experiment.planned() == {**FRONTIER, **AFTER, **measured}
    said = experiment.snakemake()
    assert "; 3 draws of the places)" in said.stdout
    assert "Salience, fixations minus random places in sight" in said.stdout
    metrics = json.loads((experiment.folder / "reports/metrics.json").read_text())
    draws = metrics["comparisons"]["paper"]["support_vector_machine"]["random"]["draws"]
    assert (draws["count"], len(draws["leads"])) == (3, 3)
    assert "means over 3 draws" in (experiment.folder / "reports/report.html").read_text()
    assert experiment.planned() == {}
    experiment.set(recognition={"classifier": {"svm_penalty": 3.0}})
    assert experiment.planned() == {**FRONTIER, **AFTER, **RECOGNISED, "block_of_study": 1}
    experiment.set(probing={"random_draws": 1}, recognition={"classifier": {"svm_penalty": 1.0}})
    # The store has the features and the block of the finished run; a dry run lists the block, whose file is missing.
    assert experiment.planned() == {**AFTER, "block_of_study": 1}


def test_dvc_keeps_a_study_once_it_is_asked_to(repository, tmp_path):
    experiment = repository.copy(tmp_path / "experiment")
    shutil.copytree(ROOT / "studies", experiment.folder / "studies", dirs_exist_ok=True)
    write(experiment, {**MINE, "conditions": {"penalty 2": MINE["conditions"]["penalty 2"]}})
    experiment.snakemake("--", "study_mine")
    # The run shows the study in its report, and locks both.
    assert "up to date" in experiment.run("dvc", "status").stdout
    pipeline = experiment.folder / "studies/dvc.yaml"
    pipeline.write_text(pipeline.read_text().replace("own: []", "own: [mine]"))
    assert "own@mine" in experiment.run("dvc", "status").stdout
    experiment.run("dvc", "repro", "studies/dvc.yaml")
    # The same was made again, so the report that shows it is current.
    assert planned(experiment) == {}
    # The study's own lock lies in folder studies, on which the stage of the run depends.
    assert "Nothing to be done" in experiment.run("dvc", "repro").stdout
    assert "up to date" in experiment.run("dvc", "status").stdout
    experiment.set(recognition={"classifier": {"svm_penalty": 3.0}})
    assert "own@mine" in experiment.run("dvc", "status").stdout


def test_a_study_of_python_with_a_step_of_its_own_is_one_file(experiment):
    shutil.copy(ROOT / "examples/studies/first_touches.py", experiment.folder / "studies")
    experiment.snakemake("--", "first_touches_all")
    path = experiment.folder / "studies/first_touches.py"
    page = (experiment.folder / "reports/report.html").read_text()
    assert "How much does each further touch tell?" in page
    found = json.loads((experiment.folder / "reports/first_touches.json").read_text())
    assert {len(accuracies) for accuracies in found.values()} == {3}
    assert planned(experiment, "first_touches_all") == {}
    # The file is the code of its step; of its conditions, what they change counts.
    path.write_text(path.read_text().replace("cell.accuracy.mean()", "cell.accuracy.min()"))
    assert planned(experiment, "first_touches_all") == {"first_touches": 1, "report": 1}
