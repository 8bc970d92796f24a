"""The small run that the tests of the workflow make, and what it felt."""

import pytest
from workflow.conftest import finished, fresh, once, open_folder

from visuohaptic.evaluation.summary import select
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

__all__ = ["finished", "fresh", "once", "open_folder"]


@pytest.fixture(scope="session")
def features(finished):
    """Features of the touches where the eye rests: four objects of two classes, two views each."""
    table = read_table(FEATURES, finished.folder / "results/features")
    return select(table, strategy="fixation")
