"""Unwrapping from Python is unwrapping by the command."""

import errno
import gzip
import json
import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import cones
from conftest import report

# (shape, vertices, keywords, arguments of the command)
CASES = [
    ("hare", 1500, {}, []),
    ("hare", 1500, {"n": 8}, ["-n", "8"]),
    ("part", 1200, {"n": 12, "scale": "area", "islands": "single"}, ["-n", "12", "--scale", "area", "--islands", "single"]),
    ("torus-3", 2000, {"n": 9, "method": "pursuit", "margin": 8.0}, ["-n", "9", "--method", "pursuit", "--margin", "8"]),
    ("capsule", 700, {"n": 6, "quantize": 4}, ["-n", "6", "--quantize", "4"]),
    ("terrain", 900, {"max_distortion": 1.1, "angles": "optimal"}, ["--max-distortion", "1.1"]),
    ("part", 600, {"refine": "always", "n": 8}, ["--refine", "-n", "8"]),
    # refined once more, since two cones bend its angles
    ("sphere", 40, {"refine": "always", "n": 2, "free_seams": "never"}, ["--refine", "-n", "2", "--free-seams", "never"]),
    ("torus", 900, {"n": 8, "fill_holes": 0.4}, ["-n", "8", "--fill-holes=0.4"]),
    ("hare", 900, {"n": 16, "islands": "pack", "rotations": "quarter"}, ["-n", "16", "--islands", "pack", "--rotations", "quarter"]),
]


@pytest.mark.parametrize("name, vertices, keywords, arguments", CASES)
def test_coordinates_and_reports_are_those_of_the_command_to_the_bit(command, tmp_path, name, vertices, keywords, arguments):
    path, out, told = (tmp_path / file for file in ("in.obj", "out.obj", "report.json"))
    cones.shape(name, vertices).write(path)
    command("unwrap", path, "-o", out, "--report", told, *arguments)
    result = cones.unwrap(path, **keywords)
    theirs = cones.read(out)
    assert (result.mesh.corners == theirs.corners).all()
    assert (result.uv == theirs.uv).all()
    expected, ours = report(told), json.loads(json.dumps(result.report))
    for key in ("distortion", "islands", "cones", "repairs", "seams", "number", "method", "angles", "policy", "warnings"):
        assert ours[key] == expected[key], key


def test_what_is_written_is_what_the_command_writes(command, tmp_path, hare):
    path = tmp_path / "in.obj"
    hare.write(path)
    for ending in ("obj", "ply"):
        ours, theirs = tmp_path / f"ours.{ending}", tmp_path / f"theirs.{ending}"
        command("unwrap", path, "-o", theirs, "-n", "6")
        cones.unwrap(path, n=6).write(ours)
        assert ours.read_bytes() == theirs.read_bytes()


def test_measuring_parting_and_packing_are_those_of_the_command(command, tmp_path, hare):
    path, out = tmp_path / "single.obj", tmp_path / "out.obj"
    cones.unwrap(hare, n=24, islands="single").write(path)
    ours = cones.measure(path)
    theirs = json.loads(command("measure", path, "--json"))
    assert ours.distortion == theirs["distortion"] and ours.islands == theirs["islands"]
    command("islands", path, "-o", out)
    parted = cones.islands(path)
    assert (parted.uv == cones.read(out).uv).all()
    assert cones.measure(cones.read(path), uv=parted.uv).distortion["overlap_pairs"] == 0
    command("pack", path, "-o", out, "--rotations", "quarter")
    assert (cones.pack(path, rotations="quarter").uv == cones.read(out).uv).all()
    mesh = cones.read(path)
    named = 10**12 * parted.triangle_island
    packed = [cones.pack(mesh, uv=parted.uv, triangle_island=names).uv for names in (parted.triangle_island, named)]
    assert (packed[0] == packed[1]).all()


