"""Keys of a scene: values, checks, messages."""

from __future__ import annotations

import copy
import pickle
import re
import subprocess
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pantoline
from conftest import EN_300, SMALL


def said(path: Path, *sets: str) -> str:
    """The refusal of the program."""
    command = [pantoline.program(), "check", path, "--no-report"]
    ended = subprocess.run([*command, *(f"--set={text}" for text in sets)], capture_output=True, text=True)
    assert ended.returncode == 2, ended
    return ended.stderr.strip()


def test_a_key_that_is_set_is_read_back_with_every_default_beside_it(scene: pantoline.Scene) -> None:
    scene["run.speed_kmh"] = 280
    assert scene["run.speed_kmh"] == 280.0
    scene["pantograph[1].static_force"] = np.float64(130.5)
    assert scene["pantograph[1].static_force"] == scene["pantograph.0.static_force"] == 130.5
    scene["coupling.algorithm"] = "jacobi"
    assert scene["coupling.algorithm"] == "jacobi"
    scene["run.evaluate"] = {"time": [0.1, 0.4]}
    assert scene["run.evaluate"] == {"time": [0.1, 0.4]}
    assert scene["solver.rho_inf"] is not None  # a default
    assert scene["wind"] is None
    assert "run.speed_kmh" in scene and "wind" not in scene and "run.sped" not in scene
    assert pantoline.Scene.loads(scene.to_toml()).to_toml() == scene.to_toml()


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("run.sped_kmh", 250, "run.sped_kmh=250"),
        ("run.speed_kmh", -250, "run.speed_kmh=-250"),
        ("coupling.algorithm", "jacoby", 'coupling.algorithm="jacoby"'),
        ("pantograph[3].static_force", 100, "pantograph[3].static_force=100"),
        ("catenary.spans", "many", 'catenary.spans="many"'),
    ],
)
def test_a_value_is_refused_as_the_program_refuses_it(key: str, value: object, text: str) -> None:
    scene = pantoline.Scene.load(EN_300)
    before = scene.to_toml()
    with pytest.raises(pantoline.SceneError) as refused:
        scene[key] = value
    program = said(EN_300, text)
    assert str(refused.value) in program, program
    assert scene.to_toml() == before and scene.overrides == []


def test_an_unknown_key_is_refused_with_the_nearest_one(scene: pantoline.Scene) -> None:
    with pytest.raises(ValueError, match='run.sped_kmh: unknown key, did you mean "speed_kmh"?'):
        scene["run.sped_kmh"]
    with pytest.raises(pantoline.SceneError, match=r"has 1 entry, \[1\], and no \[2\]"):
        scene["pantograph[2].static_force"]


@pytest.mark.parametrize("key", ["", ".", "x y", "pantograph[-1]", "run.speed_kmh=3", "run..speed_kmh"])
def test_a_text_that_is_no_key_is_refused_by_its_name(scene: pantoline.Scene, key: str) -> None:
    refusal = re.escape(f'"{key}": is no key')
    with pytest.raises(pantoline.SceneError, match=refusal):
        scene[key]
    with pytest.raises(pantoline.SceneError, match=refusal):
        scene[key] = 3
    assert key not in scene and scene.overrides == SMALL


def test_the_key_that_was_meant_is_named(scene: pantoline.Scene) -> None:
    with pytest.raises(pantoline.SceneError, match=r'no key, did you mean "run.speed_kmh"\?'):
        scene["run.speed_kmh=3"]


def test_keys_of_a_scene_whose_values_contradict_each_other_are_known(scene: pantoline.Scene) -> None:
    scene["run.duration"] = 0.2
    assert "run.speed_kmh" in scene and "solver.rho_inf" in scene
    assert "run.sped_kmh" not in scene and "wind" not in scene and "" not in scene and 5 not in scene
    with pytest.raises(pantoline.SceneError, match="run.sped_kmh: unknown key"):
        scene["run.sped_kmh"]
    with pytest.raises(pantoline.SceneError, match=r"has 1 entry, \[1\], and no \[2\]"):
        scene["pantograph[2].static_force"]
    for key in ("run.speed_kmh", "wind"):
        with pytest.raises(pantoline.SceneError, match="run.evaluate"):
            scene[key]


def test_values_that_contradict_each_other_are_refused_by_the_run(scene: pantoline.Scene) -> None:
    scene["run.duration"] = 0.2
    with pytest.raises(pantoline.SceneError, match="run.evaluate"):
        scene.run()
    scene["run.evaluate"] = {"time": [0.1, 0.2]}
    assert scene.run().complete


def test_a_copy_is_apart_and_a_pickle_is_equal(scene: pantoline.Scene) -> None:
    other = scene.copy()
    other["run.speed_kmh"] = 250
    assert scene["run.speed_kmh"] == 300.0
    for again in (copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        assert again.to_toml() == scene.to_toml() and again.overrides == SMALL


@pytest.mark.parametrize("value", [None, b"12", bytearray(b"12"), object(), [1, None], {1, 2}])
def test_a_value_of_no_type_of_a_scene_is_refused_with_its_key(scene: pantoline.Scene, value: object) -> None:
    with pytest.raises(TypeError, match="run.speed_kmh = .*: must be a number, a text"):
        scene["run.speed_kmh"] = value
    with pytest.raises(TypeError, match="run.speed_kmh = .*: must be a number, a text"):
        scene.update({"run.speed_kmh": value})
    assert scene.overrides == SMALL


def test_one_override_is_one_key() -> None:
    assert pantoline.Scene.load(EN_300, "run.speed_kmh=200").overrides == ["run.speed_kmh=200"]


@pytest.mark.parametrize("overrides", [None, 5, [5]])
def test_overrides_of_another_type_are_refused_by_their_name(overrides: Any) -> None:
    with pytest.raises(TypeError, match="overrides = .*: must be a text, or a list of texts"):
        pantoline.Scene.load(EN_300, overrides)


def test_what_is_no_scene_is_refused_with_the_way_to_one(tmp_path: Path) -> None:
    given: Any = str(EN_300)
    with pytest.raises(TypeError, match=r"en50318-300.toml'.*Scene.load\(path\)"):
        pantoline.Scene(given)
    for value in (given, EN_300, None):
        for use in (
            pantoline.Simulation,
            partial(pantoline.sweep, vary={"run.speed_kmh": [200]}, out=tmp_path),
            pantoline.sensitivity,
        ):
            with pytest.raises(TypeError, match=r"scene = .*: must be a Scene, such as Scene.load\(path\) returns"):
                use(value)


def test_a_file_that_is_no_scene_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        pantoline.Scene.load(tmp_path / "none.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(pantoline.SceneError, match="no text in UTF-8"):
        pantoline.Scene.load(tmp_path / "binary.toml")
    with pytest.raises(pantoline.SceneError, match="title is missing"):
        pantoline.Scene.loads("")


def test_the_check_has_droppers_and_start(scene: pantoline.Scene) -> None:
    report = scene.check()
    assert report["start"][0]["force_N"] > 0
    droppers = scene.droppers()
    assert len(droppers) == 6 * 9 and droppers.to_pandas()["force_N"].gt(0).all()
