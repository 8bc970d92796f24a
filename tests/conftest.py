"""What holds for every test: the same examples in every run, no clock, and long files first."""

import signal

from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

# A busy machine is no failure, and a failure must come back. tests/test_hypothesis_settings.py checks both.
settings.register_profile(
    "suite", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("suite")
# Hypothesis also draws numbers and texts that it finds in the imported modules of the project. Which modules are
# imported depends on the tests that ran before in the same process, and with pytest-xdist on the load of the
# machine. Reading the modules takes seconds on a busy machine, which count as slow drawing. Hypothesis has no
# setting for this, so no module counts as a module of the project.
providers.is_local_module_file = lambda _: False

# A shell that starts tests in the background lets them, and all that they start, ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """Begin with the workflow, whose files take minutes, so that no process waits for one at the end."""
    items.sort(key=lambda item: "workflow" not in item.path.parts)
