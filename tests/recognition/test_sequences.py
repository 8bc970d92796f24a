"""From a table to sequences."""

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import PAPER_FEATURES, features_table, with_column

from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import (
    classes_of_two,
    gather_any,
    gather_pipeline,
    gather_sequences,
    shuffle_touches,
    take_strategy,
    viewpoints_of_all,
    whole_sequences,
)
from visuohaptic.tables.schema import matrix

CONTOURLETS, POINT, NORMAL = PAPER_FEATURES[:16], PAPER_FEATURES[16:19], PAPER_FEATURES[19:]


@pytest.mark.parametrize(
    ("cues", "names"),
    [
        (("cutaneous", "kinesthetic"), PAPER_FEATURES),
        (("kinesthetic",), (*POINT, *NORMAL)),
        (("position",), ("x", "y", "z")),
        (("normal",), ("normal_x", "normal_y", "normal_z")),
        (("normal", "position"), (*POINT, *NORMAL)),
        (("kinesthetic", "position"), (*POINT, *NORMAL)),
        (("position", "cutaneous"), (*CONTOURLETS, *POINT)),
    ],
)
def test_cues_of_the_papers_pipeline_are_columns_in_one_order(cues, names):
    table = features_table(objects=(2, 2))
    gathered = gather_pipeline(table, RecognitionParameters(cues=cues), "paper")
    assert gathered.feature_names == names
    expected = gather_sequences(table, names, 5)
    np.testing.assert_array_equal(gathered.features, expected.features)


def test_rows_come_back_as_sequences_or_their_first_touches_whatever_their_order():
    table = features_table(objects=(2, 3), viewpoints=3)
    shuffled = table.take(np.random.default_rng(0).permutation(table.num_rows))
    sequences = gather_sequences(shuffled, PAPER_FEATURES, None)
    expected = matrix(table, PAPER_FEATURES).reshape(15, 5, 22)
    np.testing.assert_array_equal(sequences.features, expected)
    first = gather_sequences(shuffled, PAPER_FEATURES, 3)
    np.testing.assert_array_equal(first.features, expected[:, :3])
    assert sequences.classes == ("class0", "class1")
    assert sequences.labels.tolist() == [0] * 6 + [1] * 9
    assert sequences.viewpoint.tolist() == [0, 1, 2] * 5


# Without touches 3, 4 of one sequence and 0, 1, 2 of the next the rows still count 0 … 4.
@pytest.mark.parametrize("dropped", [[0], [2], [4], [39], [3, 4, 5, 6, 7]])
def test_missing_touch_is_named(dropped):
    table = features_table(objects=(1, 1))
    kept = table.take([row for row in range(table.num_rows) if row not in dropped])
    with pytest.raises(RecognitionError, match=r"viewpoint \d, has the touches .* 0 to 4, once"):
        gather_sequences(kept, PAPER_FEATURES, 5)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("gather", [gather_sequences, gather_any])
def test_value_that_is_not_finite_is_named(gather, value):
    table = features_table(objects=(1,))
    column = table.column("contourlet_03").to_numpy().copy()
    column[7] = value
    with pytest.raises(RecognitionError, match=r"class0/object0 has contourlet_03 = .* at touch 2"):
        gather(with_column(table, "contourlet_03", column), ["contourlet_03"], 5)


def test_a_view_with_more_touches_than_a_sequence_gives_whole_ones_alone():
    table = features_table(objects=(1,), touches=7, viewpoints=3)
    (found,) = gather_any(table, ("x", "y"), 5)
    (touched,) = gather_any(table, ("x", "y"), 7)
    np.testing.assert_array_equal(found[::2], touched[:, :5])
    np.testing.assert_array_equal(found[1::2], touched[:, 2:])


MIXED = ["random"] * 10 + ["fixation"] * 30


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda table: with_column(table, "strategy", MIXED), "exactly one"),
        (lambda table: table.slice(0, 0), "hold no touches"),
        (lambda table: table.drop_columns(["contourlet_02"]), "lack the columns contourlet_02"),
    ],
)
@pytest.mark.parametrize("gather", [gather_sequences, gather_any])
def test_two_strategies_none_and_a_missing_column_are_named(gather, change, reason):
    table = features_table(objects=(1, 1), viewpoints=4)
    with pytest.raises(RecognitionError, match=reason):
        gather(change(table), PAPER_FEATURES, 5)


