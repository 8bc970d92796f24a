"""What a small made-up run senses: classes apart in the view and, less so, in touch."""

import numpy as np
import pyarrow as pa
from recognition.synthetic import features_table

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import gather_pipeline
from visuohaptic.recognition.summary import select
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
    tables = {
        strategy: features_table(strategy, objects, viewpoints, touches, separation, seed)
        for seed, strategy in enumerate((*STRATEGIES, ADAPTIVE))
    }
    rows = pa.concat_tables(tables[strategy] for strategy in STRATEGIES)
    recognition = RUN.recognition.model_copy(update={"touches": touches})
    gathered = {
        strategy: gather_pipeline(select(rows, strategy=strategy), recognition, "best")
        for strategy in STRATEGIES
    }
    names = gathered[STRATEGIES[0]].feature_names
    candidates = gather_candidates(tables[ADAPTIVE], names)
    sequences = candidates.sequences
    generator = np.random.default_rng(11)
    clean = np.eye(len(sequences.classes))[sequences.labels] @ generator.normal(
        size=(len(sequences.classes), 30)
    )
    seen = generator.normal(scale=5, size=(len(clean), len(SIGHTS), 30))
    seen[:, 0] = clean + generator.normal(scale=0.1, size=clean.shape)
    touched = {strategy: one.features for strategy, one in gathered.items()}
    views = {cue: seen.astype(np.float32) for cue in CUES}
    return Sensed(sequences, views, touched, candidates)
