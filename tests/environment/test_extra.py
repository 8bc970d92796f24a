"""The library without the extra imports nothing of it, and says which extra is missing."""

import subprocess
import sys

import pytest
from source_folders import PYTHONPATH


def run(code):
    return subprocess.run(
        [sys.executable, "-c", code],
        check=False,
        env={"PYTHONPATH": PYTHONPATH},
        capture_output=True,
        text=True,
    )


@pytest.mark.slow
def test_no_import_of_the_library_brings_gymnasium():
    code = """
import sys, visuohaptic as vh, visuohaptic.environment
vh.example("chair"), vh.touch, vh.register
assert "gymnasium" not in sys.modules
"""
    assert run(code).stderr == ""


@pytest.mark.slow
def test_a_name_of_the_environment_says_which_extra_is_missing():
    ran = run("""
import importlib.util
found = importlib.util.find_spec
importlib.util.find_spec = lambda name, *rest: None if name == "gymnasium" else found(name, *rest)
import visuohaptic.environment
from visuohaptic.environment import TouchEnv
""")
    assert ran.returncode == 1
    assert ran.stderr.splitlines()[-1] == (
        "visuohaptic.base.errors.MissingPackageError: gymnasium is not installed; "
        "`pip install 'visuohaptic[environment]'` brings it."
    )
