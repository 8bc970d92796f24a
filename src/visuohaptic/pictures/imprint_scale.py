"""The words for dark and light in a picture of imprints."""

from __future__ import annotations

from dataclasses import dataclass

from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters


@dataclass(frozen=True)
class ImprintScale:
    """The meaning of the two ends of an imprint's scale, in words.

    Attributes
    ----------
    dark, light : str
        The meanings of 0 and 1.
    """

    dark: str
    light: str

    def __str__(self) -> str:
        return f"dark: {self.dark} (0); light: {self.light} (1)"

    @property
    def sentence(self) -> str:
        """The meaning of light and dark as a sentence."""
        return f"In an imprint light is {self.light} (1) and dark is {self.dark} (0)."


def imprint_scale(sensor: SensorParameters, *scenes: Scene) -> ImprintScale:
    """Return the meaning of dark and light in imprints by `sensor.normalisation` and the covers of the scenes.

    With normalisation ``per_imprint``, 1 is the point of the imprint nearest to the sensor's plane, and 0 is the
    farthest point. With ``absolute``, 1 is contact with the plane, and 0 is a gap of `sensor.depth_range` or more. A
    cover turns gaps into pressures. Scenes with and without a cover have both meanings, joined by "or".
    """
    ends = dict.fromkeys(_ends(sensor, scene) for scene in scenes)
    dark, light = (" or ".join(meanings) for meanings in zip(*ends, strict=True))
    return ImprintScale(dark, light)


def _ends(sensor: SensorParameters, scene: Scene) -> tuple[str, str]:
    """Return the meanings of 0 and 1."""
    covered = scene.cover != "none" and scene.effects.elastic_cover != "never"
    if sensor.normalisation == "per_imprint":
        if covered:
            return "the imprint's lowest pressure", "the imprint's highest pressure"
        return "the imprint's farthest point", "the imprint's nearest point"
    if covered:
        return "no pressure", f"{scene.full_scale_pressure_pa:g} Pa or more"
    gap = f"a gap of {sensor.depth_range:g} object radii or more"
    return gap, "contact with the sensor's plane"
