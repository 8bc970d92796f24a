"""Choices inside the training objects."""

import itertools

import numpy as np
import pytest
from recognition.synthetic import clusters
from scipy.spatial.distance import pdist
from sklearn.linear_model import LogisticRegression
from sklearn.neighbors import KNeighborsClassifier
from sklearn.svm import SVC

from visuohaptic.base.registry import Registry
from visuohaptic.recognition import classifiers, tuning
from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.classifiers import (
    CLASSIFIERS,
    Classifier,
)
from visuohaptic.recognition.memory import FitMemory
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import LEAST_SCORE, best_temperature, softmax

EVERY_CLASSIFIER = RecognitionParameters(best=BestParameters(classifiers=CLASSIFIERS.names))


def folds_of(descriptors, labels, owners, memory=None, **settings):
    generator = np.random.default_rng(0)
    return tuning.make_inner_folds(
        descriptors, labels, owners, BestParameters(**settings), generator, memory
    )


def tuned(name, descriptors, labels, folds, seed=0):
    """Tune a classifier that answers without one of bags."""
    fits, generator = tuning.FoldFits(None, descriptors, labels), np.random.default_rng(seed)
    return tuning.fit_tuned_classifier(name, RecognitionParameters(), fits, folds, 3, generator)[0]


def test_projection_keeps_distances_orders_components_by_variance_and_drops_empty_ones():
    descriptors, _, _ = clusters(columns=6)
    doubled = np.concatenate([descriptors, descriptors, np.ones((len(descriptors), 2))], axis=1)
    projected = tuning.fit_projection(doubled, 64).apply(doubled)
    assert projected.shape[1] == 6
    assert np.all(np.diff(projected.var(axis=0)) <= 0)
    standard = (descriptors - descriptors.mean(axis=0)) / descriptors.std(axis=0)
    np.testing.assert_allclose(pdist(projected), np.sqrt(2) * pdist(standard), atol=1e-9)


def test_inner_folds_hold_out_whole_objects_and_project_without_them():
    descriptors, labels, owners = clusters()
    folds = folds_of(descriptors, labels, owners)
    assert len(folds) == tuning.INNER_FOLDS
    assert sum(len(fold.held_out) for fold in folds) == len(labels)
    for fold in folds:
        assert len(fold.fits.train) + len(fold.held_out) == len(labels)
        np.testing.assert_allclose(fold.fits.train.mean(axis=0), 0, atol=1e-12)


def test_class_with_one_training_object_is_never_held_out_from_a_fold_that_lacks_it():
    for fold in folds_of(*clusters(objects=(1, 3, 3))):
        assert set(fold.held_out_labels) <= set(fold.fits.labels)


def test_without_a_second_object_a_class_the_simplest_setting_is_taken():
    descriptors, labels, owners = clusters(objects=(1, 1))
    assert folds_of(descriptors, labels, owners) == []
    found = tuned("support_vector_machine", descriptors, labels, [])
    assert found.setting == "svm_penalty 1.0"
    assert found.temperature == 1


@pytest.mark.parametrize("name", CLASSIFIERS.names)
def test_every_classifier_gives_probabilities_also_of_a_class_it_never_saw(name):
    descriptors, labels, owners = clusters(objects=(2, 2))
    probabilities = tuned(name, descriptors, labels * 2, []).ballots(descriptors).alone()
    np.testing.assert_allclose(probabilities.sum(axis=1), 1)
    assert probabilities[:, 1].max() < 1e-9
    folds = folds_of(descriptors, labels, owners)
    found = tuned(name, descriptors, labels, folds).ballots(descriptors).alone()
    assert (found.argmax(axis=1) == labels).mean() > 0.9


def test_the_setting_with_the_least_log_loss_wins_at_its_own_temperature():
    descriptors, labels, owners = clusters(separation=0.1)
    folds = folds_of(descriptors, labels, owners)
    held_out = np.concatenate([fold.held_out_labels for fold in folds])
    losses = {}
    for count in CLASSIFIERS["k_nearest_neighbours"].grid["neighbours"]:
        votes = KNeighborsClassifier(count)
        found = [
            tuning.class_scores(votes.fit(fold.fits.train, fold.fits.labels), fold.held_out, 3)
            for fold in folds
        ]
        losses[f"neighbours {count}"] = best_temperature(np.concatenate(found), held_out)
    chosen = tuned("k_nearest_neighbours", descriptors, labels, folds)
    assert chosen.setting == min(losses, key=losses.get) != next(iter(losses))
    assert chosen.temperature == losses[chosen.setting][1]


