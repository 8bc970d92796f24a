"""Poses of sensors as CSV files: x, y, z and a quaternion, or a normal."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike
from pyarrow.csv import ConvertOptions, ReadOptions, open_csv

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError
from visuohaptic.sensor.imprints import Poses, stand_on
from visuohaptic.tables.schema import matrix

PLACE = ("x", "y", "z")
QUATERNION = ("qw", "qx", "qy", "qz")
NORMAL = ("normal_x", "normal_y", "normal_z")
ROLL = "roll"
MOST_POSES = 1_000_000


def write_poses(poses: FloatArray, path: str | Path) -> None:
    """Write poses, shape (n, 4, 4), with the shortest digits that read back as the same numbers."""
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_matrix(poses[:, :3, :3]).as_quat(canonical=True, scalar_first=True)
    rows = np.concatenate([poses[:, :3, 3], turned], axis=1)
    with Path(path).open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([*PLACE, *QUATERNION])
        writer.writerows(rows.tolist())


def read_poses(path: str | Path) -> FloatArray:
    """Read poses.

    Parameters
    ----------
    path : path
        A CSV file with the columns x, y, z and qw, qx, qy, qz, a quaternion of any length but 0; or
        normal_x, normal_y, normal_z, away from the object, and, if it likes, roll in degrees.

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
    from scipy.spatial.transform import Rotation

    table = _read_numbers(path)
    names = table.column_names
    axes = QUATERNION if set(QUATERNION) <= set(names) else NORMAL
    missing = [name for name in (*PLACE, *axes, *names) if names.count(name) != 1]
    if missing:
        raise ParameterError(
            f"{path} has no column {missing[0]}, or more than one; {', '.join(PLACE)} and "
            f"{', '.join(QUATERNION)} or {', '.join(NORMAL)} are needed."
        )
    rows = matrix(table, names)
    places, directions = matrix(table, PLACE), matrix(table, axes)
    lengths = np.linalg.norm(directions, axis=1, keepdims=True)
    lost = np.flatnonzero(~(lengths[:, 0] > 0) | ~np.isfinite(rows).all(axis=1))
    if len(lost):
        raise ParameterError(
            f"{path}: pose {lost[0]} has a number that is not finite, or {', '.join(axes)} of length 0."
        )
    if axes is NORMAL:
        roll = table.column(ROLL).to_numpy() if ROLL in names else 0.0
        return matrices(turned(stand_on(places, directions / lengths), roll))
    poses = np.tile(np.eye(4), (len(places), 1, 1))
    poses[:, :3, :3] = Rotation.from_quat(directions, scalar_first=True).as_matrix()
    poses[:, :3, 3] = places
    return poses


def turned(stands: Poses, roll: ArrayLike) -> Poses:
    """Turn sensors about their normals, by degrees; `ParameterError` if these are not finite or too many."""
    angles = np.radians(np.asarray(roll, dtype=np.float64))
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
    """Give poses (n, 4, 4): x along the columns, y against the rows, z along the normal."""
    poses = np.tile(np.eye(4), (len(stands), 1, 1))
    axes = (stands.columns, -stands.rows, stands.normals, stands.points)
    poses[:, :3] = np.stack(axes, axis=2)
    return poses


def _read_numbers(path: str | Path) -> pa.Table:
    try:
        with Path(path).open(newline="", encoding="utf-8-sig") as stream:
            # Arrow passes over empty lines, too.
            names = next(filter(None, csv.reader(stream)), [])
    except (UnicodeDecodeError, csv.Error) as error:
        raise ParameterError(f"{path} holds no numbers by columns: {error}.") from error
    numbers = ConvertOptions(column_types=dict.fromkeys(names, pa.float64()))
    try:
        # One thread alone knows the lines.
        with open_csv(path, ReadOptions(use_threads=False), convert_options=numbers) as reader:
            parts: list[pa.RecordBatch] = []
            for part in reader:
                parts.append(part)
                if sum(map(len, parts)) > MOST_POSES:
                    raise ParameterError(
                        f"{path} holds more than {MOST_POSES:,} poses, which is the most."
                    )
            table = pa.Table.from_batches(parts, reader.schema)
    except pa.ArrowInvalid as error:
        raise ParameterError(f"{path} holds no numbers by columns: {error}.") from error
    return table.rename_columns([name.strip() for name in names])
