"""Begin the process of a job: Ctrl-C ends the process at once while modules are imported, and imports take less time.

Scripts of jobs, and nothing else, import this module, before all other imports: they take up to half of a short job. At
the start of its work, `jobs.job` lets Ctrl-C raise KeyboardInterrupt again, so that temporary files are removed, and calls
`end_imports`.
"""

import signal
import threading

# A run in the background ignores Ctrl-C, and only the main thread may install a handler.
if (
    threading.current_thread() is threading.main_thread()
    and signal.getsignal(signal.SIGINT) == signal.default_int_handler
):
    signal.signal(signal.SIGINT, signal.SIG_DFL)

# Plug-ins, which may import pandas, are loaded by this import.
from visuohaptic.base.quick_imports import begin_imports

begin_imports()
