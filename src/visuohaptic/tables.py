"""The schema of every table: its columns, their types, units and ranges.

A table is one Parquet file, or a folder of them that reads as one. It is checked
before it is written, and written whole or not at all.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from visuohaptic.errors import TableError

_SEQUENCES = (np.ndarray, list, tuple, pa.ChunkedArray)


@dataclass(frozen=True)
class Column:
    """One column: what it holds and what it may hold.

    Attributes
    ----------
    name : str
        The column's name.
    dtype : pyarrow.DataType
        Its exact type.
    description : str
        What it means, in a few words.
    unit : str
        Unit or frame of reference; empty for plain counts and names.
    minimum, maximum : float or None
        Closed range of every value (of every element, for lists).
    nullable : bool
        Whether a value may be missing.
    """

    name: str
    dtype: pa.DataType
    description: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    nullable: bool = False


@dataclass(frozen=True)
class Schema:
    """A table's name, its columns in order, and the columns that identify a row."""

    name: str
    columns: tuple[Column, ...]
    keys: tuple[str, ...]

    @property
    def arrow(self) -> pa.Schema:
        """The same schema for pyarrow, descriptions and units as metadata."""
        return pa.schema(
            [
                pa.field(
                    column.name,
                    column.dtype,
                    column.nullable,
                    {"description": column.description, "unit": column.unit},
                )
                for column in self.columns
            ],
            {"table": self.name},
        )


TEXT = pa.string()
COUNT = pa.int32()
REAL = pa.float64()

OBJECT_KEYS = (
    Column("class", TEXT, "class of the object"),
    Column("object", TEXT, "name of the object within its class"),
)
VIEW_KEYS = (
    *OBJECT_KEYS,
    Column("viewpoint", COUNT, "number of the viewpoint, or of the random sequence", minimum=0),
)
TOUCH_KEYS = (
    *VIEW_KEYS,
    Column("strategy", TEXT, "how the probing locations were chosen"),
    Column("touch", COUNT, "place in the sequence of touches, 0 first", minimum=0),
)
POINT = tuple(
    Column(axis, REAL, f"probing location, {axis}", "object frame, unit sphere", -1.0001, 1.0001)
    for axis in "xyz"
)
NORMAL = tuple(
    Column(f"normal_{axis}", REAL, f"outward unit normal, {axis}", "object frame", -1.0001, 1.0001)
    for axis in "xyz"
)
TANGENT = tuple(
    Column(
        f"tangent_{axis}",
        REAL,
        f"the imprint's +column axis, {axis}",
        "object frame",
        -1.0001,
        1.0001,
    )
    for axis in "xyz"
)

SENSOR_SIZE = Column("sensor_size", REAL, "edge of the sensor's square", "object radii", 0)
CONTACT_STATE = Column("contact_state", TEXT, "full, shrunk, at_minimum, blocked or partial")


def _names(columns: Iterable[Column]) -> tuple[str, ...]:
    return tuple(column.name for column in columns)


VIEWS = Schema(
    "views",
    (
        *VIEW_KEYS,
        Column("eye_x", REAL, "camera centre, x", "object frame"),
        Column("eye_y", REAL, "camera centre, y", "object frame"),
        Column("eye_z", REAL, "camera centre, z", "object frame"),
        Column("view", pa.binary(), "the rendered view, PNG"),
        Column(
            "saliency", pa.binary(), "the saliency map, 8-bit grey PNG, the view's maximum white"
        ),
        Column(
            "conspicuity", pa.map_(TEXT, pa.binary()), "conspicuity map of each channel that ran"
        ),
        Column("skipped", pa.map_(TEXT, TEXT), "reason for each channel that did not run"),
        Column(
            "distinct_fixations", COUNT, "fixations found before the view was exhausted", minimum=0
        ),
    ),
    _names(VIEW_KEYS),
)

FIXATIONS = Schema(
    "fixations",
    (
        *TOUCH_KEYS,
        Column("pixel_row", COUNT, "row in the view, 0 at the top", "pixel", 0, nullable=True),
        Column(
            "pixel_column", COUNT, "column in the view, 0 at the left", "pixel", 0, nullable=True
        ),
        *POINT,
        *NORMAL,
        Column("face", COUNT, "triangle of the object's mesh", minimum=0),
        Column(
            "saliency",
            REAL,
            "saliency where the eye rests",
            "of the view's maximum",
            0,
            1,
            nullable=True,
        ),
    ),
    _names(TOUCH_KEYS),
)

