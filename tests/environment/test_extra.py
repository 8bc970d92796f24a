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
def test_no_module_outside_of_the_environment_imports_gymnasium_or_the_environment():
    ran = run("""
import importlib, pkgutil, sys, visuohaptic
# Packages are imported to find their modules; this one can't be.
sys.modules["visuohaptic.environment"] = None
names = [one.name for one in pkgutil.walk_packages(visuohaptic.__path__, "visuohaptic.")]
for name in names:
    if not name.startswith("visuohaptic.environment"):
        importlib.import_module(name)
print(len(names), "gymnasium" in sys.modules)
""")
    assert ran.returncode == 0, ran.stderr
    count, imported = ran.stdout.split()
    assert int(count) > 200
    assert imported == "False"


@pytest.mark.slow
def test_without_gymnasium_the_package_is_imported_and_a_name_of_it_says_which_extra_is_missing():
    ran = run("""
import importlib.util
found = importlib.util.find_spec
importlib.util.find_spec = lambda name, *rest: None if name == "gymnasium" else found(name, *rest)
import visuohaptic.environment
print("imported")
from visuohaptic.environment import TouchEnv
""")
    assert ran.returncode == 1
    assert ran.stdout == "imported\n"
    assert ran.stderr.splitlines()[-1] == (
        "visuohaptic.base.errors.MissingPackageError: gymnasium is not installed; "
        "`pip install 'visuohaptic[environment]'` brings it."
    )
