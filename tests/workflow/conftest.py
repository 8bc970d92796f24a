"""A small copy of the experiment: four objects of two classes, two small views, everything real."""

import fcntl
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment, set_parameters
from workflow import stand_ins

SMALL = {
    "viewpoints": {"count": 2},
    "rendering": {"resolution": 64},
    "workflow": {"views_per_job": 2, "objects_per_job": 2},
    "recognition": {"pipelines": ["paper"]},
}


def pytest_addoption(parser):
    parser.addoption(
        "--examples", type=int, metavar="N", help="examples of the state machine of working folders"
    )


@dataclass(frozen=True)
class Experiment:
    """A copy of the repository in which commands can be run; `variables` are more of the environment."""

    folder: Path
    variables: dict[str, str] = field(default_factory=dict)

    @property
    def environment(self):
        """That of a user's shell, with bytecode; a copy's own package is found by the copy's own means."""
        kept = {
            key: value
            for key, value in os.environ.items()
            if not key.startswith(("GIT_", "PYTEST_", "DVC_"))
            and key not in {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE"}
        }
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        return {**kept, "PATH": path, **self.variables}

    def run(self, *command, check=True, **more):
        """Run a command of the environment there, and give what it printed."""
        result = subprocess.run(
            command, cwd=self.folder, env={**self.environment, **more}, check=False, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600,
        )  # fmt: skip
        if check and result.returncode:
            raise AssertionError(f"{' '.join(map(str, command))} failed:\n{result.stdout[-5000:]}")
        return result

    def start(self, *command):
        """Start a command in a process group of its own."""
        return subprocess.Popen(
            command, cwd=self.folder, env=self.environment, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    def snakemake(self, *arguments, check=True):
        return self.run("snakemake", "-j2", *arguments, check=check)

    def planned(self, *targets):
        """Count the jobs of each rule that would run now."""
        output = self.snakemake("-n", *targets).stdout
        if "Nothing to be done" in output:
            return {}
        table = output.split("Job stats:")[1].split("\n\n")[0]
        counts = re.findall(r"^(\w+) +(\d+)$", table, re.M)
        return {
            name: int(count) for name, count in counts if name not in {"total", "all", *targets}
        }

    def set(self, **sections):
        """Change parameters, section by section."""
        set_parameters(self.folder, sections)

    def commit(self, message):
        """Let DVC take over all results, and commit everything that git tracks or should track."""
        self.run("dvc", "commit", "--force")
        self.run("git", "add", "--all")
        self.run("git", "commit", "-qm", message)

    def copy(self, folder):
        shutil.copytree(self.folder, folder, symlinks=True)
        return Experiment(folder)


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
def fresh(once):
    """The experiment before anything has run."""
    return once("fresh", lambda one: copy_experiment(one.folder, COPIED, SMALL_OBJECTS, SMALL))


@pytest.fixture(scope="session")
def finished(fresh, once):
    """The experiment after one whole run with two processes."""
    return once("finished", lambda one: fresh.copy(one.folder).snakemake())


@pytest.fixture
def experiment(finished, tmp_path):
    """A finished experiment to do with as a test likes."""
    return finished.copy(tmp_path / "experiment")


@pytest.fixture(scope="session")
def whole_stand_in(once):
    """A finished experiment whose scripts are stand-ins."""

    def make(one):
        stand_ins.make_experiment(one.folder)
        one.snakemake()

    return once("stand_in", make)


@pytest.fixture
def stand_in(whole_stand_in, tmp_path):
    """A finished experiment of stand-ins to do with as a test likes."""
    return whole_stand_in.copy(tmp_path / "experiment")


@pytest.fixture
def fresh_stand_in(tmp_path):
    """An experiment of stand-ins before anything has run."""
    experiment = Experiment(tmp_path / "experiment")
    stand_ins.make_experiment(experiment.folder)
    return experiment


@pytest.fixture(scope="session")
def repository(whole_stand_in, once):
    """A git repository of stand-ins whose results DVC has taken over."""

    def make(one):
        whole_stand_in.copy(one.folder)
        one.run("git", "init", "-q", "-b", "main")
        one.run("git", "config", "user.name", "A")
        one.run("git", "config", "user.email", "a@b.c")
        one.commit("run")

    return once("repository", make)
