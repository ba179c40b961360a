"""What a field lives on, and fields in the form that the native half reads."""

from __future__ import annotations

import os
from typing import Any, Optional, Union

import numpy as np

from .. import _cones
from .._arrays import count as whole, plain, unmasked
from .._cones import Error

#: Kinds of numbers that are read in place on grids; what others are widened to; and what is used on graphs and meshes.
_ON_GRIDS = {np.dtype(t) for t in ("u1", "u2", "i2", "i4", "i8", "u8", "f4", "f8")}
_WIDENED = {"b1": "u1", "i1": "i2", "u4": "i8", "f2": "f4"}
#: Integers beyond this are not all floats.
_EXACT = 2**53


def vertex_count(vertices: Any) -> int:
    """A number of vertices."""
    return whole("vertices", "vertices", vertices)


def edge_table(edges: Any) -> np.ndarray:
    """Edges as pairs of vertex indices."""
    table = np.asarray(edges)
    table = np.empty((0, 2), dtype=np.int64) if table.size == 0 else table
    if table.ndim != 2 or table.shape[1] != 2 or table.dtype.kind not in "iu":
        raise Error(f"edges are pairs of vertex indices of the shape (m, 2), but {table.shape} {table.dtype} is given")
    if table.dtype.kind == "u" and table.max(initial=0) > np.iinfo(np.int64).max:
        raise Error(f"an edge names vertex {table.max()}, which is not there")
    return plain(table, np.int64)


class Graph:
    """An undirected graph of ``vertices`` vertices and edges (m, 2). Repeated edges and loops change nothing."""

    def __init__(self, vertices: int, edges: Any):
        self.vertex_count = vertex_count(vertices)
        self._native = _cones.Domain.graph(self.vertex_count, edge_table(edges))

    @classmethod
    def from_rows(cls, starts: Any, indices: Any) -> Graph:
        """The graph whose vertex v has the neighbours ``indices[starts[v]:starts[v + 1]]``, an edge in one of two rows or in both: compressed
        rows, such as ``indptr`` and ``indices`` of scipy, or of a neighbour search. Indices of 32 and 64 bits are read where they lie."""
        starts, indices = np.asarray(starts), np.asarray(indices)
        if starts.ndim != 1 or indices.ndim != 1 or starts.dtype.kind not in "iu" or (indices.size and indices.dtype.kind not in "iu"):
            raise Error("compressed rows are two lists of integers: where rows start, and the neighbours in them")
        graph = cls.__new__(cls)
        kind = np.int32 if indices.dtype == np.int32 else np.int64
        graph._native = _cones.Domain.rows(plain(starts, np.int64), plain(indices, kind))
        graph.vertex_count = len(starts) - 1
        return graph

    @classmethod
    def from_sparse(cls, matrix: Any) -> Graph:
        """The graph whose edges are the stored entries of a square scipy sparse matrix, in either triangle or both."""
        rows, columns = matrix.shape
        if rows != columns:
            raise Error(f"the matrix of a graph is square, not ({rows}, {columns})")
        if matrix.format in ("csr", "csc"):
            return cls.from_rows(matrix.indptr, matrix.indices)
        entries = matrix.tocoo()
        return cls(rows, np.column_stack([entries.row, entries.col]).astype(np.int64))


class TriangleMesh:
    """The vertices and edges of triangles (m, 3), in any orientation, which need be no surface."""

    def __init__(self, vertices: int, triangles: Any):
        table = np.asarray(triangles)
        table = np.empty((0, 3), dtype=np.uint32) if table.size == 0 else table
        if table.ndim != 2 or table.dtype.kind not in "iu":
            raise Error(f"triangles have the shape (m, 3), but {table.shape} {table.dtype} is given")
        if table.size and (table.min() < 0 or table.max() >= 2**32):
            raise Error("a triangle names a vertex that is negative, or beyond 32 bits (vertices are counted from 0)")
        self.vertex_count = vertex_count(vertices)
        self._native = _cones.Domain.triangles(self.vertex_count, plain(table, np.uint32))


class Field:
    """A field on its domain, ready to be read."""

    def __init__(
        self,
        field: Any,
        domain: Any = None,
        *,
        connectivity: Optional[str] = None,
        periodic: Any = False,
        mask: Any = None,
        nan: str = "refuse",
    ):
        self.names: Optional[list] = None
        if _is_networkx(domain):
            self.names = list(domain.nodes)
            domain, field = _of_networkx(domain, field, self.names)
        if isinstance(field, (str, bytes, os.PathLike)):
            raise Error(f"a field is an array of numbers, not the name of a file: read it first, as with numpy.load({os.fspath(field)!r})")
        values, inside = unmasked(field)
        self.shape, self.dtype = values.shape, values.dtype
        if nan not in ("refuse", "mask"):
            raise Error(f"nan is refuse or mask, not {nan!r}")
        inside = _inside(mask, inside, values.shape)
        if nan == "refuse" and inside is not None:
            refuse_nan(values, inside)
        self.masks_nan = nan == "mask" or inside is not None
        #: The array as it was given, where cells of it are left out.
        self.given = values if inside is not None else None
        if inside is not None:
            values = masked(values, inside)
        if domain is None:
            self.domain = _grid(values.shape, connectivity, periodic)
            self.values = _read_in_place(values)
        else:
            if connectivity is not None or np.any(periodic):
                raise Error("connectivity and periodic are for fields on grids, without a domain")
            self.domain = _graph(domain)
            self.values = _widest(values)
            if values.ndim != 1:
                raise Error(f"a field on a domain has one value for each vertex, but it has the shape {values.shape}")

    def cast(self, values: np.ndarray) -> np.ndarray:
        """Values of the field in the kind of numbers that it came in; exact."""
        return values if values.dtype == self.dtype or self.dtype.kind == "O" else values.astype(self.dtype)

    def shaped(self, values: np.ndarray) -> np.ndarray:
        """One number for each vertex, in the shape of the field."""
        return values.reshape(self.shape)


