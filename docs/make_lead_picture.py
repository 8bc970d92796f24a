"""Draw docs/pictures/lead.png from the kept figures of study `claims`: `make readme`, with Chromium."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from make_claims import CLASSIFIER, CUES, PIPELINES, SETS, STRATEGIES
from plotly.subplots import make_subplots

DOCS = Path(__file__).parent
PICTURE = DOCS / "pictures" / "lead.png"
WIDTH, HEIGHT = 1000, 640
COLOURS = ("#0b57a4", "#a34a00", "#5c2a86", "#3d5c1e")
SYMBOLS = ("circle", "square", "diamond", "x")


def draw(sets: Mapping[str, Mapping[str, Any]]) -> go.Figure:
    """Draw the lead of fixation with its interval: a panel a set and pipeline, a row a cue."""
    titles = [f"{SETS[name]}, pipeline {pipeline}" for name in sets for pipeline in PIPELINES]
    figure = make_subplots(
        rows=len(sets), cols=len(PIPELINES), subplot_titles=titles, shared_yaxes=True
    )
    opponents = [name for name in STRATEGIES if name != "fixation"]
    for row, figures in enumerate(sets.values(), start=1):
        for column, pipeline in enumerate(PIPELINES, start=1):
            for place, strategy in enumerate(opponents):
                cells = [figures[pipeline][strategy][CLASSIFIER][cue] for cue in CUES]
                leads = [100 * cell["lead"] for cell in cells]
                figure.add_trace(
                    go.Scatter(
                        x=leads,
                        y=[number + 0.16 * (1.5 - place) for number in range(len(CUES))],
                        error_x={
                            "array": [
                                100 * cell["lead_high"] - lead
                                for cell, lead in zip(cells, leads, strict=True)
                            ],
                            "arrayminus": [
                                lead - 100 * cell["lead_low"]
                                for cell, lead in zip(cells, leads, strict=True)
                            ],
                            "symmetric": False,
                        },
                        mode="markers",
                        marker={"color": COLOURS[place], "symbol": SYMBOLS[place], "size": 8},
                        name=STRATEGIES[strategy],
                        legendgroup=strategy,
                        showlegend=row == column == 1,
                    ),
                    row,
                    column,
                )
    figure.add_vline(x=0, line_color="#555d66", line_width=1)
    figure.update_yaxes(tickvals=list(range(len(CUES))), ticktext=list(CUES.values()))
    figure.update_xaxes(title_text="lead of fixation, percentage points", row=len(sets))
    figure.update_layout(
        template="simple_white",
        width=WIDTH,
        height=HEIGHT,
        legend={"orientation": "h", "y": 1.14},
        margin={"l": 90, "r": 20, "t": 90, "b": 50},
    )
    return figure


def photograph(figure: go.Figure, picture: Path) -> None:
    """Write a figure, as large as its layout says, with Chromium."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        sys.exit("Chromium is needed to write a picture.")
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "figure.html")
        figure.write_html(page, include_plotlyjs=True, config={"staticPlot": True})
        subprocess.run(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
             f"--window-size={figure.layout.width},{figure.layout.height}",
             "--virtual-time-budget=4000", f"--screenshot={picture}", page.as_uri()],
            check=True, capture_output=True, timeout=120,
        )  # fmt: skip


def main() -> None:
    """Write the picture."""
    files = {name: DOCS / "figures" / f"claims_{name}.json" for name in SETS}
    sets = {
        name: json.loads(file.read_text("utf-8")) for name, file in files.items() if file.is_file()
    }
    photograph(draw(sets), PICTURE)


if __name__ == "__main__":
    main()
