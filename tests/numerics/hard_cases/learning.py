"""Learning from samples that are too few, too alike, or of unhandy size."""

import warnings

import numpy as np
from numerics import oracles
from numerics.surfaces import pick

from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.classifiers import CLASSIFIERS
from visuohaptic.recognition.encoding import SequenceEncoder, fit_standardiser
from visuohaptic.recognition.experiment import UNFIT
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.self_organising_map import fit_batch_map, lattice, line
from visuohaptic.stability.findings import Finding

DEFAULT = RecognitionParameters()
MAY_BE_REFUSED = "one sample a class", "all samples identical", "features that vary by one ulp"
"""Samples of which no covariance can be taken; where features vary by rounding alone, they are identical."""


def hard_samples(generator):
    """Return features, shape (n, d), and classes that are hard to learn from, by name."""
    labels = np.arange(40) % 4
    plain = generator.normal(size=(40, 6)) + 3 * labels[:, None] * generator.normal(size=6)
    few = generator.normal(size=(8, 60))
    dead, outlier = plain.copy(), plain.copy()
    dead[:, 2:] = 5.0
    outlier[0, 0] = 1e12
    ulps = np.where(generator.random((40, 6)) < 0.5, 1.0, np.nextafter(1.0, 2))
    scales = plain * 10.0 ** np.array([-8, 8, -4, 4, 0, 8])
    return {
        "well behaved": (plain, labels),
        "identical samples in two classes": (np.repeat(plain[:20], 2, axis=0), np.arange(40) % 2),
        "all samples identical": (np.ones((40, 6)), labels),
        "collinear features": (plain[:, :1] * np.arange(1, 7), labels),
        "fewer samples than features": (few, np.arange(8) % 4),
        "one sample a class": (plain[:4], np.arange(4)),
        "features that never vary": (dead, labels),
        "features that vary by one ulp": (ulps, labels),
        "scales from 1e-8 to 1e8": (scales, labels),
        "one sample 1e12 away": (outlier, labels),
        "a class that never varies": (np.where(labels[:, None] == 1, 0.5, plain), labels),
    }


def fit_quietly(name, features, labels):
    """Fit a classifier; what scikit-learn warns of in hard samples is expected."""
    classifier = CLASSIFIERS[name].make(ClassifierParameters())
    if "random_state" in classifier.get_params():
        classifier.set_params(random_state=0)
    with warnings.catch_warnings(action="ignore"):
        return classifier.fit(features, labels)


def predict_quietly(fitted, features):
    """Classify samples; what scikit-learn warns of in hard samples is expected."""
    with warnings.catch_warnings(action="ignore"):
        return np.asarray(fitted.predict(features))


def classifiers(generator):
    """Fit a classifier on each of the hard samples: it gives a class for each, or a clear refusal."""
    name = str(generator.choice(CLASSIFIERS.names))
    for samples, (features, labels) in hard_samples(generator).items():
        scaled = fit_standardiser(features, "standardise").apply(features)
        try:
            found = predict_quietly(fit_quietly(name, scaled, labels), scaled)
        except UNFIT:
            wrong = samples not in MAY_BE_REFUSED
        else:
            wrong = not set(found.tolist()) <= set(labels.tolist()) or len(found) != len(labels)
            wrong |= samples == "well behaved" and bool((found == labels).mean() <= 0.25)
        label = f"{name} on {samples}"
        yield Finding("learning/every classifier ends in labels", wrong, label)


def draw_sequences(generator, classes=3, each=6, touches=5):
    """Draw touch sequences of well separated classes, shape (n, touches, 22), and their classes."""
    centres = 2 * generator.normal(size=(classes, 1, 1, 22))
    values = centres + generator.normal(size=(classes, each, touches, 22))
    return values.reshape(-1, touches, 22), np.repeat(np.arange(classes), each)


def predict_sequences(training, labels, tested, classifier, parameters=DEFAULT):
    """Learn from training sequences as the paper's pipeline does; give features and classes of others."""
    learnt, features = encode_sequences(training, tested, parameters)
    fitted = fit_quietly(classifier, learnt, labels)
    return features, predict_quietly(fitted, features)


def encode_sequences(training, tested, parameters):
    """Fit the encoder on training sequences; return the features of these and of others."""
    encoder = SequenceEncoder(parameters).fit(training)
    return encoder.transform(training), encoder.transform(tested)


