"""Thousands of meshes, and fields larger than memory, with dask; needs the extra ``[dask]``.

**Meshes**

    tasks = cones.dask.unwrap(paths, "out", n=16)          # a delayed task a mesh; nothing has run yet
    items = dask.compute(*tasks)                           # here, or on the workers of a dask.distributed client
    failed = [item for item in items if item.error]

A mesh that cannot be unwrapped is an item with its error, and stops no other. Each result is written whole with a line about it beside it
(``NAME.json``); what is there already, of the same input and the same options, is not done again: a run that was killed goes on where it was.

**Fields**

    pairs = cones.dask.persistence(dask.array.from_zarr("volume.zarr"), nan="mask").maxima

Each chunk, with one layer of the next ones, becomes the pairs that are final whatever the other chunks hold, and a summary of the size of
its border; summaries are joined in a tree, and in the end the pairs are those of the field in one piece, ties included. Only layers and summaries move between
workers; pairs go to the caller.
"""

from __future__ import annotations

import gzip
import hashlib
import itertools
import json
import operator
import os
import time
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Optional, Union
from urllib.parse import unquote

import dask
import numpy as np

from ._cones import Error
from .mesh import write_whole
from .topo import Pairs, Persistence
from .topo import _blocks as blocks
from .topo._domain import round_ends
from .unwrapping import unwrap as _unwrap

Path_ = Union[str, os.PathLike]


@dataclass(frozen=True)
class Item:
    """What became of one mesh."""

    path: str
    #: The file that was written; none where there is an error.
    output: Optional[str]
    #: Why there is none, in a sentence.
    error: Optional[str] = None
    cones: int = 0
    islands: int = 0
    #: The area distortion D, the mean of σ₁/σ₂, the share that lies over itself.
    area_distortion: float = float("nan")
    quasi_conformal: float = float("nan")
    overlap: float = float("nan")
    warnings: tuple = ()
    seconds: float = 0.0
    #: Whether it was there already.
    was_done: bool = False


def unwrap(
    paths: Iterable[Path_],
    folder: Path_,
    *,
    ending: str = ".obj",
    resume: bool = True,
    **options: Any,
) -> list:
    """A delayed task for each mesh, which writes it with texture coordinates to ``folder`` and gives an `Item`.

    Outputs are named as the inputs are below their common folder; no input is overwritten. ``ending`` is .obj, .ply or .glb; ``options`` are those of
    `cones.unwrap`. With ``resume`` what is there already is not done again.
    """
    if isinstance(paths, (str, os.PathLike)):
        raise Error(f"paths is a list of files, not one: give [{os.fspath(paths)!r}]")
    sources = [Path(path) for path in paths]
    outputs = _outputs(sources, Path(folder), ending)
    work = dask.delayed(_item, pure=False)
    return [work(str(source), str(output), resume, options) for source, output in zip(sources, outputs)]


def _outputs(sources: list[Path], folder: Path, ending: str) -> list[Path]:
    if ending not in (".obj", ".ply", ".glb"):
        raise Error(f"a mesh is written as .obj, .ply or .glb, not as {ending!r}")
    if not sources:
        return []
    absolute = [source.absolute() for source in sources]
    base = os.path.commonpath([source.parent for source in absolute])
    outputs = [folder / source.relative_to(base).with_name(_stem(source) + ending) for source in absolute]
    first: dict[Path, Path] = {}
    # By whatever name: also that of another one.
    inputs = {source.resolve() for source in absolute}
    for source, output in zip(sources, outputs):
        if output.resolve() in inputs:
            raise Error(f"{output} is an input, which is never overwritten: name another folder")
        if output in first:
            raise Error(f"{first[output]} and {source} would both be written to {output}: give them different names")
        first[output] = source
    return outputs


def _stem(path: Path) -> str:
    name = path.name[:-3] if path.name.lower().endswith(".gz") else path.name
    return Path(name).stem


