"""Parameters are checked as a whole, and every fault is named with its path."""

import re
import subprocess
import sys

import pytest
from source_folders import PYTHONPATH

from visuohaptic import parameters
from visuohaptic.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters


def test_sections_that_are_left_out_take_their_defaults():
    assert ExperimentParameters.from_mapping({}) == ExperimentParameters()


def test_what_is_dumped_reads_back():
    chosen = ExperimentParameters.from_mapping({"viewpoints": {"elevations_degrees": [0, 30]}})
    assert ExperimentParameters.from_mapping(chosen.model_dump(mode="json")) == chosen


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"senser": {}}, "senser is no parameter"),
        ({"sensor": {"size": 1}}, r"sensor\.size is no parameter"),
        ({"seed": -1}, "seed is -1: input should be greater than or equal to 0"),
        (
            {"meshes": {"set": "all"}},
            "meshes.set is 'all': input should be 'paper', 'benchmark', 'outside', 'hard' or 'odd'",
        ),
        (
            {"probing": {"strategies": ["fixation", "guessing"]}},
            r"probing.strategies.1 is 'guessing': input should be 'fixation', .* or 'human'",
        ),
        (
            {"recognition": {"best": {"classifiers": ["oracle"]}}},
            r"recognition.best.classifiers.0 is 'oracle': input should be 'k_nearest_neighbours', ",
        ),
        ({"attention": {"weights": {"glare": 1}}}, r"attention\.weights\.glare is no parameter"),
        ({"scene": {"effects": {"rust": "auto"}}}, r"scene\.effects\.rust is no parameter"),
        ({"workflow": {"views_per_job": "many"}}, "workflow.views_per_job is 'many'"),
        ({"sensor": {"smallest_size": 1.0}}, "smallest_size is 1.0; at most largest_size"),
        ({"seed": -1, "senser": {}}, "seed is -1.*; senser is no parameter"),
        (
            {"probing": {"strategies": ["random", "random"]}},
            "probing.strategies names random 2 times; once is allowed",
        ),
        ({"recognition": {"pipelines": ["best", "best"]}}, "recognition.pipelines names best 2"),
        (
            {"recognition": {"classifiers": ["naive_bayes"] * 3}},
            "recognition.classifiers names naive_bayes 3 times",
        ),
        ({"cost": {"touches": [1, 1]}}, "cost.touches names 1 2 times"),
        ({"viewpoints": {"count": 100000}}, "viewpoints.count is 100000: .* less than or equal"),
        (
            {"viewpoints": {"count": 1000, "elevations_degrees": [0, 10, 20, 30, 40]}},
            "viewpoints.count is 1000 and viewpoints.elevations_degrees has 5 rings: 5000",
        ),
        ({"rendering": {"resolution": 10000}}, "rendering.resolution is 10000: .* 4096"),
        ({"cost": {"view_resolutions": [99999]}}, "cost.view_resolutions.0 is 99999"),
    ],
)
def test_each_fault_is_named(values, sentence):
    with pytest.raises(ParameterError, match=sentence) as caught:
        ExperimentParameters.from_mapping(values)
    assert "\n" not in str(caught.value)


def test_the_number_of_viewpoints_counts_every_ring():
    parameters = ExperimentParameters.from_mapping(
        {"viewpoints": {"count": 4, "elevations_degrees": [0, 30, 60]}}
    )
    assert parameters.viewpoints.total == 12


def test_parameters_are_read_without_the_libraries_of_the_phases():
    program = (
        "import sys, visuohaptic.parameters; "
        "print(sorted({name.split('.')[0] for name in sys.modules} & "
        "{'numpy', 'pandas', 'pyarrow', 'cv2', 'open3d', 'trimesh', 'scipy', 'sklearn'}))"
    )
    output = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True, text=True, check=True, env={"PYTHONPATH": PYTHONPATH},
    ).stdout  # fmt: skip
    assert output == "[]\n"


