"""Tables of results."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._arguments import imported
from ._pantoline import check_name

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class Table(Sequence[dict[str, Any]]):
    """Rows with the same keys; a sequence of dictionaries, and a data frame on request."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self._rows = [dict(row) for row in rows]

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""
        return list(dict.fromkeys(key for row in self._rows for key in row))

    def column(self, name: str) -> list[Any]:
        """Values of a column; ``None`` where a row has none.

        Raises:
            KeyError: No such column; the message has the nearest name.
        """
        check_name(name, self.columns)
        return [row.get(name) for row in self._rows]

    def to_arrow(self) -> pyarrow.Table:
        """The table in Arrow."""
        import pyarrow

        return pyarrow.table({name: self.column(name) for name in self.columns})

    def to_pandas(self) -> pandas.DataFrame:
        """The table in pandas, which must be installed."""
        pandas = imported("pandas", "pandas", "to_pandas()")
        return pandas.DataFrame({name: self.column(name) for name in self.columns})

    def to_polars(self) -> polars.DataFrame:
        """The table in polars, which must be installed."""
        polars = imported("polars", "polars", "to_polars()")
        return polars.DataFrame({name: self.column(name) for name in self.columns})

    def __getitem__(self, index: Any) -> Any:
        return self._rows[index]

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return iter(self._rows)

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows: {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{_shown(name)}</th>" for name in self.columns)
        rows = "".join("<tr>" + "".join(f"<td>{_shown(row.get(name))}</td>" for name in self.columns) + "</tr>" for row in self)
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _shown(value: Any) -> str:
    if value is None:
        return ""
    return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))
