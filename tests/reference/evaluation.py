"""Evaluation once more, plainly: accuracies of objects, means over draws, leads, intervals, tests, Holm's correction.

Written from `docs/intervals.md`, `docs/probing.md` and the cited sources. Nothing of the product is imported.
Accuracies and leads are shares, not percentages. `values` and `weights` have one entry per object.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from scipy.stats import t as student

EXTRA = 0.75
"""The weight of the extra object, in objects."""


# --- figures


def object_accuracies(rows):
    """Return the accuracy and the weight of each object from rows (object, split, predicted, true class) of sequences.

    A split's accuracy is the share of its sequences that are correctly classified, and the figure is the mean over
    splits. So a sequence weighs one over the number of sequences of its split. An object's weight is the sum of the
    weights of its sequences, and its accuracy is their weighted mean: the weighted mean of objects is the mean of splits.
    """
    in_split: dict = {}
    for _, split, _, _ in rows:
        in_split[split] = in_split.get(split, 0) + 1
    correct: dict = {}
    weight: dict = {}
    for owner, split, predicted, truth in rows:
        share = 1 / in_split[split]
        weight[owner] = weight.get(owner, 0.0) + share
        correct[owner] = correct.get(owner, 0.0) + share * (predicted == truth)
    return {owner: (correct[owner] / weight[owner], weight[owner]) for owner in sorted(weight)}


def mean_over_splits(rows):
    """Return the mean over splits of the share of sequences that are correctly classified."""
    splits = sorted({row[1] for row in rows})
    shares = []
    for split in splits:
        answers = [predicted == truth for _, own, predicted, truth in rows if own == split]
        shares.append(sum(answers) / len(answers))
    return sum(shares) / len(shares)


def accuracies_from_shares(rows):
    """Return `object_accuracies` from rows of a study: one per object and split, with accuracy and number of sequences."""
    in_split: dict = {}
    for row in rows:
        in_split[row["split"]] = in_split.get(row["split"], 0) + row["sequences"]
    sums: dict = {}
    for row in rows:
        share = row["sequences"] / in_split[row["split"]]
        # The accuracy is a share of the sequences; kept in single precision, it is rounded.
        right = round(row["accuracy"] * row["sequences"]) / row["sequences"]
        correct, weight = sums.get((row["class"], row["object"]), (0.0, 0.0))
        sums[row["class"], row["object"]] = (correct + share * right, weight + share)
    return {owner: (correct / weight, weight) for owner, (correct, weight) in sorted(sums.items())}


def object_votes(credit):
    """Return the vote and the weight of each object from its credit, by (split, object): as `object_accuracies`."""
    in_split: dict = {}
    for split, _ in credit:
        in_split[split] = in_split.get(split, 0) + 1
    sums: dict = {}
    for (split, owner), value in credit.items():
        vote, weight = sums.get(owner, (0.0, 0.0))
        sums[owner] = (vote + value / in_split[split], weight + 1 / in_split[split])
    return {owner: (vote / weight, weight) for owner, (vote, weight) in sorted(sums.items())}


def mean_of_splits(credit):
    """Return the mean over splits of the mean credit of a split's objects."""
    by_split: dict = {}
    for (split, _), value in credit.items():
        by_split.setdefault(split, []).append(value)
    return sum(sum(values) / len(values) for values in by_split.values()) / len(by_split)


def mean_of_draws(draws):
    """Return each object's mean accuracy and mean weight over the draws that tested it; objects of the first draw count.

    A draw maps an object to its (accuracy, weight).
    """
    means = {}
    for owner in draws[0]:
        own = [draw[owner] for draw in draws if owner in draw]
        means[owner] = tuple(sum(pair[part] for pair in own) / len(own) for part in (0, 1))
    return means


def weighted_mean(values, weights):
    """Return the mean of values with weights."""
    return sum(value * weight for value, weight in zip(values, weights, strict=True)) / sum(weights)


def balanced_weights(classes):
    """Return one over the number of objects of each object's class."""
    return [1 / classes.count(a_class) for a_class in classes]


def paired_differences(first, second):
    """Return the differences (first minus second) and the weights of the first, of the objects that both have."""
    shared = [owner for owner in first if owner in second]
    return (
        shared,
        [first[owner][0] - second[owner][0] for owner in shared],
        [first[owner][1] for owner in shared],
    )


# --- the interval of an accuracy


