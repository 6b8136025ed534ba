"""Sensitivity: published indices, direct runs, the program, and what is refused."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from numpy.typing import NDArray

import pantoline
from conftest import EN_300, SMALL

matplotlib.use("agg")

SETS = [*SMALL, "model.reduce=planar+linearised", "run.duration=0.3", "run.evaluate={ time = [0.1, 0.3] }"]
#: Ranges that the scene gives.
KEYS = ["contact.stiffness", "pantograph[1].static_force"]

#: Effects are differences of figures of about 100, each with the same rounding: relative to the smallest effect.
ROUNDING = 1e-9


def scene() -> pantoline.Scene:
    return pantoline.Scene.load(EN_300, SETS)


def ishigami(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Function of Ishigami and Homma (1990), a = 7, b = 0.1."""
    x, y, z = rows.T
    return np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)


def column(table: pantoline.Table, name: str) -> dict[str, Any]:
    return dict(zip(table.column("key"), table.column(name)))


def test_sobol_indices_of_the_ishigami_function_are_as_published() -> None:
    ranges = {key: (-np.pi, np.pi) for key in "xyz"}
    samples = pantoline.Samples(ranges, "sobol", n=4096, second_order=True)
    assert samples.rows.shape == (4096 * 8, 3)
    found = samples.analyse(ishigami)
    # Within the digits of the first two places, which 4096 points of the sequence have; the intervals are wider.
    near = 0.005
    assert column(found["figure"], "S1") == pytest.approx({"x": 0.3139, "y": 0.4424, "z": 0.0}, abs=near)
    assert column(found["figure"], "ST") == pytest.approx({"x": 0.5576, "y": 0.4424, "z": 0.2437}, abs=near)
    assert found["figure"].column("key") == ["x", "y", "z"]
    first = found.second_order[0]
    assert (first["key"], first["with_key"]) == ("x", "z") and first["S2"] == pytest.approx(0.2437, abs=near)
    assert all(0.0 < row["S1_conf"] < 0.1 and 0.0 < row["ST_conf"] < 0.1 for row in found["figure"])
    # Variance a² / 8 + b π⁴ / 5 + b² π⁸ / 18 + 1 / 2, mean a / 2.
    variance = 49 / 8 + 0.1 * np.pi**4 / 5 + 0.01 * np.pi**8 / 18 + 0.5
    assert found.figures[0]["std"] ** 2 == pytest.approx(variance, rel=0.01)
    assert found.figures[0]["mean"] == pytest.approx(3.5, abs=0.01)
    # Without second order from a table of values, the same indices of the same points.
    plain = pantoline.Samples(ranges, "sobol", n=4096)
    again = plain.analyse({"f": ishigami(plain.rows)}, units={"f": "N"})
    assert column(again["f"], "ST") == pytest.approx(column(found["figure"], "ST"), abs=ROUNDING)
    assert again.figures[0]["unit"] == "N" and len(again.second_order) == 0


def test_effects_on_a_linear_function_are_slope_times_range() -> None:
    samples = pantoline.Samples({"x": (0.0, 2.0), "y": (-1.0, 3.0), "z": (5.0, 6.0)}, "morris", n=7)
    assert len(samples) == 7 * 4
    table = samples.analyse(lambda rows: 3.0 * rows[:, 0] - 2.0 * rows[:, 1])["figure"]
    assert table.column("key") == ["y", "x", "z"]
    # Rounding of sums of a few numbers of order 10.
    near = 1e-13
    assert table.column("mu_star") == pytest.approx([8.0, 6.0, 0.0], abs=near)
    assert table.column("mu") == pytest.approx([-8.0, 6.0, 0.0], abs=near)
    assert table.column("sigma") == pytest.approx([0.0, 0.0, 0.0], abs=near)


