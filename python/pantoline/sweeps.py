"""Many cases of one scene, in one table."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._arguments import imported, made_folder, mapping, texts, whole
from ._pantoline import CaseSweep, RunError, SweepError
from ._typed import listed
from .scene import Scene, checked
from .table import Table

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

#: Rows of a table that are shown.
_SHOWN = 20


class SweepResult:
    """Table of a sweep: one row per case and pantograph, in the order of the plan."""

    def __init__(self, path: Path, summary: dict[str, Any]) -> None:
        #: Folder of the files.
        self.path = path
        #: Counts of cases, rows and failures.
        self.summary = summary

    @property
    def complete(self) -> bool:
        """``True`` where every case is finished."""
        return bool(self.summary["complete"])

    def to_arrow(self) -> pyarrow.Table:
        """The table in Arrow."""
        import pyarrow.parquet

        return pyarrow.parquet.read_table(self.path / "sweep.parquet")

    def to_pandas(self) -> pandas.DataFrame:
        """The table in pandas, which must be installed."""
        pandas = imported("pandas", "pandas", "to_pandas()")
        return pandas.DataFrame(self.to_arrow().to_pandas())

    def to_polars(self) -> polars.DataFrame:
        """The table in polars, which must be installed."""
        polars = imported("polars", "polars", "to_polars()")
        return polars.read_parquet(self.path / "sweep.parquet")

    def __len__(self) -> int:
        return int(self.summary["rows"])

    def __repr__(self) -> str:
        return f"<SweepResult {self.path}, {self.summary['finished']} of {self.summary['cases']} cases>"

    def _repr_html_(self) -> str:
        table = self.to_arrow()
        # Series of forces are left out.
        columns = [field.name for field in table.schema if not field.type.num_fields]
        rows = table.select(columns).slice(0, _SHOWN).to_pylist()
        left = len(table) - len(rows)
        more = f"<p>{left} more rows in {html.escape(str(self.path))}</p>" if left else ""
        return Table(rows)._repr_html_() + more


def sweep(
    scene: Scene,
    vary: Mapping[str, Any],
    *,
    out: str | os.PathLike[str],
    derive: Mapping[str, str] | None = None,
    where: str | Iterable[str] = (),
    sample: str | None = None,
    n: int | None = None,
    seed: int | None = None,
    series: bool = False,
    mode: str = "monolithic",
    jobs: int | None = None,
    progress: bool = False,
    client: Any = None,
    batch: int | None = None,
    retries: int = 3,
) -> SweepResult:
    """Makes many cases of a scene into one table, as ``master sweep`` does, with the same files.

    A sweep that was ended goes on with the same call; finished cases are kept in ``out``.

    Args:
        scene: The scene that all cases have in common.
        vary: Values by key: a list; a text of the command line, such as ``"200:320:10"`` or ``"normal(110,5)"``; or a
            dict of the file of a sweep, such as ``{"from": 200, "to": 320, "step": 10}`` or ``{"normal": [110, 5]}``.
        out: Folder for ``sweep.csv``, ``sweep.parquet``, ``sweep.html`` and the journal.
        derive: Expressions by key, such as ``{"run.duration": "400 / (run.speed_kmh / 3.6)"}``.
        where: Expressions that must hold for a case.
        sample: ``"latin"``, ``"sobol"`` or ``"random"`` in place of all combinations.
        n: Number of samples.
        seed: Seed of the samples.
        series: ``True`` to keep the filtered force of every case in ``sweep.parquet``.
        mode: As for :meth:`Scene.run`.
        jobs: Cases made side by side; as many as there are cores where nothing is said. With ``client``: side by side
            within a task.
        progress: ``True`` for a bar on a terminal.
        client: A ``dask.distributed.Client``, on whose workers the cases are made; needs ``pantoline[dask]``.
        batch: Cases of a task, with ``client``.
        retries: Times that a task is begun again whose worker has gone, with ``client``.

    Raises:
        SceneError: A scene, or a value of a key, that is refused.
        SweepError: A wish that is refused.
        TypeError: An argument of another type.
        ImportError: distributed is not installed, with ``client``.
        RunError: A sweep that has not reached its end; what is finished is kept.
    """
    checked(scene)
    vary = mapping("vary", vary, '{"run.speed_kmh": [260, 280, 300]}')
    derive = mapping("derive", {} if derive is None else derive, '{"run.duration": "400 / (run.speed_kmh / 3.6)"}')
    wishes: dict[str, Any] = {
        "vary": [f"{key}={listed(key, values)}" for key, values in vary.items()],
        "derive": [f"{key}={expression}" for key, expression in derive.items()],
        "where_": texts("where", where),
        "sample": None if sample is None else str(sample),
        "count": None if n is None else whole("n", n, 1, SweepError),
        "seed": None if seed is None else whole("seed", seed, 0, SweepError),
        "series": series,
    }
    _, result = carried_out(scene, wishes, Path(out), Workers(mode, jobs, progress, client, batch, retries))
    return result


@dataclass(frozen=True)
class Workers:
    """Place and way in which cases are made, as for :func:`sweep`."""

    mode: str
    jobs: int | None
    progress: bool
    client: Any
    batch: int | None
    retries: int

    def __post_init__(self) -> None:
        for name, value in (("jobs", self.jobs), ("batch", self.batch)):
            if value is not None:
                whole(name, value, 1, SweepError)
        whole("retries", self.retries, 0, SweepError)
        if self.client is not None:
            known = imported("distributed", "dask", "client").Client
            if not isinstance(self.client, known):
                raise TypeError(f"client = {self.client!r}: must be a dask.distributed.Client")


def carried_out(
    scene: Scene, wishes: Mapping[str, Any], folder: Path, workers: Workers
) -> tuple[CaseSweep, SweepResult]:
    """Makes the cases of wishes, those of :class:`CaseSweep` but for ``mode``, ``jobs`` and ``files``."""
    client, jobs = workers.client, workers.jobs
    if jobs is None:
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
        jobs = cores if client is None else 1
    wishes = {**wishes, "mode": workers.mode, "jobs": jobs}
    cases = CaseSweep(scene._source, **wishes, files={})
    made_folder("out", folder)
    if client is None:
        summary = json.loads(cases.run(folder, workers.progress))
    else:
        from ._cluster import on_cluster

        summary = on_cluster(client, scene, cases, wishes, folder, workers.batch, workers.retries)
    result = SweepResult(folder, summary)
    if not result.complete:
        finished, all_cases = summary["finished"], summary["cases"]
        error = RunError(f"{finished} of {all_cases} cases are finished; the same call goes on from there")
        error.result = result  # type: ignore[attr-defined]
        raise error
    return cases, result