def feature_units(generator):
    """Express features in other units: no answer changes.

    Each feature may have a unit of its own only where touches are standardised. Where they are not, the
    map sorts features by their values as they are, so that only a unit that all share leaves the groups.
    """
    classifier = str(generator.choice(CLASSIFIERS.names))
    training, labels = draw_sequences(generator)
    tested = training + 0.3 * generator.normal(size=training.shape)
    features = training.shape[-1]
    factors = 10.0 ** generator.integers(-8, 9, features)
    powers = generator.integers(-26, 27, features)
    ways = (
        ("standardise", "each standardised feature", factors, powers),
        ("none", "all features alike", factors[0], powers[0]),
    )
    for scaling, what, factor, power in ways:
        parameters = RecognitionParameters(touch_scaling=scaling)
        in_other_units = (training * factor, tested * factor)
        by_powers = (np.ldexp(training, power), np.ldexp(tested, power))
        (plain, predicted), (_, renamed), (scaled, _) = (
            predict_sequences(train, labels, test, classifier, parameters)
            for train, test in ((training, tested), in_other_units, by_powers)
        )
        yield _label_changes(f"{what} rescaled by 1e±8", predicted != renamed, classifier)
        name = f"learning/{what} rescaled by powers of two"
        yield Finding(name, (plain != scaled).any(), classifier)


def degenerate_sequences(generator):
    """Return touch sequences, shape (n, touches, 22), most of whose features hardly vary, by name; and classes."""
    values, labels = draw_sequences(generator)
    # Normals of a box are axes, and its flat imprints have no deviation in any sub-band.
    boxes = values.copy()
    boxes[..., :16] = 0.1
    boxes[..., 19:] = np.eye(3)[generator.integers(0, 3, values.shape[:2])]
    alike = np.repeat(values[:, :1], values.shape[1], axis=1)
    one_feature = np.full_like(values, 0.3)
    one_feature[..., 16] = values[..., 16]
    names = ("touches on boxes", "touches that are all alike", "one feature that varies")
    return dict(zip(names, (boxes, alike, one_feature), strict=True)), labels


def rounding(generator):
    """Change the last digit of features that hardly vary: no answer changes."""
    classifier = str(generator.choice(CLASSIFIERS.names))
    sequences, labels = degenerate_sequences(generator)
    for samples, training in sequences.items():
        changed = training * (1 + 1e-15 * generator.uniform(-1, 1, training.shape))
        _, predicted = predict_sequences(training[::2], labels[::2], training[1::2], classifier)
        _, renamed = predict_sequences(changed[::2], labels[::2], changed[1::2], classifier)
        name, label = "features changed by 1e-15", f"{classifier}, {samples}"
        yield _label_changes(name, predicted != renamed, label)


def _label_changes(requirement, changed, label):
    return Finding(
        f"learning/{requirement}",
        changed,
        lambda row: f"{label}, sequence {row}",
    )


def standardised_columns(generator):
    """Compare a standardised column with exact rationals."""
    exponent, scale = pick(generator, -6, 8), int(generator.integers(-150, 151))
    values = (10.0**exponent + generator.normal(size=64)) * 10.0**scale
    found = fit_standardiser(values[:, None], "standardise").apply(values[:, None])[:, 0]
    mean, second, _ = oracles.exact_moments(values)
    deviation = oracles.root(second)
    wanted = (oracles.exact(values) - mean).astype(float) / deviation
    name = "learning/standardised columns against exact rationals"
    error = np.abs(found - wanted).max()
    label = f"mean 1e{exponent:.1f} deviations, scale 1e{scale}"
    yield Finding(name, error, label)


def maps(generator):
    """Fit self-organising maps: units stay within their touches, even where some never win."""
    exponent = int(generator.choice([-100, -8, 0, 8, 100]))
    places = [lattice(2, 3), line(2), line(5), line(8)][generator.integers(4)]
    row = np.arange(40)[:, None]
    kinds = {
        "normal": generator.normal(size=(40, 5)),
        "identical": np.ones((40, 5)),
        "two places": np.where(row % 2, -1.0, 1.0) * np.ones(5),
        "a line": np.outer(generator.normal(size=40), np.arange(1, 6)),
        "one outlier": np.where(row == 0, 1e6, generator.normal(size=(40, 5))),
    }
    for kind, values in kinds.items():
        touches = values * 10.0**exponent
        fitted = fit_batch_map(touches, places)
        low, high = touches.min(axis=0), touches.max(axis=0)
        extent = max(float((high - low).max()), float(np.abs(touches).max()))
        outside = np.maximum(np.maximum(low - fitted.weights, fitted.weights - high) / extent, 0)
        error = outside.max() if np.isfinite(fitted.distances(touches)).all() else np.inf
        label = f"{kind}, {len(places)} units, scale 1e{exponent}"
        yield Finding("learning/map units stay within their touches", error, label)
