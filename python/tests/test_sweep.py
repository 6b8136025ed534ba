"""Sweeps: the table of the program, on threads and on a cluster."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest

import pantoline
from conftest import EN_300, SMALL

VARY: dict[str, Any] = {"run.speed_kmh": "250:300:10", "pantograph[1].static_force": [100, 120]}
SETS = [*SMALL, "model.reduce=planar+linearised", "run.duration=0.3", "run.evaluate={ time = [0.1, 0.3] }"]


def scene() -> pantoline.Scene:
    return pantoline.Scene.load(EN_300, SETS)


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sweep of the program."""
    folder = tmp_path_factory.mktemp("program")
    command = [pantoline.program(), "sweep", EN_300, "--out", folder, "-q", "--jobs=2", "--vary=run.speed_kmh=250:300:10"]
    command += ["--vary=pantograph[1].static_force=100,120", *(f"--set={text}" for text in SETS)]
    subprocess.run(command, check=True)
    return folder


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_sweep_has_the_table_of_the_program_on_any_number_of_threads(
    jobs: int, expected: Path, tmp_path: Path
) -> None:
    table = pantoline.sweep(scene(), VARY, out=tmp_path, jobs=jobs)
    assert (tmp_path / "sweep.csv").read_bytes() == (expected / "sweep.csv").read_bytes()
    assert table.complete and len(table) == 12
    assert table.to_arrow().equals(pyarrow.parquet.read_table(expected / "sweep.parquet"))
    assert len(table.to_pandas()) == len(table.to_polars()) == 12
    again = pantoline.sweep(scene(), VARY, out=tmp_path, jobs=jobs)
    assert again.summary["made_earlier"] == 12


def test_samples_and_expressions_are_those_of_the_program(tmp_path: Path) -> None:
    table = pantoline.sweep(
        scene(),
        {"force": "80:120"},
        derive={"pantograph[1].static_force": "force + 10"},
        where="force > 70",
        sample="sobol",
        n=3,
        seed=5,
        out=tmp_path,
    ).to_pandas()
    assert np.array_equal(table["pantograph[1].static_force"], table["force"] + 10)


def test_a_wish_is_refused_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(pantoline.SweepError, match="must have a number of samples too"):
        pantoline.sweep(scene(), {"run.speed_kmh": "250:300"}, sample="latin", out=tmp_path)
    with pytest.raises(pantoline.SweepError, match='sample = "lattin": must be one of latin, sobol, random'):
        pantoline.sweep(scene(), VARY, sample="lattin", n=3, out=tmp_path)
    with pytest.raises(pantoline.SceneError, match="unknown key"):
        pantoline.sweep(scene(), {"run.sped_kmh": [1, 2]}, out=tmp_path)
    assert not (tmp_path / "sweep.csv").exists()


@pytest.mark.parametrize(
    ("name", "value", "least"),
    [("n", -1, 1), ("seed", -1, 0), ("jobs", 0, 1), ("batch", 0, 1), ("batch", -1, 1), ("retries", -1, 0)],
)
def test_a_number_is_refused_by_its_name(name: str, value: int, least: int, tmp_path: Path) -> None:
    refusal = f": must be a whole number from {least} on"
    numbers: dict[str, Any] = {"sample": "latin", "n": 3, name: value}
    with pytest.raises(pantoline.SweepError, match=f"{name} = {value}{refusal}"):
        pantoline.sweep(scene(), {"run.speed_kmh": "250:300"}, out=tmp_path, **numbers)
    with pytest.raises(TypeError, match=f"{name} = 'many'{refusal}"):
        pantoline.sweep(scene(), {"run.speed_kmh": "250:300"}, out=tmp_path, **{**numbers, name: "many"})
    assert not list(tmp_path.iterdir())


def test_a_range_of_a_file_is_that_of_the_command_line(expected: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(expected, tmp_path / "again")
    speeds = {"from": 250, "to": np.int64(300), "step": 10.0}
    table = pantoline.sweep(scene(), {**VARY, "run.speed_kmh": speeds}, out=folder)
    assert table.summary["made_earlier"] == 12


def test_a_distribution_of_a_file_is_that_of_the_command_line(tmp_path: Path) -> None:
    for force in ("normal(110,5)", {"normal": [110, 5]}, {"normal": np.array([110.0, 5.0])}):
        table = pantoline.sweep(scene(), {"pantograph[1].static_force": force}, sample="random", n=2, out=tmp_path)
    assert table.summary["made_earlier"] == 2


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ({"from": 200, "to": 300}, pantoline.SweepError),
        ({"from": "a", "to": 300, "step": 50}, pantoline.SweepError),
        ({"normal": 110}, pantoline.SweepError),
        ({}, pantoline.SweepError),
        ({200, 300}, TypeError),
        ((speed for speed in (200, 300)), TypeError),
        (b"200", TypeError),
        (None, TypeError),
        ([200, None], TypeError),
    ],
)
def test_values_of_another_form_are_refused_with_the_forms(
    values: object, kind: type[Exception], tmp_path: Path
) -> None:
    with pytest.raises(kind, match=r"run.speed_kmh = .*: must be a value, a list, .*\"from\".*\"normal\""):
        pantoline.sweep(scene(), {"run.speed_kmh": values}, out=tmp_path)


