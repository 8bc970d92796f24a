"""A run prints one line per job, says at its end where the report is, and keeps Snakemake's options as they are."""

import logging
import re
from uuid import uuid4

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from visuohaptic_workflow.progress import show_job_lines, spoken_time

LINE = re.compile(
    r"^\[(\d+) of (\d+)\] (.+?)(: \d+ s)?(; some [\d.]+ (?:s|min|h) left)?$", re.MULTILINE
)
OF_SNAKEMAKE = ("Finished jobid", "Select jobs to execute", "Execute ", "steps (")
AT_END = "Nothing to be done; the report is at reports/report.html."


@pytest.mark.workflow
def test_a_run_names_each_finished_job_and_its_end_the_report(stand_in):
    stand_in.set(seed=7)
    output = stand_in.snakemake().stdout
    assert not [said for said in OF_SNAKEMAKE if said in output]
    lines = LINE.findall(output)
    assert [int(count) for count, *_ in lines] == list(range(1, len(lines) + 1))
    assert {int(total) for _, total, *_ in lines} == {len(lines)}
    assert all(left for *_, left in lines[:-1])
    assert lines[-1][2:] == ("all", "", "")
    touching = [words for _, _, words, *_ in lines if words.startswith("touching ")]
    assert "touching bottle/bs0_yogurtBottle and 1 other, viewpoints 00-01" in touching
    (log,) = sorted((stand_in.folder / ".snakemake/log").iterdir())[-1:]
    assert "Finished jobid" in log.read_text()
    assert stand_in.snakemake().stdout.splitlines()[-1] == AT_END
    for arguments in (("-n",), ("meshes_all",)):
        assert "Nothing to be done (all" in stand_in.snakemake(*arguments).stdout


@pytest.mark.workflow
def test_a_failed_job_is_named_below_its_error_and_options_of_snakemake_count(stand_in):
    script = stand_in.folder / "workflow/scripts/metrics.py"
    good = script.read_text()
    script.write_text(good.replace("with job(snakemake):", "with job(snakemake):\n    1 / 0"))
    output = stand_in.snakemake("-k", check=False).stdout
    error = output.index("error: ZeroDivisionError: division by zero (see logs/metrics.log)")
    assert output.index("failed: summarising the scores") > error
    script.write_text(good)
    quiet = stand_in.snakemake("--quiet").stdout
    assert not LINE.findall(quiet)
    assert "the report is at reports/report.html." in quiet
    (stand_in.folder / "reports/report.html").unlink()
    verbose = stand_in.snakemake("--verbose").stdout
    assert not LINE.findall(verbose)
    assert "Finished jobid" in verbose


@pytest.mark.workflow
def test_a_user_who_stops_the_planning_of_a_run_sees_no_traceback(whole_stand_in, tmp_path):
    (tmp_path / "plug_in").mkdir()
    (tmp_path / "plug_in/stopping.py").write_text("raise KeyboardInterrupt\n")
    plug_in = f"plugins=[{tmp_path}/plug_in/stopping.py]"
    stopped = whole_stand_in.snakemake("-n", "--config", plug_in, check=False)
    assert stopped.returncode != 0
    assert stopped.stdout.splitlines()[-1] == "stopped."
    assert "Traceback" not in stopped.stdout


def sent(*events):
    """Send events to a logger with lines of jobs, and return what its stream printed."""
    logger, printed = logging.getLogger(str(uuid4())), []
    logger.setLevel(logging.INFO)
    handler = logging.StreamHandler()
    handler.emit = lambda record: printed.append(record.getMessage())
    logger.addHandler(handler)
    show_job_lines(logger, lambda message, wildcards: f"{message} {wildcards}", lambda: None)
    for message, fields in events:
        logger.info(message, extra=fields)
    return printed


def started(jobid, **wildcards):
    fields = {"jobid": jobid, "rule_msg": f"job {jobid}", "rule_name": "a", "wildcards": wildcards}
    return None, {"event": LogEvent.JOB_INFO, **fields}


def ended(jobid):
    return "Finished", {"event": LogEvent.JOB_FINISHED, "job_id": jobid}


def test_jobs_of_a_group_end_together_and_are_counted_one_by_one():
    progress = (None, {"event": LogEvent.PROGRESS, "done": 3, "total": 3})
    printed = sent(
        started(4), started(5), started(6, of="b"), ended(4), ended(5), ended(6), progress
    )
    assert [line.partition(":")[0] for line in printed if line.startswith("[")] == [
        "[1 of 3] job 4 {}",
        "[2 of 3] job 5 {}",
        "[3 of 3] job 6 {'of'",
    ]


def test_a_job_that_the_user_stopped_is_no_failure():
    failed = (None, {"event": LogEvent.JOB_ERROR, "jobid": 4})
    for how in ("returned non-zero exit status 130.", "died with <Signals.SIGINT: 2>."):
        stopped = (f"RuleException: Command 'a' {how}", {"event": LogEvent.ERROR})
        printed = sent(started(4), stopped, failed)
        assert not [line for line in printed if "failed: " in line or "RuleException" in line]
    crashed = ("RuleException: Command 'a' returned exit status 1.", {"event": LogEvent.ERROR})
    assert {"failed: job 4 {}", crashed[0]} <= {*sent(started(4), crashed, failed)}


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.2, "some 1 s"),
        (9, "some 9 s"),
        (44, "some 40 s"),
        (95, "some 2 min"),
        (7200, "some 2.0 h"),
    ],
)
def test_time_left_has_one_or_two_digits(seconds, words):
    assert spoken_time(seconds) == words
