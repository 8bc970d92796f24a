"""Time contourlets, PyWavelets and a plain recursive contourlet transform: `python -m benchmarks contourlet`.

The peers take turns, and medians are compared, so that other work on the machine affects all equally. Set
`OPENBLAS_NUM_THREADS=1` for figures of one core.
"""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable
from functools import partial
from importlib import import_module

import numpy as np
import pywt

from benchmarks.turns import Peers, in_turn, medians
from contourlets import (
    EXTENSIONS,
    Contourlet,
    NonsubsampledContourlet,
    directional_deviations,
    wavelet_deviations,
)

ROUNDS = 9
MICRO, MILLI = 1e6, 1e3


def images_of(*shape: int) -> np.ndarray:
    """Draw normal noise."""
    return np.random.default_rng(0).standard_normal(shape)


def contest(peers: Peers, scale: float) -> dict[str, float]:
    """Return the median processor seconds of each peer, multiplied by `scale`."""
    return medians(in_turn(peers, ROUNDS), scale)


def deviations_of_small_images(count: int = 1000) -> dict[str, float]:
    """Time 16 deviations of 32 × 32 images, microseconds per image."""
    images = images_of(count, 32, 32)
    plain = import_module("contourlet_definition")

    def recursive() -> list[float]:
        """Compute the deviations by the definition of the tests."""
        return [float(np.std(band, ddof=1)) for band in plain.toolbox_bands(images[0], (4,))[1:]]

    peers: dict[str, Callable[[], object]] = {
        f"deviations_{extension}": partial(directional_deviations, images, extension=extension)
        for extension in EXTENSIONS
    }
    peers |= {
        "wavelet_db2_3_levels": lambda: wavelet_deviations(images, "db2", 3),
        "wavelet_bior44_1_level": lambda: wavelet_deviations(images, "bior4.4", 1),
        "wavelet_db2_3_levels_PyWavelets_batch": lambda: pywt.wavedec2(
            images, "db2", level=3, axes=(1, 2)
        ),
        "ladder_transform": lambda: Contourlet((4,)).forward(images),
    }
    figures = contest(peers, MICRO / count) | contest({"plain_recursive_form": recursive}, MICRO)
    ratio = figures["plain_recursive_form"] / figures["deviations_periodic"]
    return figures | {"plain_over_periodic": ratio}


def small_batches() -> dict[str, float]:
    """Time deviations of batches of the sizes of a job, microseconds per image."""
    images = images_of(80, 32, 32)
    peers = {size: partial(directional_deviations, images[:size]) for size in (1, 8, 80)}
    seconds = contest({str(size): call for size, call in peers.items()}, MICRO)
    return {size: value / int(size) for size, value in seconds.items()}


def large_image() -> dict[str, float]:
    """Time two levels (l = 3, 4) of a large image: milliseconds, and ratios to PyWavelets."""
    image = images_of(512, 512)
    peers: dict[str, Callable[[], object]] = {
        "wavedec2_bior44": lambda: pywt.wavedec2(image, "bior4.4", "periodization", level=2)
    }
    for extension in EXTENSIONS:
        transform = Contourlet((3, 4), extension=extension)
        peers[f"forward_{extension}"] = partial(transform.forward, image)
        peers[f"inverse_{extension}"] = partial(transform.inverse, transform.forward(image))
    figures = contest(peers, MILLI)
    for extension in EXTENSIONS:
        ratio = figures[f"forward_{extension}"] / figures["wavedec2_bior44"]
        figures[f"forward_{extension}_over_wavedec2"] = ratio
    return figures


def published_sizes() -> dict[str, float]:
    """Time 64 × 64 images with two levels, for which other packages publish times, milliseconds."""
    image = images_of(64, 64)
    peers: dict[str, Callable[[], object]] = {
        "contourlet": lambda: Contourlet((3, 4)).forward(image),
        "nonsubsampled": lambda: NonsubsampledContourlet((3, 4)).forward(image),
    }
    return contest(peers, MILLI)


def first_calls() -> dict[str, float]:
    """Time the deviations of one image in a first call, which also computes tables, milliseconds."""
    image = images_of(1, 32, 32)
    figures = {}
    for extension in EXTENSIONS:
        # No other benchmark uses these filters, so their tables are not cached yet.
        start = time.perf_counter()
        directional_deviations(image, 4, "bior2.8", "pkva6", extension)
        figures[f"deviations_{extension}"] = MILLI * (time.perf_counter() - start)
    return figures


def peak_memory() -> dict[str, float]:
    """Measure the peak of working memory without input and output, MiB."""
    images = images_of(20_000, 32, 32)
    directional_deviations(images[:1])
    tracemalloc.start()
    result = directional_deviations(images)
    deviations = tracemalloc.get_traced_memory()[1] - result.nbytes
    tracemalloc.reset_peak()
    held = tracemalloc.get_traced_memory()[0]
    coefficients = Contourlet((4,)).forward(images[:4000])
    output = sum(band.nbytes for band in coefficients.bands)
    forward = tracemalloc.get_traced_memory()[1] - held - output
    tracemalloc.stop()
    return {
        "deviations_of_20000": deviations / 2**20,
        "forward_of_4000": forward / 2**20,
        "input_of_20000": images.nbytes / 2**20,
    }


def run() -> dict[str, object]:
    """Run all comparisons; names end with the unit: us per image, ms, or MiB."""
    return {
        "deviations_us": deviations_of_small_images(),
        "batches_us": small_batches(),
        "large_ms": large_image(),
        "published_ms": published_sizes(),
        "first_call_ms": first_calls(),
        "peak_mib": peak_memory(),
    }
