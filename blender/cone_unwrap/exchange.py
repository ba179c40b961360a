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
    return Part(obj).mesh


class Part:
    """Faces of an object as a mesh of their own, and where they are in the object's; all of them, unless some are given (a mask)."""

    def __init__(self, obj, faces=None):
        if obj.mode == "EDIT":
            obj.update_from_editmode()
        self.obj, self.data = obj, obj.data
        data = obj.data
        points, polygons = _points(data), _faces(data)
        self.is_whole = faces is None or bool(np.all(faces))
        #: The object's vertex of each vertex; masks of the object's faces, loops, edges at these faces, and edges between them and others.
        self.vertices = np.arange(len(points))
        self.faces, self.loops, self.edges, self.rim = (
            np.full(len(of), value) for of, value in ((polygons, True), (data.loops, True), (data.edges, True), (data.edges, False))
        )
        if not self.is_whole:
            self._restrict(polygons, faces)
            chosen = [polygons[face] for face in np.flatnonzero(faces)]
            self.vertices, corners = np.unique(np.concatenate(chosen), return_inverse=True)
            points, polygons = points[self.vertices], np.split(corners, np.cumsum([len(face) for face in chosen])[:-1])
        self.mesh = cones.Mesh(points, polygons)

    def _restrict(self, polygons, faces):
        self.faces, self.loops = faces, np.repeat(faces, [len(polygon) for polygon in polygons])
        along = np.empty(len(self.data.loops), dtype=np.int32)
        self.data.loops.foreach_get("edge_index", along)
        self.edges, others = (np.zeros(len(self.data.edges), dtype=bool) for _ in range(2))
        self.edges[along[self.loops]] = True
        others[along[~self.loops]] = True
        self.rim = self.edges & others

    def marked_seams(self):
        """The edges that the user has marked as seams (k, 2), and no earlier `write`; the rim is cut anyway."""
        marked = edges(self.data)[_seams(self.obj)[0] & self.edges & ~self.rim]
        return np.searchsorted(self.vertices, marked)

    def _cut(self, seams):
        """A mask of the object's edges that are seams (k, 2) of the part, or its rim."""
        cut = self.rim.copy()
        cut[_edge_indices(edges(self.data), self.vertices[np.asarray(seams, dtype=np.int64)])] = True
        return cut


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


def _seams(obj):
    """Masks of the edges that the user has marked as seams, and of those that an earlier `write` has."""
    data = obj.data
    marked = np.empty(len(data.edges), dtype=bool)
    data.edges.foreach_get("use_seam", marked)
    if OWN not in data.attributes:
        return marked, np.zeros_like(marked)
    own = np.empty(len(data.edges), dtype=np.int32)
    if obj.mode == "EDIT":
        # The attribute's own data is empty then.
        mesh = bmesh.from_edit_mesh(data)
        layer = mesh.edges.layers.int[OWN]
        own[:] = [edge[layer] for edge in mesh.edges]
    else:
        data.attributes[OWN].data.foreach_get("value", own)
    return marked & (own == 0), marked & (own != 0)


def selected_vertices(obj):
    """The selected vertices, in edit mode."""
    return np.flatnonzero(_selected(obj, obj.data.vertices))


def selected_faces(obj):
    """A mask of the selected faces, in edit mode; hidden ones are none of them."""
    return _selected(obj, obj.data.polygons)


def _selected(obj, elements):
    obj.update_from_editmode()
    selected = np.empty(len(elements), dtype=bool)
    elements.foreach_get("select", selected)
    return selected


def write(part, uv, seams=None):
    """Puts texture coordinates on the active UV map, or on a new one; other faces keep theirs. Marks the part's edges (k, 2) as seams where some
    are given, and its rim, in place of those of its edges that an earlier call has marked: they would pile up, and be taken for the user's."""
    data = part.data
    own = None
    if seams is not None:
        users, earlier = _seams(part.obj)
        own = np.where(part.edges, part._cut(seams), earlier) & ~users
    if part.obj.mode == "EDIT":
        _write_in_edit_mode(part, uv, own)
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


def _write_in_edit_mode(part, uv, own):
    mesh = bmesh.from_edit_mesh(part.data)
    # Layers first: one that is made moves the others.
    layer = mesh.loops.layers.uv.verify()
    owns = None if own is None else mesh.edges.layers.int.get(OWN) or mesh.edges.layers.int.new(OWN)
    places = iter(uv.tolist())
    for face, is_here in zip(mesh.faces, part.faces.tolist()):
        if is_here:
            for loop in face.loops:
                loop[layer].uv = next(places)
    if own is not None:
        for edge, is_own in zip(mesh.edges, own.tolist()):
            if is_own or edge[owns]:
                edge.seam, edge[owns] = is_own, is_own
    bmesh.update_edit_mesh(part.data, loop_triangles=False, destructive=False)


def triangulate(part, triangles):
    """Cuts the part's polygons into triangles, given as corners of its mesh (t, 3): those that its map was computed with."""
    if part.obj.mode == "EDIT":
        mesh = bmesh.from_edit_mesh(part.data)
        _split(mesh, part, triangles)
        bmesh.update_edit_mesh(part.data)
        return
    mesh = bmesh.new()
    mesh.from_mesh(part.data)
    _split(mesh, part, triangles)
    mesh.to_mesh(part.data)
    mesh.free()
    part.data.update()


def _split(mesh, part, triangles):
    faces = [face for face, is_here in zip(mesh.faces, part.faces.tolist()) if is_here]
    corners = [(k, vertex) for k, face in enumerate(faces) for vertex in face.verts]
    pieces = [{face} for face in faces]
    for triangle in triangles.tolist():
        face = corners[triangle[0]][0]
        a, b, c = (corners[corner][1] for corner in triangle)
        for ends in ((a, b), (b, c), (c, a)):
            for piece in pieces[face].intersection(ends[0].link_faces):
                # One that has both, side by side or not: it is cut if they are not.
                if ends[1] in piece.verts and not _are_neighbours(piece, *ends):
                    other, _ = bmesh.utils.face_split(piece, *ends)
                    other.select_set(piece.select)
                    pieces[face].add(other)


def _are_neighbours(face, a, b):
    around = list(face.verts)
    return abs(around.index(a) - around.index(b)) in (1, len(around) - 1)


def _edge_indices(table, seams):
    """The place of each of some edges in a table of edges."""
    if len(seams) == 0:
        return np.empty(0, dtype=np.int64)
    keys, wanted = (np.sort(np.asarray(e, dtype=np.int64), axis=1) @ np.array([1 << 32, 1]) for e in (table, seams))
    order = np.argsort(keys)
    return order[np.searchsorted(keys, wanted, sorter=order)]
