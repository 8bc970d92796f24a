"""Headline figures from answers that are counted by hand."""

import json

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import features_table

from visuohaptic import recognition
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.evaluation.summary import confusion, select, summarise
from visuohaptic.recognition.parameters import (
    IntervalParameters,
    ProtocolParameters,
    RecognitionParameters,
)
from visuohaptic.tables.phases import PREDICTIONS, SCORES
from visuohaptic.tables.schema import build_rows

PARAMETERS = RecognitionParameters(
    protocol=ProtocolParameters(protocol="leave_one_object_a_class_out", maximum_splits=6),
    classifiers=("k_nearest_neighbours", "naive_bayes"),
)
UNEVEN_FOLDS = PARAMETERS.model_copy(
    update={"protocol": ProtocolParameters(protocol="grouped_folds", folds=3, repeats=2)}
)


def both(*runs):
    return tuple(pa.concat_tables(parts) for parts in zip(*runs, strict=True))


def answers(named, strategy="fixation"):
    """Tables of one classifier from {(class, object): the classes predicted}."""
    keys = {"pipeline": "paper", "strategy": strategy, "classifier": "naive_bayes"}
    keys |= {"split": 0, "seed": 0}
    nothing = {"probability": None, "voted": None}
    rows = [
        keys | nothing | {"class": category, "object": name, "viewpoint": place, "predicted": one}
        for (category, name), predicted in named.items()
        for place, one in enumerate(predicted)
    ]
    right = float(np.mean([row["class"] == row["predicted"] for row in rows]))
    figures = {"accuracy": right, "object_accuracy": 0.0, "sequences": len(rows), "note": None}
    return build_rows(SCORES, [keys | figures]), build_rows(PREDICTIONS, rows)


@pytest.mark.parametrize(
    ("pipeline", "objects", "counts", "parameters"),
    [
        ("paper", (3, 3, 3), (6, 9, 36), PARAMETERS),
        ("order_free", (2, 4), (6, 6, 24), PARAMETERS),
        ("paper", (3, 5, 2), (3, 10, 40), UNEVEN_FOLDS),
    ],
)
def test_means_are_the_means_over_splits_whatever_the_classes_and_the_vote(
    pipeline, objects, counts, parameters
):
    runs = [
        recognition.run_pipeline(
            features_table(strategy, objects, separation=2, seed=seed), parameters, 1, pipeline
        )
        for seed, strategy in enumerate(("fixation", "random"))
    ]
    scores, predictions = both(*runs)
    results = summarise(scores, predictions)["results"][pipeline]
    assert set(results) == {"fixation", "random"}
    for strategy, cells in results.items():
        for classifier, cell in cells.items():
            rows = select(scores, strategy=strategy, classifier=classifier)
            for figure in ("accuracy", "object_accuracy"):
                mean = rows.column(figure).to_numpy().mean()
                assert cell[figure]["mean"] == pytest.approx(mean)
                assert cell[figure]["low"] <= mean <= cell[figure]["high"]
            assert (cell["splits"], cell["objects"], cell["sequences"]) == counts


def test_figures_counted_by_hand():
    scores, predictions = answers(
        {
            ("cup", "a"): ["cup", "cup", "cup", "car"],
            ("cup", "b"): ["car", "car", "car", "cup"],
            ("car", "c"): ["car", "car", "car", "cup"],
        }
    )
    cell = summarise(scores, predictions)["results"]["paper"]["fixation"]["naive_bayes"]
    assert cell["accuracy"]["mean"] == pytest.approx(7 / 12)
    assert cell["object_accuracy"]["mean"] == pytest.approx((1 + 0 + 1) / 3)
    assert cell["class_accuracy"]["cup"]["mean"] == pytest.approx(4 / 8)
    assert cell["class_accuracy"]["car"]["mean"] == pytest.approx(3 / 4)
    assert cell["balanced_accuracy"]["mean"] == pytest.approx((4 / 8 + 3 / 4) / 2)
    assert cell["class_accuracy"]["car"]["low"] is None
    counted = confusion(predictions)
    assert counted.classes == ("car", "cup")
    assert counted.counts.tolist() == [[3, 1], [4, 4]]


