"""A scene: one line, its pantographs and one run."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ._pantoline import RunError, SceneError, SceneSource
from ._arguments import made_folder, mapping, texts
from ._typed import typed
from .result import Result
from .table import Table


class Scene:
    """A scene with keys set in it.

    Keys are those of the scene file by their paths, such as ``run.speed_kmh`` or ``pantograph[1].static_force``, in the
    units of the file. Setting a key is the same as ``master run --set``, with the same checks and messages.
    """

    def __init__(self, source: SceneSource) -> None:
        if not isinstance(source, SceneSource):
            ways = "Scene.load(path) reads a file, Scene.loads(text) a text"
            raise TypeError(f"source = {source!r}: must be the source of a scene; {ways}")
        self._source = source

    @classmethod
    def load(cls, path: str | os.PathLike[str], overrides: Iterable[str] | Mapping[str, Any] = ()) -> Scene:
        """The scene of a file.

        Args:
            path: The file, in TOML.
            overrides: Keys to be set: ``"key=value"`` as behind ``--set``, one or several, or a mapping of keys to
                values.

        Raises:
            SceneError: Every problem found, with file, line, key, value, unit and remedy.
            OSError: A file that cannot be read.
        """
        try:
            text = Path(path).read_bytes().decode("utf-8")
        except UnicodeDecodeError:
            raise SceneError(f"{os.fspath(path)}: is no text in UTF-8; expected a scene (.toml)") from None
        return cls._made(text, path, overrides)

    @classmethod
    def loads(
        cls,
        text: str,
        overrides: Iterable[str] | Mapping[str, Any] = (),
        *,
        file: str | os.PathLike[str] = "scene",
    ) -> Scene:
        """The scene of a text; ``file`` is its name in messages, and files that it names are beside that file."""
        return cls._made(text, file, overrides)

    @classmethod
    def _made(
        cls, text: str, file: str | os.PathLike[str], overrides: Iterable[str] | Mapping[str, Any]
    ) -> Scene:
        if isinstance(overrides, Mapping):
            scene = cls(SceneSource(text, file, []))
            scene.update(overrides)
            return scene
        return cls(SceneSource(text, file, texts("overrides", overrides)))

    @property
    def name(self) -> str:
        """Name in results: that of the file."""
        return self._source.name

    @property
    def overrides(self) -> list[str]:
        """Keys that are set, as behind ``--set``."""
        return self._source.overrides

    def __getitem__(self, key: str) -> Any:
        """Value of a key in the resolved scene, every default and choice included.

        A list of tables is counted from 1. A known key that is left out has the value ``None``.
        """
        return self._source.value(key)

    def __setitem__(self, key: str, value: Any) -> None:
        """Sets a key; a value that is refused leaves the scene as it was.

        Values that contradict each other are refused by :meth:`run`, :meth:`check` and reading, so that several keys
        can be set in turn.
        """
        self._source = self._source.with_keys([(key, typed(key, value))])

    def __contains__(self, key: object) -> bool:
        """``True`` for a key that has a value, also where values contradict each other."""
        return isinstance(key, str) and self._source.has(key)

    # Keys are found by paths, not counted.
    __iter__ = None

    def update(self, keys: Mapping[str, Any]) -> None:
        """Sets several keys at once."""
        keys = mapping("keys", keys, '{"run.speed_kmh": 280}')
        self._source = self._source.with_keys([(key, typed(key, value)) for key, value in keys.items()])

    def copy(self) -> Scene:
        """A scene that can be changed apart from this one."""
        return Scene(self._source)

    __copy__ = copy

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._source.text, self._source.origin, self._source.overrides)

    def to_toml(self) -> str:
        """The resolved scene as the text of a file, with every default; it runs again with the same results."""
        return self._source.to_toml()

    def check(self) -> dict[str, Any]:
        """Statics, elasticity, waves, start and notes of the scene: what ``master check --json`` prints."""
        report: dict[str, Any] = json.loads(self._source.check())
        return report

    def droppers(self) -> Table:
        """Droppers of the line at rest: place, unstressed length (m) and force (N)."""
        statics = self.check()["statics"]
        return Table(statics["droppers"] if statics else [])

    def run(
        self,
        mode: str = "monolithic",
        *,
        out: str | os.PathLike[str] | None = None,
        report: bool = True,
        animation: bool = True,
        check: bool = True,
    ) -> Result:
        """Runs the scene, without the lock of the interpreter; Ctrl-C ends the run.

        Args:
            mode: ``"monolithic"`` for line and pantographs as one system, ``"inprocess"`` for the coupled components,
                ``"cosimulation"`` for FMUs through their C interface, which supplied FMUs need.
            out: Folder for the files that ``master run`` writes.
            report: ``False`` to write no ``report.html``.
            animation: ``False`` to draw no pictures, which saves their time.
            check: ``False`` to return a run that has not reached its end, in place of raising.

        Raises:
            SceneError: A scene that cannot be run.
            RunError: A run that has not reached its end; the attribute ``result`` has what there is.
        """
        if out is not None:  # a folder that cannot be made is refused before the run
            made_folder("out", out)
        result = Result(self._source.run(mode, animation and out is not None))
        if out is not None:
            result.save(out, report=report, animation=animation)
        if check and not result.complete:
            error = RunError(f"{self.name}: the run is incomplete: {result.incomplete_reason}")
            error.result = result  # type: ignore[attr-defined]
            raise error
        return result

    def __repr__(self) -> str:
        keys = "".join(f", {text}" for text in self.overrides)
        return f"<Scene {self._source.origin}{keys}>"


def checked(scene: Any) -> Scene:
    """A scene that was given, refused where it is none."""
    if not isinstance(scene, Scene):
        raise TypeError(f"scene = {scene!r}: must be a Scene, such as Scene.load(path) returns")
    return scene


def _again(text: str, origin: str, overrides: list[str]) -> Scene:
    return Scene(SceneSource(text, origin, overrides))
