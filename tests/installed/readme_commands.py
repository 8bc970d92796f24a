"""Every command of the README and of the pages on sharing and studies runs, in its order: `make test-installed`.

The experiment is a small one. The environment is that of `make` and pytest, without the packages of the extra `dev`. A command is run as
it stands, is run in another form, or is left out; the last two have a reason, which the test shows.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
from docs.shell_commands import block_commands, line_commands
from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment, set_parameters

ROOT = Path(__file__).parents[2]
README, SHARING, STUDIES = (
    ROOT / name for name in ("README.md", "docs/sharing.md", "studies/README.md")
)
# Three classes, so that one can be unknown, and two of them with a test object and two to train.
OBJECTS = (
    "bs0_yogurtBottle", "bsby_beer_bottle", "sc_com_bath2_jabon_pijo",
    "bs0_chair2", "bsby_chair3", "sc_plastic_chair",
    "bsby_horse", "sc_dog",
)  # fmt: skip
SMALL = {
    "viewpoints": {"count": 2},
    "rendering": {"resolution": 64},
    "workflow": {"views_per_job": 2, "objects_per_job": 4},
    "recognition": {
        "classifiers": ["k_nearest_neighbours", "support_vector_machine"],
        # More combinations than this: folds of whole objects.
        "protocol": {"maximum_splits": 1, "fold_rounds": 1},
        "order_free": {"waves": 20, "classifiers": ["linear_discriminant"]},
    },
    "cost": {
        "touches": [1, 5], "viewpoints": [1, 2], "imprint_resolutions": [16], "view_resolutions": [64],
        "frontier_touches": [5], "frontier_viewpoints": [1], "objects": 1, "rounds": 1,
    },
}  # fmt: skip

IN_ANOTHER_FORM = {
    "make": ("snakemake --cores 2", "`make` makes .venv and then runs this"),
    "snakemake -j2 variants_all": (
        "snakemake -n -- variants_all && snakemake -j2 -- results/variant/r017.json",
        "684 variants take minutes even here: what would run, and one of them",
    ),
    "git add dvc.lock && git commit -m Results": (
        "snakemake --cores 2 && git add dvc.lock && git commit -m Results",
        "`make` was run in the other experiment",
    ),
    "dvc remote add --default team s3://bucket/visuohaptic": (
        "dvc remote add --default team ../storage",
        "S3 needs a network and a key; a folder is the README's other example",
    ),
    "visuohaptic recognise mug.obj": (
        "snakemake -j2 -- model_all && visuohaptic recognise mug.obj",
        "with a model of this run",
    ),
    "dvc pull": (
        "git clone -q ../origin ../colleague && cd ../colleague && dvc pull",
        "a colleague pulls, in a clone",
    ),
    "dvc checkout": (
        "cd ../colleague && dvc checkout",
        "here a model was made since, which it would refuse to remove",
    ),
}
LEFT_OUT = {
    "make test": "it needs the extra dev",
    "source .venv/bin/activate": "it is for the reader's shell; this environment is on PATH",
    "dvc remote modify team endpointurl https://…": "it is for S3, which needs a network and a key",
}


def texts(*commands):
    return list(dict.fromkeys(" ".join(words) for words in commands))


@pytest.fixture(scope="module")
def of_studies(tmp_path_factory):
    """An experiment with objects enough for every study."""
    folder = tmp_path_factory.mktemp("studies") / "experiment"
    copy_experiment(folder, COPIED, OBJECTS, SMALL)
    write_mug(folder)
    return folder


@pytest.fixture(scope="module")
def of_dvc(tmp_path_factory):
    """A git repository with the smallest experiment and somewhere to push to."""
    folder = tmp_path_factory.mktemp("dvc") / "experiment"
    copy_experiment(folder, COPIED, SMALL_OBJECTS, SMALL)
    # The frontier is measured in the other experiment.
    small = {"recognition": {"pipelines": ["paper"]}, "cost": {"frontier_touches": []}}
    set_parameters(folder, small)
    write_mug(folder)
    run(folder, "git init -q && git add --all && git commit -qm Start")
    run(folder, "git init -q --bare ../origin && git remote add origin ../origin")
    run(folder, "git config push.autoSetupRemote true")
    return folder


def write_mug(folder):
    trimesh.creation.annulus(0.8, 1, 2).export(folder / "mug.obj")


def run(folder, command):
    environment = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("GIT_", "PYTEST_", "DVC_", "PYTHONPATH"))
    }
    person = {"NAME": "Reader", "EMAIL": "reader@example.org"}
    for role in ("AUTHOR", "COMMITTER"):
        environment |= {f"GIT_{role}_{name}": value for name, value in person.items()}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=environment, check=False,
        text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600,
    )  # fmt: skip
    assert not done.returncode, f"{command} failed:\n{done.stdout[-5000:]}"
    return done.stdout


def run_as_here(folder, command):
    if command in LEFT_OUT:
        pytest.skip(LEFT_OUT[command])
    run(folder, IN_ANOTHER_FORM.get(command, (command, ""))[0])


OF_README = texts(*block_commands(README), *line_commands(README))
# Within the lines of the page on studies, names stand for the reader's own.
OF_STUDIES = texts(*block_commands(STUDIES))
OF_SHARING = texts(*block_commands(SHARING), *line_commands(SHARING))
STORED = [command for command in OF_README if command.startswith(("git ", "dvc "))]
BEFORE_DVC = list(
    dict.fromkeys([*(command for command in OF_README if command not in STORED), *OF_STUDIES])
)
AFTER = dict.fromkeys([*STORED, *OF_SHARING])
UNDER_DVC = [command for command in AFTER if command not in BEFORE_DVC]


@pytest.mark.parametrize("command", BEFORE_DVC)
def test_a_command_runs(command, of_studies):
    run_as_here(of_studies, command)


@pytest.mark.parametrize("command", UNDER_DVC)
def test_a_command_runs_under_dvc(command, of_dvc):
    run_as_here(of_dvc, command)


def test_every_exception_is_a_command_of_the_pages():
    assert {*IN_ANOTHER_FORM, *LEFT_OUT} <= {*BEFORE_DVC, *UNDER_DVC}
