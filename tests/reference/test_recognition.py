"""The product's recognition against the plain one of `recognition.py`, phase by phase.

Each phase of the reference gets the product's inputs of that phase. Where a choice is random, the reference gets the
product's draws. Tolerances: descriptors and statistics are sums of a few hundred numbers of size 1, so that another order
of summation changes them by less than 1e-12; standardised ones by less than 1e-9, because a deviation divides them.
Probabilities: covariances are inverted, in 1e-9. Predictions, votes and groups are equal; no case has a tie of distances.
"""

import itertools
from collections import Counter
from functools import cache

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from reference import recognition as plain
from reference.feature_tables import (
    BANDS,
    IMPRINT,
    NORMAL,
    PLACE,
    STATES,
    feature_columns,
    numbers,
    sequences_of,
)
from source_folders import ROOT

from visuohaptic.base.seeds import spawn_generator
from visuohaptic.recognition import (
    RecognitionParameters,
    SequenceEncoder,
    make_order_free,
    run_pipeline,
    touch_descriptors,
)
from visuohaptic.recognition.descriptors import draw_waves
from visuohaptic.recognition.quadratic_discriminant import QuadraticDiscriminant
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table

KEPT = ROOT / "tests/golden/kept"
SEED = 7
PARAMETERS = RecognitionParameters()

SHAPES = {
    # Four views of overlapping classes, so that votes tie.
    "two classes of two": {"objects": (2, 2), "separation": 0.1},
    "missing and long sequences": {"objects": (2, 3, 2), "lengths": (5, 7, 4, 5, 5), "viewpoints": 5, "seed": 1},
    "four classes": {"objects": (2, 2, 2, 2), "separation": 0.4, "seed": 2},
    "constant features": {
        "objects": (3, 2, 2), "separation": 0.5, "seed": 3,
        "constant": ("contourlet_03", "contourlet_04", "y", "imprint_empty"),
    },
}  # fmt: skip


def table_of(columns):
    return build_table(FEATURES, columns)


class Case:
    """A table of features, the product's scores and predictions of one pipeline, and the reference's sequences."""

    def __init__(self, columns, pipeline):
        self.columns, self.pipeline = columns, pipeline
        self.table = table_of(columns)
        scores, predictions = run_pipeline(self.table, PARAMETERS, SEED, pipeline)
        self.scores, self.predictions = scores.to_pylist(), predictions.to_pylist()
        self.sequences = sequences_of(columns)
        self.keys = list(self.sequences)
        self.classes = sorted({key[0] for key in self.keys})
        self.labels = np.array([key[0] for key in self.keys])

    def tested(self, split):
        """Return the objects that the product tested in a split."""
        return {(row["class"], row["object"]) for row in self.predictions if row["split"] == split}

    def is_tested(self, split):
        objects = self.tested(split)
        return np.array([key[:2] in objects for key in self.keys])

    @property
    def splits(self):
        return sorted({row["split"] for row in self.scores})

    def answers(self, split, classifier):
        """Return the product's predictions of a split, in the order of the keys."""
        rows = [
            row
            for row in self.predictions
            if (row["split"], row["classifier"]) == (split, classifier)
        ]
        keyed = {(row["class"], row["object"], row["viewpoint"]): row for row in rows}
        assert len(keyed) == len(rows)
        return [
            keyed[key]
            for key, tested in zip(self.keys, self.is_tested(split), strict=True)
            if tested
        ]

    def score(self, split, classifier):
        [row] = [
            row for row in self.scores if (row["split"], row["classifier"]) == (split, classifier)
        ]
        return row


@cache
def case_of(name, pipeline):
    """Return a case; each is run once."""
    return Case(feature_columns(**SHAPES[name]), pipeline)


# --- splits


@pytest.mark.parametrize("name", SHAPES)
def test_every_split_is_tested_in_order(name):
    for pipeline in ("paper", "order_free"):
        case = case_of(name, pipeline)
        objects = sorted({key[:2] for key in case.keys})
        assert [case.tested(split) for split in case.splits] == plain.every_split(objects)


def test_eighty_one_combinations_are_all_tested():
    columns = feature_columns((3, 3, 3, 3), viewpoints=2, seed=10)
    parameters = RecognitionParameters(classifiers=("naive_bayes",))
    _, predictions = run_pipeline(table_of(columns), parameters, SEED, "paper")
    tested = {}
    for row in predictions.to_pylist():
        tested.setdefault(row["split"], set()).add((row["class"], row["object"]))
    objects = sorted({key[:2] for key in sequences_of(columns)})
    assert [tested[split] for split in sorted(tested)] == plain.every_split(objects)
    assert len(tested) == 81


