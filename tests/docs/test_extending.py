"""Each example of docs/extending.md is applied to a copy, where the tests of every entry run over it."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "extending.md").read_text()
EXAMPLES = dict(
    re.findall(r"^## An? ([\w ]+)\n(.*?)(?=^## |\Z)", PAGE, flags=re.MULTILINE | re.DOTALL)
)


def block(example, kind):
    (text,) = re.findall(rf"^```{kind}\n(.*?)^```", EXAMPLES[example], re.MULTILINE | re.DOTALL)
    return text


def edited_files(example):
    return set(re.findall(r"^\+\+\+ b/(.*)$", block(example, "diff"), re.MULTILINE))


def test_the_table_names_the_files_that_each_example_edits():
    rows = [row.split("|")[1:] for row in re.findall(r"^\| an? .*$", PAGE, re.MULTILINE)]
    named = {row[0].split(" ", 2)[2].strip(): set(re.findall("`(.*?)`", row[2])) for row in rows}
    assert named == {
        example: {file for file in edited_files(example) if not file.startswith("tests/")}
        for example in EXAMPLES
    }


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_passes_the_tests_of_every_entry_and_its_own(example, tmp_path):
    left_out = shutil.ignore_patterns("__pycache__")
    for folder in ("src", "packages", "tests"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=left_out)
    for file in ("pyproject.toml", "params.yaml"):
        shutil.copy(ROOT / file, tmp_path)
    (tmp_path / "example.diff").write_text(block(example, "diff"))
    # In a folder within a repository, git would skip files that the repository does not track.
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(tmp_path.parent)}
    environment["PYTHONPATH"] = os.pathsep.join(
        str(tmp_path / name) for name in ("src", "packages/contourlets/src")
    )
    subprocess.run(["git", "apply", "example.diff"], cwd=tmp_path, env=environment, check=True)
    prompt, program, *arguments = shlex.split(block(example, "console"))
    assert (prompt, program) == ("$", "pytest")
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-v", *arguments],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    own = next(file for file in edited_files(example) if file.startswith("tests/"))
    passed = set(re.findall(r"^(tests/\S+\.py)::.* PASSED", ran.stdout, re.MULTILINE))
    assert own in passed
    # Every file of the command has tests of the new entry.
    assert passed == {word for word in arguments if word.endswith(".py")}