def test_shares_of_a_sum_of_distributed_numbers_are_those_of_their_variances() -> None:
    ranges: dict[str, Any] = {"x": "normal(10, 2)", "y": "uniform(-3, 3)", "z": "lognormal(1, 0.5)"}
    samples = pantoline.Samples(ranges, "sobol", n=4096)
    found = samples.analyse(lambda rows: rows @ [1.0, 2.0, 3.0])
    # Variances of the three: σ²; (b − a)² / 12; (exp σ² − 1) exp σ², each with the square of its factor.
    parts = np.array([2.0**2, 4.0 * 6.0**2 / 12.0, 9.0 * (np.exp(0.25) - 1.0) * np.exp(0.25)])
    expected = dict(zip("xyz", parts / parts.sum()))
    # Tails of a sequence of 4096 points.
    assert column(found["figure"], "S1") == pytest.approx(expected, abs=0.01)
    assert column(found["figure"], "ST") == pytest.approx(expected, abs=0.01)
    assert found.figures[0]["std"] ** 2 == pytest.approx(parts.sum(), rel=0.01)
    # Quantiles at 5 % and 95 %, from tables of the normal distribution.
    end = 2.0 * 1.6448536269514722
    assert found.parameters[0]["low"] == pytest.approx(10.0 - end) and found.parameters[0]["high"] == 10.0 + end
    # Effects over a whole range of four levels at shares from 5 % to 95 %, two levels apart: 3/2 of the difference.
    levels = pantoline.sensitivities.quantiles("normal(10, 2)", [0.05, 0.35, 0.65, 0.95])
    effect = 1.5 * (levels[2] - levels[0])
    screened = pantoline.Samples({"x": ranges["x"]}, "morris", n=5).analyse(lambda rows: rows[:, 0])
    assert screened["figure"][0]["mu_star"] == pytest.approx(effect, rel=1e-9)
    for wrong in ("normal(10)", "choice(1, 2)", "normal(1, -1)", "0, 1"):
        with pytest.raises(pantoline.SweepError, match="must"):
            pantoline.Samples({"x": wrong}, "sobol", n=2)


def test_samples_are_those_of_their_seed_and_leave_the_generator_of_numpy_alone() -> None:
    ranges = {"x": (0.1, 0.3), "y": (1e6, 3e6)}
    for method in ("morris", "sobol"):
        np.random.seed(3)
        rows = [pantoline.Samples(ranges, method, n=8, seed=seed).rows for seed in (0, 0, 1)]
        following = np.random.random()
        np.random.seed(3)
        assert np.random.random() == following
        assert np.array_equal(rows[0], rows[1]) and not np.array_equal(rows[0], rows[2])
        assert (rows[0] >= [0.1, 1e6]).all() and (rows[0] <= [0.3, 3e6]).all()
    found = [pantoline.Samples(ranges, "sobol", n=8, seed=0).analyse(lambda rows: rows[:, 0] ** 2) for _ in "ab"]
    assert list(found[0].table) == list(found[1].table)


def test_a_figure_that_never_changes_has_no_shares() -> None:
    ranges = {"x": (0.0, 1.0), "y": (0.0, 1.0)}
    constant = {"loss": np.zeros(8 * 6)}
    found = pantoline.Samples(ranges, "sobol", n=8, second_order=True).analyse(constant)
    assert found["loss"].column("ST") == [None, None] and found.second_order.column("S2") == [None]
    assert found["loss"].to_pandas()["S1"].isna().all()
    assert pantoline.Samples(ranges, "morris").analyse({"loss": np.zeros(30)})["loss"].column("mu_star") == [0.0, 0.0]
    with pytest.raises(pantoline.SweepError, match="one for each of 48 cases"):
        pantoline.Samples(ranges, "sobol", n=8, second_order=True).analyse(np.zeros(3))


def test_a_case_without_its_figure_ends_sobol_and_its_trajectory_of_morris() -> None:
    ranges = {"x": (0.0, 2.0), "y": (0.0, 1.0)}

    def failing(cases: list[int]) -> Any:
        def function(rows: NDArray[np.float64]) -> NDArray[np.float64]:
            values = 3.0 * rows[:, 0] + rows[:, 1]
            values[cases] = np.nan
            return values

        return function

    with pytest.raises(pantoline.RunError, match="case 6: has no finite figure; 2 of 32 cases are without"):
        pantoline.Samples(ranges, "sobol", n=8).analyse(failing([5, 9]))
    samples = pantoline.Samples(ranges, "morris", n=5)
    found = samples.analyse(failing([4, 5]))
    assert found.figures[0]["trajectories"] == 4
    assert column(found["figure"], "mu_star") == pytest.approx({"x": 6.0, "y": 1.0}, abs=1e-13)
    with pytest.raises(pantoline.RunError, match="case 1: .* 1 of 5 trajectories have figure"):
        samples.analyse(failing([0, 3, 6, 9]))