def test_more_combinations_than_splits_are_folds_of_whole_objects():
    # 3 x 5 x 6 = 90 combinations, more than 81: folds, each object tested once a round, in three rounds.
    columns = feature_columns((3, 5, 6), viewpoints=2, seed=4)
    parameters = RecognitionParameters(classifiers=("naive_bayes",))
    _, predictions = run_pipeline(table_of(columns), parameters, SEED, "paper")
    tested = {}
    for row in predictions.to_pylist():
        tested.setdefault(row["split"], set()).add((row["class"], row["object"]))
    folds = [tested[split] for split in sorted(tested)]
    assert len(folds) == 15
    rounds = [folds[start : start + 5] for start in (0, 5, 10)]
    objects = {key[:2] for key in sequences_of(columns)}
    for one in rounds:
        assert Counter(itertools.chain(*one)) == Counter(objects)
        for a_class in ("class0", "class1", "class2"):
            sizes = [sum(owner[0] == a_class for owner in fold) for fold in one]
            assert max(sizes) - min(sizes) <= 1
    assert len({frozenset(frozenset(fold) for fold in one) for one in rounds}) == 3


# --- pipeline paper


# Seeds whose groups depend on the radii, their number and factors, the first units, or passes after the twentieth.
@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 12, 19, 25, 32, 34, 42, 55])
def test_the_map_sorts_features_into_the_same_groups(seed):
    generator = np.random.default_rng(seed)
    count = int(generator.integers(4, 30))
    training = generator.normal(size=(count, 5, 22)) * generator.uniform(0.2, 2, size=22)
    training += generator.normal(size=(count, 5, 3)) @ generator.normal(size=(3, 22)) * (seed % 2)
    training += generator.normal(size=22) * (seed % 3)
    weights = SequenceEncoder(PARAMETERS).fit(training).reduction_.weights
    groups = plain.feature_groups(training)
    for feature, group in enumerate(groups):
        share = 1 / groups.count(group)
        assert weights[feature].tolist() == pytest.approx(
            [share * (unit == group) for unit in range(5)]
        )


@pytest.mark.parametrize("name", SHAPES)
def test_the_sixty_numbers(name):
    case = case_of(name, "paper")
    touches = np.array([numbers(one, BANDS + PLACE + NORMAL) for one in case.sequences.values()])
    for split in case.splits:
        tested = case.is_tested(split)
        encoder = SequenceEncoder(PARAMETERS).fit(touches[~tested])
        expected = plain.paper_numbers(touches[~tested], touches[tested])
        for rows, own in zip((touches[~tested], touches[tested]), expected, strict=True):
            np.testing.assert_allclose(encoder.transform(rows), own, rtol=0, atol=1e-9)


