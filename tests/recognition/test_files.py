"""From the feature table to files of scores and predictions."""

import pytest

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.files import make_scores
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table, write_table


def test_a_strategy_without_touches_is_named(tmp_path):
    columns = dict.fromkeys(FEATURES.arrow.names, 0.5)
    columns |= {"class": "cup", "object": "a", "viewpoint": [0], "strategy": "random", "touch": 0}
    columns |= {"contact_state": "full"}
    write_table(FEATURES, build_table(FEATURES, columns), tmp_path / "features.parquet")
    with pytest.raises(RecognitionError, match=r"no touch was made by fixation; .*\['random'\]"):
        make_scores(
            [tmp_path / "features.parquet"], tmp_path / "s", tmp_path / "p",
            "paper", "fixation", RecognitionParameters(), 0,
        )  # fmt: skip
