"""Pictures of the examples: what each plug-in does with the objects that the package brings."""

from __future__ import annotations

import ast
import io
import runpy
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import visuohaptic as vh
from visuohaptic.attention.parameters import AttentionParameters

EXAMPLES = Path(__file__).parents[2] / "examples"
Draw = Callable[[Path], None]


def draw_touches(name: str, strategy: str) -> Draw:
    """Return a function that draws the touches of one view of an object that the package brings."""
    return lambda path: vh.example(name).touch(viewpoints=1, strategy=strategy).picture().save(path)


def draw_redness(path: Path) -> None:
    """Draw a view of the car and its saliency map of channel `redness` only."""
    channels = AttentionParameters().weights.model_dump()
    weights = {f"attention.weights.{name}": float(name == "redness") for name in channels}
    [view] = vh.example("car").touch(viewpoints=1, parameters=weights).views.to_pylist()
    images = {"view": view["view"], "saliency by redness": view["saliency"]}
    draw_images(path, {title: Image.open(io.BytesIO(png)) for title, png in images.items()})


def draw_zero_offset(path: Path) -> None:
    """Draw two imprints without and with an offset of all cells."""
    images: dict[str, object] = {}
    for offset in (0.0, 0.3):
        scene = {"scene.zero_offset": offset, "sensor.normalisation": "absolute"}
        touched = vh.example("chair").touch(viewpoints=1, parameters=scene)
        images |= {f"touch {one + 1}, offset {offset:g}": touched.imprints[one] for one in (0, 3)}
    draw_images(path, images)


def draw_grid_means(path: Path) -> None:
    """Draw an imprint beside its 16 means."""
    chosen = {"features.descriptor": "grid_means"}
    touched = vh.example("bottle").touch(viewpoints=1, parameters=chosen)
    names = [f"contourlet_{number:02d}" for number in range(1, 17)]
    means = np.array([touched.features[name][0].as_py() for name in names]).reshape(4, 4)
    draw_images(path, {"imprint": touched.imprints[0], "16 means": means})


def draw_principal(path: Path) -> None:
    """Draw random sequences of touches by their first two principal components."""
    from visuohaptic.recognition.encoding import SequenceEncoder
    from visuohaptic.recognition.parameters import RecognitionParameters

    chosen = RecognitionParameters(self_organising_map={"output": "principal", "outputs": 2})
    touches = np.random.default_rng(0).normal(size=(60, 5, 22)) * np.arange(1, 23)
    reduced = SequenceEncoder(chosen).fit(touches).reduce(touches)
    draw_points(path, reduced.reshape(-1, 2), "first component", "second component")


def draw_extra_trees(path: Path) -> None:
    """Draw the classes that the classifier predicts for random points."""
    from visuohaptic.recognition import make_order_free

    generator = np.random.default_rng(0)
    rows = generator.normal(size=(40, 2)) + np.repeat([[0.0], [3.0]], 20, axis=0)
    fitted = make_order_free("extra_trees").fit(rows, np.repeat(["cup", "lamp"], 20))
    points = generator.uniform(-2, 5, size=(500, 2))
    lamps = fitted.predict(points) == "lamp"
    draw_points(path, points, "feature 1", "feature 2", {"cup": ~lamps, "lamp": lamps})


def draw_images(path: Path, images: Mapping[str, object]) -> None:
    """Draw images side by side, grey levels from 0 to 1."""
    figure = Figure(figsize=(2.2 * len(images), 2.4), layout="constrained")
    for axes, (title, image) in zip(figure.subplots(1, len(images)), images.items(), strict=True):
        shown = np.asarray(image)
        axes.imshow(shown, cmap="gray", vmin=0, vmax=1 if shown.dtype.kind == "f" else 255)
        axes.set_title(title, fontsize=9)
        axes.set_axis_off()
    figure.savefig(path, dpi=100)


def draw_points(
    path: Path,
    points: np.ndarray,
    across: str,
    up: str,
    groups: Mapping[str, np.ndarray] | None = None,
) -> None:
    """Draw points (n, 2), in the colour of their group."""
    figure = Figure(figsize=(4.4, 3), layout="constrained")
    axes = figure.subplots()
    axes.set(xlabel=across, ylabel=up)
    for name, chosen in (groups or {"": np.full(len(points), fill_value=True)}).items():
        axes.scatter(points[chosen, 0], points[chosen, 1], s=8, label=name)
    if groups:
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5))
    figure.savefig(path, dpi=100)


PICTURES: dict[str, tuple[str, Draw]] = {
    "closest": ("The five closest places of a chair.", draw_touches("chair", strategy="closest")),
    "redness": ("A car, and its saliency map of this channel only.", draw_redness),
    "zero_offset": ("Two imprints of a chair, without and with the offset.", draw_zero_offset),
    "grid_means": ("An imprint of a bottle, and its means.", draw_grid_means),
    "principal": ("Random touches of 22 features, reduced to two.", draw_principal),
    "extra_trees": ("Classes predicted for random points.", draw_extra_trees),
}


def gallery_page(folder: Path, address: str | None) -> str:
    """Draw the pictures into a folder, and return the page that shows them above their code.

    Parameters
    ----------
    folder : path
        Where to.
    address : str or None
        Address of the repository, to which the names of the files link.
    """
    folder.mkdir(parents=True, exist_ok=True)
    parts = ["# Gallery of plug-ins", ""]
    parts += ["Copy the example that is nearest to what you want: [](/docs/extending.md).", ""]
    for path in sorted(
        EXAMPLES.glob("*.py"), key=lambda path: (path.stem not in PICTURES, path.stem)
    ):
        source = path.read_text(encoding="utf-8")
        about = (ast.get_docstring(ast.parse(source)) or "").split("\n\n")[0].replace("\n", " ")
        task, _, does = about.removeprefix("Example of ").partition(": ")
        name = f"`examples/{path.name}`"
        link = name if address is None else f"[{name}]({address}/blob/HEAD/examples/{path.name})"
        parts += [
            f"## {task[:1].upper()}{task[1:]}",
            "",
            f"{does[:1].upper()}{does[1:]} ({link})",
            "",
        ]
        if path.stem in PICTURES:
            caption, draw = PICTURES[path.stem]
            runpy.run_path(str(path))  # registers the plug-in
            draw(folder / f"{path.stem}.png")
            parts += [f"![{caption}](/gallery/{path.stem}.png)", "", f"*{caption}*", ""]
        parts += ["```python", source.strip(), "```", ""]
    return "\n".join(parts)
