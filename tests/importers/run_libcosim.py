"""The pair in libcosim, with its fixed-step algorithm."""
from importlib.metadata import version

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

from exchange import CONNECTIONS, FORCE, HEIGHT, Description, Plan, Table


def check(result, what):
    """libcosim's C functions return 0 or true for success, by function."""
    if not result:
        raise RuntimeError(f"libcosim: {what} failed")


def main():
    plan, path = Plan.given()
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(plan.nanoseconds)
    references = {name: Description(fmu) for name, fmu in plan.fmus.items()}
    slaves = {}
    for name, fmu in plan.fmus.items():
        slave = CosimLocalSlave(fmu_path=fmu, instance_name=name)
        slaves[name] = execution.add_local_slave(slave)
        check(slaves[name] >= 0, f"adding {fmu}")
        for parameter, value in plan.parameters[name].items():
            initial = execution.boolean_initial_value if isinstance(value, bool) else execution.real_initial_value
            check(initial(slaves[name], references[name][parameter], value), parameter)
    for source, sink, name in CONNECTIONS:
        result = execution.connect_real_variables(
            slaves[source], references[source][name], slaves[sink], references[sink][name]
        )
        check(result == 0, f"connecting {name}")
    recorded = (slaves["Catenary"], references["Catenary"][FORCE]), (slaves["Pantograph"], references["Pantograph"][HEIGHT])
    observer = CosimObserver.create_last_value()
    check(execution.add_observer(observer), "observing")
    table = Table()
    for n in range(plan.steps):
        check(execution.step(), f"step {n}")
        table.add(*(observer.last_real_values(slave, [reference])[0] for slave, reference in recorded))
    table.write(path, "libcosim", version("libcosimpy"))


main()
