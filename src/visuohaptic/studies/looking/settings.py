"""What study looking compares, by the names of its table."""

from __future__ import annotations

CLEAN = "clean"
"""The sight in which looking is learnt."""

CUES = ("view", "outline")
"""What the eye describes: the grey picture, or the silhouette that is cut out of it."""

LOOK = CUES[0]
"""What of looking is combined with touch."""

TOUCH, PRODUCT, CHECKED, SIDE_BY_SIDE, STOPPING = (
    *("touch", "product", "checked product"),
    *("side by side", "stopping"),
)
