"""A small copy of the experiment: four objects of two classes, two small views, everything real."""

import fcntl
import os
import shutil

import pytest
from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment
from workflow import stand_ins
from workflow.experiments import SMALL, Experiment
from workflow.quick_commands import serving


def pytest_addoption(parser):
    parser.addoption(
        "--examples", type=int, metavar="N", help="examples of the state machine of working folders"
    )


@pytest.fixture(scope="session")
def once(tmp_path_factory):
    """Return what makes an experiment once for all processes of pytest-xdist."""
    root = tmp_path_factory.getbasetemp()
    root = root.parent if "PYTEST_XDIST_WORKER" in os.environ else root

    def made(name, make):
        experiment = Experiment(root / name / "experiment")
        with (root / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (root / name / "made").exists():
                shutil.rmtree(root / name, ignore_errors=True)
                make(experiment)
                (root / name / "made").touch()
        return experiment

    return made


@pytest.fixture(scope="session")
def open_folder():
    """Return the function that opens a folder as an experiment whose commands run in forks of one process."""
    with serving() as open_folder:
        yield open_folder


@pytest.fixture(scope="session")
def fresh(once):
    """The experiment before anything has run."""
    return once("fresh", lambda one: copy_experiment(one.folder, COPIED, SMALL_OBJECTS, SMALL))


@pytest.fixture(scope="session")
def finished(fresh, once, request):
    """The experiment after one whole run with two processes, which are forks."""

    def make(one):
        open_folder = request.getfixturevalue("open_folder")
        open_folder(fresh.copy(one.folder).folder, has_stand_ins=False).snakemake()

    return once("finished", make)


@pytest.fixture
def experiment(finished, open_folder, tmp_path):
    """A copy of the finished experiment, whose commands and scripts are forks."""
    folder = finished.copy(tmp_path / "experiment").folder
    return open_folder(folder, has_stand_ins=False)


@pytest.fixture(scope="session")
def whole_stand_in(once, open_folder):
    """A finished experiment whose scripts are stand-ins, and whose commands are forks."""

    def make(one):
        stand_ins.make_experiment(one.folder)
        open_folder(one.folder).snakemake()

    return open_folder(once("stand_in", make).folder)


@pytest.fixture
def stand_in(whole_stand_in, tmp_path):
    """A copy of the finished experiment of stand-ins."""
    return whole_stand_in.copy(tmp_path / "experiment")


@pytest.fixture
def fresh_stand_in(open_folder, tmp_path):
    """An experiment of stand-ins before anything has run."""
    stand_ins.make_experiment(tmp_path / "experiment")
    return open_folder(tmp_path / "experiment")


@pytest.fixture(scope="session")
def repository(whole_stand_in, open_folder, once):
    """A git repository of stand-ins whose results DVC has taken over."""

    def make(one):
        made = whole_stand_in.copy(one.folder)
        made.run("git", "init", "-q", "-b", "main")
        made.run("git", "config", "user.name", "A")
        made.run("git", "config", "user.email", "a@b.c")
        made.commit("run")

    return open_folder(once("repository", make).folder)
