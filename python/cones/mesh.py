"""Meshes: vertices and polygons, from arrays or files."""

from __future__ import annotations

import errno
import gzip
import os
import secrets
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np

from . import _cones
from ._arrays import count, counted, plain
from ._cones import Error

#: What a mesh can be made of: the mesh itself, or vertices and faces.
Faces = Union[np.ndarray, Sequence[Sequence[int]]]
#: The most that a built-in surface is made of, as by the command.
_MOST_VERTICES = 4_000_000


class Mesh:
    """Vertices and polygons.

    ``Mesh(V, F)`` takes vertices (n, 3) and faces: an array (m, k) of vertex indices from 0, or a sequence of polygons of any size.
    Faces may be flipped, doubled, degenerate or non-manifold: what is broken is mended when the mesh is analysed, and counted. Maps are
    given for *corners*: those of face 0 in order, then those of face 1, and so on. ``uv`` are texture coordinates that there are already, for
    each corner (corners, 2) or for each vertex (n, 2); where there are as many of both, for corners.
    """

    def __init__(self, vertices: Any, faces: Faces, uv: Any = None):
        points = plain(vertices, np.float64)
        if points.ndim != 2:
            raise Error(f"vertices must have the shape (n, 3), but they have {points.shape}")
        corners, starts = _polygons(faces)
        self._native = _cones.Mesh(points, corners, starts, None if uv is None else _of_corners(uv, corners, len(points)))

    @classmethod
    def _of(cls, native: _cones.Mesh) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._native = native
        return mesh

    @property
    def vertices(self) -> np.ndarray:
        """The positions of the vertices, (n, 3); a copy."""
        return self._native.vertices

    @property
    def corners(self) -> np.ndarray:
        """The vertex of each corner, (corners,) uint32; a copy."""
        return self._native.corners

    @property
    def face_start(self) -> np.ndarray:
        """Where each face's corners begin, and at the end their number: (faces + 1,) int64."""
        return self._native.face_start

    @property
    def faces(self) -> Union[np.ndarray, list[np.ndarray]]:
        """The vertices of each face: (m, k) where all have k corners, otherwise a list of arrays."""
        corners, starts = self.corners, self.face_start
        sizes = np.diff(starts)
        if (sizes == sizes[0]).all():
            return corners.reshape(-1, sizes[0])
        return np.split(corners, starts[1:-1])

    @property
    def uv(self) -> Optional[np.ndarray]:
        """The texture coordinates that a file had, (corners, 2); none if any corner has none."""
        return self._native.uv

    @property
    def vertex_count(self) -> int:
        """How many vertices there are."""
        return self._native.vertex_count

    @property
    def face_count(self) -> int:
        """How many faces there are."""
        return self._native.face_count

    @property
    def corner_count(self) -> int:
        """How many corners all faces have together."""
        return self._native.corner_count

    @property
    def skipped(self) -> str:
        """What the file said that the mesh does not hold, such as ``2 lines``; empty if nothing."""
        return self._native.skipped

    def triangles(self) -> tuple[np.ndarray, np.ndarray]:
        """The triangles that are computed with: three corners each (t, 3), and the face each is part of (t,)."""
        return self._native.triangles()

    def texture_seams(self, *, weld: Union[bool, str] = "auto") -> np.ndarray:
        """The edges where the mesh's own texture coordinates are cut: two vertices each, (k, 2)."""
        return self._native.texture_seams(welding(weld))

    def write(self, path: Union[str, os.PathLike], uv: Any = None, *, triangulate: bool = False) -> None:
        """Writes the mesh as .obj, .ply or .glb, compressed where .gz follows, with texture coordinates for its corners (corners, 2), or its own.

        An OBJ that was read is written back line for line. The file appears whole or not at all.
        """
        path = Path(path)
        coordinates = None if uv is None else plain(uv, np.float64)
        is_compressed = path.suffix.lower() == ".gz"
        ending = path.with_suffix("").suffix if is_compressed else path.suffix
        data = self._native.to_bytes(ending.lower().lstrip("."), coordinates, triangulate)
        # Without the time of writing: the same mesh is the same bytes.
        write_whole(path, gzip.compress(data, mtime=0) if is_compressed else data)

    def __repr__(self) -> str:
        return f"<cones.Mesh of {self.vertex_count} vertices, {counted(self.face_count, 'face', 'faces')}>"


def read(path: Union[str, os.PathLike]) -> Mesh:
    """Reads a mesh: OBJ, OFF, PLY, STL or glTF (.glb, .gltf), gzipped or not; known by its content."""
    name = os.fspath(path)
    try:
        return Mesh._of(_cones.Mesh.read(name))
    except FileNotFoundError:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), name) from None


