"""Draw the pictures of `transform.md`: `python packages/contourlets/docs/make_pictures.py`, with Pillow."""

from __future__ import annotations

import colorsys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from contourlets import Contourlet, NonsubsampledContourlet, directional_deviations

PICTURES = Path(__file__).resolve().parent / "pictures"

INK, PAPER, FAINT = (25, 25, 30), (255, 255, 255), (150, 150, 155)
BLUE, ORANGE = (0, 90, 160), (205, 95, 0)
MARGIN, GAP, LABEL = 24, 8, 22

Array = NDArray[np.float64]
Colour = tuple[int, int, int]


def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Give Pillow's own font."""
    return ImageFont.load_default(size)


def grey(values: Array, low: float, high: float, size: tuple[int, int]) -> Image.Image:
    """Map numbers to grey; stretch to a size without smoothing."""
    levels = np.rint(255 * np.clip((values - low) / (high - low), 0, 1)).astype(np.uint8)
    return Image.fromarray(levels).resize(size, Image.Resampling.NEAREST).convert("RGB")


def signed(values: Array, size: int) -> Image.Image:
    """Map numbers to grey with zero in the middle; stretch to a square."""
    peak = max(float(np.abs(values).max()), 1e-12)
    return grey(values, -peak, peak, (size, size))


def band_colour(number: int, strength: float = 1.0) -> Colour:
    """Give neighbouring bands hues that are far apart, and pale them by strength."""
    hue = (number * 0.381966) % 1
    saturation, value = (0.34, 0.97) if number % 2 else (0.52, 0.84)
    rgb = colorsys.hsv_to_rgb(hue, saturation, value)
    red, green, blue = (round(255 * (1 - strength * (1 - part))) for part in rgb)
    return red, green, blue


def wedge(number: int, radius: float) -> list[tuple[float, float]]:
    """Corners of the ideal support of one of 16 bands: (column, row) of one of its two halves."""
    if number < 8:
        low, high = -1 + number / 4, -1 + (number + 1) / 4
        return [(radius, radius * low), (radius, radius * high), (0, 0)]
    low, high = 1 - (number - 8) / 4, 1 - (number - 7) / 4
    return [(radius * low, radius), (radius * high, radius), (0, 0)]


def draw_tiling(draw: ImageDraw.ImageDraw, corner: tuple[int, int], side: int) -> None:
    """Draw the ideal tiling of one level with 16 bands."""
    centre = np.array(corner) + side / 2
    for number in range(16):
        for sign in (1, -1):
            corners = [tuple(centre + sign * np.array(c)) for c in wedge(number, side / 2)]
            draw.polygon(corners, fill=band_colour(number), outline=PAPER)
    draw.rectangle(
        [*(centre - side / 4), *(centre + side / 4)], fill=(235, 235, 235), outline=PAPER
    )
    draw.text(tuple(centre), "coarse", INK, font(17), anchor="mm")


def number_wedges(draw: ImageDraw.ImageDraw, corner: tuple[int, int], side: int) -> None:
    """Write the bands' numbers where the ideal tiling has them."""
    centre = np.array(corner) + side / 2
    for number in range(16):
        for sign in (1, -1):
            place = centre + sign * np.mean(wedge(number, side / 2)[:2], axis=0) * 0.8
            draw.text(tuple(place), str(number + 1), INK, font(17), anchor="mm")


def measured_tiling(side: int) -> Image.Image:
    """Colour every frequency by the band that answers it most, as strongly as it does."""
    impulse = np.zeros((128, 128))
    impulse[0, 0] = 1
    bands = NonsubsampledContourlet((4,)).forward(impulse).levels[0]
    gains = np.abs(np.fft.fftshift(np.fft.fft2(np.stack(bands)), axes=(1, 2)))
    winners, peaks = gains.argmax(axis=0), np.minimum(gains.max(axis=0), 1)
    pixels = np.array(
        [
            [band_colour(int(k), float(p)) for k, p in zip(row, strong, strict=True)]
            for row, strong in zip(winners, peaks, strict=True)
        ],
        np.uint8,
    )
    return Image.fromarray(pixels).resize((side, side), Image.Resampling.NEAREST)


