"""What classifiers say of test sequences."""

from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pipelines import pipeline_of

PARAMETERS = RecognitionParameters()


def predict(sequences, split, pipeline):
    """Return the classes, or the log probabilities, of a split's test sequences by classifier."""
    parts = pipeline_of(pipeline, PARAMETERS, 0)
    return {
        prediction.classifier: prediction.predicted
        if prediction.log_probabilities is None
        else prediction.log_probabilities
        for prediction in predict_splits(sequences, parts, [split], 0)
    }
