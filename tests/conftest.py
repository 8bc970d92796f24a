"""What holds for every test: the same examples in every run, no clock, and long files first."""

import signal

from hypothesis import settings

# A busy machine is no failure, and a failure must come back.
settings.register_profile("suite", derandomize=True, deadline=None)
settings.load_profile("suite")

# A shell that starts tests in the background lets them, and all that they start, ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """Begin with the workflow, whose files take minutes, so that no process waits for one at the end."""
    items.sort(key=lambda item: "workflow" not in item.path.parts)
