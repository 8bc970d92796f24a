"""YAML is refused where a parser reads something else than what is written."""

import re
from itertools import pairwise

import pytest

from visuohaptic.base.errors import ParameterError
from visuohaptic.io.yaml_files import check_config, check_spelling, read_yaml


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("seed: 010", "seed (line 1) is 010"),
        ("seed: 1:30", "seed (line 1) is 1:30"),
        ("sensor: {reach: -1.0e+400}", "sensor.reach (line 1) is -1.0e+400"),
        ("meshes:\n  set: [yes]", "meshes.set (line 2) is yes"),
        ("sensor: {reach: 1}\nsensor: {}", "sensor is in line 1 and again in line 2"),
        ("yes: 1", "name yes (line 1) is yes"),
        ("1:04: 1", "name 1:04 (line 1) is 1:04"),
        ("a: 2026-13-01", "can't be read: month must be"),
        ("a: &a [1, *a]", "values more than 50 levels deep"),
        ("[" * 5000, "more than 50 levels deep"),
        (
            "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n"
            + "".join(
                f"{new}: &{new} [{', '.join([f'*{old}'] * 10)}]\n"
                for old, new in pairwise("abcdefgh")
            ),
            "more than 1,000,000 values",
        ),
        ("x" * 5_000_001, "larger than 5 MB"),
        ("sensor:\n  reach: 1\n  reach: 2", "sensor.reach is in line 2 and again in line 3"),
    ],
)
def test_what_yaml_would_change_is_refused_with_its_line(tmp_path, line, sentence):
    path = tmp_path / "params.yaml"
    path.write_text(f"{line}\n")
    with pytest.raises(ParameterError, match=re.escape(sentence)):
        read_yaml(path)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("seed=1:30", "--config: seed (line 1) is 1:30"),
        ("sensor={reach: 1, reach: 2}", "--config: sensor.reach is in line 1 and again in line 1"),
    ],
)
def test_a_value_of_the_command_line_that_yaml_would_change_is_refused(given, sentence):
    with pytest.raises(ParameterError, match=re.escape(sentence)):
        check_config(given)


@pytest.mark.parametrize(
    "value", ["10", "0", "0.5", "-1e-3", "true", "False", '"010"', "'yes'", "null", "[a.py]"]
)
def test_a_value_that_yaml_reads_as_written_passes(tmp_path, value):
    path = tmp_path / "params.yaml"
    path.write_text(f"seed: {value}\n")
    check_spelling(path)
    check_config(f"seed={value}")


def test_broken_yaml_is_named_in_a_file_and_left_to_snakemake_on_its_command_line(tmp_path):
    path = tmp_path / "params.yaml"
    path.write_text("seed: 1\nsensor: {resolution: 8\nprobing: 3\n")
    with pytest.raises(ParameterError, match=r"params\.yaml can't be read: .*line 3") as caught:
        read_yaml(path)
    assert "unicode string" not in str(caught.value)
    check_config("a={b")
