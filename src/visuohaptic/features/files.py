"""From the touch table to the feature table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from visuohaptic.features.describing import describe_touches
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.tables.phases import FEATURES, TOUCHES
from visuohaptic.tables.schema import read_table, write_table


def make_features(
    touches: str | Path | Sequence[str | Path], output: str | Path, parameters: FeatureParameters
) -> None:
    """Make the feature table of a touch table."""
    write_table(FEATURES, describe_touches(read_table(TOUCHES, touches), parameters), output)
