"""Effects and channels: where each was simulated or left out and why, its run time, and its change of images."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import read_surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.encoding import imprint_strip, webp_address
from visuohaptic.pictures.taxels import as_images
from visuohaptic.report.estimates import Row
from visuohaptic.report.run import Run
from visuohaptic.report.wording import counted, listed
from visuohaptic.scene.parameters import PRESETS, VISUAL_EFFECTS, EffectModes
from visuohaptic.sensor.example_shapes import touch_gallery
from visuohaptic.studies.effects.influence import measured_scenes
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import EFFECT_INFLUENCE
from visuohaptic.touches.touch_table import touch_locations

_SAME = {True: "bit for bit", False: "no", None: "effects are off"}


def influence_figures(path: Path, scene: str) -> Row:
    """Return the run time of effects and their changes of images, from a file of `tables.EFFECT_INFLUENCE`.

    ``view`` has one row per effect of the view, ``touch`` one row per effect of touch in scene `scene`, and ``scenes``
    one row per scene. Milliseconds are per view or per thousand touches. ``shifts`` are the mean changes of an image,
    shares of full scale, by scene. ``views`` and ``touches`` are the numbers measured.
    """
    rows = read_table(EFFECT_INFLUENCE, path).to_pylist()
    view = [_effect(row, rows, 1) for row in _ordered(rows, "any", VISUAL_EFFECTS)]
    touch = [_effect(row, rows, 1000) for row in _ordered(rows, scene, EffectModes.model_fields)]
    scenes = [_ordered(rows, name, EffectModes.model_fields) for name in PRESETS]
    return {
        "view": view,
        "touch": touch,
        "scenes": [_scene(effects) for effects in scenes if effects],
        "views": max((row["units"] for row in view), default=0),
        "touches": max((row["units"] for row in touch), default=0),
    }


def effects_answer(scenes: Sequence[Row]) -> str:
    """Return a sentence on the number of effects that each scene needs, and on the time saved without other effects.

    `scenes` are the ``scenes`` of `influence_figures`; the sentence is empty without scenes.
    """
    if not scenes:
        return ""
    count = max(len(scene["needed"]) + len(scene["unneeded"]) for scene in scenes)
    needed = []
    for scene in scenes:
        # Milliseconds of a thousand touches are microseconds of one touch.
        with_all = scene["milliseconds_always"]
        saved = with_all - scene["milliseconds"] if scene["unneeded"] else 0
        saves = f" (saves {saved:.0f} of {with_all:.0f} µs per touch)" if saved > 0 else ""
        needed.append(f"{len(scene['needed'])} in scene {scene['name']}{saves}")
    changed = listed([scene["name"] for scene in scenes if scene["equal"] is False])
    sentence = f"Of {counted(count, 'effect')} of touch, each scene simulates only the needed effects: {', '.join(needed)}."
    if changed:
        return f"{sentence} In {changed} images change without the other effects."
    same = " Images are the same, bit for bit, as with all effects."
    return sentence + same if all(scene["equal"] for scene in scenes) else sentence


def rows_of_scenes(study: Row) -> list[tuple[Row, list[Row]]]:
    """Return the tables of study `effects`, each with its rows of scenes with all effects.

    Tables without an accuracy in these rows are left out.
    """
    pairs = [
        (table, [row for row in table["cells"] if row["condition"] in PRESETS])
        for table in study["tables"]
    ]
    return [
        (table, rows) for table, rows in pairs if any(row["accuracy"] is not None for row in rows)
    ]


def scene_strips(
    mesh: str | Path, locations: pa.Table, parameters: ExperimentParameters
) -> dict[str, str]:
    """Touch an object in every scene and return the imprints as one ``data:`` URI per scene.

    `mesh` is the object's mesh file, and `locations` the touched places, rows of `tables.FIXATIONS`.
    """
    caster, sensor = RayCaster(read_surface(mesh)), parameters.sensor
    felt = {
        name: touch_locations(caster, locations, sensor, scene, parameters.seed).images
        for name, scene in measured_scenes(parameters.scene, sensor.layout).items()
    }
    return {
        name: webp_address(imprint_strip(as_images(sensor.taxels, part)))
        for name, part in felt.items()
    }


def hard_places(parameters: ExperimentParameters) -> list[Row]:
    """Touch the example shapes that are hard for the run's sensor.

    Returns one row per shape: ``name``, ``size`` (width of the pad in object radii), contact ``state``, and
    ``imprint``, a ``data:`` URI.
    """
    return [
        {
            "name": shape.name,
            "size": float(felt.size[0]),
            "state": str(felt.contact_state[0]),
            "imprint": webp_address(
                imprint_strip(as_images(parameters.sensor.taxels, felt.images[:1]))
            ),
        }
        for shape, felt in touch_gallery(parameters.sensor, parameters.scene, parameters.seed)
    ]


def _ordered(
    rows: Sequence[Row], scene: str, effects: Mapping[str, object] | Sequence[str]
) -> list[Row]:
    by_effect = {row["effect"]: row for row in rows if row["scene"] == scene}
    return [by_effect[name] for name in effects if name in by_effect]


def _effect(effect: Row, rows: Sequence[Row], unit: int) -> Row:
    """Return the figures of one effect; milliseconds are per `unit` touches or views."""
    scale = 1000.0 * unit / effect["touches"]
    shifted = [row for row in rows if row["effect"] == effect["effect"] and row["image_shift"] > 0]
    return {
        "name": effect["effect"],
        "milliseconds": scale * effect["seconds"],
        "milliseconds_always": scale * effect["seconds_always"],
        "shifts": {row["scene"]: row["image_shift"] for row in shifted},
        "units": effect["touches"],
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
    """Sum rows of `tables.EFFECTS` over all jobs, one row per effect in the scene's order.

    Sums are ``touches_sum``, ``runs_sum`` and ``seconds_sum``; ``modes`` and ``reasons`` list all that occur.
    """
    order = {name: index for index, name in enumerate(EffectModes.model_fields)}
    sums = [(name, "sum") for name in ("touches", "runs", "seconds")]
    texts = [(name, "distinct") for name in ("mode", "reason")]
    rows = table.group_by("effect", use_threads=False).aggregate([*sums, *texts]).to_pylist()
    for row in rows:
        row |= {
            "modes": ", ".join(row["mode_distinct"]),
            "reasons": "; ".join(row["reason_distinct"]),
        }
    return sorted(rows, key=lambda row: (order.get(row["effect"], len(order)), row["effect"]))


def effect_rows(
    summed: Sequence[Row], influence: Mapping[str, Sequence[Row]] | None, scene: str
) -> list[Row]:
    """Return one row per effect: how often it ran and why, and its time and change of images where measured.

    Parameters
    ----------
    summed : sequence of mappings
        Rows of `sum_effects`.
    influence : mapping, optional
        The result of `influence_figures`.
    scene : str
        The scene of the run.

    Returns
    -------
    list of mappings
        Rows of `summed` with ``of``, such as ``16 views``; ``milliseconds`` as run and ``milliseconds_always``, per
        view or per thousand touches, and ``shift``, the mean change of an image as a share of full scale. The last
        three are None where they were not measured.
    """
    measured = (
        {row["name"]: row for row in (*influence["view"], *influence["touch"])} if influence else {}
    )
    rows: list[Row] = []
    for row in summed:
        found = measured.get(row["effect"], {})
        shifts = found.get("shifts", {})
        rows.append(
            {
                **row,
                "of": counted(
                    row["touches_sum"], "view" if row["effect"] in VISUAL_EFFECTS else "touch"
                ),
                "milliseconds": found.get("milliseconds"),
                "milliseconds_always": found.get("milliseconds_always"),
                "shift": shifts.get("any", shifts.get(scene)),
            }
        )
    return rows


def sum_channels(views: pa.Table) -> list[Row]:
    """Return one row per channel of attention: views in which it ``ran`` or was ``skipped``, and ``why``.

    `views` are rows of `tables.VIEWS`.
    """
    ran = Counter(name for maps in views.column("conspicuity").to_pylist() for name, _ in maps)
    skipped = [pair for pairs in views.column("skipped").to_pylist() for pair in pairs]
    left_out = Counter(name for name, _ in skipped)
    names = [*CHANNELS, *sorted({*ran, *left_out} - set(CHANNELS))]
    why = {
        name: dict.fromkeys(reason for channel, reason in skipped if channel == name)
        for name in names
    }
    return [
        {"channel": name, "ran": ran[name], "skipped": left_out[name], "why": "; ".join(why[name])}
        for name in names
    ]


def count_states(touches: pa.Table) -> dict[str, Counter[str]]:
    """Count rows of `tables.TOUCHES` by strategy and contact state."""
    rows = touches.group_by(["strategy", "contact_state"]).aggregate([([], "count_all")])
    by_strategy: dict[str, Counter[str]] = {}
    for row in rows.to_pylist():
        by_strategy.setdefault(row["strategy"], Counter())[row["contact_state"]] = row["count_all"]
    return by_strategy


def count_passed_over(touches: pa.Table) -> Counter[str]:
    """Count the places that were passed over because the sensor can't reach them, by strategy.

    These are the ranks that are missing below the highest rank of a sequence in rows of `tables.TOUCHES`.
    """
    sequence = ["class", "object", "viewpoint", "strategy"]
    ranks = touches.group_by(sequence).aggregate([("rank", "max"), ("rank", "count_distinct")])
    counts: Counter[str] = Counter()
    for row in ranks.to_pylist():
        counts[row["strategy"]] += row["rank_max"] + 1 - row["rank_count_distinct"]
    return counts


def count_missing(run: Run) -> Counter[str]:
    """Count the touches that are missing from the number in the parameters, by strategy."""
    required = run.views.num_rows * run.parameters.attention.fixations
    counts = Counter(run.touches.column("strategy").to_pylist())
    return Counter({strategy: required - count for strategy, count in counts.items()})
