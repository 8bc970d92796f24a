"""Fill the tables of README.md from the kept accuracies by cue: `make readme` and `make cues`."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path

from filling import fill_page, table

from cues.kept import MeasuredCues, Setting, kept_cues
from cues.sentences import carries_sentence, imprints_sentence
from cues.study import CUES, STRATEGIES, TOUCHES, WAYS, CueName, is_bare
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Figure, with_interval
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import POSES, percent, points, strategy_name

PAGE = Path(__file__).parent / "README.md"
INTERVALS = IntervalParameters()
HEADLINE = TOUCHES[-1]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    kept = kept_cues()
    sentences = [
        _plain(sentence)
        for one in kept.values()
        for sentence in (carries_sentence(one, INTERVALS), imprints_sentence(one, INTERVALS))
    ]
    heads = ["objects", "pipeline", "touches by", "touches"]
    frames = ["objects", "pipeline", "objects are", "known of the pose", *heads[2:]]
    cues = [*CUES.values(), "imprints add", "pose less imprint"]
    parts: dict[str, list[list[object]]] = {"upright": [], "unknown": [], "known": []}
    for measured in kept.values():
        for setting in _settings():
            if measured.has(setting, "all"):
                part, names = _place(setting)
                row = [measured.objects, *names, *_figures(measured, setting)]
                parts[part].append(row)
    sources = "; ".join(
        f"{one.objects} objects: {one.source.commit[:12]}, {one.source.date}"
        for one in kept.values()
        if one.source
    )
    return {
        "headline": "\n\n".join(textwrap.fill(one, 100, break_on_hyphens=False) for one in sentences),
        "upright": table([*heads, *cues], parts["upright"]),
        "unknown": table([*frames, *cues], parts["unknown"]),
        "known": table([*heads[:2], "known of the pose", *heads[2:], *cues], parts["known"]),
        "sources": textwrap.fill(f"Measured once and kept; {sources}.", 100, break_on_hyphens=False),
    }  # fmt: skip


def _settings() -> Iterator[Setting]:
    """Yield the settings to show: off the first table, fewer touches than five by fixation only."""
    for way in WAYS:
        for pipeline in way.pipelines:
            for strategy in STRATEGIES:
                for touches in reversed(TOUCHES):
                    is_first = (way.tested, way.turns, way.frame) == ("new", "none", "full")
                    if is_first or touches == HEADLINE or strategy == STRATEGIES[0]:
                        yield Setting(way.tested, way.turns, way.frame, touches, pipeline, strategy)


def _place(setting: Setting) -> tuple[str, list[object]]:
    """Return the block of a setting and the cells that name the setting."""
    last = [strategy_name(setting.strategy), setting.touches]
    known = KNOWN[setting.frame]
    if setting.tested == "known":
        return "known", [setting.pipeline, known, *last]
    if (setting.turns, setting.frame) == ("none", "full"):
        return "upright", [setting.pipeline, *last]
    return "unknown", [setting.pipeline, POSES[setting.turns], known, *last]


def _figures(measured: MeasuredCues, setting: Setting) -> Iterator[str]:
    missing = "nothing to tell" if is_bare(setting.frame, setting.touches) else "not measured"
    for name in CUES:
        shown = measured.has(setting, name)
        yield _share(measured.accuracy(setting, name, INTERVALS)) if shown else missing
    pairs: tuple[tuple[CueName, CueName], ...] = (("all", "pose"), ("pose", "imprint"))
    for pair in pairs:
        if measured.has(setting, *pair):
            difference = measured.difference(setting, *pair, INTERVALS)
            yield _plain(with_interval(difference, points))
        else:
            yield ""


def _share(figure: Figure) -> str:
    return _plain(with_interval(figure, percent))


def _plain(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


if __name__ == "__main__":
    fill_page(PAGE, blocks())
