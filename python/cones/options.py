"""The options of the command as keyword arguments, in the form that the native half reads."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Set
from typing import Any, Optional, Union

import numpy as np

from ._arrays import count, is_whole, places
from ._cones import METHODS, Error
from .mesh import Mesh, welding


SMALL_HOLE = 0.5
"""Boundary loops of up to so many roots of their part's area are small holes."""


def preparation(
    weld: Union[bool, str], smooth: bool, refine: str, open_handles: str, fill_holes: Union[bool, float] = False
) -> dict:
    """How a model is made ready."""
    try:
        size = {False: None, True: SMALL_HOLE}[bool(fill_holes)] if isinstance(fill_holes, (bool, np.bool_)) else float(fill_holes)
    except (TypeError, ValueError):
        size = np.nan
    if size is not None and not 0 <= size < np.inf:
        raise Error(f"fill_holes is True, False or how long a hole's loop may be, in roots of the area, not {fill_holes!r}")
    return {
        "weld": _one_of("weld", welding(weld), ("auto", "never", "always")),
        "smooth": bool(smooth),
        "refine": _one_of("refine", refine, ("never", "needles", "always")),
        "handles": _one_of("open_handles", open_handles, ("auto", "never", "always")),
        "fill_holes": size,
    }


def choice(
    n: Any = None,
    max_distortion: Optional[float] = None,
    min_persistence: Optional[float] = None,
    cones: Any = None,
    method: str = "refined",
    angles: str = "optimal",
    quantize: Optional[int] = None,
    search: str = "coarse",
) -> dict:
    """Which cones."""
    if sum(x is not None for x in (n, max_distortion, min_persistence, cones)) > 1:
        raise Error("give one of n, max_distortion, min_persistence and cones")
    if quantize not in (None, 4, 6):
        raise Error(f"quantize is 4 or 6, for textures of squares or of triangles, not {quantize!r}")
    return {
        "cones": _which(n, max_distortion, min_persistence, cones),
        "placement": _one_of("method", method, METHODS),
        "search": {"coarse": "coarse-to-fine", "full": "full"}[_one_of("search", search, ("coarse", "full"))],
        "rule": _one_of("angles", angles, ("optimal", "harmonic")),
        "quantize": {None: None, 4: "fourfold", 6: "sixfold"}[quantize],
    }


def layout(
    mesh: Mesh,
    weld: Union[bool, str],
    vertices: int,
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
) -> dict:
    """Where seams run, and what becomes of the islands, on a mesh of so many vertices: the given one, or what it was refined to."""
    if not 0 <= seam_weight <= 1:
        raise Error(f"seam_weight is a number from 0 to 1, not {seam_weight}")
    kept = keep_seams
    if isinstance(keep_seams, bool):
        if keep_seams and not mesh._native.has_uv:
            raise Error("keep_seams is for a mesh with texture coordinates, and this one has none")
        kept = mesh.texture_seams(weld=weld) if keep_seams else None
    kept = _edges(kept)
    places("edges of keep_seams", kept, vertices)
    return {
        "islands": _one_of("islands", islands, ("single", "overlap-free", "pack")),
        "seams": {"weight": float(seam_weight), "given": _edges(seams), "kept": kept, "avoid": _edges(avoid)},
        "limbs": _one_of("cut_limbs", cut_limbs, ("auto", "never")),
        "free_seams": _one_of("free_seams", free_seams, ("auto", "never", "always")),
        "packing": packing(margin, texture_size, rotations, texel_density, max_seam),
    }


def together(choice: dict, layout: dict) -> dict:
    """All options of a map, which must not contradict each other."""
    if choice["quantize"] and layout["free_seams"] == "always":
        raise Error("free_seams='always' lets the two sides of seams differ, quantize keeps them alike: leave one of the two out")
    return {**choice, **layout}


def packing(
    margin: float = 4.0,
    texture_size: int = 1024,
    rotations: str = "any",
    texel_density: Optional[float] = None,
    max_seam: float = 0.1,
) -> dict:
    """How islands are packed."""
    tiles: Any = "one" if texel_density is None else {"udim": {"texel_density": float(texel_density)}}
    return {
        "texture_size": count("texture_size", "pixels", texture_size, 2**32 - 1),
        "margin": float(margin),
        "rotations": _one_of("rotations", rotations, ("any", "quarter", "none")),
        "tiles": tiles,
        "max_seam": float(max_seam),
    }


def vertices_of(cones: Any) -> list[int]:
    """The vertices of given cones."""
    return [vertex for vertex, _ in _given(cones)]


def _which(n: Any, max_distortion: Any, min_persistence: Any, cones: Any) -> Any:
    if max_distortion is not None:
        if not max_distortion > 1:
            raise Error(f"max_distortion must be above 1 (1 is no distortion), but {max_distortion} is given")
        return {"within-distortion": float(max_distortion)}
    if min_persistence is not None:
        if not min_persistence >= 0:
            raise Error(f"min_persistence must be 0 at least, but {min_persistence} is given")
        return {"min-persistence": float(min_persistence)}
    if cones is not None:
        return {"given": _given(cones)}
    if n is None:
        return "automatic"
    return {"each": [count("n", "cones", k) for k in n]} if np.ndim(n) else {"count": count("n", "cones", n)}


def _given(cones: Any) -> list:
    """Vertices, with curvatures in radians if those are given too."""
    if isinstance(cones, (str, bytes, os.PathLike)):
        raise Error(f"cones are vertices, not the name of a file: read it first, as with numpy.loadtxt({os.fspath(cones)!r}, dtype=int)")
    if isinstance(cones, Mapping):
        return [[_vertex(v), None if k is None else float(k)] for v, k in cones.items()]
    table = getattr(cones, "table", cones)
    if isinstance(table, np.ndarray) and table.dtype.names:
        return [[_vertex(v), float(k)] for v, k in zip(table["vertex"], table["curvature"])]
    return [[_vertex(v), None] for v in (table if np.iterable(table) else [table])]


def _vertex(v: Any) -> int:
    if not is_whole(v, 2**32 - 1):
        raise Error(f"a cone is at vertex {v}, which is negative, no whole number, or beyond 32 bits (vertices are counted from 0)")
    return int(v)


def _edges(edges: Any) -> list:
    if edges is None:
        return []
    table = np.asarray(list(edges) if isinstance(edges, (Set, Iterator)) else edges)
    if table.size == 0:
        return []
    if table.ndim != 2 or table.shape[1] != 2 or table.dtype.kind not in "iu":
        raise Error(f"edges are pairs of vertex indices of the shape (k, 2), but {table.shape} {table.dtype} is given")
    if table.min() < 0 or table.max() >= 2**32:
        raise Error("an edge names a vertex that is negative, or beyond 32 bits (vertices are counted from 0)")
    return table.tolist()


def _one_of(option: str, name: str, names: Any) -> str:
    if name not in names:
        raise Error(f"{option} is {', '.join(names[:-1])} or {names[-1]}, not {name!r}")
    return name
