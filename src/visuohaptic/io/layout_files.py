"""Layouts of taxels as text tables."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError, TableError
from visuohaptic.geometry.layouts import MOST_TAXELS, Layout
from visuohaptic.io.text_tables import read_table_file

COLUMNS = ("x", "y", "z", "direction_x", "direction_y", "direction_z")
"""Columns of a file of taxels; other columns are ignored."""

LARGEST_BYTES = 32 * 10**6
"""Limit of a file of taxels (bytes): the largest layout with all digits is smaller."""


def read_layout(path: str | Path, unit: str | None = None) -> Layout:
    """Read the taxels of a pad from a text table.

    Parameters
    ----------
    path : path
        A text table, as spreadsheets write it (`io.text_tables`), with one row per taxel and the columns x, y, z,
        direction_x, direction_y and direction_z in the pad's frame, as `Layout.of` takes them. Other columns are ignored.
    unit : {"mm", "cm", "m", "in"}, optional
        Unit of x, y and z.

    Returns
    -------
    Layout
        The layout, with the name of the file.

    Raises
    ------
    ParameterError
        If the file can't be read, a column is missing, a cell is no number, or the taxels are not allowed.

    Examples
    --------
    >>> import visuohaptic as vh
    >>> vh.read_layout("examples/layouts/icub_fingertip.csv", unit="mm")
    <Layout icub_fingertip.csv: 12 taxels, 13.6 mm wide>
    """
    rows = read_taxels(path)
    return Layout.of(rows[:, :3], rows[:, 3:], unit, Path(path).name)


def read_taxels(path: str | Path) -> FloatArray:
    """Read position and direction of each taxel, shape (t, 6), from a text table; errors as for `read_layout`."""
    table = read_table_file(path, MOST_TAXELS, LARGEST_BYTES, "taxels")
    missing = [name for name in COLUMNS if table.names.count(name) != 1]
    if missing:
        raise ParameterError(
            f"{path} has {table.names.count(missing[0])} columns {missing[0]}; {', '.join(COLUMNS)} are needed, each "
            "once, in a header."
        )
    try:
        return table.numbers([table.names.index(name) for name in COLUMNS])
    except TableError as error:
        raise ParameterError(str(error)) from error
