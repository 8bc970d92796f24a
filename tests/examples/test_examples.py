"""Each example of a plug-in runs as it is written, and passes the tests of every entry of its kind."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from source_folders import PYTHONPATH

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "extending.md").read_text()
EXAMPLES = {path.stem: path for path in sorted((ROOT / "examples").glob("*.py"))}
TESTS = {
    Path(row[0]).stem: re.findall(r"`(tests/.*?)`", row[1])
    for row in re.findall(r"^\|.*\[`(examples/\w+\.py)`\].*\|(.*)\|$", PAGE, re.MULTILINE)
}
PRINTED = {
    "closest": r"2\.\d+( 2\.\d+){4}",
    "extra_trees": "cup lamp",
    "grid_means": r"16( 0\.\d+){5}",
    "principal": r"\(20, 5, 3\) 2\d\.\d 2\d\.\d 2\d\.\d",
    "redness": r"red 1\.0 blue 0\.0",
    "torch_classifier": r"1\.0",
    # Rounding of other processors may move single touches.
    "train_agent": r"at_random 0\.(8\d|9)\nby_worth 0\.9[4-9]",
    "twenty_lines": r"1\.0",
    "zero_offset": r"0\.1 0\.6 1\.0 1\.0 by zero_offset",
}

NEEDS = {"torch_classifier": "torch"}
"""Packages that no extra of the developers brings, by example."""
PLUG_INS = {name: path for name, path in EXAMPLES.items() if TESTS.get(name)}


def run(*command, **variables):
    return subprocess.run(
        [sys.executable, *command],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": PYTHONPATH, **variables},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_page_names_every_example_and_its_tests():
    assert set(TESTS) == set(EXAMPLES) == set(PRINTED)
    assert all((ROOT / file).is_file() for files in TESTS.values() for file in files)


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_runs_as_written(name):
    if name in NEEDS:
        pytest.importorskip(NEEDS[name], reason=f"{NEEDS[name]} is not installed")
    ran = run(EXAMPLES[name])
    assert ran.returncode == 0, ran.stderr
    assert re.fullmatch(PRINTED[name], ran.stdout.strip())
    numbers = [float(number) for number in ran.stdout.split() if name == "closest"]
    assert numbers == sorted(numbers)


@pytest.mark.slow
def test_the_examples_pass_the_tests_of_every_entry():
    files = sorted({file for found in TESTS.values() for file in found})
    command = ["-m", "pytest", "-p", "no:cacheprovider", "-v", "-k", " or ".join(PLUG_INS), *files]
    plug_ins = os.pathsep.join(map(str, PLUG_INS.values()))
    ran = run(*command, VISUOHAPTIC_PLUGINS=plug_ins)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    for name in PLUG_INS:
        expected = TESTS[name]
        passed = re.findall(rf"^(tests/\S+\.py)::.*\b{name}\b.* PASSED", ran.stdout, re.MULTILINE)
        assert set(passed) >= set(expected), name
