"""Environment of Gymnasium: its checker, seeds, and a rule that lowers the variation of the force."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import SyncVectorEnv

import pantoline
from conftest import EN_300, TINY
from pantoline.gym import ContactForceEnv

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
