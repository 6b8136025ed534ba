"""An FMU in FMPy, and instances of it that are driven with the strip in contact."""
import csv
import itertools
import json
import math
import pathlib

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP = 1e-3
# Scenes whose FMUs are checked.
SCENES = ("en50318", "thesis", "stitched", "twin", "overlap")


class Table:
    """A CSV file of numbers; columns by name."""

    def __init__(self, path):
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.names = rows[0]
        self.rows = [[float(text) for text in row] for row in rows[1:]]

    def column(self, name):
        at = self.names.index(name)
        return [row[at] for row in self.rows]


class Fmu:
    """An unpacked FMU with the trajectory of the core under the same inputs."""

    def __init__(self, data, scene, kind, folder):
        self.kind = kind
        self.data = pathlib.Path(data) / scene
        self.path = self.data / f"{kind}.fmu"
        self.description = read_model_description(self.path)
        self.folder = extract(str(self.path), str(folder))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.references = {name: variable.valueReference for name, variable in self.variables.items()}
        self.inputs = self.of("input")
        self.outputs = self.of("output")
        self.numbers = itertools.count(1)

    def of(self, causality):
        """Names of the real variables of a causality."""
        return [v.name for v in self.description.modelVariables if v.causality == causality and v.type == "Real"]

    def table(self, plan, what):
        return Table(self.data / f"{self.kind}.{plan}.{what}.csv")

    def other(self):
        """Parameters equivalent to the scene `other.toml`."""
        return json.loads((self.data / "other.json").read_text(encoding="utf-8"))[self.kind]

    def start(self, name):
        return float(self.variables[name].start)

    def contacts(self):
        """Contacts of strip 1: with each contact wire, or with the only one."""
        parts = [name.removesuffix(".force") for name in self.outputs if name.startswith("contact[1].wire[") and name.endswith(".force")]
        return parts or ["contact[1]"]

    def instance(self):
        """An instance before its initialisation."""
        return Instance(self)

    def running(self, shift=0.0, **parameters):
        """An instance at its first communication point."""
        instance = Instance(self, shift)
        instance.begin(**parameters)
        return instance


class Instance:
    """An instance; `shift` in m varies its stimulus."""

    def __init__(self, fmu, shift=0.0):
        self.fmu = fmu
        self.shift = shift
        self.count = 0
        self.slave = FMU2Slave(
            guid=fmu.description.guid,
            unzipDirectory=fmu.folder,
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
            instanceName=f"{fmu.kind} {next(fmu.numbers)}",
        )
        self.slave.instantiate(loggingOn=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.slave.freeInstance()

    def begin(self, **parameters):
        """Initialises in the order of FMPy: experiment, parameters, initialisation mode."""
        self.slave.setupExperiment(startTime=0.0, stopTime=10.0)
        self.set(parameters)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.count = 0

    def set(self, values):
        """Sets variables of any type by name."""
        setters = {"Real": self.slave.setReal, "Boolean": self.slave.setBoolean, "String": self.slave.setString}
        for name, value in values.items():
            variable = self.fmu.variables[name]
            setters[variable.type]([variable.valueReference], [value])

    def get(self, *names):
        """Values of real variables by name."""
        values = self.slave.getReal([self.fmu.references[name] for name in names])
        return values if len(names) > 1 else values[0]

    def outputs(self):
        return self.get(*self.fmu.outputs)

    def stimulus(self):
        """Inputs of the coming step: the strip presses with more than 100 N and moves."""
        t = self.count * STEP
        start = self.fmu.start
        if self.fmu.kind == "Catenary":
            return {
                "strip[1].x": start("strip[1].x") + 60.0 * t,
                "strip[1].vx": 60.0,
                "strip[1].z": start("strip[1].z") + 0.002 + self.shift + 0.01 * (1.0 - math.cos(8.0 * t)),
                "strip[1].vz": 0.08 * math.sin(8.0 * t),
            }
        return {"contact[1].fz": start("contact[1].fz") - 1e3 * self.shift - 40.0 * math.sin(8.0 * t)}

    def step(self, count=1):
        """Takes steps under the stimulus; returns all real outputs at the end."""
        for _ in range(count):
            self.set(self.stimulus())
            self.slave.doStep(self.count * STEP, STEP)
            self.count += 1
        return self.outputs()
