"""Files that DVC brings are taken where they are current, and made again where they are not."""

import os
import shutil

import pytest
from small_experiment import merged
from workflow.conftest import Experiment
from workflow.walks import digests, make_repository

pytestmark = [pytest.mark.workflow, pytest.mark.long]

WIDER_FOCUS = {"attention": {"focus_radius": 0.3}}
SMALLER_SENSOR = {"sensor": {"largest_size": 0.2}}
THREE_NEIGHBOURS = {"recognition": {"classifier": {"neighbours": 3}}}


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    """A repository with two branches whose results have been pushed; its scripts are stand-ins."""
    folder = tmp_path_factory.mktemp("shared")
    make_repository(folder / "repository")
    return Experiment(folder / "repository")


def clone(experiment, folder):
    experiment.run("git", "clone", "-q", str(experiment.folder), str(folder))
    return Experiment(folder)


@pytest.fixture
def pulled(shared, tmp_path):
    """A clone whose results DVC has brought."""
    experiment = clone(shared, tmp_path / "clone")
    experiment.run("dvc", "pull")
    return experiment


def clean_digests(shared, folder, changes):
    """Give the results of a run from nothing."""
    experiment = clone(shared, folder)
    experiment.set(**changes)
    experiment.snakemake("dvc_all")
    return digests(experiment.folder)


def test_after_a_pull_both_tools_find_nothing_to_do(pulled):
    assert pulled.planned() == {}
    assert "up to date" in pulled.run("dvc", "status").stdout
    assert "Nothing to be done" in pulled.snakemake("dvc_all").stdout


def test_a_dry_run_changes_no_file(pulled):
    before = digests(pulled.folder)
    pulled.set(**WIDER_FOCUS)
    assert pulled.planned()["fixations"] == 4
    assert digests(pulled.folder) == before
    pulled.run("git", "checkout", "-q", "params.yaml")
    assert pulled.planned() == {}


def test_a_parameter_changed_after_a_pull_gives_the_results_of_a_clean_run(
    pulled, shared, tmp_path
):
    pulled.set(**WIDER_FOCUS)
    pulled.snakemake("dvc_all")
    assert digests(pulled.folder) == clean_digests(shared, tmp_path / "clean", WIDER_FOCUS)
    assert pulled.planned() == {}


def test_a_change_tried_put_back_and_made_again_gives_the_results_of_a_clean_run(shared, tmp_path):
    experiment = shared.copy(tmp_path / "experiment")
    experiment.snakemake("dvc_all")
    experiment.run(
        "dvc", "exp", "run",
        "-S", "sensor.largest_size=0.2", "-S", "recognition.classifier.neighbours=3",
    )  # fmt: skip
    experiment.run("git", "checkout", "--", ".")
    experiment.run("dvc", "checkout")
    changes = merged(SMALLER_SENSOR, THREE_NEIGHBOURS)
    experiment.set(**changes)
    experiment.snakemake("dvc_all")
    assert digests(experiment.folder) == clean_digests(shared, tmp_path / "clean", changes)


def test_a_branch_without_its_results_gives_the_results_of_a_clean_run(shared, tmp_path):
    experiment = shared.copy(tmp_path / "experiment")
    experiment.run("git", "checkout", "-q", "other")
    experiment.snakemake("dvc_all")
    assert digests(experiment.folder) == clean_digests(shared, tmp_path / "clean", WIDER_FOCUS)


def test_code_edited_after_a_pull_runs_again(pulled):
    module = pulled.folder / "workflow/scripts/features.py"
    module.write_text(module.read_text() + "\n# edited\n")
    planned = pulled.planned()
    assert planned["features"] == 4
    assert "touches" not in planned


@pytest.mark.parametrize("kind", ["hardlink", "symlink"])
def test_links_to_the_cache_are_judged_like_copies(shared, tmp_path, kind):
    experiment = clone(shared, tmp_path / "clone")
    experiment.run("dvc", "config", "cache.type", kind)
    experiment.run("dvc", "pull")
    assert experiment.planned() == {}
    experiment.set(**SMALLER_SENSOR)
    planned = experiment.planned()
    assert planned["touches"] == 4
    assert "fixations" not in planned


def test_an_older_table_put_back_by_hand_is_noticed(pulled):
    experiment = pulled
    part = "results/features/chair/bsby_chair3/00-01.parquet"
    kept = experiment.folder / "kept.parquet"
    shutil.copy2(experiment.folder / part, kept)
    experiment.set(features={"extension": "symmetric"})
    experiment.snakemake("dvc_all")
    right = digests(experiment.folder)
    shutil.copy2(kept, experiment.folder / part)
    experiment.snakemake("dvc_all")
    assert digests(experiment.folder) == right


def test_a_table_without_a_record_is_made_again(pulled):
    (pulled.folder / "results/records/touches/chair/bsby_chair3/00-01.json").unlink()
    assert pulled.planned()["touches"] == 1


def test_results_that_were_touched_are_current(shared, tmp_path):
    experiment = shared.copy(tmp_path / "experiment")
    for file in (experiment.folder / "results").rglob("*.parquet"):
        os.utime(file)
    assert experiment.planned() == {}
