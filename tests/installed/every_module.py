"""Every module can be imported with the packages that users have: `make test-installed`."""

import importlib
import pkgutil

import pytest

import contourlets
import meshreaders
import visuohaptic
import visuohaptic_workflow

# What needs an extra that `make` does not bring refuses in a sentence before it imports these.
OF_AN_EXTRA = {
    "meshreaders.formats.collada",
    "visuohaptic.environment.registration",
    "visuohaptic.environment.single",
    "visuohaptic.environment.vector",
}


@pytest.mark.parametrize("package", [contourlets, meshreaders, visuohaptic, visuohaptic_workflow])
def test_every_module_can_be_imported(package):
    names = [
        found.name for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    ]
    assert names
    for name in set(names) - OF_AN_EXTRA:
        importlib.import_module(name)
