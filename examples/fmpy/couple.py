"""Couples Catenary.fmu and Pantograph.fmu of a folder, the line first in every step."""

import shutil
import statistics
import sys
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, DURATION, FROM = 0.001, 2.0, 1.0  # s
STRIP = [f"strip[1].{name}" for name in ("x", "y", "z", "vx", "vy", "vz", "roll")]
LOAD = {f"contact[1].{name}": f"contact[1].mean_{name}" for name in ("fx", "fy", "fz")} | {"contact[1].y": "contact[1].y"}


class Side:
    """One FMU between its initialisation and its end."""

    def __init__(self, path: Path):
        description = read_model_description(path)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.folder = extract(path)
        identifier = description.coSimulation.modelIdentifier
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=identifier,
            instanceName=description.modelName,
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0, stopTime=DURATION)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def get(self, names):
        return self.fmu.getReal([self.references[name] for name in names])

    def set(self, names, values):
        self.fmu.setReal([self.references[name] for name in names], values)

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def main(folder: Path):
    line, pantograph = Side(folder / "Catenary.fmu"), Side(folder / "Pantograph.fmu")
    forces = []
    for n in range(round(DURATION / STEP)):
        t = n * STEP
        line.set(STRIP, pantograph.get(STRIP))
        line.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=STEP)
        pantograph.set(list(LOAD), line.get(LOAD.values()))
        pantograph.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=STEP)
        if t >= FROM:
            forces += line.get(["contact[1].force"])
    line.end()
    pantograph.end()
    print(f"contact force from {FROM} s to {DURATION} s: mean {statistics.fmean(forces):.1f} N, std {statistics.pstdev(forces):.1f} N")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
