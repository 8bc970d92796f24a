"""New names of parameters, commands and targets that were renamed or removed, for errors about the old names."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from visuohaptic.base.wrong_values import SIMILAR

CONSTANTS = {
    "attention.centre_levels": "attention.levels.CENTRE_LEVELS",
    "attention.entropy_bins": "attention.channels.ENTROPY_BINS",
    "attention.iterations": "attention.saliency.ITERATIONS",
    "attention.orientations": "attention.channels.ORIENTATIONS",
    "attention.surround_offsets": "attention.levels.SURROUND_OFFSETS",
    "attention.symmetry_radii": "attention.channels.SYMMETRY_RADII",
    "meshes.merge_tolerance": "meshes.preparing.MERGE_TOLERANCE",
    **{
        f"recognition.self_organising_map.{name}": f"recognition.self_organising_map.{constant}"
        for name, constant in {
            "final_radius": "RADII",
            "initial_radius": "RADII",
            "learning_rate": "LEARNING_RATE",
            "online_epochs": "ONLINE_EPOCHS",
            "ordering_epochs": "ORDERING_EPOCHS",
            "settling_epochs": "SETTLING_EPOCHS",
        }.items()
    },
    "rendering.crease_angle_degrees": "geometry.curvature.CREASE_ANGLE_DEGREES",
    "rendering.crease_width": "geometry.curvature.CREASE_WIDTH",
    "rendering.light_elevation_degrees": "fixations.rendering.LIGHT_ELEVATION_DEGREES",
    "sensor.clearance": "sensor.placing.CLEARANCE",
    "sensor.flatness": "sensor.touching.FLATNESS",
    "sensor.penetration_tolerance": "sensor.placing.PENETRATION_TOLERANCE",
    "viewpoints.field_of_view_degrees": "fixations.viewpoints.FIELD_OF_VIEW_DEGREES",
}
"""Former parameters that are now constants of a module."""

PARAMETERS = {
    **{
        name: f"it is now the constant visuohaptic.{constant}"
        for name, constant in CONSTANTS.items()
    },
    "attention.terms": "strategy `human` has the terms, with fixed weights",
    "gaze": "it is now `make gaze FOLDER=... PEER=...`, and options of `python -m human_gaze`",
    "recognition.best": "pipeline best is now order_free, with section recognition.order_free and fixed settings",
    "recognition.classifier.neighbour_weights": "it is gone, the votes of all neighbours count alike",
    "recognition.classifier.tree_criterion": "it is gone, splits lower the Gini impurity",
    "recognition.intervals.bootstrap_samples": "it is gone, intervals need no samples",
    "recognition.protocol.turns": "it is now meshes.turns, which turns the meshes before they are looked at",
    "rendering.light_azimuth_degrees": "it is gone, both sides are lit alike",
    "viewpoints.first_azimuth_degrees": "it is gone, every ring begins at +z",
    "viewpoints.roll_degrees": "it is gone, all cameras are upright",
    "workflow.keep_studies_current": "it is gone, workflow.studies lists the studies that every run measures",
}
"""Former parameters and sections by dotted name."""

VALUES = {
    ("recognition.order_free.cues", "azimuth_free"): "it is now recognition.frame: vertical",
}
"""Former values of parameters, by dotted name of the parameter and value."""

COMMANDS = {
    "compare --out": "it is now `compare --csv FILE`",
    "export --run": "it is gone, `visuohaptic export FOLDER` takes the run in the working folder",
    "gaze": "it is now `make gaze FOLDER=...`",
    "images": "it is now `python packages/contourlets/examples/tactile_images.py FOLDER`",
    "recognise --budget": "it is now `recognise --viewpoints N`",
    "touch --budget": "it is now `touch --viewpoints N`",
}
"""Former commands of `visuohaptic` and their options."""

STUDIES = {
    "certainty": "trust",
    "cost": "settings_cost",
    "curves": "touch_curves",
    "looking": "eye_and_touch",
    "reading": "variant",
    "readings": "variants",
}
"""Former words in the names of studies, of their rules and of their files, with the new words."""

_EXPORT = "it is now `visuohaptic export FOLDER`"
_GAZE = "it is now `make gaze FOLDER=...`"
_LEAKS = "leaks are what tests/leaks looks for"
TARGETS = {
    "crate": "docs/sharing.md says how to pack a run as an RO-Crate",
    "dvc_all": "it is now all, and model_all for the saved model",
    "export": _EXPORT,
    "export_all": _EXPORT,
    "gaze": _GAZE,
    "gaze_all": _GAZE,
    "guards_hold": _LEAKS,
    "guards_of_training": _LEAKS,
    "reports/crate.zip": "docs/sharing.md says how to pack a run as an RO-Crate",
    "results/guards.parquet": _LEAKS,
}
"""Former rules and files of the workflow, without rules and files of studies."""

FOLDERS = {"plugins/": "plug_ins/"}
"""Former folders for the user's files, with the new folders."""


def unknown_parameter(
    name: str, siblings: Iterable[str] = (), elsewhere: Iterable[str] = ()
) -> str:
    """Return the clause that no parameter has this dotted name, with its successor if the parameter was renamed.

    Without a successor, the most similar of `siblings`, the names of the same section, is suggested. Without such a
    name, the dotted names `elsewhere` are suggested.
    """
    parts = name.split(".")
    prefixes = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    successor = next((PARAMETERS[prefix] for prefix in prefixes if prefix in PARAMETERS), None)
    if successor:
        return f"{name} is no parameter: {successor}"
    similar = get_close_matches(parts[-1], siblings, 1, SIMILAR)
    suggested = [".".join([*parts[:-1], *similar])] if similar else list(elsewhere)
    ending = f"; did you mean {' or '.join(suggested)}?" if suggested else ""
    return f"{name} is no parameter{ending}"


def moved_value(name: str, value: object) -> str:
    """Return the successor of a former value of the parameter with this dotted name; "" for other values."""
    return VALUES.get((name, value), "") if isinstance(value, str) else ""