def share_below_zero(factors, shapes):
    """Return the chance that a sum of factors times independent gamma variables is at most 0.

    Gil-Pelaez (Biometrika 38, 1951): 1/2 minus 1/pi times the integral of Im(phi(u)) / u over u > 0, with the
    characteristic function phi(u) = product of (1 - i factor u) ** -shape. With u = exp(v) the integrand has no pole.
    """
    factors, shapes = np.asarray(factors, dtype=float), np.asarray(shapes, dtype=float)
    factors = factors / np.abs(factors).max()
    step = 0.06
    along = np.exp(np.arange(-30, 30, step))[:, None] * factors
    modulus = np.exp(-(shapes / 2 * np.log1p(along**2)).sum(axis=1))
    angle = (shapes * np.arctan(along)).sum(axis=1)
    return 0.5 - float((modulus * np.sin(angle)).sum()) * step / math.pi


def random_mean_quantile(values, weights, shapes, share):
    """Return the quantile of the mean of values with random weights: gamma variables of the shapes, times the weights."""
    low, high = min(values), max(values)
    for _ in range(36):
        middle = (low + high) / 2
        factors = [weight * (value - middle) for value, weight in zip(values, weights, strict=True)]
        if max(factors) <= 0 or (min(factors) < 0 and share_below_zero(factors, shapes) >= share):
            high = middle
        else:
            low = middle
    return (low + high) / 2


def extra_weight(weights):
    """Return the weight of the extra object: the mean of the weights, each weighted by itself."""
    return weighted_mean(weights, weights)


def low_end(values, weights, share, least=None):
    """Return the low end: the smaller of the quantile for observed variation and the one for unobserved failures.

    `least` is the worst possible value, None without bound.
    """
    count = len(values)
    shapes = [1.0] * count + [EXTRA]
    with_extra = [*weights, extra_weight(weights)]
    ends = [random_mean_quantile([*values, min(values)], with_extra, shapes, share)]
    if least is not None:
        ends.append(
            random_mean_quantile([max(values)] * count + [least], with_extra, shapes, share)
        )
    return min(ends)


def accuracy_interval(values, weights, confidence=0.95, bounds=(0.0, 1.0)):
    """Return the ends of the interval of the weighted mean; the high end is the mirror image of the low end.

    A bound is None for a measure without it.
    """
    share = (1 - confidence) / 2
    least, most = bounds
    mirrored = [-value for value in values]
    return (
        low_end(values, weights, share, least),
        -low_end(mirrored, weights, share, None if most is None else -most),
    )


# --- the interval and test of a lead


def sign_changes(count, drawn=None):
    """Return sign changes as tuples of booleans, True for objects whose sign changes: all, or drawn ones and no change."""
    if drawn is None:
        return list(itertools.product([False, True], repeat=count))
    return [*drawn, (False,) * count]


def sign_change_p(differences, weights, lead=0.0, drawn=None):
    """Return the share of all sign changes of (differences - lead) with a weighted sum as far from 0 as the true one.

    `drawn` are random sign changes in place of all; the observed signs are added.
    """
    terms = [weight * (one - lead) for one, weight in zip(differences, weights, strict=True)]
    observed, rounding = abs(sum(terms)), 1e-12 * sum(abs(term) for term in terms)
    groups = sign_changes(len(terms), drawn)
    as_far = 0
    for changed in groups:
        total = sum(-term if change else term for term, change in zip(terms, changed, strict=True))
        as_far += abs(total) >= observed - rounding
    return as_far / len(groups)


def sign_change_interval(differences, weights, confidence=0.95, drawn=None):
    """Return the least and the largest lead that the sign changes do not reject; infinite ends if nothing is rejected.

    With sign changes of a group, the sum is as far from 0 exactly if the lead lies between the mean of the group and the
    mean of the others. One of the two is at most the mean of all, the other at least.
    """
    count = len(differences)
    groups = sign_changes(count, drawn)
    lower, upper, always = [], [], 0
    for changed in groups:
        if all(changed) or not any(changed):
            always += 1
            continue
        means = []
        for side in (True, False):
            group = [index for index in range(count) if changed[index] is side]
            means.append(
                weighted_mean(
                    [differences[index] for index in group], [weights[index] for index in group]
                )
            )
        lower.append(min(means))
        upper.append(max(means))
    needed = math.ceil((1 - confidence) * len(groups) - 1e-9) - always
    if needed <= 0:
        return -math.inf, math.inf
    return sorted(lower)[needed - 1], sorted(upper, reverse=True)[needed - 1]


def unobserved_p(differences, weights):
    """Return the two-sided p value of a lead of 0 by the rule of unobserved failures, with the bounds -1 and 1.

    Twice the chance that the extra object, as bad as possible, makes up for all others, as good as the best one. Bad is
    the side away from the mean.
    """
    side = 1 if weighted_mean(differences, weights) > 0 else -1
    best = max(side * one for one in differences)
    if best <= 0:
        return 1.0
    factors = [weight * best for weight in weights] + [-extra_weight(weights)]
    return min(1.0, 2 * share_below_zero(factors, [1.0] * len(weights) + [EXTRA]))


