"""The FMUs do what the core does, to rounding."""
import numpy
from fmpy import simulate_fmu

TOLERANCE = 1e-12  # inputs are read without rounding: room for a few operations


def compare(names, found, expected):
    for name in names:
        a, b = numpy.array(found[name], dtype=float), numpy.array(expected.column(name))
        assert a.shape == b.shape and numpy.isfinite(a).all(), name
        worst = numpy.abs(a - b).max()
        assert worst <= TOLERANCE * max(1.0, numpy.abs(b).max()), f"{name}: differs by {worst}"


def test_simulate_fmu_gives_the_trajectory_of_the_core(fmu):
    given, expected = fmu.table("plain", "inputs"), fmu.table("plain", "outputs")
    signals = numpy.array([tuple(row) for row in given.rows], dtype=[(name, float) for name in given.names])
    names = expected.names[1:]
    times = given.column("time")
    result = simulate_fmu(
        fmu.folder,
        model_description=fmu.description,
        stop_time=times[-1],
        output_interval=times[1],
        input=signals,
        output=names,
    )
    assert list(result["time"]) == times
    compare(names, result, expected)
    if fmu.kind == "Catenary":
        force = result["contact[1].force"]
        assert force.min() > 20.0, "the strip is in contact"
        assert numpy.ptp(force) > 20.0 and result["contact[1].closed"].all()


def test_input_derivatives_of_three_orders_give_the_trajectory_of_the_core(fmu):
    given, expected = fmu.table("derivatives", "inputs"), fmu.table("derivatives", "outputs")
    times = given.column("time")
    references = [fmu.references[name] for name in fmu.inputs]
    values = numpy.array([given.column(name) for name in fmu.inputs]).T
    rates = [numpy.array([given.column(f"{name}|{order}") for name in fmu.inputs]).T for order in (1, 2, 3)]
    names = [name for name in expected.names[1:] if fmu.variables[name].type == "Real"]
    found = {name: [] for name in names}
    with fmu.instance() as instance:
        slave = instance.slave
        slave.setupExperiment(startTime=0.0, stopTime=times[-1])
        slave.enterInitializationMode()
        slave.setReal(references, list(values[0]))
        slave.exitInitializationMode()
        for n, t in enumerate(times):
            for name, value in zip(names, instance.get(*names)):
                found[name].append(value)
            if n + 1 == len(times):
                break
            slave.setReal(references, list(values[n]))
            for order in (1, 2, 3):
                slave.setRealInputDerivatives(references, [order] * len(references), list(rates[order - 1][n]))
            slave.doStep(t, times[n + 1] - t)
            # The value reached inside the step is kept.
            reached = numpy.array(slave.getReal(references))
            assert numpy.allclose(reached, values[n + 1], rtol=0.0, atol=1e-5), "a cubic misses by 40 N (8 h)^4 / 24"
    compare(names, found, expected)


def test_a_strip_that_is_set_once_follows_its_velocity_or_is_held(line):
    for follow in (True, False):
        with line.instance() as instance:
            instance.begin(**{"inputs.follow_velocity": follow})
            x, height = instance.get("strip[1].x", "strip[1].z")
            instance.set({"strip[1].vx": 50.0, "strip[1].vz": 0.1})
            for n in range(10):
                instance.slave.doStep(n * 2e-3, 2e-3)
            moved, risen, at = instance.get("strip[1].x", "strip[1].z", "contact[1].x")
            expected = (1.0, 2e-3) if follow else (0.0, 0.0)
            assert abs(moved - x - expected[0]) < 1e-9 and abs(risen - height - expected[1]) < 1e-9
            assert abs(at - moved) < 1e-2, "the contact point is where the strip is"
            # A value that is set later replaces the one followed.
            instance.set({"strip[1].x": x})
            assert instance.get("strip[1].x") == x


def test_output_derivatives_are_slopes_of_the_outputs(fmu):
    names = ["contact[1].force", "contact[1].gap", "support[2].uplift"] if fmu.kind == "Catenary" else ["strip[1].z", "strip[1].vz"]
    references = [fmu.references[name] for name in names]
    with fmu.running() as instance:
        instance.step(50)
        # Inputs that go on without a kink: held inputs have no slope inside a step.
        slopes = numpy.array(instance.slave.getRealOutputDerivatives(references, [1] * len(names)))
        assert numpy.isfinite(slopes).all()
        beyond = instance.slave.getRealOutputDerivatives(references, [4] * len(names))
        assert list(beyond) == [0.0] * len(names), "an order that is not available is 0"
        if fmu.kind == "Pantograph":
            assert slopes[0] == instance.get("strip[1].vz")
