"""Cone-based conformal unwrapping of surfaces, and 0-dimensional persistence of scalar fields.

    >>> import cones
    >>> mesh = cones.shape("capsule", 500)
    >>> result = cones.unwrap(mesh, n=4)
    >>> result.uv.shape == (mesh.corner_count, 2), len(result.cones)
    (True, 4)

| what | where |
|---|---|
| unwrapping in one call | `unwrap`, which gives an `Unwrapping` |
| one analysis, many maps | `Analysis`: place, predict, order, curve, flatten |
| maps that somebody made | `measure`, `islands`, `pack` |
| files | `read`, `Mesh.write`, `Unwrapping.write` |
| scalar fields | `cones.topo`: pairs, merge trees, segments, distances |
| many meshes, fields in blocks | `cones.dask` |
| figures | `cones.plot` (matplotlib) |

Arrays are numpy's, and lie in memory as numpy has them: C-contiguous ones of the right type are read in place. Work runs without the
interpreter's lock, on as many threads as ``RAYON_NUM_THREADS`` says or as there are cores; results do not depend on how many. Ctrl-C
stops it, and so does an exception of ``progress(stage, fraction)``, which is called in the caller's thread: the fraction is None where it is
not known, and short work may end before the first call. What cannot be had raises
`Error`, with the sentence that the command prints.
"""

from importlib import import_module as _import_module
from typing import Any as _Any

from . import topo
from ._cones import METHODS, Error, __version__, thread_count
from .analysis import Analysis, Cones, Order
from .maps import Islands, Measures, Packing, islands, measure, pack
from .mesh import Mesh, read, shape
from .unwrapping import Unwrapping, unwrap


def __getattr__(name: str) -> _Any:
    """Figures, which need matplotlib, are loaded when they are first asked for."""
    if name == "plot":
        return _import_module(".plot", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "METHODS",
    "Analysis",
    "Cones",
    "Error",
    "Islands",
    "Measures",
    "Mesh",
    "Order",
    "Packing",
    "Unwrapping",
    "__version__",
    "islands",
    "measure",
    "pack",
    "read",
    "shape",
    "thread_count",
    "topo",
    "unwrap",
]
