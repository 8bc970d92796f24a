"""What Slurm says of a job is what Snakemake gets to know, and the groups of its profile fit every study."""

from pathlib import Path

import pytest
import yaml

from visuohaptic_workflow.slurm_status import judge, main

PROFILE = Path(__file__).parents[2] / "profiles/slurm/config.yaml"
STUDIES = (
    "settings_cost",
    "touch_curves",
    "variants",
    "ablations",
    "effects",
    "trust",
    "eye_and_touch",
)


@pytest.mark.workflow
def test_every_study_can_be_asked_for_with_the_groups_of_the_profile(fresh, open_folder):
    profile = yaml.safe_load(PROFILE.read_text())
    groups = [f"{rule}={group}" for rule, group in profile["groups"].items()]
    targets = [f"{study}_all" for study in STUDIES]
    planned = open_folder(fresh.folder, has_stand_ins=False)
    output = planned.snakemake("-n", "-q", "rules", "--groups", *groups, "--", *targets).stdout
    assert "figures_of_study" in output


@pytest.mark.parametrize(
    ("said", "state"),
    [
        ("COMPLETED", "success"),
        ("RUNNING", "running"),
        ("PENDING", "running"),
        ("TIMEOUT", "failed"),
    ],
)
def test_a_state_of_slurm_is_one_of_snakemakes(said, state):
    assert judge(f"JobId=7 JobName=a\n   JobState={said} Reason=None") == state


def test_a_job_that_is_held_as_it_could_not_be_launched_is_not_waited_for():
    assert judge("JobId=7\n   JobState=PENDING Reason=launch_failed_requeued_held") == "failed"


@pytest.mark.parametrize(
    ("error", "state"),
    [
        ("slurm_load_jobs error: Invalid job id specified", "failed"),
        ("slurm_load_jobs error: Unable to contact slurm controller", "running"),
    ],
)
def test_a_forgotten_job_has_failed_and_a_silent_controller_is_waited_for(
    tmp_path, monkeypatch, capsys, error, state
):
    program = tmp_path / "scontrol"
    program.write_text(f"#!/bin/sh\necho '{error}' >&2\nexit 1\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    main("7")
    assert capsys.readouterr().out == f"{state}\n"
