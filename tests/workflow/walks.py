"""Random walks over what users do to a working folder; each must end in the results of a clean run.

A walk edits parameters, modules and meshes, switches branches, lets DVC bring files, runs, deletes and
kills, in an order drawn by a seed. Then it runs `snakemake` and compares all results with those of a run from
nothing. The scripts are stand-ins (stand_ins.py), so every difference shows.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from dataclasses import dataclass, field

import numpy as np
from small_experiment import set_parameters
from workflow.clean_runs import clean_digests
from workflow.conftest import Experiment
from workflow.stand_ins import MODULES, digests, stand_in

SCRIPTS = ("touches", "recognition")
OWN_MODEL = "meshes/own/chair/stool.stl"
LONG_AGO = (946_000_000, 946_000_000)
PARAMETERS = (
    {"sensor": {"largest_size": 0.2}},
    {"sensor": {"largest_size": 0.3}},
    {"probing": {"strategies": ["fixation"]}},
    {"probing": {"strategies": ["fixation", "random"]}},
)
MESH = "meshes/paper/chair/bsby_chair3.ply.gz"
OTHER_MESH = "meshes/paper/chair/bs0_chair2.ply.gz"
SECONDS_A_COMMAND = 300
# What a walk may do, with how often: methods of `Walk`, and plain commands.
ACTIONS = {
    "edit_parameter": 4, "edit_parameter_and_back": 1, "edit_script": 1, "edit_module": 2,
    "edit_module_twice_within_a_second": 2, "edit_module_while_jobs_run": 2,
    "replace_module_by_older_file": 1, "edit_mesh": 1, "bring_own_mesh": 2, "run_with_other_values": 2,
    "run_experiment": 1, "delete": 2, "damage": 2, "kill": 2, "change_version": 1, "keep_own_file": 1,
}  # fmt: skip
COMMANDS = {
    "git checkout -qf main": 1,
    "git checkout -qf other": 1,
    "dvc checkout --force": 1,
    **{
        f"dvc checkout --force results/{table}": 0.5
        for table in ("features", "touches", "fixations", "scores")
    },
    "dvc pull --force": 2,
    "dvc exp apply tried": 1,
    "dvc repro": 1,
    "snakemake -n": 1,
    "snakemake -j1": 2,
    "snakemake -j1 features_all": 1,
    "snakemake -j1 touches_all": 1,
}


def add_branches(made):
    """Give a repository with a finished run another branch and an experiment, and push all results."""
    made.run("dvc", "remote", "add", "--default", "team", str(made.folder.parent / "remote"))
    made.run("git", "commit", "-qam", "name the remote")
    made.set(recognition={"touches": 4})
    made.snakemake()
    made.run("dvc", "commit", "--force")
    made.run("dvc", "exp", "save", "--name", "tried")
    made.run("git", "checkout", "-qf", "main")
    made.run("git", "checkout", "-qb", "other")
    made.set(**PARAMETERS[0])
    made.snakemake()
    made.commit("other")
    made.run("dvc", "push", "--all-branches")
    made.run("git", "checkout", "-qf", "main")
    made.run("dvc", "checkout", "--force")


@dataclass
class Walk:
    """One walk through a folder."""

    experiment: Experiment
    generator: np.random.Generator
    steps: list[str] = field(default_factory=list)

    @property
    def folder(self):
        return self.experiment.folder

    def take_step(self):
        """Do one thing, drawn at random."""
        steps = {**ACTIONS, **COMMANDS}
        weights = np.array(list(steps.values()), float)
        step = list(steps)[self.generator.choice(len(steps), p=weights / weights.sum())]
        self.steps.append(step)
        if step in ACTIONS:
            getattr(self, step)()
        else:
            self.attempt(step)

    def draw(self, choices):
        """Draw one of several."""
        return choices[self.generator.integers(len(choices))]

    def attempt(self, command, *arguments):
        """Run a command that may refuse in a sentence."""
        self.experiment.run(*command.split(), *arguments, check=False)

    def edit_parameter(self):
        set_parameters(self.folder, self.draw(PARAMETERS))

    def edit_parameter_and_back(self):
        path = self.folder / "params.yaml"
        before = path.read_text()
        self.edit_parameter()
        self.attempt("snakemake -n")
        path.write_text(before)
        self.attempt("snakemake -n")

    def edit_script(self):
        name = self.draw(SCRIPTS)
        script = self.folder / f"workflow/scripts/{name}.py"
        script.write_text(stand_in(name, self.draw((0, 1))))

    def write_module(self, value):
        """Let a module have another value, and give its path and name."""
        name = MODULES[self.draw(tuple(MODULES))]
        path = self.folder / "src" / f"{name.replace('.', '/')}.py"
        text = path.read_text().partition("\nVALUE = ")[0].rstrip("\n")
        path.write_text(f"{text}\nVALUE = {value}\n")
        return path, name

    def edit_module(self):
        self.write_module(self.draw((1, 2)))

    def edit_module_twice_within_a_second(self):
        for _ in range(3):
            path, name = self.write_module(1)
            first = path.stat().st_mtime_ns
            paths = str(self.folder / "src")
            self.experiment.run("python", "-c", f"import {name}", check=False, PYTHONPATH=paths)
            path.write_text(path.read_text().replace("VALUE = 1", "VALUE = 2"))
            os.utime(path, ns=(first, first))

    def edit_module_while_jobs_run(self):
        process = self.experiment.start("snakemake", "-j2")
        time.sleep(self.generator.uniform(1.0, 3.0))
        self.edit_module()
        process.wait(timeout=SECONDS_A_COMMAND)

    def replace_module_by_older_file(self):
        path, _ = self.write_module(self.draw((1, 2)))
        os.utime(path, LONG_AGO)

    def edit_mesh(self):
        mesh = self.folder / MESH
        mesh.write_bytes((self.folder / OTHER_MESH).read_bytes())
        if self.draw((0, 1)):
            os.utime(mesh, LONG_AGO)

    def bring_own_mesh(self):
        import trimesh

        path = self.folder / OWN_MODEL
        path.parent.mkdir(exist_ok=True, parents=True)
        trimesh.creation.box().export(path)
        if self.draw((0, 1)):
            os.utime(path, LONG_AGO)

    def run_with_other_values(self):
        target = self.draw(("features_all", "all"))
        self.attempt("snakemake -j2 --config", 'sensor={"largest_size": 0.2}', "--", target)
        if self.draw((0, 1)):
            self.attempt("dvc commit --force")

    def run_experiment(self):
        how = self.draw(("", "--temp", "--queue"))
        self.attempt(f"dvc exp run {how} -S recognition.touches=4")
        if how == "--queue":
            self.attempt("dvc exp run --queue -S sensor.largest_size=0.2")
            self.attempt("dvc exp run --run-all")

    def delete(self):
        files = sorted(digests(self.folder))
        state = self.draw((".snakemake", "results/records", "one", "one", "one"))
        if state == "one" and files:
            (self.folder / self.draw(files)).unlink()
        else:
            shutil.rmtree(self.folder / state, ignore_errors=True)

    def damage(self):
        files = sorted(digests(self.folder))
        if files:
            file = self.folder / self.draw(files)
            text = file.read_text()
            file.unlink()  # it may be a link to the cache
            file.write_text(self.draw((text[:20], f"{text} ")))

    def kill(self):
        process = self.experiment.start("snakemake", "-j2")
        time.sleep(self.generator.uniform(0.5, 3.0))
        how = self.draw((signal.SIGKILL, signal.SIGKILL, signal.SIGINT))
        if process.poll() is None:
            (os.killpg if self.draw((0, 1)) else os.kill)(process.pid, how)
        process.wait(timeout=SECONDS_A_COMMAND)

    def change_version(self):
        other = self.folder / ".other" / "pywavelets-99.dist-info"
        other.mkdir(parents=True, exist_ok=True)
        (other / "METADATA").write_text("Metadata-Version: 2.1\nName: PyWavelets\nVersion: 99\n")
        self.experiment.variables["PYTHONPATH"] = str(other.parent)

    def keep_own_file(self):
        for name in ("features/mine.parquet", "touches/mine/mine.parquet"):
            file = self.folder / "results" / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("mine")


def walk(repository, folder, seed):
    """Take one walk; give its steps where something was wrong, and what."""
    generator = np.random.default_rng(seed)
    if generator.integers(3):
        walked = repository.copy(folder)
    else:
        walked = Experiment(folder)
        repository.run("git", "clone", "-q", ".", str(folder))
        walked.run("git", "fetch", "-q", "origin", "other:other")
        walked.run("dvc", "pull")
    taken = Walk(walked, generator)
    for _ in range(generator.integers(2, 5)):
        taken.take_step()
    mine = list((folder / "results").rglob("mine.parquet"))
    last = walked.snakemake(check=False)
    if last.returncode:
        wrong = f"the last run failed: {last.stdout[-1500:]}"
    else:
        wrong = _difference(folder, clean_digests(walked))
    if not wrong and not all(file.exists() for file in mine):
        wrong = "a file of the user is gone"
    return wrong and f"walk {seed}, {', '.join(taken.steps)}: {wrong}"


def _difference(folder, expected):
    """Compare what a clean run makes, and what else a record stands for: without one a file is the user's."""
    found = digests(folder)
    records = [
        json.loads(file.read_text()) for file in (folder / "results").glob("*records/**/*.json")
    ]
    vouched = {table for record in records for table in record.get("tables", ())}
    different = sorted(
        name
        for name in {*expected, *(found.keys() & vouched)}
        if found.get(name) != expected.get(name)
    )
    return f"{len(different)} files differ: {different[:5]}" if different else None


def take_walks(repository, folder, count):
    """Take walks from copies of a repository, one after another; say which were wrong."""
    start = repository.copy(folder / "repository")
    add_branches(start)
    wrong = []
    for seed in range(count):
        found = walk(start, folder / f"walk{seed}", seed)
        if found:
            wrong.append(found)
        else:
            shutil.rmtree(folder / f"walk{seed}")
    return wrong
