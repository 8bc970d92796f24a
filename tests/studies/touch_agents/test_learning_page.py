"""The agent of the page learns what the page says, and the page's answers are those of the figures."""

import subprocess
import sys
from pathlib import Path

import pytest
from docs.shell_commands import blocks
from source_folders import PYTHONPATH

PAGE = Path(__file__).parents[3] / "studies/touch_agents/learning.md"


@pytest.mark.slow
def test_the_agent_of_the_page_learns_where_to_touch():
    [code], [shown] = blocks(PAGE, "python"), blocks(PAGE, "text")
    ran = subprocess.run(
        [sys.executable, "-c", code],
        env={"PYTHONPATH": PYTHONPATH},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    made, told = (
        {name: float(share) for name, share in map(str.split, text.splitlines())}
        for text in (ran.stdout, shown)
    )
    # Rounding of other processors may move single touches.
    assert made == pytest.approx(told, abs=0.03)
    assert made["by_worth"] > made["at_random"] + 0.05