def _item(path: str, output: str, resume: bool, options: dict) -> Item:
    """Unwraps one mesh, or finds that it was."""
    began = time.perf_counter()
    line = Path(f"{output}.json")
    try:
        key = _key(path, options)
        done = _found(line, output, key) if resume else None
        if done is not None:
            return done
        result = _unwrap(path, **options)
        Path(output).parent.mkdir(parents=True, exist_ok=True)
        # Lest it be taken for a line about the new output, should this end in between.
        line.unlink(missing_ok=True)
        result.write(output)
        item = Item(
            path,
            output,
            cones=len(result.report["cones"]),
            islands=result.island_count,
            area_distortion=result.distortion["area_mean"],
            quasi_conformal=result.distortion["quasi_conformal"]["mean"],
            overlap=result.distortion["overlap"],
            warnings=tuple(result.warnings),
            seconds=time.perf_counter() - began,
        )
        write_whole(line, json.dumps({"key": key, **asdict(item)}, indent=1).encode())
        return item
    except (Error, OSError) as error:
        return Item(path, None, error=str(error), seconds=time.perf_counter() - began)


def _key(path: str, options: dict) -> str:
    """What a result depends on: the input's bytes, the options, the version."""
    from ._cones import __version__

    text = json.dumps([__version__, _plain(sorted(options.items()))])
    digest = hashlib.blake2b(text.encode())
    for part in [Path(path), *_buffers(Path(path))]:
        with open(part, "rb") as file:
            while block := file.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()


def _plain(value: Any) -> Any:
    """A value in terms of JSON, of which keys of mappings may be anything."""
    if isinstance(value, Mapping):
        return [[_plain(key), _plain(of_key)] for key, of_key in value.items()]
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if value is None or isinstance(value, (str, int, float)):
        return value
    return value.tolist() if hasattr(value, "tolist") else repr(value)


def _buffers(path: Path) -> list[Path]:
    """The files beside it that a glTF keeps its numbers in."""
    name = path.name.lower()
    if not name.endswith((".gltf", ".gltf.gz")):
        return []
    data = path.read_bytes()
    try:
        content = json.loads(gzip.decompress(data) if name.endswith(".gz") else data)
        names = [buffer.get("uri", "data:") for buffer in content.get("buffers", [])]
        beside = [path.parent / unquote(name) for name in names if not name.startswith("data:")]
    except (ValueError, OSError, EOFError, AttributeError, TypeError):
        # Whoever reads the mesh says what is wrong with it.
        return []
    return [buffer for buffer in beside if buffer.is_file()]


def _found(line: Path, output: str, key: str) -> Optional[Item]:
    """The item of a result that is there already."""
    try:
        found = json.loads(line.read_text())
    except (OSError, ValueError):
        return None
    if not isinstance(found, dict) or found.pop("key", None) != key or not Path(output).exists():
        return None
    return Item(**{**found, "warnings": tuple(found["warnings"]), "was_done": True})


