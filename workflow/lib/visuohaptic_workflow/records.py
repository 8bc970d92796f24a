"""What a job checks before and after its work, and the record that it leaves."""

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
"""The variable of the environment that says which Python planned the run."""


class StateError(VisuohapticError):
    """What a job works with is not what the run was planned for."""


def check_inputs(given: Mapping[str, Any]) -> None:
    """Refuse files of another state than the run's, by what `Keys.given` gave to the job.

    Raises `StateError` if packages, code or sources are others than when the run began, or what it takes was made in
    another state. Versions in an environment of its own (conda, a container) are left to its definition.
    """
    if os.environ.get(PREFIX) == sys.prefix:
        for module, planned in given["parts"]["packages"].items():
            if (found := version_of(module)) != planned:
                raise StateError(
                    f"{module} is {found} here, and {planned} where the run was planned."
                )
    check_unchanged(given)
    for record, key in given["parts"]["from"].items():
        kept = read_record(record)
        if kept.get("key") != key:
            raise StateError(f"{record} is of another state than this run's; run again.")
        for file, digest in kept["tables"].items():
            if not _holds(file, digest):
                raise StateError(f"{file} is not what its record says; run again.")


def check_unchanged(given: Mapping[str, Any]) -> None:
    """Refuse code and sources that were changed, even if they were changed back, since the run began.

    Raises `StateError` if one has another content, inode, time of change or size.
    """
    files = given["files"]
    for part in ("code", "sources"):
        for file, (name, digest) in zip(files[part], given["parts"][part].items(), strict=True):
            if not _holds(file, digest):
                raise StateError(f"{name} was changed while this run was at work; run again.")
    if stamps_of([*files["code"], *files["sources"]]) != given["stamps"]:
        raise StateError(
            "a file of code or a source was written again while this run was at work; run again."
        )


def write_record(snakemake: Any, given: Mapping[str, Any] | None) -> None:
    """Write the record of the job that runs now, once its tables are there; one without a key fits never."""
    path = str(snakemake.output.record)
    tables = [str(file) for file in snakemake.output if str(file) != path]
    record = {
        "key": key_of(given["parts"]) if given else None,
        "parts": given["parts"] if given else {},
        "tables": {file: Digests().of(file) for file in tables},
        "log": str(snakemake.log[0]),
    }
    atomic_write_text(path, json.dumps(record, indent=1, sort_keys=True) + "\n")


def _holds(file: str, digest: str) -> bool:
    with suppress(OSError):
        return Digests().of(file) == digest
    return False
