"""A change reruns the phase that it is about and what follows, and nothing else, whatever the times say."""

import json
import sys
from pathlib import Path

import pytest
from workflow.plans import CHANGES

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).parents[2]
PHASES = ("meshes", "fixations", "touches", "features", "recognition", "metrics", "report")


@pytest.fixture(scope="module")
def plans(finished, tmp_path_factory):
    experiment = finished.copy(tmp_path_factory.mktemp("plans") / "experiment")
    tests = f"PYTHONPATH={ROOT / 'tests'}"
    found = experiment.run("env", tests, sys.executable, "-P", "-m", "workflow.plans")
    return json.loads(found.stdout)


@pytest.mark.parametrize("name", CHANGES)
def test_what_runs_begins_with_the_phase_that_a_change_is_about(plans, name):
    stale, change = plans[name], CHANGES[name]
    assert stale.get(change.first, 0) == change.jobs
    if change.is_alone or change.first in {None, "report"}:
        assert sum(stale.values()) == change.jobs
    else:
        assert set(stale) & set(PHASES) == set(PHASES[PHASES.index(change.first) :])