def test_scores_of_two_classes_favour_the_one_that_the_machine_names():
    descriptors, labels, _ = clusters(objects=(2, 2))
    machine = SVC().fit(descriptors, labels)
    scores = tuning.class_scores(machine, descriptors, 2)
    np.testing.assert_array_equal(scores.argmax(axis=1), machine.predict(descriptors))
    assert scores.min() > LEAST_SCORE


@pytest.mark.slow
def test_what_other_splits_have_fitted_changes_no_number():
    descriptors, labels, owners = clusters(separation=0.3)
    tested = [owners % 3 == out for out in range(3)]

    def probabilities(memory):
        found = []
        for turn, test in enumerate([*tested, *tested]):
            training = (descriptors[~test], labels[~test], owners[~test], 3, EVERY_CLASSIFIER)
            generator = np.random.default_rng(turn % 3)
            projection, fits = tuning.fit_best_classifiers(*training, generator, memory)
            projected = projection.apply(descriptors[test])
            found += [classifier.ballots(projected).alone() for _, classifier, _ in fits]
        return np.array(found)

    assert np.array_equal(probabilities(FitMemory(1000)), probabilities(None))


def test_a_new_classifier_counts_as_random_until_its_entry_says_otherwise(monkeypatch):
    drawn = []

    def fit(parameters, features, labels, seed):
        drawn.append(seed)
        return SVC().fit(features, labels), None

    entry = Classifier("new", "new classifier", fit, {"svm_penalty": (1.0,)})
    for module in (tuning, classifiers):
        monkeypatch.setattr(module, "CLASSIFIERS", Registry("classifier", entry))
    rows, labels, owners = clusters()
    folds = folds_of(rows, labels, owners)
    for seed in range(2):
        tuned("new", rows, labels, folds, seed)
    # Both folds and all rows, each time with a seed of its own.
    assert len(set(drawn)) == 6


@pytest.mark.parametrize("entry", list(CLASSIFIERS), ids=lambda entry: entry.name)
def test_settings_that_are_tried_are_settings_that_exist(entry):
    for values in itertools.product(*entry.grid.values()):
        ClassifierParameters(**dict(zip(entry.grid, values, strict=True)))


@pytest.mark.parametrize("entry", list(CLASSIFIERS), ids=lambda entry: entry.name)
def test_a_classifier_that_counts_as_deterministic_is_the_same_with_every_seed(entry):
    descriptors, labels, _ = clusters(separation=0.3)
    # Of columns that come twice, one that draws takes now the one and now the other.
    doubled = np.concatenate([descriptors, descriptors], axis=1)
    shown = np.random.default_rng(1).normal(size=(200, doubled.shape[1]))
    scores = []
    for seed in range(5):
        fitted, _ = entry.fit(ClassifierParameters(), doubled, labels, seed)
        scores.append(tuning.class_scores(fitted, shown, 3))
    assert all(np.array_equal(found, scores[0]) for found in scores) == entry.deterministic


def test_folds_share_the_fits_of_the_same_rows_classes_objects_and_settings_alone():
    rows, labels, owners = clusters()
    memory = FitMemory(1000)

    def fits(*learnt, **settings):
        return [id(fold.fits) for fold in folds_of(*learnt, memory, **settings)]

    known = [fits(rows, labels, owners)]
    assert fits(rows.copy(), labels.copy(), owners.copy()) == known[0]
    known += [fits(rows + 1e-9, labels, owners), fits(rows, labels + 1, owners)]
    known += [fits(rows, labels, owners + 1), fits(rows, labels, owners, components=2)]
    known += [fits(rows, labels, owners, bags=())]
    assert len(set(itertools.chain(*known))) == 2 * len(known)


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


def test_scores_are_logarithms_of_probabilities():
    descriptors, labels, _ = clusters(objects=(2, 2))
    regression = LogisticRegression().fit(descriptors, labels)
    scores = tuning.class_scores(regression, descriptors, 2)
    np.testing.assert_allclose(softmax(scores), regression.predict_proba(descriptors))
