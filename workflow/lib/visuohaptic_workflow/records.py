"""Records: what made a file, written beside the results so that they travel with them.

Snakemake remembers parameters in `.snakemake`, which neither git nor DVC carries. A job's record
holds the same in a file: the parameters of its rule, and the SHA-256 of its code, its
inputs and its outputs. So anyone who gets the files can check whether they are what the rules
would make now.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Protocol

TIMESTAMP = ".snakemake_timestamp"
"""The file in a folder that is an output by whose time Snakemake judges it."""


class RecordedJob(Protocol):
    """A job that keeps a record."""

    @property
    def params(self) -> Mapping[str, Any]:
        """The rule's parameters for this job."""

    @property
    def code(self) -> list[str]:
        """Files of the code that the job runs."""

    @property
    def inputs(self) -> list[str]:
        """Files that the job reads, without the code."""

    @property
    def outputs(self) -> list[str]:
        """Files that the job writes; its record is one of them."""

    @property
    def record(self) -> str:
        """The file that says what made the outputs."""


def write_record(snakemake: Any) -> None:
    """Write the record of the job that runs now, once its outputs are there.

    Parameters
    ----------
    snakemake : object
        What Snakemake gives a script; without an output named `record` nothing is written.

    Raises
    ------
    TypeError
        If a parameter is not made of built-in types; Snakemake would not remember it either.
    """
    path = getattr(snakemake.output, "record", None)
    if path is None:
        return
    code = list(getattr(snakemake.input, "code", ()))
    record = _record(
        params=dict(snakemake.params.items()),
        code=code,
        inputs=set(map(str, snakemake.input)) - set(map(str, code)),
        outputs=[str(file) for file in snakemake.output if str(file) != path],
    )
    text = json.dumps(record, indent=1, sort_keys=True) + "\n"
    unfinished = Path(f"{path}.part")
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(path)


def is_current(job: RecordedJob) -> bool:
    """Whether a job's files are what the job would make now, by the record beside them.

    Parameters
    ----------
    job : RecordedJob
        The job.

    Returns
    -------
    bool
        False also where a file or the record is missing, or the record can't be read.
    """
    try:
        expected = expected_record(job)
    except OSError:  # a file of its code is gone
        return False
    return fits_record(job.record, expected)


def expected_record(job: RecordedJob) -> str:
    """Sum up what a job's record would say, but for the contents of inputs and outputs.

    Parameters
    ----------
    job : RecordedJob
        The job.

    Returns
    -------
    str
        64 hexadecimal digits.

    Raises
    ------
    OSError
        If a file of its code can't be read.
    """
    outputs = [file for file in job.outputs if file != job.record]
    return _sum_up(
        {
            "params": job.params,
            "code": _digest_of_code(job.code),
            "inputs": sorted(set(job.inputs)),
            "outputs": sorted(set(outputs)),
        }
    )


def fits_record(path: str | Path, expected: str) -> bool:
    """Whether a record says what is expected, and its files still have the contents it names.

    Parameters
    ----------
    path : path
        The record.
    expected : str
        What `expected_record` gave.

    Returns
    -------
    bool
        False also where a file or the record is missing, or the record can't be read.
    """
    try:
        kept = json.loads(Path(path).read_text(encoding="utf-8"))
        files = {**kept["inputs"], **kept["outputs"]}
        names = {part: sorted(kept[part]) for part in ("inputs", "outputs")}
        kept.pop("rule", None)  # in older records
        if _sum_up({**kept, **names}) != expected:
            return False
        return all(digest(file) == found for file, found in files.items())
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _sum_up(record: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def digest(path: str | Path) -> str:
    """Give the SHA-256 of a file, or of all files in a folder with their names.

    Parameters
    ----------
    path : path
        The file or folder.

    Returns
    -------
    str
        64 hexadecimal digits. Remembered until the file's time or size changes.

    Raises
    ------
    OSError
        If it can't be read.
    """
    path = Path(path)
    if not path.is_dir():
        found = path.stat()
        return _digest_of_version(os.fspath(path), found.st_mtime_ns, found.st_size)
    files = sorted(file for file in path.rglob("*") if file.is_file() and file.name != TIMESTAMP)
    return _digest_of_names({str(file.relative_to(path)): digest(file) for file in files})


@cache
def _digest_of_version(path: str, _modified_ns: int, _size: int) -> str:
    with open(path, "rb") as stream:  # noqa: PTH123 - faster, for thousands of small files
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _digest_of_names(digests: Mapping[str, str]) -> str:
    return hashlib.sha256(json.dumps(digests, sort_keys=True).encode()).hexdigest()


def _digest_of_code(code: Iterable[str]) -> str:
    # The code's own folder does not count: the workflow may be run from another one.
    names = sorted((Path(file).name, digest(file)) for file in code)
    return hashlib.sha256(json.dumps(names).encode()).hexdigest()


def _record(
    params: Mapping[str, Any],
    code: Iterable[str],
    inputs: Iterable[str],
    outputs: Iterable[str],
) -> dict[str, Any]:
    return {
        "params": params,
        "code": _digest_of_code(code),
        "inputs": {str(file): digest(file) for file in inputs},
        "outputs": {str(file): digest(file) for file in outputs},
    }
