"""Run `snakemake`, `dvc` and questions about an experiment in forks of one process that imported all.

A command that way costs a fraction of a second instead of seconds, so that a test can run hundreds. Of an experiment of
stand-ins everything is real but two things: a job's script runs in the process of Snakemake, and the value of a module
that a stand-in imports is read from the text of the module. Bytecode and imports are tested with real processes, in
`test_states.py`. Real scripts run in forks, too: they import the experiment's own modules, and find packages of others
imported.

Jobs can be disturbed: variable `FAULT` of the environment is JSON with the fields of `Fault`.
"""

from __future__ import annotations

import atexit
import importlib
import json
import os
import re
import runpy
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from functools import partial
from importlib import import_module
from pathlib import Path

from workflow.experiments import Experiment
from workflow.shim import ask

from visuohaptic.base.quick_imports import quick_imports
from visuohaptic_workflow.code_of_jobs import imports_of

FAULT = "TEST_FAULT"
SERVER = "TEST_SERVER"
CLONE = "TEST_CLONE"
PARENT = "TEST_PARENT"
REAL = "TEST_REAL"
COMMANDS = ("snakemake", "dvc")
IMPORTED = (
    "dvc.cachemgr", "dvc.cli", "dvc.data_cloud", "dvc.lock", "dvc.repo", "dvc.repo.experiments", "dvc.repo.index",
    "dvc.repo.plots", "dvc.rwlock", "dvc.scm", "requests", "scmrepo.git", "smart_open", "snakemake.cli",
    "visuohaptic.phases", "visuohaptic_workflow.closing", "visuohaptic_workflow.jobs", "workflow.clean_runs",
)  # fmt: skip
IMPORTED_BY_SCRIPTS = (
    "cv2", "jinja2", "lxml.etree", "matplotlib.figure", "matplotlib.backends.backend_svg", "PIL.Image", "pywt",
    "scipy.optimize", "scipy.spatial", "scipy.stats", "sklearn.discriminant_analysis", "sklearn.naive_bayes",
    "sklearn.neighbors", "sklearn.svm", "sklearn.tree", "trimesh", "visuohaptic.geometry.compiled_open3d",
)  # fmt: skip
OURS = {"visuohaptic", "visuohaptic_workflow", "contourlets", "meshreaders"}
TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent


@dataclass(frozen=True)
class Fault:
    """What happens while the job with number `job` (from 1 on) of a run works.

    `kind` is ``fail`` (the job raises an error), ``kill`` (all processes of the run end at once, with half of the job's
    tables written) or ``write`` (`text` is appended to `file`, as by a user who saves during a run).
    """

    kind: str
    job: int
    file: str = ""
    text: str = ""

    @property
    def environment(self):
        return {FAULT: json.dumps(asdict(self))}


@dataclass(frozen=True)
class QuickExperiment(Experiment):
    """An experiment whose `snakemake` and `dvc` run in forks of a server; `inspect` answers as `clean_runs` says.

    Where `has_stand_ins` is False, each script runs in a fork of the server. `clone` is the folder of the code, if this
    folder has none.
    """

    server: Path = Path()
    has_stand_ins: bool = True
    clone: Path | None = None

    def run(self, *command, check=True, **more):
        if command[0] not in COMMAND_OF:
            return super().run(*command, check=check, **more)
        environment = {**self.environment, **more, SERVER: str(self.server)}
        if not self.has_stand_ins:
            environment[REAL] = "1"
        if self.clone:
            environment[CLONE] = str(self.clone)
        environment["PATH"] = f"{self.server.parent}/bin{os.pathsep}{environment['PATH']}"
        answer = ask(self.server, command, self.folder, environment)
        if check and answer.returncode:
            raise AssertionError(f"{' '.join(command)} failed:\n{answer.stdout[-5000:]}")
        return answer

    def snakemake(self, *arguments, check=True):
        """Run Snakemake. Stand-ins run in the process of Snakemake, one at a time."""
        jobs = "-j1" if self.has_stand_ins else "-j2"
        return self.run("snakemake", jobs, *arguments, check=check)