def test_comparison_is_fixation_minus_the_other_strategy():
    good = answers({("cup", "a"): ["cup"] * 4, ("car", "c"): ["car"] * 4})
    bad = answers(
        {("cup", "a"): ["cup", "cup", "car", "car"], ("car", "c"): ["car"] * 3 + ["cup"]},
        strategy="random",
    )
    compared = summarise(*both(good, bad))["comparisons"]["paper"]["naive_bayes"]
    assert compared["random"]["difference"]["mean"] == pytest.approx(3 / 8)
    assert compared["random"]["p_value"] >= 0.5
    assert compared["random"]["difference"] == {"mean": 0.375, "low": -1, "high": 1}
    assert compared["random"]["objects"] == 2


def test_a_comparison_weighs_objects_by_their_sequences():
    good = answers({("cup", "a"): ["cup"] * 6, ("car", "c"): ["car"] * 2})
    bad = answers({("cup", "a"): ["car"] * 6, ("car", "c"): ["car"] * 2}, strategy="random")
    compared = summarise(*both(good, bad))["comparisons"]["paper"]["naive_bayes"]
    assert compared["random"]["difference"]["mean"] == pytest.approx(6 / 8)


def test_a_comparison_weighs_objects_as_fixation_did():
    good = answers({("cup", "a"): ["cup"] * 6, ("car", "c"): ["car"] * 2})
    bad = answers({("cup", "a"): ["car"] * 3, ("car", "c"): ["car"] * 5}, strategy="random")
    compared = summarise(*both(good, bad))["comparisons"]["paper"]["naive_bayes"]
    assert compared["random"]["difference"]["mean"] == pytest.approx(6 / 8)


FIRST = answers({("cup", "a"): ["cup", "car"], ("cup", "d"): ["cup"], ("car", "c"): ["car"]})
SECOND = answers({("cup", "b"): ["cup"], ("car", "c"): ["car"]}, strategy="random")


def test_order_of_rows_changes_nothing_and_all_of_it_is_json():
    other = answers({("cup", "a"): ["car"], ("cup", "d"): ["cup"], ("car", "c"): ["car"]}, "random")
    tables = both(FIRST, other)
    first, second = (
        json.dumps(summarise(*rows), sort_keys=True, allow_nan=False)
        for rows in (tables, [table[::-1] for table in tables])
    )
    assert first == second


def test_tables_of_different_runs_are_refused():
    with pytest.raises(RecognitionError, match="must come from the same run"):
        summarise(SECOND[0], FIRST[1])


def test_strategies_are_compared_over_the_objects_that_both_tested():
    compared = summarise(*both(FIRST, SECOND))["comparisons"]["paper"]["naive_bayes"]["random"]
    assert (compared["objects"], compared["difference"]["mean"]) == (1, 0.0)
    alone = answers({("cup", "b"): ["cup"]}, strategy="random")
    with pytest.raises(
        RecognitionError, match="fixation and random were tested on no object in common"
    ):
        summarise(*both(FIRST, alone))


OBJECTS = {("cup", "a"): 2, ("cup", "b"): 6, ("cup", "d"): 3, ("car", "c"): 4, ("car", "e"): 5}
RIGHT = {"fixation": (2, 5, 1, 4, 3), "random": (1, 2, 2, 3, 0)}


def counted(strategy):
    other = {"cup": "car", "car": "cup"}
    named = {
        key: [key[0]] * right + [other[key[0]]] * (views - right)
        for (key, views), right in zip(OBJECTS.items(), RIGHT[strategy], strict=True)
    }
    return answers(named, strategy)


def drawn_interval(values, weights, worst, best, draws=400_000):
    """Draw the rule of docs/intervals.md, in points of this test alone."""
    generator = np.random.default_rng(1)
    own = weights * generator.standard_gamma(1, (draws, len(values)))
    extra = (weights**2).sum() / weights.sum() * generator.standard_gamma(0.75, draws)
    total = own.sum(axis=1) + extra

    def quantile(share, objects, further):
        return np.quantile((own @ objects + extra * further) / total, share)

    same = np.ones(len(values))
    low = quantile(0.025, values, values.min()), quantile(0.025, values.max() * same, worst)
    high = quantile(0.975, values, values.max()), quantile(0.975, values.min() * same, best)
    return [np.average(values, weights=weights), min(low), max(high)]


