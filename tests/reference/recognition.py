"""Recognition once more, plainly: splits, the paper's map, the statistics of a sequence, classifiers, predictions.

Written from the paper, `docs/recognition.md` and the cited sources; rules that the page leaves out stand here. Nothing
of the product is imported. A sequence is an array (t, k): t touches in order, k features each.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from sklearn.covariance import ledoit_wolf_shrinkage
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.svm import SVC
from sklearn.tree import DecisionTreeClassifier

# Daubechies' filter of four taps (Ten Lectures on Wavelets, 1992, table 6.1), low pass, for decomposition.
ROOT = math.sqrt(3)
DB2_LOW = [(1 - ROOT) / (4 * math.sqrt(2)), (3 - ROOT) / (4 * math.sqrt(2)),
           (3 + ROOT) / (4 * math.sqrt(2)), (1 + ROOT) / (4 * math.sqrt(2))]  # fmt: skip
DB2_HIGH = [-DB2_LOW[3], DB2_LOW[2], -DB2_LOW[1], DB2_LOW[0]]

UNITS = 5
PASSES = 20
FIRST_RADIUS, LAST_RADIUS = 2.0, 0.5


# --- splits


def every_split(objects):
    """Return the test objects of each split: one object of each class, in every combination.

    `objects` are pairs (class, name). The first class varies slowest.
    """
    classes = sorted({a_class for a_class, _ in objects})
    members = [sorted(pair for pair in objects if pair[0] == a_class) for a_class in classes]
    return [set(chosen) for chosen in itertools.product(*members)]


# --- the paper's map


def batch_map(samples):
    """Return the unit of each sample of a self-organising map of five units in a row (Kohonen, Neural Networks 37, 2013).

    `samples` has shape (n, d). Units start evenly on the first principal component, from one standard deviation below the
    mean to one above. The direction's largest entry is positive. In each pass every unit becomes the mean of all samples,
    weighted by a Gaussian of the distance on the row between the unit and the sample's nearest unit.
    """
    count = len(samples)
    centre = samples.mean(axis=0)
    _, singular, directions = np.linalg.svd(samples - centre, full_matrices=False)
    spread = singular[0] / math.sqrt(count)
    along = directions[0] * np.sign(directions[0][np.argmax(np.abs(directions[0]))])
    units = np.array([centre + step * spread * along for step in np.linspace(-1, 1, UNITS)])
    radii = np.geomspace(FIRST_RADIUS, LAST_RADIUS, PASSES)
    nearest = nearest_units(samples, units)
    step = 0
    while True:
        radius = radii[min(step, PASSES - 1)]
        for unit in range(UNITS):
            weights = [math.exp(-((unit - other) ** 2) / (2 * radius**2)) for other in nearest]
            units[unit] = np.average(samples, axis=0, weights=weights)
        former, nearest = nearest, nearest_units(samples, units)
        step += 1
        if step >= PASSES and nearest == former:
            return nearest


def nearest_units(samples, units):
    """Return the index of the unit nearest to each sample."""
    return [int(np.argmin([np.sum((sample - unit) ** 2) for unit in units])) for sample in samples]


def feature_groups(training):
    """Return the group of each feature: the map sorts the k features, each known by its values in all training touches.

    `training` are sequences (t, k).
    """
    touches = np.concatenate(training)
    return batch_map(touches.T)


def group_means(sequence, groups):
    """Return the signals of a sequence, (t, 5): the mean of each group's features, 0 for an empty group."""
    signals = np.zeros((len(sequence), UNITS))
    for unit in range(UNITS):
        members = [feature for feature, group in enumerate(groups) if group == unit]
        if members:
            for touch, features in enumerate(sequence):
                signals[touch, unit] = sum(features[member] for member in members) / len(members)
    return signals


# --- the statistics of a sequence


def deviation(values):
    """Return the standard deviation, divided by N - 1."""
    mean = sum(values) / len(values)
    return math.sqrt(sum((value - mean) ** 2 for value in values) / (len(values) - 1))


def root_mean_square(values):
    """Return the root of the mean of the squares."""
    return math.sqrt(sum(value**2 for value in values) / len(values))


