"""Steps, kept states, signals, memory."""

from __future__ import annotations

import copy
import gc
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pantoline

#: Growth of the memory that is no leak, bytes: what allocators keep.
ROOM = 4_000_000


def steps(simulation: pantoline.Simulation, count: int, signal: str = "contact[1].force") -> bytes:
    """Values of a signal after each of some steps, bit for bit."""
    values = []
    for _ in range(count):
        simulation.step()
        values.append(simulation[signal])
    return np.array(values).tobytes()


def test_steps_have_the_bits_of_the_run(scene: pantoline.Scene) -> None:
    result = scene.run()
    simulation = pantoline.Simulation(scene)
    assert simulation.time == 0.0 and simulation.step_length == 0.001
    for name in ("contact[1].force", "strip[1].z", "contact[1].wire.z"):
        simulation.reset()
        assert simulation[name] == result[name][0]
        assert steps(simulation, 200, name) == result[name][1:201].tobytes(), name
    assert simulation.time == pytest.approx(0.2)


def test_a_kept_state_goes_on_bit_for_bit(scene: pantoline.Scene) -> None:
    simulation = pantoline.Simulation(scene)
    simulation.step(30)
    kept = simulation.save()
    expected = steps(simulation, 50)
    simulation.restore(kept)
    assert steps(simulation, 50) == expected
    other = pantoline.Simulation(scene)
    other.restore(pickle.loads(pickle.dumps(kept)))
    assert other.time == pytest.approx(30 * other.step_length)
    assert steps(other, 50) == expected
    simulation.reset()
    simulation.step(30)
    assert steps(simulation, 50) == expected


def test_signals_are_read_and_set(scene: pantoline.Scene) -> None:
    simulation = pantoline.Simulation(scene)
    force = simulation.signals["contact[1].force"]
    assert (force.unit, force.settable) == ("N", False)
    assert all(signal.description for signal in simulation.signals.values())
    assert simulation.signals["pantograph[1].uplift_force"].settable
    assert simulation["pantograph[1].uplift_force"] == scene["pantograph[1].static_force"]
    kept = simulation.save()
    simulation.step(100)
    plain = simulation["contact[1].force"]
    simulation.restore(kept)
    simulation["pantograph[1].uplift_force"] += 50.0
    simulation.step(100)
    assert simulation["contact[1].force"] > plain + 1.0
    simulation.reset()
    assert simulation["pantograph[1].uplift_force"] == scene["pantograph[1].static_force"]
    with pytest.raises(ValueError, match="cannot be set"):
        simulation["contact[1].force"] = 1.0
    with pytest.raises(ValueError, match="must be a finite number"):
        simulation["pantograph[1].uplift_force"] = float("nan")
    value: Any
    for value in (None, "1", [1.0]):
        with pytest.raises(TypeError, match=r"pantograph\[1\].uplift_force = .*: must be a number, in N"):
            simulation["pantograph[1].uplift_force"] = value
    nearest = r'contact\[1\].forc: unknown name, did you mean "contact\[1\].force"\?'
    with pytest.raises(KeyError, match=nearest):
        simulation["contact[1].forc"]
    with pytest.raises(KeyError, match=nearest):
        simulation["contact[1].forc"] = 1.0


def test_a_number_of_steps_that_is_none_is_refused(tiny: pantoline.Scene) -> None:
    simulation = pantoline.Simulation(tiny)
    with pytest.raises(ValueError, match="n = -1: must be a whole number from 0 on"):
        simulation.step(-1)
    count: Any = 1.5
    with pytest.raises(TypeError, match="n = 1.5: must be a whole number from 0 on"):
        simulation.step(count)
    assert simulation.time == simulation.step(0) == 0.0


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickle.dumps])
def test_a_simulation_is_not_copied_and_says_how_its_state_is(
    copied: Callable[[object], object], tiny: pantoline.Scene
) -> None:
    with pytest.raises(TypeError, match=r"cannot be copied or pickled: keep its state with save\(\)"):
        copied(pantoline.Simulation(tiny))


def test_bytes_of_a_state_that_were_changed_are_refused(tiny: pantoline.Scene) -> None:
    whole = pantoline.Simulation(tiny).save().to_bytes()
    assert pantoline.Checkpoint(whole).to_bytes() == whole
    for place in range(0, len(whole), max(1, len(whole) // 97)):
        changed = bytearray(whole)
        changed[place] ^= 1
        with pytest.raises(ValueError, match="not the bytes of a kept state"):
            pantoline.Checkpoint(bytes(changed))
    for cut in (whole[:-1], whole + b"0"):
        with pytest.raises(ValueError, match="not the bytes of a kept state"):
            pantoline.Checkpoint(cut)


def test_wind_is_set_where_the_scene_has_air(scene: pantoline.Scene) -> None:
    def settable() -> list[str]:
        signals = pantoline.Simulation(scene).signals
        return [name for name, signal in signals.items() if signal.settable and ".wind." in name]

    assert settable() == []
    scene["wind"] = {"speed": 10.0, "yaw_deg": 0.0, "air_density": 1.2, "pantograph": {"uplift": 0.01}}
    assert settable() == [f"pantograph[1].wind.v{axis}" for axis in "xyz"]
    simulation = pantoline.Simulation(scene)
    plain = steps(simulation, 50)
    assert plain == scene.copy().run()["contact[1].force"][1:51].tobytes()
    simulation.reset()
    simulation["pantograph[1].wind.vx"] = -20.0
    assert steps(simulation, 50) != plain
    simulation.reset()
    assert simulation["pantograph[1].wind.vx"] == 0.0 and steps(simulation, 50) == plain


def test_the_end_of_the_run_ends_the_steps(tiny: pantoline.Scene) -> None:
    simulation = pantoline.Simulation(tiny)
    simulation.step(simulation.steps_left)
    assert simulation.time == 0.1
    with pytest.raises(pantoline.RunError, match="is the end of the run"):
        simulation.step()
    simulation.reset()
    assert simulation.time == 0.0


def test_a_state_of_another_scene_is_refused(scene: pantoline.Scene, tiny: pantoline.Scene) -> None:
    kept = pantoline.Simulation(tiny).save()
    with pytest.raises(ValueError, match="of another system"):
        pantoline.Simulation(scene).restore(kept)
    with pytest.raises(ValueError, match="not the bytes"):
        pantoline.Checkpoint(b"")


def memory() -> int:
    """Resident memory of this process, bytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def flat(once: Callable[[], object], times: int) -> None:
    """Asserts that neither memory nor open files grow with calls."""
    for _ in range(times // 10):
        once()
    gc.collect()
    before, files = memory(), len(os.listdir("/proc/self/fd"))
    for _ in range(times):
        once()
    gc.collect()
    assert memory() - before < ROOM
    assert len(os.listdir("/proc/self/fd")) == files


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read as Linux says it")
def test_ten_thousand_resets_keep_memory_and_files_flat(tiny: pantoline.Scene) -> None:
    simulation = pantoline.Simulation(tiny)

    def once() -> None:
        simulation.step()
        simulation.reset()

    flat(once, 10_000)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read as Linux says it")
def test_simulations_that_are_made_and_freed_keep_memory_and_files_flat(tiny: pantoline.Scene) -> None:
    cycles = int(os.environ.get("PANTOLINE_CYCLES", "300"))  # 2000 and more show the same, and take a minute
    flat(lambda: pantoline.Simulation(tiny), cycles)
