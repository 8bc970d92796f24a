"""Independent random generators, one for each thing that is random."""

from __future__ import annotations

import hashlib
import json

import numpy as np


def spawn_generator(seed: int, *keys: object) -> np.random.Generator:
    """Give the random generator, a PCG64, of a seed, at least 0, and names, such as ``("random", "cup/mug", 3)``.

    It depends on these alone, a name being its ``str``: not on the order of jobs, or other generators.
    """
    # JSON quotes each name, so that no two chains of names read the same.
    names = json.dumps([str(key) for key in keys])
    digest = hashlib.sha256(names.encode()).digest()
    words = np.frombuffer(digest, dtype="<u4")
    sequence = np.random.SeedSequence(seed, spawn_key=tuple(int(word) for word in words))
    return np.random.Generator(np.random.PCG64(sequence))
