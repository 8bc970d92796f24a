"""OpenCV's filters with the same bits on every processor."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import numpy as np
from numpy.typing import ArrayLike

from .planes import Plane


@contextmanager
def plain_filters() -> Iterator[None]:
    """Make OpenCV compute the same bits on every x86-64 processor, and restore its settings afterwards.

    OpenCV's code for newer instructions differs in the last bits. These bits would decide which of two nearly
    equal saliencies is the largest.
    """
    optimised, primitives = cv2.useOptimized(), cv2.ipp.useIPP()
    cv2.setUseOptimized(False)
    try:
        yield
    finally:
        cv2.setUseOptimized(optimised)
        cv2.ipp.setUseIPP(primitives)


def plain_kernel(values: ArrayLike) -> Plane:
    """Round a filter to 12 decimals: the last digit of NumPy's elementary functions depends on the processor."""
    return np.round(np.asarray(values, dtype=np.float64), 12).astype(np.float32)
