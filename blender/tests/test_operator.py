"""The extension in the real Blender, without a window: run with a Python that has `bpy` (from PyPI) and the package `cones`."""

import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
bmesh = pytest.importorskip("bmesh")

import cones  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import cone_unwrap  # noqa: E402
from cone_unwrap import exchange, operator  # noqa: E402
from cone_unwrap.work import Stopped, Work  # noqa: E402


@pytest.fixture(autouse=True)
def scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    cone_unwrap.register()
    yield
    cone_unwrap.unregister()


def cube():
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object


def suzanne():
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def from_mesh(mesh, name):
    data = bpy.data.meshes.new(name)
    data.from_pydata(mesh.vertices.tolist(), [], [face.tolist() for face in mesh.faces])
    obj = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(obj)
    return obj


def select(*objects):
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def uv_of(obj):
    if obj.mode == "EDIT":
        mesh = bmesh.from_edit_mesh(obj.data)
        layer = mesh.loops.layers.uv.active
        return np.array([loop[layer].uv[:] for face in mesh.faces for loop in face.loops])
    layer = obj.data.uv_layers.active
    uv = np.empty(2 * len(obj.data.loops), dtype=np.float32)
    layer.uv.foreach_get("vector", uv)
    return uv.reshape(-1, 2).astype(np.float64)


def seams_of(obj):
    if obj.mode == "EDIT":
        obj.update_from_editmode()
    return {frozenset(edge.vertices) for edge in obj.data.edges if edge.use_seam}


def measured(obj):
    return cones.measure(exchange.read(obj), uv=uv_of(obj))


def assert_is_map(obj, **keywords):
    """The object has the map of the library on its loops, and its seams are marked where the map is cut."""
    expected = cones.unwrap(exchange.read(obj), **keywords)
    assert np.abs(uv_of(obj) - expected.uv).max() < 1e-6
    assert {frozenset(edge) for edge in expected.seam_edges.tolist()} <= seams_of(obj)
    found = measured(obj)
    assert found.distortion["flipped"] == 0
    assert found.distortion["quasi_conformal"]["mean"] == pytest.approx(expected.distortion["quasi_conformal"]["mean"], rel=1e-3)
    return expected


def test_a_cube_in_object_mode():
    obj = cube()
    assert bpy.ops.uv.cone_unwrap() == {"FINISHED"}
    expected = assert_is_map(obj)
    # Eight corners of curvature π/2 leave nothing to distort.
    assert len(expected.cones) == 8 and expected.distortion["area_mean"] == pytest.approx(1)
    assert measured(obj).distortion["area_mean"] == pytest.approx(1, abs=1e-5)


def test_suzanne_in_edit_mode_has_the_same_map_as_in_object_mode():
    obj = suzanne()
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.uv.cone_unwrap(number="COUNT", count=20) == {"FINISHED"}
    in_edit_mode, seams = uv_of(obj), seams_of(obj)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (uv_of(obj) == in_edit_mode).all() and seams_of(obj) == seams
    again = suzanne()
    assert bpy.ops.uv.cone_unwrap(number="COUNT", count=20) == {"FINISHED"}
    assert_is_map(again, n=20)
    assert (uv_of(again) == in_edit_mode).all() and seams_of(again) == seams


def equator(mesh):
    """The edges between the faces of the upper half and those of the lower one: closed loops."""
    is_upper = mesh.vertices[mesh.faces].mean(axis=1)[:, 2] > np.median(mesh.vertices[:, 2])
    sides = [frozenset(edge) for face in mesh.faces.tolist() for edge in zip(face, face[1:] + face[:1])]
    owner = np.repeat(is_upper, 3)
    upper, lower = ({side for side, own in zip(sides, owner) if own == half} for half in (True, False))
    return upper & lower


