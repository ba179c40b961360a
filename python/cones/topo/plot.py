"""Figures of diagrams and merge trees; needs matplotlib. Each draws on given axes, or on new ones, and returns them."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from ._fields import MergeTree
from ._pairs import Pairs


def _axes(axes: Optional[Any]) -> Any:
    if axes is not None:
        return axes
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


def diagram(pairs: Pairs, axes: Optional[Any] = None, **style: Any) -> Any:
    """Birth and death as points; essential classes on a dashed line beyond all values."""
    axes = _axes(axes)
    points = pairs.diagram()
    finite = points[np.isfinite(points).all(axis=1)]
    values = np.concatenate([finite.reshape(-1), points[:, 0]])
    low, high = (values.min(), values.max()) if len(values) else (0.0, 1.0)
    margin = 0.06 * ((high - low) or 1.0)
    never = low - margin if pairs.is_superlevel else high + margin
    shown = np.where(np.isinf(points), never, points)
    axes.plot([low - margin, high + margin], [low - margin, high + margin], color="0.7", linewidth=1)
    axes.axhline(never, color="0.7", linewidth=1, linestyle="dashed")
    axes.scatter(shown[:, 0], shown[:, 1], **{"s": 14, **style})
    axes.set(xlabel="birth", ylabel="death", aspect="equal")
    return axes


def barcode(pairs: Pairs, axes: Optional[Any] = None, n: int = 100, **style: Any) -> Any:
    """The n most persistent pairs as bars from birth to death, the longest on top."""
    axes = _axes(axes)
    table = pairs.top(n)
    rows = np.arange(len(table))
    axes.hlines(rows, table["birth"].astype(float), table["death"].astype(float), **{"linewidth": 2, **style})
    axes.invert_yaxis()
    axes.set(xlabel="value", ylabel="pair")
    return axes


def merge_tree(tree: MergeTree, axes: Optional[Any] = None, **style: Any) -> Any:
    """The tree: values upwards, leaves side by side in the order of their branches. For trees of up to some hundred leaves: simplify first."""
    axes = _axes(axes)
    nodes = tree.nodes()
    children: list[list[int]] = [[] for _ in nodes]
    for node, parent in enumerate(nodes["parent"].tolist()):
        if parent >= 0:
            children[parent].append(node)
    place = np.zeros(len(nodes))
    leaves = 0
    for root in np.flatnonzero(nodes["parent"] < 0).tolist():
        stack = [(root, False)]
        while stack:
            node, is_done = stack.pop()
            if not children[node]:
                place[node], leaves = leaves, leaves + 1
            elif is_done:
                place[node] = np.mean([place[child] for child in children[node]])
            else:
                stack.append((node, True))
                stack.extend((child, False) for child in children[node])
    value = nodes["value"].astype(float)
    for node, parent in enumerate(nodes["parent"].tolist()):
        if parent >= 0:
            line = {"color": "0.2", "linewidth": 1.2, **style}
            axes.plot([place[node], place[node], place[parent]], [value[node], value[parent], value[parent]], **line)
    axes.scatter(place[: tree.leaf_count], value[: tree.leaf_count], s=16, zorder=3)
    axes.set(ylabel="value", xticks=[])
    return axes
