"""Features of tactile images of any size, such as those of a real pressure sensor.

Beside the deviations of contourlet bands of several levels there is what one level leaves out: how
hard and how much is pressed, how the pressure is spread, and coarse frequencies. None of it
depends on where in the image the object lies, up to the borders.

How well objects are classified from single images is measured by the protocol of Gandarias, García-Cerezo
and Gómez-de-Gabriel ("CNN-based methods for object recognition with high-resolution tactile sensors", IEEE
Sensors Journal 19(16), 2019): random splits of each class's images. Images of one object are on both sides,
so this tells known objects apart; it says nothing of new ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.errors import RecognitionError

LEVELS = (2, 3, 4)
"""Contourlet levels, the coarsest first: 28 bands."""

CONTACT = 0.05
"""From this share of the full scale on a taxel counts as touched."""

ORDERED = 16
RINGS = 12
FREQUENCIES = 12
PENALTY = 30.0
"""Penalty C of the support vector machine."""

FORMATS = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm")


@dataclass(frozen=True)
class TactileImages:
    """Images (n, rows, columns) in [0, 1] of the full scale, and the n folders' and files' names."""

    images: NDArray[np.float64]
    classes: tuple[str, ...]
    names: tuple[str, ...]


def read_tactile_images(folder: str | Path) -> TactileImages:
    """Read grey images, `folder/<class>/<image>`, of 8 or 16 bit and one size, sorted by class and name."""
    folder = Path(folder)
    files = sorted(path for path in folder.glob("*/*") if path.suffix.lower() in FORMATS)
    if not files:
        raise RecognitionError(
            f"{folder} holds no <class>/<image>; images may end in {', '.join(FORMATS)}."
        )
    images = [_read_image(file) for file in files]
    for file, image in zip(files, images, strict=True):
        if image.shape != images[0].shape:
            found, first = (" × ".join(map(str, one.shape)) for one in (image, images[0]))
            raise RecognitionError(
                f"{file} has {found} taxels and {files[0]} has {first}; one size is allowed."
            )
    return TactileImages(
        np.stack(images),
        tuple(file.parent.name for file in files),
        tuple(file.name for file in files),
    )


def describe_tactile_images(
    images: NDArray[np.float64], levels: Sequence[int] = LEVELS
) -> Mapping[str, NDArray[np.float64]]:
    """Describe images (n, rows, columns) in [0, 1] by groups of features (n, k), each image by itself.

    `levels` are those of the contourlet bands, the coarsest first; `LevelsError` if they are not allowed.
    """
    from contourlets import Contourlet, band_deviations

    transform = Contourlet(tuple(levels), "9-7", "pkva12", "symmetric")
    padded = _pad(images, 2 ** (len(levels) + max(*levels, 1) - 1))
    return {
        "contourlet": band_deviations(padded, transform),
        "pressure": _pressure(images),
        "ordered": _ordered(images),
        "shape": _shape(images),
        "spectrum": _spectrum(images),
    }


def tabulate(read: TactileImages, groups: Mapping[str, NDArray[np.float64]]) -> pa.Table:
    """Give columns `class`, `image` and one a feature, such as `pressure_02`, a row an image."""
    columns = {
        f"{group}_{place:02d}": column
        for group, values in groups.items()
        for place, column in enumerate(values.T, 1)
    }
    return pa.table({"class": read.classes, "image": read.names, **columns})


def split_accuracies(
    groups: Mapping[str, NDArray[np.float64]],
    classes: Sequence[str],
    splits: int,
    train_share: float,
    generator: np.random.Generator,
) -> NDArray[np.float64]:
    """Give the share (splits,) of test images that a support vector machine classifies correctly.

    Of the n images of `classes`, `groups` hold features (n, k) each, which count alike, whatever their
    width; `train_share` of each class's images trains.
    """
    from threadpoolctl import threadpool_limits

    names, labels = np.unique(np.asarray(classes), return_inverse=True)
    if len(names) < 2:
        raise RecognitionError(f"There is one class ({names[0]}); at least two are needed.")
    counts = np.bincount(labels)
    tested = np.round(counts * (1 - train_share)).astype(int)
    lacking = (tested < 1) | (tested >= counts)
    if lacking.any():
        raise RecognitionError(
            f"Class {names[lacking][0]} has {counts[lacking][0]} images, which can't be divided into "
            f"{train_share:g} to train and the rest to test."
        )
    with threadpool_limits(limits=1):
        return np.array(
            [_accuracy(groups, labels, _draw(labels, tested, generator)) for _ in range(splits)]
        )


def _draw(
    labels: NDArray[np.int64], tested: NDArray[np.int64], generator: np.random.Generator
) -> NDArray[np.bool_]:
    """Choose so many test images of each class; true where an image is tested."""
    chosen = np.zeros(len(labels), dtype=bool)
    for place, count in enumerate(tested):
        chosen[generator.permutation(np.flatnonzero(labels == place))[:count]] = True
    return chosen


def _accuracy(
    groups: Mapping[str, NDArray[np.float64]],
    labels: NDArray[np.int64],
    tested: NDArray[np.bool_],
) -> float:
    from sklearn.svm import SVC

    from visuohaptic.recognition.encoding import fit_standardiser

    parts = [
        fit_standardiser(values[~tested], "standardise").apply(values) / np.sqrt(values.shape[1])
        for values in groups.values()
    ]
    rows = np.concatenate(parts, axis=1)
    machine = SVC(C=PENALTY, gamma=1 / max(rows[~tested].var(axis=0).sum(), 1e-12))
    machine.fit(rows[~tested], labels[~tested])
    return float((machine.predict(rows[tested]) == labels[tested]).mean())


def _read_image(file: Path) -> NDArray[np.float64]:
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(file) as opened:
            deep = opened.mode.startswith("I")
            grey = np.asarray(opened if deep else opened.convert("L"), dtype=np.float64)
    except (UnidentifiedImageError, OSError, Image.DecompressionBombError) as error:
        raise RecognitionError(f"{file} can't be read as an image ({error}).") from error
    if min(grey.shape) < 4:
        raise RecognitionError(
            f"{file} has {grey.shape[0]} × {grey.shape[1]} taxels; at least 4 × 4 are needed."
        )
    return grey / (65535.0 if deep else 255.0)


def _pad(images: NDArray[np.float64], multiple: int) -> NDArray[np.float64]:
    """Put zeros around images until both sides are multiples of a number."""
    _, rows, columns = images.shape
    grow = [-size % multiple for size in (rows, columns)]
    return np.pad(images, ((0, 0), *((more // 2, more - more // 2) for more in grow)))


def _pressure(images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give mean, deviation, peak and share of touched taxels."""
    flat = images.reshape(len(images), -1)
    touched = (flat > CONTACT).mean(axis=1)
    return np.column_stack([flat.mean(axis=1), flat.std(axis=1), flat.max(axis=1), touched])


