"""Example of a gymnasium environment: choose the next touch, and predict the class of the object.

Spaces, reward and info follow active perception in ap_gym and Tactile MNIST (T. Schneider et al., "Tactile MNIST",
2025), with our sensor instead of a GelSight.
"""

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box, Dict, Discrete

import visuohaptic as vh


def touch_at(thing, target):
    """Touch the surface at the point that is nearest to a target (3,), in the object frame.

    Returns the imprint (r, r), the position (3,) and the rotation (3, 3) of the sensor. The columns of the rotation are
    the sensor's column axis, its row axis, and the outward normal.
    """
    nearest, _ = vh.RayCaster(thing.surface).nearest(np.reshape(target, (1, 3)).astype(float))
    felt = thing.touch(at=nearest)
    [touch] = felt.touches.to_pylist()
    position, normal, tangent = (
        np.array([touch[f"{prefix}{axis}"] for axis in "xyz"])
        for prefix in ("", "normal_", "tangent_")
    )
    return felt.imprints[0], position, np.column_stack([tangent, np.cross(normal, tangent), normal])


def cross_entropy(prediction, target, batch_shape=(), rng=None):
    """Compute the loss of logits (k,) for the true class, as `ap_gym.CrossEntropyLossFn` does."""
    logits = np.asarray(prediction, dtype=float)
    most = logits.max()
    return float(most + np.log(np.exp(logits - most).sum()) - logits[target])


class TouchEnvironment(gym.Env):
    """Touch an object of an unknown class, step by step.

    Parameters
    ----------
    objects : sequence of TouchableObject, optional
        The objects; each episode draws an object. Their classes are the targets. The default is the package's four
        example objects.
    step_limit : int
        Touches of an episode after the first touch, which `reset` makes.
    step_length : float
        Largest movement from touch to touch (object radii).
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - required by gymnasium
    render_mode = None
    loss_fn = staticmethod(cross_entropy)

    def __init__(self, objects=None, step_limit=16, step_length=0.5):
        names = ("bottle", "car", "chair", "quadruped")
        self.objects = [vh.example(name) for name in names] if objects is None else list(objects)
        self.classes = sorted({thing.key.split("/")[0] for thing in self.objects})
        self.step_limit, self.step_length = step_limit, step_length
        side = len(touch_at(self.objects[0], [0.0, 1.0, 0.0])[0])
        self.observation_space = Dict(
            {
                "sensor_img": Box(-1, 1, (side, side, 1)),
                "sensor_pos": Box(-1, 1, (3,)),
                "sensor_rot": Box(-1, 1, (6,)),
                "time_step": Box(-1, 1, ()),
            }
        )
        self.inner_action_space = Dict({"sensor_target_pos_rel": Box(-1, 1, (3,))})
        self.prediction_space = Box(-np.inf, np.inf, (len(self.classes),))
        self.prediction_target_space = Discrete(len(self.classes))
        self.action_space = Dict(
            {"action": self.inner_action_space, "prediction": self.prediction_space}
        )

    def reset(self, *, seed=None, options=None):  # noqa: ARG002 - required by gymnasium
        """Draw an object and a direction, and touch the object there."""
        super().reset(seed=seed)
        self.thing = self.objects[self.np_random.integers(len(self.objects))]
        self.target = self.classes.index(self.thing.key.split("/")[0])
        self.steps = 0
        direction = self.np_random.normal(size=3)
        return self._touch(direction / np.linalg.norm(direction)), {}

    def step(self, action):
        """Move the sensor and touch. The reward depends on the prediction from the touches before this touch."""
        move = np.asarray(action["action"]["sensor_target_pos_rel"], dtype=float)
        # Limit the length of the movement to 1, as in Tactile MNIST.
        moved = move / max(1.0, np.linalg.norm(move))
        self.steps += 1
        seen = self._touch(self.position + self.step_length * moved)
        base_reward = -1e-3 * float(np.linalg.norm(move))
        loss = self.loss_fn(action["prediction"], self.target)
        info = {
            "base_reward": base_reward,
            "prediction": {"target": self.target, "loss": loss},
        }
        return seen, base_reward - loss, self.steps >= self.step_limit, False, info

    def _touch(self, target):
        imprint, self.position, rotation = touch_at(self.thing, target)
        seen = {
            "sensor_img": 2 * imprint[:, :, None] - 1,
            "sensor_pos": self.position,
            "sensor_rot": rotation[:, 1:].T.ravel(),
            "time_step": 2 * self.steps / self.step_limit - 1,
        }
        return {name: np.array(np.clip(value, -1, 1), "f4") for name, value in seen.items()}


if __name__ == "__main__":
    from gymnasium.utils.env_checker import check_env

    environment = TouchEnvironment(step_limit=4)
    check_env(environment, skip_render_check=True)
    environment.reset(seed=0)
    environment.action_space.seed(0)
    ended, losses = False, []
    while not ended:
        _, _, ended, _, info = environment.step(environment.action_space.sample())
        losses.append(info["prediction"]["loss"])
    print(len(losses), "touches, mean loss", round(np.mean(losses), 2))
