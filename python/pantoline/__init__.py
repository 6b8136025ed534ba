"""Dynamics of pantograph and overhead line.

A :class:`Scene` is one line, its pantographs and one run. :meth:`Scene.run` runs it to a :class:`Result`,
:class:`Simulation` advances it step by step, :func:`sweep` makes many cases of it into one table,
:func:`sensitivity` says which numbers matter.

>>> import pantoline
>>> scene = pantoline.Scene.load("scenes/en50318-300.toml")
>>> scene["run.speed_kmh"] = 280
>>> result = scene.run()
>>> result.summary["pantographs"][0]["contact_force"]["filtered"]["std"]  # N
"""

from __future__ import annotations

from ._carried import fmus, program
from ._pantoline import VERSION as __version__
from ._pantoline import Checkpoint, RunError, SceneError, SweepError
from ._pantoline import set_program as _set_program
from .result import Result
from .scene import Scene
from .sensitivities import Samples, Sensitivity, sensitivity
from .simulation import Signal, Simulation
from .sweeps import SweepResult, sweep
from .table import Table

# Libraries of FMUs, and the program of isolated ones, are beside the program that the package carries.
_set_program(program())

__all__ = [
    "Checkpoint",
    "Result",
    "RunError",
    "Samples",
    "Scene",
    "SceneError",
    "Sensitivity",
    "Signal",
    "Simulation",
    "SweepError",
    "SweepResult",
    "Table",
    "__version__",
    "fmus",
    "program",
    "sensitivity",
    "sweep",
]
