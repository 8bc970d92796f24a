"""Say of a Slurm job what Snakemake asks: running, success or failed.

`python -P -m visuohaptic_workflow.slurm_status JOB` asks the controller itself, so no accounting database is needed.
"""

import re
import subprocess
import sys

_FAILED = frozenset(
    [
        "BOOT_FAIL",
        "CANCELLED",
        "DEADLINE",
        "FAILED",
        "NODE_FAIL",
        "OUT_OF_MEMORY",
        "PREEMPTED",
        "TIMEOUT",
    ]
)


def judge(answer: str) -> str:
    """Judge a job by what `scontrol show job` says of it, nothing while the controller is down: running, success or failed."""
    # Such a job is pending until an administrator releases it.
    if "Reason=launch_failed_requeued_held" in answer:
        return "failed"
    states = re.findall(r"\bJobState=([A-Z_]+)", answer)
    if not states or not {"COMPLETED", *_FAILED}.intersection(states):
        return "running"
    return "failed" if _FAILED.intersection(states) else "success"


def main(job: str) -> None:
    """Print the state of a job; one that the controller has forgotten has failed."""
    asked = subprocess.run(  # noqa: S603 - the number is Snakemake's
        ["scontrol", "show", "job", job],  # noqa: S607 - wherever the cluster has it
        check=False,
        capture_output=True,
        text=True,
    )
    is_forgotten = "Invalid job id" in asked.stderr
    sys.stdout.write("failed\n" if is_forgotten else f"{judge(asked.stdout)}\n")


if __name__ == "__main__":
    main(sys.argv[1])
