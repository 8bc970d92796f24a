"""The product's evaluation against the plain one of `evaluation.py`, phase by phase.

Tolerances: means are sums of at most a few hundred numbers, so 1e-12. Ends of intervals are roots of integrals, which the
product finds to 1e-12 of the probability and the plain bisection to 2e-11 of the range; the quantiles' slopes are at least
1e-2, so 1e-9. The p value of unobserved failures is one integral, in which the
product's trapezoids have an error of 3e-10, so 1e-9. Counts of sign changes are equal.
"""

import itertools
import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from reference import evaluation as plain
from source_folders import ROOT

from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import (
    balanced_class_interval,
    balanced_interval,
    class_interval,
    compare_differences,
    holm,
    object_interval,
)
from visuohaptic.evaluation.leads import DrawnAccuracies, compare_by_lead
from visuohaptic.evaluation.means_over_draws import lead_over_draws, mean_over_draws
from visuohaptic.evaluation.sign_changes import _sign_changes, sign_change_test
from visuohaptic.evaluation.summary import summarise
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.leads import Lead, verdict
from visuohaptic.tables.phases import PREDICTIONS, SCORES
from visuohaptic.tables.schema import build_rows

INTERVALS = IntervalParameters()
END, CHANCE, EXACT = 1e-9, 1e-9, 1e-12
KEPT = ROOT / "tests/golden/kept"


def made_objects(seed, count):
    """Return accuracies with ties, unequal weights and classes of objects, each class at least once."""
    generator = np.random.default_rng(seed)
    values = np.round(generator.beta(3, 1, size=count), 1 + seed % 3)
    if seed % 4 == 0:
        values = np.round(values)
    weights = generator.uniform(0.2, 3, size=count) if seed % 2 else np.ones(count)
    classes = min((3, 2, 5, 12)[seed % 4], count)
    labels = [f"class{index % classes}" for index in range(count)]
    return values, weights, labels


OBJECTS = [(seed, count) for seed, count in enumerate([2, 3, 4, 5, 6, 7, 8, 9, 12, 12, 15, 30])]


# --- accuracies


@pytest.mark.parametrize(("seed", "count"), OBJECTS)
@pytest.mark.parametrize("confidence", [0.95, 0.8])
def test_intervals_of_accuracies(seed, count, confidence):
    values, weights, classes = made_objects(seed, count)
    parameters = IntervalParameters(confidence=confidence)
    found = object_interval(values, weights, parameters)
    ends = plain.accuracy_interval(values.tolist(), weights.tolist(), confidence)
    assert found.mean == pytest.approx(plain.weighted_mean(values, weights), abs=EXACT)
    assert [found.low, found.high] == pytest.approx(ends, abs=END)
    wider = class_interval(values, weights, classes, parameters)
    expected = plain.new_classes_interval(values, weights, classes, ends, confidence)
    assert [wider.low, wider.high] == pytest.approx(expected, abs=END)


@pytest.mark.parametrize(("seed", "count"), OBJECTS)
def test_intervals_of_balanced_accuracies(seed, count):
    values, _, classes = made_objects(seed, count)
    weights = plain.balanced_weights(classes)
    found = balanced_interval(values, classes, INTERVALS)
    ends = plain.accuracy_interval(values.tolist(), weights)
    means = [
        np.mean([v for v, own in zip(values, classes, strict=True) if own == one])
        for one in sorted(set(classes))
    ]
    assert found.mean == pytest.approx(np.mean(means), abs=EXACT)
    assert [found.low, found.high] == pytest.approx(ends, abs=END)
    wider = balanced_class_interval(values, classes, INTERVALS)
    expected = plain.new_classes_interval(values, weights, classes, ends)
    assert [wider.low, wider.high] == pytest.approx(expected, abs=END)


