"""Classify images of a tactile sensor: contourlet bands beside pressure, shape and spectrum.

``python tactile_images.py FOLDER`` reads ``FOLDER/<class>/<image>`` and prints the share of test images
that a support vector machine classifies correctly. The protocol is that of J. M. Gandarias, A. J.
García-Cerezo and J. M. Gómez-de-Gabriel ("CNN-based methods for object recognition with high-resolution
tactile sensors", IEEE Sensors Journal 19(16), 2019): 20 random splits, 80 % of each class's images to
train. Images of one object are on both sides: this tells known objects apart, and says nothing of new ones.

Whole numbers of 1, 8 and 16 bits are shares of the largest number of their type, and floats shares of 1.
``python tactile_images.py FOLDER FULL_SCALE`` says what the full scale of 16 and 32 bits and of floats is:
4095 for a sensor of 12 bits, for example. Colours are read as grey.
"""

import sys
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps
from sklearn.compose import ColumnTransformer
from sklearn.model_selection import cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from contourlets import Contourlet, band_deviations

FloatArray = NDArray[np.float64]

LEVELS = (2, 3, 4)  # the coarsest first: 28 bands
CONTACT = 0.05  # share of the full scale from which a taxel counts as touched
RANKS = 16
RINGS = 12
FREQUENCIES = 12
TEST_SHARE = 0.2
PENALTY = 30.0  # of the support vector machine
LARGEST_PIXELS = 2**26  # of all images together: 0.5 GB
FORMATS = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm")


