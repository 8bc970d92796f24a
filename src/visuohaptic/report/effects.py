"""Effects and channels that were simulated or computed, what they cost and change, and what was left out and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.estimates import Row
from visuohaptic.report.pictures import imprint_strip, webp_address
from visuohaptic.report.run import Run
from visuohaptic.report.wording import counted, listed, percent
from visuohaptic.scene.parameters import PRESETS, VISUAL_EFFECTS, EffectModes
from visuohaptic.sensor.example_shapes import touch_gallery
from visuohaptic.studies.effects.influence import measured_scenes
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import EFFECT_INFLUENCE
from visuohaptic.touches.touching import touch_locations

_SAME = {True: "bit for bit", False: "no", None: "effects are off"}


def influence_figures(path: Path, scene: str) -> Row:
    """Read `tables.EFFECT_INFLUENCE`: rows of ``view``, of ``touch`` in one scene, and of all ``scenes``.

    Milliseconds are of one view, or of a thousand touches; shifts, how far images move, are shares by scene.
    """
    rows = read_table(EFFECT_INFLUENCE, path).to_pylist()
    view = [_effect(row, rows, 1) for row in _ordered(rows, "any", VISUAL_EFFECTS)]
    touch = [_effect(row, rows, 1000) for row in _ordered(rows, scene, EffectModes.model_fields)]
    scenes = [_ordered(rows, name, EffectModes.model_fields) for name in PRESETS]
    return {
        "view": view,
        "touch": touch,
        "scenes": [_scene(found) for found in scenes if found],
        "views": max((row["units"] for row in view), default=0),
        "touches": max((row["units"] for row in touch), default=0),
    }


def effects_answer(scenes: Sequence[Row]) -> str:
    """Say how many effects each scene needs, and what leaving out the others saves and changes."""
    if not scenes:
        return ""
    count = max(len(scene["needed"]) + len(scene["unneeded"]) for scene in scenes)
    needed = []
    for scene in scenes:
        # Milliseconds of a thousand touches are microseconds of one touch.
        whole = scene["milliseconds_always"]
        saved = whole - scene["milliseconds"] if scene["unneeded"] else 0
        saves = f" (saves {saved:.0f} of {whole:.0f} µs per touch)" if saved > 0 else ""
        needed.append(f"{len(scene['needed'])} in scene {scene['name']}{saves}")
    changed = listed([scene["name"] for scene in scenes if scene["equal"] is False])
    said = f"Of {counted(count, 'effect')} of touch only those are simulated that a scene needs: {', '.join(needed)}."
    if changed:
        return f"{said} In {changed} images change without the others."
    same = " Images are the same, bit for bit, as with all effects."
    return said + same if all(one["equal"] for one in scenes) else said


def rows_of_scenes(study: Row) -> list[tuple[Row, list[Row]]]:
    """Give each table of study `effects`, with its rows of scenes as a whole; none without such rows."""
    found = [
        (table, [row for row in table["cells"] if row["condition"] in PRESETS])
        for table in study["tables"]
    ]
    return [one for one in found if any(row["accuracy"] is not None for row in one[1])]


def scene_strips(
    mesh: str | Path, locations: pa.Table, parameters: ExperimentParameters
) -> dict[str, str]:
    """Touch an object's places, rows of `tables.FIXATIONS`, in every scene: a picture's address by scene."""
    caster = RayCaster(read_surface(mesh))
    return {
        name: webp_address(
            imprint_strip(
                touch_locations(caster, locations, parameters.sensor, scene, parameters.seed).images
            )
        )
        for name, scene in measured_scenes(parameters.scene).items()
    }


def hard_places(parameters: ExperimentParameters) -> list[Row]:
    """Touch the hard places with the run's sensor: ``name``, ``size``, ``state``, ``imprint``'s address."""
    return [
        {
            "name": probe.name,
            "size": float(felt.size[0]),
            "state": str(felt.contact_state[0]),
            "imprint": webp_address(imprint_strip(felt.images[:1])),
        }
        for probe, felt in touch_gallery(parameters.sensor, parameters.scene, parameters.seed)
    ]


def _ordered(
    rows: Sequence[Row], scene: str, effects: Mapping[str, object] | Sequence[str]
) -> list[Row]:
    found = {row["effect"]: row for row in rows if row["scene"] == scene}
    return [found[name] for name in effects if name in found]


def _effect(own: Row, rows: Sequence[Row], unit: int) -> Row:
    scale = 1000.0 * unit / own["touches"]
    moved = [row for row in rows if row["effect"] == own["effect"] and row["image_shift"] > 0]
    return {
        "name": own["effect"],
        "milliseconds": scale * own["seconds"],
        "milliseconds_always": scale * own["seconds_always"],
        "shifts": {row["scene"]: row["image_shift"] for row in moved},
        "units": own["touches"],
    }


def _scene(rows: Sequence[Row]) -> Row:
    scale = 1e6 / max(row["touches"] for row in rows)
    return {
        "name": rows[0]["scene"],
        "needed": [row["effect"] for row in rows if row["needed"]],
        "unneeded": [row["effect"] for row in rows if not row["needed"]],
        "milliseconds": scale * sum(row["seconds"] for row in rows),
        "milliseconds_always": scale * sum(row["seconds_always"] for row in rows),
        "equal": rows[0]["equal_to_always"],
        "same": _SAME[rows[0]["equal_to_always"]],
    }


def sum_effects(table: pa.Table) -> list[Row]:
    """Sum up `tables.EFFECTS` over all jobs, an effect a row, in the scene's order, with all modes and reasons."""
    order = {name: place for place, name in enumerate(EffectModes.model_fields)}
    sums = [(name, "sum") for name in ("touches", "runs", "seconds")]
    texts = [(name, "distinct") for name in ("mode", "reason")]
    rows = table.group_by("effect", use_threads=False).aggregate([*sums, *texts]).to_pylist()
    for row in rows:
        row |= {
            "modes": ", ".join(row["mode_distinct"]),
            "reasons": "; ".join(row["reason_distinct"]),
        }
    return sorted(rows, key=lambda row: (order.get(row["effect"], len(order)), row["effect"]))