@pytest.mark.parametrize("bounds", [(-1.0, 1.0), (-0.5, math.inf), (-math.inf, math.inf)])
def test_intervals_of_other_measures(bounds):
    # A measure without a bound has only the quantile for observed variation.
    values, weights, _ = made_objects(3, 7)
    values = values - 0.3
    found = object_interval(values, weights, INTERVALS, bounds)
    least, most = (None if math.isinf(bound) else bound for bound in bounds)
    ends = plain.accuracy_interval(values.tolist(), weights.tolist(), bounds=(least, most))
    assert [found.low, found.high] == pytest.approx(ends, abs=END)


def test_twelve_equal_objects_are_a_beta_quantile():
    # docs/intervals.md: twelve of twelve gives 76.8 to 100 %. With equal weights the extra object's share has the beta
    # distribution (0.75, 12).
    from scipy.stats import beta

    found = object_interval(np.ones(12), np.ones(12), INTERVALS)
    assert [found.low, found.high] == pytest.approx([1 - beta.ppf(0.975, 0.75, 12), 1.0], abs=1e-9)
    assert plain.accuracy_interval([1.0] * 12, [1.0] * 12)[0] == pytest.approx(found.low, abs=END)
    assert round(100 * found.low, 1) == 76.8


def test_the_plain_interval_has_the_quantiles_of_many_draws():
    # 200,000 draws of the random weights: a quantile's standard error is sqrt(0.025 * 0.975 / 200,000) / density, below 0.0011
    # in these cases. Allowed are 0.004.
    generator = np.random.default_rng(0)
    for seed, count in [(1, 4), (3, 7), (6, 12)]:
        values, weights, _ = made_objects(seed, count)
        extra = np.sum(weights**2) / np.sum(weights)
        factors = np.column_stack(
            [generator.exponential(size=(200_000, count)), generator.gamma(0.75, size=200_000)]
        )
        factors *= np.append(weights, extra)
        ends = []
        for sign, worst in ((1, 0.0), (-1, -1.0)):
            own = sign * values
            variants = (np.append(own, own.min()), np.append(np.full(count, own.max()), worst))
            lows = [np.quantile(factors @ drawn / factors.sum(axis=1), 0.025) for drawn in variants]
            ends.append(sign * min(lows))
        assert plain.accuracy_interval(values.tolist(), weights.tolist()) == pytest.approx(
            ends, abs=0.004
        )


# --- leads


def made_differences(seed, count):
    generator = np.random.default_rng(100 + seed)
    differences = np.round(
        generator.normal(0.15 * (seed % 4), 0.2, size=count).clip(-1, 1), 1 + seed % 3
    )
    if seed % 5 == 0:
        differences = np.abs(differences)
    weights = generator.uniform(0.2, 3, size=count) if seed % 2 else np.ones(count)
    return differences, weights, [f"class{index % 3}" for index in range(count)]


LEADS = [(seed, count) for seed, count in enumerate([2, 3, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 11, 12])]


@pytest.mark.parametrize(("seed", "count"), LEADS)
@pytest.mark.parametrize("confidence", [0.95, 0.8])
def test_intervals_and_p_values_of_leads(seed, count, confidence):
    differences, weights, classes = made_differences(seed, count)
    parameters = IntervalParameters(confidence=confidence)
    found = compare_differences(differences, weights, parameters, classes=classes)
    values = differences.tolist(), weights.tolist()
    ends, p_value = plain.lead_interval(*values, confidence), plain.lead_p(*values)
    assert found.exact
    assert (found.objects, found.classes) == (count, min(count, 3))
    assert found.difference.mean == pytest.approx(plain.weighted_mean(*values), abs=EXACT)
    assert [found.difference.low, found.difference.high] == pytest.approx(ends, abs=END)
    assert found.p_value == pytest.approx(p_value, abs=CHANCE)
    wider = found.difference_new_classes
    expected = plain.new_classes_interval(*values, classes, ends, confidence, (-1.0, 1.0))
    assert [wider.low, wider.high] == pytest.approx(expected, abs=END)
    assert found.p_value_new_classes == pytest.approx(
        plain.new_classes_p(*values, classes, p_value), abs=CHANCE
    )


