"""What was found before is found again, and nothing else is taken for it."""

import numpy as np

from visuohaptic.recognition.memory import FitMemory

ROWS, LABELS = np.random.default_rng(0).normal(size=(8, 5)), np.arange(8) % 2


def test_the_same_arrays_and_settings_are_found_once_and_others_are_not_mistaken_for_them():
    memory = FitMemory(1000)
    first = memory.recall((ROWS, LABELS, 3), object)
    assert memory.recall((ROWS.copy(), LABELS.copy(), 3), object) is first
    others = [(ROWS + 1e-15, LABELS, 3), (ROWS.reshape(5, 8), LABELS, 3), (ROWS, 1 - LABELS, 3)]
    found = [memory.recall(other, object) for other in (*others, (ROWS, LABELS, 4))]
    assert len({first, *found}) == 5


def test_the_oldest_go_first():
    memory = FitMemory(20)
    kept = [memory.recall((number,), object, size=8) for number in range(3)]
    assert memory.recall((2,), object, size=8) is kept[2]
    assert memory.recall((1,), object, size=8) is kept[1]
    assert memory.recall((0,), object, size=8) is not kept[0]
    assert memory.recall((2,), object, size=8) is not kept[2]
    large = memory.recall((9,), object, size=30)
    assert memory.recall((9,), object, size=30) is large
