"""Arrays as the native half reads them: row by row, aligned, in this machine's byte order."""

from __future__ import annotations

from typing import Any

import numpy as np


def plain(values: Any, kind: Any) -> np.ndarray:
    """The array itself if it lies in memory like that, a copy otherwise (what comes over a network may not be aligned)."""
    return np.require(values, dtype=kind, requirements=("C_CONTIGUOUS", "ALIGNED", "ENSUREARRAY"))