def test_copies_and_triangles_with_a_vertex_twice_are_not_measured(command, tmp_path):
    square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 2 1\nvt 0 1\n"
    spare = "f 3/3 2/2 1/1\nf 1/1 2/2 2/3\n"
    (tmp_path / "square.obj").write_text(f"{square}f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
    (tmp_path / "spare.obj").write_text(f"{square}f 1/1 2/2 3/3\n{spare}f 1/1 3/3 4/4\n")
    ours, plain = cones.measure(tmp_path / "spare.obj"), cones.measure(tmp_path / "square.obj")
    assert ours.distortion == plain.distortion and ours.islands == plain.islands
    theirs = json.loads(command("measure", tmp_path / "spare.obj", "--json"))
    assert ours.distortion == theirs["distortion"] and len(ours.left_out) == theirs["input"]["left_out"]
    assert ours.left_out.tolist() == [1, 2] and ours.triangle_island.tolist() == [0, -1, -1, 0]
    assert ours.triangle_quasi_conformal.tolist() == pytest.approx([2, 1, 1, 2]) and not ours.triangle_log_scale[1:3].any()
    mesh = cones.read(tmp_path / "spare.obj")
    over = mesh.uv.copy()
    over[9:] = mesh.uv[:3] * 0.5 + 0.1
    assert cones.measure(mesh, uv=over).overlapping.tolist() == [0, 3]
    over[10] = np.nan
    with pytest.raises(cones.Error, match="triangle 3 "):
        cones.measure(mesh, uv=over)


def test_one_analysis_gives_the_maps_of_one_call(hare):
    analysis = cones.Analysis(hare.vertices, hare.faces)
    eight = analysis.place(8)
    again = analysis.flatten(eight)
    assert (again.uv == cones.unwrap(hare, n=8).uv).all()
    assert analysis.predict(eight.vertices)["n"] == 8
    assert analysis.predict(eight)["predicted_area"] == pytest.approx(eight.prediction["predicted_area"], rel=1e-9)
    curve = analysis.curve(20)
    assert (np.diff(curve["n"]) > 0).all() and curve["predicted_area"][-1] < curve["predicted_area"][0]
    given = analysis.flatten(eight.table)
    assert {int(v) for v in given.cones["vertex"]} == {int(v) for v in eight.vertices}
    assert np.allclose(given.uv, again.uv)


def test_curvatures_of_a_closed_surface_sum_to_gauss_bonnet(hare):
    analysis = cones.Analysis(hare)
    assert analysis.place(7).curvatures.sum() == pytest.approx(2 * np.pi * analysis.topology["euler"])
    phi = analysis.conformal_factor()
    extrema = analysis.extrema()
    assert (phi[extrema["vertex"]] == extrema["value"]).all()
    top = extrema[0]
    assert top["persistence"] == phi.max() - phi.min()


def test_merged_copies_of_a_vertex_stand_for_it(hare):
    soup = hare.vertices[hare.corners]
    analysis = cones.Analysis(soup, np.arange(len(soup)).reshape(-1, 3), weld=True)
    whole = cones.Analysis(hare).conformal_factor()
    assert np.allclose(analysis.conformal_factor(), whole[hare.corners], atol=1e-9)
    four = analysis.place(4).vertices
    copy = next(v for v in np.flatnonzero((soup == soup[four[0]]).all(axis=1)) if v != four[0])
    assert (analysis.place(cones=[copy, *four[1:]]).vertices == four).all()
    with pytest.raises(cones.Error, match="is given twice"):
        analysis.place(cones=[copy, *four])


def test_meshes_may_have_texture_coordinates(hare):
    result = cones.unwrap(hare, n=4)
    mapped = cones.Mesh(hare.vertices, hare.faces, result.uv)
    assert (mapped.uv == result.uv).all()
    assert cones.measure(mapped).distortion["area_mean"] == pytest.approx(result.distortion["area_mean"])
    origin, uv, triangles = result.split()
    # As trimesh has them: for each vertex.
    like = SimpleNamespace(vertices=hare.vertices[origin], faces=triangles, visual=SimpleNamespace(uv=uv))
    assert len(cones.measure(like).islands) == result.island_count
    # For vertices also where there are as many corners; and what is none is no reason to refuse a mesh.
    corners = np.random.default_rng(1).permutation(3 * hare.face_count).reshape(-1, 3)
    soup, flat = np.empty((corners.size, 3)), np.empty((corners.size, 2))
    soup[corners.ravel()], flat[corners.ravel()] = hare.vertices[hare.corners], result.uv
    like = SimpleNamespace(vertices=soup, faces=corners, visual=SimpleNamespace(uv=flat))
    assert cones.measure(like, weld=True).distortion["area_mean"] == pytest.approx(result.distortion["area_mean"])
    for other in ([], np.zeros((0, 2)), np.zeros((5, 2)), None, "x"):
        odd = SimpleNamespace(vertices=hare.vertices, faces=hare.faces, visual=SimpleNamespace(uv=other))
        assert cones.Analysis(odd).topology["faces"] == hare.face_count
    with pytest.raises(cones.Error, match="for corners, or"):
        cones.Mesh(hare.vertices, hare.faces, result.uv[:7])
    with pytest.raises(cones.Error, match="triangle_island is a number"):
        cones.pack(mapped, triangle_island=np.zeros(hare.face_count))


def test_quadrilaterals_and_polygons_keep_their_corners():
    square = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0.0]]
    table = cones.Mesh(square, [[0, 1, 4, 3], [1, 2, 5, 4]])
    mixed = cones.Mesh(square, [[0, 1, 4, 3], [1, 2, 5], [1, 5, 4]])
    assert table.faces.shape == (2, 4) and [len(f) for f in mixed.faces] == [4, 3, 3]
    assert cones.unwrap(table).uv.shape == (8, 2)
    result = cones.unwrap(mixed)
    assert result.uv.shape == (10, 2) and result.triangle_face.tolist() == [0, 0, 1, 2]