def skewness(values):
    """Return the third central moment over the second one's power of 1.5, 0 where values vary by rounding."""
    mean = sum(values) / len(values)
    second = sum((value - mean) ** 2 for value in values) / len(values)
    third = sum((value - mean) ** 3 for value in values) / len(values)
    return third / second**1.5 if math.sqrt(second) > 1e-12 * root_mean_square(values) else 0.0


def filtered(signal, taps):
    """Return every second value of the convolution with zeros beyond the ends: y[n] = sum over k of taps[k] x[2n + 1 - k]."""
    length = (len(signal) + len(taps) - 1) // 2
    result = []
    for place in range(length):
        total = 0.0
        for index, tap in enumerate(taps):
            source = 2 * place + 1 - index
            if 0 <= source < len(signal):
                total += tap * signal[source]
        result.append(total)
    return result


def wavelet_details(signal, levels=3):
    """Return the details of each level of a wavelet decomposition, the finest level first (Mallat, 1989)."""
    details = []
    approximation = list(signal)
    largest = max(abs(value) for value in signal)
    for _ in range(levels):
        level = filtered(approximation, DB2_HIGH)
        # Zeros of the filter leave rounding, whose skewness may be large.
        is_rounding = max(abs(value) for value in level) <= 1e-12 * largest
        details.append([0.0] * len(level) if is_rounding else level)
        approximation = filtered(approximation, DB2_LOW)
    return details


def sequence_statistics(signals):
    """Return the 60 numbers of a sequence of five signals: deviation, rms and skewness of each signal and of its details."""
    numbers = []
    for signal in np.asarray(signals, dtype=float).T:
        for values in [list(signal), *wavelet_details(signal)]:
            numbers += [deviation(values), root_mean_square(values), skewness(values)]
    return numbers


def paper_numbers(training, tested):
    """Return the classifier's inputs (n, 60) of training and test sequences: map, statistics, standardised."""
    groups = feature_groups(training)
    rows = [
        np.array([sequence_statistics(group_means(one, groups)) for one in some])
        for some in (training, tested)
    ]
    return standardised(
        *rows, sizes=np.tile([0.0, 0.0, 1.0], 20)
    )  # a skewness has no unit, its size is 1


def standardised(training, tested, sizes=0.0):
    """Return both arrays minus the training mean, divided by the training standard deviation (by N).

    A column that varies by at most 1e-12 of its largest value, or of `sizes`, varies by rounding and becomes 0.
    """
    mean, spread = training.mean(axis=0), training.std(axis=0)
    is_constant = spread <= 1e-12 * np.maximum(np.abs(training).max(axis=0), sizes)
    spread = np.where(is_constant, np.inf, spread)
    return (training - mean) / spread, (tested - mean) / spread


# --- the descriptors of pipeline order_free

SHORTEST = 1e-6
"""Shorter vectors have no direction: they are divided by this length (object radii)."""


def four_statistics(rows):
    """Return mean, standard deviation (divided by N), minimum and maximum of each column; zeros without a row."""
    columns = list(zip(*rows, strict=True))
    means = [sum(column) / len(column) for column in columns]
    deviations = [
        math.sqrt(sum((value - mean) ** 2 for value in column) / len(column))
        for column, mean in zip(columns, means, strict=True)
    ]
    return (
        means
        + deviations
        + [min(column) for column in columns]
        + [max(column) for column in columns]
    )


def pose_in_three_ways(point, normal):
    """Return 16 numbers of a touch: in the object frame (6), mirrored (5), and free of azimuth (5)."""
    x, _, z = point
    normal_x, _, normal_z = normal
    axial, radius = math.hypot(x, z), math.sqrt(sum(value**2 for value in point))
    outward = sum(one * other for one, other in zip(point, normal, strict=True)) / max(
        radius, SHORTEST
    )
    radial = (x * normal_x + z * normal_z) / max(axial, SHORTEST)
    around = abs(x * normal_z - z * normal_x) / max(axial, SHORTEST)
    mirrored = [abs(x), abs(z), *(abs(value) for value in normal)]
    return [*point, *normal, *mirrored, axial, radius, outward, radial, around]


