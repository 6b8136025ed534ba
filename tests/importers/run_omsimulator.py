"""The pair in OMSimulator, with its fixed-step master (`oms_ma`).

OMSimulator updates the inputs in the order of the dependencies, as `run_fmpy.py --propagate` and unlike
`coupling.algorithm = "jacobi"`: the pantograph's strip first, then the line's force at that strip.
"""
import tempfile

import OMSimulator
from OMSimulator import SSP, CRef

from exchange import CONNECTIONS, FORCE, HEIGHT, Plan, Table


def main():
    plan, path = Plan.given()
    model = SSP()
    for name, fmu in plan.fmus.items():
        model.addResource(fmu, new_name=f"resources/{name}.fmu")
        component = model.addComponent(CRef("default", name), f"resources/{name}.fmu")
        for parameter, value in plan.parameters[name].items():
            component.setValue(parameter, value)
    for source, sink, name in CONNECTIONS:
        model.addConnection(CRef("default", source, name), CRef("default", sink, name))
    model.newSolver({"name": "fixed", "method": "oms_ma", "fixedStepSize": plan.step})
    for name in plan.fmus:
        model.setSolver(CRef("default", name), "fixed")
    with tempfile.TemporaryDirectory() as folder:
        model.export(f"{folder}/pair.ssp")
        running = model.instantiate()
        running.setResultFile("")
        running.setStopTime(plan.steps * plan.step)
        running.setFixedStepSize(plan.step)
        running.initialize()
        table = Table()
        for n in range(plan.steps):
            running.stepUntil((n + 1) * plan.step)
            table.add(running.getValue(CRef("default", "Catenary", FORCE)), running.getValue(CRef("default", "Pantograph", HEIGHT)))
        table.write(path, "OMSimulator", OMSimulator.version)
        running.terminate()
        running.delete()


main()
