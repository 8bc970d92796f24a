"""Example of a classifier: register a classifier of scikit-learn in one line."""

from sklearn.ensemble import ExtraTreesClassifier

import visuohaptic as vh

vh.register(vh.Classifier.of("extra_trees", ExtraTreesClassifier(50)))

if __name__ == "__main__":
    import numpy as np

    from visuohaptic.recognition import make_order_free

    rows = np.random.default_rng(0).normal(size=(40, 6)) + np.repeat([[0.0], [3.0]], 20, axis=0)
    fitted = make_order_free("extra_trees").fit(rows, np.repeat(["cup", "lamp"], 20))
    print(*fitted.predict([[0.0] * 6, [3.0] * 6]))
