"""Environments of Gymnasium in which the commands of a controlled pantograph are learnt, one case or many at once.

Needs ``pip install './python[gym]'``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ._arguments import imported, whole

imported("gymnasium", "gym", "pantoline.gym")  # its refusal names the extra

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ._pantoline import EnvironmentBatch, ForceAim
from ._typed import typed
from .scene import Scene, checked
from .simulation import Simulation

#: Keys of a scene in each case: between two numbers, or by a function of the number of the case and a generator.
Variation = Mapping[str, tuple[float, float]] | Callable[[int, np.random.Generator], Mapping[str, Any]]


def _spaces() -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Observations and actions of one case."""
    bound = np.full(4, np.inf, dtype=np.float32)
    observations = gymnasium.spaces.Box(-bound, bound, dtype=np.float32)
    return observations, gymnasium.spaces.Box(-1.0, 1.0, shape=(1,), dtype=np.float32)


def _drawn(generator: np.random.Generator, lead: int) -> int:
    """Samples without control before an episode."""
    return int(generator.integers(0, lead + 1))


class ContactForceEnv(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """Drive of a pantograph as the action, contact force as the aim.

    The scene has ``pantograph.control`` with ``law = "given"`` and a limit of the actuator. A step of the environment
    is a sample of that controller. An episode ends with the run, ``run.duration`` (truncated), or with a step that
    cannot be made (terminated, with a reward of -100 and a ``reason`` in the information).

    Observation, 4 numbers: contact force less the desired one over the desired one; height of the strip less that at
    the start, m; vertical velocity of the strip, m/s; force of the drive over its limit. With several strips on the
    head, forces are summed, height and velocity are means.

    Action, 1 number from -1 to 1: command over the limit of the actuator.

    Reward of a step: ``-mean(((F - F_desired) / F_desired)**2) - effort * action**2``, the mean over the macro steps.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, scene: Scene, *, pantograph: int = 1, effort: float = 0.0, lead: int = 0) -> None:
        """Makes the environment.

        Args:
            scene: The scene.
            pantograph: The controlled pantograph, from 1.
            effort: Weight of the squared action in the reward.
            lead: Most samples without control before an episode, drawn by the seed of :meth:`reset`: episodes then
                begin at different places of the line.

        Raises:
            ValueError: A scene whose pantograph takes no commands, or whose actuator has no limit.
        """
        self._simulation = Simulation(scene)
        self._aim = ForceAim(self._simulation._stepper, whole("pantograph", pantograph, 1), effort)
        self._lead = whole("lead", lead, 0)
        self.observation_space, self.action_space = _spaces()

    @property
    def simulation(self) -> Simulation:
        """The simulation, for signals beyond the observation."""
        return self._simulation

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Goes back to the start, and without control as many samples on as the seed says."""
        super().reset(seed=seed, options=options)
        observation, _, _, _, time, force = self._aim.begin(_drawn(self.np_random, self._lead))
        return np.array(observation, dtype=np.float32), {"time": time, "force": force}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Holds a command for a sample."""
        command = float(np.asarray(action, dtype=float).reshape(-1)[0])
        observation, reward, truncated, reason, time, force = self._aim.step(command)
        info: dict[str, Any] = {"time": time, "force": force}
        if reason is not None:
            info["reason"] = reason
        return np.array(observation, dtype=np.float32), reward, reason is not None, truncated, info


class ContactForceVectorEnv(VectorEnv[NDArray[np.float32], NDArray[np.float32], NDArray[Any]]):
    """Many cases of :class:`ContactForceEnv`, stepped at once on all cores without the lock of the interpreter.

    Observation, action, reward and end are those of :class:`ContactForceEnv`, and each case has the same bits as alone,
    whatever the number of threads. Cases of one line share its static state and its modes; an episode begins from the
    kept start of its case, at a small part of the cost of setting it up. Seeds and information are those of
    ``gymnasium.vector.SyncVectorEnv``: with ``seed=s``, case ``i`` begins with the seed ``s + i``.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        scene: Scene,
        num_envs: int,
        *,
        vary: Variation | None = None,
        seed: int | None = None,
        pantograph: int = 1,
        effort: float = 0.0,
        lead: int = 0,
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    ) -> None:
        """Makes the environments.

        Args:
            scene: The scene.
            num_envs: Number of cases.
            vary: Keys of the scene that differ from case to case: a mapping of keys to pairs of numbers, between which
                each case draws, or a function that is given the number of the case (from 0) and a generator, and
                returns keys with their values. Each case keeps its keys for all its episodes.
            seed: Seed of these draws; what a case draws depends on the seed and its number alone.
            pantograph: The controlled pantograph, from 1.
            effort: Weight of the squared action in the reward.
            lead: Most samples without control before an episode, as for :class:`ContactForceEnv`.
            threads: Most threads; all cores where it is left out.
            autoreset_mode: When an episode that has ended is followed by the next; all three modes of Gymnasium.

        Raises:
            ValueError: A case that is refused, with its number and its keys.
        """
        super().__init__()
        num_envs = whole("num_envs", num_envs, 1)
        threads = None if threads is None else whole("threads", threads, 1)
        self.num_envs = num_envs
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode}
        self.single_observation_space, self.single_action_space = _spaces()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        draws = np.random.SeedSequence(seed).spawn(num_envs)
        self._keys = [_case(vary, case, np.random.default_rng(draw)) for case, draw in enumerate(draws)]
        cases = [[f"{key}={typed(key, value)}" for key, value in keys.items()] for keys in self._keys]
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        pantograph = whole("pantograph", pantograph, 1)
        self._batch = EnvironmentBatch(checked(scene)._source, cases, pantograph, effort, threads or cores)
        self._lead = whole("lead", lead, 0)
        self._generators: list[np.random.Generator | None] = [None] * num_envs
        self._ended = np.zeros(num_envs, dtype=np.bool_)

    @property
    def keys(self) -> list[dict[str, Any]]:
        """Keys of the scene that each case has drawn."""
        return [dict(keys) for keys in self._keys]

    def signal(self, name: str) -> NDArray[np.float64]:
        """Value of a signal of :class:`pantoline.Simulation` in every case, in its unit.

        Raises:
            KeyError: No such signal.
        """
        return np.array(self._batch.get(name))

    def _draw(self, case: int) -> int:
        generator = self._generators[case]
        if generator is None:
            generator, _ = seeding.np_random()
            self._generators[case] = generator
        return _drawn(generator, self._lead)

    def _turn(
        self, begun: NDArray[np.bool_], actions: list[float] | None
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], dict[str, Any], list[tuple[int, str]]]:
        """A start for the cases in ``begun``, a step for the others, where there are actions."""
        leads = [self._draw(case) if begun[case] else None for case in range(self.num_envs)]
        observed, rewards, truncated, times, forces, reasons = self._batch.turn(leads, actions)
        info = {"time": np.frombuffer(times), "force": np.frombuffer(forces)}
        observations = np.frombuffer(observed, dtype=np.float32).reshape(self.num_envs, 4)
        return observations, np.frombuffer(rewards), np.array(truncated), info, reasons

    def _told(self, info: dict[str, Any], cases: NDArray[np.bool_]) -> dict[str, Any]:
        """Information on these cases, as ``SyncVectorEnv`` has it."""
        told: dict[str, Any] = {}
        for key, values in info.items():
            told[key] = np.where(cases, values, 0.0)
            told[f"_{key}"] = cases.copy()
        return told

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode in every case, or in those of the array ``options["reset_mask"]``."""
        mask = np.ones(self.num_envs, dtype=np.bool_)
        if options and "reset_mask" in options:
            mask = np.asarray(options["reset_mask"])
            if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
                raise ValueError(
                    f"options['reset_mask']: must be an array of {self.num_envs} booleans, not all of them false"
                )
        seeds = [seed + case for case in range(self.num_envs)] if isinstance(seed, int) else seed
        if seeds is not None:
            if len(seeds) != self.num_envs:
                raise ValueError(f"seed: must be one number, or a list of {self.num_envs}, not of {len(seeds)}")
            for case, own in enumerate(seeds):
                if own is not None and mask[case]:
                    self._generators[case], _ = seeding.np_random(own)
        observations, _, _, info, _ = self._turn(mask, None)
        self._ended[mask] = False
        return observations, self._told(info, mask)

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Holds a command in every case for a sample, and begins episodes as the mode of autoreset has it."""
        commands = np.asarray(actions, dtype=float).reshape(-1)
        if len(commands) != self.num_envs:
            raise ValueError(f"actions: must be {self.num_envs} numbers, one for each case, not {len(commands)}")
        begun = np.zeros(self.num_envs, dtype=np.bool_)
        if self.autoreset_mode is AutoresetMode.NEXT_STEP:
            begun = self._ended
        elif self.autoreset_mode is AutoresetMode.DISABLED and self._ended.any():
            ended = np.flatnonzero(self._ended).tolist()
            raise ValueError(f"cases {ended}: the episode has ended: reset them by options['reset_mask']")
        observations, rewards, truncated, info, reasons = self._turn(begun, commands.tolist())
        terminated = np.zeros(self.num_envs, dtype=np.bool_)
        terminated[[case for case, _ in reasons]] = True
        truncated &= ~begun
        every = np.ones(self.num_envs, dtype=np.bool_)
        told = self._told(info, every)
        self._ended = terminated | truncated
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._ended.any():
            failed = dict(reasons)
            again, _, _, fresh, _ = self._turn(self._ended, None)
            told = self._told(fresh, every)
            for case in np.flatnonzero(self._ended).tolist():
                last = {key: values[case] for key, values in info.items()}
                if case in failed:
                    last["reason"] = failed[case]
                told = self._add_info(told, {"final_obs": observations[case], "final_info": last}, case)
            observations = again
        else:
            for case, reason in reasons:
                told = self._add_info(told, {"reason": reason}, case)
        return observations, rewards, terminated, truncated, told


def _case(vary: Variation | None, case: int, generator: np.random.Generator) -> dict[str, Any]:
    """Keys of a case."""
    if vary is None:
        return {}
    if callable(vary):
        return dict(vary(case, generator))
    return {key: float(generator.uniform(low, high)) for key, (low, high) in vary.items()}
