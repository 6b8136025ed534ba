"""Steps per second and core of many environments over one line in its modes, at 100 Hz.

Usage: ``python environments.py SCENE [--cases 64] [--threads 1] [--samples 300]``
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import pantoline
from pantoline.gym import ContactForceVectorEnv

#: Drive of 100 Hz on a line in its modes.
KEYS = [
    "pantograph[1].control={ law='given', sample_time=0.01, actuator={ lag=0.005, limit=60 } }",
    "model.reduce=['modal']",
    "catenary.mesh.error_percent=1.0",
]

#: Pantographs that differ from case to case.
VARY = {"pantograph[1].static_force": (100.0, 130.0), "pantograph[1].masses[1]": (6.0, 9.0)}


def main() -> None:
    """Prints set-up, reset and steps of all cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--cases", type=int, default=64)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--samples", type=int, default=300)
    asked = parser.parse_args()

    begin = time.perf_counter()
    scene = pantoline.Scene.load(asked.scene, KEYS)
    env = ContactForceVectorEnv(scene, asked.cases, vary=VARY, seed=0, threads=asked.threads)
    print(f"set-up: {time.perf_counter() - begin:.2f} s, {asked.cases} cases, {asked.threads} threads")
    begin = time.perf_counter()
    env.reset(seed=0)
    print(f"reset: {1e3 * (time.perf_counter() - begin) / asked.cases:.3f} ms per case")
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(asked.samples)]
    begin, begin_cpu = time.perf_counter(), time.process_time()
    for action in actions:
        env.step(np.asarray(action))
    spent, spent_cpu = time.perf_counter() - begin, time.process_time() - begin_cpu
    steps = asked.cases * asked.samples
    print(
        f"steps: {steps / spent:.0f} per second, {steps / spent / asked.threads:.0f} per second and core, "
        f"{steps / spent_cpu:.0f} per second of processor time"
    )


if __name__ == "__main__":
    main()
