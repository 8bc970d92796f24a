"""The world that a touch happens in: what is simulated, and how strongly.

A scene is data alone. Each effect has a mode: `auto` simulates it only
where something calls for it, `always` everywhere, `never` nowhere. What calls for a tactile
effect stands beside the effect in `visuohaptic.sensor`; what calls for a visual one stands here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from visuohaptic.errors import RegistryError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Mode = Literal["auto", "always", "never"]
Cover = Literal["none", "winkler", "half_space"]
Readout = Literal["ideal", "grounded", "floating"]
PresetName = Literal["ideal", "fsr400", "worn_fsr"]


class TactileModes(BaseModel):
    """When each effect of the sensor is simulated, in the order in which a touch goes through them.

    Each has an entry in `visuohaptic.sensor.effects`, except for `adaptive_size`, which is how
    the sensor is placed.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    adaptive_size: Mode = Field("auto", description="the square shrinks until nothing penetrates")
    elastic_cover: Mode = Field("auto", description="an elastic layer turns gaps into pressure")
    force_response: Mode = Field(
        "auto", description="pressure to conductance, break and saturation"
    )
    gain_scatter: Mode = Field("auto", description="each cell has its own gain")
    hysteresis: Mode = Field("auto", description="more output on release than on pressing")
    drift: Mode = Field("auto", description="output creeps with the logarithm of time")
    dead_cells: Mode = Field("auto", description="broken cells conduct nothing")
    crosstalk: Mode = Field("auto", description="sneak paths between rows and columns")
    noise: Mode = Field("auto", description="additive noise of the amplifier")
    quantisation: Mode = Field("auto", description="rounding to the converter's levels")


