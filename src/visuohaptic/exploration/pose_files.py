"""Poses of sensors as CSV files: x, y, z and a quaternion, or a normal."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from visuohaptic.errors import ParameterError
from visuohaptic.sensor.imprints import Poses, stand_on

PLACE = ("x", "y", "z")
QUATERNION = ("qw", "qx", "qy", "qz")
NORMAL = ("normal_x", "normal_y", "normal_z")
ROLL = "roll"

_MOST = 1_000_000
"""Poses of one file."""


def write_poses(poses: NDArray[np.float64], path: str | Path) -> None:
    """Write poses, shape (n, 4, 4), with the shortest digits that read back as the same numbers."""
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_matrix(poses[:, :3, :3]).as_quat(canonical=True, scalar_first=True)
    rows = np.concatenate([poses[:, :3, 3], turned], axis=1)
    with Path(path).open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([*PLACE, *QUATERNION])
        writer.writerows(rows.tolist())


def read_poses(path: str | Path) -> NDArray[np.float64]:
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
        If a column is missing, or a row holds no numbers or no direction.
    """
    from scipy.spatial.transform import Rotation

    names, rows = _read_numbers(Path(path))
    columns = {name: rows[:, place] for place, name in enumerate(names)}
    places = _taken(columns, PLACE, path)
    if set(QUATERNION) <= set(columns):
        quaternions = _taken(columns, QUATERNION, path)
        _check_lengths(quaternions, "quaternion", path)
        poses = np.tile(np.eye(4), (len(rows), 1, 1))
        poses[:, :3, :3] = Rotation.from_quat(quaternions, scalar_first=True).as_matrix()
        poses[:, :3, 3] = places
        return poses
    normals = _taken(columns, NORMAL, path)
    _check_lengths(normals, "normal", path)
    stands = stand_on(places, normals / np.linalg.norm(normals, axis=1, keepdims=True))
    return matrices(turned(stands, columns.get(ROLL, 0.0)))


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


def matrices(stands: Poses) -> NDArray[np.float64]:
    """Give poses (n, 4, 4): x along the columns, y against the rows, z along the normal."""
    poses = np.tile(np.eye(4), (len(stands), 1, 1))
    axes = (stands.columns, -stands.rows, stands.normals, stands.points)
    poses[:, :3] = np.stack(axes, axis=2)
    return poses


def _read_numbers(path: Path) -> tuple[list[str], NDArray[np.float64]]:
    with path.open(newline="", encoding="utf-8") as stream:
        reader = csv.reader(stream)
        names = [name.strip() for name in next(reader, [])]
        rows: list[list[float]] = []
        for line in reader:
            if not line:
                continue
            try:
                rows.append([float(text) for text in line])
            except ValueError:
                raise ParameterError(
                    f"{path}, line {reader.line_num}: {','.join(line)[:80]} are no numbers."
                ) from None
            if len(line) != len(names) or not np.isfinite(rows[-1]).all():
                raise ParameterError(
                    f"{path}, line {reader.line_num} has {len(line)} numbers for {len(names)} columns, or one that "
                    "is not finite."
                )
            if len(rows) > _MOST:
                raise ParameterError(f"{path} has more than {_MOST} poses.")
    return names, np.reshape(rows, (len(rows), len(names)))


def _taken(
    columns: dict[str, NDArray[np.float64]], names: tuple[str, ...], path: str | Path
) -> NDArray[np.float64]:
    missing = [name for name in names if name not in columns]
    if missing:
        raise ParameterError(
            f"{path} has no column {missing[0]}; {', '.join(PLACE)} and {', '.join(QUATERNION)} or "
            f"{', '.join(NORMAL)} are needed."
        )
    return np.column_stack([columns[name] for name in names])


def _check_lengths(rows: NDArray[np.float64], what: str, path: str | Path) -> None:
    lost = np.flatnonzero(~(np.linalg.norm(rows, axis=1) > 0))
    if len(lost):
        raise ParameterError(f"{path}: the {what} of pose {lost[0]} has the length 0.")
