"""Words that the page explains where it first uses them."""

from __future__ import annotations

import re
from collections.abc import Mapping

from markupsafe import Markup, escape

WORDS: Mapping[str, str] = {
    "channel": "One map of the attention model: colour, intensity, orientation, contrast, curvature, edge, entropy, symmetry.",
    "contourlet": "An image transform: a Laplacian pyramid, and a directional filter bank that splits its details into sub-bands.",
    "correctly classified": "A test sequence (or object) is correctly classified if the predicted class is its true class.",
    "coverage": "The share of prediction sets that contain the true class. The stated coverage holds for objects like the training objects.",
    "effect": "A physical effect that may be simulated: shading in a view, noise in an imprint, and so on.",
    "error rate": "The share that is not correctly classified.",
    "fixation": "A place at which the attention model rests; the first is the most salient.",
    "imprint": "The tactile image of one touch: depth or pressure at each taxel.",
    "pipeline": "A way from features to a class: `paper` follows the paper; `order_free` and `learned` are our own.",
    "prediction set": "The named class and further classes, which together hold the true class at least at a stated rate.",
    "saliency map": "The weighted sum of the conspicuity maps.",
    "scene": "The world in which a touch happens: cover, electronics, wear; `ideal` has none.",
    "self-organising map": "A lattice of units fitted to the touches; the paper reduces 22 features to five numbers with it.",
    "sequence": "The touches of one object from one viewpoint by one strategy, in order.",
    "split": "One division of the objects into training and test objects.",
    "variant": "One way to understand the paper: one option for each choice that it leaves open.",
}
"""Meanings by word, the same as in docs/glossary.md."""

_FIRST = re.compile(rf"\b({'|'.join(sorted(WORDS, key=len, reverse=True))})(?=s?\b)", re.IGNORECASE)


def explained(text: str) -> Markup:
    """Return a text as HTML, escaped, with the meaning of each glossary word on hover over its first use."""
    seen: set[str] = set()

    def explain(match: re.Match[str]) -> str:
        word = match[1].lower()
        if word in seen:
            return match[1]
        seen.add(word)
        return f'<abbr title="{escape(WORDS[word])}">{match[1]}</abbr>'

    # Escapes such as &#39; contain no word of the glossary, so the words can be replaced after escaping.
    return Markup(_FIRST.sub(explain, str(escape(text))))  # noqa: S704 - escaped before
