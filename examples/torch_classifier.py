"""Example of a neural network on imprints and poses: PyTorch behind the interface of scikit-learn."""

import numpy as np
import torch
from sklearn.base import BaseEstimator, ClassifierMixin
from torch import nn


class TouchNetwork(nn.Module):
    """Convolutions over each imprint, then linear layers over imprint and pose; scores are averaged over the touches."""

    def __init__(self, classes):
        super().__init__()
        self.skin = nn.Sequential(
            nn.Conv2d(1, 8, 5, stride=2), nn.ReLU(), nn.Conv2d(8, 16, 3, stride=2), nn.ReLU(),
            nn.AdaptiveAvgPool2d(2), nn.Flatten(),
        )  # fmt: skip
        self.touch = nn.Sequential(nn.Linear(16 * 4 + 6, 64), nn.ReLU(), nn.Linear(64, classes))

    def forward(self, imprints, poses):
        """Compute the scores of the classes: (n, t, r, r) and (n, t, 6) to (n, classes)."""
        sequences, touches = poses.shape[:2]
        skin = self.skin(imprints.flatten(0, 1).unsqueeze(1)).unflatten(0, (sequences, touches))
        return self.touch(torch.cat([skin, poses], dim=2)).mean(dim=1)


class TorchClassifier(ClassifierMixin, BaseEstimator):
    """Classify sequences of touches from `vh.evaluate(…, inputs="touches")`."""

    def __init__(self, epochs=30, random_state=None):
        self.epochs = epochs
        self.random_state = random_state

    def fit(self, X, y):
        """Fit on sequences (n, t) with classes `y` (n,)."""
        torch.manual_seed(0 if self.random_state is None else self.random_state)
        self.classes_, labels = np.unique(y, return_inverse=True)
        self.network_ = TouchNetwork(len(self.classes_))
        imprints, poses = tensors(X)
        labels = torch.from_numpy(labels)
        optimiser = torch.optim.Adam(self.network_.parameters(), 1e-3)
        for _ in range(self.epochs):
            for batch in torch.randperm(len(X)).split(64):
                optimiser.zero_grad()
                scores = self.network_(imprints[batch], poses[batch])
                nn.functional.cross_entropy(scores, labels[batch]).backward()
                optimiser.step()
        return self

    def predict(self, X):
        """Predict the classes (n,) of sequences (n, t)."""
        with torch.no_grad():
            scores = self.network_(*tensors(X))
        return self.classes_[scores.argmax(dim=1).numpy()]


def tensors(sequences):
    """Copy imprints (n, t, r, r) and poses (n, t, 6) to tensors."""
    return [torch.from_numpy(sequences[name].copy()) for name in ("imprint", "pose")]


if __name__ == "__main__":
    # After a run: vh.evaluate(TorchClassifier(), "results/touches", inputs="touches", splits=9)
    kind = [("imprint", "f4", (32, 32)), ("pose", "f4", 6), ("sensor_size", "f4")]
    sequences, labels = np.zeros((40, 5), dtype=kind), np.repeat([0, 1], 20)
    sequences["imprint"][20:] = 1
    sequences["pose"] = np.random.default_rng(0).normal(size=(40, 5, 6))
    print(np.mean(TorchClassifier().fit(sequences, labels).predict(sequences) == labels))
