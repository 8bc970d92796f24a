"""The lock file by which DVC knows a finished run, `dvc.lock`: written only for results that today's keys would give."""

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

LOCK = Path("dvc.lock")

STAGE = "experiment"
"""The stage of `dvc.yaml` that is locked; stages of studies are the user's to commit."""

IN_STAGE = "DVC_STAGE"
"""The variable that DVC sets in the environment of a stage's command."""

EMPTY_WHERE_NOTHING_IS_MADE = (
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
"""Outputs of `dvc.yaml` that a run may not fill; DVC fails where an output is missing, and warns of an empty one."""

KEPT = ".keep"
"""The file that keeps an empty folder; readers of tables pass over hidden files."""

OWN_MESHES = "meshes/own"
"""The folder of meshes that users add."""

_KEPT_AS_IT_WAS = "dvc.lock stays as it was"


class LockError(VisuohapticError):
    """The lock file can't be written for the results that are there."""


def is_lockable() -> bool:
    """Return whether this folder is a repository of Git and DVC, with DVC installed, and no stage of DVC runs."""
    is_repository = Path(".dvc").is_dir() and Path(".git").exists() and Path("dvc.yaml").exists()
    return is_repository and IN_STAGE not in os.environ and find_spec("dvc") is not None


def make_empty_outputs() -> None:
    """Make the folders of `EMPTY_WHERE_NOTHING_IS_MADE`, each with a file `KEPT`."""
    for folder in map(Path, EMPTY_WHERE_NOTHING_IS_MADE):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / KEPT).touch()


def lock_in_new_process(environment: Mapping[str, str]) -> None:
    """Ask a new process, which reads the workflow and its parameters again, to write the lock.

    Its sentences go to standard error. Its failure fails nothing: the results are there.
    """
    ask = ["snakemake", "--list-rules", "--quiet", "--workflow-profile", "none"]
    command = [sys.executable, "-m", *ask]
    with suppress(KeyboardInterrupt):  # the new process gets it, too, and the results are there
        subprocess.run(command, env=environment, check=False, stdout=sys.stderr)  # noqa: S603 - our own words


def write_lock(
    keys: Keys, targets: Iterable[str], are_parameters_current: Callable[[], bool]
) -> None:
    """Let DVC write its lock for the results behind `targets`.

    `are_parameters_current` reads ``params.yaml`` again, and returns whether it says what the keys are made of. Raises
    `LockError` if a record does not fit today's key, if an input or result changes meanwhile, or if DVC refuses; the
    lock is then as it was before.
    """
    records = keys.needed_for(targets)
    if stale := [record for record in records if keys.why(record)]:
        raise LockError(
            f"{_KEPT_AS_IT_WAS}: {len(stale)} results are not those of today's parameters, code and meshes, "
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
        said = [line for line in done.stderr.splitlines() if line.startswith("ERROR: ")]
        reason = said[0].removeprefix("ERROR: ") if said else f"status {done.returncode}"
        raise LockError(f"{_KEPT_AS_IT_WAS}: `dvc commit` ended with: {reason}.")
    if not (are_parameters_current() and all(map(keys.is_unchanged, records))):
        _restore(old)
        raise LockError(f"{_KEPT_AS_IT_WAS}: a file changed while DVC read the results; run again.")


def check_clone() -> None:
    """Check the clone of a DVC experiment that runs in a folder of its own.

    Raises
    ------
    LockError
        The clone is shallow: Git can't fetch the experiment's commit into the clone, and DVC reports nothing. Or Git
        does not track a mesh in `OWN_MESHES`: the experiment's folder lacks this mesh.
    """
    clone = os.environ.get("DVC_ROOT", "")
    if not clone or Path(clone) == Path.cwd():
        return
    if _git(clone, "rev-parse", "--is-shallow-repository").strip() == "true":
        raise LockError(
            f"{clone} is a shallow clone, from which DVC would lose this experiment's result; "
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
    """Return whether a lock is there and is YAML of several entries; DVC refuses one that was cut off."""
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