def test_a_mesh_that_is_split_along_its_seams_has_the_same_map(hare):
    result = cones.unwrap(hare, n=6)
    origin, uv, triangles = result.split()
    assert (uv[triangles] == result.uv[result.triangles]).all()
    assert (origin[triangles] == hare.corners[result.triangles]).all()
    for weld in ("auto", "always", True):
        split = cones.measure(hare.vertices[origin], triangles, uv[triangles].reshape(-1, 2), weld=weld)
        assert split.distortion["area_mean"] == pytest.approx(result.distortion["area_mean"])
        assert split.distortion["seam_length"] == pytest.approx(result.distortion["seam_length"])
    assert cones.unwrap(hare.vertices[origin], triangles, n=6).island_count == result.island_count
    with pytest.raises(cones.Error, match="weld"):
        cones.unwrap(hare, weld="sometimes")


def test_marked_seams_are_cut(hare):
    edges = np.column_stack([hare.faces[:40, 0], hare.faces[:40, 1]])
    result = cones.unwrap(hare, n=6, seams=edges)
    cut = {frozenset(edge) for edge in result.seam_edges.tolist()}
    assert all(frozenset(edge) in cut for edge in edges.tolist())
    path = cones.unwrap(result.mesh, n=6, seams=result.seam_edges)
    assert path.distortion["overlap_pairs"] == 0
    for given in (set(map(tuple, edges.tolist())), (edge for edge in edges.tolist())):
        assert cones.unwrap(hare, n=6, seams=given).seam_edges.shape == result.seam_edges.shape


def test_cones_to_measure_are_those_of_a_result_or_vertices(hare):
    result = cones.unwrap(hare, n=6)
    error = cones.measure(hare, uv=result.uv, cones=result.cones["vertex"]).distortion["curvature_error"]
    for given in (result.cones, cones.Analysis(hare).place(cones=result.cones), result.cones["vertex"].tolist()):
        assert cones.measure(hare, uv=result.uv, cones=given).distortion["curvature_error"] == error
    for given in ([-1], [10**6], [1.7]):
        with pytest.raises(cones.Error, match="vertex"):
            cones.measure(hare, uv=result.uv, cones=given)


def test_the_search_is_that_of_the_command(command, tmp_path):
    path = tmp_path / "hare.obj"
    cones.shape("hare", 9000).write(path)
    found = {search: cones.unwrap(path, n=5, search=search).cones["vertex"].tolist() for search in ("coarse", "full")}
    for search, vertices in found.items():
        command("unwrap", path, "-n", 5, "--search", search, "-o", tmp_path / "map.obj", "--report", tmp_path / "report.json")
        assert [cone["vertex"] for cone in report(tmp_path / "report.json")["cones"]] == vertices


