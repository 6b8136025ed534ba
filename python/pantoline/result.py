"""The result of a run."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._arguments import imported, made_folder
from ._pantoline import RunResult
from .table import Table

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class Result:
    """Series, figures and limits of a run.

    ``result["contact[1].force"]`` is a series over :attr:`time`; names and bits are those of ``timeseries.csv``.
    """

    def __init__(self, run: RunResult) -> None:
        self._run = run

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Figures, limits, model and cost: the content of ``summary.json``."""
        summary: dict[str, Any] = json.loads(self._run.summary())
        return summary

    @property
    def complete(self) -> bool:
        """``True`` where the run has reached its end."""
        return bool(self.summary["complete"])

    @property
    def incomplete_reason(self) -> str:
        """Reason why it has not; empty for a complete run."""
        return self._run.incomplete_reason()

    @cached_property
    def limits(self) -> Table:
        """Limits of standards: value, bound, margin, and ``pass``, which is ``None`` where a limit is not decided."""
        return Table(self.summary["limits"])

    @cached_property
    def droppers(self) -> Table:
        """Droppers of the line at rest: place, unstressed length (m) and force (N)."""
        return Table(json.loads(self._run.droppers()))

    @cached_property
    def time(self) -> NDArray[np.float64]:
        """Times of the series, s."""
        return _array(self._run.time())

    @cached_property
    def _names(self) -> dict[str, tuple[str, str]]:
        return {name: (unit, text) for name, unit, text in self._run.names()}

    @property
    def signals(self) -> list[str]:
        """Names of the series."""
        return list(self._names)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each series."""
        return {name: unit for name, (unit, _) in self._names.items()}

    @property
    def descriptions(self) -> dict[str, str]:
        """One sentence on each series."""
        return {name: text for name, (_, text) in self._names.items()}

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """A series by its name, in the unit of :attr:`units`.

        Raises:
            KeyError: No such series; the message has the nearest name.
        """
        if name == "time":
            return self.time
        return _array(self._run.series(name))

    def __contains__(self, name: object) -> bool:
        return name == "time" or name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def filtered(self, pantograph: int = 1) -> NDArray[np.float64]:
        """Low-pass filtered contact force of a pantograph, counted from 1, over the whole record, N."""
        return _array(self._run.filtered(pantograph))

    def to_arrow(self) -> pyarrow.Table:
        """All series in Arrow; fields carry ``unit`` and ``description``."""
        import pyarrow

        columns = {"time": (self.time, "s", "Time")}
        columns |= {name: (self[name], unit, text) for name, (unit, text) in self._names.items()}
        fields = [
            pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit, "description": text})
            for name, (_, unit, text) in columns.items()
        ]
        return pyarrow.table([values for values, _, _ in columns.values()], schema=pyarrow.schema(fields))

    def to_pandas(self) -> pandas.DataFrame:
        """All series in pandas, which must be installed, with the time as index."""
        pandas = imported("pandas", "pandas", "to_pandas()")
        return pandas.DataFrame({name: self[name] for name in self}, index=pandas.Index(self.time, name="time"))

    def to_polars(self) -> polars.DataFrame:
        """All series in polars, which must be installed, with a column ``time``."""
        polars = imported("polars", "polars", "to_polars()")
        return polars.DataFrame({"time": self.time} | {name: self[name] for name in self})

    def scene_toml(self) -> str:
        """The resolved scene that was run."""
        return self._run.scene()

    def save(self, folder: str | os.PathLike[str], *, report: bool = True, animation: bool = True) -> None:
        """Writes the files that ``master run`` writes; pictures are there where the run was given ``out``."""
        self._run.save(made_folder("folder", folder), report, animation)

    def report(self) -> str:
        """The page ``report.html``, complete in itself."""
        return self._run.report()

    def plot(self, pantograph: int = 1, ax: Any = None) -> Any:
        """Draws the contact force of a pantograph over the track with matplotlib, which must be installed.

        Returns:
            The axes drawn on, ``ax`` where given.

        Raises:
            IndexError: No such pantograph.
            ImportError: matplotlib is not installed.
        """
        filtered = self.filtered(pantograph)
        if ax is None:
            _, ax = imported("matplotlib.pyplot", "plot", "plot()").subplots(layout="constrained")
        prefix = f"head[{pantograph}]" if f"head[{pantograph}].force" in self else f"contact[{pantograph}]"
        evaluation = self.summary["evaluation"]
        ax.plot(self[f"{prefix}.x"], self[f"{prefix}.force"], linewidth=0.5, alpha=0.5, label="as computed")
        label = f"filtered, {evaluation['low_pass_hz']:g} Hz"
        ax.plot(self[f"{prefix}.x"], filtered, linewidth=1.2, label=label)
        begin, end = (np.interp(t, self.time, self[f"{prefix}.x"]) for t in evaluation["time_s"][pantograph - 1])
        ax.axvspan(begin, end, alpha=0.08, label="evaluated")
        ax.set(xlabel="position [m]", ylabel="contact force [N]", title=self.summary["title"])
        ax.legend(loc="upper right")
        return ax

    def __str__(self) -> str:
        return self._run.table()

    def __repr__(self) -> str:
        summary = self.summary
        state = "" if self.complete else ", incomplete"
        return f"<Result {summary['scene']}, {summary['mode']}, {len(self.time)} samples{state}>"

    def _repr_html_(self) -> str:
        return f"{self._picture()}<pre>{html.escape(str(self))}</pre>"

    def _picture(self) -> str:
        """The filtered force of the first pantograph as a small drawing."""
        try:
            force = self.filtered()
        except RuntimeError:
            return ""
        width, height, points = 640.0, 120.0, 640
        step = max(1, len(force) // points)
        force = force[::step]
        if len(force) < 2 or not np.isfinite(force).all():
            return ""
        low, high = float(force.min()), float(force.max())
        x = np.linspace(0.0, width, len(force))
        y = height - (force - low) / max(high - low, 1e-9) * height
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
        return (
            f'<svg viewBox="0 0 {width:g} {height:g}" width="{width:g}" role="img">'
            f"<title>Filtered contact force, {low:.1f} N to {high:.1f} N</title>"
            f'<polyline points="{line}" fill="none" stroke="currentColor"/></svg>'
        )


def _array(data: bytearray) -> NDArray[np.float64]:
    return np.frombuffer(data, dtype="<f8")
