"""Maps that somebody made: measured, taken apart where they lie over themselves, packed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np

from . import _cones, options
from ._arrays import places, plain
from ._cones import Error
from .mesh import Faces, Mesh, as_mesh, welding
from .unwrapping import Progress


@dataclass(frozen=True)
class Measures:
    """How good a map is."""

    #: Under the keys of ``cones measure --json``: area_mean (the area distortion D), quasi_conformal and area (mean, median, p95, p99, max),
    #: u_l2, u_linf, flipped, degenerate, overlap, overlap_pairs, overlap_complete, overlap_depth, fill, tiles, seam_length, curvature_error.
    distortion: dict
    #: The number of triangles and the share of the area of each island.
    islands: list[dict]
    #: The triangles that are not measured: they have a vertex twice, or lie where another one on the same vertices does.
    left_out: np.ndarray = field(repr=False)
    #: The triangles that lie over or under another.
    overlapping: np.ndarray = field(repr=False)
    #: The island of each triangle; -1 for those left out.
    triangle_island: np.ndarray = field(repr=False)
    #: σ₁/σ₂ of each triangle, infinite if it is degenerate; 1 for those left out.
    triangle_quasi_conformal: np.ndarray = field(repr=False)
    #: The centred log scale of each triangle; 0 for those left out.
    triangle_log_scale: np.ndarray = field(repr=False)


@dataclass(frozen=True)
class Islands:
    """A map whose islands lie neither over themselves nor over each other."""

    #: A position for each corner (corners, 2).
    uv: np.ndarray = field(repr=False)
    #: The island of each triangle; -1 for those that have a vertex twice and no corner in common with any other.
    triangle_island: np.ndarray = field(repr=False)
    island_count: int
    #: How many pairs of triangles lay over each other.
    overlapping_pairs: int
    #: How many of them could not be parted, as triangles of one polygon cannot.
    left: int
    #: How much longer seams are now, in the mesh's unit.
    added_seam: float


@dataclass(frozen=True)
class Packing:
    """A map whose islands are packed."""

    #: A position for each corner (corners, 2).
    uv: np.ndarray = field(repr=False)
    islands: int
    tiles: int
    #: The share of the tiles that is covered, before and after.
    fill_before: float
    fill: float
    #: Texels between islands: what was asked for, or less where there are too many for that.
    margin: float
    #: What lengths in the plane were multiplied by.
    scale: float


def measure(
    vertices: Any,
    faces: Optional[Faces] = None,
    uv: Any = None,
    *,
    weld: Union[bool, str] = "auto",
    cones: Any = None,
) -> Measures:
    """Measures a map: the command ``cones measure``.

    ``uv`` is (corners, 2), or the mesh's own; ``cones`` are vertices that may be curved, or a table of cones; by default all that are by more than 0.1. ``weld``
    says which vertices are taken for one, as for `cones.unwrap`.
    """
    mesh = as_mesh(vertices, faces)
    known = None if cones is None else places("cones", options.vertices_of(cones), mesh.vertex_count).astype(np.uint32)
    return Measures(**_cones.measure(mesh._native, _map(mesh, uv), welding(weld), known))


def islands(
    vertices: Any,
    faces: Optional[Faces] = None,
    uv: Any = None,
    *,
    weld: Union[bool, str] = "auto",
    margin: float = 4.0,
    texture_size: int = 1024,
    rotations: str = "any",
    texel_density: Optional[float] = None,
    progress: Optional[Progress] = None,
) -> Islands:
    """Takes a map apart until no island lies over itself, and packs it: the command ``cones islands``. A map without overlap comes back as
    it is."""
    mesh = as_mesh(vertices, faces)
    asked = options.packing(margin, texture_size, rotations, texel_density)
    parted = _cones.part(mesh._native, _map(mesh, uv), welding(weld), progress)
    if parted["overlapping_pairs"]:
        packed = _cones.pack(mesh._native, parted["uv"], parted["triangle_island"], "never", asked, progress)
        parted["uv"] = packed["uv"]
    return Islands(**parted)


def pack(
    vertices: Any,
    faces: Optional[Faces] = None,
    uv: Any = None,
    *,
    triangle_island: Any = None,
    weld: Union[bool, str] = "auto",
    margin: float = 4.0,
    texture_size: int = 1024,
    rotations: str = "any",
    texel_density: Optional[float] = None,
    progress: Optional[Progress] = None,
) -> Packing:
    """Packs the islands of a map into the unit square, or onto UDIM tiles: the command ``cones pack``. Islands move rigidly and are scaled
    alike; if no packing that is found is better than how they lie, they stay so. ``triangle_island`` says which triangles move together (-1 stays);
    without it islands are found, where ``weld`` says which vertices are taken for one, as for `cones.unwrap`."""
    mesh = as_mesh(vertices, faces)
    asked = options.packing(margin, texture_size, rotations, texel_density)
    given = None if triangle_island is None else np.asarray(triangle_island)
    if given is not None and given.dtype.kind not in "iu":
        raise Error(f"triangle_island is a number of an island for each triangle, an integer, not {given.dtype}")
    given = None if given is None else plain(given, np.int64)
    return Packing(**_cones.pack(mesh._native, _map(mesh, uv), given, welding(weld), asked, progress))


def _map(mesh: Mesh, uv: Any) -> np.ndarray:
    coordinates = mesh.uv if uv is None else plain(uv, np.float64)
    if coordinates is None:
        raise Error("the mesh has no texture coordinates at some corner: give uv")
    if coordinates.ndim != 2:
        raise Error(f"uv must have the shape (corners, 2), but it has {coordinates.shape}")
    return coordinates
