"""A scene step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

from ._arguments import whole
from ._pantoline import Checkpoint, Stepper
from .scene import Scene, checked


@dataclass(frozen=True)
class Signal:
    """A signal of a simulation."""

    name: str
    unit: str
    description: str
    settable: bool


class Simulation:
    """Line and pantographs as one system, advanced from outside.

    As long as nothing is set, the same bits as ``scene.run()`` at the ends of the macro steps. The scene is taken as it
    is; changes of it afterwards do not count.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = checked(scene).copy()
        self._stepper = Stepper(scene._source)
        self._signals = {signal[0]: Signal(*signal) for signal in self._stepper.signals()}

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._stepper.time()

    @property
    def step_length(self) -> float:
        """Length of a step, s: ``coupling.macro_step`` of the scene; the last one may be shorter."""
        return self._stepper.step_length()

    @property
    def steps_left(self) -> int:
        """Steps until the end of the run, ``run.duration`` of the scene."""
        return self._stepper.steps_left()

    @property
    def signals(self) -> dict[str, Signal]:
        """Signals by their names, with units, and which of them can be set."""
        return dict(self._signals)

    def step(self, n: int = 1) -> float:
        """Makes ``n`` steps, without the lock of the interpreter.

        Returns:
            The time reached, s.

        Raises:
            RunError: A step that fails, or a step beyond the end of the run.
        """
        self._stepper.step(whole("n", n, 0))
        return self.time

    def reset(self) -> None:
        """Goes back to the start: all values that were set are those of the scene again."""
        self._stepper.reset()

    def save(self) -> Checkpoint:
        """Keeps the present state, from which the simulation goes on bit for bit; it can be pickled."""
        return self._stepper.save()

    def restore(self, checkpoint: Checkpoint) -> None:
        """Goes to a state that a simulation of the same scene has kept.

        Raises:
            ValueError: The state of another scene.
        """
        self._stepper.restore(checkpoint)

    def get(self, name: str) -> float:
        """Value of a signal, in its unit."""
        return self._stepper.get(name)

    def set(self, name: str, value: float) -> None:
        """Sets a signal for the steps that follow.

        Raises:
            KeyError: No such signal.
            TypeError: A value that is no number.
            ValueError: A signal that can only be read.
        """
        self._stepper.set(name, value)

    __getitem__ = get
    __setitem__ = set

    def __reduce__(self) -> NoReturn:
        way = "keep its state with save(), which can be pickled, and restore() it in another Simulation of the scene"
        raise TypeError(f"a Simulation cannot be copied or pickled: {way}")

    def __repr__(self) -> str:
        return f"<Simulation {self._scene.name}, t = {self.time:g} s, {self.steps_left} steps left>"