def frequency_axes(draw: ImageDraw.ImageDraw, corner: tuple[int, int], side: int) -> None:
    """Mark −π, 0 and π along both axes."""
    left, top = corner
    for mark, place in (("-pi", 0), ("0", side // 2), ("pi", side)):
        draw.text((left + place, top + side + 6), mark, INK, font(15), anchor="mt")
        draw.text((left - 6, top + place), mark, INK, font(15), anchor="rm")
    draw.text((left + side // 2, top + side + 26), "along a row", FAINT, font(15), anchor="mt")
    draw.text((left + 6, top - 6), "down a column (pointing down)", FAINT, font(15), anchor="lb")


def make_tiling(path: Path) -> None:
    """Draw the ideal tiling beside the measured one."""
    side, left = 460, MARGIN + 26
    canvas = Image.new("RGB", (2 * (side + left) + 40, side + 150), PAPER)
    draw = ImageDraw.Draw(canvas)
    titles = ("What a band should answer to", "What it does answer to most")
    for column, title in enumerate(titles):
        corner = (left + column * (side + left + 20), 84)
        draw.text((corner[0], 20), title, INK, font(20))
        if column == 0:
            draw_tiling(draw, corner, side)
        else:
            canvas.paste(measured_tiling(side), corner)
        number_wedges(draw, corner, side)
        draw.rectangle([*corner, corner[0] + side, corner[1] + side], outline=FAINT)
        frequency_axes(draw, corner, side)
    canvas.save(path, optimize=True)


def paste_bands(
    canvas: Image.Image, bands: list[Array], corner: tuple[int, int], side: int, columns: int
) -> int:
    """Paste bands with their numbers in rows; return the height that they take."""
    draw = ImageDraw.Draw(canvas)
    for number, band in enumerate(bands):
        left = corner[0] + number % columns * (side + GAP)
        top = corner[1] + number // columns * (side + LABEL + GAP)
        draw.text((left, top + LABEL - 4), str(number + 1), INK, font(15), anchor="ls")
        canvas.paste(signed(band, side), (left, top + LABEL))
    return -(-len(bands) // columns) * (side + LABEL + GAP)


def make_zone_plate(path: Path) -> None:
    """Draw a zone plate, which turns through all directions, and its 16 bands."""
    steps = (np.arange(256) - 127.5) / 128
    plate = np.cos(0.42 * np.pi * 128 * (steps[:, None] ** 2 + steps[None, :] ** 2))
    bands = list(Contourlet((4,), extension="symmetric").forward(plate).levels[0])
    side, large = 128, 2 * 128 + GAP + LABEL
    canvas = Image.new(
        "RGB",
        (2 * MARGIN + large + GAP + 4 * (side + GAP), 2 * MARGIN + 4 * (side + LABEL + GAP)),
        PAPER,
    )
    canvas.paste(grey(plate, -1, 1, (large, large)), (MARGIN, MARGIN + LABEL))
    draw = ImageDraw.Draw(canvas)
    draw.text((MARGIN, MARGIN + LABEL - 4), "zone plate", INK, font(15), anchor="ls")
    notes = [
        "256 x 256 pixels, one level, 16 bands.",
        "Bands 1 to 8 hold 32 x 128 coefficients,",
        "9 to 16 hold 128 x 32; drawn as squares,",
        "zero in middle grey.",
    ]
    for line, note in enumerate(notes):
        draw.text((MARGIN, MARGIN + LABEL + large + 12 + 21 * line), note, INK, font(15))
    paste_bands(canvas, bands, (MARGIN + large + 2 * GAP, MARGIN), side, 4)
    canvas.save(path, optimize=True)


def curved_edge() -> Array:
    """Make an image that is dark above a curve and bright below it, so that its ends differ."""
    rows, columns = np.indices((32, 32))
    return np.clip(rows - 9 - columns**2 / 52, 0, 1)


def draw_deviations(
    draw: ImageDraw.ImageDraw, corner: tuple[int, int], size: tuple[int, int], image: Array
) -> None:
    """Draw both extensions' 16 deviations as bars."""
    rows = {
        name: directional_deviations(image[None], extension=name)[0]
        for name in ("periodic", "symmetric")
    }
    peak = max(row.max() for row in rows.values())
    (left, top), (width, height) = corner, size
    base, step = top + height, width / 16
    for index, (name, colour) in enumerate(zip(rows, (ORANGE, BLUE), strict=True)):
        for number, value in enumerate(rows[name]):
            x = left + number * step + index * step * 0.42 + 2
            draw.rectangle([x, base - height * value / peak, x + step * 0.40, base], fill=colour)
        draw.rectangle(
            [left + 150 * index, base + 34, left + 150 * index + 14, base + 48], fill=colour
        )
        draw.text((left + 150 * index + 20, base + 41), name, INK, font(15), anchor="lm")
    for number in range(16):
        draw.text(
            (left + (number + 0.45) * step, base + 5), str(number + 1), INK, font(13), anchor="mt"
        )
    draw.line([left, base, left + width, base], fill=INK)
    draw.text((left, top - 10), "Standard deviation of each band", INK, font(15), anchor="ls")
    draw.text((left + width, top - 10), f"tallest bar: {peak:.3f}", FAINT, font(15), anchor="rs")


def make_borders(path: Path) -> None:
    """Draw an image, its bands with two extensions, and their deviations."""
    image = curved_edge()
    side, large = 84, 260
    canvas = Image.new("RGB", (2 * MARGIN + 8 * (side + GAP) + large + 3 * GAP, 800), PAPER)
    draw = ImageDraw.Draw(canvas)
    draw.text((MARGIN, MARGIN + LABEL - 4), "image, 32 x 32", INK, font(15), anchor="ls")
    canvas.paste(grey(image, 0, 1, (large, large)), (MARGIN, MARGIN + LABEL))
    frame = [MARGIN, MARGIN + LABEL, MARGIN + large - 1, MARGIN + LABEL + large - 1]
    draw.rectangle(frame, outline=FAINT)
    top, left = MARGIN, MARGIN + large + 3 * GAP
    for name in ("periodic", "symmetric"):
        bands = list(Contourlet((4,), extension=name).forward(image).levels[0])
        draw.text((left, top + LABEL - 4), f"{name} extension", INK, font(17), anchor="ls")
        top += LABEL + paste_bands(canvas, bands, (left, top + LABEL), side, 8) + GAP
    draw_deviations(draw, (left, top + 40), (8 * (side + GAP) - GAP, 150), image)
    canvas.save(path, optimize=True)


def main() -> None:
    """Draw all pictures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    make_tiling(PICTURES / "tiling.png")
    make_zone_plate(PICTURES / "zone_plate.png")
    make_borders(PICTURES / "borders.png")


if __name__ == "__main__":
    main()