def sublevel(
    field: Any,
    *,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Pairs:
    """The minima of a chunked field; options as for `persistence`."""
    return _computed(field, (False,), connectivity=connectivity, periodic=periodic, nan=nan, keep_zeros=keep_zeros)[0]


def superlevel(
    field: Any,
    *,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Pairs:
    """The maxima of a chunked field; options as for `persistence`."""
    return _computed(field, (True,), connectivity=connectivity, periodic=periodic, nan=nan, keep_zeros=keep_zeros)[0]


def persistence(
    field: Any,
    *,
    connectivity: Optional[str] = None,
    periodic: Any = False,
    nan: str = "refuse",
    keep_zeros: bool = False,
) -> Persistence:
    """The pairs of both directions of a chunked field: of a dask array, something that has one as ``.data`` (xarray), or what
    ``dask.array.from_array`` takes (zarr). Computed at once, by the client that is active if there is one. Options are as for
    `cones.topo.sublevel`. Masked cells of masked arrays are left out.

    Parameters
    ----------
    field : dask array, xarray or zarr array of one to three axes
    connectivity : "axis" (default), "full" or "freudenthal"
    periodic : bool or sequence of bool
        Which axes go round.
    nan : "refuse" or "mask"
    keep_zeros : bool
        Keep pairs whose extremum and saddle have equal values.
    """
    return Persistence(*_computed(field, (False, True), connectivity=connectivity, periodic=periodic, nan=nan, keep_zeros=keep_zeros))


def _computed(field: Any, directions: tuple, **options: Any) -> list[Pairs]:
    array = _chunked(field)
    asked = _options(array.ndim, **options)
    if not array.size:
        values = np.zeros(array.shape, array.dtype)
        from .topo import sublevel as minima
        from .topo import superlevel as maxima

        return [(maxima if superlevel else minima)(values, **options) for superlevel in directions]
    done = dask.compute(*_trees(array, _Plan(array, directions, asked)))
    return [
        blocks.collect(last, [table for table, _ in found], sum(zeros for _, zeros in found), superlevel=superlevel, shape=array.shape)
        for superlevel, (last, found) in zip(directions, done)
    ]


def _chunked(field: Any) -> Any:
    """The field as a dask array."""
    import dask.array as da

    known = (np.ndarray, da.Array)
    if not isinstance(field, known) and isinstance(getattr(field, "data", None), known):
        field = field.data
    array: Any = field if isinstance(field, da.Array) else da.from_array(field)
    if not 1 <= array.ndim <= 3:
        raise Error(f"a chunked field is an array of one to three axes, not {array.ndim}")
    if any(np.isnan(length) for length in array.shape):
        raise Error("the sizes of the field's chunks must be known: call compute_chunk_sizes() on it")
    # Then all chunks are masked arrays: summaries join if they are of one kind of numbers.
    return array.map_blocks(np.ma.asarray) if _is_masked(array._meta) else array


def _is_masked(array: Any) -> bool:
    return isinstance(array, np.ma.MaskedArray)


def _options(axes: int, connectivity: Optional[str], periodic: Any, nan: str, keep_zeros: bool) -> dict:
    if nan not in ("refuse", "mask"):
        raise Error(f"nan is refuse or mask, not {nan!r}")
    return {"connectivity": connectivity or "axis", "periodic": tuple(round_ends(periodic, axes)), "nan": nan, "keep_zeros": keep_zeros}


def _trees(array: Any, plan: _Plan) -> list:
    """For each direction the last join of a tree of joins, and tables with numbers of zeros of all calls; delayed."""
    pick, summarise, join = (dask.delayed(work, pure=False) for work in (operator.getitem, _of_slabs, _joined))
    # One task reads a chunk and leaves nothing of it but summaries and slabs: whole chunks are no results that could be moved.
    taken = array.map_blocks(_taken_apart, plan=plan, dtype=object, meta=np.empty((0,) * array.ndim, dtype=object)).to_delayed()
    trees = []
    of_tiles = {}
    for place in np.ndindex(*map(len, plan.tiles)):
        pieces = plan.pieces(place)
        if _is_whole(pieces):
            of_tiles[place] = pick(taken[pieces[0].chunk], place)
        else:
            of_tiles[place] = summarise([pick(taken[piece.chunk], place) for piece in pieces], place, plan)
    for k in range(len(plan.directions)):
        found: list = []

        def kept(result: Any) -> Any:
            found.append(pick(result, 1))  # noqa: B023
            return pick(result, 0)

        parts = {place: kept(pick(of_tile, k)) for place, of_tile in of_tiles.items()}
        while len(parts) > 1:
            # Neighbours along the axis with the most parts.
            axis = max(range(array.ndim), key=lambda axis: len({place[axis] for place in parts}))
            pairs: dict = {}
            for rank, at in enumerate(sorted({place[axis] for place in parts})):
                for place in (place for place in parts if place[axis] == at):
                    pairs.setdefault((*place[:axis], rank // 2, *place[axis + 1 :]), []).append(parts[place])
            parts = {place: both[0] if len(both) == 1 else kept(join(*both)) for place, both in pairs.items()}
        (last,) = parts.values()
        trees.append((last, found))
    return trees


@dataclass(frozen=True)
class _Along:
    """A tile along one axis: its own vertices, and the slices of chunks that have them and the layer after them."""

    start: int
    stop: int
    pieces: tuple


_ALL = slice(None)


@dataclass(frozen=True)
class _Piece:
    """What a chunk has of a tile and the layer after it."""

    chunk: tuple
    slices: tuple


class _Plan:
    """How an array is cut into tiles, and what is asked of each."""

    def __init__(self, array: Any, directions: tuple, asked: dict):
        self.tiles = [_tiles(lengths, periodic) for lengths, periodic in zip(array.chunks, asked["periodic"])]
        self.shape, self.directions, self.asked = array.shape, directions, asked
        self.is_masked = _is_masked(array._meta)

    def pieces(self, place: tuple) -> list[_Piece]:
        """The pieces of the tile at a place, the last axis fastest."""
        along = [of_axis[k].pieces for of_axis, k in zip(self.tiles, place)]
        return [_Piece(*zip(*of_axes)) for of_axes in itertools.product(*along)]

    def places(self, chunk: tuple) -> Iterable[tuple]:
        """The places of the tiles that have something of a chunk."""
        with_chunk = [
            [place for place, along in enumerate(of_axis) if any(k == number for k, _ in along.pieces)]
            for of_axis, number in zip(self.tiles, chunk)
        ]
        return itertools.product(*with_chunk)

    def summarised(self, values: Any, place: tuple) -> list:
        """For each direction what is carried on of a tile, and what is final: the one goes to the next join, the other to the caller."""
        tile = [of_axis[k] for of_axis, k in zip(self.tiles, place)]
        start, stop = (tuple(getattr(along, end) for along in tile) for end in ("start", "stop"))
        return [
            _split(blocks.summarise(values, start, stop, self.shape, superlevel=superlevel, **self.asked))
            for superlevel in self.directions
        ]


def _is_whole(pieces: list[_Piece]) -> bool:
    return len(pieces) == 1 and all(slab == _ALL for slab in pieces[0].slices)


def _tiles(lengths: tuple, periodic: bool) -> list[_Along]:
    """How an axis of chunks is cut into tiles.

    A tile that took the layer after it from the next chunk would be as much at home there, and dask would move whole chunks. So the last layer of a chunk is a
    tile of its own: the others lie in one chunk with all that they need, and only layers move.
    """
    ends = np.cumsum((0, *lengths)).tolist()
    there = [k for k, length in enumerate(lengths) if length]
    tiles = []
    for rank, k in enumerate(there):
        low, high = ends[k], ends[k + 1]
        is_last = rank + 1 == len(there)
        if len(there) == 1 or (is_last and not periodic):
            tiles.append(_Along(low, high, ((k, _ALL),)))
            continue
        if high - low > 1:
            tiles.append(_Along(low, high - 1, ((k, _ALL),)))
        following = there[0] if is_last else there[rank + 1]
        tiles.append(_Along(high - 1, high, ((k, slice(-1, None)), (following, slice(0, 1)))))
    return tiles


def _taken_apart(values: Any, plan: _Plan, block_id: tuple) -> dict:
    """By tile what a chunk gives: the summaries of the one that is its own, slabs to those that it shares."""
    chunk = np.asanyarray(values)
    if _is_masked(chunk) and not plan.is_masked:
        raise Error("a chunk is a masked array, but the array of chunks does not say so: give it a meta that is one")
    given: dict[tuple, Any] = {}
    for place in plan.places(block_id):
        pieces = plan.pieces(place)
        if _is_whole(pieces):
            given[place] = plan.summarised(chunk, place)
        else:
            (piece,) = (piece for piece in pieces if piece.chunk == block_id)
            given[place] = chunk[piece.slices].copy()
    return given


def _of_slabs(slabs: list, place: tuple, plan: _Plan) -> list:
    """The summaries of a tile that lies in several chunks."""
    concatenate = np.ma.concatenate if plan.is_masked else np.concatenate
    for axis in reversed(range(len(place))):
        count = len(plan.tiles[axis][place[axis]].pieces)
        slabs = [concatenate(slabs[k : k + count], axis=axis) for k in range(0, len(slabs), count)]
    return plan.summarised(slabs[0], place)


def _joined(*parts: blocks.Part) -> tuple:
    return _split(blocks.join(*parts))


def _split(part: blocks.Part) -> tuple:
    """What is carried on, and what is final."""
    return blocks.Part(part.summary, part.number, part.table[:0].copy(), 0), (part.table, part.zero_count)
