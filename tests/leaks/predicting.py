"""What classifiers say of test sequences."""

import numpy as np

from visuohaptic.recognition.experiment import fitting, split_runner
from visuohaptic.recognition.parameters import RecognitionParameters

PARAMETERS = RecognitionParameters()


def predict(sequences, split, pipeline):
    """Return the classes, or the probabilities, of a split's test sequences by classifier."""
    answer_split = split_runner(sequences, PARAMETERS, 0, pipeline)
    with fitting():
        return {
            answer.classifier: answer.predicted
            if answer.ballots is None
            else answer.ballots.alone()
            for answer in answer_split(split, np.random.default_rng(0))
        }
