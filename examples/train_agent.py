"""Example of an agent that learns in the environment with which touch it recognises most; the same four objects train and test."""

import gymnasium
import numpy as np
from sklearn.ensemble import ExtraTreesClassifier, ExtraTreesRegressor

import visuohaptic.environment  # noqa: F401 - registers the name

rows = gymnasium.make_vec("visuohaptic/Touch-v0", num_envs=64, touches=1, places=16)
generator = np.random.default_rng(0)


def play(choose, rounds):
    """Return the chosen places, what was felt there, and the classes, of rounds of 64 episodes."""
    parts = []
    for _ in range(rounds):
        seen, _ = rows.reset()
        chosen = choose(seen)
        felt, _, _, _, told = rows.step({"action": chosen, "prediction": np.zeros((64, 4))})
        numbers = np.column_stack([felt["imprint"].reshape(64, -1), felt["pose"]])
        parts.append((seen["places"][range(64), chosen], numbers, told["prediction"]["target"]))
    return map(np.concatenate, zip(*parts, strict=True))


def at_random(seen):
    """Choose one valid place per episode at random."""
    return np.array([generator.choice(np.flatnonzero(valid[:-1])) for valid in seen["valid"]])


def by_worth(seen):
    """Choose the valid place per episode whose touch tells most by prediction."""
    predicted = worth.predict(seen["places"].reshape(-1, 6)).reshape(64, -1)
    return np.where(seen["valid"][:, :-1], predicted, -np.inf).argmax(axis=1)


rows.reset(seed=0)
_, felt, classes = play(at_random, 4)
recogniser = ExtraTreesClassifier(100, random_state=0).fit(felt, classes)
places, felt, classes = play(at_random, 8)
right = recogniser.predict_proba(felt)[range(len(classes)), classes]
worth = ExtraTreesRegressor(100, min_samples_leaf=4, random_state=0).fit(
    places, np.log(right + 0.01)
)
for choose in (at_random, by_worth):
    _, felt, classes = play(choose, 4)
    print(choose.__name__, (recogniser.predict(felt) == classes).mean().round(2))
