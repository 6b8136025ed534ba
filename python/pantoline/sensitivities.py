"""Sensitivity: how much results depend on numbers that are not known for certain."""

from __future__ import annotations

import csv
import html
import json
import operator
import os
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import imported, mapping, whole
from ._pantoline import RunError, SweepError, figure_names, quantiles, shares
from ._typed import typed
from .scene import Scene, checked
from .sweeps import Workers, carried_out
from .table import Table

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

Method = Literal["one_at_a_time", "morris", "sobol"]

#: Least and most of a number, or its distribution as it is typed, such as ``"normal(110, 5)"``.
Range = tuple[float, float] | str

#: Samples where nothing is said: trajectories of Morris, as by Campolongo et al. (2007), and base samples of Sobol.
_SAMPLES = {"morris": 10, "sobol": 128}

#: Levels of a range on which trajectories of Morris move, as by Morris (1991).
_LEVELS = 4

#: Seed where none is given, that of ``master sweep``.
_SEED = 1

#: Least share of all values of a distribution, so that every value is finite.
_LEAST_SHARE = 1e-9

#: Column by which parameters are sorted, the largest first.
_SORTED = {"morris": "mu_star", "sobol": "ST"}

#: Most parameters that a figure shows.
_DRAWN = 20


class Sensitivity:
    """Dependence of figures on parameters.

    ``result["std"]`` is the table of a figure, the most important parameter first; ``result["std", 2]`` that of the
    second pantograph.

    | method | columns of a table beside ``key`` |
    | --- | --- |
    | ``one_at_a_time`` | ``value``, ``low``, ``high``, ``mark``; changes of the figure ``at_low`` and ``at_high``; |
    | | ``slope_low`` and ``slope_high``, in units of the figure by that of the key |
    | ``morris`` | ``mu_star``, ``mu``, ``sigma``: mean without sign, mean and deviation of the elementary effects, |
    | | changes of the figure per whole range of the parameter; ``mu_star_conf`` |
    | ``sobol`` | ``S1`` and ``ST``: shares of the variance by the parameter alone, and with its interactions; |
    | | ``S1_conf``, ``ST_conf``; all ``None`` for a figure that is the same in every case |

    A ``conf`` is half the width of the interval of 95 % confidence, by bootstrap.
    """

    def __init__(
        self,
        method: Method,
        parameters: Table,
        figures: Table,
        table: Table,
        *,
        second_order: Table | None = None,
        runs: int,
        failed: Sequence[str] = (),
        path: Path | None = None,
    ) -> None:
        #: Method.
        self.method: Method = method
        #: Parameters: ``key``, ``value`` in the scene, ``low``, ``high``, ``distribution`` (``None`` where values are even
        #: between these), ``mark``.
        self.parameters = parameters
        #: Figures by ``pantograph`` and ``figure``, with ``unit``. One at a time: the ``value`` in the scene as it is,
        #: and changes ``below`` and ``above`` that all parameters make together. Else: ``mean`` and ``std`` over the
        #: cases, and for Morris the ``trajectories`` that have no failed case.
        self.figures = figures
        #: All tables as one, with ``pantograph``, ``figure`` and ``unit``.
        self.table = table
        #: ``S2`` and ``S2_conf`` of pairs of parameters; no rows where not asked for.
        self.second_order = second_order if second_order is not None else Table([])
        #: Number of runs.
        self.runs = runs
        #: Runs without figures, with their reasons.
        self.failed = list(failed)
        #: Folder of the files; ``None`` where nothing was kept.
        self.path = path

    def __getitem__(self, name: str | tuple[str, int]) -> Table:
        """Table of a figure, of the first pantograph or of one counted from 1."""
        figure, pantograph = (name, 1) if isinstance(name, str) else name
        own = [row for row in self.table if (row["figure"], row["pantograph"]) == (figure, pantograph)]
        if not own:
            raise KeyError(name)
        return Table([{key: value for key, value in row.items() if key not in _PLACE} for row in own])

    # Figures are found by names, not counted.
    __iter__ = None

    def to_arrow(self) -> pyarrow.Table:
        """:attr:`table` in Arrow."""
        return self.table.to_arrow()

    def to_pandas(self) -> pandas.DataFrame:
        """:attr:`table` in pandas, which must be installed."""
        return self.table.to_pandas()

    def to_polars(self) -> polars.DataFrame:
        """:attr:`table` in polars, which must be installed."""
        return self.table.to_polars()

    def plot(self, figure: str = "std", pantograph: int = 1, ax: Any = None) -> Any:
        """Draws the parameters of a figure as bars with matplotlib, which must be installed.

        Returns:
            The axes drawn on, ``ax`` where given.
        """
        rows = list(self[figure, pantograph])[:_DRAWN][::-1]
        unit = next(row["unit"] for row in self.table if (row["figure"], row["pantograph"]) == (figure, pantograph))
        if ax is None:
            _, ax = imported("matplotlib.pyplot", "plot", "plot()").subplots(layout="constrained")
        keys = [row["key"] for row in rows]
        place = np.arange(len(rows))

        def column(name: str) -> NDArray[np.float64]:
            return np.array([np.nan if row[name] is None else row[name] for row in rows], dtype=float)

        of = f"{figure} [{unit}]" if unit else figure
        if self.method == "one_at_a_time":
            ax.barh(place, column("at_low"), label="at the least value")
            ax.barh(place, column("at_high"), height=0.5, label="at the largest value")
            label = f"change of {of}"
        elif self.method == "morris":
            ax.barh(place, column("mu_star"), xerr=column("mu_star_conf"), label="mu_star")
            ax.plot(column("sigma"), place, "k.", label="sigma")
            label = f"elementary effects on {of}"
        else:
            ax.barh(place + 0.2, column("S1"), height=0.4, xerr=column("S1_conf"), label="S1")
            ax.barh(place - 0.2, column("ST"), height=0.4, xerr=column("ST_conf"), label="ST")
            label = f"share of the variance of {figure}"
        ax.set(xlabel=label, yticks=place, yticklabels=keys)
        ax.legend(loc="lower right")
        return ax

    def _summary(self) -> str:
        failed = f", {len(self.failed)} without figures" if self.failed else ""
        return f"{self.method}, {len(self.parameters)} parameters, {self.runs} runs{failed}"

    def __repr__(self) -> str:
        return f"<Sensitivity {self._summary()}>"

    def _repr_html_(self) -> str:
        parts = [f"<p>{html.escape(self._summary())}</p>"]
        if self.failed:
            items = "".join(f"<li>{html.escape(text)}</li>" for text in self.failed[:_DRAWN])
            parts.append(f"<ul>{items}</ul>")
        for row in self.figures:
            heading = f"{row['figure']} [{row['unit']}], pantograph {row['pantograph']}"
            table = self[row["figure"], row["pantograph"]]._repr_html_()
            parts.append(f"<details open><summary>{html.escape(heading)}</summary>{table}</details>")
        return "".join(parts)

    def _write(self, folder: Path, facts: Mapping[str, Any]) -> None:
        """Writes ``sensitivity.csv`` and ``sensitivity.json``, each beside its place first."""
        content = {
            "method": self.method,
            **facts,
            "runs": self.runs,
            "failed": self.failed,
            "parameters": list(self.parameters),
            "figures": list(self.figures),
            "indices": list(self.table),
            "second_order": list(self.second_order),
        }
        text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
        partial = folder / ".sensitivity.json.partial"
        partial.write_text(text, encoding="utf-8")
        partial.replace(folder / "sensitivity.json")
        partial = folder / ".sensitivity.csv.partial"
        with open(partial, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, self.table.columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows(self.table)
        partial.replace(folder / "sensitivity.csv")


#: Columns that say which figure a row belongs to.
_PLACE = ("pantograph", "figure", "unit")


class Samples:
    """Cases of Morris or Sobol by SALib, and the indices that follow from the figures of the cases.

    :func:`sensitivity` runs the cases of a scene. The class by itself is for other functions, and for figures that
    were computed elsewhere:

    >>> samples = pantoline.Samples({"x": (0.0, 1.0), "y": "normal(0, 2)"}, "morris", n=10)
    >>> samples.analyse(lambda rows: 3.0 * rows[:, 0])["figure"]
    """

    def __init__(
        self,
        ranges: Mapping[str, Range],
        method: Literal["morris", "sobol"],
        *,
        n: int | None = None,
        seed: int | None = None,
        second_order: bool = False,
    ) -> None:
        """Draws the cases.

        Args:
            ranges: Least and most of each parameter, with values even between them; or its distribution as behind
                ``--range``: ``"uniform(from, to)"``, ``"log_uniform(from, to)"``, ``"normal(mean, std)"`` or
                ``"lognormal(median, sigma of the natural logarithm)"``. Morris moves between the 5 % and 95 % quantiles of
                the last two.
            method: ``"morris"`` for ``n * (parameters + 1)`` cases, ``"sobol"`` for ``n * (parameters + 2)``, or
                ``n * (2 * parameters + 2)`` with ``second_order``.
            n: Trajectories of Morris, 10 where nothing is said; base samples of Sobol, a power of two, 128 where
                nothing is said.
            seed: Seed of the samples and of the confidence; 1 where nothing is said.
            second_order: ``True`` for the indices of pairs of parameters too, with ``"sobol"``.

        Raises:
            SweepError: A wish that is refused.
            ImportError: SALib is not installed, which the extra ``pantoline[sensitivity]`` has.
        """
        if method not in _SAMPLES:
            raise SweepError(f'method = "{method}": must be one of one_at_a_time, {", ".join(_SAMPLES)}')
        if not ranges:
            raise SweepError("ranges: must have at least one parameter")
        for key, known in ranges.items():
            if isinstance(known, str):
                continue
            low, high = known
            if not (np.isfinite([low, high]).all() and low < high):
                raise SweepError(f"{key}: must have a range from a least to a larger value, not {low} to {high}")
        self.n = _SAMPLES[method] if n is None else operator.index(n)
        self.seed = _SEED if seed is None else whole("seed", seed, 0, SweepError)
        if method == "morris" and self.n < 2:
            raise SweepError(f"n = {self.n}: must be at least 2 trajectories, so that effects have a deviation")
        if method == "sobol" and (self.n < 2 or self.n & (self.n - 1)):
            near = 1 << max(1, self.n.bit_length()) if self.n > 0 else _SAMPLES[method]
            raise SweepError(f"n = {self.n}: must be a power of two from 2 on, such as {near}, for an even sequence")
        if second_order and method != "sobol":
            raise SweepError(f"second_order: must be left out with {method}; sobol has indices of pairs")
        self.method: Literal["morris", "sobol"] = method
        self.keys = list(ranges)
        self.second_order = second_order
        self._ranges = [ranges[key] for key in self.keys]
        bounds = np.array([self._varied(known) for known in self._ranges], dtype=float)
        self._problem = {"num_vars": len(self.keys), "names": self.keys, "bounds": bounds.tolist()}
        sample = _salib("sample", method).sample
        if method == "morris":
            rows = sample(self._problem, self.n, num_levels=_LEVELS, seed=self.seed)
        else:
            rows = sample(self._problem, self.n, calc_second_order=second_order, seed=self.seed)
        #: Values of the parameters, one row per case, in the order of ``keys``.
        self.rows: NDArray[np.float64] = np.clip(rows, bounds[:, 0], bounds[:, 1])
        for index, known in enumerate(self._ranges):
            if isinstance(known, str):
                self.rows[:, index] = quantiles(known, self.rows[:, index].tolist())

    def _varied(self, known: Range) -> tuple[float, float]:
        """Numbers between which samples are drawn: values of a range, shares of a distribution."""
        if not isinstance(known, str):
            return known
        if self.method == "morris":
            low, high = shares(known)
            return low, high
        return _LEAST_SHARE, 1.0 - _LEAST_SHARE

    def analyse(
        self,
        figures: Mapping[str, ArrayLike] | ArrayLike | Callable[[NDArray[np.float64]], Any],
        *,
        units: Mapping[str, str] | None = None,
    ) -> Sensitivity:
        """Indices from the figures of all cases, in the order of :attr:`rows`.

        A value that is not finite is a failed case. Sobol refuses it: a sequence without a point is no longer even,
        and samples without a part of the ranges are no longer those of independent parameters. Morris leaves out its
        whole trajectory: those left have all their effects.

        Args:
            figures: Values by names; or the values of one figure, which is called ``"figure"``; or a function of
                :attr:`rows` that returns either.
            units: Units of figures.

        Raises:
            RunError: A case without its figure, for Sobol; fewer than two whole trajectories, for Morris.
        """
        found = figures(self.rows) if callable(figures) else figures
        named = found if isinstance(found, Mapping) else {"figure": found}
        units = units or {}
        values = [(1, name, units.get(name, ""), np.asarray(column, dtype=float)) for name, column in named.items()]
        parameters = []
        for key, known in zip(self.keys, self._ranges):
            text = known if isinstance(known, str) else None
            low, high = known if not isinstance(known, str) else quantiles(known, shares(known))
            parameters.append({"key": key, "low": low, "high": high, "distribution": text})
        return self._analysed(values, Table(parameters), [""] * len(self.rows))

    def _analysed(
        self,
        figures: Iterable[tuple[int, str, str, NDArray[np.float64]]],
        parameters: Table,
        reasons: Sequence[str],
        path: Path | None = None,
    ) -> Sensitivity:
        """Indices of figures: pantograph, name, unit and values; ``reasons`` say why a case has none."""
        shown: list[dict[str, Any]] = []
        table: list[dict[str, Any]] = []
        pairs: list[dict[str, Any]] = []
        for pantograph, name, unit, values in figures:
            if values.shape != (len(self.rows),):
                cases = len(self.rows)
                raise SweepError(f"{name}: has values of shape {values.shape}, must have one for each of {cases} cases")
            place = {"pantograph": pantograph, "figure": name, "unit": unit}
            whole = self._whole(name, values, reasons)
            known = values[whole]
            figure = {**place, "mean": float(known.mean()), "std": float(known.std())}
            if self.method == "morris":
                figure["trajectories"] = len(known) // (len(self.keys) + 1)
                rows = self._morris(self.rows[whole], known)
            else:
                rows, second = self._sobol(known)
                pairs += [{**place, **row} for row in second]
            shown.append(figure)
            by = _SORTED[self.method]
            rows.sort(key=lambda row: -np.inf if row[by] is None else row[by], reverse=True)
            table += [{**place, **row} for row in rows]
        failed = [f"case {number}: {reason}" for number, reason in enumerate(reasons, 1) if reason]
        return Sensitivity(
            self.method,
            parameters,
            Table(shown),
            Table(table),
            second_order=Table(pairs),
            runs=len(self.rows),
            failed=failed,
            path=path,
        )

    def _whole(self, name: str, values: NDArray[np.float64], reasons: Sequence[str]) -> NDArray[np.bool_]:
        """Cases that indices are computed of."""
        known: NDArray[np.bool_] = np.isfinite(values)
        if known.all():
            return known
        case = int(np.argmin(known))
        reason = f"case {case + 1}: {reasons[case] or f'has no finite {name}'}"
        if self.method == "sobol":
            missing = f"{int((~known).sum())} of {len(known)} cases are without {name}"
            raise RunError(f"{reason}; {missing}, and sobol needs all: must be ranges in which every run is stable")
        size = len(self.keys) + 1
        trajectories = known.reshape(-1, size).all(axis=1)
        if trajectories.sum() < 2:
            left = f"{int(trajectories.sum())} of {trajectories.size} trajectories have {name} in all their cases"
            raise RunError(f"{reason}; {left}, and morris needs two: must be other ranges, or a larger n")
        return np.repeat(trajectories, size)

    def _morris(self, rows: NDArray[np.float64], values: NDArray[np.float64]) -> list[dict[str, Any]]:
        analyze = _salib("analyze", "morris").analyze
        random = np.random.default_rng(self.seed)
        found = analyze(self._problem, rows, values, num_levels=_LEVELS, seed=random)
        names = ("mu_star", "mu", "sigma", "mu_star_conf")
        return [
            {"key": key, **{name: float(found[name][index]) for name in names}} for index, key in enumerate(self.keys)
        ]

    def _sobol(self, values: NDArray[np.float64]) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        names = ("S1", "S1_conf", "ST", "ST_conf")
        pairs = list(combinations(range(len(self.keys)), 2)) if self.second_order else []
        if np.ptp(values) == 0.0:
            # No variance has no shares.
            none: dict[str, Any] = {"S2": None, "S2_conf": None}
            second = [{"key": self.keys[i], "with_key": self.keys[j], **none} for i, j in pairs]
            return [{"key": key, **dict.fromkeys(names)} for key in self.keys], second
        analyze = _salib("analyze", "sobol").analyze
        random = np.random.default_rng(self.seed)
        found = analyze(self._problem, values, calc_second_order=self.second_order, seed=random)
        rows = [
            {"key": key, **{name: float(found[name][index]) for name in names}} for index, key in enumerate(self.keys)
        ]
        second = [
            {
                "key": self.keys[i],
                "with_key": self.keys[j],
                "S2": float(found["S2"][i, j]),
                "S2_conf": float(found["S2_conf"][i, j]),
            }
            for i, j in pairs
        ]
        second.sort(key=lambda row: row["S2"], reverse=True)
        return rows, second

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        return f"<Samples {self.method}, {len(self.keys)} parameters, {len(self)} cases>"


def _salib(part: str, method: str) -> Any:
    return imported(f"SALib.{part}.{method}", "sensitivity", f'method = "{method}"')


def _typed(key: str, known: Range) -> str:
    """A range as it is typed behind ``--range``."""
    return f"{key}={known if isinstance(known, str) else ':'.join(typed(key, end) for end in known)}"


def sensitivity(
    scene: Scene,
    method: Method = "one_at_a_time",
    *,
    ranges: Mapping[str, Range] | None = None,
    keys: Iterable[str] | None = None,
    figures: str | Iterable[str] | None = None,
    n: int | None = None,
    seed: int | None = None,
    second_order: bool = False,
    out: str | os.PathLike[str] | None = None,
    mode: str = "monolithic",
    jobs: int | None = None,
    progress: bool = False,
    client: Any = None,
    batch: int | None = None,
    retries: int = 3,
) -> Sensitivity:
    """Runs a scene with its uncertain numbers varied, and says how much each of them matters.

    ``"one_at_a_time"`` is ``master sensitivity``: the scene as it is, and each number at the ends of its range.
    ``"morris"`` screens many numbers over their whole ranges, ``"sobol"`` divides the variance among them; both take
    all numbers as independent, and even between their ends where they have no distribution.

    An analysis that was ended goes on with the same call, where ``out`` is given.

    Args:
        scene: The scene; its ``[ranges]``, and ranges beside its numbers, are those of the parameters.
        method: ``"one_at_a_time"``, ``"morris"`` or ``"sobol"``.
        ranges: Least and most by key, or a distribution as for :class:`Samples`, beside those of the scene and before
            them.
        keys: Keys of the parameters, such as the largest ones of Morris for Sobol; all with a range where nothing is
            said.
        figures: Names of the figures in the result: ``std``, ``mean``, ``max``, ``min`` (N) and ``loss`` (%) of each
            pantograph, ``uplift`` (mm); all where nothing is said.
        n: As for :class:`Samples`.
        seed: As for :class:`Samples`.
        second_order: As for :class:`Samples`.
        out: Folder for ``sensitivity.csv``, ``sensitivity.json`` and the files of :func:`sweep`; nothing is kept where
            nothing is said. One at a time: ``sensitivity.html`` too, all with the content of ``master sensitivity``.
        mode: As for :meth:`Scene.run`.
        jobs: As for :func:`sweep`.
        progress: As for :func:`sweep`.
        client: As for :func:`sweep`.
        batch: As for :func:`sweep`.
        retries: As for :func:`sweep`.

    Raises:
        SceneError: A scene, or a value of a key, that is refused.
        SweepError: A range or another wish that is refused.
        RunError: An analysis that has not reached its end; the scene as it is without figures, one at a time; a run
            without figures, for Sobol; fewer than two trajectories without such a run, for Morris.
        ImportError: SALib is not installed, for Morris and Sobol.
    """
    wanted = [figures] if isinstance(figures, str) else list(figures or figure_names())
    for name in wanted:
        if name not in figure_names():
            raise SweepError(f'figures: "{name}": must be one of {", ".join(figure_names())}')
    ranges = mapping("ranges", {} if ranges is None else ranges, '{"contact.stiffness": (4e4, 6e4)}')
    texts = [_typed(key, known) for key, known in ranges.items()]
    chosen = None if keys is None else list(keys)
    names = ("key", "value", "low", "high", "distribution", "mark")
    parameters = Table([dict(zip(names, row)) for row in checked(scene)._source.parameters(texts, chosen)])
    workers = Workers(mode, jobs, progress, client, batch, retries)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place if out is None else out)
        path = None if out is None else folder
        if method == "one_at_a_time":
            for name, wish in (("n", n), ("seed", seed), ("second_order", second_order or None)):
                if wish is not None:
                    raise SweepError(f"{name}: must be left out with one_at_a_time, which has no samples")
            cases, _ = carried_out(scene, {**_NO_WISHES, "ranges": texts, "keys": chosen}, folder, workers)
            return _one_at_a_time(json.loads(cases.effects(folder) or "{}"), parameters, wanted, path)
        drawn: dict[str, Range] = {row["key"]: row["distribution"] or (row["low"], row["high"]) for row in parameters}
        samples = Samples(drawn, method, n=n, seed=seed, second_order=second_order)
        columns = {key: samples.rows[:, index].tolist() for index, key in enumerate(samples.keys)}
        cases, _ = carried_out(scene, {**_NO_WISHES, "rows": columns}, folder, workers)
        found = json.loads(cases.figures(folder))
        values = [
            (row["pantograph"], row["figure"], row["unit"], np.array(row["values"], dtype=float))
            for row in found["figures"]
            if row["figure"] in wanted
        ]
        reasons = found["reasons"]
        ended = np.array([not reason for reason in reasons])
        # A figure that no run has that reached its end has no indices.
        there = [row for row in values if not ended.any() or np.isfinite(row[3][ended]).any()]
        result = samples._analysed(there, parameters, reasons, path)
        if path is not None:
            facts = {"scene": scene.name, "mode": mode, "n": samples.n, "seed": samples.seed}
            result._write(path, facts)
        return result


