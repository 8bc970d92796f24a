"""Made-up touches of known objects in several turns."""

from dataclasses import replace

from recognition.synthetic import features_table
from studies.surfaces import RUN

from known_objects.new_touches import Turned, mark_turns
from known_objects.study import MOST_TOUCHES, PIPELINE, STUDY
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.studies.conditions import plan_study

PLANNED = plan_study(STUDY, RUN).conditions


def turned_touches(objects=3, turns=4, separation=2.0, viewpoints=4):
    """Return the touches of so many objects in so many turns; each object is the only one of its class."""
    return [
        Turned(
            features_table(
                objects=(1,) * objects,
                touches=MOST_TOUCHES,
                viewpoints=viewpoints,
                separation=separation,
                seed=turn,
            ),
            PLANNED[turn].parameters,
        )
        for turn in range(turns)
    ]


def gathered(turned):
    """Return the sequences of all turns."""
    table = mark_turns([one.features for one in turned])
    return gather_pipeline(table, turned[0].parameters.recognition, PIPELINE, RUN.seed)


def with_touches(turned, change):
    """Return the same turns with changed tables of features."""
    return [replace(one, features=change(one.features)) for one in turned]
