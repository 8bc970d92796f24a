"""What users, accidents and other tools do to a working folder, as a Hypothesis state machine.

Each step is one thing that happens; each run of the workflow is checked at once against a run from nothing
(`FolderMachine.check`). The workflow's Snakefile, rules and keys are real, its scripts are stand-ins.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
from pathlib import Path

from hypothesis import note
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule
from small_experiment import SMALL_OBJECTS, set_parameters, write_catalogue
from workflow.quick_commands import Fault, QuickExperiment
from workflow.stand_ins import MODULES, digests, stand_in

TARGETS = (
    "all", "meshes_all", "touches_all", "features_all", "recognition_all", "stability_all", "report_all",
    "reports/metrics.json", "model_all",
)  # fmt: skip
PARAMETERS = (
    {"sensor": {"largest_size": 0.2}},
    {"sensor": {"largest_size": 0.3}},
    {"recognition": {"touches": 4}},
    {"recognition": {"touches": 5}},
    {"probing": {"strategies": ["fixation"]}},
    {"probing": {"strategies": ["fixation", "random"]}},
    {"recognition": {"pipelines": ["paper"]}},
    {"recognition": {"pipelines": ["paper", "order_free"]}},
    {"viewpoints": {"count": 1}},
    {"viewpoints": {"count": 2}},
    {"viewpoints": {"count": 3}},
    {"workflow": {"views_per_job": 1}},
    {"workflow": {"views_per_job": 2}},
    {"workflow": {"objects_per_job": 1}},
    {"workflow": {"objects_per_job": 2}},
)
MORE = ("sc_plastic_chair", "bsby_beer_bottle")
SETS = (
    SMALL_OBJECTS,
    (*SMALL_OBJECTS, MORE[0]),
    (*SMALL_OBJECTS, *MORE),
    (*SMALL_OBJECTS[1:], *MORE),
)
PLUG_IN = "plug_ins/mine.py"
WITH_PLUG_IN = {"plugins": [PLUG_IN], "probing": {"strategies": ["fixation", "placed"]}}
WITHOUT_PLUG_IN = {"plugins": [], "probing": {"strategies": ["fixation", "random"]}}
PLUG_IN_TEXT = '''"""A strategy with a helper and numbers beside it."""

import visuohaptic as vh

vh.register(vh.Strategy("placed", "my places", lambda viewpoint, attention, generator: None, needs_view=False))
'''
STUDY = "studies/palm.yaml"
CONDITIONS = (
    "title: Palm\nconditions: {palm 0.2: {sensor.largest_size: 0.2}}\n",
    "title: Palm\nconditions: {palm 0.2: {sensor.largest_size: 0.2}, four touches: {recognition.touches: 4}}\n",
)
BESIDE = (PLUG_IN, "plug_ins/helper_of_mine.py", "plug_ins/more/numbers.json")
MESH = "meshes/paper/chair/bsby_chair3.ply.gz"
OTHER_MESH = "meshes/paper/chair/bs0_chair2.ply.gz"
OWN_MODEL = "meshes/own/chair/stool.stl"
SCRIPTS = ("touches", "recognition")
FOLDERS = (
    ".snakemake", ".cache", ".cache/tables", "logs", "results/records", "results/study_records", "results/touches", "results/features",
    "results/effects", "results/scores", "results/study_blocks", "reports",
)  # fmt: skip
DVC = (
    "dvc repro", "dvc checkout --force", "dvc checkout --force results/touches", "dvc checkout --force results/records",
    "dvc exp run -S recognition.touches=4", "dvc exp run -S sensor.largest_size=0.2",
    "dvc exp apply tried", "dvc commit --force", "git checkout -qf main", "git checkout -qf other",
    "dvc exp run --queue -S recognition.touches=4", "dvc exp run --temp -S sensor.largest_size=0.2",
    "dvc pull --force",
)  # fmt: skip
CHECKED = {"dvc repro", *(command for command in DVC if command.startswith("dvc exp run -S"))}
"""Commands after which the folder must hold what a run makes."""
FOREIGN = (
    {},
    {"VISUOHAPTIC_RUN": "elsewhere:1"},
    {"VISUOHAPTIC_PLUGINS": "/gone/plug_in.py"},
    {"VISUOHAPTIC_ARGUMENTS": '["study_ablations"]', "VISUOHAPTIC_PREFIX": "/usr"},
)
TIMES = {"long ago": 946_000_000, "future": 2_500_000_000}


def add_branches(made):
    """Add a branch and an experiment to a repository with a finished run, and push all results."""
    made.run("dvc", "remote", "add", "--default", "team", str(made.folder.parent / "remote"))
    made.run("git", "commit", "-qam", "name the remote")
    made.set(recognition={"touches": 4})
    made.snakemake()
    made.run("dvc", "commit", "--force")
    made.run("dvc", "exp", "save", "--name", "tried")
    made.run("git", "checkout", "-qf", "main")
    made.run("git", "checkout", "-qb", "other")
    made.set(sensor={"largest_size": 0.2})
    made.snakemake()
    made.commit("other")
    made.run("dvc", "push", "--all-branches")
    made.run("git", "checkout", "-qf", "main")
    made.run("dvc", "checkout", "--force")


class FolderMachine(RuleBasedStateMachine):
    """A working folder, and what happens to it. Subclasses set where it begins and how commands are run.

    Attributes
    ----------
    starts : mapping of str to QuickExperiment
        Folders to begin from, by name; only those named ``repository`` have Git and DVC.
    work : Path
        Where the folders of examples are made.
    box : Path
        A model of the user.
    counts : Counter
        How often commands ran and runs were checked.
    """

    starts: dict[str, QuickExperiment]
    work: Path
    box: Path
    counts: dict[str, int]

    @initialize(start=st.sampled_from(("plain", "plain", "repository")))
    def begin(self, start):
        folder = self.work / "folder"
        subprocess.run(["rm", "-rf", folder], check=True)
        self.experiment = self.starts[start].copy(folder)
        self.is_repository = start == "repository"
        self.foreign: dict[str, str] = {}
        self.is_wrong = False

    def teardown(self):
        """End each example with a run of everything."""
        if not self.is_wrong:
            self.run("all")
        subprocess.run(["rm", "-rf", self.work / "folder"], check=True)

    @property
    def folder(self):
        return self.experiment.folder

    def command(self, *argv, **more):
        self.counts["commands"] += 1
        self.mine = self.own_files()
        return self.experiment.run(*argv, check=False, **self.foreign, **more)

    def snakemake(self, target, **more):
        return self.command("snakemake", "-j1", "--", target, **more)

    @rule()
    def run_whole(self):
        self.run("all")

    @rule(asked=st.sampled_from(TARGETS))
    def run_target(self, asked):
        self.run(asked)

    def run(self, asked):
        """Run the workflow: what the target covers must be right, and the next run must find nothing to do."""
        self.is_wrong = True
        done = self.snakemake(asked)
        assert done.returncode == 0, done.stdout[-1500:]
        self.check(asked)
        self.is_wrong = False

    @rule(
        asked=st.sampled_from(("all", *TARGETS)),
        values=st.sampled_from(PARAMETERS),
        kind=st.sampled_from(("fail", "kill", "write")),
        job=st.integers(1, 4),
        saved=st.sampled_from((*MODULES, "source")),
    )
    def run_disturbed(self, asked, values, kind, job, saved):
        """Run after a change of parameters with a fault in one job, then the same command without."""
        self.set_parameter(values)
        file = self.folder / MESH if saved == "source" else self.module(saved)
        self.run_with_fault(asked, kind, job, str(file), "\nVALUE = 3\n")

    def run_with_fault(self, asked, kind, job, file="", text=""):
        """Run with a fault, then the same command without; an edit after the job that it is about is no error."""
        done = self.snakemake(asked, **Fault(kind, job, file, text).environment)
        self.counts[f"{kind}: {'an error' if done.returncode else 'no effect'}"] += 1
        self.is_wrong = "Traceback" in done.stdout
        assert not self.is_wrong, done.stdout[-1500:]
        self.run(asked)

    def check(self, target):
        """Compare the folder with what a run from nothing makes, and ask `why` and `verify`.

        All files of the target are there; of other files, whichever are there are current. Models alone may be stale.
        """
        self.counts["runs checked"] += 1
        mine = self.mine
        done = self.command("inspect", target)
        assert done.returncode == 0, done.stdout[-1500:]
        clean = json.loads(done.stdout.splitlines()[-1])
        expected, found = clean["results"], digests(self.folder)
        wanted = {file for file in expected if _is_of(file, clean["wanted"])}
        wrong = {
            file
            for file, digest in expected.items()
            if file in wanted | found.keys() and found.get(file) != digest
        }
        assert not wrong, f"{len(wrong)} tables are not those of a clean run: {sorted(wrong)[:4]}"
        others = {
            file
            for file in found
            if not file.startswith("results/models/") and not _is_of(file, clean["named"])
        }
        assert not others, f"{len(others)} files are of no job of today: {sorted(others)[:4]}"
        if target == "all":
            assert clean["why"] == ["Nothing to be done."], clean["why"]
            planned = self.command("snakemake", "-n").stdout
            assert "Nothing to be done" in planned, planned[-1500:]
        stale = [line for line in clean["verify"] if "/model_records/" not in line]
        assert stale[0].startswith("All ") or not stale[:-1], f"verify lists {stale[:4]}"
        assert self.own_files() >= mine, "files of the user are gone"

    # Parameters, objects and code

    @rule(values=st.sampled_from(PARAMETERS))
    def set_parameter(self, values):
        set_parameters(self.folder, values)

    @rule(objects=st.sampled_from(SETS))
    def choose_objects(self, objects):
        write_catalogue(self.folder, objects)

    @rule(there=st.booleans())
    def bring_or_take_own_model(self, there):
        path = self.folder / OWN_MODEL
        path.parent.mkdir(exist_ok=True, parents=True)
        path.unlink(missing_ok=True)
        if there:
            shutil.copy(self.box, path)

    @rule(back=st.booleans())
    def edit_source(self, back):
        original = (self.starts["plain"].folder / MESH).read_bytes()
        other = (self.folder / OTHER_MESH).read_bytes()
        (self.folder / MESH).write_bytes(original if back else other)

    @rule(name=st.sampled_from(tuple(MODULES)), value=st.integers(0, 2), is_old=st.booleans())
    def edit_module(self, name, value, is_old):
        path = self.module(name)
        text = path.read_text().partition("\nVALUE = ")[0].rstrip("\n")
        path.write_text(f"{text}\nVALUE = {value}\n" if value else f"{text}\n")
        if is_old:
            os.utime(path, (TIMES["long ago"],) * 2)

    @rule(name=st.sampled_from(SCRIPTS), version=st.integers(0, 1))
    def edit_script(self, name, version):
        (self.folder / f"workflow/scripts/{name}.py").write_text(stand_in(name, version))

    @rule(is_used=st.booleans())
    def use_plug_in(self, is_used):
        for name in BESIDE:
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if not path.exists():
                path.write_text(PLUG_IN_TEXT if name == PLUG_IN else "0\n")
        set_parameters(self.folder, WITH_PLUG_IN if is_used else WITHOUT_PLUG_IN)

    @precondition(lambda self: (self.folder / PLUG_IN).exists())
    @rule(name=st.sampled_from(BESIDE), value=st.integers(1, 3))
    def edit_plug_in_or_a_file_beside(self, name, value):
        text = PLUG_IN_TEXT if name == PLUG_IN else ""
        (self.folder / name).write_text(f"{text}# {value}\n")

    @rule(conditions=st.sampled_from(("", *CONDITIONS)), is_listed=st.booleans())
    def write_study(self, conditions, is_listed):
        """Write or delete a study, and let every run measure the study or only a request."""
        path = self.folder / STUDY
        path.unlink(missing_ok=True)
        if conditions:
            path.write_text(conditions)
        studies = ["palm"] if is_listed and conditions else []
        set_parameters(self.folder, {"workflow": {"studies": studies}})

    @precondition(lambda self: (self.folder / STUDY).exists())
    @rule()
    def run_study(self):
        self.run("study_palm")

    # Damage

    @rule(
        how=st.sampled_from(("delete", "cut", "swap", "edit", "age", "future")),
        of=st.sampled_from(("table", "table", "record", "store")),
        index=st.integers(0, 1000),
    )
    def damage(self, how, of, index):
        """Do something to one table, record or file of the store, which may be a link to DVC's cache: so replace it."""
        files = {
            "table": lambda: sorted(map(self.folder.joinpath, digests(self.folder))),
            "record": self.records,
            "store": self.stored,
        }[of]()
        if not files:
            return
        file = files[index % len(files)]
        note(f"{how} {file.relative_to(self.folder)}")
        content = file.read_bytes()
        if how in {"age", "future"}:
            os.utime(file, (TIMES["long ago" if how == "age" else "future"],) * 2)
            return
        file.unlink()
        if how == "cut":
            file.write_bytes(content[: len(content) // 2])
        if how == "edit":
            file.write_bytes(content + b" ")
        if how == "swap":
            other = files[(index + 1) % len(files)]
            file.write_bytes(other.read_bytes() if other.exists() else b"")

    @rule(folder=st.sampled_from(FOLDERS))
    def delete_folder(self, folder):
        shutil.rmtree(self.folder / folder, ignore_errors=True)

    @rule(
        phase=st.sampled_from(("fixations", "touches", "features")),
        values=st.sampled_from(PARAMETERS),
    )
    def lose_phase(self, phase, values):
        """Change a parameter and delete all outputs and records of a phase, as Snakemake does when its jobs fail."""
        self.set_parameter(values)
        tables = {
            "fixations": ("views", "fixations", "effects/views"),
            "touches": ("touches", "policy_fixations", "effects/touches"),
            "features": ("features",),
        }[phase]
        for name in (*tables, f"records/{phase}"):
            shutil.rmtree(self.folder / "results" / name, ignore_errors=True)

    @rule(
        what=st.sampled_from(("results", "sources", "both")),
        when=st.sampled_from((*TIMES, "any order")),
    )
    def set_clock(self, what, when):
        places = {"results": ("results", "reports"), "sources": ("src", "meshes", "workflow")}
        folders = [
            folder for name, some in places.items() if what in {name, "both"} for folder in some
        ]
        files = sorted(
            file for name in folders for file in (self.folder / name).rglob("*") if file.is_file()
        )
        for number, file in enumerate(files):
            # Any order, but the same in each run of the example.
            seconds = int(hashlib.sha256(str(number).encode()).hexdigest()[:6], 16)
            time = TIMES.get(when, 1_000_000_000 + seconds)
            os.utime(file, (time, time))

    @rule(variables=st.sampled_from(FOREIGN))
    def enter_environment(self, variables):
        """Go on in a shell that a job or a notebook of another run started."""
        self.foreign = {**variables, **{k: v for k, v in self.foreign.items() if k == "PYTHONPATH"}}

    @rule(is_other=st.booleans())
    def change_version(self, is_other):
        other = self.folder / ".other" / "pywavelets-99.dist-info"
        other.mkdir(parents=True, exist_ok=True)
        (other / "METADATA").write_text("Metadata-Version: 2.1\nName: PyWavelets\nVersion: 99\n")
        self.foreign.pop("PYTHONPATH", None)
        if is_other:
            self.foreign["PYTHONPATH"] = str(other.parent)

    @rule()
    def keep_own_files(self):
        for name in ("features/mine.parquet", "touches/mine/mine.parquet"):
            file = self.folder / "results" / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("mine")

    # Git and DVC

    @precondition(lambda self: self.is_repository)
    @rule(command=st.sampled_from(DVC))
    def use_dvc(self, command):
        words = command.split()
        done = (
            self.command(*words) if words[0] == "dvc" else self.experiment.run(*words, check=False)
        )
        self.counts[f"{command}: {'refused' if done.returncode else 'done'}"] += 1
        if done.returncode:
            return
        if "--queue" in words:
            self.command("dvc", "exp", "run", "--run-all")
        elif command in CHECKED:
            # Before an experiment, DVC makes its folders as they are committed, without other files.
            self.mine = self.own_files()
            self.check("all")

    def ask(self, question):
        """Return what `make why` or `make verify` prints."""
        words = ("snakemake", "--list-rules", "--quiet", "--workflow-profile", "none")
        return self.command(*words, VISUOHAPTIC_ASKED=question).stdout

    def own_and_results(self):
        """Return the paths of all files under results."""
        files = (self.folder / "results").rglob("*.*")
        return {str(file.relative_to(self.folder)) for file in files}

    def own_files(self):
        return {*(self.folder / "results").rglob("mine.parquet")}

    def module(self, phase):
        return self.folder / "src" / f"{MODULES[phase].replace('.', '/')}.py"

    def stored(self):
        return sorted(file for file in (self.folder / ".cache/tables").rglob("*") if file.is_file())

    def records(self):
        return sorted((self.folder / "results").glob("*records/**/*.json"))


def _is_of(file, names):
    """Tell whether a file, or a folder that it is in, is among names."""
    names = {*names}
    return file in names or any(str(parent) in names for parent in Path(file).parents)
