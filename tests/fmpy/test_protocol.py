"""Rollback, serialisation, independence, misuse, and the call orders of other importers."""
import ctypes
import math
import os
import pathlib
import shutil
import subprocess

import numpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from driver import STEP


def test_a_restored_state_repeats_bit_for_bit(fmu):
    with fmu.running() as instance:
        instance.step(30)
        state = instance.slave.getFMUState()
        count, first = instance.count, instance.step(40)
        for _ in range(2):
            instance.slave.setFMUState(state)
            instance.count = count
            assert instance.step(40) == first
        instance.slave.freeFMUState(state)


def test_a_state_saved_by_serialisation_continues_in_a_new_instance(fmu):
    with fmu.running(shift=0.0005) as instance:
        instance.step(30)
        state = instance.slave.getFMUState()
        stored = instance.slave.serializeFMUState(state)
        count, expected = instance.count, instance.step(40)
        instance.slave.freeFMUState(state)
    with fmu.instance() as other:
        other.shift = 0.0005
        state = other.slave.deSerializeFMUstate(stored)
        other.slave.setFMUState(state)
        other.slave.freeFMUState(state)
        other.count = count
        assert other.step(40) == expected
        # A damaged byte in the middle is found.
        damaged = bytearray(stored)
        damaged[len(damaged) // 2] ^= 1
        with pytest.raises(FMICallException):
            other.slave.deSerializeFMUstate(bytes(damaged))


def test_two_interleaved_instances_behave_as_if_alone(fmu):
    alone = []
    for shift in (0.0, 0.001):
        with fmu.running(shift) as instance:
            alone.append(instance.step(100))
    with fmu.running(0.0) as one, fmu.running(0.001) as two:
        for _ in range(20):
            together = [one.step(5), two.step(5)]
    assert together == alone and together[0] != together[1]


def test_after_reset_an_instance_is_as_new(fmu):
    with fmu.running() as instance:
        first = instance.step(50)
        instance.slave.reset()
        instance.begin()
        assert instance.step(50) == first


def test_directional_derivatives_equal_difference_quotients(fmu):
    outputs = [fmu.references[name] for name in fmu.outputs]
    with fmu.running() as instance:
        instance.step(50)
        slave = instance.slave
        state = slave.getFMUState()
        for name in fmu.inputs:
            known = [fmu.references[name]]
            found = numpy.array(slave.getDirectionalDerivative(outputs, known, [1.0]))
            value, h = instance.get(name), 1e-6
            sides = []
            for sign in (1, -1):
                slave.setReal(known, [value + sign * h])
                sides.append(numpy.array(slave.getReal(outputs)))
                slave.setFMUState(state)
            difference = (sides[0] - sides[1]) / (2 * h)
            error = numpy.abs(found - difference) / numpy.maximum(1.0, numpy.abs(difference))
            worst = int(error.argmax())
            # The change of the sliding speed with the bend of the wire is left out.
            assert error[worst] < 3e-5, f"{fmu.outputs[worst]} by {name}: {found[worst]}, differences give {difference[worst]}"
            # The derivative is linear in the direction.
            assert numpy.allclose(slave.getDirectionalDerivative(outputs, known, [-2.5]), -2.5 * found, rtol=1e-14, atol=0.0)
            depends = {fmu.outputs[k] for k in range(len(outputs)) if difference[k] != 0.0}
            for unknown in fmu.description.outputs:
                if unknown.variable.name in depends:
                    named = [variable.name for variable in unknown.dependencies]
                    assert name in named, f"{unknown.variable.name} depends on {name}, its description does not say so"
        slave.freeFMUState(state)
        if fmu.kind == "Catenary":
            touched = [contact for contact in fmu.contacts() if instance.get(f"{contact}.force") > 0.0]
            assert touched
            for contact in touched:
                force, gap = (fmu.references[f"{contact}.{name}"] for name in ("force", "gap"))
                stiffness, closing = slave.getDirectionalDerivative([force, gap], [fmu.references["strip[1].z"]], [1.0])
                # The contact has the share of the motion that the residual compliance leaves.
                share = stiffness / fmu.start("contact.stiffness")
                assert 0.3 < share < 1.0 + 1e-3 and abs(closing + share) < 1e-3
        else:
            motion = [fmu.references[f"strip[1].{name}"] for name in ("z", "vz")]
            assert slave.getDirectionalDerivative(motion, [fmu.references["contact[1].fz"]], [1.0]) == [0.0, 0.0]


def refused(call, *arguments):
    with pytest.raises(FMICallException):
        call(*arguments)


@pytest.mark.parametrize("value", (math.nan, math.inf, -math.inf))
def test_an_input_that_is_no_number_is_refused_and_reset_helps(fmu, value):
    with fmu.running() as instance:
        expected = instance.step(20)
        refused(instance.slave.setReal, [fmu.references[fmu.inputs[0]]], [value])
        refused(instance.slave.doStep, instance.count * STEP, STEP)
        instance.slave.reset()
        instance.begin()
        assert instance.step(20) == expected


def test_steps_and_references_that_make_no_sense_are_refused(fmu):
    for time, step in ((0.0, -STEP), (0.0, 0.0), (0.0, math.nan), (0.5, STEP), (math.inf, STEP), (0.0, 11.0)):
        with fmu.running() as instance:
            refused(instance.slave.doStep, time, step)
    with fmu.running() as instance:
        refused(instance.slave.getReal, [4_294_967])
        refused(instance.slave.getInteger, [fmu.references[fmu.outputs[0]]])
        instance.step()  # a refused question has no consequence
        refused(instance.slave.setReal, [fmu.references[fmu.outputs[0]]], [1.0])


def test_a_wrong_guid_is_refused(fmu):
    slave = FMU2Slave(guid="{wrong}", unzipDirectory=fmu.folder, modelIdentifier=fmu.kind, instanceName="wrong")
    with pytest.raises(Exception):
        slave.instantiate()


def tuned(fmu):
    """A parameter with another value than its start."""
    return fmu.other()


def run_like_fmpy(fmu, values):
    with fmu.instance() as instance:
        instance.slave.setupExperiment(tolerance=1e-6, startTime=0.0, stopTime=1.0)
        instance.set(values)
        instance.slave.enterInitializationMode()
        instance.set(instance.stimulus())
        instance.slave.exitInitializationMode()
        return instance.step(30)


def run_like_libcosim(fmu, values):
    """Parameters before the experiment and again in initialisation mode; outputs read and inputs set by turns there."""
    with fmu.instance() as instance:
        instance.set(values)
        instance.slave.setupExperiment(startTime=0.0, stopTime=1.0)
        instance.slave.enterInitializationMode()
        instance.set(values)
        for _ in range(2):
            for name in fmu.outputs:
                instance.get(name)
            instance.set(instance.stimulus())
        instance.slave.exitInitializationMode()
        instance.outputs()
        return instance.step(30)


def run_like_ecos(fmu, values):
    """Sets all values in initialisation mode, and reads outputs after every set."""
    with fmu.instance() as instance:
        instance.slave.setupExperiment(startTime=0.0)
        instance.slave.enterInitializationMode()
        instance.outputs()
        instance.set(values)
        instance.set(instance.stimulus())
        instance.outputs()
        instance.slave.exitInitializationMode()
        for _ in range(30):
            instance.set(instance.stimulus())
            instance.outputs()
            instance.slave.doStep(instance.count * STEP, STEP)
            instance.count += 1
        return instance.outputs()


def run_like_omsimulator(fmu, values):
    """A stop time that is none, and each step taken twice from a state that was announced as never needed."""
    with fmu.instance() as instance:
        slave = instance.slave
        instance.set(values)
        slave.fmi2SetupExperiment(slave.component, 0, 0.0, 0.0, 0, 0.01)
        slave.enterInitializationMode()
        instance.set(instance.stimulus())
        slave.exitInitializationMode()
        for _ in range(30):
            state = slave.getFMUState()
            instance.step()
            instance.count -= 1
            slave.setFMUState(state)
            slave.freeFMUState(state)
            instance.step()
        return instance.outputs()


def run_like_a_master_that_adds_up_steps(fmu, values):
    """Communication points that are sums and therefore differ by rounding from the earlier ones."""
    with fmu.instance() as instance:
        instance.begin(**values)
        time = 0.0
        for _ in range(30):
            instance.set(instance.stimulus())
            instance.slave.doStep(time, STEP + 2e-19 * instance.count)
            time += STEP
            instance.count += 1
        return instance.outputs()


def test_the_call_orders_of_other_importers_give_the_same(fmu):
    values = tuned(fmu)
    expected = run_like_fmpy(fmu, values)
    assert run_like_libcosim(fmu, values) == expected
    assert run_like_ecos(fmu, values) == expected
    assert run_like_omsimulator(fmu, values) == expected
    summed = run_like_a_master_that_adds_up_steps(fmu, values)
    for name, a, b in zip(fmu.outputs, summed, expected):
        assert abs(a - b) <= 1e-6 * max(1.0, abs(b)), name
    untuned = run_like_fmpy(fmu, {})
    assert untuned != expected, "the parameters matter"


def test_inputs_are_part_of_a_saved_state(fmu):
    with fmu.running() as instance:
        instance.step(10)
        instance.set(instance.stimulus())
        before = instance.get(*fmu.inputs)
        state = instance.slave.getFMUState()
        expected = (instance.slave.doStep(instance.count * STEP, STEP), instance.outputs())[1]
        instance.set({fmu.inputs[2]: before[2] + 0.001})
        instance.slave.setFMUState(state)
        assert instance.get(*fmu.inputs) == before
        instance.slave.doStep(instance.count * STEP, STEP)
        assert instance.outputs() == expected
        instance.slave.freeFMUState(state)


def test_a_missing_resource_location_means_the_folder_beside_the_library(fmu):
    """Container FMUs pass none."""
    with fmu.running() as instance:
        expected = instance.step(10)
    with fmu.instance() as instance:
        slave = instance.slave
        slave.fmi2FreeInstance(slave.component)
        slave.component = slave.fmi2Instantiate(
            b"nothing", 1, fmu.description.guid.encode(), None, ctypes.byref(slave.callbacks), 0, 0
        )
        assert slave.component
        instance.begin()
        assert instance.step(10) == expected


def test_nothing_of_the_process_changes(fmu):
    before = (os.getcwd(), dict(os.environ))
    with fmu.running() as instance:
        instance.step(5)
    assert (os.getcwd(), dict(os.environ)) == before


def test_the_archive_needs_its_resources_only_until_it_is_initialised(fmu, tmp_path):
    copy = pathlib.Path(shutil.copytree(fmu.folder, tmp_path / "copy"))
    slave = FMU2Slave(guid=fmu.description.guid, unzipDirectory=str(copy), modelIdentifier=fmu.kind, instanceName="bare")
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    shutil.rmtree(copy / "resources")
    slave.doStep(0.0, STEP)
    slave.reset()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, STEP)
    slave.freeInstance()


def test_the_library_exports_the_functions_of_the_standard_only(fmu):
    library = next(pathlib.Path(fmu.folder, "binaries").glob("*/*"))
    listing = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    names = [line.split()[-1] for line in listing.splitlines()]
    assert len(names) == 34 and all(name.startswith("fmi2") for name in names), names