@contextmanager
def serving():
    """Start a server, and yield a function that returns the `QuickExperiment` of a folder."""
    with tempfile.TemporaryDirectory() as folder:
        address = Path(folder) / "socket"
        for name in COMMANDS:
            shim = Path(folder) / "bin" / name
            shim.parent.mkdir(exist_ok=True)
            shim.write_text(
                f"#!{sys.executable} -SE\nimport sys\nsys.path.insert(0, {str(TESTS)!r})\n"
                f"from workflow.shim import run\nrun({name!r}, {str(address)!r})\n"
            )
            shim.chmod(0o755)
        paths = (
            TESTS,
            *(
                ROOT / name
                for name in (
                    "src",
                    "packages/contourlets/src",
                    "packages/meshreaders/src",
                    "workflow/lib",
                )
            ),
        )
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, paths))}
        command = (sys.executable, "-m", "workflow.quick_commands", str(address))
        with subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, text=True
        ) as server:
            server.stdout.readline()  # it listens
            try:
                yield partial(QuickExperiment, server=address)
            finally:
                server.terminate()


def serve(address):
    """Import what commands need, then fork a process per command, until this process is terminated."""
    with quick_imports():  # without pandas, as scripts
        for module in (*IMPORTED, *IMPORTED_BY_SCRIPTS):
            import_module(module)
    # The parsers of the command lines import all commands and plug-ins, half of the time of a dry run.
    import_module("snakemake.cli").get_argument_parser()
    import_module("dvc.cli.parser").get_main_parser()
    # A copy of the experiment has new files, whose imports no folder's cache has.
    for folder in ("src", "packages", "workflow", "studies"):
        for file in ROOT.joinpath(folder).rglob("*.py"):
            imports_of(file)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(address)
        listening.listen()
        sys.stdout.write("listens\n")
        sys.stdout.flush()
        while True:
            connection, _ = listening.accept()
            if os.fork() == 0:
                signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                listening.close()
                answer_request(connection)
                os._exit(0)
            connection.close()


def answer_request(connection):
    """Run the command of a request in a fork, and send its return code and output."""
    with connection, connection.makefile("rw") as stream, tempfile.TemporaryFile() as output:
        request = json.loads(stream.readline())
        pid = os.fork()
        if pid == 0:
            os.dup2(output.fileno(), 1)
            os.dup2(output.fileno(), 2)
            run_request(**request)
        _, status = os.waitpid(pid, 0)
        output.seek(0)
        text = output.read().decode(errors="replace")
        stream.write(json.dumps({"returncode": os.waitstatus_to_exitcode(status), "stdout": text}))
        stream.write("\n")


def run_request(argv, folder, environment):
    """Run a command in this process, and end the process with the command's return code."""
    code = 1
    os.setsid()
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    if parent := os.environ.pop(PARENT, ""):
        os.getppid = lambda: int(parent)  # the run that waits for this process
    sys.argv = list(argv)
    sys.path[:0] = filter(None, environment.get("PYTHONPATH", "").split(os.pathsep))
    relocate_modules(environment.get(CLONE, folder))
    try:
        code = COMMAND_OF[argv[0]](argv[1:])
    except SystemExit as ended:
        code = ended.code
    except BaseException:  # noqa: BLE001 - printed as Python would
        sys.excepthook(*sys.exc_info())
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    atexit._run_exitfuncs()
    sys.stdout.flush()
    os._exit(code if isinstance(code, int) else int(bool(code)))


def relocate_modules(folder):
    """Let modules that this process imported have the paths of an experiment's own files, which keys name."""
    for name, module in [*sys.modules.items()]:
        if name.partition(".")[0] in OURS:
            spec = module.__spec__
            spec.origin = spec.origin and spec.origin.replace(str(ROOT), folder)
            if spec.submodule_search_locations:
                paths = [path.replace(str(ROOT), folder) for path in module.__path__]
                module.__path__ = spec.submodule_search_locations = paths


