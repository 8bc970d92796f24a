"""Choices inside the training objects."""

import itertools

import numpy as np
import pytest
from recognition.synthetic import clusters
from sklearn.linear_model import LogisticRegression
from sklearn.svm import SVC

from visuohaptic.errors import RegistryError
from visuohaptic.recognition import classifiers, tuning
from visuohaptic.recognition.classifiers import (
    CLASSIFIERS,
    Classifier,
    ClassifierParameters,
)
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import LEAST_SCORE, softmax
from visuohaptic.recognition.tuning import (
    FoldFits,
    class_scores,
    fit_projection,
    fit_tuned_classifier,
    make_inner_folds,
)
from visuohaptic.registry import Registry

EVERY_CLASSIFIER = RecognitionParameters(best=BestParameters(classifiers=CLASSIFIERS.names))


def test_projection_keeps_distances_when_it_keeps_every_component():
    descriptors, _, _ = clusters()
    projection = fit_projection(descriptors, 1000)
    projected = projection.apply(descriptors)
    standard = (descriptors - descriptors.mean(axis=0)) / descriptors.std(axis=0)
    np.testing.assert_allclose(
        np.linalg.norm(projected[:, None] - projected, axis=2),
        np.linalg.norm(standard[:, None] - standard, axis=2),
        atol=1e-9,
    )


def test_projection_orders_components_by_variance_and_drops_empty_ones():
    descriptors, _, _ = clusters(columns=6)
    doubled = np.concatenate([descriptors, descriptors, np.ones((len(descriptors), 2))], axis=1)
    projected = fit_projection(doubled, 64).apply(doubled)
    variances = projected.var(axis=0)
    assert projected.shape[1] == 6
    assert np.all(np.diff(variances) <= 0)


def test_inner_folds_hold_out_whole_objects_and_project_without_them():
    descriptors, labels, owners = clusters()
    folds = make_inner_folds(
        descriptors, labels, owners, BestParameters(inner_folds=3), np.random.default_rng(0)
    )
    assert len(folds) == 3
    assert sum(len(fold.held_out) for fold in folds) == len(labels)
    for fold in folds:
        assert len(fold.fits.train) + len(fold.held_out) == len(labels)
        np.testing.assert_allclose(fold.fits.train.mean(axis=0), 0, atol=1e-12)


def test_class_with_one_training_object_is_never_held_out_from_a_fold_that_lacks_it():
    descriptors, labels, owners = clusters(objects=(1, 3, 3))
    folds = make_inner_folds(
        descriptors, labels, owners, BestParameters(), np.random.default_rng(0)
    )
    for fold in folds:
        assert set(fold.held_out_labels) <= set(fold.fits.labels)


def test_without_a_second_object_a_class_the_simplest_setting_is_taken():
    descriptors, labels, owners = clusters(objects=(1, 1))
    folds = make_inner_folds(
        descriptors, labels, owners, BestParameters(), np.random.default_rng(0)
    )
    assert folds == []
    tuned, _ = fit_tuned_classifier(
        "support_vector_machine", ClassifierParameters(), FoldFits(None, descriptors, labels), folds,
        2, np.random.default_rng(0),
    )  # fmt: skip
    assert tuned.setting == "svm_penalty 1.0"
    assert tuned.temperature == 1


@pytest.mark.parametrize("name", CLASSIFIERS.names)
def test_every_classifier_gives_probabilities_also_of_a_class_it_never_saw(name):
    descriptors, labels, owners = clusters(objects=(2, 2))
    generator = np.random.default_rng(0)
    folds = make_inner_folds(descriptors, labels, owners, BestParameters(), generator)
    tuned, _ = fit_tuned_classifier(
        name, ClassifierParameters(), FoldFits(None, descriptors, labels * 2), [], 3, generator
    )
    probabilities = tuned.ballots(descriptors).alone()
    np.testing.assert_allclose(probabilities.sum(axis=1), 1)
    assert probabilities[:, 1].max() < 1e-9
    assert len(folds) == 2
    tuned, _ = fit_tuned_classifier(
        name, ClassifierParameters(), FoldFits(None, descriptors, labels), folds, 2, generator
    )
    assert (tuned.ballots(descriptors).alone().argmax(axis=1) == labels).mean() > 0.9


def test_scores_of_two_classes_favour_the_one_that_the_machine_names():
    descriptors, labels, _ = clusters(objects=(2, 2))
    machine = SVC().fit(descriptors, labels)
    scores = class_scores(machine, descriptors, 2)
    np.testing.assert_array_equal(scores.argmax(axis=1), machine.predict(descriptors))
    regression = LogisticRegression().fit(descriptors, labels)
    np.testing.assert_allclose(
        softmax(class_scores(regression, descriptors, 2)), regression.predict_proba(descriptors)
    )
    assert scores.min() > LEAST_SCORE


