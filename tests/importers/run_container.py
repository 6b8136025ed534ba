"""The pair in one container FMU that FMPy makes, run in FMPy."""
import pathlib
import tempfile

import attrs
import fmpy
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component, Configuration, Connection
from fmpy.fmi2 import FMU2Slave
from fmpy.model_description import CoSimulation, DefaultExperiment, ModelDescription, ModelVariable, Unknown

from exchange import CONNECTIONS, FORCE, HEIGHT, Plan, Table


def literal(value):
    return str(value).lower() if isinstance(value, bool) else repr(value)


class Container:
    """Content of the container, and its visible variables."""

    def __init__(self, plan):
        self.components = {}
        self.variables = {}
        for name, path in plan.fmus.items():
            description = fmpy.read_model_description(path)
            self.components[name] = Component(name=name, filename=pathlib.Path(path), modelDescription=description)
            self.variables[name] = {variable.name: variable for variable in description.modelVariables}
        self.mappings = {}
        for name, values in plan.parameters.items():
            for parameter, value in values.items():
                self.show(name, parameter, causality="parameter", variability="fixed", start=literal(value))
        for name, output in (("Catenary", FORCE), ("Pantograph", HEIGHT)):
            self.show(name, output, causality="output", variability="continuous", initial="calculated")
        self.step = plan.step

    def show(self, name, inner, **attributes):
        variable = self.variables[name][inner]
        outer = ModelVariable(name=f"{name}.{inner}", type=variable.type, **attributes)
        self.mappings[outer] = [(self.components[name], variable)]

    def connections(self):
        # The container transfers one group after the other: the force is read before the line gets the new strip.
        for source, sink in dict.fromkeys((source, sink) for source, sink, _ in reversed(CONNECTIONS)):
            names = [name for a, b, name in CONNECTIONS if (a, b) == (source, sink)]
            # FMPy 0.3.32 writes the FMI 2 name of a connection's type; its container knows the names of FMI 3 only.
            ends = {name: [attrs.evolve(self.variables[name][inner], type="Float64") for inner in names] for name in (source, sink)}
            yield Connection(
                startElement=self.components[source],
                startConnectors=ends[source],
                endElement=self.components[sink],
                endConnectors=ends[sink],
            )

    def write(self, path):
        # To the container, reference 0 is the time.
        time = ModelVariable(name="time", type="Real", causality="independent", variability="continuous")
        variables = [time, *self.mappings]
        outputs = [Unknown(variable=variable) for variable in variables if variable.causality == "output"]
        description = ModelDescription(
            fmiVersion="2.0",
            modelName="Container",
            instantiationToken="{pair}",
            variableNamingConvention="flat",
            coSimulation=CoSimulation(modelIdentifier="container_fmu", fixedInternalStepSize=self.step),
            defaultExperiment=DefaultExperiment(stepSize=repr(self.step)),
            modelVariables=variables,
            outputs=outputs,
            initialUnknowns=outputs,
        )
        configuration = Configuration(
            parallelDoStep=False,
            modelDescription=description,
            components=list(self.components.values()),
            connections=list(self.connections()),
            variableMappings=self.mappings,
        )
        create_container_fmu(configuration, pathlib.Path(tempfile.mkdtemp(dir=path.parent)), path)


def main():
    plan, path = Plan.given()
    with tempfile.TemporaryDirectory() as folder:
        fmu = pathlib.Path(folder, "Container.fmu")
        Container(plan).write(fmu)
        description = fmpy.read_model_description(fmu)
        references = {variable.name: variable.valueReference for variable in description.modelVariables}
        recorded = [references[f"Catenary.{FORCE}"], references[f"Pantograph.{HEIGHT}"]]
        container = FMU2Slave(
            guid=description.guid,
            unzipDirectory=fmpy.extract(str(fmu), str(pathlib.Path(folder, "unzipped"))),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="container",
        )
        container.instantiate(loggingOn=False)
        container.setupExperiment(startTime=0.0)
        container.enterInitializationMode()
        container.exitInitializationMode()
        table = Table()
        for n in range(plan.steps):
            container.doStep(n * plan.step, plan.step)
            table.add(*container.getReal(recorded))
        table.write(path, "FMPy container FMU", fmpy.__version__)
        container.terminate()
        container.freeInstance()


main()
