"""Hand a job's script over to the process that starts jobs warm.

Python imports a module of this name at its start. Only the workflow puts this folder on the path,
for the processes that it starts. If no server takes the script, it starts as a normal process.
"""

import _signal  # `signal` itself takes a millisecond
import os
import sys

_SCRIPTS = os.path.join(".snakemake", "scripts")


def _start_warm() -> None:
    from visuohaptic_workflow.warm_start import hand_over

    status = hand_over(sys.orig_argv[1])
    if status is not None:
        os._exit(status)


# Without pathlib, whose import would cost every start some milliseconds.
if len(sys.orig_argv) == 2 and os.path.dirname(sys.orig_argv[1]).endswith(_SCRIPTS):
    # An interrupt ends this process without a traceback; `jobs.job` lets a script tidy up.
    _signal.signal(_signal.SIGINT, _signal.SIG_DFL)
    _start_warm()

# Import the sitecustomize that this one shadows.
sys.path.remove(os.path.dirname(__file__))
del sys.modules[__name__]
import sitecustomize  # noqa: E402, F401
