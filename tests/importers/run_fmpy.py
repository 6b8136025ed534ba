"""The pair in FMPy, call by call.

With `--propagate` the force on the pantograph is read after the line has received the new strip, as in tools that
follow the dependencies of the model descriptions.
"""
import sys
import tempfile

import fmpy
from fmpy.fmi2 import FMU2Slave

from exchange import FORCE, HEIGHT, LOAD, STRIP, Plan, Table


class Side:
    """An FMU, its calls by names of variables."""

    def __init__(self, name, path):
        self.description = fmpy.read_model_description(path)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.folder = tempfile.TemporaryDirectory()
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(path, self.folder.name),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        # FMPy prints whatever the FMU logs; the harness expects nothing.
        self.slave.instantiate(loggingOn=True)

    def initialise(self, parameters):
        self.slave.setupExperiment(startTime=0.0)
        setters = {"Real": self.slave.setReal, "Boolean": self.slave.setBoolean}
        for name, value in parameters.items():
            setters[self.variables[name].type]([self.variables[name].valueReference], [value])
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def references(self, names):
        return [self.variables[name].valueReference for name in names]

    def end(self):
        self.slave.terminate()
        self.slave.freeInstance()


def main():
    propagate = "--propagate" in sys.argv
    plan, path = Plan.given()
    line, pantograph = (Side(name, plan.fmus[name]) for name in ("Catenary", "Pantograph"))
    for side, name in ((line, "Catenary"), (pantograph, "Pantograph")):
        side.initialise(plan.parameters[name])
    strip_from, strip_to = pantograph.references(STRIP), line.references(STRIP)
    load_from, load_to = line.references(LOAD), pantograph.references(LOAD)
    recorded = line.references([FORCE]), pantograph.references([HEIGHT])
    table = Table()
    for n in range(plan.steps):
        strip = pantograph.slave.getReal(strip_from)
        load = line.slave.getReal(load_from)
        line.slave.setReal(strip_to, strip)
        if propagate:
            load = line.slave.getReal(load_from)
        pantograph.slave.setReal(load_to, load)
        line.slave.doStep(n * plan.step, plan.step)
        pantograph.slave.doStep(n * plan.step, plan.step)
        table.add(line.slave.getReal(recorded[0])[0], pantograph.slave.getReal(recorded[1])[0])
    table.write(path, "FMPy", fmpy.__version__)
    line.end()
    pantograph.end()


main()
