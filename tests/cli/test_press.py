"""`visuohaptic press`: poses out of a touch, and back."""

import re
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from visuohaptic.cli import press
from visuohaptic.exploration import pressing


@pytest.fixture
def bottle(tmp_path):
    profile = [[0, 0], [25, 0], [25, 70], [10, 90], [10, 120], [0, 120]]
    trimesh.creation.revolve(profile, sections=48).export(tmp_path / "bottle.stl")
    return tmp_path / "bottle.stl"


def test_poses_of_a_touch_are_pressed_again_on_the_same_file(visuohaptic, tmp_path, bottle):
    own = ("--up", "z", "--unit", "mm")
    touched = visuohaptic("touch", bottle, *own, "--viewpoints", 1, "--out", "felt")
    assert touched.code == 0, touched.err
    measures = ("--size", 12, "--height", 6, "--resolution", 24)
    pressed = visuohaptic("press", bottle, "--poses", "felt/poses.csv", *measures)
    assert pressed.code == 0, pressed.err
    images = np.load(tmp_path / "pressed/imprints.npy")
    assert images.shape[1:] == (12, 24)
    assert len(images) == len((tmp_path / "felt/poses.csv").read_text().splitlines()) - 1
    # A touched place lies on the surface, so the middle of each imprint is in contact.
    assert (images[:, 5:7, 11:13].max(axis=(1, 2)) > 0.9).all()
    assert np.isfinite(np.load(tmp_path / "pressed/heights.npy")).any()
    assert (tmp_path / "pressed/picture.png").is_file()


def test_poses_with_normals_are_pressed_without_scipy(tmp_path, bottle):
    # SciPy's rotations take 0.3 processor seconds, a fifth of the command.
    (tmp_path / "poses.csv").write_text("x,y,z,normal_x,normal_y,normal_z\n25,0,30,1,0,0\n")
    command = ["press", str(bottle), "--poses", "poses.csv", "--size", "5"]
    program = f"""
import sys
from visuohaptic.cli.main import run
try:
    run({command})
finally:
    assert "scipy" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)


def test_a_wrong_measure_is_one_sentence_and_writes_nothing(visuohaptic, tmp_path, bottle):
    (tmp_path / "poses.csv").write_text("x,y,z,normal_x,normal_y,normal_z\n25,0,30,1,0,0\n")
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", "--size", 0)
    assert ended.code == 1
    assert "size holds 0" in ended.err
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", "--size", 5, "--scene", "fsr400")
    assert ended.code == 1
    assert "unit is None" in ended.err
    assert not (tmp_path / "pressed").exists()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
@pytest.mark.parametrize("option", ["--size", "--height", "--depth"])
def test_a_length_that_is_not_finite_is_one_sentence(visuohaptic, tmp_path, bottle, option, number):
    (tmp_path / "poses.csv").write_text("x,y,z,normal_x,normal_y,normal_z\n25,0,30,1,0,0\n")
    measures = {"--size": "5", option: number}
    arguments = [word for pair in measures.items() for word in pair]
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", *arguments)
    assert ended.code == 1
    found = re.escape(f"{float(number):g}")
    assert re.fullmatch(rf"error: (size|depth) holds {found}; positive .*\n", ended.err)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("measures", "says"),
    [
        (("--size", "5", "--resolution", "9" * 20), "should be less than or equal to 1024"),
        (("--size", "5", "--resolution", "9" * 400), "should be less than or equal to 1024"),
        (("--size", "1e-90", "--height", "1"), "square cells need 3.2e+91 rows"),
    ],
)
def test_a_resolution_of_any_size_is_one_sentence(visuohaptic, tmp_path, bottle, measures, says):
    (tmp_path / "poses.csv").write_text("x,y,z,normal_x,normal_y,normal_z\n25,0,30,1,0,0\n")
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", *measures)
    assert ended.code == 2
    assert says in ended.err
    assert press.MOST_ALONG_EDGE == pressing.MOST_ALONG_EDGE


PRESS = """
import resource, sys
from visuohaptic.cli.main import run

resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
run(sys.argv[1:])
"""


@pytest.mark.slow
def test_a_disk_that_is_full_is_one_sentence_and_leaves_no_part_of_a_file(tmp_path, bottle):
    (tmp_path / "poses.csv").write_text("x,y,z,normal_x,normal_y,normal_z\n25,0,30,1,0,0\n")
    out = tmp_path / "pressed"
    options = ("--poses", tmp_path / "poses.csv", "--size", 5, "--out", out)
    command = [sys.executable, "-c", PRESS, "press", bottle, *options]
    ended = subprocess.run([*map(str, command)], check=False, capture_output=True, text=True)
    assert ended.returncode == 1
    assert ended.stderr == f"error: {out / 'imprints.npy'} can't be written: File too large.\n"
    assert [*out.iterdir()] == []


POSE = "x,y,z,normal_x,normal_y,normal_z\n25,0,30,1,0,0\n"
TAXELS = (
    "x;y;z;direction_x;direction_y;direction_z\n0;0,5;0;0;0;-1\n0;-0,5;0;0;0;-1\n0;0;0;0;0;-2\n"
)


def test_a_layout_of_a_file_with_decimal_commas_is_pressed_and_drawn(visuohaptic, tmp_path, bottle):
    (tmp_path / "poses.csv").write_text(POSE)
    (tmp_path / "pad.csv").write_text(TAXELS)
    layout = ("--layout", "pad.csv", "--layout-unit", "cm", "--unit", "mm")
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", *layout)
    assert ended.code == 0, ended.err
    assert np.load(tmp_path / "pressed/imprints.npy").shape == (1, 3)
    heights = np.load(tmp_path / "pressed/heights.npy")
    # The wall is round: 25 mm, and 48 sections. Taxels 5 mm aside are 0.5 mm away.
    assert heights[0] == pytest.approx([-0.5, -0.5, 0], abs=0.06)
    assert (tmp_path / "pressed/layout.png").is_file()
    assert "3 taxels" in ended.out
    assert "note" not in ended.out


def test_millimetres_that_are_read_as_metres_are_said_once(visuohaptic, tmp_path, bottle):
    (tmp_path / "poses.csv").write_text(POSE + "25,0,40,1,0,0\n")
    (tmp_path / "pad.csv").write_text(TAXELS)
    layout = ("--layout", "pad.csv", "--layout-unit", "m", "--unit", "mm")
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", *layout)
    assert ended.code == 0, ended.err
    assert ended.out.count("check the units of both") == 1


@pytest.mark.parametrize(
    ("options", "code", "says"),
    [
        (("--layout", "fist", "--size", 5), 1, "fist can't be read: No such file"),
        (("--layout", "dome"), 1, "Layout dome has real lengths and unit is None; the unit of the mesh"),
        (("--layout", "pad.csv"), 1, "size is missing"),
        (("--layout", "dome", "--size", 5, "--height", 4), 2, "a layout has no --height"),
        ((), 2, "a width is needed without --layout"),
    ],
)  # fmt: skip
def test_a_layout_that_is_not_allowed_is_one_sentence(
    visuohaptic, tmp_path, bottle, options, code, says
):
    (tmp_path / "poses.csv").write_text(POSE)
    (tmp_path / "pad.csv").write_text(TAXELS)
    ended = visuohaptic("press", bottle, "--poses", "poses.csv", *options)
    assert ended.code == code
    assert says in re.sub(r"[│\s]+", " ", ended.err)
    assert not (tmp_path / "pressed").exists()
