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
    check_job_size,
    check_run,
    read_parameters,
)


def test_what_is_dumped_reads_back():
    chosen = ExperimentParameters.from_mapping({"viewpoints": {"elevations_degrees": [0, 30]}})
    assert ExperimentParameters.from_mapping(chosen.model_dump(mode="json")) == chosen


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"seed": -1, "senser": {}}, "seed is -1: a number of at least 0 is needed; senser is no"),
        ({"probing": {"strategies": ["fixation", "guessing"]}}, "strategies.1 is 'guessing'"),
        ({"attention": {"weights": {"glare": 1}}}, r"attention\.weights\.glare is no parameter"),
        ({"scene": {"effects": {"rust": "auto"}}}, r"scene\.effects\.rust is no parameter"),
        (
            {"sensor": {"resolutoin": 8}},
            r"resolutoin is no parameter; did you mean sensor\.resolution\?$",
        ),
        ({"senser": {}}, r"senser is no parameter; did you mean sensor\?$"),
        (
            {"recognition": {"order_free": {"wave": 3}}},
            r"did you mean recognition\.order_free\.waves\?$",
        ),
        (
            {"resolution": 16},
            r"resolution is no parameter; did you mean rendering\.resolution or sensor\.resolution\?$",
        ),
        (
            {"attention": {"resolution": 16}},
            r"attention\.resolution is no parameter; did you mean rendering\.resolution or sensor",
        ),
        ({"objects": 3}, r"objects is no parameter; did you mean cost\.objects\?$"),
        ({"sensor": {"zzz": 1}}, r"sensor\.zzz is no parameter\.$"),
        (
            {"probing": {"strategies": ["guessing"]}},
            r"strategies.0 is 'guessing': fixation, [^;]* are allowed\.$",
        ),
        ({"probing": {"strategies": []}}, r"strategies is \[\]: at least 1 value is needed\.$"),
        ({"probing": {"strategies": "random"}}, r"is 'random': a list is needed\.$"),
        ({"probing": {"strategies": ["fixaton"]}}, r"is 'fixaton': did you mean fixation\?$"),
        ({"sensor": {"resolution": "x"}}, r"sensor.resolution is 'x': a whole number is needed\.$"),
        ({"sensor": {"resolution": 16.5}}, r"is 16\.5: a whole number is needed\.$"),
        ({"sensor": 3}, r"sensor is 3: a section with names is needed\.$"),
        ({"sensor": {"largest_size": 0}}, r"largest_size is 0: a number above 0 is needed\.$"),
        ({"seed": True}, "seed is True: a number is needed"),
        ({"cost": {"touches": [2, True]}}, r"cost.touches is \[2, True\]: a number is needed"),
        ({"sensor": {"smallest_size": 1.0}}, "smallest_size is 1.0; at most largest_size"),
        ({"recognition": {"classifiers": ["naive_bayes"] * 3}}, "classifiers names naive_bayes 3"),
        (
            {"viewpoints": {"count": 257}, "rendering": {"resolution": 2048}},
            "rendering.resolution is 2048 and there are 257 viewpoints: 1,077,936,128 pixels",
        ),
        (
            {
                "viewpoints": {"count": 65},
                "sensor": {"resolution": 256},
                "attention": {"fixations": 16},
            },
            "is 256 and there are 65 viewpoints with 16 fixations each: 68,157,440 sensing points",
        ),
        ({"rendering": {"resolution": 2049}}, "is 2049: a number of at most 2048 is needed"),
        ({"cost": {"view_resolutions": [4096]}}, "is 4096: a number of at most 2048 is needed"),
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
    heavy = {"pandas", "open3d", "trimesh", "scipy", "sklearn", "matplotlib", "pyarrow"}
    if module == "visuohaptic":
        heavy |= {"numpy", "pydantic", "typer"}
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
        ({"sensor": 3, "sensor.resolution": 16}, "sensor is 3, but sensor.resolution needs"),
        ({3: 4}, "3 is no name"),
        ("sensor.resolution=16", "str; a mapping or ExperimentParameters"),
    ],
)
def test_parameters_in_python_that_are_none_are_named(values, sentence):
    with pytest.raises(ParameterError, match=sentence):
        as_parameters(values)


TOUCHES, FIXATIONS, RESOLUTION, FRAME = (
    "recognition.touches", "attention.fixations", "sensor.resolution", "recognition.frame",
)  # fmt: skip


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({TOUCHES: 8}, f"{TOUCHES} is 8 and {FIXATIONS} is 5"),
        ({TOUCHES: 5, FIXATIONS: 3}, f"{TOUCHES} is 5 and {FIXATIONS} is 3"),
        *(({RESOLUTION: side}, f"{RESOLUTION} is {side}, .* 16 dir") for side in (2, 12)),
        ({FRAME: "none", "features.descriptor": "wavelet"}, f"{FRAME} is none, .* is wavelet"),
        ({FRAME: "centre", "features.levels": [3, 3]}, f"{FRAME} is centre, .*levels .3, 3"),
    ],
)
def test_what_would_fail_is_refused_before_a_run(values, sentence):
    with pytest.raises(ParameterError, match=f"^p: {sentence}"):
        check_run(as_parameters(values), "p")


