"""Blender's meshes as arrays and back.

A corner of the library is a loop of Blender: both go through the faces in order, and round each face in order. In edit mode the mesh is a
bmesh, whose faces, loops and edges are in the order of the mesh that ``update_from_editmode`` writes.
"""

import bmesh
import numpy as np

import cones

#: The attribute of edges that says which of them `write` has marked as seams.
OWN = "cone_unwrap_seam"


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
    """The edges that the user has marked as seams (k, 2), and no earlier `write`; the mesh has been read."""
    return edges(obj.data)[_users_seams(obj)]


def _users_seams(obj):
    data = obj.data
    marked = np.empty(len(data.edges), dtype=bool)
    data.edges.foreach_get("use_seam", marked)
    if OWN not in data.attributes:
        return marked
    own = np.empty(len(data.edges), dtype=np.int32)
    if obj.mode == "EDIT":
        # The attribute's own data is empty then.
        mesh = bmesh.from_edit_mesh(data)
        layer = mesh.edges.layers.int[OWN]
        own[:] = [edge[layer] for edge in mesh.edges]
    else:
        data.attributes[OWN].data.foreach_get("value", own)
    return marked & (own == 0)


def selected_vertices(obj):
    """The selected vertices; the mesh has been read."""
    selected = np.empty(len(obj.data.vertices), dtype=bool)
    obj.data.vertices.foreach_get("select", selected)
    return np.flatnonzero(selected)


def write(obj, uv, seams=None):
    """Puts texture coordinates on the active UV map, or on a new one. Marks edges (k, 2) as seams where some are given, in place of those that
    an earlier call has marked: they would pile up, and be taken for the user's."""
    data = obj.data
    own = None
    if seams is not None:
        own = np.zeros(len(data.edges), dtype=bool)
        own[_edge_indices(edges(data), seams)] = True
        users = _users_seams(obj)
        own &= ~users
    if obj.mode == "EDIT":
        _write_in_edit_mode(data, uv, own)
        return
    layer = data.uv_layers.active or data.uv_layers.new(name="UVMap")
    # By the attribute: `layer.uv` writes into memory that a step of undo shares (Blender 5.0), and undo then gives back the new map.
    data.attributes[layer.name].data.foreach_set("vector", np.ascontiguousarray(uv, dtype=np.float32).reshape(-1))
    if own is not None:
        data.edges.foreach_set("use_seam", users | own)
        if OWN not in data.attributes:
            data.attributes.new(OWN, "INT", "EDGE")
        data.attributes[OWN].data.foreach_set("value", own.astype(np.int32))
    data.update()


def _write_in_edit_mode(data, uv, own):
    mesh = bmesh.from_edit_mesh(data)
    # Layers first: one that is made moves the others.
    layer = mesh.loops.layers.uv.verify()
    owns = None if own is None else mesh.edges.layers.int.get(OWN) or mesh.edges.layers.int.new(OWN)
    places = iter(uv.tolist())
    for face in mesh.faces:
        for loop in face.loops:
            loop[layer].uv = next(places)
    if own is not None:
        for edge, is_own in zip(mesh.edges, own.tolist()):
            if is_own or edge[owns]:
                edge.seam, edge[owns] = is_own, is_own
    bmesh.update_edit_mesh(data, loop_triangles=False, destructive=False)


def _edge_indices(table, seams):
    """The place of each of some edges in a table of edges."""
    if len(seams) == 0:
        return np.empty(0, dtype=np.int64)
    keys, wanted = (np.sort(np.asarray(e, dtype=np.int64), axis=1) @ np.array([1 << 32, 1]) for e in (table, seams))
    order = np.argsort(keys)
    return order[np.searchsorted(keys, wanted, sorter=order)]
