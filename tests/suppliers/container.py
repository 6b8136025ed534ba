"""Packs an FMU into FMPy's container FMU: container.py NESTED.fmu CONTAINER.fmu STEP

The container steps the nested FMU in steps of STEP seconds and has its own binary, names and value references.
"""

import sys
import tempfile
from pathlib import Path

from fmpy import read_model_description
from fmpy.container_fmu import Configuration
from fmpy.container_fmu.cli import create_container_fmu
from fmpy.container_fmu.config import Component
from fmpy.model_description import CoSimulation, ModelDescription, ModelVariable, Unknown

# Names in the container, by those of the nested FMU.
NAMES = {
    "m1": "pantograph.m1",
    "m2": "pantograph.m2",
    "k1": "pantograph.k1",
    "k2": "pantograph.k2",
    "c1": "pantograph.c1",
    "c2": "pantograph.c2",
    "static.force": "pantograph.static_force",
    "reference_height": "pantograph.reference_height",
    "start_height": "pantograph.start_height",
    "F_c": "pantograph.contact_force",
    "z1": "pantograph.height",
    "v1": "pantograph.velocity",
}


def main(nested, container, step):
    inner = read_model_description(nested)
    component = Component(name="pantograph", filename=Path(nested), modelDescription=inner)
    outer = ModelDescription()
    outer.fmiVersion = "2.0"
    outer.modelName = "Container of a pantograph"
    outer.instantiationToken = "{a3b1f0de-52c3-4a2e-8f57-9a51b6d7c1aa}"
    outer.generationTool = "FMPy container FMU"
    outer.coSimulation = CoSimulation()
    outer.coSimulation.modelIdentifier = "container_fmu"
    outer.coSimulation.canHandleVariableCommunicationStepSize = False
    outer.coSimulation.fixedInternalStepSize = step
    outer.unitDefinitions = inner.unitDefinitions
    # The binary takes value reference 0 for the time, and i for entry i - 1 of its list of variables.
    time = ModelVariable(type="Real", name="time")
    time.causality, time.variability = "independent", "continuous"
    outer.modelVariables.append(time)
    mappings = {}
    for variable in inner.modelVariables:
        if variable.name not in NAMES:
            continue
        own = ModelVariable(type="Real", name=NAMES[variable.name])
        own.causality, own.variability = variable.causality, variable.variability
        own.start, own.initial = variable.start, variable.initial
        own.unit, own.description = variable.unit, variable.description
        outer.modelVariables.append(own)
        mappings[own] = [(component, variable)]
    unknown = [Unknown(variable=v) for v in outer.modelVariables if v.causality == "output"]
    outer.outputs = outer.initialUnknowns = unknown
    configuration = Configuration(
        parallelDoStep=False,
        modelDescription=outer,
        components=[component],
        connections=[],
        variableMappings=mappings,
    )
    with tempfile.TemporaryDirectory() as folder:
        unzipped = Path(folder) / "unzipped"
        unzipped.mkdir()
        create_container_fmu(configuration, unzipped, Path(container))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]))
