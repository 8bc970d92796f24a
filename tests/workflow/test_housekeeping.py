"""What is missing is made, what is gone is cleared away, and nothing else happens."""

import os

import pytest
import trimesh
from workflow.conftest import Experiment
from workflow.walks import make_experiment

pytestmark = pytest.mark.workflow


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A finished experiment; its scripts are stand-ins."""
    folder = tmp_path_factory.mktemp("whole") / "experiment"
    make_experiment(folder)
    experiment = Experiment(folder)
    experiment.snakemake()
    return experiment


@pytest.fixture
def experiment(whole, tmp_path):
    return whole.copy(tmp_path / "experiment")


@pytest.mark.parametrize(
    ("file", "rule"),
    [
        ("results/views/chair/bsby_chair3/00-01.parquet", "fixations"),
        ("reports/report.html", "report"),
        *(
            pytest.param(*deleted, marks=pytest.mark.long)
            for deleted in (
                ("results/meshes/chair/bsby_chair3/bsby_chair3.ply", "meshes"),
                ("results/effects/touches/chair/bsby_chair3/00-01.parquet", "touches"),
                ("reports/plots/accuracy.csv", "metrics"),
            )
        ),
    ],
)
def test_a_deleted_output_is_made_again(experiment, file, rule):
    (experiment.folder / file).unlink()
    assert experiment.planned()[rule] == 1
    experiment.snakemake()
    assert (experiment.folder / file).exists()


def test_touched_scripts_rules_and_modules_rerun_nothing(experiment):
    for pattern in (
        "workflow/**/*.py",
        "workflow/**/*.smk",
        "src/**/*.py",
        "packages/**/*.py",
        "params.yaml",
        "Snakefile",
    ):
        for file in experiment.folder.glob(pattern):
            os.utime(file)
    assert experiment.planned() == {}


def test_an_edited_module_reruns_its_phase_and_what_follows(experiment):
    module = experiment.folder / "src/visuohaptic/features/describing.py"
    module.write_text(f"{module.read_text()}# edited\n")
    planned = experiment.planned()
    assert planned["features"] == 4
    assert "touches" not in planned


@pytest.mark.long
def test_results_and_logs_of_a_deleted_object_go(experiment):
    own = experiment.folder / "meshes/own/chair/stool.stl"
    own.parent.mkdir()
    trimesh.creation.box().export(own)
    experiment.snakemake()
    own.unlink()
    experiment.snakemake()
    left = [
        file
        for folder in ("results", "logs")
        for file in (experiment.folder / folder).rglob("*stool*")
    ]
    assert left == []
    assert experiment.planned() == {}


def test_a_run_about_some_objects_leaves_results_of_others(experiment):
    catalogue = experiment.folder / "meshes/catalogue.csv"
    catalogue.write_text(
        "".join(
            line
            for line in catalogue.read_text().splitlines(keepends=True)
            if "bsby_chair3" not in line
        )
    )
    meshes = sorted((experiment.folder / "results/meshes").glob("*/*/*.ply"))
    next(file for file in meshes if file.stem != "bsby_chair3").unlink()
    experiment.snakemake("--", "meshes_all")
    assert sorted((experiment.folder / "results/meshes").glob("*/*/*.ply")) == meshes
