"""`visuohaptic images`: features of real tactile images, and how well objects are classified by them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.cli.printing import JsonOption, say, say_json


def images(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Holds <class>/<image>, of one size.")
    ],
    out: Annotated[Path, typer.Option(help="The table of features, Parquet.")] = Path(
        "tactile_features.parquet"
    ),
    levels: Annotated[
        str, typer.Option(help="Contourlet levels, the coarsest first, with commas between.")
    ] = "2,3,4",
    splits: Annotated[
        int, typer.Option(min=0, help="Random splits to train and test on; 0 for none.")
    ] = 0,
    train_share: Annotated[
        float, typer.Option(min=0.01, max=0.99, help="Share of each class's images that trains.")
    ] = 0.8,
    seed: Annotated[int, typer.Option(min=0, help="Random seed of the splits.")] = 2018,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Describe tactile images of any size: contourlet bands, pressure, shape and spectrum.

    Example: visuohaptic images touches --splits 20
    """
    import time

    import numpy as np
    import pyarrow.parquet as pq

    from visuohaptic.cli.tactile_images import (
        describe_tactile_images,
        read_tactile_images,
        split_accuracies,
        tabulate,
    )
    from visuohaptic.whole_files import whole_file

    chosen = _levels(levels)
    started = time.perf_counter()
    read = read_tactile_images(folder)
    groups = describe_tactile_images(read.images, chosen)
    table = tabulate(read, groups)
    with whole_file(out) as unfinished:
        pq.write_table(table, unfinished)
    count, rows, columns = read.images.shape
    values: dict[str, object] = {
        "images": count,
        "classes": len(set(read.classes)),
        "rows": rows,
        "columns": columns,
        "features": table.num_columns - 2,
        "out": out,
    }
    said = f"{out}: {count} images of {rows} × {columns} taxels"
    lines = [f"{said}, {values['classes']} classes, {values['features']} features"]
    if splits:
        generator = np.random.default_rng(seed)
        found = split_accuracies(groups, read.classes, splits, train_share, generator)
        spread = float(found.std(ddof=1)) if splits > 1 else 0.0
        values |= {"splits": splits, "accuracy": float(found.mean()), "deviation": spread}
        lines.append(
            f"{100 * found.mean():.1f} % ± {100 * spread:.1f} of test images correctly classified, "
            f"{splits} random splits, {train_share:g} to train"
        )
    seconds = time.perf_counter() - started
    if as_json:
        say_json({**values, "seconds": seconds})
        return
    for line in lines:
        say(line)
    say(f"{seconds:.1f} s")


def _levels(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise typer.BadParameter(
            f"{text!r} is no list of levels; numbers with commas between are, such as 2,3,4.",
            param_hint="--levels",
        ) from None