def unobserved_interval(differences, weights, confidence=0.95):
    """Return the interval of unobserved failures: all objects as the best one, the extra object as bad as possible."""
    share = (1 - confidence) / 2
    ends = []
    for side in (1, -1):
        mirrored = [side * one for one in differences]
        values = [max(mirrored)] * len(mirrored) + [-1.0]
        with_extra = [*weights, extra_weight(weights)]
        ends.append(
            side * random_mean_quantile(values, with_extra, [1.0] * len(mirrored) + [EXTRA], share)
        )
    return ends[0], ends[1]


def lead_interval(differences, weights, confidence=0.95):
    """Return the least and the largest lead that one of the two tests does not reject, within -1 and 1."""
    signs = sign_change_interval(differences, weights, confidence)
    unobserved = unobserved_interval(differences, weights, confidence)
    mean = weighted_mean(differences, weights)
    return max(-1.0, min(signs[0], unobserved[0], mean)), min(
        1.0, max(signs[1], unobserved[1], mean)
    )


def lead_p(differences, weights):
    """Return the p value of a lead: the larger of both tests' at a lead of 0."""
    return max(sign_change_p(differences, weights), unobserved_p(differences, weights))


# --- new classes


def class_means(values, weights, classes):
    """Return the weighted mean and the weight of each class."""
    means, sums = [], []
    for a_class in sorted(set(classes)):
        members = [index for index, own in enumerate(classes) if own == a_class]
        means.append(
            weighted_mean(
                [values[index] for index in members], [weights[index] for index in members]
            )
        )
        sums.append(sum(weights[index] for index in members))
    return means, sums


def standard_error(means, weights):
    """Return the standard error of a weighted mean of independent means of one variance.

    The variance is the sum of squares of (share times deviation from the weighted mean), divided by the sum's expectation
    for variance 1. The weighted mean has this variance times the sum of squared shares. With equal shares the standard
    error is the standard deviation (n - 1) over the root of n.
    """
    shares = [weight / sum(weights) for weight in weights]
    centre = weighted_mean(means, weights)
    second = sum(share**2 for share in shares)
    squares = sum((share * (mean - centre)) ** 2 for mean, share in zip(means, shares, strict=True))
    expected = sum(share**2 * (1 - 2 * share + second) for share in shares)
    return math.sqrt(squares / expected * second)


def new_classes_interval(values, weights, classes, first, confidence=0.95, bounds=(0.0, 1.0)):
    """Return Student's interval of the means of classes, joined with the first interval, within the bounds."""
    means, sums = class_means(values, weights, classes)
    centre = weighted_mean(means, sums)
    reach = student.ppf((1 + confidence) / 2, len(means) - 1) * standard_error(means, sums)
    least, most = bounds
    return max(least, min(first[0], centre - reach)), min(most, max(first[1], centre + reach))


def new_classes_p(values, weights, classes, first_p):
    """Return the larger of Student's p value of the means of classes and the first p value."""
    means, sums = class_means(values, weights, classes)
    centre, error = weighted_mean(means, sums), standard_error(means, sums)
    if error == 0:
        return max(first_p, 1.0 if centre == 0 else 0.0)
    return max(first_p, 2 * student.sf(abs(centre / error), len(means) - 1))


# --- many tests


def holm(p_values):
    """Return adjusted p values (Holm, Scandinavian Journal of Statistics 6, 1979): the i-th smallest of m, counted from 0,
    times m - i, at least as large as the one before, at most 1.
    """
    count = len(p_values)
    order = sorted(range(count), key=lambda index: p_values[index])
    adjusted = [0.0] * count
    largest = 0.0
    for rank, index in enumerate(order):
        largest = max(largest, min(1.0, (count - rank) * p_values[index]))
        adjusted[index] = largest
    return adjusted


def verdict(leads, margin=0.05, significance=0.05):
    """Return the word of a question, the indices of the leads that are ahead and behind, and the excluded lead.

    `leads` are (mean, high end, p value). The word is yes if every lead is ahead with p below 0.05 after Holm's
    correction; no if none is, and each interval ends at five points or below; else not settled.
    """
    adjusted = holm([p_value for _, _, p_value in leads])
    shown = [index for index, p_value in enumerate(adjusted) if p_value < significance]
    ahead = [index for index in shown if leads[index][0] > 0]
    behind = [index for index in shown if leads[index][0] < 0]
    excluded = max(high for _, high, _ in leads)
    word = "not settled"
    if len(ahead) == len(leads):
        word = "yes"
    elif not ahead and excluded <= margin:
        word = "no"
    return word, ahead, behind, excluded
