"""Measure the run time of each effect in modes `auto` and `always`, and its influence on images."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.fixations.parameters import RenderingParameters
from visuohaptic.fixations.rendering import Views, cast_pixel_rays, colour_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.pads import Taxels
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import object_of, read_surface
from visuohaptic.scene.parameters import (
    PRESETS,
    TACTILE_EFFECTS,
    VISUAL_EFFECTS,
    EffectModes,
    Mode,
    Scene,
)
from visuohaptic.scene.records import EffectRecord
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.placing import Placed
from visuohaptic.sensor.sensing import Touches, sense
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FIXATIONS, by_object
from visuohaptic.tables.schema import build_rows, read_table, write_table
from visuohaptic.tables.studies import EFFECT_INFLUENCE
from visuohaptic.touches.choosing import Wanted, choose_locations
from visuohaptic.touches.touch_table import place_sensors_at, random_fields

ROUNDS = 3
"""Number of measurements of each time; the median is kept. The modes take turns."""

VIEWS = 2
"""Number of viewpoints per object that measure the effects of the view."""

Row = dict[str, Any]
"""A row of `tables.EFFECT_INFLUENCE`. For effects of the view, ``touches`` is the number of views."""


def measured_scenes(scene: Scene, layout: str | Taxels) -> dict[str, Scene]:
    """Return the scenes to measure by preset; the run's scene replaces its own preset.

    With another `sensor.layout` than the square, presets read each cell separately, because only a square has rows and
    columns.
    """
    readout = {} if layout == "square" else {"readout": "ideal"}
    presets = {name: Scene.model_validate({"preset": name, **readout}) for name in PRESETS}
    return {**presets, scene.preset: scene}


def touch_influence(
    caster: RayCaster,
    fixations: pa.Table,
    sensor: SensorParameters,
    scenes: Mapping[str, Scene],
    seed: int,
) -> list[Row]:
    """Measure the sensor's effects in each scene at the probing locations of an object.

    Parameters
    ----------
    caster : RayCaster
        The surface.
    fixations : pyarrow.Table
        Rows of `tables.FIXATIONS`, at least one.
    sensor : SensorParameters
        The sensor.
    scenes : mapping of str to Scene
        Scenes by name.
    seed : int
        The experiment's seed. The noise is the same with and without an effect.

    Returns
    -------
    list of Row
        One row per scene and effect.
    """
    fields = random_fields(fixations, seed)
    placed: dict[tuple[Mode, int], list[Placed]] = {}

    def touch(scene: Scene, turn: int) -> Touches:
        mode = scene.effects.adaptive_size
        if (mode, turn) not in placed:
            placed[mode, turn] = list(place_sensors_at(caster, fixations, sensor, mode))
        return sense(placed[mode, turn], sensor, scene, fields)

    return [
        influence
        for name, scene in scenes.items()
        for influence in _scene_influence(name, scene, touch)
    ]


def view_influence(
    caster: RayCaster,
    cameras: Sequence[Camera],
    rendering: RenderingParameters,
    modes: EffectModes,
) -> list[Row]:
    """Measure the effects of the view from c >= 1 cameras; the rays are cast once for all effects.

    Returns one row per effect.
    """
    hits = list(cast_pixel_rays(caster, cameras, rendering))

    def render(modes: EffectModes) -> Views:
        return colour_views(caster, cameras, hits, rendering, modes)

    always = Scene().with_effects("always").effects
    as_given, as_always = render(modes), render(always)
    seconds, seconds_always = _median_seconds(
        [as_given.effects, as_always.effects],
        lambda _: render(modes).effects,
        lambda _: render(always).effects,
    )
    rows = []
    for effect in VISUAL_EFFECTS:
        on, off, forced = (
            as_given
            if getattr(modes, effect) == mode
            else render(modes.model_copy(update={effect: mode}))
            for mode in ("auto", "never", "always")
        )
        (needed,) = (record.needed for record in on.effects if record.effect == effect)
        change = np.abs(on.colour - off.colour)[on.mask]
        rows.append(
            {
                "scene": "any",
                "effect": effect,
                "touches": len(cameras),
                "needed": needed,
                "seconds": seconds[effect],
                "seconds_always": seconds_always[effect],
                "image_shift": float(change.mean()) if change.size else 0.0,
                "equal_to_always": bool(np.array_equal(on.colour, forced.colour)),
            }
        )
    return rows


def sum_influences(parts: Sequence[Row]) -> pa.Table:
    """Combine the rows of several objects to `tables.EFFECT_INFLUENCE`.

    Seconds and touches are summed. ``image_shift`` is averaged over touches.
    """
    groups: dict[tuple[str, str], list[Row]] = {}
    for part in parts:
        groups.setdefault((part["scene"], part["effect"]), []).append(part)
    rows = []
    for group in groups.values():
        names = ("touches", "needed", "seconds", "seconds_always")
        sums = {name: sum(part[name] for part in group) for name in names}
        shift = sum(part["touches"] * part["image_shift"] for part in group) / sums["touches"]
        equal = [part["equal_to_always"] for part in group]
        all_equal = None if None in equal else all(equal)
        rows.append({**group[0], **sums, "image_shift": shift, "equal_to_always": all_equal})
    return build_rows(EFFECT_INFLUENCE, rows)


def make_effect_influence(step: StepInputs) -> None:
    """Write `tables.EFFECT_INFLUENCE` of a sample of objects in every preset."""
    run, parts = step.run, list[Row]()
    scenes, placed = measured_scenes(run.scene, run.sensor.layout), place_cameras(run.viewpoints)
    wanted = Wanted(run.attention.fixations, run.probing.unreachable, run.probing.when_exhausted)
    located = dict(by_object(read_table(FIXATIONS, step.inputs["fixations"])))
    for mesh in step.inputs["meshes"]:
        key = object_of(mesh)
        if key not in located:  # rejected mesh, or an object that no view shows
            continue
        caster = RayCaster(read_surface(mesh))
        table, _ = choose_locations(caster, located[key], run.sensor, wanted)
        if not table.num_rows:
            continue
        viewpoints = sorted(set(table.column("viewpoint").to_pylist()))
        cameras = [
            placed[number] for number in viewpoints[: min(VIEWS, run.rendering.views_at_once)]
        ]
        parts += view_influence(caster, cameras, run.rendering, run.scene.effects)
        parts += touch_influence(caster, table, run.sensor, scenes, run.seed)
    write_table(EFFECT_INFLUENCE, sum_influences(parts), step.outputs[0])


def _scene_influence(
    name: str, scene: Scene, touch: Callable[[Scene, int], Touches]
) -> Iterator[Row]:
    always = scene.with_effects("always")
    whole, forced = touch(scene, 0), touch(always, 0)
    modes = scene.effects.model_dump(include=set(TACTILE_EFFECTS))
    equal = None if "never" in modes.values() else np.array_equal(whole.images, forced.images)
    seconds, seconds_always = _median_seconds(
        [whole.effects, forced.effects],
        lambda turn: touch(scene, turn).effects,
        lambda turn: touch(always, turn).effects,
    )
    for record in whole.effects:
        shift = 0.0
        # An effect that no touch needs changes no image, so do not touch again.
        if record.runs and record.needed:
            others = scene.effects.model_copy(update={record.effect: "never"})
            without = touch(scene.model_copy(update={"effects": others}), 0)
            shift = float(np.abs(without.images - whole.images).mean())
        yield {
            "scene": name,
            "effect": record.effect,
            "touches": record.touches,
            "needed": record.needed,
            "seconds": seconds[record.effect],
            "seconds_always": seconds_always[record.effect],
            "image_shift": shift,
            "equal_to_always": equal,
        }


def _median_seconds(
    first: Sequence[Sequence[EffectRecord]], *runs: Callable[[int], Sequence[EffectRecord]]
) -> Iterator[dict[str, float]]:
    """Yield the median seconds of each effect for each run function; `first` are the records of the first round."""
    rounds = [list(first), *([run(turn) for run in runs] for turn in range(1, ROUNDS))]
    for ways in zip(*rounds, strict=True):
        yield {
            records[0].effect: float(np.median([record.seconds for record in records]))
            for records in zip(*ways, strict=True)
        }
