"""The pair in PyFMI, with its Jacobi master and constant extrapolation."""
import os
import tempfile

import pyfmi
from pyfmi import load_fmu
from pyfmi.master import Master

from exchange import CONNECTIONS, FORCE, HEIGHT, Plan, Table


def main():
    plan, path = Plan.given()
    # PyFMI writes its logs and results to the current directory.
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        models = {}
        for name, fmu in plan.fmus.items():
            models[name] = load_fmu(fmu, kind="CS", log_file_name=f"{name}.txt")
            for parameter, value in plan.parameters[name].items():
                models[name].set(parameter, value)
        connections = [(models[source], name, models[sink], name) for source, sink, name in CONNECTIONS]
        master = Master(list(models.values()), connections)
        options = master.simulate_options()
        options["step_size"] = plan.step
        options["extrapolation_order"] = 0
        options["linear_correction"] = False
        options["result_handling"] = "memory"
        table = Table()
        results = master.simulate(0.0, plan.steps * plan.step, options=options)
        # The first point is the start.
        forces, heights = results[models["Catenary"]][FORCE][1:], results[models["Pantograph"]][HEIGHT][1:]
        for force, height in zip(forces, heights):
            table.add(force, height)
        os.chdir(os.path.dirname(path))
        table.write(path, "PyFMI", pyfmi.__version__)


main()
