"""Registration of ``visuohaptic/Touch-v0``."""

from __future__ import annotations

import gymnasium

NAME = "visuohaptic/Touch-v0"


def register() -> None:
    """Register the single and the vector environment with Gymnasium; a second call changes nothing."""
    if NAME in gymnasium.envs.registration.registry:
        return
    gymnasium.envs.registration.register(
        NAME,
        entry_point="visuohaptic.environment.single:TouchEnv",
        vector_entry_point="visuohaptic.environment.vector:TouchVectorEnv",
    )
