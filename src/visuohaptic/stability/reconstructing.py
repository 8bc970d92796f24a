"""How exactly the contourlet transform gives an image back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contourlets import Contourlet

Floats = NDArray[np.float64]


def reconstruction_errors(images: Floats) -> Floats:
    """Decompose images, shape (n, side, side), put them together again, and give each one's error.

    Errors are in units of the image's largest pixel; an image of zeros counts as one of ones.
    """
    transform = Contourlet(levels=(4,))
    again = transform.inverse(transform.forward(images))
    largest = np.abs(images).max(axis=(1, 2))
    return np.abs(again - images).max(axis=(1, 2)) / np.where(largest > 0, largest, 1.0)
