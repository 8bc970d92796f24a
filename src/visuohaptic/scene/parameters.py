"""The scene of a touch: the simulated effects and their strengths.

A scene is data only. Each effect has a mode. `auto` simulates the effect only where it is needed,
`always` everywhere, `never` nowhere. `visuohaptic.sensor.effects` decides where a tactile effect is
needed, and `visuohaptic.fixations.visual_effects` where a visual effect is needed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from visuohaptic.base.errors import RegistryError
from visuohaptic.base.section import Section

Mode = Literal["auto", "always", "never"]
Cover = Literal["none", "winkler", "half_space"]
Readout = Literal["ideal", "grounded", "floating"]
PresetName = Literal["ideal", "fsr400", "worn_fsr"]


class TactileModes(Section):
    """When each effect of the sensor is simulated, in the order of simulation.

    Each effect has an entry in `visuohaptic.sensor.effects`. Only `adaptive_size` has none: placing
    the sensor applies it (`visuohaptic.sensor.placing`).
    """

    adaptive_size: Mode = Field("auto", description="The square shrinks until nothing penetrates")
    elastic_cover: Mode = Field("auto", description="An elastic layer turns gaps into pressure")
    force_response: Mode = Field(
        "auto", description="Pressure to conductance, break and saturation"
    )
    gain_scatter: Mode = Field("auto", description="Each cell has its own gain")
    hysteresis: Mode = Field("auto", description="More output on release than on pressing")
    drift: Mode = Field("auto", description="Output creeps with the logarithm of time")
    dead_cells: Mode = Field("auto", description="Broken cells conduct nothing")
    crosstalk: Mode = Field("auto", description="Sneak paths between rows and columns")
    noise: Mode = Field("auto", description="Additive noise of the amplifier")
    quantisation: Mode = Field("auto", description="Rounding to the converter's levels")


class VisualModes(Section):
    """When each effect of the view is simulated; no preset sets them."""

    colour: Mode = Field("auto", description="The object's colours in the view")
    texture: Mode = Field("auto", description="Colours that change within one part")
    shading: Mode = Field("auto", description="Brightness by the surface's slope to the light")
    cast_shadows: Mode = Field("never", description="Shadows of parts on other parts")


class EffectModes(VisualModes, TactileModes):
    """When each effect is simulated: `auto` only where needed, `always`, or `never`."""


TACTILE_EFFECTS = TactileModes.model_fields.keys()
"""The names of the sensor's effects, including effects that plug-ins add later."""
VISUAL_EFFECTS = tuple(VisualModes.model_fields)


class Scene(Section):
    """The scene of a touch; the preset fills every value that is not given (docs/sensor.md).

    The image of a touch is in units of full scale: 1 is the output at
    `full_scale_pressure_pa`, without a cover the output in contact.
    """

    preset: PresetName = Field(
        "ideal",
        description="`ideal`: geometry only, as in the paper; `fsr400`: a new array of force sensing resistors under a rubber cover; `worn_fsr`: the same after long use",
    )
    object_radius_m: float = Field(
        0.05, gt=0, le=100, description="Real length of one object radius (metres)"
    )
    press_depths_m: tuple[float, ...] = Field(
        (0.0005,),
        min_length=1,
        description="Successive press depths of the cover (metres); the reading is at the last depth",
    )
    hold_time_s: float = Field(
        1.0, gt=0, description="Time from reaching the last depth to the reading (seconds)"
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
        0.003, gt=0, description="Thickness of the cover, for `winkler` (metres)"
    )
    full_scale_pressure_pa: float = Field(
        1e5, gt=0, description="Pressure at which the output is 1 (pascal)"
    )
    break_pressure_pa: float = Field(
        0.0, ge=0, description="Pressure below which a cell does not conduct (pascal)"
    )
    saturation_pressure_pa: float | None = Field(
        None,
        gt=0,
        description="Pressure at which conductance is half of linear (pascal); none: linear",
    )
    gain_scatter: float = Field(
        0.0, ge=0, lt=0.3, description="Standard deviation of the cells' gains (1)"
    )
    hysteresis: float = Field(
        0.0, ge=0, le=0.5, description="Excess on release at half of the peak output (1)"
    )
    drift_per_decade: float = Field(
        0.0, ge=-0.5, le=0.5, description="Change of output over ten times the time (1)"
    )
    drift_reference_s: float = Field(
        1.0, gt=0, description="Time after loading at which drift is 0 (seconds)"
    )
    dead_fraction: float = Field(
        0.0, ge=0, le=1, description="Probability of a cell being dead (1)"
    )
    readout: Readout = Field(
        "ideal",
        description="`ideal`: each cell separately; `grounded`: other lines held at zero through `line_resistance_ohm`; `floating`: other lines left open",
    )
    line_resistance_ohm: float = Field(
        0.0, ge=0, description="Resistance of each driven or read line (ohm)"
    )
    full_scale_conductance_s: float = Field(
        1e-4, gt=0, description="Conductance of a cell at output 1 (siemens)"
    )
    stand_off_conductance_s: float = Field(
        1e-7, ge=1e-12, description="Conductance of an untouched cell, for `floating` (siemens)"
    )
    noise: float = Field(
        0.0, ge=0, le=1, description="Standard deviation of additive noise (of full scale)"
    )
    bits: int | None = Field(
        None, ge=1, le=24, description="Resolution of the converter (bits); none: no rounding"
    )
    effects: EffectModes = Field(default_factory=EffectModes)

    def with_effects(self, mode: Mode) -> Scene:
        """Return a copy of the scene with one mode for every effect.

        Measurements with `always` show the time that `auto` saves.
        """
        modes = EffectModes.model_validate(dict.fromkeys(EffectModes.model_fields, mode))
        return self.model_copy(update={"effects": modes})

    @model_validator(mode="before")
    @classmethod
    def _fill_from_preset(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        return {**PRESETS.get(values.get("preset", "ideal"), {}), **values}


_TAKEN = frozenset({*Scene.model_fields, *EffectModes.model_fields})


def check_free(effect: str, settings: Iterable[str]) -> None:
    """Check that the names of an added effect and its settings are not yet names of the scene.

    Raises
    ------
    RegistryError
        If `effect` or one of `settings` is a field of `Scene` or `EffectModes`.
    """
    if twice := _TAKEN & {effect, *settings}:
        raise RegistryError(
            f"effect {effect} adds {', '.join(sorted(twice))}, which the scene already has; another "
            "name is needed."
        )


def grow_scene(effect: str, description: str, settings: Mapping[str, tuple[Any, Any]]) -> None:
    """Add the mode and the settings of an added effect to all scenes that are built from now on.

    Parameters
    ----------
    effect : str
        The name of the effect; its mode is `auto` by default.
    description : str
        The description of the mode.
    settings : mapping of str to (type, pydantic field)
        The further fields of `Scene`.
    """
    mode = Field("auto", description=description)
    for model in (TactileModes, EffectModes):
        _grow(model, {effect: (Mode, mode)})
    _grow(Scene, settings)


def _grow(model: type[Section], added: Mapping[str, tuple[Any, Any]]) -> None:
    for name, (kind, field) in added.items():
        model.__pydantic_fields__[name] = FieldInfo.from_annotated_attribute(kind, field)
    model.model_rebuild(force=True)


_FSR400: dict[str, object] = {
    "press_depths_m": (0.0005,),
    "cover": "winkler",
    # Interlink FSR 400: breaks at 0.2 N on 20.3 mm², and has half of the linear output at 0.7 to 1.4 MPa.
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