def test_leads_of_the_page():
    # docs/intervals.md: two treatments that are equal on twelve objects may differ by 23.2 points, with p 1; a steady lead of 5
    # points has p 0.0005 by sign changes alone and is not settled.
    for lead, end in ((0.0, 0.2321), (0.05, 0.1937)):
        values = [lead] * 12, [1.0] * 12
        found = compare_differences(np.array(values[0]), np.ones(12), INTERVALS)
        assert found.difference.low == pytest.approx(-end, abs=5e-5)
        assert found.p_value == pytest.approx(plain.lead_p(*values), abs=CHANCE)
    assert plain.sign_change_p([0.05] * 12, [1.0] * 12) == 2 / 2**12
    assert compare_differences(np.zeros(12), np.ones(12), INTERVALS).p_value == 1.0
    assert compare_differences(np.full(5, 0.9), np.ones(5), INTERVALS).difference.low == -1.0


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_drawn_sign_changes_agree_with_all(seed):
    # With 16 objects 4,096 of 65,536 sign changes are drawn. The share p has a standard error of sqrt(p (1 - p) / 4,096), at
    # most 0.0078; allowed are four. Ends move with the rank: by less than 0.02 here.
    differences, weights, _ = made_differences(seed, 16)
    found = compare_differences(differences, weights, IntervalParameters(permutations=4096))
    values = differences.tolist(), weights.tolist()
    assert not found.exact
    error = 4 * math.sqrt(max(found.p_value, 1 / 4096) / 4096)
    assert found.p_value == pytest.approx(plain.lead_p(*values), abs=error)
    ends = plain.lead_interval(*values)
    assert [found.difference.low, found.difference.high] == pytest.approx(ends, abs=0.02)


def test_intervals_of_drawn_sign_changes():
    # The reference gets the product's draws, 300 for 9 objects.
    for seed in (1, 2, 3):
        differences, weights, _ = made_differences(seed, 9)
        bits, _ = _sign_changes(9, 300)
        signs = np.unpackbits(bits, axis=0, bitorder="little")[:9].T.astype(bool)
        drawn = [tuple(row) for row in signs.tolist()]
        found = sign_change_test(differences, weights / weights.sum(), 300, 0.05)
        values = differences.tolist(), weights.tolist()
        assert len(drawn) == 300
        assert found.p_value == pytest.approx(plain.sign_change_p(*values, drawn=drawn), abs=EXACT)
        ends = plain.sign_change_interval(*values, drawn=drawn)
        assert [found.low, found.high] == pytest.approx(ends, abs=EXACT)


# --- draws


def accuracies_of(seed, names, classes=2):
    generator = np.random.default_rng(seed)
    return {
        (f"class{number % classes}", name): (
            float(generator.uniform()),
            float(generator.uniform(1, 2)),
        )
        for number, name in enumerate(names)
    }


def as_product(own):
    objects = tuple(sorted(own))
    return ObjectAccuracies(
        objects,
        np.array([own[key][0] for key in objects]),
        np.array([own[key][1] for key in objects]),
    )


