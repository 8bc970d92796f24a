"""Example of an attention channel: red regions are salient."""

import visuohaptic as vh


def measure_redness(view, _):
    """Compute the excess of red over green and blue as one plane."""
    import numpy as np

    red, green, blue = view.colour
    return [np.maximum(red - np.maximum(green, blue), np.float32(0)) * view.certainty]


vh.register(vh.Channel("redness", "Red above green and blue", measure_redness, needs="hues"))

if __name__ == "__main__":
    import numpy as np

    from visuohaptic.attention import AttentionParameters, ChannelWeights, attend

    rows, columns = np.mgrid[:128, :128] / 128
    colour = np.full((1, 128, 128, 3), 0.5, dtype=np.float32)
    colour[0, 30:42, 30:42] = (0.9, 0.2, 0.2)
    colour[0, 80:92, 80:92] = (0.2, 0.2, 0.9)
    [attention] = attend(
        colour,
        mask=np.ones((1, 128, 128), bool),
        point=np.stack([rows, columns, np.zeros_like(rows)], axis=-1)[None],
        normal=np.broadcast_to([0.0, 0.0, 1.0], (1, 128, 128, 3)),
        face=np.zeros((1, 128, 128), np.int64),
        curvature=np.zeros((1, 128, 128), np.float32),
        parameters=AttentionParameters(weights=ChannelWeights.only("redness")),
    )
    saliency = attention.saliency
    print("red", saliency[30:42, 30:42].max(), "blue", saliency[80:92, 80:92].max())
