"""Arguments and optional packages, refused by their names."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

#: Largest whole number that the extension takes.
_MOST = 2**63 - 1


def whole(name: str, value: Any, least: int, refused: type[ValueError] = ValueError) -> int:
    """A whole number from ``least`` on; ``refused`` is raised for one outside."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} = {value!r}: must be a whole number from {least} on") from None
    if number < least:
        raise refused(f"{name} = {number}: must be a whole number from {least} on")
    if number > _MOST:
        raise refused(f"{name} = {number}: must be a whole number up to {_MOST}")
    return number


def mapping(name: str, value: Any, example: str) -> Mapping[str, Any]:
    """A mapping of keys; ``example`` is one that would be right."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} = {value!r}: must be a mapping of keys, such as {example}")
    return value


def texts(name: str, value: Any) -> list[str]:
    """Texts: one by itself, or several."""
    found = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
    if not all(isinstance(text, str) for text in found):
        raise TypeError(f"{name} = {value!r}: must be a text, or a list of texts")
    return found


def made_folder(name: str, path: str | os.PathLike[str]) -> Path:
    """A folder for files, made where there is none."""
    place = Path(path)
    try:
        place.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise NotADirectoryError(f"{name} = {place}: must be a folder, not a file or below one") from None
    return place


def imported(module: str, extra: str, use: str) -> Any:
    """A module of an optional package; ``use`` is what needs the package.

    Raises:
        ImportError: The package is not installed; the message names its extra.
    """
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(f"{use}: needs {package}, which the extra pantoline[{extra}] installs") from error
