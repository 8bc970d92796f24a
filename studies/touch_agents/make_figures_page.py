"""Fill figures.md, the page of all figures, from the kept figures: `make readme`."""

from __future__ import annotations

from filling import figures_of_study, fill_page

from touch_agents.make_page import HERE, KEPT, SETS, differences_table, figures_table
from touch_agents.measure import TOUCHES

PAGE = HERE / "figures.md"


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    figures = figures_of_study(KEPT, SETS)
    return {
        f"{what} {name}": made
        for name, found in figures.items()
        for what, made in (
            ("differences", differences_table(found["differences"])),
            ("figures", figures_table(found["cells"], TOUCHES)),
        )
    }


if __name__ == "__main__":
    fill_page(PAGE, blocks())
