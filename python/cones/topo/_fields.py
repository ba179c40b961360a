"""What is asked of a field."""

from __future__ import annotations

import math
from dataclasses import dataclass, field as _field
from typing import Any, Optional

import numpy as np

from .. import _cones
from .._arrays import counted, places, plain
from .._cones import Error
from ._domain import Field
from ._pairs import Pairs, Persistence, nouns, pair_table

_KINDS = {"minimum": False, "maximum": True}


def sublevel(
    field: Any,
    domain: Any = None,
    *,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Pairs:
    """The minima of a field, paired with the saddles at which the components of its sublevel sets merge.

    Parameters
    ----------
    field : array of one to three axes, or (vertices,) with a domain
        Of masked arrays (`numpy.ma`) the masked cells are left out. A picture in colour (h, w, 3) would be read as a volume: take a channel
        of it, or their mean.
    domain : Graph, TriangleMesh, scipy sparse matrix or networkx graph, optional
        With networkx the field may also be a mapping from nodes, or the name of an attribute of theirs.
    connectivity : "axis" (default), "full" or "freudenthal"
        2, 4, 6 neighbours; 2, 8, 26; or the edges of a triangulation: 2, 6, 14, which is the command's default.
    periodic : bool or sequence of bool
        Which axes go round.
    mask : array of bool, optional
        True inside of the domain.
    nan : "refuse" or "mask"
        Whether NaN is an error, or left out.
    keep_zeros : bool
        Keep pairs whose extremum and saddle have equal values.
    """
    read = Field(field, domain, connectivity=connectivity, periodic=periodic, mask=mask, nan=nan)
    return _pairs(read, False, keep_zeros)


def superlevel(
    field: Any,
    domain: Any = None,
    *,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Pairs:
    """The maxima of a field, paired with the saddles at which the components of its superlevel sets merge: their persistence is what
    mountaineers call prominence. Parameters as for `sublevel`."""
    read = Field(field, domain, connectivity=connectivity, periodic=periodic, mask=mask, nan=nan)
    return _pairs(read, True, keep_zeros)


def persistence(
    field: Any,
    domain: Any = None,
    *,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Persistence:
    """The pairs of both directions. Parameters as for `sublevel`."""
    read = Field(field, domain, connectivity=connectivity, periodic=periodic, mask=mask, nan=nan)
    return Persistence(_pairs(read, False, keep_zeros), _pairs(read, True, keep_zeros))


def _pairs(read: Field, is_superlevel: bool, keep_zeros: bool) -> Pairs:
    return Pairs(_cones.pairs_of(read.domain, read.values, is_superlevel, read.masks_nan, keep_zeros), read)


@dataclass(frozen=True)
class Segmentation:
    """Every vertex with its extremum.

    Attributes
    ----------
    extrema : ndarray int64
        The extremum of each segment: a vertex.
    labels : ndarray int32
        The segment of each vertex, in the shape of the field: a place in ``extrema``; -1 where a vertex is masked or, of
        `MergeTree.components`, beyond the level.
    """

    extrema: np.ndarray
    labels: np.ndarray = _field(repr=False)

    def sizes(self) -> np.ndarray:
        """How many vertices each segment has."""
        inside = self.labels[self.labels >= 0]
        return np.bincount(inside, minlength=len(self.extrema))


def segmentation(
    field: Any,
    domain: Any = None,
    *,
    kind: str = "maximum",
    threshold: float = 0.0,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
) -> Segmentation:
    """The basin of each minimum, or the territory of each maximum. Extrema that are no more persistent than ``threshold`` give theirs to the
    one beyond their saddle. Other parameters as for `sublevel`."""
    read = Field(field, domain, connectivity=connectivity, periodic=periodic, mask=mask, nan=nan)
    extrema, labels = _cones.segmentation(read.domain, read.values, _is_maximum(kind), threshold, read.masks_nan)
    return Segmentation(extrema, read.shaped(labels))


def simplify(
    field: Any,
    domain: Any = None,
    *,
    threshold: float,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
) -> np.ndarray:
    """The field without extrema that are no more persistent than ``threshold``, nowhere changed by more. What a mask leaves out is as it was.

    Removing minima can make maxima less persistent, and the other way round, which are then removed too: some that were up to twice as
    persistent as ``threshold`` may go. Parameters as for `sublevel`.
    """
    read = Field(field, domain, connectivity=connectivity, periodic=periodic, mask=mask, nan=nan)
    simple = read.shaped(_cones.simplify(read.domain, read.values, threshold, read.masks_nan))
    if read.given is None:
        return read.cast(simple)
    is_inside = ~np.isnan(simple)
    whole = read.given.copy()
    whole[is_inside] = simple[is_inside]
    return whole


class MergeTree:
    """How the components of sublevel sets (minima) or superlevel sets (maxima) appear, grow and merge: leaves are extrema, inner nodes
    saddles, and the root of each connected component is the last vertex to enter."""

    def __init__(self, native: _cones.Tree, read: Field):
        self._native = native
        self._read = read

    @property
    def is_superlevel(self) -> bool:
        """Whether leaves are maxima."""
        return self._native.is_superlevel

    @property
    def leaf_count(self) -> int:
        """How many leaves there are; they come first among the nodes."""
        return self._native.leaf_count

    def nodes(self) -> np.ndarray:
        """Leaves, then saddles in the order in which they enter, then other roots: a structured array (vertex, value, parent), the parent as a
        place in it, -1 for roots."""
        vertex, value, parent = self._native.nodes()
        value = self._read.cast(value)
        table = np.empty(len(vertex), dtype=[("vertex", "i8"), ("value", value.dtype), ("parent", "i8")])
        table["vertex"], table["value"], table["parent"] = vertex, value, parent
        return table

    def branches(self) -> np.ndarray:
        """The extrema with their families: the columns of `Pairs`, ``parent`` (the extremum that is joined at the saddle, -1 for none) and
        ``size`` (vertices just before)."""
        columns, parent, size = self._native.branches()
        pairs = pair_table(columns, self._read.dtype)
        table = np.empty(len(pairs), dtype=[*pairs.dtype.descr, ("parent", "i8"), ("size", "i8")])
        for name in pairs.dtype.names or ():
            table[name] = pairs[name]
        table["parent"], table["size"] = parent, size
        return table

    def sums(self, weights: Any) -> np.ndarray:
        """For each branch what the vertices of its component weigh just before the saddle."""
        return self._native.sums(plain(weights, np.float64).reshape(-1))

    def segmentation(self, threshold: float = 0.0) -> Segmentation:
        """The basins of all leaves that are more persistent than a threshold."""
        extrema, labels = self._native.segmentation(threshold)
        return Segmentation(extrema, self._read.shaped(labels))

    def clusters(self, count: int) -> Segmentation:
        """The basins of as many leaves as are wanted, those of the most persistent branches, or of all if there are fewer; never fewer than
        connected components. On the maxima of a density these are the clusters of ToMATo, see `tomato`."""
        if count < 0:
            raise Error(f"there cannot be {count} clusters")
        extrema, labels = self._native.clusters(count)
        return Segmentation(extrema, self._read.shaped(labels))

    def components(self, level: Any) -> tuple[np.ndarray, Segmentation]:
        """The components of the set of vertices up to a level (for maxima: from it upwards): a structured array (extremum, value, saddle, size),
        and the component of each vertex. The level may be any number, also where the field is of integers."""
        values = self._read.values
        columns = [("extremum", "i8"), ("value", self._read.cast(values[:0]).dtype), ("saddle", "i8"), ("size", "i8")]
        number = _level(level, values.dtype, self.is_superlevel)
        if number is None:
            labels = np.full(values.size, -1, dtype=np.int32)
            return np.empty(0, dtype=columns), Segmentation(np.empty(0, dtype=np.int64), self._read.shaped(labels))
        (extremum, value, saddle, size), (extrema, labels) = self._native.components(number)
        value = self._read.cast(value)
        table = np.empty(len(extremum), dtype=columns)
        table["extremum"], table["value"], table["saddle"], table["size"] = extremum, value, saddle, size
        return table, Segmentation(extrema, self._read.shaped(labels))

    def simplify(self, threshold: float) -> MergeTree:
        """The tree without branches that live no longer than a threshold."""
        return MergeTree(self._native.simplify(threshold), self._read)

    def field(self) -> np.ndarray:
        """The field as the tree has it: after `simplify` without the basins of branches that have gone. A masked field is float."""
        values = self._read.shaped(self._native.field)
        return values if self._read.masks_nan else self._read.cast(values)

    def __repr__(self) -> str:
        return f"<cones.topo.MergeTree of {counted(self.leaf_count, *nouns(self.is_superlevel))}>"


def merge_tree(
    field: Any,
    domain: Any = None,
    *,
    kind: str = "maximum",
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
) -> MergeTree:
    """The tree of components of all sublevel sets (``kind="minimum"``) or superlevel sets. Other parameters as for `sublevel`."""
    read = Field(field, domain, connectivity=connectivity, periodic=periodic, mask=mask, nan=nan)
    return MergeTree(_cones.merge_tree(read.domain, read.values, _is_maximum(kind), read.masks_nan), read)


def tomato(
    density: Any,
    domain: Any = None,
    *,
    count: Optional[int] = None,
    prominence: Optional[float] = None,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    mask: Any = None,
    nan: str = "refuse",
) -> Segmentation:
    """Clusters by ToMATo (Chazal, Guibas, Oudot & Skraba 2013): the territories of the maxima of a density on a neighbour graph, as many as
    ``count``, or of those that stand out by more than ``prominence``. Which of these to ask for shows in ``superlevel(density, domain).ranked()``:
    where persistence falls. Other parameters as for `sublevel`."""
    if (count is None) == (prominence is None):
        raise Error("give a count of clusters or a least prominence, one of them")
    options: dict[str, Any] = {"connectivity": connectivity, "periodic": periodic, "mask": mask, "nan": nan}
    if count is None:
        return segmentation(density, domain, kind="maximum", threshold=prominence or 0.0, **options)
    return merge_tree(density, domain, kind="maximum", **options).clusters(count)


def holes(
    field: Any, *, kind: str = "minimum", connectivity: str = "axis", mask: Any = None, nan: str = "refuse"
) -> np.ndarray:
    """The holes of the sublevel sets (``kind="minimum"``) or superlevel sets of a picture, or the cavities of those of a volume: persistent
    homology of dimension 1, or 2. Parameters as for `sublevel`; what a mask leaves out is in no set, so that a hole round it is never filled.

    Returns
    -------
    structured array (closed, filled, birth, death)
        ``closed`` is the vertex that closes the ring or the shell, ``filled`` the one inside that is reached last, both as in
        ``field.ravel()``; birth and death are the values there. Of a hole that is never filled ``filled`` is -1 and death infinite. Birth and
        death are floats where anything is left out.
    """
    read, is_superlevel = Field(field, connectivity=connectivity, mask=mask, nan=nan), _is_maximum(kind)
    values = read.values
    outside = np.isnan(values) if read.masks_nan and values.dtype.kind == "f" else np.zeros(0, dtype=bool)
    if outside.any():
        values = np.where(outside, values.dtype.type(-np.inf if is_superlevel else np.inf), values)
    closed, filled, birth, death = _cones.holes(read.domain, values, is_superlevel)
    if outside.any():
        filled = np.where(outside[filled], -1, filled)
    else:
        birth, death = read.cast(birth), read.cast(death)
    table = np.empty(len(closed), dtype=[("closed", "i8"), ("filled", "i8"), ("birth", birth.dtype), ("death", birth.dtype)])
    table["closed"], table["filled"], table["birth"], table["death"] = closed, filled, birth, death
    return table


def isolation(
    field: Any,
    extrema: Any,
    *,
    kind: str = "maximum",
    periodic: Any = False,
) -> np.ndarray:
    """For each extremum how far it is to the nearest vertex that is more extreme, connected to it or not; infinite where there is none. The
    distance is Euclidean, and a step along an axis is 1. NaN and masked cells are passed over. Ctrl-C does not stop it."""
    read = Field(field, periodic=periodic, nan="mask")
    vertices = places("extrema", extrema, read.values.size)
    return _cones.isolation(read.domain, read.values, _is_maximum(kind), vertices)


def _level(level: Any, kind: np.dtype, is_superlevel: bool) -> Any:
    """The level in a field's kind of numbers that takes in the same vertices; none if it takes in no vertex, whatever the field."""
    if level != level:
        raise Error("a level is a number, not NaN")
    if kind.kind == "f":
        # As numpy compares: a number of Python is taken to the field's kind, one of a wider kind is exact.
        near = kind.type(level)
        if isinstance(level, np.generic) and near != level and (near > level) != is_superlevel:
            near = np.nextafter(near, kind.type(np.inf if is_superlevel else -np.inf))
        return near.item()
    # As a number of Python, which compares integers and floats exactly.
    level = level.item() if isinstance(level, (np.ndarray, np.generic)) else level
    least, most = np.iinfo(kind).min, np.iinfo(kind).max
    if level > most if is_superlevel else level < least:
        return None
    inside = min(max(level, least), most)
    return math.ceil(inside) if is_superlevel else math.floor(inside)


def _is_maximum(kind: str) -> bool:
    if kind not in _KINDS:
        raise Error(f"kind is minimum or maximum, not {kind!r}")
    return _KINDS[kind]