def test_touches_of_two_objects_and_a_strategy_without_touches_are_named():
    table = features_table(objects=(1, 1))
    with pytest.raises(RecognitionError, match="class0/object0, class1/object0; one object"):
        gather_any(table, PAPER_FEATURES, 5)
    with pytest.raises(
        RecognitionError, match="no touch by random; touches by fixation can be used"
    ):
        take_strategy(table, "random", 5)


def test_a_class_with_a_single_object_is_left_out():
    features = pa.table(
        {"class": ["cup", "cup", "chair", "chair", "lamp"], "object": ["a", "a", "b", "c", "a"]}
    )
    assert classes_of_two(features).column("object").to_pylist() == ["b", "c"]


@pytest.mark.parametrize("touches", [5, None])
def test_a_sequence_with_too_few_touches_is_left_out_of_its_own_strategy_only(touches):
    whole = features_table("random", objects=(2, 2), viewpoints=3)
    short = features_table("fixation", objects=(2, 2), viewpoints=3)
    kept_rows = [row for row in range(short.num_rows) if row not in (3, 4, 10, 11, 12, 13, 14)]
    both = pa.concat_tables([whole, short.take(kept_rows)])
    kept, (sentence,) = whole_sequences(both, touches)
    assert sentence == (
        "class0/object0 is left out of recognition by fixation from viewpoint 0, because fewer than 5 places were in "
        "reach; recognition.touches: 3 keeps it."
    )
    left = {"random": [0, 1, 2] * 4, "fixation": [1, *[0, 1, 2] * 3]}
    for strategy, viewpoints in left.items():
        mine = kept.filter(pa.compute.equal(kept["strategy"], strategy))
        assert gather_sequences(mine, PAPER_FEATURES, 5).viewpoint.tolist() == viewpoints
        taken, _ = take_strategy(both, strategy, touches)
        assert taken.num_rows == 5 * len(viewpoints)


def test_viewpoints_of_all_are_those_from_which_every_strategy_touched():
    one, other = (features_table(name, objects=(2, 2), viewpoints=3) for name in ("a", "b"))
    shared = viewpoints_of_all(pa.concat_tables([one, other.slice(10)]))
    assert shared.num_rows == 2 * (one.num_rows - 10)
    first = shared.filter(pa.compute.equal(shared["object"], "object0"))
    assert set(
        first.filter(pa.compute.equal(first["class"], "class0"))["viewpoint"].to_pylist()
    ) == {2}


def test_fewer_touches_may_be_enough_and_none_are_no_error():
    table = features_table(objects=(2, 2)).slice(0, 78)
    for kept, touches in ((table, 3), (table.slice(0, 0), 5)):
        assert whole_sequences(kept, touches) == (kept, ())
    assert len(whole_sequences(table, 4)[1]) == 1


def test_shuffled_touches_stay_whole_and_with_their_sequence():
    kept = gather_sequences(features_table(touches=5), PAPER_FEATURES, 5)
    orders = set()
    for before, after in zip(kept.features, shuffle_touches(kept, 3).features, strict=True):
        assert sorted(before.tolist()) == sorted(after.tolist())
        orders.add(tuple(before.tolist().index(touch) for touch in after.tolist()))
    assert len(orders) > 20


def test_an_order_depends_on_the_seed_the_object_and_the_viewpoint_alone():
    kept = gather_sequences(features_table(), PAPER_FEATURES, 5)
    whole = shuffle_touches(kept, 3).features
    some = kept.object_index % 2 == 1
    np.testing.assert_array_equal(shuffle_touches(kept.take(some), 3).features, whole[some])
    assert not np.array_equal(shuffle_touches(kept, 4).features, whole)
    other = gather_sequences(features_table("random"), PAPER_FEATURES, 5)
    np.testing.assert_array_equal(shuffle_touches(other, 3).features, whole)
