"""Thousands of meshes with dask; needs the extra ``[dask]``.

    tasks = cones.dask.unwrap(paths, "out", n=16)          # a delayed task a mesh; nothing has run yet
    items = dask.compute(*tasks)                           # here, or on the workers of a dask.distributed client
    failed = [item for item in items if item.error]

A mesh that cannot be unwrapped is an item with its error, and stops no other. Each result is written whole with a line about it beside it
(``NAME.json``); what is there already, of the same input and the same options, is not done again: a run that was killed goes on where it was.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Optional, Union

import dask

from ._cones import Error
from .mesh import write_whole
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
