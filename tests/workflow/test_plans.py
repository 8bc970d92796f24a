"""A change reruns the phase that it is about and what follows, and nothing else, whatever the times say."""

import json
import sys
from pathlib import Path

import pytest
import yaml
from workflow.plans import CHANGES

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).parents[2]
STAGES = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
PHASES = ("meshes", "fixations", "touches", "features", "recognition", "metrics", "report")
# The first phase that runs, and how many of its jobs; of two blocks of objects and two strategies.
FIRST = {
    "nothing": (None, 0),
    "touched files": (None, 0),
    "meshes": ("meshes", 2),
    "viewpoints": ("fixations", 2),
    "rendering": ("fixations", 2),
    "attention": ("fixations", 2),
    "probing": ("fixations", 2),
    "sensor": ("touches", 2),
    "scene": ("touches", 2),
    "a scene to see": ("fixations", 2),
    "features": ("features", 2),
    "recognition": ("recognition", 2),
    "seed": ("fixations", 2),
    "workflow": ("meshes", 4),
    "views a job": ("fixations", 4),
    "another mesh": ("meshes", 1),
    "columns of the shape": ("meshes", 2),
    "other columns": ("report", 1),
    "a credit": ("report", 1),
    "a script": ("recognition", 2),
    "meshes/preparing": ("meshes", 2),
    "attention/saliency": ("fixations", 2),
    "sensor/placing": ("touches", 2),
    "contourlets/directional": ("features", 2),
    "recognition/classifiers": ("recognition", 2),
    "recognition/metrics": ("metrics", 1),
}
# A lost or edited table is made again, and comes out as it was.
ALONE = {
    "an edited table": {"features": 1},
    "no mesh": {"meshes": 1},
    "no views": {"fixations": 1},
    "no effects": {"touches": 1},
    "no plot": {"metrics": 1},
    "no report": {"report": 1},
}


@pytest.fixture(scope="module")
def plans(finished, tmp_path_factory):
    experiment = finished.copy(tmp_path_factory.mktemp("plans") / "experiment")
    tests = f"PYTHONPATH={ROOT / 'tests'}"
    found = experiment.run("env", tests, sys.executable, "-P", "-m", "workflow.plans")
    return json.loads(found.stdout)


@pytest.mark.parametrize("name", FIRST)
def test_what_runs_begins_with_the_phase_that_a_change_is_about(plans, name):
    stale = plans[name]["stale"]
    first, count = FIRST[name]
    expected = set(PHASES[PHASES.index(first) :]) if first else set()
    assert set(stale) & set(PHASES) == expected
    assert stale.get(first, 0) == count
    if first in {None, "report"}:
        assert sum(stale.values()) == count


@pytest.mark.parametrize("name", ALONE)
def test_a_table_that_is_lost_or_edited_is_made_again_alone(plans, name):
    assert plans[name]["stale"] == ALONE[name]


def rules_of(stage):
    command = STAGES[stage]["cmd"].partition("--allowed-rules")[2].partition("--")[0]
    return set(command.split())


@pytest.mark.parametrize("name", [name for name in CHANGES if CHANGES[name].config])
def test_a_stage_names_the_sections_whose_change_moves_its_rules(plans, name):
    (section,) = CHANGES[name].config
    for stage, entry in STAGES.items():
        named = any(path.partition(".")[0] == section for path in entry["params"])
        assert named or not set(plans[name]["moved"]) & rules_of(stage), stage


def test_every_change_is_planned():
    assert {*FIRST, *ALONE} == set(CHANGES)
