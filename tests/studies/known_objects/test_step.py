"""The step of study `known_objects`, from meshes to its two files."""

import json
from itertools import islice

import pytest
from studies.surfaces import RUN, small_surfaces, write_meshes

from known_objects.new_touches import make_known_objects
from known_objects.study import MOST_TOUCHES, STRATEGIES, STUDY, TURNS
from known_objects.tables import KNOWN_OBJECTS
from visuohaptic.base.errors import RecognitionError
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.recomputing import Sources, make_study_features
from visuohaptic.studies.refusals import ERROR
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table


def inputs(folder, made):
    outputs = [folder / "known_objects.parquet", folder / "known_objects.json"]
    return StepInputs(STUDY.name, {}, outputs, RUN, recomputed_features=made)


@pytest.mark.long
def test_a_ring_and_a_box_are_known_again_in_any_pose(tmp_path):
    # One object of each class: a class needs no second object here.
    surfaces = {key: surface for key, surface in small_surfaces().items() if key.endswith("0")}
    sources = Sources(write_meshes(tmp_path, surfaces))
    plan = plan_study(STUDY, RUN)
    assert len(plan.recomputations) == TURNS
    made = {}
    for key, recomputation in plan.recomputations.items():
        made[key] = tmp_path / f"{key}.parquet"
        make_study_features(recomputation, sources, made[key])
    step = inputs(tmp_path, made)
    make_known_objects(step)
    answers = read_table(KNOWN_OBJECTS, step.outputs[0])
    views = RUN.viewpoints.total
    assert answers.num_rows == 2 * TURNS * views * MOST_TOUCHES * len(STRATEGIES)
    for one in json.loads(step.outputs[1].read_text()):
        assert one["objects"] == ["box/box0", "ring/ring0"]
        assert one["views"] == [TURNS * views] * 2
        assert [row["touches"] for row in one["by_touches"]] == list(range(1, MOST_TOUCHES + 1))
        assert one["by_touches"][-1]["accuracy"] > 0.9


def test_refused_features_end_in_their_reason(tmp_path):
    made = dict.fromkeys(plan_study(STUDY, RUN).recomputations, tmp_path / "refused.parquet")
    refused = FEATURES.arrow.empty_table().replace_schema_metadata({ERROR: "No view shows it."})
    write_table(FEATURES, refused, next(islice(made.values(), 1)))
    with pytest.raises(RecognitionError, match="No view shows it"):
        make_known_objects(inputs(tmp_path, made))