def sum_channels(views: pa.Table) -> list[Row]:
    """Give each channel of attention, in how many `tables.VIEWS` it ``ran`` and was ``skipped``, and ``why``."""
    ran = Counter(name for maps in views.column("conspicuity").to_pylist() for name, _ in maps)
    skipped = [pair for pairs in views.column("skipped").to_pylist() for pair in pairs]
    left_out = Counter(name for name, _ in skipped)
    names = [*CHANNELS, *sorted({*ran, *left_out} - set(CHANNELS))]
    why = {name: dict.fromkeys(reason for one, reason in skipped if one == name) for name in names}
    return [
        {"channel": name, "ran": ran[name], "skipped": left_out[name], "why": "; ".join(why[name])}
        for name in names
    ]


def count_states(touches: pa.Table) -> dict[str, Counter[str]]:
    """Count the touches in each contact state, by strategy."""
    rows = touches.group_by(["strategy", "contact_state"]).aggregate([([], "count_all")])
    found: dict[str, Counter[str]] = {}
    for row in rows.to_pylist():
        found.setdefault(row["strategy"], Counter())[row["contact_state"]] = row["count_all"]
    return found


def count_passed_over(touches: pa.Table) -> Counter[str]:
    """Count the places that were passed over for being out of reach, by strategy."""
    sequence = ["class", "object", "viewpoint", "strategy"]
    found = touches.group_by(sequence).aggregate([("rank", "max"), ("rank", "count_distinct")])
    counts: Counter[str] = Counter()
    for row in found.to_pylist():
        counts[row["strategy"]] += row["rank_max"] + 1 - row["rank_count_distinct"]
    return counts


def replaced_sentence(touches: pa.Table, fixations: int) -> str:
    """Say how many touches by fixation lie at none of a view's fixations; empty if all lie at one.

    Parameters
    ----------
    touches : pyarrow.Table
        Rows of `tables.TOUCHES`.
    fixations : int
        The fixations of a view. A place of a higher rank replaces a fixation that the sensor can't reach.
    """
    ranks = touches.filter(pc.equal(touches.column("strategy"), "fixation"))
    replaced = pc.sum(pc.greater_equal(ranks.column("rank"), fixations)).as_py() or 0
    first = ranks.group_by(["class", "object", "viewpoint"]).aggregate([("rank", "min")])
    missed = pc.sum(pc.greater(first.column("rank_min"), 0)).as_py() or 0
    if not replaced and not missed:
        return ""
    return (
        f"In this run {percent(replaced / ranks.num_rows, 0)} of the touches by fixation are at none of the view's "
        f"{counted(fixations, 'fixation')}, but at a later place that the sensor can reach, and in {missed} of "
        f"{counted(first.num_rows, 'view')} the most salient place is never touched."
    )


def count_missing(run: Run) -> Counter[str]:
    """Count the touches that were asked for and not made, by strategy."""
    asked = run.views.num_rows * run.parameters.attention.fixations
    made = Counter(run.touches.column("strategy").to_pylist())
    return Counter({strategy: asked - count for strategy, count in made.items()})