def test_means_and_leads_over_draws():
    fixation = accuracies_of(0, "abcdefgh")
    draws = [
        accuracies_of(seed, names)
        for seed, names in ((1, "abcdefg"), (2, "abcdefgh"), (3, "abcdefg"))
    ]
    seen = [accuracies_of(4, "abcdefgh")]
    mean = plain.mean_of_draws(draws)
    found = mean_over_draws([as_product(draw) for draw in draws])
    for key, accuracy, weight in zip(found.objects, found.accuracy, found.weights, strict=True):
        assert (accuracy, weight) == pytest.approx(mean[key], abs=EXACT)
    assert set(found.objects) == set(mean)
    by_strategy = {"fixation": [fixation], "random": draws, "random_visible": seen}
    product = compare_by_lead(
        {name: DrawnAccuracies(tuple(map(as_product, some))) for name, some in by_strategy.items()},
        INTERVALS,
    )
    for name, plus, minus in (
        ("seeing", "fixation", "random"), ("sight", "random_visible", "random"), ("salience", "fixation", "random_visible"),
    ):  # fmt: skip
        first, others = plain.mean_of_draws(by_strategy[plus]), by_strategy[minus]
        shared, differences, weights = plain.paired_differences(first, plain.mean_of_draws(others))
        lead = product[name]
        assert lead["objects"] == len(shared)
        assert lead["difference"]["mean"] == pytest.approx(
            plain.weighted_mean(differences, weights), abs=EXACT
        )
        ends = plain.lead_interval(differences, weights)
        assert [lead["difference"]["low"], lead["difference"]["high"]] == pytest.approx(
            ends, abs=END
        )
        assert lead["p_value"] == pytest.approx(plain.lead_p(differences, weights), abs=CHANCE)
        leads = [
            plain.weighted_mean(*plain.paired_differences(first, other)[1:]) for other in others
        ]
        assert lead["draws"]["leads"] == pytest.approx(leads, abs=EXACT)
        assert lead_over_draws(
            as_product(first), [as_product(o) for o in others]
        ).mean == pytest.approx(np.mean(leads))
        spread = np.std(leads, ddof=1) if len(leads) > 1 else 0.0
        assert lead["draws"]["standard_deviation"] == pytest.approx(spread, abs=EXACT)


# --- many tests


def test_holm():
    generator = np.random.default_rng(0)
    for count in (1, 2, 3, 8, 20):
        p_values = np.round(generator.beta(0.3, 2, size=count), 3).tolist()
        assert holm(p_values) == pytest.approx(plain.holm(p_values), abs=EXACT)
    assert plain.holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


@pytest.mark.parametrize("over", ["objects", "classes"])
def test_the_word_of_a_question(over):
    # Leads of many kinds; each word comes up, also at a p value that the correction moves over 0.05.
    generator = np.random.default_rng(1)
    words = set()
    for case in range(60):
        count, shift = int(generator.integers(1, 5)), (-0.03, 0.06, 0.0)[case % 3]
        means = generator.normal(shift, 0.02, size=count)
        highs = means + generator.uniform(0.0, 0.05, size=count)
        p_values = np.round(generator.beta(0.2, 5, size=count), 3)
        word, ahead, behind, excluded = plain.verdict(
            list(zip(means, highs, p_values, strict=True))
        )
        leads = []
        for mean, high, p_value in zip(means, highs, p_values, strict=True):
            other = (-1.0, 1.0, 1.0)
            objects, classes = ((-1.0, high, p_value), other)[:: 1 if over == "objects" else -1]
            leads.append(
                Lead(
                    "salience",
                    "paper",
                    "none",
                    "full",
                    1,
                    12,
                    Estimate(mean, *objects, *classes),
                    0.0,
                )
            )
        found = verdict(leads, over)
        words.add(word)
        assert found.word == word
        assert [leads.index(one) for one in found.ahead] == ahead
        assert [leads.index(one) for one in found.behind] == behind
        assert found.excluded == excluded
    assert words == {"yes", "no", "not settled"}


# --- all figures


def decided(rows, pipeline):
    """Return the credit of each object in each split, from rows of predictions."""
    of_object: dict = {}
    for row in rows:
        of_object.setdefault((row["split"], (row["class"], row["object"])), []).append(row)
    credit = {}
    for key, own in of_object.items():
        if pipeline == "order_free":
            credit[key] = float(own[0]["voted"] == own[0]["class"])
        else:
            credit[key] = majority_credit([row["predicted"] for row in own], own[0]["class"])
    return credit


def majority_credit(predicted, truth):
    most = max(predicted.count(one) for one in predicted)
    winners = {one for one in predicted if predicted.count(one) == most}
    return (truth in winners) / len(winners)


