"""Arrays and counts as the native half reads them: row by row, aligned, in this machine's byte order; within its range."""

from __future__ import annotations

import sys
from typing import Any, Optional

import numpy as np

from ._cones import Error


def plain(values: Any, kind: Any) -> np.ndarray:
    """The array itself if it lies in memory like that, a copy otherwise (what comes over a network may not be aligned)."""
    if np.ma.is_masked(values):
        masked = counted(np.ma.count_masked(values), "value of an array is", "values of an array are")
        raise Error(f"{masked} masked, where each is needed: fill them, or leave out what has none")
    return np.require(values, dtype=kind, requirements=("C_CONTIGUOUS", "ALIGNED", "ENSUREARRAY"))


def unmasked(values: Any) -> tuple[np.ndarray, Optional[np.ndarray]]:
    """An array, and which of its cells are inside where it is one of `numpy.ma`: those that are not masked."""
    inside = ~np.ma.getmaskarray(values) if isinstance(values, np.ma.MaskedArray) else None
    return np.asarray(values), inside


def count(option: str, things: str, n: Any, most: int = sys.maxsize) -> int:
    """A number of something, as far as one can be meant."""
    if not is_whole(n, most):
        raise Error(f"{option} is a number of {things}, not {n!r}")
    return int(n)


def counted(n: int, one: str, many: str) -> str:
    """A number with its noun: "1 face", "2 faces"."""
    return f"{n} {one if n == 1 else many}"


def is_whole(n: Any, most: int) -> bool:
    """Whether something is a whole number from 0 to ``most``, of whatever type."""
    try:
        return bool(0 <= n <= most and int(n) == n)
    except (TypeError, ValueError):
        return False


def number(name: str, value: Any, least: float, most: float = float("inf")) -> float:
    """A number within bounds, and not NaN."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise Error(f"{name} is a number, not {value!r}") from None
    if not least <= found <= most:
        bounds = "" if least == float("-inf") else f" of {least:g} at least" if most == float("inf") else f" from {least:g} to {most:g}"
        raise Error(f"{name} is a number{bounds}, not {value!r}")
    return found


def places(names: str, values: Any, size: int) -> np.ndarray:
    """Vertices that there are, of so many; ``names`` is what the caller calls them."""
    table = np.asarray(values).reshape(-1)
    if table.size and table.dtype.kind not in "iu":
        raise Error(f"{names} are vertices, which are integers, not {table.dtype}")
    wrong = table[(table < 0) | (table >= size)] if table.size else table
    if wrong.size:
        raise Error(f"{names} name vertex {wrong[0]}, which is not there: there are {size}, counted from 0")
    return plain(table, np.int64)
