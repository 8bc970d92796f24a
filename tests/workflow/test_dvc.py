"""However DVC runs the experiment, the results are those of a clean run, bit for bit; the scripts are stand-ins."""

import json
import os
import shutil
import signal
import time

import pytest
from workflow.stand_ins import digests

pytestmark = [pytest.mark.workflow, pytest.mark.long]

CHANGE = {"sensor": {"largest_size": 0.2}, "recognition": {"classifier": {"neighbours": 3}}}
SET = ("-S", "sensor.largest_size=0.2", "-S", "recognition.classifier.neighbours=3")


@pytest.fixture(scope="module")
def changed(whole_stand_in, tmp_path_factory):
    """Results of a run without DVC, with the parameters changed."""
    experiment = whole_stand_in.copy(tmp_path_factory.mktemp("changed") / "experiment")
    experiment.set(**CHANGE)
    experiment.snakemake("dvc_all")
    return digests(experiment.folder)


@pytest.fixture
def experiment(repository, tmp_path):
    return repository.copy(tmp_path / "experiment")


def test_a_changed_parameter_is_never_answered_with_old_outputs_also_after_a_kill(
    experiment, changed
):
    shutil.rmtree(experiment.folder / ".snakemake")
    experiment.set(**CHANGE)
    process = experiment.start("dvc", "repro")
    touches = experiment.folder / "results/touches"
    # DVC removes the outputs of a stage before it runs it.
    for is_there in (False, True):
        while process.poll() is None and touches.exists() != is_there:
            time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=300)
    experiment.run("dvc", "repro")
    assert digests(experiment.folder) == changed


def test_an_experiment_here_or_elsewhere_gives_the_results_of_a_clean_run(
    repository, experiment, changed
):
    experiment.run("dvc", "exp", "run", "--name", "queued", *SET, "--queue")
    experiment.run("dvc", "exp", "run", "--run-all")
    assert digests(experiment.folder) == digests(repository.folder)
    experiment.run("dvc", "exp", "apply", "queued")
    assert digests(experiment.folder) == changed
    shown = experiment.run("dvc", "exp", "show", "--json").stdout
    assert '"largest_size": 0.2' in json.dumps(json.loads(shown))


def test_declared_plots_are_drawn(finished, tmp_path):
    experiment = finished.copy(tmp_path / "experiment")
    experiment.run("git", "init", "-q")
    experiment.run("dvc", "plots", "show", "--out", "plots")
    page = (experiment.folder / "plots/index.html").read_text()
    assert "Accuracy of each classifier" in page
    assert "Predicted class by true class" in page
