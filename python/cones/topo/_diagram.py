"""Diagrams: how far two are apart, and diagrams as vectors. Clusters of weighted edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Union

import numpy as np

from .. import _cones
from .._arrays import count as whole, number, plain
from .._cones import Error
from ._domain import edge_table, vertex_count
from ._pairs import Pairs

#: The numbers of an image or of a landscape: 2 GB.
_MOST_CELLS = 2**28


class Diagram:
    """Points (birth, death). Made of `Pairs`, or of an array (n, 2) whose essential classes have an infinite death (which in an
    array no finite pair can have: where a field has infinite values, give its `Pairs`).

    As vectors: only `betti_curve` counts essential classes. The others, entropy, persistence curve, landscape, silhouette and image, leave
    them out, as they have no lifetime.
    """

    def __init__(self, points: Union[Pairs, Diagram, Any]):
        if isinstance(points, Pairs):
            # Of pairs it is known: those that die where the field is infinite are no essential classes.
            (finite, essential), falls = points.points(), points.is_superlevel
        else:
            finite, essential, falls = _split(np.asarray(points, dtype=np.float64))
        #: Points of finite pairs (n, 2).
        self.finite = plain(finite, np.float64)
        #: Births of essential classes (k,).
        self.essential = plain(essential, np.float64)
        self._native = _cones.Diagram(self.finite, self.essential, bool(falls))

    def entropy(self) -> float:
        """The entropy of the lifetimes, as parts of their sum; without essential classes."""
        return self._native.entropy()

    def betti_curve(self) -> np.ndarray:
        """How many components there are from each level on, essential classes among them: (k, 2)."""
        return np.array(self._native.betti_curve(), dtype=np.float64).reshape(-1, 2)

    def persistence_curve(self) -> np.ndarray:
        """How many finite pairs are more persistent than each threshold: (k, 2)."""
        return np.array(self._native.persistence_curve(), dtype=np.float64).reshape(-1, 2)

    def landscape(self, levels: Any, count: int = 5) -> np.ndarray:
        """The first functions of the persistence landscape at some levels: (count, levels); without essential classes."""
        at, functions = plain(levels, np.float64).reshape(-1), whole("count", "functions", count)
        if functions * at.size > _MOST_CELLS:
            raise Error(f"{functions:,} functions at {at.size:,} levels are more than {_MOST_CELLS:,} numbers: ask for fewer")
        return self._native.landscape(functions, at).reshape(functions, at.size)

    def silhouette(self, levels: Any, power: float = 1.0) -> np.ndarray:
        """The silhouette at some levels, tents weighted by a power of the lifetime; without essential classes."""
        return self._native.silhouette(number("power", power, 0.0), plain(levels, np.float64).reshape(-1))

    def image(self, births: tuple, lifetimes: tuple, shape: tuple, bandwidth: float) -> np.ndarray:
        """The persistence image: a row for each of some lifetimes, a column for each of some births, both (first, last). Each finite point adds
        a Gaussian of width ``bandwidth`` whose mass is its lifetime."""
        rows, columns = (whole("shape", "rows, and one of columns", length) for length in shape)
        if rows * columns > _MOST_CELLS:
            raise Error(f"an image of {rows} x {columns} cells is larger than {_MOST_CELLS:,}: ask for a smaller shape")
        if not 0 < bandwidth < float("inf"):
            raise Error(f"bandwidth is the width of a Gaussian, above 0, not {bandwidth}")
        for name, ends in (("births", births), ("lifetimes", lifetimes)):
            if np.shape(ends) != (2,) or not np.isfinite(ends).all():
                raise Error(f"{name} is a range of finite numbers, (first, last), not {ends!r}")
        return self._native.image(tuple(births), tuple(lifetimes), [rows, columns], bandwidth).reshape(rows, columns)

    def __len__(self) -> int:
        return len(self.finite) + len(self.essential)


@dataclass(frozen=True)
class Matching:
    """Which points of two diagrams go to each other."""

    distance: float
    #: Places among the finite points of both, (k, 2); -1 is the diagonal.
    finite: np.ndarray
    #: Places among the essential classes of both, (k, 2).
    essential: np.ndarray


def bottleneck(a: Any, b: Any) -> float:
    """The bottleneck distance of two diagrams (`Pairs`, `Diagram` or (n, 2)); exact. A step of the search takes O(n² √n) at worst for n
    points."""
    return _diagram(a)._native.bottleneck(_diagram(b)._native)


def wasserstein(a: Any, b: Any, order: float = 2.0, *, ground: float = float("inf"), relative_error: float = 0.01) -> float:
    """The Wasserstein distance of some order; steps are measured by the norm ``ground``. Too large by ``relative_error`` at most; exact for
    diagrams of 200 points and fewer, and with 0, which takes O(n³) at worst for n points."""
    return _diagram(a)._native.wasserstein(_diagram(b)._native, order, ground, relative_error)


def matching(a: Any, b: Any, order: float = 2.0, *, ground: float = float("inf"), relative_error: float = 0.01) -> Matching:
    """The Wasserstein distance with a matching that has it. Parameters and cost as for `wasserstein`."""
    distance, finite, essential = _diagram(a)._native.matching(_diagram(b)._native, order, ground, relative_error)
    pairs = [np.array(part, dtype=np.int64).reshape(-1, 2) for part in (finite, essential)]
    return Matching(distance, *pairs)


def _diagram(points: Any) -> Diagram:
    return points if isinstance(points, Diagram) else Diagram(points)


def _split(table: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """The finite points of a table, births of its essential classes, and whether points die below their births."""
    table = table.reshape(0, 2) if table.size == 0 else table
    if table.ndim != 2 or table.shape[1] != 2:
        raise Error(f"a diagram has the shape (n, 2), but {table.shape} is given")
    births, deaths = table.T
    lives, falls = np.isfinite(births) & np.isinf(deaths), bool((deaths < births).any())
    if falls and (deaths > births).any():
        raise Error("some points of the diagram die above their birth and others below")
    return table[~lives], births[lives], falls


class Linkage:
    """The clusters of weighted edges, from the lightest edge on."""

    def __init__(self, native: _cones.Linkage):
        self._native = native

    @property
    def links(self) -> np.ndarray:
        """Both clusters, weight and size of each link: (k, 4), which is what ``scipy.cluster.hierarchy`` calls Z where the graph is connected."""
        return self._native.links()

    def at(self, weight: float) -> np.ndarray:
        """The cluster of each vertex after all links up to a weight."""
        return self._native.at(number("weight", weight, float("-inf")))

    def clusters(self, count: int) -> np.ndarray:
        """The cluster of each vertex where there are so many clusters."""
        return self._native.clusters(whole("count", "clusters", count))


def single_linkage(vertices: int, edges: Any, weights: Any) -> Linkage:
    """Single linkage of weighted edges (m, 2): clusters joined from the lightest edge on."""
    numbers = plain(weights, np.float64)
    if numbers.ndim != 1:
        raise Error(f"weights are one number for each edge, (m,), but they have the shape {numbers.shape}")
    return Linkage(_cones.single_linkage(vertex_count(vertices), edge_table(edges), numbers))