def check_interval(found, name, mean, ends, wider):
    assert found[name]["mean"] == pytest.approx(mean, abs=EXACT)
    assert [found[name]["low"], found[name]["high"]] == pytest.approx(ends, abs=END)
    if wider is not None:
        name = f"{name}_new_classes"
        assert [found[name]["low"], found[name]["high"]] == pytest.approx(wider, abs=END)


def check_figures(scores, predictions, drawn):
    """Compare `summarise` with the reference, for tables of a run."""
    product = summarise(scores, predictions, INTERVALS, drawn)
    cells: dict = {}
    for row in predictions.to_pylist():
        cells.setdefault((row["pipeline"], row["strategy"], row["classifier"]), []).append(row)
    further: dict = {}
    for row in drawn.to_pylist():
        key = row["pipeline"], row["strategy"], row["classifier"]
        further.setdefault(key, []).append(row)
    draws = {key: [plain.object_accuracies(sequences_of(rows))] for key, rows in cells.items()}
    for (pipeline, strategy, classifier), rows in sorted(further.items()):
        draws.setdefault((pipeline, strategy.split("#")[0], classifier), []).append(
            plain.accuracies_from_shares(rows)
        )
    for key, rows in cells.items():
        found = product["results"][key[0]][key[1]][key[2]]
        own = plain.mean_of_draws(draws[key])
        objects = sorted(own)
        values, weights = (list(part) for part in zip(*(own[one] for one in objects), strict=True))
        classes = [one[0] for one in objects]
        if len(draws[key]) == 1:
            mean = plain.mean_over_splits(sequences_of(rows))
        else:
            mean = plain.weighted_mean(values, weights)
            means = [plain.weighted_mean(*zip(*draw.values(), strict=True)) for draw in draws[key]]
            assert found["draws"]["accuracies"] == pytest.approx(means, abs=EXACT)
        ends = plain.accuracy_interval(values, weights)
        wider = plain.new_classes_interval(values, weights, classes, ends)
        check_interval(found, "accuracy", mean, ends, wider)
        balanced = plain.balanced_weights(classes)
        ends = plain.accuracy_interval(values, balanced)
        wider = plain.new_classes_interval(values, balanced, classes, ends)
        check_interval(
            found, "balanced_accuracy", plain.weighted_mean(values, balanced), ends, wider
        )
        for a_class in sorted(set(classes)):
            members = [value for value, one in zip(values, classes, strict=True) if one == a_class]
            ends = plain.accuracy_interval(members, [1.0] * len(members))
            check_interval(found["class_accuracy"], a_class, np.mean(members), ends, None)
        for one, value, weight in zip(objects, values, weights, strict=True):
            assert found["by_object"]["/".join(one)] == pytest.approx([value, weight], abs=EXACT)
        credit = decided(rows, key[0])
        votes = plain.object_votes(credit)
        values, weights = (
            list(part) for part in zip(*(votes[one] for one in objects), strict=True)
        )
        ends = plain.accuracy_interval(values, weights)
        wider = plain.new_classes_interval(values, weights, classes, ends)
        check_interval(found, "object_accuracy", plain.mean_of_splits(credit), ends, wider)
    for (pipeline, classifier), named in leads_of(draws).items():
        for name, (first, others) in named.items():
            check_lead(product["leads"][pipeline][classifier][name], first, others)
            if name == "seeing":
                check_lead(product["comparisons"][pipeline][classifier]["random"], first, others)


def sequences_of(rows):
    return [
        ((row["class"], row["object"]), row["split"], row["predicted"], row["class"])
        for row in rows
    ]


def leads_of(draws):
    """Return for each pipeline and classifier the accuracies on both sides of each lead."""
    found: dict = {}
    for pipeline, _, classifier in draws:
        for name, plus, minus in (
            ("seeing", "fixation", "random"), ("sight", "random_visible", "random"), ("salience", "fixation", "random_visible"),
        ):  # fmt: skip
            sides = [draws.get((pipeline, side, classifier)) for side in (plus, minus)]
            if all(sides):
                found.setdefault((pipeline, classifier), {})[name] = (
                    plain.mean_of_draws(sides[0]),
                    sides[1],
                )
    return found


