"""The groups of the Slurm profile fit every study: no job outside a group lies between two jobs of it."""

from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.workflow

PROFILE = Path(__file__).parents[2] / "profiles/slurm/config.yaml"
STUDIES = ("cost", "curves", "readings", "ablations", "effects", "certainty", "looking")


def test_every_study_can_be_asked_for_with_the_groups_of_the_profile(fresh):
    profile = yaml.safe_load(PROFILE.read_text())
    groups = [f"{rule}={group}" for rule, group in profile["groups"].items()]
    targets = [f"{study}_all" for study in STUDIES]
    output = fresh.snakemake("-n", "-q", "rules", "--groups", *groups, "--", *targets).stdout
    assert "figures_of_study" in output
