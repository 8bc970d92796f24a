"""Parameters are checked as a whole, and every fault is named with its path."""

import re
import subprocess
import sys

import pytest
from source_folders import PYTHONPATH

from visuohaptic.base.errors import ParameterError
from visuohaptic.parameters import (
    DIRECTIONS,
    IMPRINT_MULTIPLE,
    ExperimentParameters,
    as_parameters,
    check_config,
    check_run,
    check_spelling,
    read_parameters,
)


def test_what_is_dumped_reads_back():
    chosen = ExperimentParameters.from_mapping({"viewpoints": {"elevations_degrees": [0, 30]}})
    assert ExperimentParameters.from_mapping(chosen.model_dump(mode="json")) == chosen


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"seed": -1, "senser": {}}, "seed is -1: .* greater than or equal to 0; senser is no"),
        ({"probing": {"strategies": ["fixation", "guessing"]}}, "strategies.1 is 'guessing'"),
        ({"attention": {"weights": {"glare": 1}}}, r"attention\.weights\.glare is no parameter"),
        ({"scene": {"effects": {"rust": "auto"}}}, r"scene\.effects\.rust is no parameter"),
        ({"seed": True}, "seed is True: a number is needed"),
        ({"cost": {"touches": [2, True]}}, "cost.touches is True: a number is needed"),
        ({"sensor": {"smallest_size": 1.0}}, "smallest_size is 1.0; at most largest_size"),
        ({"recognition": {"classifiers": ["naive_bayes"] * 3}}, "classifiers names naive_bayes 3"),
        (
            {"viewpoints": {"count": 1000, "elevations_degrees": [0, 10, 20, 30, 40]}},
            "5 rings: 5000",
        ),
    ],
)
def test_each_fault_is_named(values, sentence):
    with pytest.raises(ParameterError, match=sentence) as caught:
        ExperimentParameters.from_mapping(values)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("module", ["visuohaptic", "visuohaptic.parameters"])
def test_the_package_and_its_parameters_are_imported_without_heavy_libraries(module):
    # NumPy, Arrow and OpenCV take 0.1 s each, the others more than 0.3 s.
    heavy = {"pandas", "open3d", "trimesh", "scipy", "sklearn", "matplotlib"}
    if module == "visuohaptic":
        heavy |= {"numpy", "pydantic", "typer", "pyarrow", "cv2"}
    program = (
        f"import sys, {module}; print({heavy} & {{name.split('.')[0] for name in sys.modules}})"
    )
    output = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True, text=True, check=True, env={"PYTHONPATH": PYTHONPATH},
    ).stdout  # fmt: skip
    assert output == "set()\n"


def test_parameters_are_named_as_in_the_file_or_with_dots():
    found = as_parameters({"sensor": {"resolution": 16}, "rendering.resolution": 64})
    assert (found.sensor.resolution, found.rendering.resolution) == (16, 64)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"sensor.resolutoin": 16}, r"sensor\.resolutoin is no parameter"),
        ({"sensor.resolution": 16, "sensor": {"resolution": 8}}, r"sensor\.resolution is .* twice"),
        ({"sensor": 3, "sensor.resolution": 16}, "sensor is 3 and holds resolution"),
        ({3: 4}, "3 is no name"),
        ("sensor.resolution=16", "str; a mapping or ExperimentParameters"),
    ],
)
def test_parameters_in_python_that_are_none_are_named(values, sentence):
    with pytest.raises(ParameterError, match=sentence):
        as_parameters(values)


TOUCHES, FIXATIONS, RESOLUTION = (
    "recognition.touches", "attention.fixations", "sensor.resolution",
)  # fmt: skip


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({TOUCHES: 8}, f"{TOUCHES} is 8 and {FIXATIONS} is 5"),
        ({TOUCHES: 5, FIXATIONS: 3}, f"{TOUCHES} is 5 and {FIXATIONS} is 3"),
        *(({RESOLUTION: side}, f"{RESOLUTION} is {side}, .* 16 dir") for side in (2, 12)),
    ],
)
def test_what_would_fail_is_refused_before_a_run(values, sentence):
    with pytest.raises(ParameterError, match=f"^p: {sentence}"):
        check_run(as_parameters(values), "p")


@pytest.mark.parametrize("values", [{FIXATIONS: 3}, *({RESOLUTION: side} for side in (3, 8, 33))])
def test_fewer_fixations_for_touch_alone_and_resolutions_that_contourlets_take_pass(values):
    check_run(as_parameters(values))


def test_the_multiple_is_that_of_the_contourlets():
    from contourlets.lattice import side_multiple

    assert side_multiple(DIRECTIONS.bit_length() - 1) == IMPRINT_MULTIPLE


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("seed: 010", "seed (line 1) is 010"),
        ("seed: 1:30", "seed (line 1) is 1:30"),
        ("sensor: {reach: -1.0e+400}", "sensor.reach (line 1) is -1.0e+400"),
        ("meshes:\n  set: [yes]", "meshes.set (line 2) is yes"),
        ("sensor: {reach: 1}\nsensor: {}", "sensor is in line 1 and again in line 2"),
        ("sensor:\n  reach: 1\n  reach: 2", "sensor.reach is in line 2 and again in line 3"),
    ],
)
def test_what_yaml_would_change_is_refused_with_its_line(tmp_path, line, sentence):
    path = tmp_path / "params.yaml"
    path.write_text(f"{line}\n")
    with pytest.raises(ParameterError, match=re.escape(sentence)):
        read_parameters(path)


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
    with pytest.raises(ParameterError, match=r"params\.yaml can't be read: .*line 3"):
        read_parameters(path)
    check_config("a={b")