def test_meshes_are_written_compressed(hare, tmp_path):
    hare.write(tmp_path / "hare.obj")
    hare.write(tmp_path / "hare.obj.gz")
    assert gzip.decompress((tmp_path / "hare.obj.gz").read_bytes()) == (tmp_path / "hare.obj").read_bytes()
    assert (cones.read(tmp_path / "hare.obj.gz").faces == hare.faces).all()


BROKEN = [
    (lambda v, f: (v, f[:, :2]), "face 0 has 2 corners, but a face needs at least 3"),
    (lambda v, f: (v, f + len(v)), "vertices only"),
    (lambda v, f: (np.where(v == v[3], np.nan, v), f), "which must be finite"),
    (lambda v, f: (v[:, :2], f), "vertices must have the shape (n, 3), but it has"),
    (lambda v, f: (v, f.astype(float)), "which are integers"),
    (lambda v, f: (v, -f.astype(int)), "negative"),
    (lambda v, f: (v, f[:0]), "no faces"),
    (lambda v, f: (v, f[0]), "faces must have the shape"),
    (lambda v, f: (np.ma.masked_array(v, v == v[3]), f), "are masked, where each is needed"),
]


@pytest.mark.parametrize("broken, sentence", BROKEN)
def test_what_cannot_be_a_mesh_is_refused_in_a_sentence(hare, broken, sentence):
    with pytest.raises(cones.Error) as told:
        cones.unwrap(*broken(hare.vertices, hare.faces))
    assert sentence in str(told.value).replace("they have", "it has")


def test_repairs_are_told(hare):
    doubled = cones.Mesh(np.vstack([hare.vertices, hare.vertices[:1]]), np.vstack([hare.faces, hare.faces[:2]]))
    result = cones.unwrap(doubled, n=6)
    assert [count for _, count, _ in result.repairs] == [2, 1] and cones.unwrap(hare, n=6).repairs == []
    assert result.repairs == cones.Analysis(doubled).repairs
    told = [repair["text"] for repair in result.report["repairs"]]
    assert told[0].startswith("2 copies of faces") and told[1].startswith("1 isolated vertex, left out (first vertex ")


def test_one_of_a_kind_is_told_of_in_the_singular():
    triangle = np.eye(3), [[0, 1, 2]]
    assert repr(cones.Mesh(*triangle)) == "<cones.Mesh of 3 vertices, 1 face>"
    assert repr(cones.Analysis(*triangle)) == "<cones.Analysis of 3 vertices, 1 component, genus 0>"
    assert "0 cones, 1 island," in repr(cones.unwrap(*triangle))
    assert repr(cones.topo.sublevel([0.0, 1.0])) == "<cones.topo.Pairs: 1 minimum>"
    assert repr(cones.topo.superlevel([0.0, 1.0, 0.0, 1.0])) == "<cones.topo.Pairs: 2 maxima>"


