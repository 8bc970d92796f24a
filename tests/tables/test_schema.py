"""Tables are checked before they are written, and written whole or not at all."""

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from visuohaptic.base.errors import TableError
from visuohaptic.tables import schema
from visuohaptic.tables.phases import FIXATIONS
from visuohaptic.tables.schema import (
    MOST_VALUES,
    build_table,
    images,
    known_columns,
    names_of,
    read_table,
    take_table,
    write_table,
)
from visuohaptic.tables.schemas import SCHEMAS


def fixation_columns(count=5, viewpoint=0):
    places = np.linspace(-0.5, 0.5, count)
    return {
        "class": "cup",
        "object": "mug",
        "viewpoint": viewpoint,
        "strategy": "fixation",
        "touch": np.arange(count),
        **dict.fromkeys(("pixel_row", "pixel_column", "face"), np.arange(count)),
        "saliency": np.linspace(1, 0.5, count),
        "unreachable": [None] * count,
        "random_stream": "fixation",
        **dict.fromkeys(("x", "y", "z", "normal_x", "normal_y", "normal_z"), places),
    }


def test_a_folder_of_parts_reads_as_one_table_sorted_by_its_keys(tmp_path):
    parts = [build_table(FIXATIONS, fixation_columns(viewpoint=number)) for number in (2, 0, 1)]
    paths = [tmp_path / "cup" / f"{place}.parquet" for place in range(3)]
    for part, path in zip(parts, paths, strict=True):
        write_table(FIXATIONS, part, path)
    whole = pa.concat_tables([parts[1], parts[2], parts[0]])
    for files in (tmp_path, paths, paths[::-1]):
        assert read_table(FIXATIONS, files).equals(whole)
        chosen = whole.select([*FIXATIONS.keys, "x", "saliency"])
        assert read_table(FIXATIONS, files, ["saliency", "x"]).equals(chosen)
    assert read_table(FIXATIONS, tmp_path, []).column_names == [*FIXATIONS.keys]
    frame = pd.read_parquet(tmp_path)
    assert len(frame) == 15
    assert tuple(frame.columns[:5]) == FIXATIONS.keys


@pytest.mark.parametrize(
    ("column", "value", "sentence"),
    [
        ("x", np.full(5, np.nan), "column x has NaN or infinite values"),
        ("x", np.full(5, 2.0), "column x spans 2.0 to 2.0; -1.0001 to 1.0001 is allowed"),
        ("saliency", np.full(5, -0.1), "column saliency spans -0.1"),
        ("touch", np.arange(-1, 4), "column touch spans -1 to 3; 0 to any number is allowed"),
        ("touch", np.zeros(5, dtype=int), "4 rows repeat the key"),
        ("touch", np.full(5, 0.5), "column touch does not fit int32"),
        ("face", [None] * 5, "column face has 5 missing values"),
        ("y", np.zeros(4), "columns have lengths \\[4, 5\\]"),
    ],
)
def test_a_table_that_breaks_its_schema_is_refused_in_a_sentence(column, value, sentence):
    with pytest.raises(TableError, match=sentence):
        build_table(FIXATIONS, fixation_columns() | {column: value})


def test_missing_and_unknown_columns_are_named():
    columns = fixation_columns()
    columns["colour"] = columns.pop("x")
    with pytest.raises(TableError, match=r"missing \['x'\], not in the schema \['colour'\]"):
        build_table(FIXATIONS, columns)


def test_pixels_and_saliency_may_be_missing_where_no_eye_looked():
    blind = {"pixel_row": [None] * 5, "pixel_column": [None] * 5, "saliency": [None] * 5}
    table = build_table(FIXATIONS, fixation_columns() | blind)
    assert table.column("pixel_row").null_count == 5