class VisualModes(BaseModel):
    """When each effect of the view is simulated; no preset sets them."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    colour: Mode = Field("auto", description="the object's colours in the view")
    texture: Mode = Field("auto", description="colours that change within one part")
    shading: Mode = Field("auto", description="brightness by the surface's slope to the light")
    cast_shadows: Mode = Field("never", description="parts that stand in each other's light")


class EffectModes(VisualModes, TactileModes):
    """When each effect is simulated."""


TACTILE_EFFECTS = tuple(TactileModes.model_fields)
VISUAL_EFFECTS = tuple(VisualModes.model_fields)


class Scene(BaseModel):
    """What world the touch happens in; a preset fills whatever is not given.

    The image of a touch is in units of full scale: 1 is the output at
    `full_scale_pressure_pa`, without a cover the output in contact.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    preset: PresetName = Field(
        "ideal",
        description="`ideal`: geometry only, as in the paper; `fsr400`: a new array of force sensing resistors under a rubber cover; `worn_fsr`: the same after long use",
    )
    object_radius_m: float = Field(
        0.05, gt=0, le=100, description="real length of one object radius (metres)"
    )
    press_depths_m: tuple[float, ...] = Field(
        (0.0005,),
        min_length=1,
        description="how far the cover is pressed in, one after another (metres); the image is taken at the last",
    )
    hold_time_s: float = Field(
        1.0, gt=0, description="time from reaching the last depth to the reading (seconds)"
    )
    cover: Cover = Field(
        "none",
        description="`none`: a rigid plane that measures gaps; `winkler`: independent springs; `half_space`: an elastic half-space",
    )
    cover_modulus_pa: float = Field(
        1.5e5, gt=0, description="Young's modulus of the cover (pascal)"
    )
    cover_poisson_ratio: float = Field(
        0.45, ge=0, lt=0.5, description="Poisson's ratio of the cover (1)"
    )
    cover_thickness_m: float = Field(
        0.003, gt=0, description="thickness of the cover, for `winkler` (metres)"
    )
    full_scale_pressure_pa: float = Field(
        1e5, gt=0, description="pressure at which the output is 1 (pascal)"
    )
    break_pressure_pa: float = Field(
        0.0, ge=0, description="pressure below which a cell does not conduct (pascal)"
    )
    saturation_pressure_pa: float | None = Field(
        None,
        gt=0,
        description="pressure at which conductance is half of linear (pascal); none: linear",
    )
    gain_scatter: float = Field(
        0.0, ge=0, lt=0.3, description="standard deviation of the cells' gains (1)"
    )
    hysteresis: float = Field(
        0.0, ge=0, le=0.5, description="excess on release at half of the peak output (1)"
    )
    drift_per_decade: float = Field(
        0.0, ge=-0.5, le=0.5, description="change of output over ten times the time (1)"
    )
    drift_reference_s: float = Field(
        1.0, gt=0, description="time after loading at which drift counts as none (seconds)"
    )
    dead_fraction: float = Field(
        0.0, ge=0, le=1, description="probability of a cell being dead (1)"
    )
    readout: Readout = Field(
        "ideal",
        description="`ideal`: each cell alone; `grounded`: other lines held at zero through `line_resistance_ohm`; `floating`: other lines left open",
    )
    line_resistance_ohm: float = Field(
        0.0, ge=0, description="resistance of each driven or read line (ohm)"
    )
    full_scale_conductance_s: float = Field(
        1e-4, gt=0, description="conductance of a cell at output 1 (siemens)"
    )
    stand_off_conductance_s: float = Field(
        1e-7, ge=1e-12, description="conductance of an untouched cell, for `floating` (siemens)"
    )
    noise: float = Field(
        0.0, ge=0, le=1, description="standard deviation of additive noise (of full scale)"
    )
    bits: int | None = Field(
        None, ge=1, le=24, description="resolution of the converter (bits); none: no rounding"
    )
    effects: EffectModes = Field(EffectModes(), description="when each effect is simulated")

    def with_effects(self, mode: Mode) -> Scene:
        """Give the same scene with one mode for every effect.

        Parameters
        ----------
        mode : {"auto", "always", "never"}
            When each effect is simulated.

        Returns
        -------
        Scene
            Fit to measure what `auto` saves against `always`.
        """
        modes = EffectModes.model_validate(dict.fromkeys(EffectModes.model_fields, mode))
        return self.model_copy(update={"effects": modes})

    @model_validator(mode="before")
    @classmethod
    def _fill_from_preset(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        return {**PRESETS.get(values.get("preset", "ideal"), {}), **values}


@dataclass(frozen=True)
class VisualPlan:
    """Whether a visual effect is simulated, and why or why not.

    Attributes
    ----------
    effect : str
        Its name among the effect modes.
    mode : {"auto", "always", "never"}
        When it may be simulated.
    called_for, simulated : bool
        Whether the object or the light calls for it, and whether it is simulated.
    reason : str
        Why it is called for, or why not.
    """

    effect: str
    mode: Mode
    called_for: bool
    simulated: bool
    reason: str


def plan_visual(
    modes: EffectModes, face_colours: NDArray[np.uint8], ambient: float
) -> tuple[VisualPlan, ...]:
    """Decide which visual effects the views of an object need.

    Parameters
    ----------
    modes : EffectModes
        When each effect may be simulated.
    face_colours : numpy.ndarray
        Shape (f, 3), uint8, sRGB.
    ambient : float
        Share of light that comes evenly from everywhere, 0 to 1.

    Returns
    -------
    tuple of VisualPlan
        One for each of `VISUAL_EFFECTS`. Simulating an effect that is not called for changes no
        view.

    Raises
    ------
    RegistryError
        If an effect is declared and has no plan.
    """
    coloured = bool((face_colours != face_colours[:, :1]).any())
    patterned = bool((face_colours != face_colours[:1]).any())
    slanted = ambient < 1
    shaded = slanted and modes.shading != "never"
    light = "part of the light has a direction" if slanted else "all light is ambient"
    shadow = light if shaded or not slanted else "without shading no light is blocked"
    plans = (
        _plan(modes, "colour", coloured, "faces have hues" if coloured else "all faces are grey"),
        _plan(
            modes,
            "texture",
            patterned,
            "faces differ in colour" if patterned else "all faces have one colour",
        ),
        _plan(modes, "shading", slanted, light),
        _plan(modes, "cast_shadows", shaded, shadow),
    )
    planned = tuple(plan.effect for plan in plans)
    if planned != VISUAL_EFFECTS:
        raise RegistryError(
            f"{', '.join(planned)} are planned; each of {', '.join(VISUAL_EFFECTS)} needs a plan."
        )
    return plans


def seen_colours(
    face_colours: NDArray[np.uint8], face_areas: NDArray[np.float64], modes: EffectModes
) -> NDArray[np.uint8]:
    """Give the faces' colours without the effects that are never simulated.

    Without texture all faces have the mean colour by area; without colour each face
    has the grey of its luma (ITU-R BT.601).

    Parameters
    ----------
    face_colours : numpy.ndarray
        Shape (f, 3), uint8, sRGB.
    face_areas : numpy.ndarray
        Shape (f,), float64, any unit.
    modes : EffectModes
        When each effect may be simulated.

    Returns
    -------
    numpy.ndarray
        Shape (f, 3), uint8.
    """
    import numpy as np

    if "never" not in (modes.texture, modes.colour):
        return face_colours
    colours = face_colours.astype(np.float64)
    if modes.texture == "never":
        mean = (colours * face_areas[:, None]).sum(axis=0) / face_areas.sum()
        colours = np.repeat(mean[None], len(colours), axis=0)
    if modes.colour == "never":
        luma = colours @ np.array([0.299, 0.587, 0.114])
        colours = np.repeat(luma[:, None], 3, axis=1)
    return np.round(colours).astype(np.uint8)


def _plan(modes: EffectModes, effect: str, called_for: bool, reason: str) -> VisualPlan:  # noqa: FBT001
    mode: Mode = getattr(modes, effect)
    simulated = mode == "always" or (mode == "auto" and called_for)
    return VisualPlan(effect, mode, called_for, simulated, reason)


_FSR400: dict[str, object] = {
    "press_depths_m": (0.0005,),
    "cover": "winkler",
    # 0.2 N on the 20.3 mm² of the Interlink FSR 400; half of linear within 0.7 to 1.4 MPa.
    "break_pressure_pa": 1e4,
    "saturation_pressure_pa": 1e6,
    "gain_scatter": 0.06,
    "hysteresis": 0.1,
    "drift_per_decade": 0.05,
    "readout": "grounded",
    "line_resistance_ohm": 10.0,
    "noise": 0.005,
    "bits": 8,
}
PRESETS: dict[str, dict[str, object]] = {
    "ideal": {},
    "fsr400": _FSR400,
    "worn_fsr": {
        **_FSR400,
        "press_depths_m": (0.0008, 0.0005),
        "hold_time_s": 100.0,
        "gain_scatter": 0.12,
        "dead_fraction": 0.02,
        "line_resistance_ohm": 50.0,
        "noise": 0.02,
    },
}