def read_tactile_images(
    folder: str | Path, full_scale: float | None = None
) -> tuple[FloatArray, list[str]]:
    """Read ``folder/<class>/<image>``: images (n, rows, columns) in [0, 1] of the full scale, and n classes.

    `full_scale` is that of images of 16 or 32 bits a taxel, where it is not the largest number of 16 bits, or
    1 of floats. Raises `ValueError` if an image can't be read, or images differ in size or are too large.
    """
    files = sorted(
        file
        for file in Path(folder).glob("*/*")
        if file.suffix.lower() in FORMATS and file.is_file()
    )
    if not files:
        raise ValueError(f"{folder} holds no <class>/<image> that ends in {', '.join(FORMATS)}.")
    if full_scale is not None and not 0 < full_scale < np.inf:
        raise ValueError(f"full_scale is {full_scale}; a number above 0 is allowed.")
    images: list[FloatArray] = []
    for file in files:
        image = _read_image(file, full_scale, LARGEST_PIXELS // len(files))
        if images and image.shape != images[0].shape:
            raise ValueError(
                f"{file} has {image.shape[0]} × {image.shape[1]} taxels and {files[0]} has "
                f"{images[0].shape[0]} × {images[0].shape[1]}; one size is allowed."
            )
        images.append(image)
    return np.stack(images), [file.parent.name for file in files]


def _read_image(file: Path, full_scale: float | None, most_pixels: int) -> FloatArray:
    try:
        # Opening reads the size, and no pixels yet.
        with warnings.catch_warnings(action="ignore", category=Image.DecompressionBombWarning):
            opened = Image.open(file)
        with opened:
            _check_header(opened, file, most_pixels)
            # Cameras turn images by a tag.
            found = ImageOps.exif_transpose(opened)
            return _as_shares(found, opened, file, full_scale)
    except (OSError, SyntaxError, Image.DecompressionBombError) as error:
        raise ValueError(f"{file} can't be read as an image: {error}.") from error


def _check_header(opened: Image.Image, file: Path, most_pixels: int) -> None:
    columns, rows = opened.size
    if columns * rows > most_pixels:
        raise ValueError(
            f"{file} has {rows} × {columns} taxels; {most_pixels:,} an image are allowed, as all images "
            f"together are at most {LARGEST_PIXELS:,}."
        )
    frames = getattr(opened, "n_frames", 1)
    if frames > 1:
        raise ValueError(f"{file} has {frames} pages; one is allowed.")


def _as_shares(
    image: Image.Image, opened: Image.Image, file: Path, full_scale: float | None
) -> FloatArray:
    if image.has_transparency_data and np.asarray(image.convert("RGBA"))[..., 3].min() < 255:
        raise ValueError(f"{file} is transparent, so what its taxels show depends on a background.")
    # Of these formats Pillow scales 16 bits to the whole range.
    is_scaled = image.mode == "I" and opened.format in {"PNG", "PPM"}
    if image.mode in {"1", "L", "LA", "P", "PA", "RGB", "RGBA", "CMYK", "YCbCr"}:
        return np.asarray(image.convert("L"), dtype=np.float64) / 255
    if image.mode == "I" and not is_scaled and full_scale is None:
        raise ValueError(
            f"{file} has whole numbers of 32 bits a taxel, or of 16 with a sign; their full scale must be given."
        )
    if image.mode not in {"I", "F"} and not image.mode.startswith("I;16"):
        raise ValueError(f"{file} has the mode {image.mode}, which is not read; grey is needed.")
    if opened.format == "TIFF" and opened.tag_v2.get(262) == 0:
        raise ValueError(f"{file} counts from white to black, which is read of 8 bits only.")
    values = np.asarray(image, dtype=np.float64)
    shares: FloatArray = values / (full_scale or (1.0 if image.mode == "F" else 65535))
    if not (shares.min() >= 0 and shares.max() <= 1):
        raise ValueError(
            f"{file} has readings from {values.min():g} to {values.max():g}; finite readings from 0 to the "
            "full scale are needed, which may be given."
        )
    return shares


def describe(images: FloatArray) -> dict[str, FloatArray]:
    """Compute groups of features (n, k) of images (n, rows, columns) in [0, 1], each image by itself."""
    return {
        "contourlet": _contourlet(images),
        "pressure": _pressure(images),
        "ranks": _ranks(images),
        "shape": _shape(images),
        "spectrum": _spectrum(images),
    }


def split_accuracies(
    groups: dict[str, FloatArray], classes: list[str], splits: int = 20, seed: int = 2018
) -> FloatArray:
    """Return the share of test images classified correctly in each random split.

    Every group of features has the same weight, whatever its width.
    """
    ends = np.cumsum([0, *(values.shape[1] for values in groups.values())])
    scaling = ColumnTransformer(
        [
            (name, StandardScaler(), slice(start, end))
            for name, start, end in zip(groups, ends[:-1], ends[1:], strict=True)
        ],
        transformer_weights={name: values.shape[1] ** -0.5 for name, values in groups.items()},
    )
    estimator = make_pipeline(scaling, SVC(C=PENALTY, gamma="scale"))
    generator = np.random.default_rng(seed)
    drawn = [_draw_split(np.asarray(classes), generator) for _ in range(splits)]
    return cross_val_score(estimator, np.hstack([*groups.values()]), classes, cv=drawn)


def _draw_split(
    classes: NDArray[np.str_], generator: np.random.Generator
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Draw a fifth of each class's images to test; return the indices that train and those that test."""
    is_tested = np.zeros(len(classes), dtype=bool)
    for name in np.unique(classes):
        own = generator.permutation(np.flatnonzero(classes == name))
        is_tested[own[: round(len(own) * TEST_SHARE)]] = True
    return np.flatnonzero(~is_tested), np.flatnonzero(is_tested)


def _contourlet(images: FloatArray) -> FloatArray:
    """Pad images with zeros to a multiple of what the levels need; return each band's deviation."""
    multiple = 2 ** (len(LEVELS) + max(LEVELS) - 1)
    more = [-size % multiple for size in images.shape[1:]]
    padded = np.pad(images, ((0, 0), *((pad // 2, pad - pad // 2) for pad in more)))
    return band_deviations(padded, Contourlet(LEVELS, "9-7", "pkva12", "symmetric"))


def _pressure(images: FloatArray) -> FloatArray:
    """Return mean, deviation, peak and share of touched taxels."""
    flat = images.reshape(len(images), -1)
    touched = (flat > CONTACT).mean(axis=1)
    return np.column_stack([flat.mean(axis=1), flat.std(axis=1), flat.max(axis=1), touched])


def _ranks(images: FloatArray) -> FloatArray:
    """Return the values at ranks from the largest to the smallest."""
    flat = np.sort(images.reshape(len(images), -1), axis=1)[:, ::-1]
    return flat[:, np.geomspace(1, flat.shape[1], RANKS).astype(int) - 1]


def _shape(images: FloatArray) -> FloatArray:
    """Return total, principal extents and moments of the pressure, and its sums over rings around its centre."""
    count, rows, columns = images.shape
    y, x = np.mgrid[:rows, :columns]
    total = images.sum(axis=(1, 2)) + 1e-9  # an empty image has the extents 0
    centre_x, centre_y = ((images * axis).sum(axis=(1, 2)) / total for axis in (x, y))
    dx, dy = x - centre_x[:, None, None], y - centre_y[:, None, None]
    xx, yy, xy = (
        (images * square).sum(axis=(1, 2)) / total for square in (dx * dx, dy * dy, dx * dy)
    )
    trace, gap = xx + yy, np.hypot(xx - yy, 2 * xy)
    large, small = (np.sqrt(np.maximum(trace + sign * gap, 0) / 2) for sign in (1, -1))
    width = np.hypot(rows, columns) / 2 / RINGS
    ring = np.minimum((np.hypot(dx, dy) / width).astype(int), RINGS)
    index = np.arange(count)[:, None, None] * (RINGS + 1) + ring
    sums = np.bincount(index.ravel(), images.ravel(), count * (RINGS + 1)).reshape(count, -1)
    return np.column_stack([np.log(total), large, small, xx, yy, np.abs(xy), sums[:, :RINGS]])


def _spectrum(images: FloatArray) -> FloatArray:
    """Return logarithms of the amplitudes of the lowest frequencies of either sign."""
    size = [max(edge, 2 * FREQUENCIES) for edge in images.shape[1:]]
    amplitudes = np.log1p(np.abs(np.fft.rfft2(images, size)))
    lowest = amplitudes[:, :FREQUENCIES, :FREQUENCIES]
    mirrored = amplitudes[:, -1:-FREQUENCIES:-1, :FREQUENCIES]
    return np.concatenate([part.reshape(len(images), -1) for part in (lowest, mirrored)], axis=1)


if __name__ == "__main__":
    images, classes = read_tactile_images(sys.argv[1], *map(float, sys.argv[2:3]))
    shares = 100 * split_accuracies(describe(images), classes)
    print(
        f"{len(images)} images of {len(set(classes))} classes: {shares.mean():.1f} ± "
        f"{shares.std(ddof=1):.1f} % of test images correctly classified, {len(shares)} random splits"
    )