def test_a_refused_table_leaves_the_old_file_as_it_was(tmp_path):
    path = tmp_path / "mug.parquet"
    good = build_table(FIXATIONS, fixation_columns())
    write_table(FIXATIONS, good, path)
    before = path.read_bytes()
    with pytest.raises(TableError, match="repeat the key"):
        write_table(FIXATIONS, pa.concat_tables([good, good]), path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["mug.parquet"]


def test_half_a_file_and_no_file_are_named(tmp_path):
    with pytest.raises(TableError, match="no Parquet file"):
        read_table(FIXATIONS, tmp_path)
    path = tmp_path / "mug.parquet"
    write_table(FIXATIONS, build_table(FIXATIONS, fixation_columns()), path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(TableError, match=r"mug\.parquet can't be read as Parquet"):
        read_table(FIXATIONS, path)


@pytest.mark.parametrize("kind", ["rows", "values of lists"])
def test_a_short_file_that_claims_very_many_values_is_refused_before_they_take_memory(
    tmp_path, kind
):
    path = tmp_path / "mug.parquet"
    nothing = pa.array(np.zeros(4_000_000, np.int8))
    if kind == "rows":
        columns = dict.fromkeys(names_of(FIXATIONS.columns), nothing)
    else:
        columns = {"class": pa.ListArray.from_arrays([0, len(nothing)], nothing)}
    rows = pa.table(columns)
    groups = MOST_VALUES // (len(nothing) * len(columns)) + 1
    with pq.ParquetWriter(path, rows.schema) as writer:
        for _ in range(groups):
            writer.write_table(rows, row_group_size=rows.num_rows)
    assert path.stat().st_size < 10**6
    counts = (
        rf"has {groups * rows.num_rows} rows with {groups * len(nothing) * len(columns)} values"
    )
    with pytest.raises(TableError, match=rf"mug\.parquet {counts}; 100000000 values are allowed"):
        read_table(FIXATIONS, path)


def test_a_short_file_of_long_repeated_texts_is_refused_before_they_take_memory(
    tmp_path, monkeypatch
):
    table = build_table(FIXATIONS, fixation_columns())
    rows = table.num_rows
    path = tmp_path / "mug.parquet"
    monkeypatch.setattr(schema, "MOST_TEXT_BYTES", 10**6)
    write_table(FIXATIONS, table, path)
    assert read_table(FIXATIONS, path).num_rows == rows
    long = pa.DictionaryArray.from_arrays(np.zeros(rows, np.int32), ["x" * (10**6 // rows + 1)])
    pq.write_table(table.set_column(1, "object", long.cast(pa.string())), path)
    with pytest.raises(TableError, match=r"mug\.parquet has texts of 1 MB; 1 MB are allowed"):
        read_table(FIXATIONS, path)


def test_images_come_back_square_and_mixed_sizes_are_refused():
    stack = np.linspace(0, 1, 2 * 16, dtype=np.float32).reshape(2, 4, 4)
    table = pa.table({"image": pa.array(list(stack.reshape(2, -1)), pa.list_(pa.float32()))})
    np.testing.assert_array_equal(images(table), stack)
    mixed = pa.table({"image": pa.array([[0.0] * 4, [0.0] * 9], pa.list_(pa.float32()))})
    with pytest.raises(TableError, match=r"images have \[4, 9\] points"):
        images(mixed)


def test_every_schema_describes_each_column():
    assert all(column.description for schema in SCHEMAS.values() for column in schema.columns)


def test_known_columns_are_taken_in_the_order_and_the_types_of_the_schema():
    table = build_table(FIXATIONS, fixation_columns())
    frame = table.to_pandas().assign(mine=1).astype({"class": "category", "touch": "float32"})
    other = frame[["mine", "x", "touch", "class"]]
    found = known_columns(FIXATIONS, other)
    assert found.column_names == ["class", "touch", "x"]
    assert found.equals(table.select(found.column_names))
    with pytest.raises(TableError, match="no column object"):
        take_table(FIXATIONS, other)