def _ordered(images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the largest, … smallest value at so many ranks."""
    flat = np.sort(images.reshape(len(images), -1), axis=1)[:, ::-1]
    ranks = np.geomspace(1, flat.shape[1], ORDERED).astype(int) - 1
    return flat[:, ranks]


def _shape(images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give total, principal extents and moments of the pressure, and its sums over rings around its centre."""
    count, rows, columns = images.shape
    y, x = np.mgrid[:rows, :columns]
    total = images.sum(axis=(1, 2)) + 1e-9
    across, down = ((images * axis).sum(axis=(1, 2)) / total for axis in (x, y))
    dx, dy = x - across[:, None, None], y - down[:, None, None]
    xx, yy, xy = (
        (images * square).sum(axis=(1, 2)) / total for square in (dx * dx, dy * dy, dx * dy)
    )
    trace, gap = xx + yy, np.hypot(xx - yy, 2 * xy)
    large, small = (np.sqrt(np.maximum(trace + sign * gap, 0) / 2) for sign in (1, -1))
    width = math.hypot(rows, columns) / 2 / RINGS
    ring = np.minimum((np.hypot(dx, dy) / width).astype(int), RINGS)
    place = np.arange(count)[:, None, None] * (RINGS + 1) + ring
    sums = np.bincount(place.ravel(), images.ravel(), count * (RINGS + 1)).reshape(count, -1)
    return np.column_stack([np.log(total), large, small, xx, yy, np.abs(xy), sums[:, :RINGS]])


def _spectrum(images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give logarithms of the amplitudes of the lowest frequencies of either sign."""
    _, rows, columns = images.shape
    size = (max(rows, 2 * FREQUENCIES), max(columns, 2 * FREQUENCIES))
    amplitudes = np.log1p(np.abs(np.fft.rfft2(images, size)))
    lowest = amplitudes[:, :FREQUENCIES, :FREQUENCIES]
    mirrored = amplitudes[:, -1:-FREQUENCIES:-1, :FREQUENCIES]
    return np.concatenate([one.reshape(len(images), -1) for one in (lowest, mirrored)], axis=1)