def test_the_sixty_numbers_before_scaling():
    generator = np.random.default_rng(6)
    training = generator.normal(size=(12, 5, 22)) + generator.normal(size=22)
    training[0, :2] = 0.0  # a coefficient is 0, its level is not
    encoder = SequenceEncoder(RecognitionParameters(sequence_scaling="none")).fit(training)
    groups = plain.feature_groups(training)
    expected = [plain.sequence_statistics(plain.group_means(one, groups)) for one in training]
    np.testing.assert_allclose(encoder.transform(training), expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_predictions_of_pipeline_paper(name):
    case = case_of(name, "paper")
    touches = np.array([numbers(one, BANDS + PLACE + NORMAL) for one in case.sequences.values()])
    for split in case.splits:
        tested = case.is_tested(split)
        training, rows = plain.paper_numbers(touches[~tested], touches[tested])
        # The seed of the tree is the product's draw: one per classifier, in their order.
        generator = spawn_generator(SEED, "recognition", "paper", 0, split)
        seeds = {
            classifier: int(generator.integers(2**31)) for classifier in PARAMETERS.classifiers
        }
        encoder = SequenceEncoder(PARAMETERS).fit(touches[~tested])
        for classifier, fitted in plain.paper_classifiers(seeds["decision_tree"]).items():
            inputs = training, rows
            if classifier == "decision_tree":
                # Thresholds lie between numbers, so the tree gets the product's.
                inputs = encoder.transform(touches[~tested]), encoder.transform(touches[tested])
            predicted = fitted.fit(inputs[0], case.labels[~tested]).predict(inputs[1])
            answers = case.answers(split, classifier)
            assert [row["predicted"] for row in answers] == predicted.tolist(), classifier
            assert all(row["probability"] is None and row["voted"] is None for row in answers)


@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
@pytest.mark.parametrize("name", SHAPES)
def test_scores_are_shares_of_sequences_and_of_objects(name, pipeline):
    case = case_of(name, pipeline)
    for split, classifier in {(row["split"], row["classifier"]) for row in case.scores}:
        answers, score = case.answers(split, classifier), case.score(split, classifier)
        assert score["sequences"] == len(answers)
        right = plain.share_correct(
            [row["predicted"] for row in answers], [row["class"] for row in answers]
        )
        assert score["accuracy"] == pytest.approx(right, abs=1e-15)
        votes = []
        for owner in sorted(case.tested(split)):
            own = [row for row in answers if (row["class"], row["object"]) == owner]
            if pipeline == "paper":
                votes.append(plain.majority_vote([row["predicted"] for row in own], owner[0]))
            else:
                [voted] = {row["voted"] for row in own}
                votes.append(float(voted == owner[0]))
        assert score["object_accuracy"] == pytest.approx(sum(votes) / len(votes), abs=1e-15)


def test_votes_of_the_first_case_tie():
    case = case_of("two classes of two", "paper")
    assert any(
        plain.majority_vote(
            [row["predicted"] for row in case.answers(split, classifier)][:4], "class0"
        )
        == 0.5
        for split in case.splits
        for classifier in PARAMETERS.classifiers
    )


# --- pipeline order_free


def described(sequence, waves):
    states = [[float(row["contact_state"] == state) for state in STATES] for row in sequence]
    return plain.order_free_descriptors(
        numbers(sequence, BANDS), numbers(sequence, IMPRINT), numbers(sequence, ["sensor_size"])[:, 0], states,
        numbers(sequence, PLACE), numbers(sequence, NORMAL), waves.directions, waves.phases,
    )  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_descriptors(name):
    case = case_of(name, "order_free")
    rows, classes, objects = touch_descriptors(case.table, PARAMETERS, SEED)
    expected = [
        described(one, draw_waves(PARAMETERS.order_free, SEED)) for one in case.sequences.values()
    ]
    assert rows.shape[1] == 516
    assert classes.tolist() == case.labels.tolist()
    assert objects.tolist() == ["/".join(key[:2]) for key in case.keys]
    np.testing.assert_allclose(rows, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("touches", [1, 2])
def test_descriptors_of_few_touches(touches):
    # One touch has no pair, two have one extent.
    columns = feature_columns((2, 2), viewpoints=2, lengths=(touches,), seed=5)
    parameters = RecognitionParameters(touches=touches)
    rows, _, _ = touch_descriptors(table_of(columns), parameters, SEED)
    waves = draw_waves(parameters.order_free, SEED)
    expected = [described(one, waves) for one in sequences_of(columns, touches).values()]
    np.testing.assert_allclose(
        rows, expected, rtol=0, atol=1e-7
    )  # roots of rounding are below 1e-7


def test_the_waves_draw_the_gaussian_kernel():
    # Rahimi and Recht (NIPS 2007): the mean product of two touches' waves tends to exp(-d^2 / 2) at d kernel widths. Normals
    # count half. Products have a standard deviation below 1.25, so the mean of 25,000 is within four standard errors, 0.032.
    parameters = RecognitionParameters(order_free={"waves": 5000}).order_free
    drawn = [draw_waves(parameters, seed) for seed in range(5)]
    generator = np.random.default_rng(0)
    for _ in range(20):
        poses = generator.normal(size=(2, 6)) * 0.3
        values = [np.sqrt(2) * np.cos(poses @ waves.directions + waves.phases) for waves in drawn]
        step = (poses[0] - poses[1]) * [1, 1, 1, 0.5, 0.5, 0.5] / 0.35
        product = np.mean([first * second for first, second in values])
        assert product == pytest.approx(np.exp(-(step @ step) / 2), abs=0.032)


def test_the_rotation_keeps_all_but_a_billionth_of_the_variance():
    # Standardised columns whose differences carry shares of the variance of about 1e-4, 1e-7 and 1e-12. The last is dropped.
    generator = np.random.default_rng(9)
    rows = np.repeat(generator.normal(size=(40, 5)), 2, axis=1)
    rows[:, [1, 3, 5]] += generator.normal(size=(40, 3)) * [3e-2, 1e-3, 3e-6]
    found = make_order_free()[:-1].fit_transform(rows)
    expected, _ = plain.scaled_and_rotated(rows, rows)
    assert found.shape == expected.shape == (40, 7)
    np.testing.assert_allclose(np.abs(found), np.abs(expected), rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", SHAPES)
def test_predictions_of_pipeline_order_free(name):
    case = case_of(name, "order_free")
    rows, _, _ = touch_descriptors(case.table, PARAMETERS, SEED)
    for split in case.splits:
        tested = case.is_tested(split)
        training, test_rows = plain.scaled_and_rotated(rows[~tested], rows[tested])
        generator = spawn_generator(SEED, "recognition", "order_free", 0, split)
        tree_seed = int(
            spawn_generator(int(generator.integers(2**31)), "decision_tree").integers(2**31)
        )
        preparation = make_order_free()[:-1].fit(rows[~tested])
        classifiers = plain.order_free_classifiers(tree_seed)
        if sum(~tested) < 15:
            del classifiers["k_nearest_neighbours"]  # it can't be fitted, and has no rows
        assert {row["classifier"] for row in case.scores} == set(classifiers)
        for classifier, fitted in classifiers.items():
            inputs = training, test_rows
            if classifier == "decision_tree":
                inputs = preparation.transform(rows[~tested]), preparation.transform(rows[tested])
            fitted.fit(inputs[0], case.labels[~tested])
            logs = plain.log_probabilities(fitted, inputs[1])
            answers = case.answers(split, classifier)
            assert [row["predicted"] for row in answers] == fitted.predict(inputs[1]).tolist(), (
                classifier
            )
            for row, own in zip(answers, logs, strict=True):
                largest = np.exp(own[case.classes.index(row["predicted"])])
                assert row["probability"] == pytest.approx(largest, abs=1e-9), classifier
            owners = [(row["class"], row["object"]) for row in answers]
            for owner in set(owners):
                own = [log for log, one in zip(logs, owners, strict=True) if one == owner]
                [voted] = {
                    row["voted"] for row, one in zip(answers, owners, strict=True) if one == owner
                }
                assert voted in plain.probability_vote(own, case.classes), classifier


# --- the quadratic discriminant


@pytest.mark.parametrize("spread", [1.0, 0.02, 0.005])
@pytest.mark.parametrize("fixed", [None, 0.9])
def test_the_quadratic_discriminant(fixed, spread):
    # Many rows of few features. The last feature's variance is 1, 4e-4 (not singular) or 2.5e-5 (singular).
    generator = np.random.default_rng(8)
    labels = np.repeat(["a", "b", "c"], [20, 30, 40])
    rows = generator.normal(size=(90, 4)) * [1, 1, 2, spread] + (labels == "b")[:, None] * [
        0.5,
        1,
        0,
        0.5 * spread,
    ]
    settings = (
        {"shrinkage": 0.9, "regularisation": "always", "target": "mean_variance"} if fixed else {}
    )
    product = QuadraticDiscriminant(**settings).fit(rows, labels)
    expected = plain.QuadraticDiscriminant(fixed).fit(rows, labels)
    np.testing.assert_allclose(
        product.predict_log_proba(rows), expected.predict_log_proba(rows), rtol=0, atol=1e-8
    )
    # Far from all classes the densities are below the least number.
    far = product.predict_log_proba(100 * rows), expected.predict_log_proba(100 * rows)
    np.testing.assert_allclose(*far, rtol=1e-9, atol=1e-8)
    assert (product.note_ is not None) == (fixed is None and spread == 0.005)


# --- a default run


@pytest.mark.long
@pytest.mark.parametrize("strategy", ["fixation", "random"])
def test_predictions_of_a_default_run(strategy):
    # Tables of a kept run: features are kept in single precision, so trees, whose thresholds lie between equal numbers, are
    # left out. Every eighth of the 81 splits.
    kept = KEPT / "default_run"
    chosen = pa.compute.field("strategy") == strategy
    features = pq.read_table(kept / "features.parquet", filters=chosen).to_pydict()
    sequences = sequences_of({name: np.array(column) for name, column in features.items()})
    predictions = pq.read_table(
        kept / "predictions.parquet", filters=chosen & (pa.compute.field("pipeline") == "paper")
    )
    answers = {}
    for row in predictions.to_pylist():
        key = row["class"], row["object"], row["viewpoint"]
        answers.setdefault((row["split"], row["classifier"]), {})[key] = row["predicted"]
    keys = list(sequences)
    touches = np.array([numbers(one, BANDS + PLACE + NORMAL) for one in sequences.values()])
    labels = np.array([key[0] for key in keys])
    splits = plain.every_split(sorted({key[:2] for key in keys}))
    assert len(splits) == 81
    for split in range(0, 81, 8):
        tested = np.array([key[:2] in splits[split] for key in keys])
        training, rows = plain.paper_numbers(touches[~tested], touches[tested])
        for classifier, fitted in plain.paper_classifiers(0).items():
            if classifier == "decision_tree":
                continue
            predicted = fitted.fit(training, labels[~tested]).predict(rows)
            own = [key for key, test in zip(keys, tested, strict=True) if test]
            assert answers[split, classifier] == dict(zip(own, predicted.tolist(), strict=True)), (
                classifier
            )