@pytest.mark.slow
def test_what_other_splits_have_fitted_changes_no_number():
    descriptors, labels, owners = clusters()
    tested = [owners % 3 == out for out in range(3)]

    def probabilities(memory):
        found = []
        for turn, test in enumerate([*tested, *tested]):
            projection, fits = tuning.fit_best_classifiers(
                descriptors[~test], labels[~test], owners[~test], 3,
                EVERY_CLASSIFIER, np.random.default_rng(turn), memory,
            )  # fmt: skip
            projected = projection.apply(descriptors[test])
            found += [classifier.ballots(projected).alone() for _, classifier, _ in fits]
        return np.array(found)

    assert np.array_equal(probabilities(tuning.FitMemory()), probabilities(None))


def test_a_new_classifier_counts_as_random_until_its_entry_says_otherwise(monkeypatch):
    drawn = []

    def fit(parameters, features, labels, seed):
        drawn.append(seed)
        return SVC().fit(features, labels), None

    entry = Classifier("new", "new classifier", fit, {"svm_penalty": (1.0,)})
    for module in (tuning, classifiers):
        monkeypatch.setattr(module, "CLASSIFIERS", Registry("classifier", entry))
    rows, labels, owners = clusters()
    folds = make_inner_folds(rows, labels, owners, BestParameters(), np.random.default_rng(0))
    for seed in range(2):
        fit_tuned_classifier(
            "new",
            ClassifierParameters(),
            FoldFits(None, rows, labels),
            folds,
            3,
            np.random.default_rng(seed),
        )
    # Both folds and all rows, each time with a seed of its own.
    assert len(set(drawn)) == 6


@pytest.mark.parametrize("entry", list(CLASSIFIERS), ids=lambda entry: entry.name)
def test_settings_that_are_tried_are_settings_that_exist(entry):
    for values in itertools.product(*entry.grid.values()):
        ClassifierParameters(**dict(zip(entry.grid, values, strict=True)))


def answers_alike(entry):
    descriptors, labels, _ = clusters(separation=0.3)
    # Of columns that come twice, one that draws takes now the one and now the other.
    doubled = np.concatenate([descriptors, descriptors], axis=1)
    shown = np.random.default_rng(1).normal(size=(200, doubled.shape[1]))
    scores = []
    for seed in range(5):
        fitted, _ = entry.fit(ClassifierParameters(), doubled, labels, seed)
        scores.append(class_scores(fitted, shown, 3))
    return all(np.array_equal(found, scores[0]) for found in scores)


@pytest.mark.parametrize("name", [entry.name for entry in CLASSIFIERS if entry.deterministic])
def test_a_deterministic_classifier_is_the_same_with_every_seed(name):
    assert answers_alike(CLASSIFIERS[name])


def test_a_decision_tree_depends_on_the_seed():
    assert not answers_alike(CLASSIFIERS["decision_tree"])


def test_an_unknown_classifier_is_refused():
    descriptors, labels, _ = clusters()
    with pytest.raises(RegistryError, match="'oracle' is no classifier; k_nearest_neighbours, "):
        classifiers.fit_classifier(
            "oracle", ClassifierParameters(), descriptors, labels, np.random.default_rng(0)
        )


def test_the_same_rows_are_projected_once_and_others_are_not_mistaken_for_them(monkeypatch):
    projected = []
    original = tuning.fit_projection
    monkeypatch.setattr(
        tuning, "fit_projection", lambda *values: projected.append(values) or original(*values)
    )
    rows, labels = np.random.default_rng(0).normal(size=(8, 5)), np.arange(8) % 2
    owners, best = np.arange(8), BestParameters(components=3)
    memory = tuning.FitMemory()
    first = memory.fits(rows, labels, owners, best)
    assert memory.fits(rows.copy(), labels.copy(), owners.copy(), best) is first
    others = [
        (rows + 1e-15, labels, owners, best),
        (rows, 1 - labels, owners, best),
        (rows, labels, owners // 2, best),
        (rows, labels, owners, BestParameters(components=2)),
        (rows, labels, owners, BestParameters(components=3, bags=())),
    ]
    assert all(memory.fits(*other) is not first for other in others)
    assert len(projected) == 6


def test_memory_lets_the_oldest_go():
    memory = tuning.FitMemory(sequences=20)
    tables = [np.random.default_rng(seed).normal(size=(8, 5)) for seed in range(3)]
    labels = np.arange(8) % 2
    rest = labels, np.arange(8), BestParameters()
    kept = [memory.fits(table, *rest) for table in tables]
    assert memory.fits(tables[2], *rest) is kept[2]
    assert memory.fits(tables[0], *rest) is not kept[0]


@pytest.mark.parametrize("smallest", [1.0, 1e-3, 1e-5, 1e-6])
def test_few_rows_are_projected_as_their_singular_vectors_do_it(smallest):
    generator = np.random.default_rng(4)
    left, _ = np.linalg.qr(generator.normal(size=(30, 30)))
    right, _ = np.linalg.qr(generator.normal(size=(200, 30)))
    spread = np.geomspace(1.0, smallest, 29)
    rows = left[:, :29] * spread @ right[:, :29].T
    found, directions = tuning._directions_of_few(rows)
    np.testing.assert_allclose(found[:29], spread, rtol=1e-7)
    assert found[29] < 1e-12
    np.testing.assert_allclose(directions[:29] @ directions[:29].T, np.eye(29), atol=1e-8)
    np.testing.assert_allclose(rows @ directions[:29].T @ directions[:29], rows, atol=1e-14)