def run_snakemake(arguments):
    from snakemake.cli import main
    from snakemake.script import PythonScript

    PythonScript.execute_script = run_script_in_fork if REAL in os.environ else run_script_here
    answer_children()
    main(arguments)


def run_dvc(arguments):
    from dvc.cli import main

    answer_children()
    return main(arguments)


def run_inspection(arguments):
    from workflow.clean_runs import print_inspection

    print_inspection(arguments)
    return 0


def run_script(arguments):
    """Run a real script, which imports the modules of its own experiment."""
    for name in [*sys.modules]:
        if name.partition(".")[0] in OURS:
            del sys.modules[name]
    sys.argv = list(arguments)
    runpy.run_path(arguments[0], run_name="__main__")


COMMAND_OF = {
    "snakemake": run_snakemake, "dvc": run_dvc, "inspect": run_inspection, "script": run_script,
}  # fmt: skip


def answer_children():
    """Let the server run `python -m snakemake` and `python -m dvc`, which this process would start."""
    run = subprocess.run

    def run_by_server(command, *more, **options):
        if list(command[:2]) != [sys.executable, "-m"] or command[2] not in COMMANDS:
            return run(command, *more, **options)
        environment = {
            **(options.get("env") or os.environ),
            SERVER: os.environ[SERVER],
            PARENT: str(os.getpid()),
        }
        environment["PATH"] = os.environ["PATH"]
        answer = ask(os.environ[SERVER], command[2:], Path.cwd(), environment)
        if not options.get("capture_output"):
            sys.stderr.write(answer.stdout)
        return subprocess.CompletedProcess(command, answer.returncode, answer.stdout, answer.stdout)

    subprocess.run = run_by_server


def run_script_in_fork(script, name, edit=False):
    """Let the server run the script of a job, instead of Snakemake's `python <script>`."""
    environment = {**os.environ, PARENT: str(os.getpid())}
    answer = ask(os.environ[SERVER], ["script", name], Path.cwd(), environment)
    sys.stderr.write(answer.stdout)
    if answer.returncode:
        raise subprocess.CalledProcessError(answer.returncode, name)


started = 0
counting = threading.Lock()


def run_script_here(script, name, edit=False):
    """Run the script of a job in this process, instead of Snakemake's `python <script>`."""
    global started  # noqa: PLW0603 - jobs of a run are counted
    with counting:
        started += 1
        fault = json.loads(os.environ.get(FAULT, "null"))
        fault = Fault(**fault) if fault and fault["job"] == started else None
    importlib.import_module = module_as_text
    paths = [*sys.path]  # Snakemake's lines before the script extend them
    try:
        runpy.run_path(name, {"disturb": lambda files: disturb(fault, files)})
    except SystemExit as ended:
        if ended.code:
            raise subprocess.CalledProcessError(ended.code, name) from None
    finally:
        importlib.import_module = import_module
        sys.path[:] = paths


def module_as_text(name):
    """Return the value that a module of the experiment would define now."""
    code = Path(os.environ.get(CLONE, ""), "src")
    text = code.joinpath(*name.split(".")).with_suffix(".py").read_text()
    found = re.findall(r"^VALUE = (\d+)$", text, re.MULTILINE)
    return type("Module", (), {"VALUE": int(found[-1]) if found else 0})


def disturb(fault, files):
    """Do to a job that is about to write `files` what a fault says."""
    from visuohaptic.base.errors import VisuohapticError

    if fault is None:
        return
    if fault.kind == "write":
        with Path(fault.file).open("a") as stream:
            stream.write(fault.text)
    if fault.kind == "kill":
        half = [file for file in files if not Path(file).is_dir()]
        for file in half[: (len(half) + 1) // 2]:
            Path(file).write_text("half")
        os.killpg(0, signal.SIGKILL)
    if fault.kind == "fail":
        raise VisuohapticError("a job failed as a test wanted")


if __name__ == "__main__":
    serve(sys.argv[1])
