"""The suite in two sizes: some seconds by default; all of it where `--stability` names a file."""

import functools
import gc
import os
import time

import pytest
from hypothesis import HealthCheck, settings
from numerics.recording import Recorder

RECORDER = Recorder()
STARTED = time.perf_counter()

SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.function_scoped_fixture]
settings.register_profile(
    "fast",
    max_examples=25,
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=SLOW,
)
settings.register_profile("full", settings.get_profile("fast"), max_examples=300)


def pytest_addoption(parser):
    parser.addoption(
        "--stability",
        metavar="FILE",
        help="run the numerical suite at its full counts and write what it finds",
    )


def _asked_for(config):
    return config.getoption("stability", None)


def pytest_collection_modifyitems(config, items):
    if _asked_for(config):
        return
    hard = [item for item in items if item.get_closest_marker("hard")]
    if hard:
        config.hook.pytest_deselected(items=hard)
        items[:] = [item for item in items if not item.get_closest_marker("hard")]


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """Give this folder's properties its own counts, which they take over on import, and no others."""
    settings.load_profile("full" if _asked_for(collector.config) else "fast")
    try:
        return (yield)
    finally:
        settings.load_profile("suite")


@pytest.fixture
def recorder():
    return RECORDER


@pytest.fixture
def hold():
    """Give the function that compares errors with their tolerance and keeps the worst."""
    return RECORDER.hold


@pytest.fixture
def no_caches():
    """Let no result that was computed before, or with a planted error, be taken for the library's."""
    forget_results()
    yield
    forget_results()


def forget_results():
    for found in gc.get_objects():
        if isinstance(found, functools._lru_cache_wrapper):
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
        config.workeroutput["stability"] = RECORDER.as_data()
    elif _asked_for(config) and "PYTEST_XDIST_WORKER" not in os.environ:
        RECORDER.write(_asked_for(config), time.perf_counter() - STARTED)
