"""From the touch table to the feature table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa

from visuohaptic.features.describing import describe_touches
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.tables.phases import FEATURES, TOUCHES, by_object
from visuohaptic.tables.schema import read_table, write_table


def make_features(
    touches: str | Path | Sequence[str | Path], output: str | Path, parameters: FeatureParameters
) -> None:
    """Make the feature table of a touch table, one object in memory at a time."""
    parts = [
        describe_touches(felt, parameters) for _, felt in by_object(read_table(TOUCHES, touches))
    ]
    write_table(FEATURES, pa.concat_tables([FEATURES.arrow.empty_table(), *parts]), output)