def drawn_share(weights, least, draws=400_000):
    """Draw how often the unobserved object of docs/intervals.md has at least this share of the weight."""
    generator = np.random.default_rng(2)
    own = (weights * generator.standard_gamma(1, (draws, len(weights)))).sum(axis=1)
    extra = (weights**2).sum() / weights.sum() * generator.standard_gamma(0.75, draws)
    return np.mean(extra / (own + extra) >= least)


def test_figures_are_those_that_pandas_counts_and_draws_give():
    scores, predictions = both(counted("fixation"), counted("random"))
    found = summarise(scores, predictions)
    frame = predictions.to_pandas().astype({"class": str, "predicted": str})
    frame["right"] = frame["class"] == frame["predicted"]
    means = frame.pivot_table(values="right", index=["class", "object"], columns="strategy")
    views = frame[frame.strategy == "fixation"].groupby(["class", "object"]).size()
    weights, per_class = views.to_numpy(float), views.groupby("class").transform("size")
    for strategy in ("fixation", "random"):
        cell = found["results"]["paper"][strategy]["naive_bayes"]
        values = means[strategy].to_numpy()
        for name, own in (("accuracy", weights), ("balanced_accuracy", 1 / per_class.to_numpy())):
            expected = drawn_interval(values, own, 0, 1)
            assert list(cell[name].values()) == pytest.approx(expected, abs=0.003)
    compared = found["comparisons"]["paper"]["naive_bayes"]["random"]
    gains = (means["fixation"] - means["random"]).to_numpy()
    # Sign changes of five objects reject nothing.
    mean = np.average(gains, weights=weights)
    assert list(compared["difference"].values()) == pytest.approx([mean, -1, 1])
    signs = np.array(np.meshgrid(*[[-1, 1]] * 5)).reshape(5, -1).T
    reached = np.abs(signs @ (gains * weights)) >= abs(gains @ weights) - 1e-9
    unobserved = drawn_share(weights, gains.max() / (gains.max() + 1))
    expected = max(reached.mean(), 2 * unobserved)
    assert compared["p_value"] == pytest.approx(expected, abs=0.005)
    assert (compared["classes"], compared["p_value_new_classes"] >= compared["p_value"]) == (
        2,
        True,
    )
    unweighted = np.abs(signs @ gains) >= abs(gains.sum()) - 1e-9
    assert reached.mean() != unweighted.mean()


def test_votes_weigh_objects_by_votes_and_accuracies_by_sequences():
    # Two splits. Object a is tested in both; b and d only once, with more sequences.
    tested = (
        {("cup", "a"): ["cup"] * 2, ("car", "b"): ["cup"] * 6},
        {("cup", "a"): ["car"] * 2, ("car", "b"): ["car"], ("car", "d"): ["car"] * 5},
    )
    parts = []
    for split, named in enumerate(tested):
        tables = [table.to_pylist() for table in answers(named)]
        for rows, schema in zip(tables, (SCORES, PREDICTIONS), strict=True):
            parts.append(build_rows(schema, [row | {"split": split} for row in rows]))
    scores, predictions = pa.concat_tables(parts[::2]), pa.concat_tables(parts[1::2])
    cell = summarise(scores, predictions)["results"]["paper"]["fixation"]["naive_bayes"]
    assert cell["accuracy"]["mean"] == pytest.approx((2 / 8 + 6 / 8) / 2)
    assert cell["object_accuracy"]["mean"] == pytest.approx((1 / 2 + 2 / 3) / 2)
    assert cell["by_object"] == {
        "cup/a": [pytest.approx(0.5), pytest.approx(2 / 8 + 2 / 8)],
        "car/b": [pytest.approx((0 * 6 / 8 + 1 * 1 / 8) / (7 / 8)), pytest.approx(6 / 8 + 1 / 8)],
        "car/d": [1.0, pytest.approx(5 / 8)],
    }
    # Votes, in the order b, d, a. Of b the first vote, of weight 1/2, is wrong and the second, of 1/3, right.
    values = np.array([(1 / 3) / (1 / 2 + 1 / 3), 1.0, (1 / 2) / (1 / 2 + 1 / 3)])
    weights = np.array([1 / 2 + 1 / 3, 1 / 3, 1 / 2 + 1 / 3])
    expected = object_interval(values, weights, IntervalParameters())
    assert cell["object_accuracy"]["low"] == pytest.approx(expected.low)
    assert cell["object_accuracy"]["high"] == pytest.approx(expected.high)