def test_two_objects_with_marked_seams_are_unwrapped_each_along_its_seams():
    meshes = [cones.shape("capsule", 400), cones.shape("torus", 500)]
    objects = [from_mesh(mesh, name) for mesh, name in zip(meshes, ("capsule", "torus"))]
    loops = [equator(mesh) for mesh in meshes]
    for obj, loop in zip(objects, loops):
        for edge, ends in zip(obj.data.edges, exchange.edges(obj.data).tolist()):
            edge.use_seam = frozenset(ends) in loop
    select(*objects)
    assert bpy.ops.uv.cone_unwrap(number="COUNT", count=5) == {"FINISHED"}
    for obj, mesh, loop in zip(objects, meshes, loops):
        assert loop and loop <= seams_of(obj)
        at = {}
        uv = uv_of(obj)
        for face, corners in zip(mesh.faces.tolist(), np.arange(len(uv)).reshape(-1, 3).tolist()):
            for k in range(3):
                a, b = (k, (k + 1) % 3) if face[k] < face[(k + 1) % 3] else ((k + 1) % 3, k)
                at.setdefault(frozenset((face[a], face[b])), set()).add(tuple(uv[[corners[a], corners[b]]].reshape(-1)))
        # The two sides of a marked edge lie apart, those of an edge that is no seam together.
        assert all(len(at[edge]) == 2 for edge in loop)
        assert all(len(places) == 1 for edge, places in at.items() if edge not in seams_of(obj))


def test_seams_are_left_alone_where_that_is_asked():
    obj = from_mesh(cones.shape("capsule", 400), "capsule")
    select(obj)
    bpy.ops.uv.cone_unwrap(mark_seams=False)
    assert seams_of(obj) == set()


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_marks_of_an_earlier_run_make_way_and_those_of_the_user_stay(mode):
    mesh = cones.shape("capsule", 400)
    obj, fresh = from_mesh(mesh, "capsule"), from_mesh(mesh, "fresh")
    loop = equator(mesh)
    for one in (obj, fresh):
        for edge in one.data.edges:
            edge.use_seam = frozenset(edge.vertices) in loop
    select(obj)
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.uv.cone_unwrap(number="COUNT", count=24)
    many = seams_of(obj)
    bpy.ops.uv.cone_unwrap(number="COUNT", count=6, mark_seams=False)
    assert seams_of(obj) == many
    bpy.ops.uv.cone_unwrap(number="COUNT", count=6)
    bpy.ops.object.mode_set(mode="OBJECT")
    select(fresh)
    bpy.ops.uv.cone_unwrap(number="COUNT", count=6)
    assert loop < seams_of(obj) == seams_of(fresh) and len(seams_of(obj)) < len(many)
    assert (uv_of(obj) == uv_of(fresh)).all()


def test_a_linked_mesh_is_refused_and_stops_no_other(tmp_path):
    library = str(tmp_path / "library.blend")
    cube().name = "theirs"
    bpy.data.libraries.write(library, {bpy.context.object})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(library, link=True) as (_, to):
        to.objects = ["theirs"]
    bpy.context.collection.objects.link(bpy.data.objects["theirs"])
    select(bpy.data.objects["theirs"])
    with pytest.raises(RuntimeError, match="theirs: its mesh is linked from another file"):
        bpy.ops.uv.cone_unwrap()
    obj = cube()
    bpy.data.objects["theirs"].select_set(True)
    assert bpy.ops.uv.cone_unwrap() == {"FINISHED"}
    assert_is_map(obj)


def test_repairs_and_scales_are_told():
    mesh = cones.shape("capsule", 400)
    obj = from_mesh(cones.Mesh(np.vstack([mesh.vertices, mesh.vertices[:1]]), mesh.faces), "capsule")
    obj.scale = (1, 1, -2)
    select(obj)
    run = Run()
    run.execute(run.context)
    told = [sentence for _, sentence in run.reports]
    assert told[0].startswith("capsule: 1 isolated vertex, left out") and "capsule: it has non-uniform scale" in told[1]
    obj.scale = (2, 2, -2)
    run.reports.clear()
    run.execute(run.context)
    assert not any("scale" in sentence for _, sentence in run.reports)


