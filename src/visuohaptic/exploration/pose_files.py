"""Poses of sensors as CSV files: x, y, z and a quaternion, or a normal."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_file
from visuohaptic.base.errors import ParameterError, TableError
from visuohaptic.exploration.checking import FARTHEST, lengths_of, numbers
from visuohaptic.io.text_tables import TextTable, read_table_file
from visuohaptic.sensor.imprints import Poses, make_poses

POSITION = ("x", "y", "z")
QUATERNION = ("qw", "qx", "qy", "qz")
NORMAL = ("normal_x", "normal_y", "normal_z")
ROLL = "roll"
MOST_POSES = 1_000_000
LARGEST_BYTES = 256 * 10**6
"""Limit of a file of poses (bytes): a million poses with all digits are smaller."""


def write_poses(poses: FloatArray, path: str | Path) -> None:
    """Write poses (n, 4, 4) as positions and quaternions, with enough digits to read back the same numbers."""
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_matrix(poses[:, :3, :3]).as_quat(canonical=True, scalar_first=True)
    rows = np.concatenate([poses[:, :3, 3], turned], axis=1)
    with (
        atomic_file(path) as unfinished,
        unfinished.open("w", newline="", encoding="utf-8") as stream,
    ):
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([*POSITION, *QUATERNION])
        writer.writerows(rows.tolist())


def read_poses(path: str | Path) -> FloatArray:
    """Read poses of sensors from a text table.

    Parameters
    ----------
    path : path
        A text table, as spreadsheets write it (`io.text_tables`), with the columns x, y, z. The
        direction is a quaternion, columns qw, qx, qy, qz, or a normal away from the object, columns normal_x,
        normal_y, normal_z. Neither may have length 0. Column roll (degrees) may stand beside a normal. Other
        columns are ignored.

    Returns
    -------
    numpy.ndarray
        Shape (n, 4, 4), float64, as `press` takes them.

    Raises
    ------
    ParameterError
        If a column is missing, a row holds no numbers or no direction, or there are more than a
        million poses.
    """
    table = _read_table(path)
    is_quaternion = set(QUATERNION) <= set(table.names)
    axes = QUATERNION if is_quaternion else NORMAL
    positions, directions = _numbers(table, POSITION), _numbers(table, axes)
    lengths = lengths_of(directions)
    zero = np.flatnonzero(lengths == 0)
    if len(zero):
        raise ParameterError(
            f"{table.position(int(zero[0]))}: {', '.join(axes)} are all 0; a direction is needed."
        )
    directions /= lengths
    if not is_quaternion:
        roll = _numbers(table, (ROLL,))[:, 0] if ROLL in table.names else 0.0
        return matrices(turned(make_poses(positions, directions), roll))
    from scipy.spatial.transform import Rotation

    poses = np.tile(np.eye(4), (len(positions), 1, 1))
    poses[:, :3, :3] = Rotation.from_quat(directions, scalar_first=True).as_matrix()
    poses[:, :3, 3] = positions
    return poses


def turned(stands: Poses, roll: ArrayLike) -> Poses:
    """Turn n sensors about their normals by `roll` (degrees, scalar or (n,)). Raise `ParameterError` otherwise."""
    angles = np.radians(numbers(roll, "roll"))
    if angles.shape not in ((), (len(stands),)) or not np.isfinite(angles).all():
        raise ParameterError(
            f"roll has the shape {angles.shape}; a finite number, or one for each of {len(stands)} poses, is needed."
        )
    if not angles.any():
        return stands
    cosine, sine = (np.reshape(part, (-1, 1)) for part in (np.cos(angles), np.sin(angles)))
    columns = cosine * stands.columns - sine * stands.rows
    rows = sine * stands.columns + cosine * stands.rows
    return replace(stands, columns=columns, rows=rows)


def matrices(stands: Poses) -> FloatArray:
    """Return poses as matrices (n, 4, 4): x along the columns, y against the rows, z along the normal."""
    poses = np.tile(np.eye(4), (len(stands), 1, 1))
    axes = (stands.columns, -stands.rows, stands.normals, stands.points)
    poses[:, :3] = np.stack(axes, axis=2)
    return poses


def _read_table(path: str | Path) -> TextTable:
    table = read_table_file(path, MOST_POSES, LARGEST_BYTES, "poses")
    if not table.names:
        raise ParameterError(
            f"{table.position(0)} holds numbers; a header is needed in the first line: {', '.join(POSITION)} and "
            f"{', '.join(QUATERNION)} or {', '.join(NORMAL)}."
        )
    return table


def _numbers(table: TextTable, names: Sequence[str]) -> FloatArray:
    """Return named columns, shape (n, k), of numbers below `FARTHEST`."""
    for name in names:
        if table.names.count(name) != 1:
            raise ParameterError(
                f"{table.source} has {table.names.count(name)} columns {name}; {', '.join(POSITION)} and "
                f"{', '.join(QUATERNION)} or {', '.join(NORMAL)} are needed, each once."
            )
    chosen = [table.names.index(name) for name in names]
    try:
        values = table.numbers(chosen)
    except TableError as error:
        raise ParameterError(str(error)) from error
    large = np.argwhere(np.abs(values) >= FARTHEST)
    if len(large):
        row, column = large[0].tolist()
        raise ParameterError(
            f"{table.position(row, chosen[column])} is {values[row, column]:g}; numbers below {FARTHEST:g} are allowed."
        )
    return values
