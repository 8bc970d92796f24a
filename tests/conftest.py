"""What holds for every test: the same examples in every run, and no clock."""

from hypothesis import settings

# A busy machine is no failure, and a failure must come back.
settings.register_profile("suite", derandomize=True, deadline=None)
settings.load_profile("suite")
