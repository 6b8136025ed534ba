"""Batches of a sweep as tasks of Dask."""

from __future__ import annotations

import json
import os
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from ._pantoline import CaseSweep, RunError, SceneSource

#: Most cases of a task where nothing is said: what a worker that goes takes with it is small.
_MOST = 16


@dataclass(frozen=True)
class _Place:
    """Everything that a worker needs to make cases: no file of the client."""

    text: str
    file: str
    overrides: tuple[str, ...]
    #: Wishes and texts of files beside the scene, as JSON.
    wishes: str
    files: str
    identity: str


@lru_cache(maxsize=2)
def _sweep(place: _Place) -> CaseSweep:
    source = SceneSource(place.text, place.file, list(place.overrides))
    sweep = CaseSweep(source, **json.loads(place.wishes), files=json.loads(place.files))
    if sweep.identity() != place.identity:
        raise RunError("the worker has another version of pantoline or of an FMU: must have that of the client")
    return sweep


def _make(place: _Place, cases: Sequence[int]) -> str:
    """Makes a batch on a worker."""
    return _sweep(place).make(list(cases))


def _batches(cases: Sequence[int], size: int) -> list[list[int]]:
    return [list(cases[first : first + size]) for first in range(0, len(cases), size)]


def on_cluster(
    client: Any,
    scene: Any,
    sweep: CaseSweep,
    wishes: dict[str, Any],
    folder: Path,
    batch: int | None,
    retries: int,
) -> dict[str, Any]:
    """Makes the open cases of a sweep on the workers of a client; keeps each batch as it ends."""
    from distributed import as_completed

    source = scene._source
    place = _Place(
        text=source.text,
        file=os.path.abspath(source.origin),
        overrides=tuple(source.overrides),
        wishes=json.dumps(wishes),
        files=json.dumps(sweep.files()),
        identity=sweep.identity(),
    )
    cases = sweep.open(folder)
    threads = max(1, sum(client.nthreads().values()))
    size = max(1, min(_MOST, len(cases) // (4 * threads))) if batch is None else batch
    batches = _batches(cases, size)
    parts = folder / "parts"
    parts.mkdir(exist_ok=True)
    call = uuid.uuid4().hex
    keys = [f"pantoline-{call}-{numbers[0]}" for numbers in batches]
    futures = client.map(partial(_make, place), batches, key=keys, pure=False, retries=retries) if batches else []
    first = {future.key: numbers[0] for future, numbers in zip(futures, batches)}
    failure: BaseException | None = None
    try:
        for future in as_completed(futures):
            if future.status != "finished":
                failure = failure or future.exception()
                continue
            sweep.keep(future.result(), parts / f"part-{first[future.key]:08}.parquet")
            future.release()
    finally:
        client.cancel(futures)
        summary: dict[str, Any] = json.loads(sweep.close() or "{}")
        summary["made_earlier"] = sweep.cases() - len(cases)
    if failure is not None:
        finished, count = summary["finished"], summary["cases"]
        text = f"{finished} of {count} cases are finished; the same call goes on from there: {failure}"
        raise RunError(text) from failure
    return summary
