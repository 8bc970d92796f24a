"""Every hostile or odd input of the table ends as it must, in one sentence and without leavings."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
from cli.hostile_inputs import CASES, fits, run_case
from source_folders import PYTHONPATH

PROGRAM = "from visuohaptic.cli.main import main; main()"


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.group}: {case.name}")
def test_it_ends_as_it_must(case, tmp_path):
    ending = run_case(case, tmp_path)
    assert fits(case, ending), ending


def test_every_kind_of_input_is_in_the_table():
    assert len(CASES) >= 120
    assert len({(case.group, case.name) for case in CASES}) == len(CASES)


@pytest.fixture
def ring(tmp_path):
    trimesh.creation.torus(1, 0.4, 16, 8).export(tmp_path / "tasse à café.obj")
    (tmp_path / "quick.yaml").write_text("{rendering: {resolution: 32}, viewpoints: {count: 1}}")
    return ("touch", "tasse à café.obj", "--params", "quick.yaml")


def run(arguments, folder, **options):
    return subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments], cwd=folder, check=False,
        env={**os.environ, "PYTHONPATH": PYTHONPATH, **options.pop("env", {})},
        **({"stdout": subprocess.PIPE} | options), stderr=subprocess.PIPE, timeout=120,
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [("--version",), ("--help",), None], ids=str)
def test_a_full_disk_behind_the_output_is_one_sentence(ring, tmp_path, arguments):
    with Path("/dev/full").open("w") as full:
        ended = run(arguments or ring, tmp_path, stdout=full)
    assert ended.returncode == 1
    assert ended.stderr.decode() == "error: Writing or reading failed: No space left on device.\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("locale", "encoding"),
    [("C", "ascii"), ("POSIX", "cp1252"), ("tr_TR.UTF-8", "utf-8"), ("nonsense", "latin-1")],
)
def test_no_locale_or_encoding_stops_it(ring, tmp_path, locale, encoding):
    env = {"LANG": locale, "LC_ALL": locale, "PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}
    ended = run(ring, tmp_path, env=env)
    assert ended.returncode == 0, ended.stderr
    assert b"5 touches from 1 viewpoints" in ended.stdout
    assert ended.stderr == b""
