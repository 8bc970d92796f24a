"""OpenCV's filters with the instructions that all processors of a kind have."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import numpy as np
from numpy.typing import ArrayLike

from .planes import Plane


@contextmanager
def plain_filters() -> Iterator[None]:
    """Let OpenCV give the same bits on every x86-64 processor.

    Its versions of a filter for newer instructions differ in the last bits, and the largest of nearly equal
    saliencies with them. OpenCV's settings are as they were afterwards.
    """
    optimised, primitives = cv2.useOptimized(), cv2.ipp.useIPP()
    cv2.setUseOptimized(False)
    try:
        yield
    finally:
        cv2.setUseOptimized(optimised)
        cv2.ipp.setUseIPP(primitives)


def plain_kernel(values: ArrayLike) -> Plane:
    """Round a filter's numbers so that the last digit of an elementary function is lost."""
    return np.round(np.asarray(values, dtype=np.float64), 12).astype(np.float32)
