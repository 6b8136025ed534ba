"""Largest sensitivity of a PID loop by linear theory: the lumped pantograph of a scene on a wire of one stiffness.

    python3 python/bench/sensitivity.py scenes/thesis-lumped.toml --stiffness 3000 --kp 1 --ki 2

S = 1/(1 + L), with the loop gain L of rule, hold, delay and lag of the drive, and pantograph; a disturbance of the contact force at a frequency
remains with the share |S|. Sampled readings are taken to have no content above half the sampling frequency.
"""

import argparse
import cmath
import math
import tomllib


def force_per_drive(chain: dict, stiffness: float, s: complex) -> complex:
    """Contact force by the force of a drive on the last mass."""
    springs = [k + c * s for k, c in zip(chain["stiffnesses"], chain["dampings"])]
    # From the head down: displacement of each mass for a head that is displaced by 1.
    above, here, link = 0.0, 1.0, stiffness
    for number, (mass, spring) in enumerate(zip(chain["masses"], springs)):
        load = mass * s * s * here + link * (here - above if number else here)
        if number + 1 == len(springs):
            return stiffness / (load + spring * here)
        above, here, link = here, here + load / spring, spring
    raise ValueError("a chain has masses")


def loop_gain(chain: dict, values: argparse.Namespace, frequency: float) -> complex:
    s = 2j * math.pi * frequency
    shift = cmath.exp(-s * values.sample)
    kept = math.exp(-values.sample / values.derivative_lag) if values.derivative_lag else 0.0
    derivative = (1 - kept) * values.kd / values.sample * (1 - shift) / (1 - kept * shift)
    rule = values.kp + values.ki * values.sample / (1 - shift) + derivative
    hold = (1 - shift) / (s * values.sample)
    drive = cmath.exp(-s * values.delay) / (1 + values.lag * s)
    return rule * hold * drive * force_per_drive(chain, values.stiffness, s)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    for name, default in {
        "stiffness": 3000.0,
        "kp": 0.0,
        "ki": 0.0,
        "kd": 0.0,
        "derivative-lag": 0.0,
        "sample": 0.005,
        "delay": 0.001,
        "lag": 0.01,
    }.items():
        parser.add_argument(f"--{name}", type=float, default=default)
    values = parser.parse_args()
    with open(values.scene, "rb") as file:
        chain = tomllib.load(file)["pantograph"][0]
    frequencies = [0.01 * number for number in range(30, 2001)]
    peak, at = max((abs(1 / (1 + loop_gain(chain, values, f))), f) for f in frequencies)
    gain = abs(loop_gain(chain, values, at))
    print(f"largest sensitivity {peak:.2f} at {at:.2f} Hz, where the loop gain is {gain:.2f}")


if __name__ == "__main__":
    main()
