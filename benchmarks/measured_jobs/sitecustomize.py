"""Append processor seconds and peak memory of every job of a measured run to a file.

`benchmarks.many_objects` puts this folder on PYTHONPATH, so that each Python process of the run imports this module at its
start. `MEASURED_JOBS` is the file: one JSON object per line, with ``phase``, ``processor_s`` and ``memory_mb``.
"""

import atexit
import json
import os
import resource
import sys
from pathlib import Path


def peak_memory() -> float:
    """Return the peak memory of this process, MB. `ru_maxrss` would include Snakemake's, which started the process."""
    status = dict(
        line.split(":", 1)
        for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    )
    return int(status["VmHWM"].split()[0]) / 1024


def append_usage() -> None:
    """Append the usage of this process and its children if the process is a job of Snakemake."""
    script = Path(sys.argv[0])
    if script.parent.name != "scripts" or script.parent.parent.name != ".snakemake":
        return
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    line = {
        # Snakemake names its copy of a script tmp<random>.<name of the script>.py.
        "phase": script.stem.partition(".")[2],
        "processor_s": sum(usage.ru_utime + usage.ru_stime for usage in usages),
        "memory_mb": peak_memory(),
    }
    with Path(os.environ["MEASURED_JOBS"]).open("a", encoding="utf-8") as file:
        file.write(f"{json.dumps(line)}\n")


atexit.register(append_usage)
