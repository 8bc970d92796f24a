"""However DVC runs the experiment, the metrics are those of a clean run, bit for bit."""

import json
import shutil

import pandas as pd
import pytest

pytestmark = [pytest.mark.workflow, pytest.mark.long]

METRICS = "reports/metrics.json"
LATE_CHANGE = {"recognition": {"classifier": {"neighbours": 3}}}
CHANGE = {"sensor": {"largest_size": 0.2}, **LATE_CHANGE}
SET_LATE = ("-S", "recognition.classifier.neighbours=3")
SET = ("-S", "sensor.largest_size=0.2", *SET_LATE)


@pytest.fixture(scope="module")
def changed_metrics(fresh, tmp_path_factory):
    """Metrics of a clean run without DVC, with the parameters changed."""
    experiment = fresh.copy(tmp_path_factory.mktemp("changed") / "experiment")
    experiment.set(**CHANGE)
    experiment.snakemake("--", METRICS)
    return (experiment.folder / METRICS).read_bytes()


def test_repro_gives_the_metrics_of_a_run_without_dvc(repository, finished):
    assert (repository.folder / METRICS).read_bytes() == (finished.folder / METRICS).read_bytes()


def test_nothing_is_left_to_do_for_either_tool_after_repro(repository):
    assert repository.planned() == {}
    assert "up to date" in repository.run("dvc", "status").stdout


def test_without_the_metadata_of_snakemake_nothing_is_stale_and_nothing_lost(repository, tmp_path):
    experiment = repository.copy(tmp_path / "experiment")
    shutil.rmtree(experiment.folder / ".snakemake")
    output = experiment.run("dvc", "repro").stdout
    assert "Running stage" not in output
    assert len(pd.read_parquet(experiment.folder / "results/touches")) == 80


def test_a_changed_parameter_is_never_answered_with_old_outputs(
    repository, changed_metrics, tmp_path
):
    experiment = repository.copy(tmp_path / "experiment")
    shutil.rmtree(experiment.folder / ".snakemake")
    experiment.set(**CHANGE)
    experiment.run("dvc", "repro")
    assert (experiment.folder / METRICS).read_bytes() == changed_metrics


def test_an_experiment_gives_the_metrics_of_a_clean_run(repository, changed_metrics, tmp_path):
    experiment = repository.copy(tmp_path / "experiment")
    experiment.run("dvc", "exp", "run", "--name", "smaller", *SET)
    assert (experiment.folder / METRICS).read_bytes() == changed_metrics
    shown = experiment.run("dvc", "exp", "show", "--json").stdout
    assert "smaller" in shown
    assert '"largest_size": 0.2' in json.dumps(json.loads(shown))


@pytest.mark.parametrize("how", ["--temp", "--queue"])
def test_an_experiment_elsewhere_gives_the_metrics_of_a_run_here(
    repository, finished, tmp_path, how
):
    here = finished.copy(tmp_path / "here")
    here.set(**LATE_CHANGE)
    here.snakemake("--", METRICS)
    experiment = repository.copy(tmp_path / "experiment")
    experiment.run("dvc", "exp", "run", "--name", "nearer", *SET_LATE, how)
    if how == "--queue":
        experiment.run("dvc", "exp", "run", "--run-all")
    before = (experiment.folder / METRICS).read_bytes()
    assert before == (repository.folder / METRICS).read_bytes()
    experiment.run("dvc", "exp", "apply", "nearer")
    after = (experiment.folder / METRICS).read_bytes()
    assert after == (here.folder / METRICS).read_bytes() != before


def test_meshes_and_tables_come_back_from_a_remote(repository, tmp_path):
    experiment = repository.copy(tmp_path / "experiment")
    experiment.run("dvc", "push")
    for name in ("results", "meshes/downloaded", ".dvc/cache", "reports"):
        shutil.rmtree(experiment.folder / name)
    experiment.run("dvc", "pull")
    assert (experiment.folder / METRICS).read_bytes() == (repository.folder / METRICS).read_bytes()
    assert len(list((experiment.folder / "results/meshes").glob("*/*/*.ply"))) == 4
    assert "up to date" in experiment.run("dvc", "status").stdout


def test_declared_plots_are_drawn(repository, tmp_path):
    repository.run("dvc", "plots", "show", "--out", str(tmp_path / "plots"))
    page = (tmp_path / "plots" / "index.html").read_text()
    assert "Accuracy of each classifier" in page
    assert "What the sequences of each class were named" in page