REFUSED_TOUCHES = "recognition.touches is {} and attention.fixations is {}: a view"
REFUSED_RESOLUTION = "sensor.resolution is {}, and features takes 16 directional bands"


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        *(
            ({"recognition.touches": touches, "attention.fixations": fixations},
             REFUSED_TOUCHES.format(touches, fixations))
            for touches, fixations in ((8, 5), (5, 3))
        ),
        *(
            ({"sensor.resolution": resolution}, REFUSED_RESOLUTION.format(resolution))
            for resolution in (2, 12, 34)
        ),
    ],
)  # fmt: skip
def test_what_would_fail_is_refused_before_a_run(values, sentence):
    with pytest.raises(ParameterError, match=f"^p: {sentence}"):
        parameters.check_run(parameters.as_parameters(values), "p")


@pytest.mark.parametrize("resolution", [3, 8, 16, 33, 256])
def test_resolutions_that_the_contourlets_take_are_allowed(resolution):
    parameters.check_run(parameters.as_parameters({"sensor.resolution": resolution}))


def test_the_multiple_is_that_of_the_contourlets():
    from contourlets.lattice import side_multiple

    directions_log2 = parameters.DIRECTIONS.bit_length() - 1
    assert side_multiple(directions_log2) == parameters.IMPRINT_MULTIPLE


def test_who_only_touches_may_choose_fewer_fixations():
    few = parameters.as_parameters({"attention.fixations": 3})
    parameters.check_run(few)
    assert few.attention.fixations == 3


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("seed: 010", "seed (line 1) is 010, which YAML takes for another number"),
        ("seed: 1:30", "seed (line 1) is 1:30, which YAML takes for another number"),
        ("sensor: {reach: 1e400}", "sensor.reach (line 1) is 1e400, which is too large"),
        ("sensor: {reach: -1.0e+400}", "sensor.reach (line 1) is -1.0e+400, which is too large"),
        ("meshes:\n  set: [yes]", "meshes.set (line 2) is yes, which YAML takes for a truth value"),
        ("attention: {terms: off}", "attention.terms (line 1) is off, which YAML takes"),
    ],
)
def test_a_value_that_yaml_would_change_is_refused_with_its_line(tmp_path, line, sentence):
    path = tmp_path / "params.yaml"
    path.write_text(f"{line}\n")
    with pytest.raises(ParameterError, match=re.escape(sentence)):
        parameters.check_spelling(path)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("seed=1:30", "--config: seed (line 1) is 1:30, which YAML takes for another number"),
        ("meshes={set: no}", "--config: meshes.set (line 1) is no, which YAML takes for a truth"),
        ("sensor={reach: 1, reach: 2}", "--config: sensor.reach is in line 1 and again in line 1"),
    ],
)
def test_a_value_of_the_command_line_that_yaml_would_change_is_refused(given, sentence):
    with pytest.raises(ParameterError, match=re.escape(sentence)):
        parameters.check_config(given)


@pytest.mark.parametrize("given", ["seed=7", 'meshes={"set": "odd"}', "plugins=[a.py]", "a={b"])
def test_a_value_of_the_command_line_that_is_read_as_written_passes(given):
    parameters.check_config(given)


@pytest.mark.parametrize(
    "value", ["10", "0", "0.5", "-1e-3", "true", "False", '"010"', "'yes'", "null"]
)
def test_a_value_that_yaml_reads_as_written_passes(tmp_path, value):
    path = tmp_path / "params.yaml"
    path.write_text(f"seed: {value}\n")
    parameters.check_spelling(path)


def test_a_name_that_stands_twice_is_named_with_its_lines(tmp_path):
    path = tmp_path / "params.yaml"
    path.write_text("seed: 1\nsensor:\n  resolution: 8\n  flatness: 0.001\n  resolution: 16\n")
    with pytest.raises(
        ParameterError, match=r"sensor\.resolution is in line 3 and again in line 5; once"
    ):
        parameters.read_parameters(path)
    path.write_text("seed: 1\nviewpoints: {count: 2}\nseed: 2\n")
    with pytest.raises(ParameterError, match="seed is in line 1 and again in line 3"):
        parameters.read_parameters(path)


def test_broken_yaml_is_named_with_its_line(tmp_path):
    (tmp_path / "params.yaml").write_text("seed: 1\nsensor: {resolution: 8\nprobing: 3\n")
    with pytest.raises(ParameterError, match=r"params\.yaml can't be read: .*line 3"):
        parameters.read_parameters(tmp_path / "params.yaml")
