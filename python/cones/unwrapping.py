"""Unwrapping in one call, and what comes of it."""

from __future__ import annotations

import json
import os
from functools import cached_property
from typing import Any, Callable, Optional, Union

import numpy as np

from . import _cones, options
from ._arrays import counted
from .mesh import Faces, Mesh, as_mesh

#: ``progress(stage, fraction)``: the stage's name, and how much of it is done (0 to 1), or none where that is not known.
Progress = Callable[[str, Optional[float]], Any]

#: The columns of a table of cones.
CONE = np.dtype(
    [
        ("component", np.int64),
        ("vertex", np.int64),
        ("position", np.float64, 3),
        ("kind", "U7"),
        ("persistence", np.float64),
        ("curvature", np.float64),
    ]
)


def cone_table(cones: list) -> np.ndarray:
    """Cones as a structured array."""
    nan = float("nan")
    rows = [
        (c["component"], c["vertex"], tuple(c["position"]), c["kind"], nan if c["persistence"] is None else c["persistence"], c["curvature"])
        for c in cones
    ]
    return np.array(rows, dtype=CONE)


class Unwrapping:
    """A mesh with a map to the plane.

    Attributes
    ----------
    mesh : Mesh
        The mesh that the map is of: the one that was given, or the refined one where ``refine`` asked for it.
    uv : ndarray (corners, 2) float64
        A position for each corner of the mesh.
    triangles : ndarray (t, 3) uint32
        The triangles that were computed with, as corners of the mesh.
    triangle_face : ndarray (t,) uint32
        The face that each triangle is part of.
    triangle_island : ndarray (t,) int64
        The island of each triangle; -1 for those that belong to no surface.
    seams : list of ndarray uint32
        The seams as chains of vertices.
    detached : ndarray uint32
        Triangles that folded over and are islands of their own.
    left_out : ndarray uint32
        Triangles that belong to no surface: with repeated vertices, or copies.
    tiles : int
        How many tiles the islands are on.
    fill : float
        The islands' areas, added up, over that of the tiles.
    report : dict
        What the command's ``--report`` has: input, repairs, cones, distortion, islands, seams, times (seconds), warnings.
    """

    def __init__(self, mesh: Mesh, found: dict):
        self.mesh = mesh
        self.uv: np.ndarray = found["uv"]
        self.triangles: np.ndarray = found["triangles"]
        self.triangle_face: np.ndarray = found["triangle_face"]
        self.triangle_island: np.ndarray = found["triangle_island"]
        self.seams: list[np.ndarray] = found["seams"]
        self.detached: np.ndarray = found["detached"]
        self.left_out: np.ndarray = found["left_out"]
        self.tiles: int = found["tiles"]
        self.fill: float = found["fill"]
        self.report: dict = found["report"]

    @cached_property
    def cones(self) -> np.ndarray:
        """The cones as a structured array: component, vertex, position (3), kind, persistence (NaN if it is no extremum), curvature in
        radians."""
        return cone_table(self.report["cones"])

    @property
    def distortion(self) -> dict:
        """The measures of the map: ``area_mean`` is the area distortion D, ``quasi_conformal`` has σ₁/σ₂."""
        return self.report["distortion"]

    @property
    def warnings(self) -> list[str]:
        """What was decided on the way and what could not be had, a sentence each. What was mended in the mesh is in `repairs`; ``report["seams"]`` says
        what seams are like: handles that were opened, parts whose seams are free, and by how much their two sides differ."""
        return self.report["warnings"]

    @property
    def repairs(self) -> list[tuple[str, int, int]]:
        """What was repaired: what it was, how often, and the first place (a face or a vertex); empty for a sound mesh."""
        return [(repair["kind"], repair["count"], *repair["first"].values()) for repair in self.report["repairs"]]

    @property
    def island_count(self) -> int:
        """How many islands there are."""
        return int(self.triangle_island.max(initial=-1)) + 1

    @cached_property
    def seam_edges(self) -> np.ndarray:
        """The edges of all seams: two vertices each, (k, 2) uint32."""
        edges = [np.column_stack([seam[:-1], seam[1:]]) for seam in self.seams]
        return np.concatenate(edges) if edges else np.empty((0, 2), dtype=np.uint32)

    def split(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The map for programs that have one position a vertex: the mesh cut along its seams.

        Returns the original vertex of each new one (w,), the texture coordinate of each (w, 2), and triangles of new vertices (t, 3):
        ``mesh.vertices[origin]`` are positions.
        """
        corners = self.mesh.corners.astype(np.int64)
        key = np.empty(len(corners), dtype=[("vertex", np.int64), ("u", np.int64), ("v", np.int64)])
        key["vertex"], (key["u"], key["v"]) = corners, (self.uv + 0.0).view(np.int64).T
        _, first, wedge = np.unique(key, return_index=True, return_inverse=True)
        return corners[first], self.uv[first], wedge.reshape(-1)[self.triangles]

    def write(self, path: Union[str, os.PathLike], *, triangulate: bool = False) -> None:
        """Writes the mesh with its texture coordinates as .obj, .ply or .glb, compressed where .gz follows."""
        self.mesh.write(path, self.uv, triangulate=triangulate)

    def write_report(self, path: Union[str, os.PathLike]) -> None:
        """Writes the report as JSON."""
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.report, file, indent=1)

    def __repr__(self) -> str:
        d = self.distortion
        cones, islands = counted(len(self.report["cones"]), "cone", "cones"), counted(self.island_count, "island", "islands")
        return (
            f"<cones.Unwrapping: {cones}, {islands}, area distortion {d['area_mean']:.3f}, "
            f"quasi-conformal {d['quasi_conformal']['mean']:.3f}>"
        )


def unwrap(
    vertices: Any,
    faces: Optional[Faces] = None,
    n: Any = None,
    *,
    max_distortion: Optional[float] = None,
    min_persistence: Optional[float] = None,
    cones: Any = None,
    method: str = "refined",
    angles: str = "optimal",
    smooth: bool = False,
    weld: Union[bool, str] = "auto",
    refine: str = "never",
    open_handles: str = "auto",
    fill_holes: Union[bool, float] = False,
    quantize: Optional[int] = None,
    search: str = "coarse",
    seam_weight: float = 0.5,
    seams: Any = None,
    keep_seams: Any = False,
    avoid: Any = None,
    islands: str = "overlap-free",
    cut_limbs: str = "auto",
    free_seams: str = "auto",
    margin: float = 4.0,
    texture_size: int = 1024,
    rotations: str = "any",
    texel_density: Optional[float] = None,
    max_seam: float = 0.1,
    scale: str = "unit",
    progress: Optional[Progress] = None,
) -> Unwrapping:
    """Unwraps a surface. Options have the names, meanings and defaults of the command ``cones unwrap``, but for ``refine``: an STL is refined
    only where that is asked for, while the command refines it if it has needles.

    Parameters
    ----------
    vertices, faces
        Vertices (v, 3) and faces (m, k); or a `Mesh`, something with ``.vertices`` and ``.faces``, or a path alone.
    n : int or sequence of int, optional
        How many cones, in all or on each connected component in the order of their first faces (none where the sequence ends, but as many
        as a component needs). Without it as few as keep the area distortion within 1.25.
    max_distortion, min_persistence : float, optional
        As few cones as keep the area distortion within this; or all extrema that are so persistent.
    cones : vertices, mapping of vertices to curvatures, or a table of cones, optional
        Given cones. Curvatures are in radians and must add up to 2πχ on a closed component.
    method : one of ``cones.METHODS``
    search : "coarse" or "full"
        Whether large surfaces are searched for the best cones on a coarse level first, or on all vertices, which takes long.
    angles : "optimal" or "harmonic"
    smooth : bool
        Diffuse the curvature before extrema are looked for.
    weld : "auto", "never" or "always"
        Merge vertices at exactly the same place: where two edges of the boundary meet, none, or all.
    refine : "never", "needles" or "always"
        Cut the surface into even triangles. The map is then of ``result.mesh``.
    open_handles : "auto", "never" or "always"
        Open handles along short loops that take curvature, so that fewer cones are enough.
    fill_holes : bool or float
        Unwrap as if small holes were filled, so that seams need not run to them: boundary loops of up to half a root of their part's area, or of so
        many.
    quantize : 4 or 6, optional
        Round cones so that a texture of squares, or of triangles, keeps its directions across seams.
    seams, avoid : edges (k, 2), optional
        Edges to cut, and not to cut if there is another way: cones keep off vertices all of whose edges are to be avoided.
    keep_seams : bool or edges (k, 2)
        Cut where the mesh's own texture coordinates are cut, or these edges; those that are open already are passed over, while
        ``seams`` refuses them.
    islands : "overlap-free", "single" or "pack"
    cut_limbs : "auto" or "never"
        Cut off thin limbs at their necks where no affordable number of cones keeps lengths.
    free_seams : "auto", "never" or "always"
        Let the two sides of seams differ, for less distortion; "auto" where triangles are coarse. Where ``quantize`` is given they never do, and "always" is
        refused.
    margin, texture_size, rotations, texel_density, max_seam
        How islands are packed: turned by "any" angle, by a "quarter" or by "none" from where their straight sides lie along the axes (with
        ``quantize`` from how they are laid out); a texel density (texels a unit of length) puts them on UDIM tiles.
    scale : "unit", "area" or "none"
        The unit square, all islands together with the surface's area, or as computed; "unit" with ``texel_density``.
    progress : callable, optional
        ``progress(stage, fraction)`` hears some 25 times a second in what stage the work is, and how much of it is done, from 0 to 1, or None
        where that is not known; short work may end before it was ever called. If it raises, the work stops and the exception is passed on.

    Returns
    -------
    Unwrapping

    Raises
    ------
    Error
        If there is no surface, or the options cannot be met; the message says which.
    """
    given = as_mesh(vertices, faces)
    prepared = options.preparation(weld, smooth, refine, open_handles, fill_holes)
    choice = options.choice(n, max_distortion, min_persistence, cones, method, angles, quantize, search)
    layout = options.layout(
        given,
        weld,
        given.vertex_count,
        seam_weight=seam_weight,
        seams=seams,
        keep_seams=keep_seams,
        avoid=avoid,
        islands=islands,
        cut_limbs=cut_limbs,
        free_seams=free_seams,
        margin=margin,
        texture_size=texture_size,
        rotations=rotations,
        texel_density=texel_density,
        max_seam=max_seam,
    )
    analysis, found = _cones.Analysis.unwrapped(given._native, prepared, options.together(choice, layout), scale, progress)
    refined = analysis.refined
    return Unwrapping(given if refined is None else Mesh._of(refined[0]), found)
