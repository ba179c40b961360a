"""Arrays and counts as the native half reads them: row by row, aligned, in this machine's byte order; within its range."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from ._cones import Error


def plain(values: Any, kind: Any) -> np.ndarray:
    """The array itself if it lies in memory like that, a copy otherwise (what comes over a network may not be aligned)."""
    return np.require(values, dtype=kind, requirements=("C_CONTIGUOUS", "ALIGNED", "ENSUREARRAY"))


def count(option: str, things: str, n: Any, most: int = sys.maxsize) -> int:
    """A number of something, as far as one can be meant."""
    if not 0 <= n <= most or int(n) != n:
        raise Error(f"{option} is a number of {things}, not {n!r}")
    return int(n)
