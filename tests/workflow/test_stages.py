"""Rule files, DVC stages and parameters name the same things."""

from importlib.util import find_spec
from pathlib import Path

import pytest
import yaml
from source_folders import SOURCES

from visuohaptic.pipeline import OF_OBJECT, PHASES
from visuohaptic.studies.registry import STUDIES
from visuohaptic_workflow.closure import Start, code_of

ROOT = Path(__file__).parents[2]
STAGES = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
SCRIPTS = {
    stage: [name for name in entry["deps"] if name.startswith("workflow/scripts/")]
    for stage, entry in STAGES.items()
}
STEPS = {
    step.name: Path(find_spec(step.work.partition(":")[0]).origin)
    for study in STUDIES
    for step in study.steps
}


def rules_of(stage):
    command = STAGES[stage]["cmd"].partition("--allowed-rules")[2].partition("--")[0]
    return set(command.split())


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_depends_on_every_module_that_its_scripts_run(stage):
    runs = tuple(phase.work.module for phase in OF_OBJECT if phase.name == stage)
    files = {
        file.relative_to(ROOT)
        for script in [*SCRIPTS[stage], *(STEPS[rule] for rule in rules_of(stage) & {*STEPS})]
        for file in code_of(Start(ROOT / script, runs), tuple(SOURCES)).files
    }
    named = [Path(dependency) for dependency in STAGES[stage]["deps"]]
    missing = [file for file in files if not {file, *file.parents} & set(named)]
    assert not missing


@pytest.mark.parametrize("phase", PHASES, ids=lambda phase: phase.name)
def test_a_stage_names_the_parameters_and_tables_of_its_phase(phase):
    entry = STAGES[phase.name]
    aside = {"plugins", *({"probing.strategies"} if phase.name == "recognition" else ())}
    named = {name for name in entry["params"] if not name.startswith("workflow.")} - aside
    # Of a section of its own DVC sees what no job depends on, too.
    wide = {name for name in named if "." not in name}
    assert named - wide == {name for name in phase.sections() if name.partition(".")[0] not in wide}
    assert wide <= {name.partition(".")[0] for name in phase.sections()}
    folders = {f"results/{folder}" for folder in phase.writes.values()}
    assert set(entry["outs"]) == folders | {f"results/records/{phase.name}"}
    assert set(entry["deps"]) >= {f"results/{name}" for name in phase.reads}


# Other studies are made on request; studies/dvc.yaml has their stages.
ASIDE = {
    "workflow/scripts/gaze.py",
    "workflow/scripts/figures_of_study.py",
}


def test_every_script_belongs_to_a_stage():
    scripts = {str(file.relative_to(ROOT)) for file in (ROOT / "workflow/scripts").glob("*.py")}
    assert scripts - ASIDE == {script for scripts in SCRIPTS.values() for script in scripts}


def test_what_stages_depend_on_is_there_or_comes_from_a_stage_and_no_output_persists():
    outputs = {output for entry in STAGES.values() for output in entry["outs"]}
    needed = {dependency for entry in STAGES.values() for dependency in entry["deps"]}
    assert {name for name in needed - outputs if not (ROOT / name).exists()} == set()
    assert "persist" not in str(STAGES)