def _grid(shape: tuple, connectivity: Optional[str], periodic: Any) -> _cones.Domain:
    axes = len(shape)
    if not 1 <= axes <= 3:
        raise Error(f"a field without a domain is an array of one to three axes, not {axes}")
    if connectivity not in (None, "axis", "full", "freudenthal"):
        raise Error(f"connectivity is axis, full or freudenthal, not {connectivity!r}")
    return _cones.Domain.grid(list(shape), connectivity or "axis", round_ends(periodic, axes))


def round_ends(periodic: Any, axes: int) -> list[bool]:
    """Which axes go round: all or none, or as it is said for each."""
    of_each = [periodic] * axes if isinstance(periodic, (bool, np.bool_)) else periodic
    is_list = isinstance(of_each, (list, tuple)) or (isinstance(of_each, np.ndarray) and of_each.ndim == 1)
    if not is_list or len(of_each) != axes or not all(isinstance(goes_round, (bool, np.bool_)) for goes_round in of_each):
        raise Error(f"periodic is True or False, or a list with one of them for each axis, {axes} here; it is {periodic!r}")
    return [bool(goes_round) for goes_round in of_each]


def _graph(domain: Any) -> _cones.Domain:
    if isinstance(domain, (Graph, TriangleMesh)):
        return domain._native
    if hasattr(domain, "tocoo"):
        return Graph.from_sparse(domain)._native
    raise Error("a domain is a topo.Graph, a topo.TriangleMesh, a scipy sparse matrix or a networkx graph")


def _read_in_place(values: np.ndarray) -> np.ndarray:
    kind = values.dtype
    if not kind.isnative:
        kind = kind.newbyteorder("=")
    if kind not in _ON_GRIDS:
        wider = _WIDENED.get(kind.str[1:])
        if wider is None:
            raise Error(f"a field is an array of integers or floats of up to 64 bits, not {values.dtype}")
        kind = np.dtype(wider)
    return plain(values, kind).reshape(-1)


def _widest(values: np.ndarray) -> np.ndarray:
    kind = values.dtype
    if kind.kind not in "biuf" or kind.itemsize > 8:
        raise Error(f"a field is an array of integers or floats of up to 64 bits, not {kind}")
    wide = {"b": np.int64, "i": np.int64, "f": np.float64}.get(kind.kind, np.uint64)
    return plain(values, wide)


def _inside(mask: Any, own: Optional[np.ndarray], shape: tuple) -> Optional[np.ndarray]:
    """The cells inside both a mask and the field's own, if there are any outside."""
    if mask is not None:
        mask = np.asarray(mask, dtype=bool)
        if mask.shape != shape:
            raise Error(f"the mask has the shape {mask.shape}, but the field {shape}")
        return mask if own is None else mask & own
    # Integers stay what they are where nothing is masked.
    return None if own is None or own.all() else own


def refuse_nan(values: np.ndarray, inside: np.ndarray) -> None:
    """Says so where values that are not left out are NaN."""
    missing = np.isnan(values[inside]).sum() if values.dtype.kind == "f" else 0
    if missing:
        raise Error(f"{missing:,} values that are not masked are NaN: leave them out too with nan='mask'")


def masked(values: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Floats that are NaN outside."""
    seen = values[inside] if values.dtype.kind in "iu" else values[:0]
    if seen.size and max(abs(int(seen.min())), abs(int(seen.max()))) > _EXACT:
        raise Error("integers beyond 2**53 cannot be masked: subtract a constant first")
    native = values.dtype.newbyteorder("=")
    floats = values.astype(native if native in (np.dtype("f4"), np.dtype("f8")) else np.dtype("f8"))
    floats[~inside] = np.nan
    return floats


def _is_networkx(domain: Any) -> bool:
    return hasattr(domain, "adjacency") and hasattr(domain, "nodes")


def _of_networkx(graph: Any, field: Any, names: list) -> tuple[Graph, Any]:
    """A networkx graph, and its field as an array: an array in the order of the nodes, a mapping, or the name of an attribute."""
    if graph.is_directed():
        raise Error("a directed graph has no sublevel components: use graph.to_undirected()")
    place = {name: k for k, name in enumerate(names)}
    edges = np.array([(place[a], place[b]) for a, b in graph.edges()], dtype=np.int64).reshape(-1, 2)
    values: Union[Any, list] = field
    try:
        if isinstance(field, str):
            values = [graph.nodes[name][field] for name in names]
        elif hasattr(field, "keys"):
            values = [field[name] for name in names]
    except KeyError as missing:
        raise Error(f"there is no value for {missing}") from None
    return Graph(len(names), edges), values
