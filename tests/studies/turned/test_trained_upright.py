"""Training on upright objects and testing turned objects: no object trains and is tested in one split."""

import pyarrow as pa
import pyarrow.compute as pc
from recognition.synthetic import features_table
from studies.surfaces import RUN

from turned.study import STUDY, name_of
from turned.trained_upright import predict_turned
from visuohaptic.studies.conditions import plan_study, with_changes
from visuohaptic.studies.measuring import condition_features

TRIED = with_changes(RUN, {"recognition.touches": 2})


def planned():
    wanted = name_of("any", 0, "full", TRIED.recognition.touches)
    return next(one for one in plan_study(STUDY, TRIED).conditions if one.condition.name == wanted)


def test_only_upright_objects_train_and_only_turned_ones_are_tested():
    upright = features_table(objects=(3, 3, 3), touches=2)
    moved = upright.set_column(
        upright.column_names.index("y"), "y", pc.add(upright.column("y"), 100.0)
    ).cast(upright.schema)
    # Of a view that lacks a touch no row is left, and the columns of the others may be of another kind.
    short = condition_features(planned(), moved.slice(1), "fixation")
    assert short.num_rows == moved.num_rows - 2
    found = predict_turned(planned(), upright, short, TRIED)
    height = found.sequences.features[:, :, found.sequences.feature_names.index("y")].mean(axis=1)
    for one in found.splits:
        train, test = one.split.train, one.split.test
        assert (height[train] < 50).all()
        assert (height[test] > 50).all()
        owners = found.sequences.object_index
        assert not set(owners[train]) & set(owners[test])
        assert len(train)
        assert len(test)
    assert found.sequences.viewpoint.max() == 3


def test_the_same_objects_in_both_poses_are_recognised_as_without_turning():
    upright = features_table(objects=(3, 3, 3), touches=2)
    found = predict_turned(planned(), upright, upright, TRIED)
    tested = pa.concat_arrays(
        [pa.array(one.predicted == found.sequences.labels[one.split.test]) for one in found.splits]
    )
    assert pc.mean(tested.cast(pa.float64())).as_py() > 0.9