def test_effects_of_one_parameter_are_those_of_direct_runs() -> None:
    key, low, high = "pantograph[1].static_force", 100.0, 130.0
    found = pantoline.sensitivity(scene(), "morris", ranges={key: (low, high)}, keys=[key], n=3, seed=2)
    rows = pantoline.Samples({key: (low, high)}, "morris", n=3, seed=2).rows[:, 0]
    assert found.runs == len(rows) == 6
    for name in ("std", "mean"):
        effects = []
        for first, second in zip(rows[::2], rows[1::2]):
            figures = []
            for force in (first, second):
                one = scene()
                one[key] = force
                summary = one.run().summary["pantographs"][0]["contact_force"]["filtered"]
                figures.append(summary[name])
            effects.append((figures[1] - figures[0]) / (second - first) * (high - low))
        assert np.ptp(effects) > 0.0 or name == "mean"
        row = found[name][0]
        assert row["mu_star"] == pytest.approx(np.mean(np.abs(effects)), rel=ROUNDING)
        assert row["mu"] == pytest.approx(np.mean(effects), rel=ROUNDING)
        assert row["sigma"] == pytest.approx(np.std(effects, ddof=1), rel=1e-6, abs=ROUNDING * abs(row["mu"]))
    assert found.parameters[0] == {
        "key": key,
        "value": 120.0,
        "low": low,
        "high": high,
        "distribution": None,
        "mark": None,
    }


def test_one_at_a_time_has_the_files_of_the_program(tmp_path: Path) -> None:
    folder = tmp_path / "program"
    text = EN_300.read_text(encoding="utf-8").split("[ranges]")[0]
    file = tmp_path / "bare.toml"
    file.write_text(text, encoding="utf-8")
    ranges = {"contact.stiffness": (4e4, 6e4), "catenary.damping.alpha": (0.0125, 0.02)}
    command = [pantoline.program(), "sensitivity", file, "--out", folder, "-q", *(f"--set={text}" for text in SETS)]
    command += [f"--range={key}={low}:{high}" for key, (low, high) in ranges.items()]
    subprocess.run(command, check=True)
    bare = pantoline.Scene.load(file, SETS)
    found = pantoline.sensitivity(bare, ranges=ranges, out=tmp_path / "package")
    for name in ("sensitivity.csv", "sensitivity.json", "sensitivity.html", "sweep.csv"):
        assert (tmp_path / "package" / name).read_bytes() == (folder / name).read_bytes(), name
    content = json.loads((folder / "sensitivity.json").read_text())
    assert found.runs == content["runs"] == 4 and found.path == tmp_path / "package"
    std = content["figures"][0]
    assert found["std"].column("at_high") == [effect.get("at_high") for effect in std["effects"]]
    assert column(found["std"], "at_low")["catenary.damping.alpha"] is None
    assert found.figures[0]["above"] == std["above"]
    only = pantoline.sensitivity(bare, ranges=ranges, keys=["contact.stiffness"], figures="mean")
    assert only.figures.column("figure") == ["mean"] and only.runs == 3
    assert only["mean"].column("at_low") == [column(found["mean"], "at_low")["contact.stiffness"]]


def test_an_analysis_that_was_ended_goes_on(tmp_path: Path) -> None:
    def analysis(out: Path | None) -> pantoline.Sensitivity:
        return pantoline.sensitivity(scene(), "sobol", keys=KEYS, n=2, figures=["std", "max"], out=out)

    found = analysis(tmp_path)
    assert found.runs == 2 * 4 and found.figures.column("figure") == ["std", "max"]
    journal = tmp_path / "sweep.journal"
    lines = journal.read_bytes().splitlines(keepends=True)
    csv = (tmp_path / "sensitivity.csv").read_bytes()
    assert len(lines) == 1 + 8
    journal.write_bytes(b"".join(lines[:5]) + lines[5][:7])  # torn by a kill
    again = analysis(tmp_path)
    assert journal.read_bytes().splitlines(keepends=True)[:5] == lines[:5]
    assert list(again.table) == list(found.table) == list(analysis(None).table)
    assert (tmp_path / "sensitivity.csv").read_bytes() == csv
    content = json.loads((tmp_path / "sensitivity.json").read_text())
    assert (content["method"], content["n"], content["seed"]) == ("sobol", 2, 1)
    assert content["indices"] == list(found.table)
    with pytest.raises(pantoline.SweepError, match="another sweep .other plan"):
        pantoline.sensitivity(scene(), "sobol", keys=KEYS, n=2, seed=7, out=tmp_path)


