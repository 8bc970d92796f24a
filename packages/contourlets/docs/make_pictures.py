"""Draw the pictures of `transform.md`: `python packages/contourlets/docs/make_pictures.py`, with Matplotlib."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import hsv_to_rgb
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from contourlets import Contourlet, Extension, NonsubsampledContourlet, directional_deviations

PICTURES = Path(__file__).resolve().parent / "pictures"
MARKS = ([-1, 0, 1], ["−π", "0", "π"])
Array = NDArray[np.float64]

# Neighbouring bands have hues that are far apart.
_NUMBERS = np.arange(16)
COLOURS = hsv_to_rgb(
    np.column_stack(
        [
            _NUMBERS * 0.381966 % 1,
            np.where(_NUMBERS % 2, 0.34, 0.52),
            np.where(_NUMBERS % 2, 0.97, 0.84),
        ]
    )
)


def show(axes: Axes, values: Array, title: str, low: float, high: float) -> None:
    """Map numbers to grey, drawn as a square without smoothing."""
    axes.imshow(values, "gray", vmin=low, vmax=high, aspect="auto", interpolation="nearest")
    axes.set_title(title, loc="left", fontsize=9, pad=2)
    axes.set(xticks=[], yticks=[])


def show_bands(rows: NDArray[np.object_], bands: tuple[Array, ...]) -> None:
    """Draw bands in the order of their numbers, zero in middle grey."""
    for number, (axes, band) in enumerate(zip(rows.flat, bands, strict=True), start=1):
        peak = float(np.abs(band).max())
        show(axes, band, str(number), -peak, peak)


def wedge(number: int) -> Array:
    """Corners of one half of the ideal support of one of 16 bands, as (column, row)."""
    if number < 8:
        low = -1 + number / 4
        return np.array([(1, low), (1, low + 0.25), (0, 0)])
    high = 1 - (number - 8) / 4
    return np.array([(high, 1), (high - 0.25, 1), (0, 0)])


def measured_tiling() -> Array:
    """Colour every frequency by the band that answers it most, as strongly as it does."""
    impulse = np.zeros((128, 128))
    impulse[0, 0] = 1
    bands = NonsubsampledContourlet((4,)).forward(impulse).levels[0]
    gains = np.abs(np.fft.fftshift(np.fft.fft2(np.stack(bands)), axes=(1, 2)))
    strength = np.minimum(gains.max(axis=0), 1)[..., None]
    return 1 - strength * (1 - COLOURS[gains.argmax(axis=0)])


def make_tiling(path: Path) -> None:
    """Draw the ideal tiling beside the measured one."""
    figure, (ideal, measured) = plt.subplots(1, 2, figsize=(11, 5.6), layout="constrained")
    measured.imshow(measured_tiling(), extent=(-1, 1, 1, -1), interpolation="nearest")
    for number, colour in enumerate(COLOURS):
        for sign in (1, -1):
            corners = sign * wedge(number)
            ideal.add_patch(Polygon(corners, facecolor=colour, edgecolor="white"))
            for axes in (ideal, measured):
                axes.text(
                    *0.8 * corners[:2].mean(axis=0), str(number + 1), ha="center", va="center"
                )
    ideal.add_patch(Rectangle((-0.5, -0.5), 1, 1, facecolor="0.92", edgecolor="white"))
    ideal.text(0, 0, "coarse", ha="center", va="center")
    titles = ("What a band should answer to", "What it does answer to most")
    for axes, title in zip((ideal, measured), titles, strict=True):
        axes.set(xlim=(-1, 1), ylim=(1, -1), aspect="equal", title=title)
        axes.set(xlabel="along a row", ylabel="down a column (pointing down)")
        axes.set_xticks(*MARKS)
        axes.set_yticks(*MARKS)
    figure.savefig(path)


def make_zone_plate(path: Path) -> None:
    """Draw a zone plate, which turns through all directions, and its 16 bands."""
    steps = (np.arange(256) - 127.5) / 128
    plate = np.cos(0.42 * np.pi * 128 * (steps[:, None] ** 2 + steps[None, :] ** 2))
    figure = plt.figure(figsize=(8.9, 6), layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(1, 2))
    show(left.add_axes((0.05, 0.49, 0.9, 0.45)), plate, "zone plate, 256 × 256", -1, 1)
    note = "One level, 16 bands. Bands 1 to 8\nhold 32 × 128 coefficients, 9 to 16\n128 × 32; drawn as squares,\nzero in middle grey."
    left.text(0.05, 0.45, note, va="top", fontsize=9)
    bands = Contourlet((4,), extension="symmetric").forward(plate).levels[0]
    show_bands(right.subplots(4, 4), bands)
    figure.savefig(path)


def make_borders(path: Path) -> None:
    """Draw an image whose ends differ, its bands with two extensions, and their deviations."""
    rows, columns = np.indices((32, 32))
    image = np.clip(rows - 9 - columns**2 / 52, 0, 1)
    figure = plt.figure(figsize=(10, 8), layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(1, 3))
    show(left.add_axes((0.05, 0.71, 0.9, 0.25)), image, "image, 32 × 32", 0, 1)
    parts = right.subfigures(3, 1, height_ratios=(1, 1, 0.9))
    bars = parts[2].subplots()
    styles: tuple[tuple[Extension, str], ...] = (("periodic", "#cd5f00"), ("symmetric", "#005aa0"))
    for place, (name, colour) in enumerate(styles):
        parts[place].suptitle(f"{name} extension", x=0.02, ha="left", fontsize=11)
        bands = Contourlet((4,), extension=name).forward(image).levels[0]
        show_bands(parts[place].subplots(2, 8), bands)
        heights = directional_deviations(image[None], extension=name)[0]
        bars.bar(_NUMBERS + 0.8 + 0.4 * place, heights, 0.38, label=name, color=colour)
    bars.set_title("Standard deviation of each band", loc="left", fontsize=11)
    bars.set_xticks(_NUMBERS + 1)
    bars.spines[["top", "right"]].set_visible(False)
    bars.legend(frameon=False)
    figure.savefig(path)


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    make_tiling(PICTURES / "tiling.png")
    make_zone_plate(PICTURES / "zone_plate.png")
    make_borders(PICTURES / "borders.png")
