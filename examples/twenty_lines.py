"""Example of a simple classifier: twenty lines of NumPy and scikit-learn on means of touches."""

import numpy as np
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer


def touch_statistics(sequences):
    """Compute mean, deviation, minimum and maximum over the touches: (n, t) to (n, 32)."""
    imprints = sequences["imprint"].reshape(*sequences.shape, -1).astype(np.float64)
    skin = np.stack([imprints.mean(axis=2), imprints.std(axis=2)], axis=2)
    touches = np.concatenate([skin, sequences["pose"]], axis=2)
    parts = [touches.mean(axis=1), touches.std(axis=1), touches.min(axis=1), touches.max(axis=1)]
    return np.concatenate(parts, axis=1)


discriminant = LinearDiscriminantAnalysis(solver="lsqr", shrinkage="auto")
twenty_lines = make_pipeline(FunctionTransformer(touch_statistics), discriminant)

if __name__ == "__main__":
    # After a run: vh.evaluate(twenty_lines, "results/touches", strategy="random", inputs="touches")
    kind = [("imprint", "f4", (32, 32)), ("pose", "f4", 6), ("sensor_size", "f4")]
    sequences, labels = np.zeros((40, 5), dtype=kind), np.repeat([0, 1], 20)
    sequences["pose"] = np.random.default_rng(0).normal(size=(40, 5, 6))
    sequences["pose"][20:, :, 1] += 3
    print(np.mean(twenty_lines.fit(sequences, labels).predict(sequences) == labels))