def test_arguments_of_another_type_are_refused_by_their_names(tmp_path: Path) -> None:
    nothing: Any = None
    where: Any
    with pytest.raises(TypeError, match="vary = None: must be a mapping of keys"):
        pantoline.sweep(scene(), nothing, out=tmp_path)
    with pytest.raises(TypeError, match="derive = 'x': must be a mapping of keys"):
        pantoline.sweep(scene(), VARY, out=tmp_path, derive="x")
    for where in (5, [5]):
        with pytest.raises(TypeError, match="where = .*: must be a text, or a list of texts"):
            pantoline.sweep(scene(), VARY, out=tmp_path, where=where)
    with pytest.raises(TypeError, match="client = 'x': must be a dask.distributed.Client"):
        pantoline.sweep(scene(), VARY, out=tmp_path, client="x")


def test_a_cluster_without_its_package_is_refused_with_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match=r"client: needs distributed, which the extra pantoline\[dask\] installs"):
        pantoline.sweep(scene(), VARY, out=tmp_path, client="x")


def test_a_table_is_shown_without_pandas(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = pantoline.sweep(scene(), {"run.speed_kmh": [250, 270, 290]}, series=True, out=tmp_path)
    monkeypatch.setitem(sys.modules, "pandas", None)
    page = table._repr_html_()
    assert "<td>290</td>" in page and page.count("<tr>") == 1 + 3 and "more rows" not in page
    assert "<th>run.speed_kmh</th>" in page
    assert "filtered_N" in table.to_arrow().column_names and "filtered_N" not in page
    monkeypatch.setattr("pantoline.sweeps._SHOWN", 2)
    page = table._repr_html_()
    assert page.count("<tr>") == 1 + 2 and f"1 more rows in {tmp_path}" in page


def kill_after_the_first_batch(victim: int, parts: Path) -> None:
    """Ends a worker, with what it is in, as soon as a batch is kept."""
    while not list(parts.glob("*.parquet")):
        time.sleep(0.001)
    os.kill(victim, signal.SIGKILL)


def test_what_a_cluster_has_made_is_kept_and_gone_on_with(expected: Path, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    import pantoline._cluster as cluster

    local = distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None)
    with local, distributed.Client(local) as client:
        make = cluster._make
        try:
            cluster._make = refused_from_the_seventh
            with pytest.raises(pantoline.RunError, match="6 of 12 cases are finished; .* out of order"):
                pantoline.sweep(scene(), VARY, out=tmp_path, client=client, batch=2, retries=1)
        finally:
            cluster._make = make
        assert len((tmp_path / "sweep.csv").read_text().splitlines()) == 1 + 6
        table = pantoline.sweep(scene(), VARY, out=tmp_path, client=client, batch=3)
    assert table.summary["made_earlier"] == 6
    assert (tmp_path / "sweep.csv").read_bytes() == (expected / "sweep.csv").read_bytes()


def refused_from_the_seventh(place: Any, cases: list[int]) -> str:
    """A worker that makes the first six cases only."""
    import pantoline._cluster as cluster

    if cases[0] > 6:
        raise OSError("out of order")
    return cluster._sweep(place).make(list(cases))


def test_a_cluster_that_loses_a_worker_makes_the_same_table(expected: Path, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    settings = {"distributed.worker.daemon": False, "distributed.comm.timeouts.connect": "60s"}
    import dask

    with dask.config.set(settings):
        cluster = distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None
        )
        with cluster, distributed.Client(cluster) as client:
            pids = client.run(os.getpid)
            victim = sorted(pids.values())[0]
            arguments = (victim, tmp_path / "parts")
            watch = threading.Thread(target=kill_after_the_first_batch, args=arguments, daemon=True)
            watch.start()
            table = pantoline.sweep(scene(), VARY, out=tmp_path, client=client, batch=2)
            watch.join()
            again = pantoline.sweep(scene(), VARY, out=tmp_path, client=client)
    assert table.complete and again.summary["made_earlier"] == 12
    assert (tmp_path / "sweep.csv").read_bytes() == (expected / "sweep.csv").read_bytes()
    parts = sorted((tmp_path / "parts").glob("*.parquet"))
    assert len(parts) == 6
    joined = pyarrow.concat_tables([pyarrow.parquet.read_table(part) for part in parts])
    assert joined.equals(pyarrow.parquet.read_table(expected / "sweep.parquet"))
