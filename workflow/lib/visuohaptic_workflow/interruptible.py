"""Let Ctrl-C end the process of a job at once and without a traceback while the job's script imports modules.

Scripts of jobs, and nothing else, import this module, before all other imports: they take up to half of a short job. At
the start of its work, `jobs.job` lets Ctrl-C raise KeyboardInterrupt again, so that temporary files are removed.
"""

import signal
import threading

# A run in the background ignores Ctrl-C, and only the main thread may install a handler.
if (
    threading.current_thread() is threading.main_thread()
    and signal.getsignal(signal.SIGINT) == signal.default_int_handler
):
    signal.signal(signal.SIGINT, signal.SIG_DFL)
