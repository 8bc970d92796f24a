"""Estimators of one's own, in a module that other processes can import.

Each but the first breaks one rule of scikit-learn's estimators.
"""

from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin


class Keeping(ClassifierMixin, BaseEstimator):
    """Keeps what it is given, where a test can see it."""

    given: ClassVar = []

    def __init__(self, label=0):
        self.label = label

    def fit(self, X, y, groups=None):
        self.classes_ = np.unique(y)
        self.given.append((X, y, groups))
        return self

    def predict(self, X):
        self.given.append((X, None, None))
        return np.full(len(X), self.label)


class Changing(Keeping):
    """Its constructor changes its argument, so that it can't be copied."""

    def __init__(self, label=0):
        self.label = [label]


class Sized(Keeping):
    """Needs sequences of five touches, as a network of a fixed size does."""

    def fit(self, X, y):
        np.reshape(X["pose"], (-1, 30)) @ np.ones(30)
        if X.shape[1] != 5:
            raise ValueError("5 touches are needed")
        return super().fit(X, y)


class Scoring(Keeping):
    """Predicts scores instead of labels."""

    def predict(self, X):
        return np.zeros((len(X), 4))


class Naming(Keeping):
    """Predicts names instead of labels."""

    def predict(self, X):
        return np.full(len(X), "class0")


class Locked(Keeping):
    """Can be copied by scikit-learn, and not sent to another process."""

    def __reduce__(self):
        raise TypeError("a handle of this process")


class Ragged(Keeping):
    """Predicts lists of several lengths instead of labels."""

    def predict(self, X):
        return [[0] * (1 + row % 2) for row in range(len(X))]


class Unprintable(Keeping):
    """Has no text."""

    def __repr__(self):
        raise RuntimeError("no text")


class Untagged(Keeping):
    """Fails when it is asked what kind of estimator it is."""

    def __sklearn_tags__(self):
        raise RuntimeError("no tags")
