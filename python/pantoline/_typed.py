"""Python values as they are typed in a scene."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any


def typed(value: Any) -> str:
    """The TOML of a value, such as stands behind ``--set key=``."""
    if hasattr(value, "tolist"):  # a scalar or an array of numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        entries = ", ".join(f"{json.dumps(str(key), ensure_ascii=False)} = {typed(entry)}" for key, entry in value.items())
        return "{ " + entries + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(typed(entry) for entry in value) + "]"
    raise TypeError(f"{value!r}: must be a number, a text, true or false, a list or a dict")


def listed(values: Any) -> str:
    """Values of a key that is varied: a text such as ``"200:320:10"`` as it is, else a list."""
    if isinstance(values, str):
        return values
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, range):
        values = list(values)
    if not isinstance(values, Sequence):
        values = [values]
    return ",".join(typed(value) for value in values)
