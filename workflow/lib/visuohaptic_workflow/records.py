"""Check the inputs of a job before and after its work, and write its record."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import VisuohapticError
from visuohaptic_workflow.code_of_jobs import version_of
from visuohaptic_workflow.digests import Digests, stamps_of
from visuohaptic_workflow.keys import key_of, read_record

PREFIX = "VISUOHAPTIC_PREFIX"
"""The environment variable with `sys.prefix` of the Python that planned the run."""


class StateError(VisuohapticError):
    """Packages, code or inputs of a job have changed since the run was planned."""


def check_inputs(snapshot: Mapping[str, Any]) -> None:
    """Check that packages, code and inputs are those of the plan.

    Versions of packages are checked only in the environment that planned the run, not in one of conda or a container.

    Parameters
    ----------
    snapshot : mapping
        The result of `Keys.snapshot`.

    Raises
    ------
    StateError
        If a package, a file of code or a source has changed since the run began, or an input was made with another key.
    """
    if os.environ.get(PREFIX) == sys.prefix:
        for module, planned in snapshot["parts"]["packages"].items():
            if (installed := version_of(module)) != planned:
                raise StateError(
                    f"{module} has version {installed}, but the run was planned with {planned}; run again."
                )
    check_unchanged(snapshot)
    for record, key in snapshot["parts"]["from"].items():
        kept = read_record(record)
        if kept.get("key") != key:
            raise StateError(f"{record} is not of this run; run again.")
        for file, digest in kept["tables"].items():
            if not _has_digest(file, digest):
                raise StateError(f"{file} differs from its record; run again.")


def check_unchanged(snapshot: Mapping[str, Any]) -> None:
    """Check that code and sources were not written since the run began, even if their content is the same again.

    Raises `StateError` if the content, inode, size or a time of a file has changed.
    """
    files = snapshot["files"]
    for part in ("code", "sources"):
        for file, (name, digest) in zip(files[part], snapshot["parts"][part].items(), strict=True):
            if not _has_digest(file, digest):
                raise StateError(f"{name} was changed during this run; run again.")
    if stamps_of([*files["code"], *files["sources"]]) != snapshot["stamps"]:
        raise StateError("a file of code or a source was written during this run; run again.")


def write_record(snakemake: Any, snapshot: Mapping[str, Any] | None) -> None:
    """Write the record of the current job after its tables. A record without a snapshot is never current."""
    path = str(snakemake.output.record)
    tables = [str(file) for file in snakemake.output if str(file) != path]
    record = {
        "key": key_of(snapshot["parts"]) if snapshot else None,
        "parts": snapshot["parts"] if snapshot else {},
        "tables": {file: Digests().of(file) for file in tables},
        "log": str(snakemake.log[0]),
    }
    atomic_write_text(path, json.dumps(record, indent=1, sort_keys=True) + "\n")


def _has_digest(file: str, digest: str) -> bool:
    with suppress(OSError):
        return Digests().of(file) == digest
    return False
