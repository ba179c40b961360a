"""Persistence by blocks: tiles of a grid as bytes that join, with the pairs that have become final.

This is what `cones.dask.persistence` is made of, and what any other engine (MPI, Ray, Spark) can carry:

1. cut the grid right through, and for each tile and direction call `summarise` with its own values and the layer after them;
2. `join` the bytes, in any order and grouping, neighbours first if little is to be moved;
3. `collect` the tables of all these calls: the pairs of the whole in one piece.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from .. import _cones
from .._arrays import count, counted, unmasked
from .._cones import Error
from ._domain import _read_in_place, masked, refuse_nan
from ._pairs import Pairs, pair_table


@dataclass(frozen=True)
class Part:
    """What is known of a part of a field: what is carried on, and what is final."""

    #: The summary; its size is that of the part's border.
    summary: bytes
    #: The kind of numbers that it is about, as numpy names it.
    number: str
    #: Final pairs: the columns of `Pairs`.
    table: np.ndarray
    #: How many pairs of equal values there were, kept or not.
    zero_count: int

    def __sizeof__(self) -> int:
        """Bytes, which tell a scheduler what it costs to move."""
        return 200 + len(self.summary) + self.table.nbytes


def reach(start: tuple, stop: tuple, shape: tuple, periodic: tuple) -> list[list[tuple[int, int]]]:
    """The ranges of the values that a tile needs along each axis: its own and the layer after them, round the end of a periodic axis."""
    ranges = []
    for low, high, length, goes_round in zip(start, stop, shape, periodic):
        is_cut = high - low < length
        if is_cut and high < length:
            ranges.append([(low, high + 1)])
        elif is_cut and goes_round:
            ranges.append([(low, high), (0, 1)])
        else:
            ranges.append([(low, high)])
    return ranges


def summarise(
    values: Any,
    start: tuple,
    stop: tuple,
    shape: tuple,
    *,
    superlevel: bool,
    connectivity: str = "axis",
    periodic: tuple = (False, False, False),
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Part:
    """Sums up the tile from ``start`` to ``stop`` of a grid of some shape; its values are those that `reach` says. Of a masked array the masked
    cells are left out, and all other tiles must be masked arrays too: their numbers are then floats."""
    field, inside = unmasked(values)
    if nan == "refuse" and inside is not None:
        refuse_nan(field, inside)
    read = _read_in_place(field if inside is None else masked(field, inside))
    grid = _cones.Domain.grid(list(shape), connectivity, list(periodic[: len(shape)]))
    bytes_, columns, zeros = _cones.summarise(
        grid, list(start), list(stop), read, superlevel, nan == "mask" or inside is not None, keep_zeros
    )
    return Part(bytes_, read.dtype.str[1:], pair_table(columns, field.dtype), zeros)


def join(*parts: Part) -> Part:
    """What is known of several parts together. Tables are not carried on: each has what has become final in its call."""
    first = parts[0]
    bytes_, columns, zeros = _cones.join_summaries(first.number, [part.summary for part in parts])
    return Part(bytes_, first.number, pair_table(columns, first.table["birth"].dtype), zeros)


def collect(last: Part, tables: list, zero_count: int, *, superlevel: bool, shape: tuple) -> Pairs:
    """The pairs of the whole: of the last join and the tables of all calls."""
    open_ = _cones.open_vertices(last.number, last.summary)
    if open_:
        raise Error(f"{counted(open_, 'vertex is', 'vertices are')} shared with tiles that have not been joined")
    table = np.concatenate(tables)
    return Collected(table[np.argsort(table["extremum"], kind="stable")], zero_count, superlevel, shape)


class Collected(Pairs):
    """`Pairs` that came from many parts: the same tables."""

    def __init__(self, table: np.ndarray, zero_count: int, superlevel: bool, shape: tuple):
        self.array = table
        self.shape = shape
        self.names: Optional[list] = None
        self._zero_count, self._superlevel = zero_count, superlevel

    @property
    def is_superlevel(self) -> bool:
        """Whether the extrema are maxima."""
        return self._superlevel

    @property
    def zero_count(self) -> int:
        """How many finite pairs have an extremum and a saddle of equal value, kept or not."""
        return self._zero_count

    def ranked(self) -> np.ndarray:
        """All pairs, most persistent first, as a structured array."""
        table = self.array
        # Equally persistent ones as they enter: minima by rising value and index, maxima by falling ones.
        order = np.lexsort((table["extremum"], table["birth"]))
        order = order[::-1] if self._superlevel else order
        order = order[np.argsort(table["saddle"][order] >= 0, kind="stable")]
        birth, death = table["birth"][order], table["death"][order]
        if birth.dtype.kind in "iu":
            # Exact, also where a float is not; how far the largest is above each, as unsigned numbers have no sign to turn.
            lives = np.maximum(birth, death).astype(np.uint64) - np.minimum(birth, death).astype(np.uint64)
            return table[order[np.argsort(~lives, kind="stable")]]
        return table[order[np.argsort(-table["persistence"][order], kind="stable")]]

    def top(self, n: int) -> np.ndarray:
        """The n most persistent pairs."""
        return self.ranked()[: count("n", "pairs", n)]

    def above(self, threshold: float) -> np.ndarray:
        """The pairs of persistence strictly above a threshold."""
        if not threshold >= 0:
            raise Error(f"a threshold of persistence must be 0 at least, but {threshold} is given")
        return self.array[self.array["persistence"] > threshold]

    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """Birth and death of the finite pairs, and the births of the essential classes, as `Pairs.points` gives them."""
        table = self.array
        points = np.column_stack([table["birth"].astype(np.float64), table["death"].astype(np.float64)])
        lives = table["saddle"] < 0
        return points[~lives], points[lives, 0]

    def __len__(self) -> int:
        return len(self.array)
