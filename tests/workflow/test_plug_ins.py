"""Plug-ins of the user: jobs run with them, and an edit of one reruns what uses it, and nothing else."""

import shutil
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from small_experiment import COPIED, SMALL_OBJECTS, copy_experiment
from workflow.experiments import SMALL

pytestmark = [pytest.mark.workflow, pytest.mark.long]

EXAMPLES = Path(__file__).parents[2] / "examples"
PLUG_INS = [path for path in EXAMPLES.glob("*.py") if "register(" in path.read_text()]
OURS = {
    **SMALL,
    "plugins": ["plug_ins/closest.py", "plug_ins/grid_means.py"],
    "probing": {"strategies": ["closest"]},
    "features": {"descriptor": "grid_means"},
}


@pytest.fixture(scope="module")
def experiment(open_folder, tmp_path_factory):
    folder = tmp_path_factory.mktemp("plug_ins") / "experiment"
    copy_experiment(folder, COPIED, SMALL_OBJECTS[:1], OURS)
    for name in ("closest", "grid_means"):
        shutil.copy(EXAMPLES / f"{name}.py", folder / "plug_ins")
    return open_folder(folder, has_stand_ins=False)


def touches_of(experiment):
    return pd.read_parquet(experiment.folder / "results/touches")


def test_a_run_with_plug_ins_is_done_once_and_again_from_the_phase_whose_plug_in_was_edited(
    experiment,
):
    experiment.snakemake("features_all")
    touched = touches_of(experiment)
    assert set(touched.strategy) == {"closest"}

    plug_in = experiment.folder / "plug_ins/grid_means.py"
    text = plug_in.read_text().replace(", dtype=float", "")
    plug_in.write_text(text.replace("part.mean", "part.max"))
    assert experiment.planned("features_all") == {"features": 1}

    plug_in = experiment.folder / "plug_ins/closest.py"
    plug_in.write_text(plug_in.read_text().replace("argsort(distances", "argsort(-distances"))
    planned = {"fixations": 1, "touches": 1, "features": 1}
    assert experiment.planned("features_all") == planned
    experiment.snakemake("features_all")
    assert experiment.planned("features_all") == {}
    assert not touches_of(experiment)[["x", "y", "z"]].equals(touched[["x", "y", "z"]])


def test_a_whole_run_is_planned_with_a_plug_in_of_each_kind(experiment, tmp_path):
    every = replace(experiment, folder=tmp_path / "every")
    copy_experiment(every.folder, COPIED, SMALL_OBJECTS, SMALL)
    for path in PLUG_INS:
        shutil.copy(path, every.folder / "plug_ins")
    every.set(
        plugins=[f"plug_ins/{path.name}" for path in PLUG_INS],
        attention={"weights": {"redness": 2.0}},
        scene={"zero_offset": 0.05},
        probing={"strategies": ["fixation", "closest"]},
        features={"descriptor": "grid_means"},
        recognition={
            "classifiers": ["extra_trees"],
            "self_organising_map": {"output": "principal"},
        },
    )
    planned = every.planned("all", "ablations_all")
    assert {"fixations", "touches", "features", "recognition", "report"} <= set(planned)
    assert planned["block_of_study"] > 1
