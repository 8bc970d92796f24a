"""Conversion of points, poses and tables between the object frame and the frame of the object's file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.base.units import UNITS
from visuohaptic.exploration.checking import numbers
from visuohaptic.geometry.vectors import product
from visuohaptic.meshes.up_axis import named_axis
from visuohaptic.tables.schema import matrix

_POINTS = ("", "eye_")
_LENGTHS = ("sensor_size", "penetration")


@dataclass(frozen=True, eq=False)
class FileFrame:
    """Transformation between the frame of a file and the object frame.

    Attributes
    ----------
    from_file : numpy.ndarray
        Shape (4, 4), float64: transforms a point (x, y, z, 1) from the file's frame to the object frame. The
        object frame has its origin at the object's centroid, its y axis upwards, its z axis to the front, and the object's
        radius as unit.
    unit : str or None
        The file's unit of length, one of `UNITS`. None if the unit is not known.
    """

    from_file: FloatArray
    unit: str | None = None

    def __post_init__(self) -> None:
        if self.unit is not None and self.unit not in UNITS:
            raise MeshError(f"unit is {self.unit!r}; {', '.join(UNITS)} are allowed.")

    @property
    def has_way_back(self) -> bool:
        """Whether float64 can hold the scale of the file's coordinates, so that `to_file` exists."""
        return bool(np.isfinite(self.from_file).all())

    @property
    def up_axis(self) -> str:
        """The file's axis that is nearest to up, such as ``z`` or ``-y``."""
        return named_axis(self.from_file[1, :3])

    @property
    def front_axis(self) -> str:
        """The file's axis that is nearest to the front, such as ``x`` or ``-z``."""
        return named_axis(self.from_file[2, :3])

    @cached_property
    def to_file(self) -> FloatArray:
        """The inverse of `from_file`, (4, 4), float64. Raises `MeshError` if float64 can't hold the file's scale."""
        if not self.has_way_back:
            raise MeshError(
                "The file's coordinates are so small or large that float64 can't hold its scale; scale the file."
            )
        return np.asarray(np.linalg.inv(self.from_file), dtype=np.float64)

    @cached_property
    def radius(self) -> float:
        """Length of an object radius in the file's unit. For a stretched model: the geometric mean of three lengths."""
        return float(abs(np.linalg.det(self.to_file[:3, :3])) ** (1 / 3))

    @property
    def radius_m(self) -> float | None:
        """Length of an object radius (metres). None if the unit is not known."""
        return None if self.unit is None else self.radius * UNITS[self.unit]

    def points_in_file(self, points: ArrayLike) -> FloatArray:
        """Transform points (n, 3) from the object frame to the file's frame."""
        return product(numbers(points, "points"), self.to_file[:3, :3].T) + self.to_file[:3, 3]

    def points_in_object(self, points: ArrayLike) -> FloatArray:
        """Transform points (n, 3) from the file's frame to the object frame."""
        turned = product(numbers(points, "points"), self.from_file[:3, :3].T)
        return turned + self.from_file[:3, 3]

    def normals_in_file(self, normals: ArrayLike) -> FloatArray:
        """Transform unit normals (n, 3) from the object frame to the file's frame."""
        # Normals transform by the inverse transpose, which differs from the matrix of points for a stretched model.
        return _unit(product(numbers(normals, "normals"), self.from_file[:3, :3]))

    def poses(self, touches: pa.Table) -> FloatArray:
        """Compute the poses of touches in the file's frame.

        Parameters
        ----------
        touches : pyarrow.Table
            Rows of `tables.TOUCHES`.

        Returns
        -------
        numpy.ndarray
            Shape (n, 4, 4), float64, right-handed: origin at the touched point, z along the outward normal,
            x along the imprint's columns, y against its rows (upwards in the imprint).
        """
        poses = np.tile(np.eye(4), (touches.num_rows, 1, 1))
        outward = self.normals_in_file(_rows(touches, "normal_"))
        along = _unit(product(_rows(touches, "tangent_"), self.to_file[:3, :3].T))
        along = _unit(along - np.einsum("nd,nd->n", along, outward)[:, None] * outward)
        poses[:, :3, 0], poses[:, :3, 1], poses[:, :3, 2] = along, np.cross(outward, along), outward
        poses[:, :3, 3] = self.points_in_file(_rows(touches, ""))
        return poses

    def table(self, table: pa.Table) -> pa.Table:
        """Return a table of an exploration in the file's frame and unit.

        Points, normals, tangents and lengths are transformed; other columns stay. The table's metadata names
        the frame and the unit.
        """
        changed: dict[str, FloatArray] = {}
        for prefix in _POINTS:
            if f"{prefix}x" in table.column_names:
                changed |= _named(prefix, self.points_in_file(_rows(table, prefix)))
        if "normal_x" in table.column_names:
            changed |= _named("normal_", self.normals_in_file(_rows(table, "normal_")))
        if "tangent_x" in table.column_names:
            changed |= _named("tangent_", self.poses(table)[:, :3, 0])
        for name in set(_LENGTHS) & set(table.column_names):
            changed[name] = table.column(name).to_numpy() * self.radius
        for name, values in changed.items():
            index = table.column_names.index(name)
            table = table.set_column(index, pa.field(name, pa.float64()), pa.array(values))
        return table.replace_schema_metadata({"frame": "file", "unit": json.dumps(self.unit)})


def _named(prefix: str, rows: FloatArray) -> dict[str, FloatArray]:
    return {f"{prefix}{axis}": rows[:, index] for index, axis in enumerate("xyz")}


def _rows(table: pa.Table, prefix: str) -> FloatArray:
    return matrix(table, [f"{prefix}{axis}" for axis in "xyz"])


def _unit(rows: FloatArray) -> FloatArray:
    units: FloatArray = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    return units
