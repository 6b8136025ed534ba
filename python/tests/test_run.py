"""Runs: the bits of the program, tables, pages."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import matplotlib
import numpy as np
import pytest

import pantoline
from conftest import EN_300, SMALL

matplotlib.use("agg")


def of_program(folder: Path, mode: str) -> Path:
    """Results of the program that the package carries."""
    sets = [f"--set={text}" for text in SMALL]
    command = [pantoline.program(), "run", EN_300, "--mode", mode, "--out", folder, "-q", *sets]
    subprocess.run(command, check=True)
    return folder


def times(summary: dict) -> dict:
    """A summary without what differs between two runs."""
    cost = {key: value for key, value in summary["cost"].items() if key.endswith("steps") or key == "simulated_s"}
    return {**summary, "cost": cost}


@pytest.mark.parametrize("mode", ["monolithic", "cosimulation"])
def test_a_run_has_the_bits_of_the_program(scene: pantoline.Scene, tmp_path: Path, mode: str) -> None:
    folder = of_program(tmp_path / "program", mode)
    result = scene.run(mode, out=tmp_path / "package")
    for name in ("timeseries.csv", "scene.toml", "animation.json"):
        assert (tmp_path / "package" / name).read_bytes() == (folder / name).read_bytes(), name
    assert (tmp_path / "package" / "report.html").stat().st_size > 1000
    with open(folder / "timeseries.csv", newline="") as file:
        names, *rows = csv.reader(file)
    assert ["time", *result.signals] == names
    columns = np.array(rows, dtype=float).T
    for name, column in zip(names, columns):
        assert result[name].tobytes() == column.tobytes(), name
    summary = json.loads((folder / "summary.json").read_text())
    assert times(result.summary) == times(summary)
    assert list(result.limits) == summary["limits"]


def test_tables_have_units_and_the_same_numbers(scene: pantoline.Scene) -> None:
    result = scene.run()
    assert result.units["contact[1].force"] == "N" and result.units["strip[1].vz"] == "m/s"
    assert all(result.units.values()) and all(result.descriptions.values())
    assert result.units["contact[1].wire.z"] == "m"
    arrow, pandas, polars = result.to_arrow(), result.to_pandas(), result.to_polars()
    force = result["contact[1].force"]
    assert arrow.schema.field("contact[1].force").metadata[b"unit"] == b"N"
    for column in (arrow["contact[1].force"], pandas["contact[1].force"], polars["contact[1].force"]):
        assert np.array_equal(column.to_numpy(), force)
    assert np.array_equal(pandas.index, result.time) and len(result.time) == len(force)
    with pytest.raises(KeyError, match=r'contact\[1\].forc: unknown name, did you mean "contact\[1\].force"\?'):
        result["contact[1].forc"]
    assert list(result.droppers.to_arrow().column_names) == result.droppers.columns
    with pytest.raises(KeyError, match=r'limt: unknown name, did you mean "limit"\?'):
        result.limits.column("limt")
    assert "uplift at support" in str(result) or "EN 5" in str(result)


def test_figures_of_the_summary_are_those_of_the_filtered_force(scene: pantoline.Scene) -> None:
    result = scene.run()
    begin, end = result.summary["evaluation"]["time_s"][0]
    evaluated = (result.time >= begin - 1e-9) & (result.time <= end + 1e-9)
    figures = result.summary["pantographs"][0]["contact_force"]["filtered"]
    assert result.filtered()[evaluated].std() == pytest.approx(figures["std"], rel=1e-9)
    for number in (2, 0, -1):
        for use in (result.filtered, result.plot):
            with pytest.raises(IndexError, match=f"pantograph {number}: must be a number from 1 to 1"):
                use(number)


@pytest.mark.parametrize("package", ["pandas", "polars", "matplotlib"])
def test_a_package_that_is_missing_is_named_with_its_extra(
    scene: pantoline.Scene, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = scene.run()
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, package, None)
    uses = {
        "pandas": [result.to_pandas, result.limits.to_pandas],
        "polars": [result.to_polars, result.limits.to_polars],
        "matplotlib": [result.plot],
    }
    extra = "plot" if package == "matplotlib" else package
    for use in uses[package]:
        with pytest.raises(ImportError, match=rf"needs {package}, which the extra pantoline\[{extra}\] installs"):
            use()


def test_a_file_in_place_of_a_folder_is_refused(scene: pantoline.Scene, tmp_path: Path) -> None:
    file = tmp_path / "README.md"
    file.write_text("a file")
    result = scene.run()
    for path in (file, file / "below"):
        refusal = f"{re.escape(str(path))}: must be a folder, not a file or below one"
        with pytest.raises(NotADirectoryError, match=f"out = {refusal}"):
            scene.run(out=path)
        with pytest.raises(NotADirectoryError, match=f"folder = {refusal}"):
            result.save(path)
        with pytest.raises(NotADirectoryError, match=f"out = {refusal}"):
            pantoline.sweep(scene, {"run.speed_kmh": [200]}, out=path)
    assert file.read_text() == "a file"


def test_a_run_that_ends_early_is_raised_with_what_there_is(scene: pantoline.Scene, tmp_path: Path) -> None:
    scene["solver.max_iterations"] = 1
    scene["solver.newton_tolerance"] = 1e-8
    with pytest.raises(pantoline.RunError, match="the run is incomplete: no equilibrium at t = 0.0") as raised:
        scene.run(out=tmp_path)
    kept = raised.value.result
    assert not kept.complete and kept.incomplete_reason in str(raised.value)
    assert 1 < len(kept.time) < 500 and np.isfinite(kept["contact[1].force"]).all()
    assert json.loads((tmp_path / "summary.json").read_text())["complete"] is False
    assert kept.incomplete_reason in (tmp_path / "report.html").read_text()
    assert repr(kept).endswith("incomplete>") and "<pre>" in kept._repr_html_()
    assert len(kept.plot().lines) == 2
    returned = scene.run(check=False)
    assert returned.incomplete_reason == kept.incomplete_reason
    assert returned["contact[1].force"].tobytes() == kept["contact[1].force"].tobytes()


def test_a_result_is_shown(scene: pantoline.Scene) -> None:
    result = scene.run()
    axes = result.plot()
    assert axes.get_ylabel() == "contact force [N]" and len(axes.lines) == 2
    page = result._repr_html_()
    assert "<svg" in page and "contact force" in page
    assert "<table>" in result.limits._repr_html_()
    assert "<html" in result.report()
    assert repr(result).startswith("<Result en50318-300, monolithic")


def test_a_run_leaves_the_interpreter_free_and_ctrl_c_ends_it(scene: pantoline.Scene) -> None:
    scene["run.duration"] = 2.0
    scene["catenary.mesh.elements_per_interval"] = 8
    counted = 0
    ended = threading.Event()

    def count() -> None:
        nonlocal counted
        while not ended.is_set():
            counted += 1
            time.sleep(0.001)
            if counted == 50:
                os.kill(os.getpid(), signal.SIGINT)

    counter = threading.Thread(target=count)
    counter.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            scene.run()
    finally:
        ended.set()
        counter.join()
    assert counted >= 50


def test_a_mode_that_there_is_not_is_refused(scene: pantoline.Scene) -> None:
    with pytest.raises(pantoline.SceneError, match="must be one of monolithic, inprocess, cosimulation"):
        scene.run("parallel")


def test_runs_on_several_threads_have_the_same_bits(scene: pantoline.Scene) -> None:
    alone = scene.run()["contact[1].force"].tobytes()
    found: list[bytes] = []
    threads = [threading.Thread(target=lambda: found.append(scene.run()["contact[1].force"].tobytes())) for _ in "ab"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [alone, alone]
