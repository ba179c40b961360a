"""The analysis of a mesh: what is found once and asked many times."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Optional, Union

import numpy as np

from . import _cones, options
from ._arrays import count, counted
from ._cones import Error
from .mesh import Faces, Mesh, as_mesh
from .unwrapping import Progress, Unwrapping, cone_table

_EXTREMUM = np.dtype(
    [
        ("component", np.int64),
        ("vertex", np.int64),
        ("is_maximum", bool),
        ("value", np.float64),
        ("persistence", np.float64),
        ("saddle", np.int64),
    ]
)
_PREDICTION = np.dtype([("n", np.int64), ("predicted_l2", np.float64), ("predicted_area", np.float64)])
_ORDERED = np.dtype([("n", np.int64), ("component", np.int64), ("vertex", np.int64), ("curvature_at_n", np.float64)])


class Cones:
    """Cones that an `Analysis` has placed, with their curvatures and what is predicted for them."""

    def __init__(self, native: _cones.Cones, components: int):
        self._native = native
        self._components = components

    @cached_property
    def table(self) -> np.ndarray:
        """A structured array: component, vertex, position (3), kind, persistence, curvature in radians."""
        return cone_table(self._native.table())

    @property
    def vertices(self) -> np.ndarray:
        """The vertex of each cone."""
        return self.table["vertex"]

    @property
    def curvatures(self) -> np.ndarray:
        """The curvature of each cone in radians."""
        return self.table["curvature"]

    @property
    def prediction(self) -> dict:
        """What linear theory predicts: ``n``, ``predicted_l2`` (the norm of the log scale), ``predicted_area`` (D)."""
        return self._native.prediction

    @property
    def method(self) -> Optional[str]:
        """The method that has placed them; none where they were given."""
        return self._native.method

    @property
    def warnings(self) -> list[str]:
        """What was decided on the way, a sentence each."""
        return self._native.notes(self._components)

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return f"<cones.Cones: {len(self)}, predicted area distortion {self.prediction['predicted_area']:.3f}>"


class Order:
    """An order of cones of which every prefix is a set of cones, and what is predicted for each number.

    Attributes
    ----------
    method : str
    cones : structured array (n, component, vertex, curvature_at_n)
        The first N are the cones for N. The curvature is the one that a cone has where it is the last; NaN where those on its component are
        too few.
    curve : structured array (n, predicted_l2, predicted_area)
    """

    def __init__(self, found: dict):
        nan = float("nan")
        self.method: str = found["method"]
        rows = [
            (c["n"], c["component"], c["vertex"], nan if c["curvature_at_n"] is None else c["curvature_at_n"])
            for c in found["order"]
        ]
        self.cones = np.array(rows, dtype=_ORDERED)
        self.curve = np.array([(c["n"], c["predicted_l2"], c["predicted_area"]) for c in found["curve"]], dtype=_PREDICTION)


class Analysis:
    """A mesh with all that is found of it once: repair, intrinsic Delaunay triangulation, curvature, one factorization, the conformal
    factor and its extrema. It never changes, and several threads may ask it at the same time.

        >>> import cones
        >>> analysis = cones.Analysis(cones.shape("hare", 700))
        >>> four = analysis.place(4)
        >>> result = analysis.flatten(four)
        >>> len(result.cones), result.island_count
        (4, 1)

    Parameters
    ----------
    vertices, faces
        As for `cones.unwrap`.
    weld, smooth, refine, open_handles, fill_holes
        How it is made ready, as for `cones.unwrap`.
    progress : callable, optional
        ``progress(stage, fraction)`` while it is made, as for `cones.unwrap`.
    """

    def __init__(
        self,
        vertices: Any,
        faces: Optional[Faces] = None,
        *,
        weld: Union[bool, str] = "auto",
        smooth: bool = False,
        refine: str = "never",
        open_handles: str = "auto",
        fill_holes: Union[bool, float] = False,
        progress: Optional[Progress] = None,
    ):
        self.input = as_mesh(vertices, faces)
        self._weld = weld
        prepared = options.preparation(weld, smooth, refine, open_handles, fill_holes)
        self._native = _cones.Analysis(self.input._native, prepared, progress)

    @cached_property
    def mesh(self) -> Mesh:
        """The mesh that maps are of: the given one, or the refined one."""
        refined = self._native.refined
        return self.input if refined is None else Mesh._of(refined[0])

    @property
    def refined_face(self) -> Optional[np.ndarray]:
        """The given mesh's face for each triangle of the refined one; none where it was not refined."""
        refined = self._native.refined
        return None if refined is None else refined[1]

    def _layout(self, layout: dict) -> dict:
        for name in ("weld", "smooth", "refine", "open_handles", "fill_holes"):
            if name in layout:
                raise Error(f"{name} says how a mesh is made ready: give it to cones.Analysis, which has done that already")
        return options.layout(self.input, self._weld, self.mesh.vertex_count, **layout)

    def place(
        self,
        n: Any = None,
        *,
        max_distortion: Optional[float] = None,
        min_persistence: Optional[float] = None,
        cones: Any = None,
        method: str = "refined",
        angles: str = "optimal",
        quantize: Optional[int] = None,
        search: str = "coarse",
        progress: Optional[Progress] = None,
    ) -> Cones:
        """Cones by a method, or given ones with curvatures by a rule; options as for `cones.unwrap`."""
        asked = options.choice(n, max_distortion, min_persistence, cones, method, angles, quantize, search)
        return Cones(self._native.choose(asked, progress), self.topology["components"])

    def predict(self, cones: Any, *, angles: str = "optimal") -> dict:
        """What linear theory predicts for cones at given vertices: ``n``, ``predicted_l2``, ``predicted_area``."""
        return self.place(cones=cones, angles=angles).prediction

    def order(
        self,
        n: int = 64,
        *,
        method: str = "pursuit",
        angles: str = "optimal",
        progress: Optional[Progress] = None,
    ) -> Order:
        """One order of at least so many cones, every prefix of which is a set of cones."""
        asked = options.choice(method=method, angles=angles)
        return Order(self._native.order(asked, count("n", "cones", n), progress))

    def curve(self, n: int = 64, *, method: str = "pursuit", angles: str = "optimal") -> np.ndarray:
        """What is predicted for every number of cones, up to ``n`` at least, as far as there are so many: a structured array (n, predicted_l2,
        predicted_area), a row for each number for which there is a set."""
        return self.order(n, method=method, angles=angles).curve

    def flatten(
        self,
        cones: Any,
        *,
        angles: str = "optimal",
        scale: str = "unit",
        progress: Optional[Progress] = None,
        **layout: Any,
    ) -> Unwrapping:
        """A map with exactly these cones: `Cones` of this analysis, or vertices (with curvatures by ``angles``).

        ``layout`` are the options of `cones.unwrap` that speak of seams, islands and packing. No other cones are tried; where a layout lies
        over itself it is taken apart.
        """
        placed = cones if isinstance(cones, Cones) else self.place(cones=cones, angles=angles, progress=progress)
        asked = options.together(options.choice(angles=angles), self._layout(layout))
        return Unwrapping(self.mesh, self._native.flatten(placed._native, asked, scale, progress))

    def unwrap(
        self,
        n: Any = None,
        *,
        max_distortion: Optional[float] = None,
        min_persistence: Optional[float] = None,
        cones: Any = None,
        method: str = "refined",
        angles: str = "optimal",
        quantize: Optional[int] = None,
        search: str = "coarse",
        scale: str = "unit",
        progress: Optional[Progress] = None,
        **layout: Any,
    ) -> Unwrapping:
        """Cones and a map with them, or with others where these fail: `cones.unwrap` on an analysis that is there, whose mesh stays as it is refined."""
        choice = options.choice(n, max_distortion, min_persistence, cones, method, angles, quantize, search)
        asked = options.together(choice, self._layout(layout))
        return Unwrapping(self.mesh, self._native.atlas(asked, scale, progress))

    def conformal_factor(self) -> np.ndarray:
        """The conformal factor φ of each vertex, (v,); NaN where a vertex is on no surface. Low at tips, high at saddles."""
        return self._native.conformal_factor()

    def extrema(self) -> np.ndarray:
        """All extrema of φ, most persistent first: a structured array (component, vertex, is_maximum, value, persistence, saddle), saddle -1
        for the lowest and the highest point of a component."""
        columns = self._native.extrema()
        table = np.empty(len(columns["vertex"]), dtype=_EXTREMUM)
        for name in _EXTREMUM.names or ():
            table[name] = columns[name]
        return table

    @property
    def least_cones(self) -> int:
        """How many cones the mesh needs at least."""
        return self._native.least_cones()

    @property
    def needle_share(self) -> float:
        """The share of the area in triangles with an angle below 10°; above 0.05 a mesh is better refined."""
        return self._native.needle_share()

    @property
    def topology(self) -> dict:
        """vertices, faces, components, boundary_loops, genus, euler of the surfaces that are computed with."""
        return self._native.topology

    @property
    def repairs(self) -> list[tuple[str, int, int]]:
        """What was repaired: what it was, how often, and the first place (a face or a vertex)."""
        return self._native.repairs

    @property
    def warnings(self) -> list[str]:
        """What was decided while it was made, a sentence each."""
        return self._native.notes

    @property
    def times(self) -> dict[str, float]:
        """Seconds by stage that making it took."""
        return self._native.times

    def __repr__(self) -> str:
        t = self.topology
        components = counted(t["components"], "component", "components")
        return f"<cones.Analysis of {t['vertices']} vertices, {components}, genus {t['genus']}>"
