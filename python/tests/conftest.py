"""Scenes of the tests."""

from __future__ import annotations

from pathlib import Path

import pytest

import pantoline

TREE = Path(__file__).resolve().parents[2]
EN_300 = TREE / "scenes" / "en50318-300.toml"

#: Half a second on a short, coarse line: the tests are about the package.
SMALL = [
    "catenary.spans=6",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=0.5",
    "run.evaluate={ time = [0.1, 0.5] }",
    "coupling.macro_step=0.001",
]

#: The smallest line that there is, for states and memory.
TINY = [
    "catenary.spans=2",
    "catenary.mesh.elements_per_interval=1",
    "catenary.droppers.positions=[30.0]",
    "run.start_x=30",
    "run.duration=0.1",
    "run.evaluate={ time = [0.0, 0.1] }",
    "model.reduce=planar+linearised",
]


@pytest.fixture
def scene() -> pantoline.Scene:
    return pantoline.Scene.load(EN_300, SMALL)


@pytest.fixture
def tiny() -> pantoline.Scene:
    return pantoline.Scene.load(EN_300, TINY)
