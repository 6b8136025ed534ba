"""Pantograph.fmu with the vehicle of the thesis and its track, alone."""
import math

import numpy
import pytest
from fmpy import simulate_fmu

WHEELS = range(1, 9)
LOADS = [f"wheel[{i}].load" for i in WHEELS]
QUOTIENTS = [f"wheel[{i}].derailment_quotient" for i in WHEELS]
BASE = [f"base.{name}" for name in ("x", "y", "z", "roll", "pitch", "yaw")]
WEIGHT = 43_052.0 * 9.81  # N [Thesis, Table 1]


@pytest.fixture(scope="module")
def carried(opened):
    return opened("vehicle", "Pantograph")


def test_it_runs_alone_from_the_equilibrium_under_the_weight_of_the_vehicle(carried):
    assert set(LOADS + QUOTIENTS + BASE) <= set(carried.outputs)
    found = simulate_fmu(
        carried.folder,
        model_description=carried.description,
        stop_time=1.0,
        output_interval=1e-3,
        output=carried.outputs + ["contact[1].fz"],
    )
    assert len(found["time"]) == 1001
    for name in carried.outputs:
        assert numpy.isfinite(found[name]).all(), name
    loads = numpy.array([found[name] for name in LOADS])
    # Six bodies of 63.04 kg [Thesis, Table 2]; the uplift is an external upward force, the contact force presses down.
    pantograph = 63.04 * 9.81 - found["uplift_force"][0] - found["contact[1].fz"][0]
    print(f"{loads.sum(axis=0)[0]:.2f} N on {loads[:, 0].round(1)}, {loads.sum(axis=0)[-1]:.2f} N in the end")
    # Residuals of statics of 1e-5 N; the traction against the rolling resistance lifts the front by 1e-4 N.
    assert abs(loads.sum(axis=0) - WEIGHT - pantograph).max() < 0.1
    # 52.8 kN each, less the lift of the pantograph behind the middle.
    assert abs(loads / (WEIGHT / 8) - 1).max() < 5e-3
    # The treads stand 1:40 across the track: each wheel presses its rail outward by the slope and by its spin creep.
    quotients = numpy.array([found[name] for name in QUOTIENTS])
    print(f"Y/Q {quotients[:, 0].round(5)}")
    assert (abs(quotients) < 1 / 20).all() and (abs(quotients) > 1e-3).all()
    assert abs(quotients[::2] - quotients[1::2]).max() < 1e-6, "left and right are alike on straight track"
    # At rest in a frame that travels at 200 km/h.
    assert abs(found["base.z"] - found["base.z"][0]).max() < 1e-6
    travelled = found["base.x"] - found["base.x"][0]
    assert abs(travelled - 200 / 3.6 * found["time"]).max() < 1e-6


def test_wheels_feel_what_moves_the_pantograph_and_quotients_stay_finite(carried):
    with carried.running() as instance:
        before = numpy.array(instance.get(*LOADS))
        changes = []
        for _ in range(500):
            outputs = instance.step()
            assert all(math.isfinite(value) for value in outputs)
            changes.append(numpy.array(instance.get(*LOADS)) - before)
    most = abs(numpy.array(changes).sum(axis=1)).max()
    print(f"{most:.2f} N under a contact force that changes by 40 N")
    assert 1.0 < most < 200.0
