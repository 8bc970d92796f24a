"""The section of the report on ablations: the effect of each part in a table and a chart."""

from __future__ import annotations

from ablations.study import OTHER_DESCRIPTORS, STUDY
from visuohaptic.report.section import ReportContext, Section, Values, figures_of
from visuohaptic.report.studies import read_study
from visuohaptic.report.wording import spaced

NAMES = {
    "whole_method": "whole method",
    "turned_upright": "each object turned about the vertical",
    "turned_any_way": "each object turned in any way",
    "vertical_frame": "no azimuth in the descriptors",
    "vertical_frame_turned_upright": "no azimuth, objects turned about the vertical",
    "contourlet_only": "contourlet bands as the only descriptor of the imprint",
    **{entry.name: f"{entry.label} instead" for entry in OTHER_DESCRIPTORS},
    "cutaneous_only": "cutaneous cues only",
    "kinesthetic_only": "kinesthetic cues only",
    "fixed_sensor_size": "sensor of fixed size",
    "without_map": "no self-organising map",
}
"""Labels of conditions; other conditions are shown by name."""


def condition_name(name: str) -> str:
    """Return the label of a condition."""
    if name in NAMES:
        return NAMES[name]
    channel = name.removeprefix("without_")
    return f"channel {spaced(channel)} left out" if channel != name else spaced(name)


def ablations_values(context: ReportContext) -> Values | None:
    """Return the figures of the study; None if the run has none."""
    study = read_study(context.run.extra_path("studies"), STUDY.name, condition_name)
    return {"study": study} if study else None


SECTION = Section(STUDY.name, STUDY.title, ablations_values, (figures_of(STUDY.name),))
