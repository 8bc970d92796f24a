"""Study `views`: the accuracy by five eye fixations from each of 1 to 16 views of an object.

Written before the figures were computed: docs/accuracy_and_time.md states the gain of two views over one, by the headline
classifier of each pipeline, on the 142 objects of set ``benchmark``, beside the gain of five more touches from one view.
"""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import FIXATION_ONLY, PAPER_AND_OURS
from visuohaptic.studies.study import Condition, Study

VIEWS = (1, 2, 4, 8, 16)
"""Numbers of views that are classified together."""


def conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per number of views that the run has; the study compares each with one view."""
    changes = {**FIXATION_ONLY, "recognition.pipelines": PAPER_AND_OURS}
    for count in VIEWS:
        if count <= run.viewpoints.count:
            yield Condition(name_of(count), changes, votes=count)


def name_of(count: int) -> str:
    """Return the name of the condition of a number of views."""
    return f"{count} view{'s' if count > 1 else ''}"


STUDY = Study("views", "What one more view gains", conditions, kept="reports/studies/views.json")