def shape(name: str, vertices: int = 10_000) -> Mesh:
    """A built-in surface with about so many vertices, from 1 to 4,000,000: sphere, capsule, torus, torus-3, hare, part, terrain, ..."""
    wanted = count("vertices", "vertices", vertices)
    if not 1 <= wanted <= _MOST_VERTICES:
        raise Error(f"vertices is a number from 1 to {_MOST_VERTICES:,}, not {wanted}")
    return Mesh._of(_cones.shape(name, wanted))


def as_mesh(vertices: Any, faces: Optional[Faces]) -> Mesh:
    """The mesh of what a function was given: a mesh or a file alone, or vertices and faces."""
    if faces is not None:
        return Mesh(vertices, faces)
    if isinstance(vertices, Mesh):
        return vertices
    if isinstance(vertices, (str, os.PathLike)):
        return read(vertices)
    if hasattr(vertices, "vertices") and hasattr(vertices, "faces"):
        return Mesh(vertices.vertices, vertices.faces, _of_visual(vertices))
    raise Error("give vertices and faces, a cones.Mesh, something with .vertices and .faces, or the path of a file")


def write_whole(path: Path, data: bytes) -> None:
    """Writes a file that appears whole or not at all. A link is followed, and what is replaced hands on its mode."""
    target = path.resolve() if path.is_symlink() else path
    # Files of tempfile are their owner's alone, and to ask for the umask is to change it for all threads.
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
    try:
        file = open(temporary, "xb")
    except OSError as error:
        # It names the temporary file, of which nobody knows.
        raise OSError(error.errno, error.strerror, str(path)) from None
    try:
        with file:
            file.write(data)
        if target.exists():
            shutil.copymode(target, temporary)
        os.replace(temporary, target)
    except BaseException:
        os.unlink(temporary)
        raise


def _of_visual(mesh: Any) -> Optional[np.ndarray]:
    """The texture coordinates that trimesh has for each vertex, for each corner; none where there are no such."""
    table = np.asarray(getattr(getattr(mesh, "visual", None), "uv", None), dtype=object)
    if table.ndim != 2 or table.shape[1] < 2 or len(table) != len(mesh.vertices):
        return None
    corners, _ = _polygons(mesh.faces)
    is_there = bool(corners.size) and int(corners.max()) < len(table)
    return plain(table[:, :2].astype(np.float64)[corners], np.float64) if is_there else None


def _of_corners(uv: Any, corners: np.ndarray, vertices: int) -> np.ndarray:
    """Texture coordinates of corners, where they are given for those or for vertices."""
    table = plain(uv, np.float64)
    if table.ndim != 2 or table.shape[1] != 2 or len(table) not in (len(corners), vertices):
        raise Error(f"uv has the shape ({len(corners)}, 2), for corners, or ({vertices}, 2), for vertices, not {table.shape}")
    if len(table) == len(corners):
        return table
    if corners.size and corners.max() >= vertices:
        raise Error(f"a face uses vertex {corners.max()}, but there are {vertices}, counted from 0")
    return plain(table[corners], np.float64)


def _polygons(faces: Faces) -> tuple[np.ndarray, np.ndarray]:
    """The corners of all faces, and where each face begins."""
    if isinstance(faces, np.ndarray) and faces.dtype != object:
        table = faces
    else:
        polygons = [np.asarray(face) for face in faces]
        sizes = {face.shape for face in polygons}
        if len(sizes) > 1:
            starts = np.concatenate([[0], np.cumsum([face.size for face in polygons])])
            return _indices(np.concatenate([face.reshape(-1) for face in polygons])), starts.astype(np.int64)
        table = np.array(polygons) if polygons else np.empty((0, 3), dtype=np.uint32)
    if table.ndim != 2:
        raise Error(f"faces must have the shape (m, 3) or (m, k), but they have {table.shape}")
    count, size = table.shape
    return _indices(table.reshape(-1)), np.arange(count + 1, dtype=np.int64) * size


def _indices(corners: np.ndarray) -> np.ndarray:
    if corners.dtype == np.uint32:
        return plain(corners, np.uint32)
    if corners.size and corners.dtype.kind not in "iu":
        raise Error(f"faces are made of vertex indices, which are integers, not {corners.dtype}")
    if corners.size and (corners.min() < 0 or corners.max() >= 2**32):
        raise Error("a face uses a vertex index that is negative, or beyond 32 bits (vertices are counted from 0)")
    return plain(corners, np.uint32)


def welding(weld: Union[bool, str]) -> str:
    """Which vertices are taken for one: "auto", "never" or "always"; a truth value says none or all."""
    return ("always" if weld else "never") if isinstance(weld, bool) else weld
