"""File to file: which touches take part in recognition."""

import pyarrow as pa
import pytest

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.files import make_scores
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import classes_of_two
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table, write_table


def test_a_class_with_a_single_object_is_left_out():
    features = pa.table(
        {"class": ["cup", "cup", "chair", "chair", "lamp"], "object": ["a", "a", "b", "c", "a"]}
    )
    assert classes_of_two(features).column("object").to_pylist() == ["b", "c"]


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
