"""Long sequences of touches by every strategy, for curves over the number of touches."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.features.describing import describe_touches
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.fixations.locations import candidate_table, locate, look
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.fixations.probing import STRATEGIES, face_outwards, spread_far
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.seeds import spawn_generator
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.studies.curves.settings import LONGEST_SEQUENCE
from visuohaptic.tables.phases import FEATURES, FIXATIONS
from visuohaptic.tables.schema import check_table, write_table
from visuohaptic.touches.touching import touch_locations, touch_table

CANDIDATES = 256
"""Places of an object among which `adaptive` chooses where a viewpoint sees them."""


def make_curve_features(
    key: str,
    mesh: str | Path,
    output: str | Path,
    viewpoints: ViewpointParameters,
    rendering: RenderingParameters,
    attention: AttentionParameters,
    sensor: SensorParameters,
    scene: Scene,
    features: FeatureParameters,
    seed: int,
) -> None:
    """Touch one object by every strategy, and at every candidate of `adaptive`.

    Parameters
    ----------
    key : str
        `class/name` of the object.
    mesh : path
        Its surface.
    output : path
        The Parquet file to write, rows of `tables.FEATURES`. Those of strategy ``adaptive`` are
        no sequences but each viewpoint's candidates.
    viewpoints, rendering, attention, sensor, scene, features
        Sections of the parameters; the number of fixations is not used.
    seed : int
        The experiment's seed.
    """
    caster = RayCaster(read_surface(mesh))
    longer = attention.model_copy(update={"fixations": LONGEST_SEQUENCE})
    cameras = dict(enumerate(place_cameras(viewpoints)))
    looks = look(caster, key, cameras, rendering, longer, scene.effects)
    crowd = spread_far(caster.surface, CANDIDATES, spawn_generator(seed, "candidates", key))
    crowd = face_outwards(caster, crowd)
    tables = [
        begin_anew(locate(one, strategy, longer, seed), LONGEST_SEQUENCE)
        for one in looks
        for strategy in STRATEGIES.names
    ]
    tables += [candidate_table(one, crowd) for one in looks]
    located = pa.concat_tables(tables).combine_chunks()
    check_table(FIXATIONS, located)
    felt = touch_locations(caster, located, sensor, scene, seed)
    write_table(FEATURES, describe_touches(touch_table(located, felt), features), output)


def begin_anew(sequence: pa.Table, touches: int) -> pa.Table:
    """Make a sequence as long as asked for by starting again at its first location.

    The eye runs out of places on slender objects: once all of a view lies within the foci,
    inhibition is released and it begins anew.

    Parameters
    ----------
    sequence : pyarrow.Table
        Rows of `tables.FIXATIONS` of one sequence, in order.
    touches : int
        How many rows to give.

    Returns
    -------
    pyarrow.Table
        So many rows; none where there was none.
    """
    if not sequence.num_rows:
        return sequence
    numbers = pa.array(range(touches), pa.int32())
    again = sequence.take([number % sequence.num_rows for number in range(touches)])
    place = again.schema.get_field_index("touch")
    return again.set_column(place, again.schema.field("touch"), pc.cast(numbers, pa.int32()))
