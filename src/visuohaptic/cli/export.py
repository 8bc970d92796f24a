"""`visuohaptic export`: the touches and features of a finished run as a data set for Hugging Face `datasets`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
import yaml

from visuohaptic.base.atomic_files import atomic_file, atomic_write_text
from visuohaptic.base.errors import ExportError
from visuohaptic.cli.printing import JsonOption, folder_to_write, say, say_json
from visuohaptic.meshes.catalogue import Credit, read_credits

if TYPE_CHECKING:
    import pyarrow as pa

ROWS = 1024
"""Touches in memory at a time and per row group: 4 MB for imprints of 32 × 32."""

CREDITS = ("meshes/catalogue.csv", "meshes/paper/credits.csv")

_KNOWN = ("cc0-1.0", "cc-by-3.0", "cc-by-4.0", "unknown")  # licence names of the Hub

_CARD = """
# Touches of 3D objects

{touches} simulated tactile imprints of {objects} objects in {classes} classes, made by visuohaptic: objects were looked at
and touched where the eye would fixate, after G. Rouhafzay and A.-M. Cretu, *A Visuo-Haptic Framework for Object
Recognition Inspired from Human Tactile Perception*, Proceedings 4(1):47, 2018.

```python
from datasets import load_dataset

touches = load_dataset("FOLDER", "touches", split="train").with_format("numpy")
features = load_dataset("FOLDER", "features", split="train").to_pandas()
```

One row per touch in both; `class`, `object`, `viewpoint`, `strategy` and `touch` identify the row. `imprint` is 1
at the nearest point of the imprint and 0 at the farthest. With `sensor.normalisation: absolute`, 1 is contact and 0 is
out of the depth range. Lengths are in object radii. Hold out whole objects: touches of one object are alike.

## Credits

An imprint derives from its object's model. The models are by:

| object | author | licence | address |
|---|---|---|---|
"""


def export(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", parser=folder_to_write, help="New or empty folder.")
    ],
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Write the finished run in the working folder as a data set for Hugging Face `datasets`.

    Writes touches.parquet with the imprints, features.parquet, and README.md with licences and authors.

    Example: visuohaptic export touches
    """
    from visuohaptic.tables.phases import FEATURES, keys_of
    from visuohaptic.tables.schema import read_table, write_table

    files = sorted(Path("results/touches").rglob("*.parquet"))
    if not files:
        raise ExportError("results/touches holds no touches; run `snakemake -j2` here first.")
    existing = sorted(folder.iterdir()) if folder.is_dir() else []
    if existing:
        raise ExportError(f"{existing[0]} is there already; name a new or an empty folder.")
    features = read_table(FEATURES, "results/features")
    objects = sorted(keys_of(features).unique().to_pylist())
    with atomic_file(folder / "touches.parquet") as unfinished:
        touches = _write_touches(files, unfinished)
        if touches != features.num_rows:
            rows = f"{touches} touches and {features.num_rows} rows of features"
            raise ExportError(f"The run has {rows}; run `snakemake -j2` first.")
        if _read_keys(files).columns != features.select(list(FEATURES.keys)).columns:
            raise ExportError(
                "results/touches and results/features hold other touches; run `snakemake -j2` first."
            )
    write_table(FEATURES, features, folder / "features.parquet")
    atomic_write_text(folder / "README.md", _card(objects, read_credits(CREDITS), touches))
    size = sum(file.stat().st_size for file in folder.iterdir())
    if as_json:
        say_json({"folder": folder, "touches": touches, "objects": len(objects), "bytes": size})
    else:
        say(f"{folder}: {touches} touches of {len(objects)} objects, {size / 1e6:.1f} MB")


def _read_keys(files: Sequence[Path]) -> pa.Table:
    """Read the keys of touches, sorted as `read_table` sorts them."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from visuohaptic.tables.phases import TOUCHES

    names = list(TOUCHES.keys)
    parts = [pq.ParquetFile(file).read(columns=names) for file in files]
    rows = pa.concat_tables(parts).replace_schema_metadata()
    return rows.select(names).sort_by([(name, "ascending") for name in names])


def _write_touches(files: Sequence[Path], path: Path) -> int:
    """Write touches with imprints (rows, columns) as nested lists, taxels in one row; return the number of touches."""
    import numpy as np
    import pyarrow as pa
    import pyarrow.parquet as pq

    from visuohaptic.tables.phases import TOUCHES
    from visuohaptic.tables.schema import check_table, images_or_readings

    index = TOUCHES.arrow.get_field_index("image")
    imprint = pa.field("imprint", pa.list_(pa.list_(pa.float32())), nullable=False)
    schema = TOUCHES.arrow.set(index, imprint.with_metadata(TOUCHES.arrow.field(index).metadata))
    rows_written, size = 0, (0, 0)
    with pq.ParquetWriter(path, schema, compression="zstd") as writer:
        for file in files:
            for batch in pq.ParquetFile(file).iter_batches(ROWS):
                table = pa.Table.from_batches([batch])
                check_table(TOUCHES, table)
                imprints = images_or_readings(table)
                found = imprints.shape[1:] if imprints.ndim == 3 else (1, imprints.shape[1])
                size = size if any(size) else found
                if found != size:
                    sizes = f"{found[0]} x {found[1]}; other files have {size[0]} x {size[1]}"
                    raise ExportError(f"{file} has imprints of {sizes}; run `snakemake -j2` first.")
                ends = np.arange(len(imprints) * size[0] + 1, dtype=np.int32)
                lines = pa.ListArray.from_arrays(ends * size[1], imprints.ravel())
                nested = pa.ListArray.from_arrays(ends[: len(imprints) + 1] * size[0], lines)
                writer.write_table(table.set_column(index, imprint, nested).cast(schema))
                rows_written += len(imprints)
    return rows_written


def _card(objects: Sequence[str], credited: Mapping[str, Credit], touches: int) -> str:
    """Return README.md: the header that `datasets` and the Hub read, and the authors of the models."""
    rows = [(key, credited.get(key)) for key in objects]
    names = {
        credit.licence.lower().removesuffix("-us") if credit else "unknown" for _, credit in rows
    }
    header = {
        "pretty_name": "Touches of 3D objects",
        "license": sorted({name if name in _KNOWN else "other" for name in names}),
        "configs": [
            {"config_name": "touches", "data_files": "touches.parquet"},
            {"config_name": "features", "data_files": "features.parquet"},
        ],
    }
    classes = len({key.partition("/")[0] for key in objects})
    text = _CARD.format(touches=touches, objects=len(objects), classes=classes)
    for key, credit in rows:
        cells = (credit.author, credit.licence, credit.source_url) if credit else ("not known",) * 3
        text += f"| {' | '.join(map(_escaped, (key, *cells)))} |\n"
    return f"---\n{yaml.safe_dump(header, sort_keys=False)}---\n{text}"


def _escaped(text: str) -> str:
    """Escape Markdown markup in a name, and join its lines."""
    return re.sub(r"([\\`*\[\]<>|~$]|\b_|_\b)", r"\\\1", " ".join(text.split()))
