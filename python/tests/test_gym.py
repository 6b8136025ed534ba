"""Environments of Gymnasium: their checker, seeds, a rule that lowers the variation of the force, and many at once."""

from __future__ import annotations

import subprocess
import sys
import warnings

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import pantoline
from conftest import EN_300, TINY
from pantoline.gym import ContactForceEnv, ContactForceVectorEnv

GIVEN = "pantograph[1].control={ law='given', sample_time=0.002, actuator={ lag=0.005, limit=60 } }"


def scene(*more: str) -> pantoline.Scene:
    return pantoline.Scene.load(EN_300, [*TINY, *more])


def test_the_checker_of_gymnasium_passes() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Observations have no bounds, which the checker only remarks on.
        warnings.filterwarnings("ignore", message=".*Box observation space.*infinity.*")
        warnings.filterwarnings("ignore", message=".*Not able to test alternative render modes.*")
        warnings.filterwarnings("ignore", message=".*spec.*")
        check_env(ContactForceEnv(scene(GIVEN), lead=5), skip_render_check=True)


def test_a_seed_begins_the_same_episode_and_several_run_side_by_side() -> None:
    env = ContactForceEnv(scene(GIVEN), lead=10)
    first, info = env.reset(seed=3)
    again, _ = env.reset(seed=3)
    assert (first == again).all() and info["time"] <= 10 * 0.002
    assert len({env.reset(seed=seed)[1]["time"] for seed in range(8)}) > 1
    several = SyncVectorEnv([lambda: ContactForceEnv(scene(GIVEN)) for _ in range(2)])
    several.reset(seed=1)
    observations, rewards, *_ = several.step(np.array([[0.0], [1.0]], dtype=np.float32))
    assert observations.shape == (2, 4) and rewards.shape == (2,)
    several.close()


def total(env: ContactForceEnv, gain: float) -> float:
    observation, _ = env.reset()
    sum_of_rewards, done = 0.0, False
    while not done:
        action = np.array([-gain * observation[0]], dtype=np.float32)
        observation, reward, terminated, done, _ = env.step(action)
        assert not terminated
        sum_of_rewards += reward
    return sum_of_rewards


def test_no_action_is_the_run_and_feedback_earns_more() -> None:
    env = ContactForceEnv(scene(GIVEN))
    without = total(env, 0.0)
    result = scene().run()
    assert env.simulation["contact[1].force"] == result["contact[1].force"][-1]
    assert total(env, 0.5) > without


