"""The adaptive strategy chooses split by split, the same each time."""

import pyarrow as pa
import pytest
from recognition.synthetic import PAPER_FEATURES, features_table
from studies.surfaces import RUN, small_surfaces, write_sources

from touch_curves import adaptive, learning
from touch_curves.adaptive import CANDIDATES, learning_rows, make_candidates
from touch_curves.choosing import ADAPTIVE
from touch_curves.learning import choose_in_split
from touch_curves.study import LONGEST_SEQUENCE, touches_name
from touch_curves.study import STUDY as TOUCH_CURVES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS, plan_study
from visuohaptic.studies.figures import cells_of
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES, OUT_OF_REACH
from visuohaptic.tables.schema import read_table

SMALL = ExperimentParameters.from_mapping(
    {
        "recognition": {
            "protocol": {"protocol": "leave_one_object_a_class_out", "maximum_splits": 6},
            "order_free": {"waves": 20},
        }
    }
)
PLANNED = plan_study(TOUCH_CURVES, SMALL).conditions
TABLE = features_table("adaptive", touches=8, viewpoints=2, separation=4.0)


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch):
    """Start no process; `test_learning` tests what it finds."""
    monkeypatch.setattr(learning, "choose_afresh", choose_in_split)


def cells(pipeline, counts):
    planned = [PLANNED[count - 1] for count in counts]
    return cells_of(pa.concat_tables(learning_rows(ADAPTIVE, TABLE, planned, pipeline)))


def test_a_curve_has_a_condition_a_number_of_touches_and_all_share_their_touches():
    plan = plan_study(TOUCH_CURVES, SMALL)
    assert len(plan.conditions) == LONGEST_SEQUENCE
    (recomputation,) = plan.recomputations.values()
    assert recomputation.parameters.attention.fixations == LONGEST_SEQUENCE
    assert recomputation.parameters.probing.when_exhausted == "begin_again"


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_a_longer_curve_begins_as_a_shorter_one_and_touches_tell_the_class(pipeline):
    longer, shorter = cells(pipeline, [1, 3, 4]), cells(pipeline, [1, 3])
    assert len(shorter) == 2
    for key, cell in shorter.items():
        assert cell.accuracy.tolist() == longer[key].accuracy.tolist()
    key = (touches_name(3), pipeline, "adaptive", HEADLINE_CLASSIFIERS[pipeline])
    assert longer[key].accuracy.mean() > 0.5


def test_each_condition_learns_its_number_of_touches_in_the_pipelines_columns(monkeypatch):
    seen, predict = set(), adaptive.predict_split

    def watch(sequences, *inputs):
        seen.add((sequences.features.shape[1], sequences.feature_names))
        return predict(sequences, *inputs)

    monkeypatch.setattr(adaptive, "predict_split", watch)
    cells("paper", [1, 3])
    assert seen == {(1, PAPER_FEATURES), (3, PAPER_FEATURES)}


def test_no_candidates_give_the_reason():
    rows = pa.concat_tables(
        learning_rows(ADAPTIVE, TABLE.slice(0, 0), PLANNED[:1], "paper")
    ).to_pylist()
    assert [row["accuracy"] for row in rows] == [None]
    assert rows[0]["error"].endswith(".")


def test_the_job_of_candidates_knows_what_is_done_with_places_out_of_reach():
    run = ExperimentParameters.from_mapping({"probing": {"unreachable": "keep"}})
    needed = run.model_dump(**TOUCH_CURVES.steps[0].needs)
    assert ExperimentParameters.from_mapping(needed).probing == run.probing


def test_candidates_are_some_of_the_objects_places(tmp_path):
    sources, _ = write_sources(tmp_path, small_surfaces())
    inputs = {"meshes": list(map(str, sources.meshes[:1]))}
    make_candidates(StepInputs("touch_curves", inputs, [str(tmp_path / "candidates")], RUN))
    found = read_table(FEATURES, tmp_path / "candidates")
    assert not {*found["contact_state"].to_pylist()} & {*OUT_OF_REACH}
    for viewpoint in range(4):
        count = found.filter(pa.compute.equal(found.column("viewpoint"), viewpoint)).num_rows
        assert CANDIDATES // 8 < count < CANDIDATES
