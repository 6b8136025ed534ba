"""Python values as they are typed in a scene."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

from ._pantoline import SweepError

#: Sequences that are no lists of values.
_BYTES = (bytes, bytearray, memoryview)

#: Forms of the values of a key that is varied.
_FORMS = (
    'must be a value, a list, a text such as "200:320:10", a dict such as {"from": 200, "to": 320, "step": 10}, '
    'or a distribution such as {"normal": [110, 5]}'
)


def typed(key: str, value: Any) -> str:
    """The TOML of a value of a key, such as stands behind ``--set key=``."""
    try:
        return _toml(value)
    except TypeError:
        text = "must be a number, a text, true or false, or a list or dict of these"
        raise TypeError(f"{key} = {value!r}: {text}") from None


def _toml(value: Any) -> str:
    value = _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        entries = [f"{json.dumps(str(key), ensure_ascii=False)} = {_toml(entry)}" for key, entry in value.items()]
        return "{ " + ", ".join(entries) + " }"
    if _is_list(value):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    raise TypeError


def _plain(value: Any) -> Any:
    """A scalar or an array of numpy as Python has them."""
    return value.tolist() if hasattr(value, "tolist") else value


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, (str, *_BYTES))


def listed(key: str, values: Any) -> str:
    """Values of a key that is varied, as behind ``--vary key=``; a dict is that of a file of a sweep."""
    if isinstance(values, str):
        return values
    if isinstance(values, Mapping):
        return _ranged(key, values)
    plain = _plain(values)
    try:
        return ",".join(_toml(value) for value in (plain if _is_list(plain) else [plain]))
    except TypeError:
        raise TypeError(f"{key} = {values!r}: {_FORMS}") from None


def _ranged(key: str, form: Mapping[str, Any]) -> str:
    """A range or a distribution."""
    if form.keys() == {"from", "to", "step"} and all(isinstance(number, Real) for number in form.values()):
        return ":".join(_toml(form[name]) for name in ("from", "to", "step"))
    if len(form) == 1:
        [(name, numbers)] = form.items()
        if _is_list(_plain(numbers)):
            return f"{name}({listed(key, numbers)})"
    raise SweepError(f"{key} = {dict(form)!r}: {_FORMS}")
