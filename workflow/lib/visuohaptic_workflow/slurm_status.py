"""Print the state of a Slurm job for Snakemake: running, success or failed.

`python -P -m visuohaptic_workflow.slurm_status JOB` queries the controller, so no accounting database is needed.
"""

import re
import subprocess
import sys

_FAILED = re.compile(
    # Such a job stays pending until an administrator releases it.
    r"Reason=launch_failed_requeued_held|"
    r"\bJobState=(BOOT_FAIL|CANCELLED|DEADLINE|FAILED|NODE_FAIL|OUT_OF_MEMORY|PREEMPTED|TIMEOUT)\b"
)


def judge(answer: str) -> str:
    """Return the state from the output of `scontrol show job`, which is empty while the controller is down."""
    if _FAILED.search(answer):
        return "failed"
    return "success" if re.search(r"\bJobState=COMPLETED\b", answer) else "running"


def main(job: str) -> None:
    """Print the state of a job. A job that the controller no longer knows has failed."""
    status = subprocess.run(  # noqa: S603 - the number is Snakemake's
        ["scontrol", "show", "job", job],  # noqa: S607 - wherever the cluster has it
        check=False,
        capture_output=True,
        text=True,
    )
    is_forgotten = "Invalid job id" in status.stderr
    sys.stdout.write("failed\n" if is_forgotten else f"{judge(status.stdout)}\n")


if __name__ == "__main__":
    main(sys.argv[1])
