"""However DVC runs the experiment, the results are those of a clean run, bit for bit; the scripts are stand-ins."""

import json
import os
import shutil
import signal
import time

import pytest
from workflow.clean_runs import clean_digests
from workflow.stand_ins import digests

pytestmark = [pytest.mark.workflow, pytest.mark.long]


@pytest.fixture
def experiment(repository, tmp_path):
    return repository.copy(tmp_path / "experiment")


def test_a_changed_parameter_is_never_answered_with_old_outputs_also_after_a_kill(experiment):
    shutil.rmtree(experiment.folder / ".snakemake")
    experiment.set(recognition={"classifier": {"neighbours": 3}})
    scores = experiment.folder / "results/scores"
    before = {file: file.read_bytes() for file in scores.rglob("*.parquet")}
    process = experiment.start("dvc", "exp", "run")
    while process.poll() is None and all(
        file.exists() and file.read_bytes() == before[file] for file in before
    ):
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=300)
    experiment.run("dvc", "exp", "run")
    assert digests(experiment.folder) == clean_digests(experiment)


def test_an_experiment_here_or_elsewhere_gives_the_results_of_a_clean_run(repository, experiment):
    value = "recognition.classifier.neighbours=3"
    experiment.run("dvc", "exp", "run", "--name", "queued", "-S", value, "--queue")
    experiment.run("dvc", "exp", "run", "--run-all")
    assert digests(experiment.folder) == digests(repository.folder)
    experiment.run("dvc", "exp", "apply", "queued")
    assert digests(experiment.folder) == clean_digests(experiment)
    shown = experiment.run("dvc", "exp", "show", "--json").stdout
    assert '"neighbours": 3' in json.dumps(json.loads(shown))


def test_declared_plots_are_drawn(finished, tmp_path):
    experiment = finished.copy(tmp_path / "experiment")
    experiment.run("git", "init", "-q")
    experiment.run("dvc", "plots", "show", "--out", "plots")
    page = (experiment.folder / "plots/index.html").read_text()
    assert "Accuracy of each classifier" in page
    assert "Predicted class by true class" in page
