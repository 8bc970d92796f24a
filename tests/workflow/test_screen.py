"""`make` shows a short screen: progress, what failed and why, and at the end what came out."""

import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from visuohaptic_workflow.closing import describe_results
from visuohaptic_workflow.screen import Screen


def record(level=logging.INFO, message="", **extra):
    made = logging.LogRecord("snakemake.logging", level, "", 0, message, None, None)
    made.__dict__.update(extra)
    return made


def show_all_steps(screen, total):
    for done in range(1, total + 1):
        screen.show(record(event="progress", done=done, total=total))


def test_without_a_terminal_progress_takes_ten_lines_at_most(capsys):
    show_all_steps(Screen(), 731)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 10
    assert lines[-1].startswith("731 of 731 jobs, ")


def test_on_a_terminal_progress_takes_one_line(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    screen = Screen()
    show_all_steps(screen, 50)
    screen.say("the end")
    written = capsys.readouterr().err
    assert written.count("\n") == 1
    assert written.endswith("\r\033[Kthe end\n")
    assert "[############............] 25 of 50 jobs" in written


def test_reasons_and_commands_stay_in_the_log(capsys):
    screen = Screen()
    screen.show(record(message="Building DAG of jobs..."))
    screen.show(record(event="job_info", jobid=3, rule_msg="touching a", rule_name="touches"))
    assert capsys.readouterr().err == ""


def test_the_screen_knows_whether_the_report_was_written():
    screen = Screen()
    screen.show(record(event="job_info", jobid=3, rule_msg=None, rule_name="metrics"))
    assert not screen.wrote_report
    screen.show(record(event="job_info", jobid=4, rule_msg=None, rule_name="report"))
    assert screen.wrote_report


def test_a_failed_job_is_named_with_its_log_and_not_explained_twice(capsys):
    screen = Screen()
    screen.show(record(event="job_info", jobid=3, rule_msg="touching a", rule_name="touches"))
    error = {"event": "job_error", "jobid": 3, "rule_name": "touches", "log": ["logs/a.log"]}
    screen.show(record(logging.ERROR, **error))
    screen.show(record(logging.ERROR, "RuleException:\nCalledProcessError", event="error"))
    assert capsys.readouterr().err == ""
    assert screen.failed == ["touching a: logs/a.log"]


def test_an_error_of_the_whole_run_is_shown(capsys):
    Screen().show(record(logging.ERROR, "WorkflowError:\nseed is -1", event="error"))
    assert capsys.readouterr().err == "WorkflowError:\nseed is -1\n"


def test_nothing_is_said_of_results_that_are_not_there(tmp_path):
    assert describe_results(tmp_path / "metrics.json", tmp_path / "report.html") == []


def run_screen(experiment, *arguments):
    paths = [str(experiment.folder / part) for part in ("src", "workflow/lib")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    return subprocess.run(
        [sys.executable, "-P", "-m", "visuohaptic_workflow.screen", "-j2", *arguments],
        cwd=experiment.folder, env=environment, check=False, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip


@pytest.mark.workflow
@pytest.mark.long
def test_the_end_names_figures_report_log_and_what_else_can_be_asked(experiment):
    experiment.set(recognition={"classifier": {"neighbours": 3}})
    for _ in range(2):  # with something to do, and with nothing
        result = run_screen(experiment)
        assert result.returncode == 0
        assert "Pipeline paper, " in result.stdout
        assert "eye fixations " in result.stdout
        assert "The report is at reports/report.html." in result.stdout
        assert "snakemake -j2 cost_all" in result.stdout
        assert len(result.stdout.splitlines()) < 25
        log = result.stdout.partition("Snakemake's log is ")[2].splitlines()[0].rstrip(".")
        assert "Building DAG" in (experiment.folder / log).read_text()
    # What another target makes has no figures; those of an earlier run are not its own.
    (experiment.folder / "results/meshes/chair/bsby_chair3/bsby_chair3.ply").unlink()
    for _ in range(2):
        result = run_screen(experiment, "--", "meshes_all")
        assert result.returncode == 0
        assert "Pipeline paper, " not in result.stdout
        assert "The report is at" not in result.stdout


@pytest.mark.workflow
def test_a_failed_job_ends_with_one_and_its_sentence_stands_once(experiment):
    script = experiment.folder / "workflow/scripts/metrics.py"
    script.write_text(
        "from visuohaptic.errors import ReportError\n"
        "from visuohaptic_workflow.jobs import job\n"
        "with job(snakemake):\n    raise ReportError('The scores are odd.')\n"
    )
    result = run_screen(experiment)
    assert result.returncode == 1
    assert result.stdout.count("The scores are odd.") == 1
    assert "summing up the scores: logs/metrics.log" in result.stdout
    assert "Traceback" not in result.stdout


@pytest.mark.workflow
def test_a_wrong_parameter_is_shown_and_ends_with_one(experiment):
    experiment.set(sensor={"largest_size": -1})
    result = run_screen(experiment)
    assert result.returncode == 1
    assert "sensor.largest_size is -1: input should be greater than 0" in result.stdout


@pytest.mark.workflow
@pytest.mark.long
def test_snakemake_itself_ends_with_the_figures_where_the_report_was_written(experiment):
    experiment.set(recognition={"intervals": {"confidence": 0.9}})
    output = experiment.snakemake().stdout
    assert "Pipeline paper, " in output
    assert "The report is at reports/report.html." in output
    assert "The report is at" not in experiment.snakemake("--", "model_all").stdout
