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

import hashlib
import itertools
import json
import os
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Optional, Union

import dask
import numpy as np

from ._cones import Error
from .mesh import write_whole
from .topo import Pairs, Persistence
from .topo import _blocks as blocks
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
    """A delayed task for each mesh, which writes it with texture coordinates to ``folder`` and gives an :class:`Item`.

    Outputs are named as the inputs are below their common folder. ``ending`` is .obj, .ply or .glb; ``options`` are those of
    :func:`cones.unwrap`. With ``resume`` what is there already is not done again.
    """
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
    for source, output in zip(sources, outputs):
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

    text = json.dumps([__version__, options], sort_keys=True, default=_plain)
    digest = hashlib.blake2b(text.encode())
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else repr(value)


def _found(line: Path, output: str, key: str) -> Optional[Item]:
    """The item of a result that is there already."""
    try:
        found = json.loads(line.read_text())
    except (OSError, ValueError):
        return None
    if found.pop("key", None) != key or not Path(output).exists():
        return None
    return Item(**{**found, "warnings": tuple(found["warnings"]), "was_done": True})


def sublevel(field: Any, **options: Any) -> Pairs:
    """The minima of a chunked field; options as for :func:`persistence`."""
    return _computed(field, (False,), options)[0]


def superlevel(field: Any, **options: Any) -> Pairs:
    """The maxima of a chunked field; options as for :func:`persistence`."""
    return _computed(field, (True,), options)[0]


def persistence(field: Any, **options: Any) -> Persistence:
    """The pairs of both directions of a chunked field: of a dask array, something that has one as ``.data`` (xarray), or what
    ``dask.array.from_array`` takes (zarr). Computed at once, by the client that is active if there is one.

    Parameters
    ----------
    connectivity, periodic, nan, keep_zeros
        As for :func:`cones.topo.sublevel`.
    """
    return Persistence(*_computed(field, (False, True), options))


def _computed(field: Any, directions: tuple, options: dict) -> list[Pairs]:
    array = _chunked(field)
    asked = _options(array.ndim, **options)
    if not array.size:
        values = np.zeros(array.shape, array.dtype)
        from .topo import sublevel as minima
        from .topo import superlevel as maxima

        return [(maxima if superlevel else minima)(values, **options) for superlevel in directions]
    trees = [_tree(array, superlevel, asked) for superlevel in directions]
    done = dask.compute(*trees)
    return [
        blocks.collect(last, tables, sum(zeros), superlevel=superlevel, shape=array.shape)
        for superlevel, (last, tables, zeros) in zip(directions, done)
    ]


def _chunked(field: Any) -> Any:
    """The field as a dask array."""
    import dask.array as da

    known = (np.ndarray, da.Array)
    if not isinstance(field, known) and isinstance(getattr(field, "data", None), known):
        field = field.data
    array = field if isinstance(field, da.Array) else da.from_array(field)
    if not 1 <= array.ndim <= 3:
        raise Error(f"a chunked field is an array of one to three axes, not {array.ndim}")
    if any(np.isnan(length) for length in array.shape):
        raise Error("the sizes of the field's chunks must be known: call compute_chunk_sizes() on it")
    return array


def _options(axes: int, connectivity: str = "axis", periodic: Any = False, nan: str = "refuse", keep_zeros: bool = False) -> dict:
    if nan not in ("refuse", "mask"):
        raise Error(f"nan is refuse or mask, not {nan!r}")
    round_ends = (bool(periodic),) * axes if np.ndim(periodic) == 0 else tuple(bool(p) for p in periodic)
    if len(round_ends) != axes:
        raise Error("periodic needs a truth value for each axis")
    return {"connectivity": connectivity, "periodic": round_ends, "nan": nan, "keep_zeros": keep_zeros}


def _tree(array: Any, superlevel: bool, asked: dict) -> tuple:
    """The last join of a tree of joins, and tables and numbers of zeros of all calls; delayed."""
    summarise, join = (dask.delayed(work, pure=False) for work in (_summarised, _joined))
    tables, zeros = [], []

    def kept(found: Any) -> Any:
        tables.append(found[1])
        zeros.append(found[2])
        return found[0]

    chunks = array.to_delayed()
    tiles = [_tiles(lengths, periodic) for lengths, periodic in zip(array.chunks, asked["periodic"])]
    parts = {}
    for place in np.ndindex(*map(len, tiles)):
        tile = [of_axis[k] for of_axis, k in zip(tiles, place)]
        start, stop = (tuple(getattr(along, end) for along in tile) for end in ("start", "stop"))
        parts[place] = kept(summarise(_values(chunks, tile), start, stop, array.shape, superlevel, asked))
    while len(parts) > 1:
        # Neighbours along the axis with the most parts.
        axis = max(range(array.ndim), key=lambda axis: len({place[axis] for place in parts}))
        pairs: dict = {}
        for rank, k in enumerate(sorted({place[axis] for place in parts})):
            for place in (place for place in parts if place[axis] == k):
                pairs.setdefault((*place[:axis], rank // 2, *place[axis + 1 :]), []).append(parts[place])
        parts = {place: both[0] if len(both) == 1 else kept(join(*both)) for place, both in pairs.items()}
    (last,) = parts.values()
    return last, tables, zeros


@dataclass(frozen=True)
class _Along:
    """A tile along one axis: its own vertices, and the slices of chunks that have them and the layer after them."""

    start: int
    stop: int
    pieces: tuple


_ALL = slice(None)


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


def _values(chunks: np.ndarray, tile: list[_Along]) -> Any:
    """A tile and the layer after it: a chunk as it is, or slabs of some."""
    pieces = list(itertools.product(*(along.pieces for along in tile)))
    if len(pieces) == 1 and all(slab == _ALL for _, slab in pieces[0]):
        return chunks[tuple(k for k, _ in pieces[0])]
    cut, put_together = dask.delayed(_slab), dask.delayed(_put_together)
    slabs = [cut(chunks[tuple(k for k, _ in piece)], tuple(slab for _, slab in piece)) for piece in pieces]
    return put_together(slabs, [len(along.pieces) for along in tile])


def _slab(chunk: Any, slices: tuple) -> np.ndarray:
    """A piece of a chunk by itself, so that the chunk does not go with it."""
    return np.array(np.asarray(chunk)[slices])


def _put_together(slabs: list, counts: list) -> np.ndarray:
    """Slabs, the last axis fastest, as one array."""
    for axis in reversed(range(len(counts))):
        count = counts[axis]
        slabs = [np.concatenate(slabs[k : k + count], axis=axis) for k in range(0, len(slabs), count)]
    return slabs[0]


def _summarised(values: Any, start: tuple, stop: tuple, shape: tuple, superlevel: bool, asked: dict) -> tuple:
    return _split(blocks.summarise(values, start, stop, shape, superlevel=superlevel, **asked))


def _joined(*parts: blocks.Part) -> tuple:
    return _split(blocks.join(*parts))


def _split(part: blocks.Part) -> tuple:
    """What is carried on, and what is final: the one goes to the next join, the other to the caller."""
    carried = blocks.Part(part.summary, part.number, part.table[:0], 0)
    return carried, part.table, part.zero_count
