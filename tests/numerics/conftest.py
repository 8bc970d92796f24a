"""The suite in two sizes: some seconds by default; all of it where `--stability` names a page."""

import functools
import os
import sys

import pytest
from numerics.hard_cases.images import exact_bank
from numerics.recording import Recorder

RECORDER = Recorder()


def pytest_addoption(parser):
    parser.addoption(
        "--stability",
        metavar="PAGE",
        help="run the numerical suite at its full counts, and write a Markdown page of what it finds",
    )


def _asked_for(config):
    return config.getoption("stability", None)


def pytest_collection_modifyitems(config, items):
    hard = [item for item in items if item.get_closest_marker("hard")]
    if hard and not _asked_for(config):
        config.hook.pytest_deselected(items=hard)
        items[:] = [item for item in items if item not in hard]


@pytest.fixture
def recorder():
    """Compares errors with their tolerance and keeps the worst."""
    return RECORDER


@pytest.fixture
def no_caches():
    """Let no result that was computed before, or with a planted error, be taken for the library's."""
    forget_results()
    yield
    forget_results()


def forget_results():
    ours = [
        module
        for name, module in sys.modules.items()
        if name.partition(".")[0] in {"contourlets", "meshreaders", "numerics", "visuohaptic"}
    ]
    # The transform's definition is the tests' own, and takes a second.
    for found in [value for module in ours for value in vars(module).values()]:
        if isinstance(found, functools._lru_cache_wrapper) and found is not exact_bank:
            found.cache_clear()


@pytest.fixture
def full(request):
    """Tell whether the suite runs at its full counts."""
    return bool(_asked_for(request.config))


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Take over what a worker of pytest-xdist found."""
    found = getattr(node, "workeroutput", {}).get("stability")
    if found:
        RECORDER.merge(found)


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session, exitstatus):
    config = session.config
    if hasattr(config, "workeroutput"):
        config.workeroutput["stability"] = RECORDER.as_bytes()
    elif _asked_for(config) and "PYTEST_XDIST_WORKER" not in os.environ:
        RECORDER.write(_asked_for(config))