def test_runs_that_fail_are_named_and_left_out_with_their_trajectories(tmp_path: Path) -> None:
    # Levels at 250, 327, 403 and 480 km/h, the last one above the wave speed of 438 km/h.
    ranges = {"run.speed_kmh": (250.0, 480.0)}
    arguments: Mapping[str, Any] = {"ranges": ranges, "keys": ["run.speed_kmh"], "figures": "std"}
    with pytest.raises(pantoline.RunError, match=r"case \d+: .*of 6 cases are without std, and sobol needs all"):
        pantoline.sensitivity(scene(), "sobol", n=2, out=tmp_path, **arguments)
    assert (tmp_path / "sweep.csv").exists()
    found = pantoline.sensitivity(scene(), "morris", n=8, **arguments)
    whole = found.figures[0]["trajectories"]
    assert 2 <= whole < 8 and len(found.failed) == 8 - whole
    assert found.failed[0].startswith("case ") and "wave" in found.failed[0]
    assert f"{8 - whole} without figures" in repr(found) and "wave" in found._repr_html_()
    # The trajectories left move between the first and the third level, whichever way.
    assert found["std"][0]["sigma"] == pytest.approx(0.0, abs=ROUNDING)
    figures = []
    for speed in (250.0, 250.0 + 230.0 * 2.0 / 3.0):
        one = scene()
        one["run.speed_kmh"] = speed
        figures.append(one.run().summary["pantographs"][0]["contact_force"]["filtered"]["std"])
    assert found["std"][0]["mu_star"] == pytest.approx(abs(figures[1] - figures[0]) * 1.5, rel=1e-6)
    with pytest.raises(pantoline.RunError, match="trajectories have std in all their cases, and morris needs two"):
        pantoline.sensitivity(scene(), "morris", n=2, **{**arguments, "ranges": {"run.speed_kmh": (290.0, 900.0)}})


def test_a_wish_is_refused_with_what_would_be_right(monkeypatch: pytest.MonkeyPatch) -> None:
    text = EN_300.read_text(encoding="utf-8").split("[ranges]")[0]
    bare = pantoline.Scene.loads(text, SETS, file=EN_300)

    def said(*arguments: Any, **wishes: Any) -> str:
        with pytest.raises(pantoline.SweepError) as refused:
            pantoline.sensitivity(*arguments, **wishes)
        return str(refused.value)

    assert "gives no number a range" in said(bare, "morris")
    assert "gives no number a range" in said(bare)
    assert "did you mean contact.stiffness?" in said(bare, "morris", ranges={"contact.stifness": (1, 2)})
    assert "must lie within its range, 60000 to 70000" in said(bare, "sobol", ranges={"contact.stiffness": (6e4, 7e4)})
    assert "must be KEY=low:high" in said(bare, ranges={"contact.stiffness": (np.nan, np.inf)})
    assert "has no range; must be one of" in said(scene(), "sobol", keys=["contact.damping"])
    assert "must stand once" in said(scene(), "sobol", keys=KEYS[:1] * 2)
    assert "n = 100: must be a power of two from 2 on, such as 128" in said(scene(), "sobol", n=100)
    assert "n = 1: must be at least 2 trajectories" in said(scene(), "morris", n=1)
    assert "must be one of one_at_a_time, morris, sobol" in said(scene(), "soboll")
    assert "n: must be left out" in said(scene(), n=3)
    assert "second_order: must be left out with morris" in said(scene(), "morris", second_order=True)
    assert '"stdd": must be one of std, mean, max, min, loss, uplift' in said(scene(), figures=["stdd"])
    with pytest.raises(pantoline.SceneError, match="catenary.damping.alpha"):
        pantoline.sensitivity(scene(), "morris", ranges={"catenary.damping.alpha": (-1.0, 1.0)})
    monkeypatch.setitem(sys.modules, "SALib.sample.sobol", None)
    with pytest.raises(ImportError, match=r"needs SALib, which the extra pantoline\[sensitivity\]"):
        pantoline.sensitivity(scene(), "sobol")


def test_results_are_tables_and_pictures() -> None:
    for method, bars in (("one_at_a_time", 4), ("morris", 2), ("sobol", 4)):
        wishes: dict[str, Any] = {} if method == "one_at_a_time" else {"n": 2}
        found = pantoline.sensitivity(scene(), method, keys=KEYS, **wishes)
        assert [row["figure"] for row in found.figures] == ["std", "mean", "max", "min", "loss", "uplift"]
        tables = found.to_arrow(), found.to_pandas(), found.to_polars()
        assert [len(table) for table in tables] == [12, 12, 12]
        assert tables[0].column_names == found.table.columns
        axes = found.plot("mean")
        assert len(axes.patches) == bars and "mean" in axes.get_xlabel()
        assert axes.get_yticklabels()[-1].get_text() == found["mean"][0]["key"] == KEYS[1]
        assert "static_force" in found._repr_html_() and repr(found).startswith(f"<Sensitivity {method}, 2 parameters")
        with pytest.raises(KeyError):
            found["std", 2]


def test_a_cluster_finds_the_same(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    local = distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None)
    with local, distributed.Client(local) as client:
        for method in ("one_at_a_time", "morris"):
            wishes: dict[str, Any] = {"keys": KEYS, "n": None if method == "one_at_a_time" else 2}
            there = pantoline.sensitivity(scene(), method, client=client, out=tmp_path / method, **wishes)
            assert list(there.table) == list(pantoline.sensitivity(scene(), method, **wishes).table)
