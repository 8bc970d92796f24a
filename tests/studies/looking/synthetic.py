"""What a small made-up run senses: classes apart in the view and, less so, in touch."""

import numpy as np
from recognition.synthetic import features_table

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.studies.curves.choosing import gather_candidates
from visuohaptic.studies.looking.seeing import SIGHTS
from visuohaptic.studies.looking.sensing import ADAPTIVE, STRATEGIES, Sensed, most_touches
from visuohaptic.studies.looking.settings import CUES

RUN = ExperimentParameters.from_mapping(
    {
        "attention": {"fixations": 2},
        "recognition": {
            "touches": 2,
            "best": {"waves": 20},
            "protocol": {"maximum_splits": 1, "folds": 2, "fold_rounds": 1},
            "intervals": {"bootstrap_samples": 200},
        },
        "cost": {"budgets": [4, 10.5, 16]},
    }
)


def made_up(objects=(4, 4, 4), viewpoints=2, separation=1.0):
    """Give what is sensed: views of noise in every sight but the first."""
    touches = most_touches(RUN)
    recognition = RUN.recognition.model_copy(update={"touches": touches})
    tables = [
        features_table(strategy, objects, viewpoints, touches, separation, seed)
        for seed, strategy in enumerate((*STRATEGIES, ADAPTIVE))
    ]
    gathered = [gather_pipeline(table, recognition, "best") for table in tables[:-1]]
    candidates = gather_candidates(tables[-1], gathered[0].feature_names)
    sequences, generator = candidates.sequences, np.random.default_rng(11)
    of_class = generator.normal(size=(len(sequences.classes), 30))
    seen = generator.normal(scale=5, size=(len(sequences.labels), len(SIGHTS), 30))
    seen[:, 0] = of_class[sequences.labels] + generator.normal(scale=0.1, size=seen[:, 0].shape)
    touched = {name: one.features for name, one in zip(STRATEGIES, gathered, strict=True)}
    return Sensed(sequences, dict.fromkeys(CUES, seen.astype(np.float32)), touched, candidates)
