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
# What a change of recognition makes again for the report's frontier.
FRONTIER = {"block_of_study": 3, "frontier_seconds": 1, "frontier": 1}
RECOGNISED = {"recognition": 2, "guards_of_training": 1}
AFTER = {"metrics": 1, "report": 1, "guards_hold": 1}
EARLIER = "was measured with an earlier state"
FIGURES = "results/studies/mine.parquet"


def write(experiment, values):
    text = yaml.safe_dump(values, sort_keys=False)
    (experiment.folder / "studies").mkdir(exist_ok=True)
    (experiment.folder / "studies/mine.yaml").write_text(text)


def planned(experiment, target="study_mine"):
    output = experiment.snakemake("-n", "--", target).stdout
    if "Nothing to be done" in output:
        return {}
    table = output.split("Job stats:")[1].split("\n\n")[0].splitlines()[3:]
    counts = dict(line.split() for line in table)
    return {name: int(count) for name, count in counts.items() if name not in {"total", target}}


@pytest.fixture(scope="module")
def studied(finished, tmp_path_factory):
    experiment = finished.copy(tmp_path_factory.mktemp("studied") / "experiment")
    experiment.set(workflow={"conditions_per_job": 2})
    write(experiment, MINE)
    experiment.snakemake("--", "study_mine", "frontier_all")
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
    assert "Does &lt;b&gt;it&lt;/b&gt; matter?" in page
    assert planned(studied) == {}
    assert studied.planned() == {}


def test_a_study_that_is_not_kept_current_stays_and_the_report_says_so(studied, tmp_path):
    experiment = studied.copy(tmp_path / "experiment")
    figures, page = (experiment.folder / file for file in (FIGURES, "reports/report.html"))
    measured = figures.read_bytes()
    experiment.set(workflow={"keep_studies_current": False})
    experiment.snakemake()
    assert EARLIER not in page.read_text()
    experiment.set(recognition={"classifier": {"svm_penalty": 3.0}})
    assert experiment.planned() == {**FRONTIER, **AFTER, **RECOGNISED}
    experiment.snakemake()
    assert figures.read_bytes() == measured
    assert page.read_text().count(EARLIER) == 2  # among the warnings, and in its section
    assert experiment.planned() == {}
    # Asked for by name it is measured again, and the report follows.
    assert planned(experiment)["block_of_study"] == 3
    experiment.snakemake("--", "study_mine")
    assert figures.read_bytes() != measured
    assert EARLIER not in page.read_text()
    assert experiment.planned() == {}


def test_a_study_that_was_brought_here_and_is_of_an_earlier_state_is_named(studied, tmp_path):
    experiment = studied.copy(tmp_path / "experiment")
    figures = experiment.folder / FIGURES
    measured = figures.read_bytes()
    shutil.rmtree(experiment.folder / ".snakemake")
    experiment.set(workflow={"keep_studies_current": False}, sensor={"largest_size": 0.25})
    experiment.snakemake()
    assert figures.read_bytes() == measured
    assert EARLIER in (experiment.folder / "reports/report.html").read_text()
    assert experiment.planned() == {}


def test_a_lost_block_alone_is_measured_again(studied, tmp_path):
    experiment = studied.copy(tmp_path / "experiment")
    blocks = sorted((experiment.folder / "results/study_blocks/mine").glob("*.parquet"))
    assert len(blocks) == 3
    blocks[1].unlink()
    # It comes out the same, so the page that shows the study is current.
    assert planned(experiment) == {"block_of_study": 1, "figures_of_study": 1}


def test_an_added_condition_recomputes_only_its_own_features(studied, tmp_path):
    experiment = studied.copy(tmp_path / "experiment")
    more = {**MINE["conditions"], "palm 0.4": {"sensor.largest_size": 0.4}}
    write(experiment, {**MINE, "conditions": more})
    assert planned(experiment)["features_of_study"] == 1


def test_a_changed_parameter_of_the_run_reruns_what_depends_on_it(studied, tmp_path):
    experiment = studied.copy(tmp_path / "experiment")
    experiment.set(recognition={"intervals": {"confidence": 0.9}})
    assert planned(experiment) == {**AFTER, "figures_of_study": 1, "frontier": 1}
    experiment.set(recognition={"classifier": {"svm_penalty": 3.0}})
    follows = {**RECOGNISED, "figures_of_study": 1, "block_of_study": 3 + 3}
    assert planned(experiment) == {**FRONTIER, **AFTER, **follows}


def test_a_wrong_file_is_refused_in_one_sentence_before_anything_runs(fresh, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    write(experiment, {"title": "T", "conditions": {"a": {"sensor.size": 1}}})
    result = experiment.snakemake("--", "study_mine", check=False)
    assert result.returncode
    assert "studies/mine.yaml: a: sensor.size is no parameter; sensor has" in result.stdout
    assert "Traceback" not in result.stdout
    assert not (experiment.folder / "results").exists()


def test_dvc_keeps_a_study_once_it_is_asked_to(repository, tmp_path):
    experiment = repository.copy(tmp_path / "experiment")
    shutil.copytree(ROOT / "studies", experiment.folder / "studies")
    write(experiment, {**MINE, "conditions": {"penalty 2": MINE["conditions"]["penalty 2"]}})
    experiment.snakemake("--", "study_mine")
    assert "report.html" in experiment.run("dvc", "status").stdout
    experiment.run("dvc", "commit", "--force")
    assert "up to date" in experiment.run("dvc", "status").stdout
    pipeline = experiment.folder / "studies/dvc.yaml"
    pipeline.write_text(pipeline.read_text().replace("own: []", "own: [mine]"))
    assert "own@mine" in experiment.run("dvc", "status").stdout
    experiment.run("dvc", "repro", "studies/dvc.yaml")
    # The same was made again, so the report that shows it is current.
    assert planned(experiment) == {}
    assert "up to date" in experiment.run("dvc", "status").stdout
    experiment.set(recognition={"classifier": {"svm_penalty": 3.0}})
    assert "own@mine" in experiment.run("dvc", "status").stdout


def test_a_study_of_python_with_a_step_of_its_own_is_one_file(finished, tmp_path):
    experiment = finished.copy(tmp_path / "experiment")
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


def test_one_reading_of_the_paper_is_one_command(finished, tmp_path):
    experiment = finished.copy(tmp_path / "experiment")
    targets = ["results/reading/r012.json", "results/reading/p003.json"]
    experiment.snakemake(*targets)
    for target in targets:
        rows = json.loads((experiment.folder / target).read_text())
        # Five classifiers, each against four kinds of random touches.
        assert [row["reading"] for row in rows] == [target[16:20]] * 20
        assert all(row["fixation"] is not None for row in rows)
    assert "Nothing to be done" in experiment.snakemake("-n", *targets).stdout
