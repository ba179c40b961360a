"""Blender's meshes as arrays and back.

A corner of the library is a loop of Blender: both go through the faces in order, and round each face in order. In edit mode the mesh is a
bmesh, whose faces, loops and edges are in the order of the mesh that ``update_from_editmode`` writes.
"""

import bmesh
import numpy as np

import cones


def read(obj):
    """The mesh of an object in its own coordinates."""
    if obj.mode == "EDIT":
        obj.update_from_editmode()
    data = obj.data
    return cones.Mesh(_points(data), _faces(data))


def _points(data):
    points = np.empty(3 * len(data.vertices), dtype=np.float32)
    data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(np.float64)


def _faces(data):
    corners = np.empty(len(data.loops), dtype=np.int32)
    data.loops.foreach_get("vertex_index", corners)
    starts = np.empty(len(data.polygons), dtype=np.int32)
    data.polygons.foreach_get("loop_start", starts)
    return np.split(corners, starts[1:]) if len(starts) else []


def edges(data):
    """The vertices of each edge (e, 2)."""
    table = np.empty(2 * len(data.edges), dtype=np.int32)
    data.edges.foreach_get("vertices", table)
    return table.reshape(-1, 2)


def marked_seams(obj):
    """The edges that are marked as seams (k, 2); the mesh has been read."""
    marked = np.empty(len(obj.data.edges), dtype=bool)
    obj.data.edges.foreach_get("use_seam", marked)
    return edges(obj.data)[marked]


def selected_vertices(obj):
    """The selected vertices; the mesh has been read."""
    selected = np.empty(len(obj.data.vertices), dtype=bool)
    obj.data.vertices.foreach_get("select", selected)
    return np.flatnonzero(selected)


def write(obj, uv, seams):
    """Puts texture coordinates on the active UV map, or on a new one, and marks edges (k, 2) as seams."""
    marked = _edge_indices(edges(obj.data), seams)
    if obj.mode == "EDIT":
        _write_in_edit_mode(obj.data, uv, marked)
        return
    data = obj.data
    layer = data.uv_layers.active or data.uv_layers.new(name="UVMap")
    # By the attribute: `layer.uv` writes into memory that a step of undo shares (Blender 5.0), and undo then gives back the new map.
    data.attributes[layer.name].data.foreach_set("vector", np.ascontiguousarray(uv, dtype=np.float32).reshape(-1))
    is_seam = np.empty(len(data.edges), dtype=bool)
    data.edges.foreach_get("use_seam", is_seam)
    is_seam[marked] = True
    data.edges.foreach_set("use_seam", is_seam)
    data.update()


def _write_in_edit_mode(data, uv, marked):
    mesh = bmesh.from_edit_mesh(data)
    layer = mesh.loops.layers.uv.verify()
    places = iter(uv.tolist())
    for face in mesh.faces:
        for loop in face.loops:
            loop[layer].uv = next(places)
    mesh.edges.ensure_lookup_table()
    for edge in marked.tolist():
        mesh.edges[edge].seam = True
    bmesh.update_edit_mesh(data, loop_triangles=False, destructive=False)


def _edge_indices(table, seams):
    """The place of each of some edges in a table of edges."""
    if len(seams) == 0:
        return np.empty(0, dtype=np.int64)
    keys, wanted = (np.sort(np.asarray(e, dtype=np.int64), axis=1) @ np.array([1 << 32, 1]) for e in (table, seams))
    order = np.argsort(keys)
    return order[np.searchsorted(keys, wanted, sorter=order)]
