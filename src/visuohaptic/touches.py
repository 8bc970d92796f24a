"""The hand's part: the sensor is set down at every probing location of an object."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.raycasting import RayCaster
from visuohaptic.scene import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.touching import touch
from visuohaptic.surface import read_surface
from visuohaptic.tables import FIXATIONS, TOUCHES, build_table, matrix, read_table, write_table

_POINT = ("x", "y", "z")
_NORMAL = ("normal_x", "normal_y", "normal_z")
_TANGENT = ("tangent_x", "tangent_y", "tangent_z")


def make_touches(
    mesh: str | Path,
    fixations: str | Path,
    output: str | Path,
    sensor: SensorParameters,
    scene: Scene,
) -> None:
    """Make the touch table of an object's probing locations.

    Parameters
    ----------
    mesh : path
        The object's surface.
    fixations : path
        Its probing locations.
    output : path
        The Parquet file to write.
    sensor : SensorParameters
        Section `sensor`.
    scene : Scene
        Section `scene`.
    """
    table = read_table(FIXATIONS, fixations)
    touches = touch(
        RayCaster(read_surface(mesh)), matrix(table, _POINT), matrix(table, _NORMAL), sensor, scene
    )
    columns: dict[str, object] = {name: table.column(name) for name in (*TOUCHES.keys, *_POINT)}
    columns |= dict(zip(_NORMAL, touches.normals.T, strict=True))
    columns |= dict(zip(_TANGENT, touches.tangents.T, strict=True))
    columns |= {
        "image": touches.images,
        "sensor_size": touches.size,
        "contact_state": touches.contact_state.tolist(),
        "penetration": touches.penetration,
    }
    write_table(TOUCHES, build_table(TOUCHES, columns), output)
