"""Example of a sensor effect: a constant output of unloaded cells."""

import numpy as np
from pydantic import Field

import visuohaptic as vh
from visuohaptic.sensor import EffectDecision


def need(situation, signal):
    """Decide quickly, before any simulation, which touches need the effect, with the reason."""
    offset = situation.scene.zero_offset
    return EffectDecision(
        np.full(len(situation), offset > 0), f"an offset of {offset:g} of full scale"
    )


def run(situation, signal):
    """Add the offset to all outputs."""
    return signal.map(lambda values: values + situation.scene.zero_offset)


vh.register(
    vh.Effect(
        "zero_offset",
        need,
        run,
        example={"zero_offset": 0.1},
        description="Output of unloaded cells",
        settings={
            "zero_offset": (float, Field(0.0, ge=0, le=0.5, description="Offset (of full scale)"))
        },
        before="noise",
    )
)

if __name__ == "__main__":
    from visuohaptic.scene import Scene
    from visuohaptic.sensor import TouchBatch, simulate

    situation = TouchBatch(Scene(zero_offset=0.1), np.zeros((1, 2, 2)), np.full(1, 1e-3), None)
    readings, records = simulate(situation, np.array([[[0.0, 0.5], [0.95, 1.0]]]))
    print(*readings.ravel(), "by", *(record.effect for record in records if record.runs))