def test_selected_vertices_are_cones():
    mesh = cones.shape("capsule", 400)
    obj = from_mesh(mesh, "capsule")
    select(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(obj.data)
    bm.verts.ensure_lookup_table()
    chosen = [3, 50, 120, 200, 310]
    for v in chosen:
        bm.verts[v].select = True
    bmesh.update_edit_mesh(obj.data)
    assert bpy.ops.uv.cone_unwrap(number="SELECTED") == {"FINISHED"}
    assert_is_map(obj, cones=chosen)


def select_faces(obj, faces):
    """In edit mode, these faces alone."""
    bpy.ops.mesh.select_all(action="DESELECT")
    mesh = bmesh.from_edit_mesh(obj.data)
    mesh.faces.ensure_lookup_table()
    for face in faces:
        mesh.faces[face].select_set(True)
    bmesh.update_edit_mesh(obj.data)


def test_in_edit_mode_selected_faces_are_unwrapped_and_the_others_keep_their_map_and_seams():
    mesh = cones.shape("capsule", 400)
    obj = from_mesh(mesh, "capsule")
    select(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.uv.cone_unwrap(number="COUNT", count=6)
    before, seams = uv_of(obj), seams_of(obj)
    is_upper = mesh.vertices[mesh.faces].mean(axis=1)[:, 2] > np.median(mesh.vertices[:, 2])
    upper = np.flatnonzero(is_upper)
    select_faces(obj, upper)
    assert bpy.ops.uv.cone_unwrap(number="COUNT", count=2) == {"FINISHED"}
    after = uv_of(obj)
    corners = np.repeat(is_upper, 3)
    assert (after[~corners] == before[~corners]).all()
    # The selected faces have the map of a mesh of their own, in the square.
    vertices, faces = np.unique(mesh.faces[is_upper], return_inverse=True)
    alone = cones.unwrap(mesh.vertices[vertices].astype(np.float32), faces.reshape(-1, 3), n=2, keep_seams=False)
    assert np.abs(after[corners] - alone.uv).max() < 1e-6
    edges = lambda chosen: {frozenset(edge) for face in chosen.tolist() for edge in zip(face, face[1:] + face[:1])}  # noqa: E731
    touched, rim = edges(mesh.faces[is_upper]), equator(mesh)
    cut = {frozenset(edge) for edge in vertices[alone.seam_edges].tolist()}
    assert cut and rim and seams_of(obj) == (seams - touched) | cut | rim


def test_user_seams_among_selected_faces_are_kept_and_those_at_their_rim_are_not_told_of():
    mesh = cones.shape("capsule", 400)
    obj = from_mesh(mesh, "capsule")
    rim = equator(mesh)
    marked = {frozenset(edge) for edge in cones.unwrap(mesh, n=6).seam_edges.tolist()} | rim
    for edge in obj.data.edges:
        edge.use_seam = frozenset(edge.vertices) in marked
    select(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    is_upper = mesh.vertices[mesh.faces].mean(axis=1)[:, 2] > np.median(mesh.vertices[:, 2])
    select_faces(obj, np.flatnonzero(is_upper))
    run = Run()
    assert run.execute(run.context) == {"FINISHED"}
    assert not any("boundary" in sentence for _, sentence in run.reports)
    assert marked <= seams_of(obj)


def test_of_several_meshes_in_edit_mode_those_without_a_selected_face_are_left_alone():
    objects = [from_mesh(cones.shape("capsule", 400), name) for name in ("one", "other")]
    select(*objects)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="no face is selected: select those that are to be unwrapped"):
        bpy.ops.uv.cone_unwrap()
    mesh = bmesh.from_edit_mesh(objects[0].data)
    for face in mesh.faces:
        face.select_set(True)
    bmesh.update_edit_mesh(objects[0].data)
    assert bpy.ops.uv.cone_unwrap() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert_is_map(objects[0])
    assert not objects[1].data.uv_layers and seams_of(objects[1]) == set()


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_polygons_are_cut_into_the_triangles_of_the_map(mode):
    obj = suzanne()
    read = exchange.read(obj)
    expected = cones.unwrap(read, n=20)
    bpy.ops.object.mode_set(mode=mode)
    assert bpy.ops.uv.cone_unwrap(number="COUNT", count=20, triangulate=True) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    found = exchange.read(obj)
    assert set(np.diff(found.face_start)) == {3} and found.vertex_count == read.vertex_count
    key = lambda corners, uv: {frozenset(zip(t, map(tuple, at))) for t, at in zip(corners.tolist(), uv.tolist())}  # noqa: E731
    rounded = lambda uv: uv.astype(np.float32)  # noqa: E731
    triangles = key(read.corners[expected.triangles], rounded(expected.uv)[expected.triangles])
    assert key(found.corners.reshape(-1, 3), rounded(uv_of(obj)).reshape(-1, 3, 2)) == triangles
    assert measured(obj).distortion["flipped"] == 0
    assert {frozenset(edge) for edge in expected.seam_edges.tolist()} == seams_of(obj)


def test_only_selected_polygons_are_cut_whatever_corners_they_have():
    bpy.ops.mesh.primitive_cylinder_add(vertices=13)
    obj = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    obj.data.materials.append(bpy.data.materials.new("wood"))
    obj.data.materials.append(bpy.data.materials.new("end"))
    chosen = [k for k, face in enumerate(exchange.read(obj).faces) if len(face) == 13][:1] + [0, 1]
    mesh = bmesh.from_edit_mesh(obj.data)
    mesh.faces.ensure_lookup_table()
    mesh.faces[chosen[0]].material_index, mesh.faces[chosen[0]].smooth = 1, True
    select_faces(obj, chosen)
    assert bpy.ops.uv.cone_unwrap(triangulate=True) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    sizes = [polygon.loop_total for polygon in obj.data.polygons]
    assert (sizes.count(13), sizes.count(4), sizes.count(3)) == (1, 11, 11 + 2 * 2)
    # The pieces are selected as the whole was, and have its material and shading.
    assert sum(polygon.select for polygon in obj.data.polygons) == 11 + 2 * 2
    assert sum(polygon.material_index == 1 and polygon.use_smooth for polygon in obj.data.polygons) == 11


@pytest.mark.parametrize(
    "shape, asked", [(cube, {"rotations": "none"}), (lambda: from_mesh(cones.shape("capsule", 400), "capsule"), {"free_seams": "always"})]
)
def test_rotations_and_free_seams_are_asked_of_the_library(shape, asked):
    obj = shape()
    select(obj)
    bpy.ops.uv.cone_unwrap(mark_seams=False)
    usual = uv_of(obj)
    bpy.ops.uv.cone_unwrap(**asked)
    assert np.abs(uv_of(obj) - usual).max() > 0.01
    assert_is_map(obj, **asked)


def test_what_could_not_be_had_is_a_warning_and_is_said_last():
    obj = from_mesh(cones.shape("capsule", 400), "capsule")
    select(obj)
    run = Run()
    run.count = 1
    run.execute(run.context)
    kinds = [(next(iter(kind)), sentence) for kind, sentence in run.reports]
    assert kinds[-1] == ("WARNING", "capsule: 1 cone asked for, but this surface needs at least 3: taking 3")
    assert kinds[-2][0] == "INFO" and "3 cones" in kinds[-2][1]


def test_an_object_that_cannot_be_unwrapped_is_told_of_and_stops_no_other():
    wire = bpy.data.meshes.new("wire")
    wire.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    wire = bpy.data.objects.new("wire", wire)
    bpy.context.collection.objects.link(wire)
    select(wire)
    with pytest.raises(RuntimeError, match="wire: there are 2 vertices but no faces"):
        bpy.ops.uv.cone_unwrap()
    obj = cube()
    wire.select_set(True)
    assert bpy.ops.uv.cone_unwrap() == {"FINISHED"}
    assert_is_map(obj)
    with pytest.raises(RuntimeError, match="in edit mode"):
        bpy.ops.uv.cone_unwrap(number="SELECTED")


def test_an_operator_without_meshes_does_not_poll():
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.uv.cone_unwrap()


def test_undo_gives_the_old_map_back():
    obj = cube()
    obj.data.edges[3].use_seam = True
    bpy.ops.ed.undo_push(message="a cube")
    before, seams = uv_of(obj), seams_of(obj)
    bpy.ops.uv.cone_unwrap("EXEC_DEFAULT", True)  # and its step of undo
    assert np.abs(uv_of(obj) - before).max() > 0.01
    assert seams < seams_of(obj)
    bpy.ops.ed.undo()
    obj = bpy.context.view_layer.objects.active
    assert (uv_of(obj) == before).all() and seams_of(obj) == seams


def test_an_object_keeps_its_other_uv_maps_and_its_polygons():
    obj = cube()
    other = obj.data.uv_layers.new(name="other")
    obj.data.uv_layers.active = other
    first = obj.data.uv_layers[0]
    kept = np.empty(2 * len(obj.data.loops), dtype=np.float32)
    first.uv.foreach_get("vector", kept)
    bpy.ops.uv.cone_unwrap()
    after = np.empty_like(kept)
    obj.data.uv_layers[0].uv.foreach_get("vector", after)
    assert (kept == after).all() and len(obj.data.polygons) == 6
    assert_is_map(obj)


def finished(work):
    work.start()
    until = time.monotonic() + 60
    while not work.is_done():
        assert time.monotonic() < until
        time.sleep(0.01)
    return work


def test_work_beside_blender_comes_to_what_a_call_does():
    meshes = [cones.shape("capsule", 400), cones.shape("torus", 500)]
    jobs = [("capsule", {"vertices": meshes[0], "n": 4}), ("capsule", {"vertices": meshes[0], "cones": [10**6]}), ("torus", {"vertices": meshes[1], "n": 4})]
    told = []
    work = finished(Work(jobs, told.append))
    for mesh, outcome in zip(meshes, work.outcomes[::2]):
        assert (outcome.uv == cones.unwrap(mesh, n=4).uv).all()
    assert isinstance(work.outcomes[1], cones.Error) and len(work.outcomes) == 3
    assert told == sorted(told) and all(0 <= fraction <= 1 for fraction in told)


def test_work_is_stopped_at_once_and_a_bug_in_it_is_no_silence():
    work = Work([("hare", {"vertices": cones.shape("hare", 60_000), "n": 64})] * 50)
    work.start()
    time.sleep(0.3)
    begin = time.monotonic()
    work.stop()
    assert time.monotonic() - begin < 5
    with pytest.raises(Stopped):
        work.is_done()
    with pytest.raises(TypeError):
        finished(Work([("cube", {"no_such_option": 1})]))


class Run:
    """The operator as Blender's window runs it, which is not there without one: its own functions, with a stand-in for Blender's loop of events."""

    invoke, modal, cancel, execute = (operator.UV_OT_cone_unwrap.__dict__[name] for name in ("invoke", "modal", "cancel", "execute"))
    _begin, _end, _finish, _part, _keywords = (
        operator.UV_OT_cone_unwrap.__dict__[name] for name in ("_begin", "_end", "_finish", "_part", "_keywords")
    )
    number, count, distortion, islands, free_seams, rotations = "COUNT", 5, 1.25, "overlap-free", "auto", "any"
    margin, texture_size, fill_holes, use_seams, mark_seams, triangulate = 4.0, 1024, False, True, True, False

    def __init__(self):
        self.reports, self.calls = [], []
        note = lambda name: lambda *rest, **named: self.calls.append((name, *rest)) or object()  # noqa: E731
        manager = SimpleNamespace(**{name: note(name) for name in MANAGER})
        window = SimpleNamespace(status_text_set=note("status"))
        of = bpy.context
        self.context = SimpleNamespace(
            window_manager=manager, workspace=window, window=object(), mode=of.mode, selected_objects=of.selected_objects,
            objects_in_mode_unique_data=of.objects_in_mode_unique_data,
        )

    def report(self, kind, sentence):
        self.reports.append((kind, sentence))

    def events(self, *types):
        for name in types:
            answer = self.modal(self.context, SimpleNamespace(type=name))
        return answer


MANAGER = ("progress_begin", "progress_update", "progress_end", "event_timer_add", "event_timer_remove", "modal_handler_add")


@pytest.fixture
def with_window(monkeypatch):
    monkeypatch.setattr(operator, "bpy", SimpleNamespace(app=SimpleNamespace(background=False)))


def test_in_a_window_the_work_runs_beside_blender_with_progress(with_window):
    obj = from_mesh(cones.shape("capsule", 400), "capsule")
    select(obj)
    run = Run()
    assert run.invoke(run.context, None) == {"RUNNING_MODAL"}
    # Whoever looks round is let; a key that would change the mesh is not.
    assert run.events("MIDDLEMOUSE") == {"PASS_THROUGH"} and run.events("X") == {"RUNNING_MODAL"}
    until = time.monotonic() + 60
    while (answer := run.events("TIMER")) == {"RUNNING_MODAL"}:
        assert time.monotonic() < until
        time.sleep(0.01)
    assert answer == {"FINISHED"} and "5 cones" in run.reports[-1][1]
    assert_is_map(obj, n=5)
    names = [name for name, *_ in run.calls]
    assert names.count("progress_begin") == names.count("progress_end") == 1 and "progress_update" in names
    assert [call for call in run.calls if call[0] == "status"][-1] == ("status", None)


def test_in_a_window_esc_stops_the_work_and_changes_nothing(with_window):
    obj = from_mesh(cones.shape("hare", 30_000), "hare")
    select(obj)
    run = Run()
    run.count = 64
    run.invoke(run.context, None)
    begin = time.monotonic()
    assert run.events("TIMER", "ESC") == {"CANCELLED"}
    assert time.monotonic() - begin < 5
    assert not obj.data.uv_layers and seams_of(obj) == set()
    assert "progress_end" in [name for name, *_ in run.calls] and not run.work._thread.is_alive()
