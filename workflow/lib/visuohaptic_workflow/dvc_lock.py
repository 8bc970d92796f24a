"""Write `dvc.lock`, by which DVC recognises a finished run, but only for results of the current keys."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import yaml

from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import VisuohapticError
from visuohaptic_workflow.keys import Keys
from visuohaptic_workflow.sweeping import Sweep

LOCK = Path("dvc.lock")

STAGE = "experiment"
"""The stage of `dvc.yaml` to lock. Users commit stages of studies themselves."""

IN_STAGE = "DVC_STAGE"
"""The variable that DVC sets in the environment of a stage's command."""

OUTPUTS_THAT_MAY_BE_EMPTY = (
    "meshes/downloaded",
    *(
        f"results/{folder}/{study}"
        for study in ("frontier", "random_draws")
        for folder in (
            "study_blocks",
            "study_features",
            "study_records/block_of_study",
            "study_records/features_of_study",
        )
    ),
)
"""Outputs of `dvc.yaml` that a run may leave empty. DVC fails if an output is missing, and warns of empty outputs."""

KEPT = ".keep"
"""The file that makes an empty folder non-empty. Readers of tables ignore hidden files."""

OWN_MESHES = "meshes/own"
"""The folder of meshes that users add."""

_UNCHANGED = "dvc.lock stays as it was"


class LockError(VisuohapticError):
    """The lock file can't be written for the existing results."""


def is_lockable() -> bool:
    """Return whether this folder is a repository of Git and DVC, DVC is installed, and no stage of DVC is running."""
    is_repository = Path(".dvc").is_dir() and Path(".git").exists() and Path("dvc.yaml").exists()
    return is_repository and IN_STAGE not in os.environ and find_spec("dvc") is not None


def make_empty_outputs() -> None:
    """Make the folders of `OUTPUTS_THAT_MAY_BE_EMPTY`, each with a file `KEPT`."""
    for folder in map(Path, OUTPUTS_THAT_MAY_BE_EMPTY):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / KEPT).touch()


def lock_in_new_process(environment: Mapping[str, str]) -> bool:
    """Write the lock in a new process, which reads the workflow and its parameters again.

    Its output goes to standard error. Return whether the lock was written; the results are complete without it.
    """
    ask = ["snakemake", "--list-rules", "--quiet", "--workflow-profile", "none"]
    command = [sys.executable, "-m", *ask]
    with suppress(
        KeyboardInterrupt
    ):  # the new process gets the signal too, and the results are complete
        done = subprocess.run(command, env=environment, check=False, stdout=sys.stderr)  # noqa: S603 - our own words
        return done.returncode == 0
    return False


def write_lock(
    keys: Keys,
    targets: Iterable[str],
    are_parameters_current: Callable[[], bool],
    sweep: Sweep,
) -> None:
    """Let DVC write its lock for the results behind `targets`.

    Parameters
    ----------
    keys : Keys
        The keys of all jobs.
    targets : iterable of str
        Files of the run.
    are_parameters_current : callable
        Reads ``params.yaml`` again and returns whether the keys have the same parameters.
    sweep : Sweep
        What is stale in the folder.

    Raises
    ------
    LockError
        If a result is not current, an input or result changes meanwhile, or DVC fails.
        The lock is then unchanged.
    """
    records = keys.needed_for(targets)
    stale = [*sweep.moved, *(record for record in records if record in sweep.stale)]
    if stale:
        raise LockError(
            f"{_UNCHANGED}: {len(stale)} results do not match the current parameters, code and meshes, "
            f"such as {stale[0]}; `make why` lists the reasons."
        )
    make_empty_outputs()
    old = LOCK.read_bytes() if _is_readable(LOCK) else None
    if old is None:
        LOCK.unlink(missing_ok=True)
    command = [sys.executable, "-m", "dvc", "commit", "--force", STAGE]
    done = subprocess.run(command, check=False, capture_output=True, text=True)  # noqa: S603 - our own words
    if done.returncode:
        _restore(old)
        errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR: ")]
        reason = errors[0].removeprefix("ERROR: ") if errors else f"status {done.returncode}"
        raise LockError(f"{_UNCHANGED}: `dvc commit` ended with: {reason}.")
    if not (are_parameters_current() and all(map(keys.is_unchanged, records))):
        _restore(old)
        raise LockError(f"{_UNCHANGED}: a file changed while DVC read the results; run again.")


def check_clone() -> None:
    """Check the clone of a DVC experiment that runs in a folder of its own.

    Raises
    ------
    LockError
        The clone is shallow: Git can't fetch the experiment's commit into the clone, and DVC reports no error. Or Git
        does not track a mesh in `OWN_MESHES`: the experiment's folder lacks this mesh.
    """
    clone = os.environ.get("DVC_ROOT", "")
    if not clone or Path(clone) == Path.cwd():
        return
    if _git(clone, "rev-parse", "--is-shallow-repository").strip() == "true":
        raise LockError(
            f"{clone} is a shallow clone, in which DVC would lose this experiment's result; "
            "run `git fetch --unshallow` there, then the experiment again."
        )
    untracked = _git(
        clone, "ls-files", "-z", "--others", "--exclude-standard", "--", OWN_MESHES
    ).split("\0")
    if untracked[0]:
        raise LockError(
            f"Git does not track {untracked[0]}, so a queued experiment would run without this file; "
            f"run `git add {OWN_MESHES}`, then queue the experiment again."
        )


def is_committed() -> bool:
    """Return whether the lock is in the last commit, so that queued experiments start with its results."""
    command = ["git", "cat-file", "-e", f"HEAD:./{LOCK}"]
    return subprocess.run(command, check=False, capture_output=True).returncode == 0  # noqa: S603 - our own words


def _git(folder: str, *arguments: str) -> str:
    """Return what Git prints in a folder; empty if Git fails."""
    command = ["git", "-C", folder, *arguments]
    return subprocess.run(command, check=False, capture_output=True, text=True).stdout  # noqa: S603 - our own words


def _is_readable(lock: Path) -> bool:
    """Return whether the lock is a YAML mapping; DVC refuses a truncated lock."""
    try:
        return isinstance(yaml.safe_load(lock.read_bytes()), dict)
    except (OSError, yaml.YAMLError):
        return False


def _restore(content: bytes | None) -> None:
    if content is None:
        LOCK.unlink(missing_ok=True)
        return
    with atomic_file(LOCK) as copy:
        copy.write_bytes(content)
