"""Arrays by what they hold: numbers of 64 bits, truth values, or a plane's numbers of 32 bits."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Booleans: TypeAlias = NDArray[np.bool_]
Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Plane: TypeAlias = NDArray[np.float32]