def pair_relations(points, normals):
    """Return 27 numbers: four statistics of six numbers over all pairs of touches, and the extents of the points."""
    rows = []
    for first, second in itertools.combinations(range(len(points)), 2):
        step = points[second] - points[first]
        distance = math.sqrt(step @ step)
        along = step / max(distance, SHORTEST)
        leaving, arriving = normals[first] @ along, normals[second] @ along
        rows.append([
            distance, abs(step[1]), math.hypot(step[0], step[2]),
            normals[first] @ normals[second], arriving - leaving, abs(arriving + leaving),
        ])  # fmt: skip
    statistics = four_statistics(rows) if rows else [0.0] * 24
    centred = points - points.mean(axis=0)
    # Singular values of the centred points over the root of their number: deviations along the principal axes.
    lengths = np.linalg.svd(centred, compute_uv=False) / math.sqrt(len(points))
    return statistics + sorted([*lengths, *[0.0] * (3 - len(lengths))])


def wave_means(points, normals, directions, phases):
    """Return the mean of each wave over the touches, times the root of 2 (Rahimi and Recht, NIPS 2007).

    `directions` (6, w) and `phases` (w,) are the random draws. The sides of x count alike, in position and normal.
    """
    means = []
    for wave, phase in zip(directions.T, phases, strict=True):
        total = 0.0
        for point, normal in zip(points, normals, strict=True):
            pose = [abs(point[0]), point[1], point[2], abs(normal[0]), normal[1], normal[2]]
            total += math.cos(
                sum(one * other for one, other in zip(pose, wave, strict=True)) + phase
            )
        means.append(math.sqrt(2) * total / len(points))
    return means


def order_free_descriptors(bands, imprints, sizes, states, points, normals, directions, phases):
    """Return the 516 descriptors of a sequence.

    `bands` (t, 16) and `imprints` (t, 13) are the columns of the table, `sizes` (t,) the sensor's sizes, and `states`
    (t, 5) has 1 in the column of the contact state.
    """
    described = four_statistics(bands) + four_statistics(imprints)
    described += four_statistics([[math.log(max(size, SHORTEST))] for size in sizes])
    described += [sum(column) / len(column) for column in zip(*states, strict=True)]
    described += four_statistics(
        [pose_in_three_ways(*touch) for touch in zip(points, normals, strict=True)]
    )
    return (
        described
        + pair_relations(points, normals)
        + wave_means(points, normals, directions, phases)
    )


def scaled_and_rotated(training, tested):
    """Return the inputs of a classifier of `order_free`: standardised, then rotated to the principal components.

    Components beyond 1 - 1e-9 of the variance are left out.
    """
    training, tested = standardised(training, tested)
    centre = training.mean(axis=0)
    _, scales, components = np.linalg.svd(training - centre, full_matrices=False)
    shares = np.cumsum(scales**2) / np.sum(scales**2)
    kept = int(np.sum(shares <= 1 - 1e-9)) + 1
    return (training - centre) @ components[:kept].T, (tested - centre) @ components[:kept].T


# --- classifiers


