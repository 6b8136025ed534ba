"""Parameters that an importer sets, and other scenes."""
import pytest
from fmpy.fmi1 import FMICallException


def test_another_contact_stiffness_changes_the_force(line):
    with line.running(**{"contact.stiffness": 2.0 * line.start("contact.stiffness")}) as stiff, line.running() as soft:
        forces = [instance.get("contact[1].force") for instance in (stiff, soft)]
        assert forces[0] > 1.01 * forces[1], forces
        # Each contact is in series with the residual compliance of its wire, the same in both.
        for contact in line.contacts():
            if soft.get(f"{contact}.force") > 0.0:
                force, height = line.references[f"{contact}.force"], line.references["strip[1].z"]
                yields = [1.0 / instance.slave.getDirectionalDerivative([force], [height], [1.0])[0] for instance in (soft, stiff)]
                assert abs((yields[0] - yields[1]) * 2.0 * line.start("contact.stiffness") - 1.0) < 1e-3


def test_start_height_and_position_of_the_line_side_move_the_strip(line):
    height, x = line.start("strip[1].start.height"), line.start("strip[1].start.x")
    with line.running(**{"strip[1].start.height": height + 0.01}) as higher, line.running() as usual:
        assert abs(higher.get("strip[1].z") - height - 0.01) < 1e-12
        assert higher.get("contact[1].force") > usual.get("contact[1].force") + 10.0
    with line.running(**{"strip[1].start.x": x + 7.0, "strip[1].speed": 33.0}) as moved:
        assert abs(moved.get("strip[1].x") - x - 7.0) < 1e-9 and abs(moved.get("contact[1].x") - x - 7.0) < 1e-2
        assert moved.get("strip[1].vx") == 33.0
        moved.slave.doStep(0.0, 0.01)
        assert abs(moved.get("strip[1].x") - x - 7.33) < 1e-9


def test_start_and_speed_of_the_pantograph_side_move_the_strip(pair):
    pantograph = pair[1]
    values = {"start.height": pantograph.start("start.height") - 0.02, "start.force": 90.0, "start.x": 100.0, "speed": 25.0}
    with pantograph.running(**values) as instance:
        assert abs(instance.get("strip[1].z") - values["start.height"]) < 1e-9
        assert abs(instance.get("strip[1].x") - 100.0) < 1e-9 and abs(instance.get("strip[1].vx") - 25.0) < 1e-12
        assert instance.get("contact[1].fz") == -90.0
        instance.slave.doStep(0.0, 0.1)
        assert abs(instance.get("strip[1].x") - 102.5) < 1e-2


def test_a_parameter_reads_back_and_cannot_be_set_between_steps(fmu):
    name = "solver.rho_inf"
    with fmu.running(**{name: 0.95}) as instance:
        assert instance.get(name) == 0.95
        instance.step()
        with pytest.raises(FMICallException):
            instance.set({name: 0.96})


@pytest.mark.parametrize("values", ({"solver.micro_step": -1e-3}, {"solver.rho_inf": 2.0}))
def test_a_parameter_without_sense_is_refused(fmu, values):
    with fmu.instance() as instance, pytest.raises(FMICallException):
        instance.begin(**values)


def test_another_scene_does_what_its_values_do_as_parameters(fmu):
    with fmu.running(**fmu.other()) as instance:
        expected = instance.step(30)
    with fmu.running(scene=str(fmu.data / "other.toml")) as instance:
        assert instance.step(30) == expected
    with fmu.running() as instance:
        assert instance.step(30) != expected


def test_a_parameter_wins_over_the_other_scene(fmu):
    (name, value), = fmu.other().items()
    with fmu.running(**{name: 1.1 * value}) as instance:
        expected = instance.step(10)
    with fmu.running(scene=str(fmu.data / "other.toml"), **{name: 1.1 * value}) as instance:
        assert instance.step(10) == expected


def test_a_scene_that_leaves_its_start_open_starts_like_the_packaged_one(fmu):
    with fmu.running() as instance:
        expected = instance.step(10)
    with fmu.running(scene=str(fmu.data / "plain.toml")) as instance:
        assert instance.step(10) == expected


def test_an_empty_scene_is_the_packaged_one_again(fmu):
    with fmu.running() as instance:
        expected = instance.step(10)
    with fmu.running(scene="") as instance:
        assert instance.step(10) == expected
    with fmu.instance() as instance:
        instance.set({"scene": str(fmu.data / "other.toml")})
        instance.set({"scene": ""})
        instance.begin()
        assert instance.step(10) == expected


@pytest.mark.parametrize("name", ("longer.toml", "missing.toml"))
def test_a_scene_of_another_size_or_without_a_file_is_refused(fmu, name):
    with fmu.instance() as instance, pytest.raises(FMICallException):
        instance.begin(scene=str(fmu.data / name))


def test_a_relative_path_is_refused(fmu):
    with fmu.instance() as instance, pytest.raises(FMICallException):
        instance.begin(scene="other.toml")
