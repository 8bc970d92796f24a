"""Write a data set into a folder of its own."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from visuohaptic.errors import ExportError
from visuohaptic.export.card import CONFIGURATIONS, MARK, write_card
from visuohaptic.export.columns import arrow_schema, data_rows, sample_png
from visuohaptic.export.contents import Contents, find_contents
from visuohaptic.export.croissant import describe_files
from visuohaptic.export.experiment import Experiment, read_experiment
from visuohaptic.meshes.catalogue import read_credits
from visuohaptic.parameters import read_parameters
from visuohaptic.tables.phases import FEATURES, TOUCHES, keys_of
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.whole_files import whole_file, write_whole

CARD, CREDITS, CROISSANT = "README.md", "credits.csv", "croissant.json"
EXPERIMENT, SAMPLE = "experiment.json", "sample.png"
PARQUET = tuple(file for one in CONFIGURATIONS.values() for file in one.files.values())
FILES = (CARD, CREDITS, CROISSANT, EXPERIMENT, SAMPLE, *PARQUET)
"""All files of an export."""

_OF_TOUCHES = {
    file: CONFIGURATIONS[name].columns
    for name in ("default", "lite")
    for file in CONFIGURATIONS[name].files.values()
}


def export_run(run: str | Path, folder: str | Path, commit: str) -> Contents:
    """Export the touches of a finished run, in its folder as the workflow lays it out."""
    run = Path(run)
    parameters = read_parameters(run / "params.yaml")
    touches = sorted((run / "results/touches").rglob("*.parquet"))
    if not touches:
        raise ExportError(
            f"{run / 'results/touches'} holds no touches; name the folder of a finished run, or run "
            "`snakemake -j2` there first."
        )
    credit_files = [run / "meshes/catalogue.csv", run / "meshes/paper/credits.csv"]
    experiment = read_experiment(
        [run / "results/features"],
        [run / "results/predictions"],
        run / "reports/metrics.json",
        parameters.model_dump(mode="json"),
        commit,
    )
    return make_export(touches, credit_files, folder, parameters.seed, experiment)


def make_export(
    touches: Sequence[str | Path],
    credit_files: Sequence[str | Path],
    folder: str | Path,
    seed: int,
    experiment: Experiment,
) -> Contents:
    """Write touches as a data set that `datasets.load_dataset(folder)` reads as it is.

    The order of their files changes nothing. The folder is new, empty, or an earlier export, which is
    replaced; a missing file of credits is passed over. Raises `ExportError` if the folder holds
    anything else, or the touches can't be divided.
    """
    files, folder = sorted(map(Path, touches)), Path(folder)
    contents = find_contents(files, read_credits(credit_files), seed)
    _take_over(folder)
    # First of all, so that a folder whose export was interrupted is known as one.
    write_whole(folder / CARD, write_card(contents, experiment))
    write_whole(folder / CREDITS, _credits_of(contents))
    write_whole(folder / EXPERIMENT, experiment.as_json())
    _write_rows(files, contents, folder)
    write_table(FEATURES, experiment.features, folder / CONFIGURATIONS["features"].files["run"])
    with whole_file(folder / SAMPLE) as unfinished:
        unfinished.write_bytes(
            sample_png(pq.read_table(folder / CONFIGURATIONS["lite"].files["train"]))
        )
    write_whole(folder / CROISSANT, describe_files(contents, folder))
    return contents


def _take_over(folder: Path) -> None:
    """Make the folder, or remove the earlier export in it; anything else is refused."""
    if folder.exists() and not folder.is_dir():
        raise ExportError(f"{folder} is a file; name a folder.")
    has_files, folders = False, {str(Path(name).parent) for name in PARQUET}
    for entry in folder.rglob("*"):
        name = entry.relative_to(folder).as_posix()
        allowed = entry.is_file() if name in FILES else entry.is_dir() and name in folders
        if entry.is_symlink() or not allowed:
            raise ExportError(
                f"{folder} holds {name}, which is no part of an export; name a new or an empty folder."
            )
        has_files |= entry.is_file()
    card = folder / CARD
    is_marked = card.is_file() and MARK in card.read_text(encoding="utf-8", errors="replace")
    if has_files and not is_marked:
        raise ExportError(
            f"{folder} is not empty and holds no export; name a new or an empty folder."
        )
    for name in FILES:
        (folder / name).unlink(missing_ok=True)


def _write_rows(files: Sequence[Path], contents: Contents, folder: Path) -> None:
    """Write the rows of all files, one after the other, into every configuration and split."""
    with ExitStack() as stack:
        writers = {}
        for name, columns in _OF_TOUCHES.items():
            unfinished = stack.enter_context(whole_file(folder / name))
            writer = pq.ParquetWriter(unfinished, arrow_schema(columns), compression="zstd")
            writers[name] = stack.enter_context(writer)
        before = 0
        for file in files:
            touches = read_table(TOUCHES, file)
            if not touches.num_rows:  # of an object that was set aside
                continue
            numbers = before + _view_numbers(touches)
            before = numbers[-1] + 1
            rows = data_rows(touches, contents.classes, contents.credits)
            kept = {"data": numbers >= 0, "lite": numbers % contents.every == 0}
            tested = pc.is_in(keys_of(touches), pa.array(sorted(contents.tested))).to_numpy()
            for name, writer in writers.items():
                chosen = kept[Path(name).parent.name] & (tested == (Path(name).stem == "test"))
                if chosen.any():  # `datasets` can't read a file whose first row group is empty
                    writer.write_table(rows.filter(chosen).select(writer.schema.names))


def _view_numbers(table: pa.Table) -> np.ndarray:
    """Give rows, sorted by views, the number of their view, from 0: its strategies stay together."""
    begins = np.zeros(table.num_rows, dtype=bool)
    for name in ("class", "object", "viewpoint"):
        values = table.column(name).to_numpy()
        begins[1:] |= values[1:] != values[:-1]
    return np.cumsum(begins)


def _credits_of(contents: Contents) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["class", "object", "split", "author", "licence", "source_url"])
    for key in contents.touches:
        credit = contents.credits[key]
        owner = (*key.split("/", 1), contents.split_of(key))
        writer.writerow((*owner, credit.author, credit.licence, credit.source_url))
    return stream.getvalue()