@pytest.mark.parametrize("values", [{FIXATIONS: 3}, *({RESOLUTION: side} for side in (3, 8, 33))])
def test_fewer_fixations_for_touch_alone_and_resolutions_that_contourlets_take_pass(values):
    check_run(as_parameters(values))


@pytest.mark.parametrize(
    ("values", "advice"),
    [
        ({}, "objects_per_job to at most 2"),
        (
            {"attention.fixations": 32},
            "objects_per_job to 1 and workflow.views_per_job to at most 5",
        ),
    ],
)
def test_jobs_that_hold_too_many_sensing_points_are_refused_with_the_numbers_that_fit(
    values, advice
):
    check_job_size(as_parameters(None))
    large = {"sensor.resolution": 256, "probing.strategies": ["fixation", "random"], **values}
    with pytest.raises(
        ParameterError, match=f"sensing points per job; .*: lower workflow.{advice}"
    ):
        check_job_size(as_parameters(large))
    fits = [int(number) for number in re.findall("at most ([0-9]+)", advice)][-1]
    name = "views_per_job" if "views" in advice else "objects_per_job"
    changes = {"workflow.objects_per_job": 1, f"workflow.{name}": fits}
    check_job_size(as_parameters(large | changes))
    with pytest.raises(ParameterError):
        check_job_size(as_parameters(large | changes | {f"workflow.{name}": fits + 1}))


def test_the_multiple_is_that_of_the_contourlets():
    from contourlets.lattice import side_multiple

    assert side_multiple(DIRECTIONS.bit_length() - 1) == IMPRINT_MULTIPLE


def test_a_file_with_a_name_twice_or_of_broken_yaml_is_refused_with_the_line(tmp_path):
    path = tmp_path / "params.yaml"
    for text, sentence in (
        ("seed: 1\nseed: 2\n", "seed is in line 1"),
        ("seed: [", "can't be read"),
    ):
        path.write_text(text)
        with pytest.raises(ParameterError, match=sentence):
            read_parameters(path)


def test_a_file_of_taxels_is_read_into_the_parameters(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pad.csv").write_text(
        "x;y;z;direction_x;direction_y;direction_z\n0,5;0;0;0;0;-1\n-1;0;0;0;0;-1\n"
    )
    chosen = as_parameters({"sensor.layout": "pad.csv"})
    assert chosen.sensor.layout == ((0.5, 0, 0, 0, 0, -1), (-1, 0, 0, 0, 0, -1))
    assert len(chosen.sensor.taxels) == 2
    again = ExperimentParameters.from_mapping(chosen.model_dump())
    assert again == chosen
    (tmp_path / "pad.csv").unlink()
    with pytest.raises(ParameterError, match=r"pad\.csv can't be read"):
        as_parameters({"sensor.layout": "pad.csv"})


@pytest.mark.parametrize(
    ("layout", "says"),
    [
        ("fist", "sensor.layout: 'fist' is no layout; square, round, dome, finger, gripper, or a"),
        ([[0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, -1]], r"sensor.layout: Layout own: taxel 0 has the direction \(0, 0, 0\)"),
        ([[1, 0, 0, 0, 0, 1]], "sensor.layout: Layout own: taxel 0 looks behind the pad"),
        ([[float(n), 0, 0, 0, 0, -1] for n in range(5000)], "5,000 taxels; at most 4,096 are allowed"),
    ],
)  # fmt: skip
def test_a_layout_that_is_none_is_refused_in_a_sentence(layout, says):
    with pytest.raises(ParameterError, match=says):
        as_parameters({"sensor.layout": layout})


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({}, "features.descriptor is contourlet, which needs a square grid .* image_statistics works"),
        ({"scene.preset": "fsr400"}, "scene.readout is grounded, which needs .*; ideal works on any"),
        ({"scene.cover": "half_space"}, "scene.cover is half_space, .*; winkler works on any"),
    ],
)  # fmt: skip
def test_a_run_with_a_pad_and_parameters_that_need_a_grid_is_refused(values, says):
    with pytest.raises(ParameterError, match=says):
        check_run(as_parameters({"sensor.layout": "dome", **values}))
    fitting = {"features.descriptor": "image_statistics", "sensor.resolution": 5}
    check_run(as_parameters({"sensor.layout": "dome", **fitting}))
