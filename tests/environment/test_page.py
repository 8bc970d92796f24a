"""The page's code runs and prints what it shows, in a process that knows nothing before."""

import subprocess
import sys
from pathlib import Path

import pytest
from docs.shell_commands import blocks
from source_folders import PYTHONPATH

PAGE = Path(__file__).parents[2] / "docs/environment.md"


@pytest.mark.slow
def test_the_code_of_the_page_prints_what_the_page_shows():
    code = "\n".join(blocks(PAGE, "python"))
    ran = subprocess.run(
        [sys.executable, "-W", "error::UserWarning:gymnasium", "-c", code],
        env={"PYTHONPATH": PYTHONPATH},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    [shown] = blocks(PAGE, "text")
    assert ran.stdout.splitlines() == [shown.strip(), "(5, 32, 32)"]


def test_the_loop_takes_ten_lines():
    loop = blocks(PAGE, "python")[0]
    lines = [line for line in loop.splitlines() if line and not line.startswith("import ")]
    assert len(lines) <= 10
