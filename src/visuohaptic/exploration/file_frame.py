"""The frame of the file that an object came from: points, poses and tables, there and back."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import MeshError
from visuohaptic.exploration.units import UNITS
from visuohaptic.geometry.vectors import product
from visuohaptic.tables.schema import matrix

_POINTS = ("", "eye_")
_LENGTHS = ("sensor_size", "penetration")


@dataclass(frozen=True, eq=False)
class FileFrame:
    """Where the object frame is in the file that an object came from.

    Attributes
    ----------
    from_file : numpy.ndarray
        Shape (4, 4), float64: takes a point (x, y, z, 1) of the file into the object frame, whose origin is
        the object's centroid, whose y axis points up, and whose unit is the object's radius.
    unit : str or None
        The file's unit of length, one of `UNITS`, where it was given.
    """

    from_file: FloatArray
    unit: str | None = None

    def __post_init__(self) -> None:
        if self.unit is not None and self.unit not in UNITS:
            raise MeshError(f"unit is {self.unit!r}; {', '.join(UNITS)} are allowed.")

    @property
    def has_way_back(self) -> bool:
        """Whether float64 holds the scale of the file's coordinates."""
        return bool(np.isfinite(self.from_file).all())

    @property
    def up_axis(self) -> str:
        """The file's axis that is nearest to up, such as ``z``."""
        return "xyz"[int(np.abs(self.from_file[1, :3]).argmax())]

    @cached_property
    def to_file(self) -> FloatArray:
        """The way back, shape (4, 4), float64; `MeshError` where the file's numbers are too small or large for one."""
        if not self.has_way_back:
            raise MeshError(
                "The file's coordinates are so small or large that float64 can't hold its scale; scale the file."
            )
        return np.asarray(np.linalg.inv(self.from_file), dtype=np.float64)

    @cached_property
    def radius(self) -> float:
        """Length of an object radius in the file; the geometric mean where the model was stretched."""
        return float(abs(np.linalg.det(self.to_file[:3, :3])) ** (1 / 3))

    @property
    def radius_m(self) -> float | None:
        """The same in metres; None where the unit is not known."""
        return None if self.unit is None else self.radius * UNITS[self.unit]

    def points_in_file(self, points: ArrayLike) -> FloatArray:
        """Take points of the object frame, shape (n, 3), to the file's."""
        return product(np.asarray(points, np.float64), self.to_file[:3, :3].T) + self.to_file[:3, 3]

    def points_in_object(self, points: ArrayLike) -> FloatArray:
        """Take points of the file's frame, shape (n, 3), to the object's."""
        turned = product(np.asarray(points, np.float64), self.from_file[:3, :3].T)
        return turned + self.from_file[:3, 3]

    def normals_in_file(self, normals: ArrayLike) -> FloatArray:
        """Take unit normals of the object frame, shape (n, 3), to the file's."""
        # A plane's normal goes the way of its equation, which differs from that of points where a model was stretched.
        return _unit(product(np.asarray(normals, np.float64), self.from_file[:3, :3]))

    def poses(self, touches: pa.Table) -> FloatArray:
        """Give the poses of touches in the file's frame.

        Parameters
        ----------
        touches : pyarrow.Table
            Rows of `tables.TOUCHES`.

        Returns
        -------
        numpy.ndarray
            Shape (n, 4, 4), float64: origin at the touched place, z along the outward normal, x along
            the imprint's columns, and y against its rows, so upwards in the imprint; right-handed.
        """
        poses = np.tile(np.eye(4), (touches.num_rows, 1, 1))
        outward = self.normals_in_file(_rows(touches, "normal_"))
        along = _unit(product(_rows(touches, "tangent_"), self.to_file[:3, :3].T))
        along = _unit(along - np.einsum("nd,nd->n", along, outward)[:, None] * outward)
        poses[:, :3, 0], poses[:, :3, 1], poses[:, :3, 2] = along, np.cross(outward, along), outward
        poses[:, :3, 3] = self.points_in_file(_rows(touches, ""))
        return poses

    def table(self, table: pa.Table) -> pa.Table:
        """Give a table of an exploration in the file's frame and unit, the other columns as they are.

        Points, normals, tangents and lengths change; the table's metadata names the frame and the unit.
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
            place = table.column_names.index(name)
            table = table.set_column(place, pa.field(name, pa.float64()), pa.array(values))
        return table.replace_schema_metadata({"frame": "file", "unit": json.dumps(self.unit)})


def _named(prefix: str, rows: FloatArray) -> dict[str, FloatArray]:
    return {f"{prefix}{axis}": rows[:, place] for place, axis in enumerate("xyz")}


def _rows(table: pa.Table, prefix: str) -> FloatArray:
    return matrix(table, [f"{prefix}{axis}" for axis in "xyz"])


def _unit(rows: FloatArray) -> FloatArray:
    found: FloatArray = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    return found
