"""The pairs of a field: extremum and saddle, birth and death."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Optional

import numpy as np

from .. import _cones
from .._arrays import count, counted
from ._domain import Field


class Pairs:
    """The pairs of one direction, by rising index of their extrema.

    Tables are structured arrays, which ``pandas.DataFrame`` takes as they are:

    | what | type | meaning |
    |---|---|---|
    | extremum | int64 | the vertex at which a component is born, as in ``field.ravel()`` |
    | saddle | int64 | the vertex at which it joins an elder one; -1 for an essential class, which joins none |
    | birth | the field's type | the value at the extremum |
    | death | the field's type | the value at the saddle; for an essential class the last value to enter its component |
    | persistence | float64 | abs(death - birth); for an essential class the range of the field on its component |
    """

    def __init__(self, native: _cones.Pairs, field: Field):
        self._native = native
        self._field = field.dtype
        self.shape: tuple = field.shape
        #: The names of vertices, where the domain is a networkx graph.
        self.names: Optional[list] = field.names

    @property
    def is_superlevel(self) -> bool:
        """Whether the extrema are maxima."""
        return self._native.is_superlevel

    @property
    def zero_count(self) -> int:
        """How many finite pairs have an extremum and a saddle of equal value, kept or not."""
        return self._native.zero_count

    @cached_property
    def array(self) -> np.ndarray:
        """All pairs, as a structured array."""
        return self._table(self._native.all())

    def ranked(self) -> np.ndarray:
        """All pairs, most persistent first, as a structured array."""
        return self._table(self._native.ranked())

    def top(self, n: int) -> np.ndarray:
        """The n most persistent pairs, without sorting the others."""
        return self._table(self._native.top(count("n", "pairs", n)))

    def above(self, threshold: float) -> np.ndarray:
        """The pairs of persistence strictly above a threshold."""
        return self._table(self._native.above(threshold))

    def diagram(self) -> np.ndarray:
        """Points (birth, death) as gudhi's ``persistence_intervals_in_dimension(0)``, persim and ripser have them: (n, 2) float64, essential
        classes with an infinite death (-inf for maxima). Integers beyond 2**53 are rounded."""
        finite, essential = self.points()
        never = np.full(len(essential), -np.inf if self.is_superlevel else np.inf)
        return np.concatenate([finite, np.column_stack([essential, never])])

    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """Birth and death of the finite pairs (n, 2), and the births of the essential classes (k,), which no infinite value of a field is taken for."""
        return self._native.diagram()

    def gudhi(self) -> list[tuple[int, tuple[float, float]]]:
        """What gudhi's ``persistence()`` gives: (dimension, (birth, death)), longest first."""
        points = self.diagram()
        lives = np.abs(points[:, 1] - points[:, 0])
        return [(0, (birth, death)) for birth, death in points[np.argsort(-lives, kind="stable")].tolist()]

    def positions(self, vertices: Any) -> np.ndarray:
        """Where vertices are in the field's array: (n, axes)."""
        return np.column_stack(np.unravel_index(vertices, self.shape))

    def to_pandas(self) -> Any:
        """The pairs as a ``pandas.DataFrame``."""
        import pandas

        return pandas.DataFrame(self.array)

    def _table(self, columns: tuple) -> np.ndarray:
        return pair_table(columns, self._field)

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return f"<cones.topo.Pairs: {counted(len(self), *nouns(self.is_superlevel))}>"


@dataclass(frozen=True)
class Persistence:
    """The pairs of both directions."""

    minima: Pairs
    maxima: Pairs

    def extrema(self) -> np.ndarray:
        """The extrema of both kinds, most persistent first: the columns of `Pairs` and ``is_maximum``."""
        kinds = [(self.minima, False), (self.maxima, True)]
        tables = []
        for pairs, is_maximum in kinds:
            table = np.empty(len(pairs), dtype=[*pairs.array.dtype.descr, ("is_maximum", bool)])
            for name in pairs.array.dtype.names or ():
                table[name] = pairs.array[name]
            table["is_maximum"] = is_maximum
            tables.append(table)
        both = np.concatenate(tables)
        return both[np.argsort(-both["persistence"], kind="stable")]


def nouns(is_superlevel: bool) -> tuple[str, str]:
    """What the extrema of a direction are called, one and many."""
    return ("maximum", "maxima") if is_superlevel else ("minimum", "minima")


def pair_table(columns: tuple, kind: np.dtype) -> np.ndarray:
    """A structured array of columns, births and deaths in the field's kind of numbers."""
    extremum, saddle, birth, death, persistence = columns
    kind = birth.dtype if kind.kind == "O" else kind.newbyteorder("=")
    table = np.empty(
        len(extremum),
        dtype=[("extremum", "i8"), ("saddle", "i8"), ("birth", kind), ("death", kind), ("persistence", "f8")],
    )
    table["extremum"], table["saddle"], table["birth"] = extremum, saddle, birth
    table["death"], table["persistence"] = death, persistence
    return table