TOUCHES = Schema(
    "touches",
    (
        *TOUCH_KEYS,
        Column(
            "image",
            pa.list_(pa.float32()),
            "tactile imprint, row by row",
            "1 contact, 0 out of reach",
            0,
            1,
        ),
        SENSOR_SIZE,
        CONTACT_STATE,
        Column("penetration", REAL, "deepest penetration left", "object radii", 0),
        *POINT,
        *NORMAL,
        *TANGENT,
    ),
    _names(TOUCH_KEYS),
)

EFFECT_KEYS = (
    *OBJECT_KEYS,
    Column("first_viewpoint", COUNT, "first viewpoint of the job", minimum=0),
    Column("effect", TEXT, "what may be simulated"),
)

EFFECTS = Schema(
    "effects",
    (
        *EFFECT_KEYS,
        Column(
            "scene", TEXT, "preset of the scene, or any: effects of the view, which no preset sets"
        ),
        Column("mode", TEXT, "auto, always or never"),
        Column("reason", TEXT, "why it was called for, or why not"),
        Column("touches", COUNT, "touches of the job; views, for effects of the view", minimum=0),
        Column("called_for", COUNT, "touches or views that called for it", minimum=0),
        Column("runs", COUNT, "touches or views that it was simulated for", minimum=0),
        Column("seconds", REAL, "time spent on it; differs from run to run", "s", 0),
    ),
    _names(EFFECT_KEYS),
)

EFFECT_INFLUENCE_KEYS = (
    Column("scene", TEXT, "preset of the scene, or any: effects of the view, which no preset sets"),
    Column("effect", TEXT, "what may be simulated"),
)

EFFECT_INFLUENCE = Schema(
    "effect_influence",
    (
        *EFFECT_INFLUENCE_KEYS,
        Column("touches", COUNT, "touches measured; views, for effects of the view", minimum=1),
        Column("seconds", REAL, "time spent on it under the scene's own mode", "s", 0),
        Column("seconds_always", REAL, "time spent on it under always", "s", 0),
        Column("image_shift", REAL, "mean change of a pixel of the image without it", "1", 0, 1),
    ),
    _names(EFFECT_INFLUENCE_KEYS),
)

EFFECT_ACCURACY_KEYS = (
    Column("scene", TEXT, "preset of the scene"),
    Column("without", TEXT, "the effect that is left out, or nothing"),
    Column("strategy", TEXT, "how the probing locations were chosen"),
)

EFFECT_ACCURACY = Schema(
    "effect_accuracy",
    (
        *EFFECT_ACCURACY_KEYS,
        Column("pipeline", TEXT, "how features become an answer"),
        Column("classifier", TEXT, "the classifier"),
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("high", REAL, "upper end of its interval over objects", "1", 0, 1),
    ),
    _names(EFFECT_ACCURACY_KEYS),
)

CURVE_KEYS = (
    Column("pipeline", TEXT, "how features become an answer"),
    Column("strategy", TEXT, "how the probing locations were chosen"),
    Column("classifier", TEXT, "the classifier"),
    Column("touches", COUNT, "touches of a sequence, the first ones", minimum=1),
)

CURVES = Schema(
    "curves",
    (
        *CURVE_KEYS,
        *OBJECT_KEYS,
        Column("accuracy", REAL, "share of the object's test sequences named rightly", "1", 0, 1),
        Column("weight", REAL, "the object's weight in a mean over splits", minimum=0),
    ),
    _names((*CURVE_KEYS, *OBJECT_KEYS)),
)

TOUCH_CURVES = Schema(
    "touch_curves",
    (
        *CURVE_KEYS,
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("high", REAL, "upper end of its interval over objects", "1", 0, 1),
    ),
    _names(CURVE_KEYS),
)

TOUCHES_NEEDED_KEYS = CURVE_KEYS[:3]