def test_wrong_options_are_refused_in_a_sentence(hare):
    wrong = [
        ({"n": 4, "max_distortion": 1.2}, "give one of"),
        ({"method": "guess"}, "method is alternating"),
        ({"n": -3}, "n is a number of cones"),
        ({"n": 2.5}, "n is a number of cones"),
        ({"n": 10**30}, "n is a number of cones, not 1000000"),
        ({"n": float("inf")}, "n is a number of cones, not inf"),
        ({"scale": "large"}, "scale is"),
        ({"quantize": 5}, "quantize is 4 or 6"),
        ({"seams": [[0, 1, 2]]}, "pairs of vertex indices"),
        ({"seams": [[0, 0]]}, "there is no edge from vertex 0 to 0"),
        ({"cones": [hare.vertex_count]}, "is not a vertex of any face"),
        ({"cones": {5: 1.0, 9: None}}, "give one for all of them, or for none"),
        ({"cones": [-3]}, "a cone is at vertex -3, which is negative"),
        ({"cones": {10**30: None}}, "beyond 32 bits"),
        ({"texture_size": 2**32}, "texture_size is a number of pixels"),
        ({"margin": 900.0}, "does not fit on a texture"),
        ({"keep_seams": True}, "texture coordinates"),
        ({"keep_seams": [(0, 10**6)]}, "edges of keep_seams name vertex 1000000, which is not there"),
        ({"quantize": 4, "free_seams": "always"}, "leave one of the two out"),
        ({"n": "4"}, "n is a number of cones, not '4'"),
        ({"cones": "c.obj"}, "not the name of a file"),
        ({"cones": [1.7]}, "a cone is at vertex 1.7, which is"),
        ({"search": "fine"}, "search is coarse or full"),
    ]
    for keywords, sentence in wrong:
        with pytest.raises(cones.Error, match=sentence):
            cones.unwrap(hare, **keywords)
    for vertices in (-5, 10**30):
        with pytest.raises(cones.Error, match=f"vertices is a number of vertices, not {vertices}"):
            cones.shape("hare", vertices)
    for vertices in (0, 4_000_001):
        with pytest.raises(cones.Error, match=f"vertices is a number from 1 to 4,000,000, not {vertices}"):
            cones.shape("hare", vertices)
    with pytest.raises(cones.Error, match="n is a number of cones, not -1"):
        cones.Analysis(hare).order(-1)
    with pytest.raises(FileNotFoundError, match="nothing.obj") as told:
        cones.read("nothing.obj")
    assert (told.value.errno, told.value.filename) == (errno.ENOENT, "nothing.obj")
    with pytest.raises(FileNotFoundError) as told:
        hare.write("nowhere/hare.obj")
    assert told.value.filename == str(Path("nowhere/hare.obj"))
    one, other = cones.Analysis(hare), cones.Analysis(hare)
    with pytest.raises(cones.Error, match="another analysis"):
        other.flatten(one.place(4))
    with pytest.raises(cones.Error, match="weld says how a mesh is made ready"):
        one.flatten(one.place(4), weld="never")
    with pytest.raises(cones.Error, match="leave one of the two out"):
        one.unwrap(4, quantize=4, free_seams="always")


def test_a_file_is_replaced_as_the_command_replaces_it(tmp_path):
    mesh = cones.shape("sphere", 100)
    path, link = tmp_path / "a.obj", tmp_path / "link.obj"
    before = os.umask(0o027)
    try:
        mesh.write(path)
        assert path.stat().st_mode & 0o777 == 0o640, "as the umask asks"
        assert os.umask(0o027) == 0o027
        path.chmod(0o604)
        link.symlink_to("a.obj")
        path.write_text("")
        mesh.write(link)
    finally:
        os.umask(before)
    assert link.is_symlink() and path.stat().st_mode & 0o777 == 0o604 and path.read_text().count("\nv ") > 90
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.obj", "link.obj"]


def test_seams_of_a_mesh_that_has_texture_coordinates_in_part_are_kept(tmp_path):
    path = tmp_path / "part.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1 3 4\n")
    mesh = cones.read(path)
    assert mesh.uv is None
    result = cones.unwrap(mesh, keep_seams=True)
    assert result.island_count == 2, "they end along the diagonal"


def test_rounded_cones_keep_the_directions_of_textures_when_they_are_flattened(hare):
    analysis = cones.Analysis(hare)
    flattened, atlas = analysis.flatten(analysis.place(8, quantize=4)), cones.Analysis(hare).unwrap(8, quantize=4)
    assert (flattened.uv == atlas.uv).all()


def test_errors_are_values_errors_and_maps_of_the_wrong_length_are_refused(hare):
    assert issubclass(cones.Error, ValueError)
    with pytest.raises(cones.Error, match="one for each of the"):
        cones.measure(hare, uv=np.zeros((7, 2)))


def test_figures_are_drawn(hare):
    pytest.importorskip("matplotlib").use("agg")
    from cones import plot

    result = cones.unwrap(hare, n=6)
    assert plot.layout(result) and plot.layout(result, colour="island", edges=True)
    assert plot.curve(cones.Analysis(hare).curve(8))
