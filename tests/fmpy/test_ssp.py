"""The exported system structures in FMPy: valid against the schemas of SSP 1.0, and run by its simple loop."""
import pathlib
import zipfile

import numpy
import pytest
from fmpy.ssp import simulation
from fmpy.ssp.ssd import Parameter, ParameterSet, read_ssd, read_ssv, validate_tree
from lxml import etree

from driver import SCENES, Table


@pytest.fixture(params=SCENES)
def exported(request):
    return pathlib.Path(request.config.getoption("--data")) / request.param / "system.ssp"


def test_the_system_structure_is_valid_and_complete(exported):
    description = read_ssd(str(exported), validate=True)
    assert description.version == "1.0"
    names = {component.name: component for component in description.system.elements}
    assert set(names) == {"Catenary", "Pantograph"}
    # Every connected input of the pair, and nothing twice.
    ends = [(connection.endElement, connection.endConnector) for connection in description.system.connections]
    motion = {("Catenary", f"strip[1].{name}") for name in ("x", "y", "z", "vx", "vy", "vz", "roll")}
    load = {("Pantograph", f"contact[1].{name}") for name in ("fx", "fy", "fz", "y")}
    assert len(ends) == len(set(ends)) and set(ends) == motion | load
    for component in names.values():
        bound = [value for binding in component.parameterBindings for value in binding.parameterValues]
        assert "solver.micro_step" in {parameter.name for values in bound for parameter in values.parameters}
    start = {parameter.name for parameter in read_ssv(str(exported), "resources/Pantograph.ssv").parameters}
    assert {"start.height", "start.force", "start.x", "speed"} <= start


def test_all_files_are_valid(exported):
    with zipfile.ZipFile(exported) as archive:
        for name in archive.namelist():
            schema = {".ssd": "SystemStructureDescription.xsd", ".ssv": "SystemStructureParameterValues.xsd"}.get(name[-4:])
            if schema:
                validate_tree(etree.fromstring(archive.read(name)), schema)


def test_the_loop_of_fmpy_gives_the_same_force_as_the_master(exported, monkeypatch):
    instantiate = simulation.instantiate_fmu

    def started(component, *arguments):
        # The loop starts with zeros at all connectors; here with the outputs after initialisation.
        instantiate(component, *arguments)
        for connector in component.connectors:
            connector.value = simulation.get_value(component, connector.name)

    monkeypatch.setattr(simulation, "instantiate_fmu", started)
    expected = Table(exported.parent / "system.jacobi.csv")
    times, forces = (numpy.array(expected.column(name)) for name in ("time", "force"))
    # The strip is held over a step, as the master does without extrapolation.
    held = ParameterSet(parameters=[Parameter(name="Catenary.inputs.follow_velocity", type="Boolean", value=False)])
    found = simulation.simulate_ssp(str(exported), stop_time=times[-1] - 0.5e-3, step_size=1e-3, parameter_set=held)
    found = found["Catenary.contact[1].force"]
    assert len(found) == len(forces) - 1, "a row after each step"
    assert forces.std() > 1.0, "the force moves"
    assert numpy.abs(found - forces[1:]).max() < 1e-6 * forces.std(), numpy.abs(found - forces[1:]).max()
