"""Where parameters, commands and targets that went are now: what the errors about old names add."""

from __future__ import annotations

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
"""Parameters that are constants of modules of the package."""

PARAMETERS = {
    **{name: f"it is now the constant visuohaptic.{place}" for name, place in CONSTANTS.items()},
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
}
"""Parameters and sections by dotted names."""

VALUES = {
    ("recognition.order_free.cues", "azimuth_free"): "it is now recognition.frame: vertical",
}
"""Values of parameters, by the parameter's dotted name and the value."""

COMMANDS = {
    "compare --out": "it is now `compare --csv FILE`",
    "export --run": "it is gone, `visuohaptic export FOLDER` takes the run in the working folder",
    "gaze": "it is now `make gaze FOLDER=...`",
    "images": "it is now `python packages/contourlets/examples/tactile_images.py FOLDER`",
    "recognise --budget": "it is now `recognise --viewpoints N`",
    "touch --budget": "it is now `touch --viewpoints N`",
}
"""Commands of `visuohaptic` and their options."""

STUDIES = {
    "certainty": "trust",
    "cost": "settings_cost",
    "curves": "touch_curves",
    "looking": "eye_and_touch",
    "reading": "variant",
    "readings": "variants",
}
"""Words in the names of studies, their rules and their files."""

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
"""Rules and files of the workflow, but for those of studies."""

FOLDERS = {"plugins/": "plug_ins/"}
"""Folders for the user's own files."""


def unknown_parameter(name: str) -> str:
    """Say that there is no parameter of a dotted name, and where it is now if it went."""
    parts = name.split(".")
    names = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    where = next((PARAMETERS[one] for one in names if one in PARAMETERS), None)
    return f"{name} is no parameter" + (f": {where}" if where else "")


def moved_value(name: str, value: object) -> str:
    """Return where a value of the parameter with a dotted name is now; an empty text if the value never was one."""
    return VALUES.get((name, value), "") if isinstance(value, str) else ""
