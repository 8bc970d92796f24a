"""Example of a map: the first principal components of a touch."""

import visuohaptic as vh
from visuohaptic.recognition import FeatureGroups


def fit(touches, settings, generator):
    """Compute the first principal directions of training touches (n, d) as weights of the features."""
    import numpy as np

    _, _, directions = np.linalg.svd(touches - touches.mean(axis=0), full_matrices=False)
    return FeatureGroups(directions[: settings.outputs].T)


def reduce(fitted, touches):
    """Compute the principal components of touches: (..., d) to (..., outputs)."""
    return touches @ fitted.weights


vh.register(vh.Map("principal", "its first principal components", fit, reduce))

if __name__ == "__main__":
    import numpy as np

    from visuohaptic.recognition import RecognitionParameters, SequenceEncoder

    chosen = RecognitionParameters(self_organising_map={"output": "principal", "outputs": 3})
    generator = np.random.default_rng(0)
    sequences = generator.normal(size=(20, 5, 22)) * np.arange(1, 23)
    reduced = SequenceEncoder(chosen).fit(sequences).reduce(sequences)
    print(reduced.shape, *reduced.std(axis=(0, 1)).round(1))