TOUCHES_NEEDED = Schema(
    "touches_needed",
    (
        *TOUCHES_NEEDED_KEYS,
        Column("level", REAL, "the accuracy to be reached", "1", 0, 1),
        Column(
            "touches",
            COUNT,
            "touches from which on accuracy stays at it; missing if never",
            minimum=1,
            nullable=True,
        ),
        Column(
            "touches_low",
            COUNT,
            "touches from which on its interval's upper end stays at it; missing if never",
            minimum=1,
            nullable=True,
        ),
        Column(
            "touches_high",
            COUNT,
            "touches from which on its interval's lower end stays at it; missing if never",
            minimum=1,
            nullable=True,
        ),
        Column("most_touches", COUNT, "touches at the curve's end", minimum=1),
        Column("area", REAL, "area under the curve", "of accuracy 1 throughout", 0, 1),
        Column("area_low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("area_high", REAL, "upper end of its interval over objects", "1", 0, 1),
        Column(
            "gain", REAL, "area under fixation's curve less this one", "1", -1, 1, nullable=True
        ),
        Column("gain_low", REAL, "lower end of its interval", "1", -1, 1, nullable=True),
        Column("gain_high", REAL, "upper end of its interval", "1", -1, 1, nullable=True),
        Column("p_value", REAL, "two-sided, sign changes over objects", "1", 0, 1, nullable=True),
        Column("objects", COUNT, "objects compared", minimum=1),
    ),
    _names(TOUCHES_NEEDED_KEYS),
)

ABLATION_KEYS = (
    Column("ablation", TEXT, "what is left out or exchanged"),
    Column("pipeline", TEXT, "how features become an answer"),
    Column("classifier", TEXT, "the classifier"),
)
ABLATION_SECONDS = (
    Column(
        "making_seconds",
        REAL,
        "looking, touching and describing what is made anew",
        "s of processor",
        0,
    ),
    Column("naming_seconds", REAL, "training and testing all splits", "s of processor", 0),
)

ABLATION = Schema(
    "ablation",
    (
        *ABLATION_KEYS,
        *OBJECT_KEYS,
        Column("accuracy", REAL, "share of the object's test sequences named rightly", "1", 0, 1),
        Column("weight", REAL, "the object's weight in a mean over splits", minimum=0),
        *ABLATION_SECONDS,
    ),
    _names((*ABLATION_KEYS, *OBJECT_KEYS)),
)

ABLATIONS = Schema(
    "ablations",
    (
        *ABLATION_KEYS,
        Column("group", TEXT, "what it is one of"),
        Column("remade", TEXT, "what is made anew: nothing, descriptors, touches or views"),
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("high", REAL, "upper end of its interval over objects", "1", 0, 1),
        Column("loss", REAL, "accuracy of the whole method less this one", "1", -1, 1),
        Column("loss_low", REAL, "lower end of its interval over objects", "1", -1, 1),
        Column("loss_high", REAL, "upper end of its interval over objects", "1", -1, 1),
        Column("p_value", REAL, "two-sided, sign changes over objects", "1", 0, 1),
        *ABLATION_SECONDS,
        Column("objects", COUNT, "objects compared", minimum=1),
    ),
    _names(ABLATION_KEYS),
)

CONTOURLET_FEATURES = tuple(f"contourlet_{band:02d}" for band in range(1, 17))
IMPRINT_FEATURES = {
    "imprint_mean": "mean of the imprint",
    "imprint_deviation": "its standard deviation",
    "imprint_skewness": "its skewness",
    "imprint_empty": "share of sensing points out of reach",
    "imprint_contact": "share of sensing points in contact",
    "imprint_bending": "sum of the best quadric's second derivatives",
    "imprint_saddle": "their difference, whatever the direction",
    "imprint_upright_bending": "their difference between columns and rows",
    "imprint_tilt_columns": "size of the slope along the columns",
    "imprint_tilt_rows": "size of the slope along the rows",
    "imprint_roughness": "standard deviation that the best quadric leaves",
    "imprint_step_columns": "mean step between neighbours along the columns",
    "imprint_step_rows": "mean step between neighbours along the rows",
}
KINESTHETIC_FEATURES = ("x", "y", "z", "normal_x", "normal_y", "normal_z")

FEATURES = Schema(
    "features",
    (
        *TOUCH_KEYS,
        *(
            Column(name, REAL, "standard deviation of one directional sub-band", minimum=0)
            for name in CONTOURLET_FEATURES
        ),
        *POINT,
        *NORMAL,
        SENSOR_SIZE,
        CONTACT_STATE,
        *(Column(name, REAL, description) for name, description in IMPRINT_FEATURES.items()),
    ),
    _names(TOUCH_KEYS),
)

SCORE_KEYS = (
    Column("pipeline", TEXT, "how features become an answer"),
    Column("strategy", TEXT, "how the probing locations were chosen"),
    Column("classifier", TEXT, "the classifier"),
    Column("split", COUNT, "number of the train and test split", minimum=0),
    Column("seed", COUNT, "repeat of everything that is random in training", minimum=0),
)

SCORES = Schema(
    "scores",
    (
        *SCORE_KEYS,
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("object_accuracy", REAL, "share of test objects named rightly by vote", "1", 0, 1),
        Column("sequences", COUNT, "test sequences", minimum=1),
        Column(
            "note",
            TEXT,
            "what the classifier needed, such as a regularised covariance",
            nullable=True,
        ),
    ),
    _names(SCORE_KEYS),
)

PREDICTION_KEYS = (*SCORE_KEYS, *VIEW_KEYS)

PREDICTIONS = Schema(
    "predictions",
    (
        *PREDICTION_KEYS,
        Column("predicted", TEXT, "the class that the classifier named"),
        Column(
            "probability",
            REAL,
            "what the classifier gives that class",
            "1",
            0,
            1.0001,
            nullable=True,
        ),
        Column("voted", TEXT, "the class that all sequences of the object name", nullable=True),
    ),
    _names(PREDICTION_KEYS),
)

COST_KEYS = (
    Column("family", TEXT, "what varies"),
    Column("setting", TEXT, "to which value"),
)
COST_SECONDS_COLUMNS = (
    ("seconds", "what a recognition takes, median"),
    ("seconds_low", "its lower quartile"),
    ("seconds_high", "its upper quartile"),
    ("seconds_look", "of it: making views, looking at them"),
    ("seconds_touch", "of it: touching"),
    ("seconds_describe", "of it: features"),
    ("seconds_name", "of it: classification"),
)

COST_SECONDS = Schema(
    "cost_seconds",
    (
        *COST_KEYS,
        *(Column(name, REAL, text, "s", 0) for name, text in COST_SECONDS_COLUMNS),
        Column("recognitions", COUNT, "recognitions that were timed", minimum=1),
    ),
    _names(COST_KEYS),
)

COST_ERRORS = Schema(
    "cost_errors",
    (
        *COST_KEYS,
        Column("place", COUNT, "place along the family's line", minimum=0),
        Column("touches", COUNT, "touches from each viewpoint", minimum=1),
        Column("viewpoints", COUNT, "viewpoints that vote", minimum=1),
        Column("pipeline", TEXT, "how features become an answer"),
        Column("classifier", TEXT, "the classifier"),
        Column("changes", TEXT, "other parameters that differ from the run's, JSON"),
        Column("error", REAL, "share of recognitions that name wrongly", "1", 0, 1, nullable=True),
        Column(
            "error_low",
            REAL,
            "lower end of its interval over objects",
            "1",
            0,
            1,
            nullable=True,
        ),
        Column(
            "error_high",
            REAL,
            "upper end of its interval over objects; of no error, the exact binomial one",
            "1",
            0,
            1,
            nullable=True,
        ),
        Column("objects", COUNT, "objects that were tested", minimum=1, nullable=True),
        Column("failed", TEXT, "why it could not be run", nullable=True),
    ),
    _names(COST_KEYS),
)

COST = Schema(
    "cost",
    (
        *COST_ERRORS.columns,
        *(Column(name, REAL, text, "s", 0, nullable=True) for name, text in COST_SECONDS_COLUMNS),
        Column("recognitions", COUNT, "recognitions that were timed", minimum=1, nullable=True),
        Column("on_front", pa.bool_(), "whether no other setting is quicker and as accurate"),
        Column("dominated", pa.bool_(), "whether another one is at least as good in both"),
    ),
    _names(COST_KEYS),
)

SCHEMAS = {
    schema.name: schema
    for schema in (
        VIEWS,
        FIXATIONS,
        TOUCHES,
        EFFECTS,
        EFFECT_INFLUENCE,
        EFFECT_ACCURACY,
        CURVES,
        TOUCH_CURVES,
        TOUCHES_NEEDED,
        ABLATION,
        ABLATIONS,
        FEATURES,
        SCORES,
        PREDICTIONS,
        COST_ERRORS,
        COST_SECONDS,
        COST,
    )
}


def build_table(schema: Schema, columns: Mapping[str, object]) -> pa.Table:
    """Make a table of a schema from arrays, one a column.

    Parameters
    ----------
    schema : Schema
        The table's schema.
    columns : mapping of str to array_like
        Every column by its name, all of one length; a scalar string or number
        is repeated. Two-dimensional arrays become lists.

    Returns
    -------
    pyarrow.Table
        The checked table.

    Raises
    ------
    TableError
        If the columns break the schema.
    """
    expected = {column.name for column in schema.columns}
    if expected != set(columns):
        missing, extra = sorted(expected - set(columns)), sorted(set(columns) - expected)
        raise TableError(
            f"table {schema.name}: columns missing {missing}, not in the schema {extra}."
        )
    lengths = {len(value) for value in columns.values() if isinstance(value, _SEQUENCES)}
    if len(lengths) > 1:
        raise TableError(
            f"table {schema.name}: columns have lengths {sorted(lengths)}; one is allowed."
        )
    length = lengths.pop() if lengths else 1
    arrays = [
        _arrow_array(schema, column, columns[column.name], length) for column in schema.columns
    ]
    table = pa.Table.from_arrays(arrays, schema=schema.arrow)
    check_table(schema, table)
    return table


def check_table(schema: Schema, table: pa.Table) -> None:
    """Refuse a table that breaks its schema.

    Parameters
    ----------
    schema : Schema
        What the table must be.
    table : pyarrow.Table
        The table.

    Raises
    ------
    TableError
        If columns, types, missing values, ranges or keys are not as declared;
        NaN and infinite numbers count as out of range.
    """
    if not table.schema.equals(schema.arrow):
        raise TableError(
            f"table {schema.name}: columns are {_signature(table.schema)}; "
            f"{_signature(schema.arrow)} is what the schema names."
        )
    for column in schema.columns:
        _check_column(schema, column, table.column(column.name))
    unique = table.select(list(schema.keys)).group_by(list(schema.keys)).aggregate([])
    if unique.num_rows != table.num_rows:
        repeated = table.num_rows - unique.num_rows
        raise TableError(
            f"table {schema.name}: {repeated} rows repeat the key ({', '.join(schema.keys)})."
        )


def write_table(schema: Schema, table: pa.Table, path: str | Path) -> None:
    """Check a table and write it as Parquet, whole or not at all.

    Parameters
    ----------
    schema : Schema
        What the table must be.
    table : pyarrow.Table
        The table.
    path : path
        The file; its folder is made where missing. It is replaced in one step,
        so a reader never meets half a table.

    Raises
    ------
    TableError
        If the table breaks its schema; nothing is written then.
    """
    check_table(schema, table)
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-")
    os.close(handle)
    try:
        pq.write_table(table, temporary, compression="zstd")
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def read_table(schema: Schema, paths: str | Path | Sequence[str | Path]) -> pa.Table:
    """Read a table from one file, a folder, or several files, sorted by its keys.

    Parameters
    ----------
    schema : Schema
        What the table must be.
    paths : path or sequence of path
        Where it lies. The order of the files changes nothing.

    Returns
    -------
    pyarrow.Table
        The checked table.

    Raises
    ------
    TableError
        If there is no such file, or the table breaks its schema.
    """
    files = _parquet_files([paths] if isinstance(paths, str | Path) else paths)
    if not files:
        raise TableError(
            f"table {schema.name}: no Parquet file at {paths}; run the workflow first."
        )
    parts = [_read_part(schema, file) for file in files]
    table = pa.concat_tables(parts).sort_by([(key, "ascending") for key in schema.keys])
    check_table(schema, table)
    return table.combine_chunks()


def prune_parts(folder: str | Path, expected: Iterable[str | Path]) -> list[Path]:
    """Delete Parquet files that no longer belong to a table, and folders that this empties.

    Files are left over when an object goes away, or viewpoints are split into
    jobs in another way; a reader of the folder would meet their rows twice.

    Parameters
    ----------
    folder : path
        A table's folder; nothing outside it is touched.
    expected : iterable of path
        The files that make up the table.

    Returns
    -------
    list of pathlib.Path
        What was deleted.
    """
    keep = {Path(path) for path in expected}
    stale = [file for file in sorted(Path(folder).rglob("*.parquet")) if file not in keep]
    for file in stale:
        file.unlink()
    for parent in sorted({file.parent for file in stale}, reverse=True):
        if parent != Path(folder) and not any(parent.iterdir()):
            parent.rmdir()
    return stale


def matrix(table: pa.Table, names: Sequence[str]) -> np.ndarray:
    """Give numeric columns side by side.

    Parameters
    ----------
    table : pyarrow.Table
        A table of n rows.
    names : sequence of str
        The columns, k of them.

    Returns
    -------
    numpy.ndarray
        Shape (n, k), float64.
    """
    return np.column_stack([table.column(name).to_numpy().astype(np.float64) for name in names])


def images(table: pa.Table, name: str = "image") -> np.ndarray:
    """Give a column of square images as one array.

    Parameters
    ----------
    table : pyarrow.Table
        A table of m rows.
    name : str
        A column of lists of n² numbers each.

    Returns
    -------
    numpy.ndarray
        Shape (m, n, n), in the column's own float type.

    Raises
    ------
    TableError
        If the lists differ in length, or their length is no square.
    """
    column = table.column(name).combine_chunks()
    lengths = np.unique(pc.list_value_length(column).to_numpy(zero_copy_only=False))
    side = round(float(lengths[0]) ** 0.5) if len(lengths) == 1 else 0
    if len(lengths) != 1 or side * side != lengths[0]:
        raise TableError(
            f"column {name}: images have {lengths.tolist()} points; one square number is allowed."
        )
    return np.asarray(column.flatten()).reshape(-1, side, side)


def _arrow_array(schema: Schema, column: Column, value: object, length: int) -> pa.Array:
    if not isinstance(value, _SEQUENCES):
        value = [value] * length
    if isinstance(value, np.ndarray) and value.ndim > 1:
        value = list(value.reshape(len(value), -1))
    try:
        return pa.array(value, type=column.dtype)
    except (pa.ArrowInvalid, pa.ArrowTypeError, pa.ArrowNotImplementedError) as error:
        raise TableError(
            f"table {schema.name}: column {column.name} does not fit {column.dtype}: {error}."
        ) from error


def _check_column(schema: Schema, column: Column, values: pa.ChunkedArray) -> None:
    if values.null_count and not column.nullable:
        raise TableError(
            f"table {schema.name}: column {column.name} has {values.null_count} missing values; none is allowed."
        )
    if pa.types.is_list(column.dtype):
        values = pc.list_flatten(values)
    if not pa.types.is_floating(values.type) and not pa.types.is_integer(values.type):
        return
    if pa.types.is_floating(values.type) and pc.any(pc.invert(pc.is_finite(values))).as_py():
        raise TableError(f"table {schema.name}: column {column.name} has NaN or infinite values.")
    extremes = pc.min_max(values).as_py()
    if extremes["min"] is None:
        return
    below = column.minimum is not None and extremes["min"] < column.minimum
    above = column.maximum is not None and extremes["max"] > column.maximum
    if below or above:
        raise TableError(
            f"table {schema.name}: column {column.name} spans {extremes['min']} to {extremes['max']}; "
            f"{_bound(column.minimum)} to {_bound(column.maximum)} is allowed."
        )


def _bound(value: float | None) -> str:
    return "anything" if value is None else f"{value:g}"


def _signature(schema: pa.Schema) -> str:
    return ", ".join(f"{field.name} {field.type}" for field in schema)


def _parquet_files(paths: Sequence[str | Path]) -> list[Path]:
    files: list[Path] = []
    for path in map(Path, paths):
        files.extend(sorted(path.rglob("[!._]*.parquet")) if path.is_dir() else [path])
    return files


def _read_part(schema: Schema, file: Path) -> pa.Table:
    try:
        part = pq.ParquetFile(file).read()
    except (OSError, pa.ArrowInvalid) as error:
        raise TableError(
            f"{file} can't be read as Parquet ({error}); delete it and run again."
        ) from error
    if part.schema.names != schema.arrow.names:
        raise TableError(
            f"{file} has the columns {_signature(part.schema)}; table {schema.name} has {_signature(schema.arrow)}."
        )
    return part.cast(schema.arrow)
