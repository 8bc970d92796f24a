"""What effects cost and change, and what the sensor makes of hard places."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.pictures import imprint_strip
from visuohaptic.report.studies import Row, StudyFigures, StudyTable
from visuohaptic.report.wording import counted, listed, percent
from visuohaptic.scene.parameters import PRESETS, VISUAL_EFFECTS, EffectModes
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import EFFECT_INFLUENCE


@dataclass(frozen=True)
class EffectFigures:
    """One effect on a sample of touches, or of views.

    Attributes
    ----------
    name : str
        The effect.
    milliseconds, milliseconds_always : float
        For a thousand touches, or for one view: under the run's scene, and under `always`.
    shifts : mapping of str to float
        By scene: how far images move without it, 0 to 1; a scene in which nothing calls
        for it is left out.
    """

    name: str
    milliseconds: float
    milliseconds_always: float
    shifts: Mapping[str, float]


@dataclass(frozen=True)
class SceneFigures:
    """All effects of touch in one scene, on a sample.

    Attributes
    ----------
    name : str
        The scene's preset.
    needed, unneeded : tuple of str
        Effects that some touch needed, and those that none did.
    milliseconds, milliseconds_always : float
        For a thousand touches: as simulated, and with everything simulated always.
    equal : bool or None
        Whether both gave the same images, bit for bit; None where the scene switches effects off.
    """

    name: str
    needed: tuple[str, ...]
    unneeded: tuple[str, ...]
    milliseconds: float
    milliseconds_always: float
    equal: bool | None


@dataclass(frozen=True)
class InfluenceFigures:
    """All effects on a sample, those of the view apart, and each scene as a whole."""

    view: list[EffectFigures]
    touch: list[EffectFigures]
    scenes: list[SceneFigures]
    views: int
    touches: int


@dataclass(frozen=True)
class HardPlace:
    """One hard place as the sensor felt it; `imprint` is the address of a grey picture."""

    name: str
    size: float
    state: str
    imprint: str


def influence_figures(path: str | Path | None, scene: str) -> InfluenceFigures | None:
    """Read what effects cost and how far they move images.

    Parameters
    ----------
    path : path or None
        `tables.EFFECT_INFLUENCE`.
    scene : str
        The preset of the run's scene; the seconds are its own.

    Returns
    -------
    InfluenceFigures or None
        None where nothing was measured.
    """
    if path is None or not Path(path).is_file():
        return None
    table = read_table(EFFECT_INFLUENCE, path)
    rows = {(row["scene"], row["effect"]): row for row in table.to_pylist()}
    touch = [name for name in EffectModes.model_fields if (scene, name) in rows]
    view = [name for name in VISUAL_EFFECTS if ("any", name) in rows]
    return InfluenceFigures(
        view=[_effect_figures(name, rows, "any", 1) for name in view],
        touch=[_effect_figures(name, rows, scene, 1000) for name in touch],
        scenes=[
            _scene_figures(name, [row for row in rows.values() if row["scene"] == name])
            for name in PRESETS
            if any(found == name for found, _ in rows)
        ],
        views=max((rows["any", name]["touches"] for name in view), default=0),
        touches=max((rows[scene, name]["touches"] for name in touch), default=0),
    )


def effects_answer(figures: InfluenceFigures) -> str:
    """Say how many effects each scene needs, and what leaving out the others saves and changes."""
    if not figures.scenes:
        return ""
    count = max(len(scene.needed) + len(scene.unneeded) for scene in figures.scenes)
    needed = ", ".join(map(_scene_words, figures.scenes))
    saved = ", in brackets the time that leaving out the others saves" if "(" in needed else ""
    said = f"Of {counted(count, 'effect')} of touch so many are needed: {needed}{saved}."
    return f"{said} {_unchanged(figures.scenes)}".rstrip()


def rows_of_scenes(study: StudyFigures) -> list[tuple[StudyTable, list[Row]]]:
    """Give each table of study `effects`, with its rows of scenes as a whole; none without such rows."""
    found = [
        (table, [row for row in table.cells if row["condition"] in PRESETS])
        for table in study.tables
    ]
    return [
        (table, rows) for table, rows in found if any(row["accuracy"] is not None for row in rows)
    ]


def scene_strips(
    mesh: str | Path, locations: pa.Table, parameters: ExperimentParameters
) -> dict[str, str]:
    """Touch an object's places in every scene.

    Parameters
    ----------
    mesh : path
        The object's surface.
    locations : pyarrow.Table
        Rows of `tables.FIXATIONS`.
    parameters : ExperimentParameters
        What was run; its own scene stands for its preset.

    Returns
    -------
    dict of str to str
        By scene, the address of a grey picture of the imprints side by side.
    """
    from visuohaptic.geometry.raycasting import RayCaster
    from visuohaptic.geometry.surface import read_surface
    from visuohaptic.studies.effects.influence import measured_scenes
    from visuohaptic.touches.touching import touch_locations

    caster = RayCaster(read_surface(mesh))
    return {
        name: imprint_strip(
            touch_locations(caster, locations, parameters.sensor, scene, parameters.seed).images
        )
        for name, scene in measured_scenes(parameters.scene).items()
    }


def hard_places(parameters: ExperimentParameters) -> list[HardPlace]:
    """Touch the hard places with the run's sensor, in the run's scene.

    Parameters
    ----------
    parameters : ExperimentParameters
        What was run.

    Returns
    -------
    list of HardPlace
        One for each.
    """
    from visuohaptic.sensor.gallery import touch_gallery

    touched = touch_gallery(parameters.sensor, parameters.scene, parameters.seed)
    return [
        HardPlace(
            probe.name,
            float(felt.size[0]),
            str(felt.contact_state[0]),
            imprint_strip(felt.images[:1]),
        )
        for probe, felt in touched
    ]


def _scene_figures(name: str, rows: Sequence[Mapping[str, Any]]) -> SceneFigures:
    order = {effect: place for place, effect in enumerate(EffectModes.model_fields)}
    rows = sorted(rows, key=lambda row: order[row["effect"]])
    scale = 1e6 / max(row["touches"] for row in rows)
    return SceneFigures(
        name,
        needed=tuple(row["effect"] for row in rows if row["called_for"]),
        unneeded=tuple(row["effect"] for row in rows if not row["called_for"]),
        milliseconds=scale * sum(row["seconds"] for row in rows),
        milliseconds_always=scale * sum(row["seconds_always"] for row in rows),
        equal=rows[0]["equal_to_always"],
    )


def _scene_words(scene: SceneFigures) -> str:
    said = f"{scene.name} {len(scene.needed)}"
    saved = 1 - scene.milliseconds / scene.milliseconds_always if scene.unneeded else 0.0
    return f"{said} ({percent(saved, 0)})" if saved > 0 else said


def _unchanged(scenes: Sequence[SceneFigures]) -> str:
    """Say whether images are the same where effects that are not needed are left out."""
    changed = [scene.name for scene in scenes if scene.equal is False]
    if changed:
        return f"In {listed(changed)} images change without the others."
    if all(scene.equal for scene in scenes):
        return "No bit of an image changes."
    return ""


def _effect_figures(
    name: str, rows: Mapping[tuple[str, str], Mapping[str, Any]], scene: str, unit: int
) -> EffectFigures:
    own = rows[scene, name]
    milliseconds = 1000.0 * unit / own["touches"]
    shifts = {
        preset: rows[preset, name]["image_shift"]
        for preset in ("any", *PRESETS)
        if (preset, name) in rows and rows[preset, name]["image_shift"] > 0
    }
    return EffectFigures(
        name, milliseconds * own["seconds"], milliseconds * own["seconds_always"], shifts
    )
