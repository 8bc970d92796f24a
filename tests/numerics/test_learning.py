"""Learning from samples that are too few, too alike, or of unhandy size."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numerics import drawings, oracles
from numerics.shapes import is_one_sentence
from numerics.tolerances import U64

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.classifiers import (
    CLASSIFIERS,
    ClassifierParameters,
    fit_classifier,
)
from visuohaptic.recognition.encoding import fit_sequence_encoder, fit_standardiser
from visuohaptic.recognition.parameters import (
    RecognitionParameters,
    SelfOrganisingMapParameters,
)
from visuohaptic.recognition.self_organising_map import fit_batch_map, lattice, line
from visuohaptic.recognition.tuning import fit_projection

SEEDS = st.integers(0, 2**32 - 1)


def hard_samples(generator):
    """Give features, shape (n, d), and labels that are hard to learn from, by name."""
    plain = generator.normal(size=(40, 6)) + 3 * (np.arange(40) % 4)[:, None] * generator.normal(
        size=6
    )
    labels = np.arange(40) % 4
    few = generator.normal(size=(8, 60))
    collinear = plain[:, :1] * np.arange(1, 7)
    dead = plain.copy()
    dead[:, 2:] = 5.0
    ulps = np.where(generator.random((40, 6)) < 0.5, 1.0, np.nextafter(1.0, 2))
    scales = plain * 10.0 ** np.array([-8, 8, -4, 4, 0, 8])
    outlier = plain.copy()
    outlier[0, 0] = 1e12
    return {
        "well behaved": (plain, labels),
        "identical samples in two classes": (np.repeat(plain[:20], 2, axis=0), np.arange(40) % 2),
        "all samples identical": (np.ones((40, 6)), labels),
        "collinear features": (collinear, labels),
        "fewer samples than features": (few, np.arange(8) % 4),
        "one sample a class": (plain[:4], np.arange(4)),
        "features that never vary": (dead, labels),
        "features that vary by one ulp": (ulps, labels),
        "scales from 1e-8 to 1e8": (scales, labels),
        "one sample 1e12 away": (outlier, labels),
        "a class that never varies": (np.where(labels[:, None] == 1, 0.5, plain), labels),
    }


@pytest.mark.parametrize("name", CLASSIFIERS.names)
@pytest.mark.parametrize("samples", hard_samples(np.random.default_rng(0)))
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(k, marks=pytest.mark.hard) for k in range(1, 8))]
)
@pytest.mark.filterwarnings("ignore")
def test_every_classifier_ends_in_labels(hold, name, samples, seed):
    features, labels = hard_samples(np.random.default_rng(seed))[samples]
    scaling = fit_standardiser(features, "standardise")
    generator = np.random.default_rng(seed)
    try:
        fitted, _ = fit_classifier(
            name, ClassifierParameters(), scaling.apply(features), labels, generator
        )
    except RecognitionError as error:
        # A covariance of one sample, or of none that differ, is refused.
        assert samples in ("one sample a class", "all samples identical")
        found, wrong = labels, not is_one_sentence(str(error))
    else:
        found = fitted.predict(scaling.apply(features))
        wrong = not set(found.tolist()) <= set(labels.tolist()) or len(found) != len(labels)
    hold(
        "learning/every classifier ends in labels",
        wrong,
        f"{name} on {samples} (seed {seed})",
        drawings.image(scaling.apply(features), samples),
    )
    if samples == "well behaved":
        assert (found == labels).mean() > 0.25


def sequences_of_classes(generator, classes=3, each=6, touches=5, features=22):
    centres = 2 * generator.normal(size=(classes, 1, 1, features))
    values = centres + generator.normal(size=(classes, each, touches, features))
    return values.reshape(-1, touches, features), np.repeat(np.arange(classes), each)


def labels_of(training, labels, tested, parameters, classifier="support_vector_machine"):
    encoder = fit_sequence_encoder(training, parameters, np.random.default_rng(0))
    fitted, _ = fit_classifier(
        classifier,
        parameters.classifier,
        encoder.encode(training),
        labels,
        np.random.default_rng(0),
    )
    return encoder.encode(tested), fitted.predict(encoder.encode(tested))


@given(seed=SEEDS, classifier=st.sampled_from(CLASSIFIERS.names))
@pytest.mark.filterwarnings("ignore")
def test_the_unit_of_a_feature_moves_no_label(hold, seed, classifier):
    generator = np.random.default_rng(seed)
    training, labels = sequences_of_classes(generator)
    tested, _ = sequences_of_classes(np.random.default_rng(seed))
    tested = tested + 0.3 * generator.normal(size=tested.shape)
    parameters = RecognitionParameters()
    plain, named = labels_of(training, labels, tested, parameters, classifier)
    factors = 10.0 ** generator.integers(-8, 9, training.shape[-1])
    _, renamed = labels_of(training * factors, labels, tested * factors, parameters, classifier)
    hold(
        "learning/features rescaled by 1e±8",
        named != renamed,
        lambda row: f"{classifier}, sequence {row} (seed {seed})",
        drawings.sequence(np.log10(factors), "the powers of ten"),
    )
    powers = generator.integers(-26, 27, training.shape[-1])
    scaled, _ = labels_of(
        np.ldexp(training, powers), labels, np.ldexp(tested, powers), parameters, classifier
    )
    hold(
        "learning/features rescaled by powers of two",
        (plain != scaled).ravel(),
        f"{classifier} (seed {seed})",
    )


@given(seed=SEEDS, exponent=st.floats(-6, 8), scale=st.integers(-150, 150))
def test_standardised_columns_agree_with_exact_rationals(hold, seed, exponent, scale):
    generator = np.random.default_rng(seed)
    values = (10.0**exponent + generator.normal(size=64)) * 10.0**scale
    found = fit_standardiser(values[:, None], "standardise").apply(values[:, None])[:, 0]
    mean, second, _ = oracles.exact_moments(values)
    deviation = oracles.root(second)
    wanted = [float(oracles.Fraction(float(v)) - mean) / deviation for v in values]
    hold(
        "learning/standardised columns against exact rationals",
        np.abs(found - wanted),
        f"mean 1e{exponent:.1f} deviations, scale 1e{scale} (seed {seed})",
    )


@given(
    seed=SEEDS,
    kind=st.sampled_from(["normal", "identical", "two places", "a line", "one outlier"]),
    units=st.sampled_from([2, 5, 8]),
    plane=st.booleans(),
    exponent=st.sampled_from([-100, -8, 0, 8, 100]),
)
def test_a_map_stays_within_its_touches_even_where_units_die(
    hold, seed, kind, units, plane, exponent
):
    generator = np.random.default_rng(seed)
    touches = {
        "normal": generator.normal(size=(40, 5)),
        "identical": np.ones((40, 5)),
        "two places": np.where(np.arange(40)[:, None] % 2, -1.0, 1.0) * np.ones(5),
        "a line": np.outer(generator.normal(size=40), np.arange(1, 6)),
        "one outlier": np.where(np.arange(40)[:, None] == 0, 1e6, generator.normal(size=(40, 5))),
    }[kind] * 10.0**exponent
    places = lattice(2, 3) if plane else line(units)
    fitted = fit_batch_map(touches, places, SelfOrganisingMapParameters())
    low, high = touches.min(axis=0), touches.max(axis=0)
    extent = max(float((high - low).max()), float(np.abs(touches).max()))
    outside = np.maximum(low - fitted.weights, fitted.weights - high) / extent
    hold(
        "learning/map units stay within their touches",
        np.maximum(outside, 0).ravel(),
        f"{kind}, {len(places)} units, scale 1e{exponent} (seed {seed})",
        drawings.sequence(touches[:, 0], "the touches' first feature"),
    )
    assert np.isfinite(fitted.distances(touches)).all()


@given(seed=SEEDS, rows=st.integers(2, 12), exponent=st.sampled_from([-8, 0, 8]))
def test_a_projection_of_too_few_rows_keeps_distances(hold, seed, rows, exponent):
    generator = np.random.default_rng(seed)
    values = generator.normal(size=(rows, 40)) * 10.0 ** (exponent * (np.arange(40) % 2))
    projection = fit_projection(values, 64)
    scaled = projection.scaling.apply(values)
    found = projection.apply(values)
    wanted = np.linalg.norm(scaled[:, None] - scaled[None], axis=2)
    error = np.abs(np.linalg.norm(found[:, None] - found[None], axis=2) - wanted)
    assert projection.components.shape[1] <= rows
    # Directions below 1e-9 of the largest are left out on purpose.
    assert error.max() <= 4e-8 * max(wanted.max(), 1) + 64 * U64
