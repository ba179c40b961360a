"""Figures of maps; needs matplotlib. Each draws on given axes, or on new ones, and returns them."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from ._cones import Error
from .unwrapping import Unwrapping


def _axes(axes: Optional[Any]) -> Any:
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    return plt.subplots(figsize=(6, 6))[1]


def layout(result: Unwrapping, axes: Optional[Any] = None, *, colour: str = "scale", edges: bool = False) -> Any:
    """The islands in the plane, coloured by ``scale`` (the log of each triangle's area ratio: red is enlarged) or by ``island``."""
    if colour not in ("scale", "island"):
        raise Error(f"colour is scale or island, not {colour!r}")
    axes = _axes(axes)
    kept = result.triangle_island >= 0
    triangles, uv = result.triangles[kept], result.uv
    values = _log_scale(result)[kept] if colour == "scale" else result.triangle_island[kept] % 10
    line = {"edgecolors": "k", "linewidth": 0.1} if edges else {"edgecolors": "none"}
    if colour == "scale":
        bound = max(0.2, float(np.percentile(np.abs(values), 99)))
        drawn = axes.tripcolor(uv[:, 0], uv[:, 1], triangles, facecolors=values, cmap="coolwarm", vmin=-bound, vmax=bound, **line)
        axes.figure.colorbar(drawn, ax=axes, label="log scale")
    else:
        axes.tripcolor(uv[:, 0], uv[:, 1], triangles, facecolors=values, cmap="tab10", **line)
    axes.set(aspect="equal", xlabel="u", ylabel="v")
    return axes


def curve(curve: np.ndarray, axes: Optional[Any] = None, *, target: float = 1.25) -> Any:
    """The predicted area distortion for every number of cones, of ``Analysis.curve``."""
    axes = _axes(axes)
    axes.plot(curve["n"], curve["predicted_area"], marker=".")
    axes.axhline(target, color="0.7", linewidth=1, linestyle="dashed")
    axes.set(xlabel="cones", ylabel="predicted area distortion", yscale="log")
    return axes


def _log_scale(result: Unwrapping) -> np.ndarray:
    """Half the log of each triangle's area in the plane over that on the surface, less its mean."""
    points = result.mesh.vertices[result.mesh.corners[result.triangles]]
    a, b = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    on_surface = np.linalg.norm(np.cross(a, b), axis=1)
    flat = result.uv[result.triangles]
    p, q = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    in_plane = np.abs(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    is_measured = (on_surface > 0) & (in_plane > 0)
    scale = np.zeros(len(points))
    scale[is_measured] = 0.5 * np.log(in_plane[is_measured] / on_surface[is_measured])
    if is_measured.any():
        scale[is_measured] -= np.average(scale[is_measured], weights=on_surface[is_measured])
    return scale
