"""Parameters are checked as a whole, and every fault is named with its path."""

import subprocess
import sys
from pathlib import Path

import pytest

from visuohaptic.errors import ParameterError
from visuohaptic.parameters import ExperimentParameters

ROOT = Path(__file__).parents[1]


def test_sections_that_are_left_out_take_their_defaults():
    assert ExperimentParameters.from_mapping({}) == ExperimentParameters()


def test_what_is_dumped_reads_back():
    parameters = ExperimentParameters.from_mapping({"viewpoints": {"elevations_degrees": [0, 30]}})
    assert ExperimentParameters.from_mapping(parameters.model_dump(mode="json")) == parameters


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"senser": {}}, "senser is no parameter"),
        ({"sensor": {"size": 1}}, r"sensor\.size is no parameter"),
        ({"seed": -1}, "seed is -1: input should be greater than or equal to 0"),
        (
            {"meshes": {"set": "all"}},
            "meshes.set is 'all': input should be 'paper', 'benchmark' or 'hard'",
        ),
        (
            {"probing": {"strategies": ["fixation", "guessing"]}},
            r"probing.strategies.1 is 'guessing': input should be 'fixation', .* or 'curvature'",
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
        capture_output=True, text=True, check=True, env={"PYTHONPATH": str(ROOT / "src")},
    ).stdout  # fmt: skip
    assert output == "[]\n"
