"""Independent random generators, one per random quantity."""

from __future__ import annotations

import hashlib
import json

import numpy as np


def spawn_generator(seed: int, *keys: object) -> np.random.Generator:
    """Return the random generator (PCG64) of a seed and a chain of keys, such as ``("random", "cup/mug", 3)``.

    The generator depends only on `seed` (at least 0) and on ``str`` of each key, not on other generators or on the
    order of jobs.
    """
    # JSON quotes each key, so that no two chains of keys have the same text.
    chain = json.dumps([str(key) for key in keys])
    digest = hashlib.sha256(chain.encode()).digest()
    words = np.frombuffer(digest, dtype="<u4")
    sequence = np.random.SeedSequence(seed, spawn_key=tuple(int(word) for word in words))
    return np.random.Generator(np.random.PCG64(sequence))