def check_lead(lead, first, others):
    shared, differences, weights = plain.paired_differences(first, plain.mean_of_draws(others))
    classes = [owner[0] for owner in shared]
    ends, p_value = plain.lead_interval(differences, weights), plain.lead_p(differences, weights)
    wider = plain.new_classes_interval(differences, weights, classes, ends, bounds=(-1.0, 1.0))
    check_interval(lead, "difference", plain.weighted_mean(differences, weights), ends, wider)
    assert lead["p_value"] == pytest.approx(p_value, abs=CHANCE)
    expected = plain.new_classes_p(differences, weights, classes, p_value)
    assert lead["p_value_new_classes"] == pytest.approx(expected, abs=CHANCE)
    if "draws" in lead:
        leads = [
            plain.weighted_mean(*plain.paired_differences(first, other)[1:]) for other in others
        ]
        assert lead["draws"]["leads"] == pytest.approx(leads, abs=EXACT)


def made_run(seed):
    """Return scores, predictions and further draws of two pipelines, for three classes of two to three objects.

    Views are missing for some objects, differently by strategy and draw, and votes tie.
    """
    generator = np.random.default_rng(seed)
    objects = [("a", "1"), ("a", "2"), ("b", "1"), ("b", "2"), ("b", "3"), ("c", "1"), ("c", "2")]
    splits = list(
        itertools.product(*([one for one in objects if one[0] == name] for name in "abc"))
    )
    predictions, scores, drawn = [], [], []
    for pipeline, strategy in itertools.product(
        ("paper", "order_free"), ("fixation", "random", "random#1", "random#2", "random_visible")
    ):
        views = {one: int(generator.integers(2, 5)) for one in objects}
        if strategy == "random#2":
            del views["b", "3"]
        for number, split in enumerate(splits):
            cell = {
                "pipeline": pipeline,
                "strategy": strategy,
                "classifier": "naive_bayes",
                "split": number,
            }
            for owner in split:
                if owner not in views:
                    continue
                names = {"class": owner[0], "object": owner[1]}
                predicted = generator.choice([owner[0], owner[0], "a", "b", "c"], size=views[owner])
                if strategy in ("fixation", "random"):
                    voted = (
                        str(generator.choice(["a", "b", "c"])) if pipeline == "order_free" else None
                    )
                    predictions += [
                        {
                            **cell,
                            **names,
                            "seed": 0,
                            "viewpoint": view,
                            "predicted": one,
                            "voted": voted,
                            "probability": None,
                        }
                        for view, one in enumerate(predicted.tolist())
                    ]
                else:
                    accuracy = float(np.mean(predicted == owner[0]))
                    study = {
                        "study": "random_draws",
                        "condition": "made",
                        "repeat": 0,
                        "error": None,
                    }
                    drawn.append(
                        {**cell, **names, **study, "sequences": views[owner], "accuracy": accuracy}
                    )
            if strategy in ("fixation", "random"):
                figures = {"accuracy": 0.0, "object_accuracy": 0.0, "sequences": 1, "note": None}
                scores.append({**cell, "seed": 0, **figures})
    tables = [build_rows(SCORES, scores), build_rows(PREDICTIONS, predictions)]
    return [*tables, pa.Table.from_pylist(drawn)]


@pytest.mark.parametrize("seed", [0, 1])
def test_every_figure_of_a_made_run(seed):
    check_figures(*made_run(seed))


@pytest.mark.parametrize("run", ["small_run", pytest.param("default_run", marks=pytest.mark.long)])
def test_every_figure_of_a_run(run):
    # Scores, predictions and further draws of kept runs: four objects, and the twelve of a default run.
    kept = KEPT / run
    tables = [
        pq.read_table(kept / f"{name}.parquet")
        for name in ("scores", "predictions", "study_blocks-random_draws")
    ]
    check_figures(*tables)
