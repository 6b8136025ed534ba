"""Environment of Gymnasium in which the commands of a controlled pantograph are learnt.

Needs ``pip install './python[gym]'``.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ._pantoline import RunError
from .scene import Scene
from .simulation import Simulation

#: Reward of a step that the simulation cannot make.
FAILED = -100.0


class ContactForceEnv(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """Drive of a pantograph as the action, contact force as the aim.

    The scene has ``pantograph.control`` with ``law = "given"`` and a limit of the actuator. A step of the environment
    is a sample of that controller. An episode ends with the run, ``run.duration`` (truncated), or with a step that
    cannot be made (terminated).

    Observation, 4 numbers: contact force less the desired one over the desired one; height of the strip less that at
    the start, m; vertical velocity of the strip, m/s; force of the drive over its limit.

    Action, 1 number from -1 to 1: command over the limit of the actuator.

    Reward of a step: ``-mean(((F - F_desired) / F_desired)**2) - effort * action**2``, the mean over the macro steps.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, scene: Scene, *, pantograph: int = 1, effort: float = 0.0, lead: int = 0) -> None:
        """Makes the environment.

        Args:
            scene: The scene; pantographs with one strip each.
            pantograph: The controlled pantograph, from 1.
            effort: Weight of the squared action in the reward.
            lead: Most samples without control before an episode, drawn by the seed of :meth:`reset`: episodes then
                begin at different places of the line.

        Raises:
            ValueError: A scene whose pantograph takes no commands, or whose actuator has no limit.
        """
        path = f"pantograph[{pantograph}].control"
        law = scene[path]
        if law is None or scene[f"{path}.law"] != "given":
            raise ValueError(f'{path}.law: must be "given" for commands from outside')
        limit = scene[f"{path}.actuator.limit"]
        if limit is None:
            raise ValueError(f"{path}.actuator.limit: must be given, N; an action of 1 is a command of that force")
        self._simulation = Simulation(scene)
        sample = float(scene[f"{path}.sample_time"])
        self._steps = max(1, round(sample / self._simulation.step_length))
        if abs(self._steps * self._simulation.step_length - sample) > 1e-9 * sample:
            raise ValueError(
                f"{path}.sample_time = {sample} s: must be a whole number of coupling.macro_step = "
                f"{self._simulation.step_length} s"
            )
        self._limit = float(limit)
        self._command = f"{path}.force"
        self._names = [f"contact[{pantograph}].force", f"strip[{pantograph}].z", f"strip[{pantograph}].vz"]
        self._drive = f"strip[{pantograph}].control.force"
        start = [self._simulation[name] for name in self._names]
        desired = scene[f"{path}.force"]
        self._desired = float(start[0] if desired is None else desired)
        self._height = start[1]
        self._effort = effort
        self._lead = lead
        bound = np.full(4, np.inf, dtype=np.float32)
        self.observation_space = gymnasium.spaces.Box(-bound, bound, dtype=np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, shape=(1,), dtype=np.float32)

    @property
    def simulation(self) -> Simulation:
        """The simulation, for signals beyond the observation."""
        return self._simulation

    def _observation(self) -> NDArray[np.float32]:
        force, height, velocity = (self._simulation[name] for name in self._names)
        drive = self._simulation[self._drive]
        values = [force / self._desired - 1.0, height - self._height, velocity, drive / self._limit]
        return np.array(values, dtype=np.float32)

    def _info(self) -> dict[str, Any]:
        return {"time": self._simulation.time, "force": self._simulation[self._names[0]]}

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Goes back to the start, and without control as many samples on as the seed says."""
        super().reset(seed=seed, options=options)
        self._simulation.reset()
        lead = int(self.np_random.integers(0, self._lead + 1))
        self._simulation.step(min(lead * self._steps, self._simulation.steps_left - 1))
        return self._observation(), self._info()

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Holds a command for a sample."""
        command = float(np.clip(np.asarray(action, dtype=float).reshape(-1)[0], -1.0, 1.0))
        self._simulation[self._command] = command * self._limit
        steps = min(self._steps, self._simulation.steps_left)
        missing = 0.0
        for _ in range(steps):
            try:
                self._simulation.step()
            except RunError as error:
                return self._observation(), FAILED, True, False, {**self._info(), "reason": str(error)}
            missing += (self._simulation[self._names[0]] / self._desired - 1.0) ** 2
        reward = -missing / max(steps, 1) - self._effort * command**2
        return self._observation(), reward, False, self._simulation.steps_left == 0, self._info()