#: Wishes of a sweep whose cases follow from parameters.
_NO_WISHES: dict[str, Any] = {
    "vary": [],
    "derive": [],
    "where_": [],
    "sample": None,
    "count": None,
    "seed": None,
    "series": False,
}


def _one_at_a_time(found: dict[str, Any], parameters: Table, wanted: Sequence[str], path: Path | None) -> Sensitivity:
    """The result of ``master sensitivity``."""
    failed: list[str] = found["failed"]
    if failed and failed[0].startswith("case 1:"):
        raise RunError(f"{failed[0]}; effects are changes from the scene as it is, which has no figures")
    known = [row for row in found["figures"] if row["figure"] in wanted and row["value"] is not None]
    figures = [{name: value for name, value in row.items() if name != "effects"} for row in known]
    table = []
    for row in known:
        for effect in row["effects"]:
            place = {name: row[name] for name in _PLACE}
            names = ("key", "value", "low", "high", "mark", "at_low", "at_high")
            low, high = effect["slopes"]
            slopes = {"slope_low": low, "slope_high": high}
            table.append({**place, **{name: effect.get(name) for name in names}, **slopes})
    return Sensitivity(
        "one_at_a_time", parameters, Table(figures), Table(table), runs=found["runs"], failed=failed, path=path
    )
