"""0-dimensional persistence of scalar fields: which hills and valleys matter, and how much.

    >>> import numpy as np
    >>> from cones import topo
    >>> peaks = topo.superlevel(np.array([0.0, 7.0, 2.0, 5.0, 4.0, 9.0]))
    >>> [(p["extremum"].item(), p["saddle"].item(), p["persistence"].item()) for p in peaks.ranked()]
    [(5, -1, 9.0), (1, 2, 5.0), (3, 4, 1.0)]

| what | where |
|---|---|
| pairs of minima, of maxima, of both | `sublevel`, `superlevel`, `persistence`: `Pairs` |
| how components merge | `merge_tree`: `MergeTree` |
| the basin of each extremum | `segmentation` |
| a field without small extrema | `simplify` |
| holes of pictures, cavities of volumes | `holes` |
| how far it is to a higher summit | `isolation` |
| clusters of weighted edges | `single_linkage` |
| how far two diagrams are apart | `bottleneck`, `wasserstein`, `matching` |
| diagrams as vectors | `Diagram`: landscapes, images, curves, entropy |
| figures | `cones.topo.plot` (matplotlib) |

A field is an array of one to three axes, on a grid of its shape; or a value for each vertex of a ``domain``: a `Graph`, a
`TriangleMesh`, a scipy sparse matrix or a networkx graph. Vertices are numbered as in ``field.ravel()``: use
``numpy.unravel_index(vertex, field.shape)``.

Fields of 8 to 64 bit integers and 32 or 64 bit floats are read where they lie if they are C-contiguous; ``int8``, ``uint32``, ``bool`` and
``float16`` are widened first. Vertices are ordered by (value, index). NaN is refused unless ``nan="mask"``, which leaves such vertices out;
so do ``mask``, an array that is true inside of the domain, and the mask of a masked array. An array of three axes is a volume, also a
picture in colour (h, w, 3). While a field is read no other thread may change it.
"""

from importlib import import_module as _import_module
from typing import Any as _Any

from ._diagram import Diagram, Linkage, Matching, bottleneck, matching, single_linkage, wasserstein
from ._domain import Graph, TriangleMesh
from ._fields import (
    MergeTree,
    Segmentation,
    holes,
    isolation,
    merge_tree,
    persistence,
    segmentation,
    simplify,
    sublevel,
    superlevel,
    tomato,
)
from ._pairs import Pairs, Persistence


def __getattr__(name: str) -> _Any:
    """Figures, which need matplotlib, are loaded when they are first asked for."""
    if name == "plot":
        return _import_module(".plot", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "Diagram",
    "Graph",
    "Linkage",
    "Matching",
    "MergeTree",
    "Pairs",
    "Persistence",
    "Segmentation",
    "TriangleMesh",
    "bottleneck",
    "holes",
    "isolation",
    "matching",
    "merge_tree",
    "persistence",
    "segmentation",
    "simplify",
    "single_linkage",
    "sublevel",
    "superlevel",
    "tomato",
    "wasserstein",
]