@pytest.mark.parametrize(
    ("control", "message"),
    [
        ("", "must be \"given\""),
        ("pantograph[1].control={ law='skyhook', damping=100, sample_time=0.002 }", "must be \"given\""),
        ("pantograph[1].control={ law='given', sample_time=0.002 }", "actuator.limit: must be given"),
        ("pantograph[1].control={ law='given', sample_time=0.0025, actuator={ limit=60 } }", "whole number of"),
    ],
)
def test_scenes_that_take_no_commands_are_refused(control: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ContactForceEnv(scene(*([control] if control else [])))


#: Keys that differ from case to case.
VARY = {"pantograph[1].static_force": (100.0, 130.0), "pantograph[1].masses[1]": (6.0, 9.0)}


def both(mode: AutoresetMode, threads: int, *more: str) -> tuple[ContactForceVectorEnv, SyncVectorEnv]:
    """Three cases at once, and the same three one after the other."""
    at_once = ContactForceVectorEnv(
        scene(GIVEN, *more), 3, vary=VARY, seed=4, lead=12, effort=0.1, threads=threads, autoreset_mode=mode
    )

    def alone(keys: dict[str, float]) -> ContactForceEnv:
        case = scene(GIVEN, *more)
        case.update(keys)
        return ContactForceEnv(case, lead=12, effort=0.1)

    return at_once, SyncVectorEnv([lambda keys=keys: alone(keys) for keys in at_once.keys], autoreset_mode=mode)


def finished(observations: object, information: dict[str, object]) -> tuple[object, dict[str, object]]:
    """Final observations as lists: those of cases without an end are no arrays."""
    return observations, {key: list(value) if "final_obs" in key else value for key, value in information.items()}


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("threads", [1, 3])
def test_each_case_has_the_bits_of_its_own_environment(mode: AutoresetMode, threads: int) -> None:
    at_once, one_by_one = both(mode, threads)
    assert at_once.metadata["autoreset_mode"] is mode and len({str(keys) for keys in at_once.keys}) == 3
    assert at_once.observation_space == one_by_one.observation_space
    assert at_once.action_space == one_by_one.action_space
    assert data_equivalence(at_once.reset(seed=7), one_by_one.reset(seed=7), exact=True)
    ends = 0
    at_once.action_space.seed(1)
    for _ in range(130):  # 50 samples are a run
        actions = at_once.action_space.sample()
        found, expected = at_once.step(actions), one_by_one.step(actions)
        assert data_equivalence(found[:4], expected[:4], exact=True)
        assert data_equivalence(finished(*found[::4]), finished(*expected[::4]), exact=True)
        ends += int(found[3].sum())
    assert ends >= 6
    force = at_once.signal("contact[1].force")
    assert force.tolist() == [case.simulation["contact[1].force"] for case in one_by_one.envs]


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_a_step_that_fails_ends_the_episode_of_its_case_alone(mode: AutoresetMode) -> None:
    wild = GIVEN.replace("limit=60", "limit=1e305").replace("lag=0.005, ", "")
    at_once, one_by_one = both(mode, 2, wild)
    assert data_equivalence(at_once.reset(seed=1), one_by_one.reset(seed=1), exact=True)
    actions = np.array([[0.0], [1.0], [0.0]], dtype=np.float32)
    failed = 0
    for _ in range(8):
        found, expected = at_once.step(actions), one_by_one.step(actions)
        assert data_equivalence(found[:4], expected[:4], exact=True)
        assert data_equivalence(finished(*found[::4]), finished(*expected[::4]), exact=True)
        assert not found[2][[0, 2]].any()
        failed += int(found[2][1])
        if found[2][1]:
            assert found[1][1] == -100.0
    assert failed > 0


def test_episodes_begin_by_mask_where_nothing_begins_them() -> None:
    at_once, one_by_one = both(AutoresetMode.DISABLED, 2)
    for env in (at_once, one_by_one):
        env.reset(seed=7)
    still = np.zeros((3, 1), dtype=np.float32)
    ended = np.zeros(3, dtype=np.bool_)
    for _ in range(120):
        if ended.any():
            with pytest.raises(ValueError, match="reset_mask"):
                at_once.step(still)
            again = [env.reset(options={"reset_mask": ended.copy()}) for env in (at_once, one_by_one)]
            assert data_equivalence(*(finished(*one) for one in again), exact=True)
        found, expected = at_once.step(still), one_by_one.step(still)
        assert data_equivalence(found, expected, exact=True)
        ended = found[2] | found[3]
    for mask in (np.zeros(3, dtype=np.bool_), np.zeros(2, dtype=np.bool_), np.ones(3)):
        with pytest.raises(ValueError, match="reset_mask"):
            at_once.reset(options={"reset_mask": mask})


def test_a_case_draws_by_the_seed_and_its_number() -> None:
    def keys(cases: int, seed: int) -> list[dict[str, float]]:
        return ContactForceVectorEnv(scene(GIVEN), cases, vary=VARY, seed=seed).keys

    assert keys(2, 3) == keys(4, 3)[:2] and keys(2, 3) != keys(2, 4)
    for drawn in keys(4, 3):
        assert all(low <= drawn[key] <= high for key, (low, high) in VARY.items())
    by_function = ContactForceVectorEnv(
        scene(GIVEN), 2, vary=lambda case, generator: {"run.speed_kmh": 280.0 + case + generator.uniform()}, seed=1
    )
    by_function.reset(seed=0)
    speeds = by_function.signal("strip[1].vx") * 3.6
    assert speeds == pytest.approx([keys["run.speed_kmh"] for keys in by_function.keys])


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"num_envs": 0}, "num_envs = 0"),
        ({"threads": 0}, "threads = 0"),
        ({"vary": {"pantograph[1].masses[1]": (-2.0, -1.0)}}, r"pantograph\[1\].masses"),
        ({"vary": {"pantograph[1].mass": (1.0, 2.0)}}, "mass"),
        ({"vary": {"pantograph[1].control.actuator.limit": (-2.0, -1.0)}}, "limit"),
        ({"pantograph": 2}, "pantograph = 2: must be a whole number from 1 to 1"),
        ({"pantograph": -1}, "pantograph = -1: must be a whole number from 1 on"),
        ({"lead": -1}, "lead = -1: must be a whole number from 0 on"),
        ({"effort": float("nan")}, "effort"),
    ],
)
def test_cases_that_cannot_be_are_refused(more: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ContactForceVectorEnv(scene(GIVEN), **{"num_envs": 2, **more})  # type: ignore[arg-type]


@pytest.mark.parametrize(("name", "least"), [("pantograph", 1), ("lead", 0)])
def test_a_number_of_one_environment_is_refused_by_its_name(name: str, least: int) -> None:
    with pytest.raises(ValueError, match=f"{name} = -1: must be a whole number from {least} on"):
        ContactForceEnv(scene(GIVEN), **{name: -1})  # type: ignore[arg-type]


def test_environments_without_their_package_are_refused_with_the_extra() -> None:
    script = "import sys; sys.modules['gymnasium'] = None; import pantoline.gym"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert "pantoline.gym: needs gymnasium, which the extra pantoline[gym] installs" in ended.stderr


def test_actions_that_are_no_numbers_are_refused() -> None:
    env = ContactForceVectorEnv(scene(GIVEN), 2)
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"actions\[1\] = (NaN|nan)"):
        env.step(np.array([[0.0], [np.nan]], dtype=np.float32))
    with pytest.raises(ValueError, match="2 numbers"):
        env.step(np.zeros((3, 1), dtype=np.float32))
    with pytest.raises(KeyError, match=r'did you mean "contact\[1\].force"\?'):
        env.signal("contact[1].froce")