class QuadraticDiscriminant:
    """One Gaussian per class (Hastie, Tibshirani, Friedman 2009, eq. 4.12); priors are the shares of training sequences.

    `fixed` is None in pipeline `paper`: if the covariance of a class is singular, all classes' covariances are shrunk
    towards their own variances, each by its amount of Ledoit and Wolf. Pipeline `order_free` always shrinks, by `fixed`
    towards the mean variance.
    """

    def __init__(self, fixed=None):
        self.fixed = fixed

    def fit(self, rows, labels):
        labels = list(labels)
        self.classes_ = sorted(set(labels))
        groups = [rows[[label == a_class for label in labels]] for a_class in self.classes_]
        covariances = [
            group.T @ group / len(group)
            for group in (group - group.mean(axis=0) for group in groups)
        ]
        is_singular = any(
            len(group) <= rows.shape[1] or np.linalg.eigvalsh(covariance)[0] <= 1e-4
            for group, covariance in zip(groups, covariances, strict=True)
        )
        if self.fixed is not None or is_singular:
            floor = 1e-6 * rows.var(axis=0).mean() * np.eye(rows.shape[1])
            covariances = [
                self.shrunk(group, own) + floor
                for group, own in zip(groups, covariances, strict=True)
            ]
        self.gaussians = []
        for group, covariance in zip(groups, covariances, strict=True):
            _, logarithm = np.linalg.slogdet(covariance)
            prior = math.log(len(group) / len(rows))
            self.gaussians.append((prior, group.mean(axis=0), np.linalg.inv(covariance), logarithm))
        return self

    def shrunk(self, group, covariance):
        if self.fixed is not None:
            scale, amount = np.ones(len(covariance)), self.fixed
        else:
            # Features at their own deviations, so that the target has their own variances.
            scale = np.sqrt(np.diag(covariance))
            divisor = np.where(scale > 0, scale, 1.0)
            group = (group - group.mean(axis=0)) / divisor
            covariance = covariance / np.outer(divisor, divisor)
            amount = ledoit_wolf_shrinkage(group)
        target = np.trace(covariance) / len(covariance) * np.eye(len(covariance))
        return ((1 - amount) * covariance + amount * target) * np.outer(scale, scale)

    def predict_log_proba(self, rows):
        scores = np.array([
            [prior - logarithm / 2 - (row - mean) @ inverse @ (row - mean) / 2 for prior, mean, inverse, logarithm in self.gaussians]
            for row in rows
        ])  # fmt: skip
        return log_shares(scores)

    def predict(self, rows):
        return np.array(
            [self.classes_[index] for index in np.argmax(self.predict_log_proba(rows), axis=1)]
        )


def paper_classifiers(tree_seed):
    """Return the five classifiers of pipeline `paper` with scikit-learn's defaults; a seed settles ties within a tree."""
    return {
        "k_nearest_neighbours": KNeighborsClassifier(),
        "support_vector_machine": SVC(),
        "decision_tree": DecisionTreeClassifier(random_state=tree_seed),
        "quadratic_discriminant": QuadraticDiscriminant(),
        "naive_bayes": GaussianNB(),
    }


def order_free_classifiers(tree_seed):
    """Return the six classifiers of pipeline `order_free` with the settings of `docs/recognition.md`."""
    return {
        "k_nearest_neighbours": KNeighborsClassifier(15),
        "support_vector_machine": SVC(C=10.0),
        "decision_tree": DecisionTreeClassifier(min_samples_leaf=8, random_state=tree_seed),
        "quadratic_discriminant": QuadraticDiscriminant(fixed=0.9),
        "naive_bayes": GaussianNB(var_smoothing=0.01),
        "linear_discriminant": LinearDiscriminantAnalysis(solver="lsqr", shrinkage=0.1),
    }


def log_shares(scores):
    """Return scores minus the logarithm of the sum of their exponentials, row by row."""
    scores = scores - scores.max(axis=1, keepdims=True)
    return scores - np.log(np.exp(scores).sum(axis=1, keepdims=True))


def log_probabilities(classifier, rows):
    """Return the log probability of each class, at least -60; a support vector machine's are shares of its scores."""
    if isinstance(classifier, SVC):
        scores = classifier.decision_function(rows)
        logs = log_shares(np.array([[-one, one] for one in scores]) if scores.ndim == 1 else scores)
    elif isinstance(classifier, QuadraticDiscriminant):
        logs = classifier.predict_log_proba(rows)
    else:
        with np.errstate(divide="ignore"):
            logs = np.log(classifier.predict_proba(rows))
    return np.maximum(logs, -60.0)


# --- accuracies


def share_correct(predicted, truth):
    """Return the share of predictions that are the true class."""
    return sum(one == other for one, other in zip(predicted, truth, strict=True)) / len(truth)


def majority_vote(predicted, truth):
    """Return how correct an object is by the majority of its sequences: 1, 0, or 1/k for a tie between k classes."""
    counts = {one: list(predicted).count(one) for one in predicted}
    most = max(counts.values())
    winners = [one for one, count in counts.items() if count == most]
    return 1 / len(winners) if truth in winners else 0.0


def probability_vote(logs, classes):
    """Return the classes with the largest mean of the log probabilities (n, c) of an object's sequences.

    Several classes tie if their means differ by rounding only, 1e-9.
    """
    means = [sum(column) / len(column) for column in zip(*logs, strict=True)]
    return {
        a_class for a_class, mean in zip(classes, means, strict=True) if mean > max(means) - 1e-9
    }
