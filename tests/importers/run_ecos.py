"""The pair in ecos, with its fixed-step algorithm."""
import ctypes
import os
import pathlib
import sys
from importlib.metadata import version

# ecos' library is linked to libtbb.so.12, which the wheel `tbb` puts into the environment's own lib folder.
for tbb in sorted(pathlib.Path(sys.prefix, "lib").glob("libtbb.so.12*")):
    ctypes.CDLL(os.fspath(tbb), mode=ctypes.RTLD_GLOBAL)
    break

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

from exchange import CONNECTIONS, FORCE, HEIGHT, Plan, Table


def main():
    plan, path = Plan.given()
    EcosLib.set_log_level("warn")
    with EcosSimulationStructure() as structure:
        for name, fmu in plan.fmus.items():
            structure.add_model(name, fmu)
        for source, sink, name in CONNECTIONS:
            structure.make_real_connection(f"{source}::{name}", f"{sink}::{name}")
        parameters = {
            f"{name}::{parameter}": value for name, values in plan.parameters.items() for parameter, value in values.items()
        }
        if not structure.add_parameter_set("start", parameters):
            raise RuntimeError(f"ecos: {EcosLib.get_last_error()}")
        with EcosSimulation(structure=structure, step_size=plan.step) as simulation:
            if not simulation.init(parameter_set="start"):
                raise RuntimeError(f"ecos: {EcosLib.get_last_error()}")
            table = Table()
            for _ in range(plan.steps):
                simulation.step()
                table.add(simulation.get_real(f"Catenary::{FORCE}"), simulation.get_real(f"Pantograph::{HEIGHT}"))
            table.write(path, "ecos", version("ecospy"))
            simulation.terminate()


main()
