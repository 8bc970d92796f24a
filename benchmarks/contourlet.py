"""Contourlets against PyWavelets and against the plain recursive form, side by side.

Peers take turns within one run, and medians are compared, so that a slow spell of the machine
falls on all of them. Set `OPENBLAS_NUM_THREADS=1` for figures of one core.
"""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable, Sequence
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

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
_DEFINITION = Path(__file__).parent.parent / "packages/contourlets/tests/contourlet_definition.py"


def contest_of(peers: Peers) -> dict[str, float]:
    """Give the median processor seconds of each of some peers."""
    return medians(in_turn(peers, ROUNDS))


def plain_form() -> ModuleType:
    """Load the recursive form that the tests compare with: arrays resampled, extended, filtered."""
    spec = spec_from_file_location("contourlet_definition", _DEFINITION)
    if spec is None or spec.loader is None:
        raise FileNotFoundError(_DEFINITION)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def deviations_of_small_images(count: int = 1000) -> dict[str, float]:
    """Time 16 deviations of 32 × 32 images; microseconds an image."""
    images = np.random.default_rng(0).standard_normal((count, 32, 32))
    plain = plain_form()

    def recursive() -> list[float]:
        return [float(np.std(b, ddof=1)) for b in plain.toolbox_bands(images[0], (4,))[1:]]

    contest: dict[str, Callable[[], object]] = {
        f"deviations_{extension}": partial(directional_deviations, images, extension=extension)
        for extension in EXTENSIONS
    }
    contest |= {
        "wavelet_db2_3_levels": lambda: wavelet_deviations(images, "db2", 3),
        "wavelet_bior44_1_level": lambda: wavelet_deviations(images, "bior4.4", 1),
        "wavelet_db2_3_levels_PyWavelets_batch": lambda: pywt.wavedec2(
            images, "db2", level=3, axes=(1, 2)
        ),
        "ladder_transform": lambda: Contourlet((4,)).forward(images),
    }
    figures = {name: 1e6 * value / count for name, value in contest_of(contest).items()}
    figures["plain_recursive_form"] = 1e6 * contest_of({"plain": recursive})["plain"]
    figures["plain_over_periodic"] = (
        figures["plain_recursive_form"] / figures["deviations_periodic"]
    )
    return figures


def small_batches(sizes: Sequence[int] = (1, 8, 80)) -> dict[str, float]:
    """Time deviations of batches that a single job has; microseconds an image."""
    images = np.random.default_rng(0).standard_normal((max(sizes), 32, 32))
    contest: dict[str, Callable[[], object]] = {
        str(size): partial(directional_deviations, images[:size]) for size in sizes
    }
    return {name: 1e6 * value / int(name) for name, value in contest_of(contest).items()}


def large_image(side: int = 512) -> dict[str, float]:
    """Time two levels (l = 3, 4) of a large image; milliseconds, and ratios to PyWavelets."""
    image = np.random.default_rng(0).standard_normal((side, side))
    transforms = {extension: Contourlet((3, 4), extension=extension) for extension in EXTENSIONS}
    contest: dict[str, Callable[[], object]] = {
        "wavedec2_bior44": lambda: pywt.wavedec2(image, "bior4.4", "periodization", level=2)
    }
    for extension, transform in transforms.items():
        coefficients = transform.forward(image)
        contest[f"forward_{extension}"] = partial(transform.forward, image)
        contest[f"inverse_{extension}"] = partial(transform.inverse, coefficients)
    figures = {name: 1e3 * value for name, value in contest_of(contest).items()}
    for extension in EXTENSIONS:
        ratio = figures[f"forward_{extension}"] / figures["wavedec2_bior44"]
        figures[f"forward_{extension}_over_wavedec2"] = ratio
    return figures


def published_sizes() -> dict[str, float]:
    """Time 64 × 64 images, two levels, for which other packages publish times; milliseconds."""
    image = np.random.default_rng(0).standard_normal((64, 64))
    contest: dict[str, Callable[[], object]] = {
        "contourlet": lambda: Contourlet((3, 4)).forward(image),
        "nonsubsampled": lambda: NonsubsampledContourlet((3, 4)).forward(image),
    }
    return {name: 1e3 * value for name, value in contest_of(contest).items()}


def first_calls() -> dict[str, float]:
    """Time the deviations of one image together with the tables that a first call makes; milliseconds."""
    image = np.random.default_rng(0).standard_normal((1, 32, 32))
    figures = {}
    for extension in EXTENSIONS:
        # No other benchmark has these filters, so no table is there yet.
        start = time.perf_counter()
        directional_deviations(image, 4, "bior2.8", "pkva6", extension)
        figures[f"deviations_{extension}"] = 1e3 * (time.perf_counter() - start)
    return figures


def peak_memory() -> dict[str, float]:
    """Peak of working memory beyond input and output; MiB."""
    images = np.random.default_rng(0).standard_normal((20_000, 32, 32))
    directional_deviations(images[:1])
    tracemalloc.start()
    found = directional_deviations(images)
    deviations = tracemalloc.get_traced_memory()[1] - found.nbytes
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
    """Run every contest: microseconds an image, milliseconds, and MiB at the peak."""
    return {
        "deviations_us": deviations_of_small_images(),
        "batches_us": small_batches(),
        "large_ms": large_image(),
        "published_ms": published_sizes(),
        "first_call_ms": first_calls(),
        "peak_mib": peak_memory(),
    }


def main() -> None:
    """Print the figures as a table."""
    for group, figures in run().items():
        print(group)
        if isinstance(figures, dict):
            for name, value in figures.items():
                print(f"  {name:42s} {value:10.2f}")


if __name__ == "__main__":
    main()
