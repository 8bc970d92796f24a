"""A job leaves a log that a person and the report can read, and ends in one sentence."""

import logging
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from visuohaptic.base.errors import MeshError
from visuohaptic.io.job_logs import read_seconds, read_warnings
from visuohaptic_workflow.closing import lines_at_end
from visuohaptic_workflow.jobs import job, make_python_a_shell_word

ROOT = Path(__file__).parents[2]
PATHS = f"{ROOT / 'src'}:{ROOT / 'workflow/lib'}"


def logged_job(log):
    """Begin a job of stand-ins for what Snakemake gives a script: it leaves a record and no table."""
    record = str(log.with_name("record.json"))
    output = type("Output", (list,), {"record": record})([record])
    return job(SimpleNamespace(log=[str(log)], output=output, params={}))


@pytest.mark.parametrize("folder", ["/a b/bin", "/it's/bin", "/a&b/bin", "/$a/bin"])
def test_python_is_named_without_its_folder_where_a_shell_would_divide_the_path(
    monkeypatch, folder
):
    monkeypatch.setattr(sys, "executable", f"{folder}/python3")
    monkeypatch.setenv("PATH", "/usr/bin")
    make_python_a_shell_word()
    assert (sys.executable, os.environ["PATH"]) == ("python3", f"{folder}:/usr/bin")


def test_python_keeps_its_path_where_a_shell_takes_it_as_one_word(monkeypatch):
    monkeypatch.setattr(sys, "executable", "/a/bin/python3")
    monkeypatch.setenv("PATH", "/usr/bin")
    make_python_a_shell_word()
    assert (sys.executable, os.environ["PATH"]) == ("/a/bin/python3", "/usr/bin")


def run(program):
    subprocess.run([sys.executable, "-c", program], check=True, env={"PYTHONPATH": PATHS})


def test_a_job_that_ends_well_logs_its_seconds(tmp_path):
    with logged_job(tmp_path / "deep" / "a.log"):
        pass
    seconds = read_seconds(tmp_path / "deep" / "a.log")
    assert seconds.imports > 0
    assert seconds.work >= 0


@pytest.mark.parametrize(
    ("error", "sentence", "is_traced"),
    [
        (MeshError("a.obj is empty."), "error: a.obj is empty.\n", False),
        (ZeroDivisionError("oh"), "error: ZeroDivisionError: oh (see {})\n", True),
    ],
)
def test_an_error_is_one_sentence_and_only_the_log_has_the_traceback_of_an_unforeseen_one(
    tmp_path, capsys, error, sentence, is_traced
):
    log = tmp_path / "a.log"
    with pytest.raises(SystemExit) as caught, logged_job(log):
        raise error
    assert caught.value.code == 1
    assert capsys.readouterr().err == sentence.format(log)
    assert log.read_text().startswith(sentence.format(log))
    assert ("Traceback" in log.read_text()) == is_traced
    assert read_seconds(log) is None


def test_a_warning_is_said_once_at_the_end_of_a_run_however_often_jobs_log_it(
    tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    logs = [tmp_path / "a.log", tmp_path / "b.log", tmp_path / "missing.log"]
    for log in logs[:2]:
        with logged_job(log):
            for _ in range(2):
                logging.getLogger("visuohaptic.a").warning("cup/a is left out:\n%s", "too thin")
    assert capsys.readouterr().err == ""
    assert lines_at_end(logs, report_is_current=False) == ["warning: cup/a is left out: too thin"]
    assert read_seconds(logs[0]) is not None


def test_a_job_that_fails_says_its_warnings_with_its_error(tmp_path, capsys):
    def work():
        logging.getLogger("visuohaptic.a").warning("cup/a is left out")
        raise MeshError("no object is left.")

    log = tmp_path / "a.log"
    with pytest.raises(SystemExit), logged_job(log):
        work()
    assert capsys.readouterr().err == "error: no object is left.\nwarning: cup/a is left out\n"
    assert read_warnings([log]) == ["warning: cup/a is left out"]


def test_a_user_who_stops_a_job_while_its_script_imports_modules_sees_no_traceback():
    kill = "import os, signal; os.kill(os.getpid(), signal.SIGINT)"
    for script in sorted((ROOT / "workflow/scripts").glob("*.py")):
        above = script.read_text().partition("# isort: split\n")[0]
        assert "import visuohaptic_workflow.start_of_job" in above, script
    ended = subprocess.run(
        [sys.executable, "-c", above + kill], check=False, env={"PYTHONPATH": PATHS},
        text=True, capture_output=True,
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) == (-signal.SIGINT, "")
    # At work the job removes its temporary files first.
    work = f"""{above}
from types import SimpleNamespace
from visuohaptic_workflow.jobs import job
with job(SimpleNamespace(log=["/dev/null"], output=[], params={{}})):
    try:
        {kill}
    finally:
        print("tidied up")
"""
    ended = subprocess.run(
        [sys.executable, "-c", work], check=False, env={"PYTHONPATH": PATHS},
        text=True, capture_output=True,
    )  # fmt: skip
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "tidied up\n", "")


def test_a_user_who_stops_a_job_during_a_late_import_sees_no_error(tmp_path):
    """Compiled modules end in ImportError then, and Open3D lists its memory when the process ends."""
    program = f"""
import atexit
from types import SimpleNamespace
from visuohaptic_workflow.jobs import job
atexit.register(print, "memory")
with job(SimpleNamespace(log=["{tmp_path}/a.log"], output=[], params={{}})):
    try:
        raise KeyboardInterrupt
    except KeyboardInterrupt as error:
        raise ImportError("initialization failed") from error
"""
    ended = subprocess.run(
        [sys.executable, "-c", program], check=False, env={"PYTHONPATH": PATHS},
        text=True, capture_output=True,
    )  # fmt: skip
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")


def test_a_step_of_a_study_knows_pyarrow_before_its_job_begins_which_keeps_pandas_out():
    script = (ROOT / "workflow/scripts/study_step.py").read_text()
    above = [line for line in script.splitlines() if re.match(r"(from|import) ", line)]
    run("\n".join([*above, "import sys", "assert 'pyarrow' in sys.modules"]))


def test_a_job_that_writes_a_table_does_not_pay_for_pandas(tmp_path):
    program = f"""
import sys
import pyarrow as pa
from pathlib import Path
sys.path.insert(0, {str(ROOT / "tests")!r})
from workflow.test_jobs import logged_job
with logged_job(Path({str(tmp_path / "a.log")!r})):
    table = pa.table({{"a": [1, 2]}})
    assert "pandas" not in sys.modules
assert table.to_pandas()["a"].sum() == 3
"""
    run(program)


LIGHT = {
    "credits": {"numpy", "pooch", "joblib", "requests"},
    "features_of_study": {"lxml", "sklearn"},
    "block_of_study": {"lxml"},
    "study_step": {"sklearn"},
    "report": {"sklearn"},
    "features": {"cv2"},
}


@pytest.mark.parametrize("script", LIGHT)
def test_a_script_imports_no_package_that_its_work_does_not_call(script):
    lines = (ROOT / f"workflow/scripts/{script}.py").read_text().splitlines()
    imports = "\n".join(line for line in lines if line.startswith(("import ", "from ")))
    run(
        f"{imports}\nimport sys\nfound = {LIGHT[script]} & {{*sys.modules}}\nassert not found, found"
    )
