"""Persistence from Python: the pairs of other programs, of other ways to ask, and laws."""

import numpy as np
import pytest

import cones
from cones import topo

RANDOM = np.random.default_rng(20)


def arrays(count):
    """Random arrays that hurt: one to three axes, many ties, plateaus, smooth ones, several kinds of numbers."""
    rng = np.random.default_rng(7)
    for k in range(count):
        shape = tuple(rng.integers(1, (200, 24, 9)[k % 3], size=k % 3 + 1))
        field = rng.random(shape)
        if k % 4 == 1:
            field = rng.integers(0, 5, size=shape).astype((np.uint8, np.int16, np.int64, np.float32)[k // 4 % 4])
        if k % 4 == 2:
            field = np.cumsum(field - 0.5, axis=-1).astype(np.float32)
        if k % 4 == 3:
            field = (1000 * field - 500).astype(np.int32)
        yield field


def points(pairs):
    return sorted(map(tuple, pairs.diagram().tolist()))


def test_pairs_are_those_of_gudhi_on_two_hundred_arrays():
    gudhi = pytest.importorskip("gudhi")
    for field in arrays(200):
        doubles = field.astype(np.float64)
        for connectivity, cells in (("axis", {"vertices": doubles}), ("full", {"top_dimensional_cells": doubles})):
            complex_ = gudhi.CubicalComplex(**cells)
            complex_.compute_persistence(homology_coeff_field=2, min_persistence=0)
            expected = sorted(map(tuple, complex_.persistence_intervals_in_dimension(0).tolist()))
            assert points(topo.sublevel(field, connectivity=connectivity)) == expected
            # Maxima are the minima of what is turned upside down.
            complex_ = gudhi.CubicalComplex(**{key: -cell for key, cell in cells.items()})
            complex_.compute_persistence(homology_coeff_field=2, min_persistence=0)
            expected = sorted((-birth, -death) for birth, death in complex_.persistence_intervals_in_dimension(0).tolist())
            assert points(topo.superlevel(field, connectivity=connectivity)) == expected


def test_pairs_and_extrema_are_those_of_cripser_on_two_hundred_arrays():
    cripser = pytest.importorskip("cripser")
    tcripser = pytest.importorskip("tcripser")
    for field in arrays(200):
        # On pictures one pixel wide cripser lets no component die: it gets them as series.
        doubles = np.atleast_1d(np.ascontiguousarray(field, dtype=np.float64).squeeze())
        for connectivity, program in (("axis", cripser), ("full", tcripser)):
            found = program.computePH(doubles, maxdim=0)
            found = found[found[:, 0] == 0]
            births, deaths = found[:, 1], np.where(found[:, 2] > 1e300, np.inf, found[:, 2])
            lives = births != deaths
            assert points(topo.sublevel(field, connectivity=connectivity)) == sorted(zip(births[lives], deaths[lives]))
            if len(np.unique(doubles)) == doubles.size:
                # Without ties there is one answer to where components are born and merge.
                places = found[lives & np.isfinite(deaths)].astype(int)
                born, merged = (
                    np.ravel_multi_index(tuple(places[:, first : first + doubles.ndim].T), doubles.shape) for first in (3, 6)
                )
                ours = topo.sublevel(field, connectivity=connectivity).array
                ours = ours[ours["saddle"] >= 0]
                assert sorted(zip(ours["extremum"].tolist(), ours["saddle"].tolist())) == sorted(zip(born.tolist(), merged.tolist()))


def test_holes_are_those_of_gudhi():
    gudhi = pytest.importorskip("gudhi")
    for field in arrays(60):
        if field.ndim == 1:
            continue
        complex_ = gudhi.CubicalComplex(top_dimensional_cells=field.astype(np.float64))
        complex_.compute_persistence(homology_coeff_field=2, min_persistence=0)
        expected = sorted(map(tuple, complex_.persistence_intervals_in_dimension(field.ndim - 1).tolist()))
        found = topo.holes(field, connectivity="full")
        assert sorted(zip(found["birth"].astype(float), found["death"].astype(float))) == expected


def test_holes_round_what_is_masked_are_never_filled():
    ring = np.full((5, 5), 9)
    ring[1:4, 1:4] = 1
    ring[2, 2] = 7
    assert topo.holes(ring).tolist() == [(18, 12, 1, 7)]
    for given in ({"field": ring, "mask": ring != 7}, {"field": np.ma.masked_equal(ring, 7)}, {"field": np.where(ring == 7, np.nan, ring), "nan": "mask"}):
        assert topo.holes(**given).tolist() == [(18, -1, 1.0, np.inf)]
        turned = {name: -value if name == "field" else value for name, value in given.items()}
        assert topo.holes(**turned, kind="maximum")[["filled", "death"]].tolist() == [(-1, -np.inf)]


def test_holes_of_what_has_nothing_left_out_are_in_its_own_kind():
    ring = np.full((3, 3), 5) + 2**60
    ring[1, 1] += 4
    for given in ({}, {"nan": "mask"}, {"nan": "mask", "kind": "minimum"}):
        found = topo.holes(ring, **given)
        assert found.dtype["birth"] == ring.dtype and found.tolist() == [(8, 4, 2**60 + 5, 2**60 + 9)]


def test_what_dies_where_a_field_is_infinite_is_no_essential_class():
    pairs = topo.sublevel(np.array([0.0, 5.0, np.inf, 4.0, 1.0, 7.0]))
    diagram = topo.Diagram(pairs)
    assert (diagram.finite.tolist(), diagram.essential.tolist()) == ([[1.0, np.inf]], [0.0])
    assert topo.bottleneck(pairs, topo.sublevel(np.array([0.0, 5.0]))) == np.inf


def test_distances_are_those_of_hera():
    # GUDHI's other one, `gudhi.bottleneck_distance`, is wrong on some diagrams with essential classes (3.13: the eighth pair here).
    hera = pytest.importorskip("gudhi.hera")
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b = (topo.sublevel(rng.random(rng.integers(3, 60))) for _ in range(2))
        assert topo.bottleneck(a, b) == pytest.approx(hera.bottleneck_distance(a.diagram(), b.diagram(), 0.0), abs=1e-12)
        finite = [points[np.isfinite(points[:, 1])] for points in (a.diagram(), b.diagram())]
        expected = hera.wasserstein_distance(*finite, order=2.0, internal_p=np.inf, delta=1e-6)
        assert topo.wasserstein(*finite) == pytest.approx(expected, rel=1e-5)
        matched = topo.matching(a, b)
        assert matched.distance == topo.wasserstein(a, b)
        assert len(matched.essential) == 1 and set(matched.finite[:, 0]) - {-1} == set(range(len(a) - 1))
    assert topo.bottleneck([[0.0, np.inf]], [[0.5, np.inf]]) == 0.5
    assert topo.bottleneck([[0.0, np.inf]], []) == np.inf


KINDS = ["u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", "f2", "f4", "f8", ">f8", ">i4", "b1"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_numbers_gives_the_same_pairs_in_its_own_kind(kind):
    # Without ties but where there are two values only.
    field = RANDOM.permutation(120).reshape(10, 12)
    typed = (field % 2).astype(kind) if kind == "b1" else field.astype(kind)
    found, expected = (topo.persistence(values, connectivity="full") for values in (typed, typed.astype(np.float64)))
    for name in ("extremum", "saddle", "birth", "death", "persistence"):
        for one, other in ((found.minima, expected.minima), (found.maxima, expected.maxima)):
            assert (one.array[name] == other.array[name]).all()
    assert found.minima.array["birth"].dtype == np.dtype(kind).newbyteorder("=")
    tree = topo.merge_tree(typed)
    assert tree.nodes()["value"].dtype.kind == np.dtype(kind).kind
    assert topo.simplify(typed, threshold=3).dtype == typed.dtype
    assert (tree.segmentation(2.5).labels == topo.segmentation(typed, threshold=2.5).labels).all()


def test_large_integers_are_exact():
    field = np.array([0, 2**64 - 1, 2**64 - 3, 2**64 - 2, 1], dtype=np.uint64)
    table = topo.superlevel(field).ranked()
    assert table["birth"].tolist() == [2**64 - 1, 2**64 - 2] and table["death"].tolist() == [0, 2**64 - 3]


def test_a_mask_leaves_vertices_out():
    field = RANDOM.random((30, 40))
    mask = RANDOM.random((30, 40)) < 0.8
    holed = np.where(mask, field, np.nan)
    expected = topo.sublevel(holed, nan="mask").array
    assert (topo.sublevel(field, mask=mask).array == expected).all()
    integers = (field * 1e6).astype(np.int32)
    found = topo.sublevel(integers, mask=mask)
    assert found.array["birth"].dtype == np.int32
    assert (found.array["birth"] == integers.ravel()[found.array["extremum"]]).all()
    assert mask.ravel()[found.array["extremum"]].all()
    simple = topo.simplify(integers, threshold=1e5, mask=mask)
    assert (simple[~mask] == integers[~mask]).all() and abs(simple - integers).max() <= 1e5
    assert (topo.segmentation(field, mask=mask).labels[~mask] == -1).all()
    with pytest.raises(cones.Error, match="is NaN; replace it, or mask"):
        topo.sublevel(holed)


def test_masked_arrays_are_taken_with_their_mask():
    field = RANDOM.random((30, 40))
    field.flat[77] = np.inf
    holed, mask = (RANDOM.random((30, 40)) < 0.8 for _ in range(2))
    hidden = np.ma.masked_array(field, ~holed)
    for given, inside in [(hidden, None), (np.ma.masked_array((field[:, ::-1] < 0.5), ~holed), None), (hidden, mask)]:
        expected = topo.superlevel(given.data, mask=holed if inside is None else holed & inside)
        assert (topo.superlevel(given, mask=inside).array == expected.array).all()
    assert (topo.simplify(hidden, threshold=0.1) == topo.simplify(field, threshold=0.1, mask=holed)).all()
    assert (topo.segmentation(hidden).labels[~holed] == -1).all()
    # Integers that are no floats need no cell to be left out.
    large = np.ma.masked_array(np.array([2**63, 2**63 - 1, 2**63 + 5], dtype=np.uint64))
    assert topo.superlevel(large).array["birth"].max() == 2**63 + 5
    # Nor are those that are left out: a fill value may be what nobody can compare.
    filled = np.arange(6)
    filled[2] = np.iinfo(np.int64).min
    found = topo.sublevel(np.ma.masked_equal(filled, filled[2]))
    assert found.array["extremum"].tolist() == [0, 3]
    with pytest.raises(cones.Error, match="beyond 2\\*\\*53 cannot be masked"):
        topo.sublevel(filled, mask=np.arange(6) != 4)
    with pytest.raises(cones.Error, match="1 value of an array is masked"):
        topo.single_linkage(3, [[0, 1], [1, 2]], np.ma.masked_array([1.0, 2.0], [False, True]))


def test_simplify_changes_nothing_that_is_no_number_or_outside():
    field = np.array([0.0, 5.0, np.nan, 3.0, np.inf, -np.inf, 4.0, 3.5, 7.0], dtype=np.float32)
    mask = np.array([True] * 8 + [False])
    expected = np.array([0.0, 5.0, np.nan, 3.0, np.inf, -np.inf, 4.0, 4.0, 7.0], dtype=np.float32)
    assert np.array_equal(topo.simplify(field, threshold=0.5, mask=mask, nan="mask"), expected, equal_nan=True)
    networkx = pytest.importorskip("networkx")
    path = networkx.path_graph(4)
    networkx.set_node_attributes(path, dict(enumerate([0, 3, 2, 9])), "height")
    for given in ("height", {0: 0, 1: 3, 2: 2, 3: 9}):
        assert topo.simplify(given, path, threshold=1, mask=[True, True, True, False]).tolist() == [0, 3, 3, 9]


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.int64, np.uint64])
def test_components_take_any_level(kind):
    field = np.array([0, 7, 255 if kind == np.uint8 else np.iinfo(kind).max, 3, 4], dtype=kind)
    for name, is_in in [("maximum", lambda level: [v >= level for v in field.tolist()]), ("minimum", lambda level: [v <= level for v in field.tolist()])]:
        tree = topo.merge_tree(field, kind=name)
        for level in (3, 3.5, np.float32(3.5), -1, -0.5, 300, 2.0**64, 10**30, np.inf, -np.inf, np.int64(4)):
            table, components = tree.components(level)
            assert (components.labels >= 0).tolist() == is_in(level.item() if isinstance(level, np.generic) else level), (name, level)
            assert table["size"].sum() == (components.labels >= 0).sum() and len(components.extrema) == len(table)
        with pytest.raises(cones.Error, match="not NaN"):
            tree.components(float("nan"))


def test_graphs_of_all_kinds_have_the_same_pairs():
    scipy = pytest.importorskip("scipy.sparse")
    networkx = pytest.importorskip("networkx")
    graph = networkx.gnm_random_graph(80, 140, seed=4)
    field = RANDOM.random(80)
    edges = np.array(graph.edges())
    expected = topo.persistence(field, topo.Graph(80, edges))
    matrix = scipy.coo_matrix((np.ones(len(edges)), tuple(edges.T)), shape=(80, 80))
    named = networkx.relabel_nodes(graph, {k: f"station {k}" for k in graph})
    networkx.set_node_attributes(named, {f"station {k}": field[k] for k in graph}, "height")
    for domain, values in [
        (matrix, field),
        (matrix.tocsr(), field),
        (graph, field),
        (graph, dict(enumerate(field))),
        (named, "height"),
    ]:
        found = topo.persistence(values, domain)
        assert (found.minima.array == expected.minima.array).all() and (found.maxima.array == expected.maxima.array).all()
    assert topo.superlevel("height", named).names[0] == "station 0"
    with pytest.raises(cones.Error, match="directed"):
        topo.sublevel(field, graph.to_directed())
    with pytest.raises(cones.Error, match="names vertex 80, but there are only 80"):
        topo.Graph(80, [[0, 80]])
    with pytest.raises(cones.Error, match="names vertex"):
        topo.Graph(80, [[0, -1]])


def test_a_mesh_has_the_pairs_of_its_edges(hare):
    faces = hare.faces.astype(np.int64)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    phi = cones.Analysis(hare).conformal_factor()
    on_mesh = topo.persistence(phi, topo.TriangleMesh(hare.vertex_count, faces))
    on_graph = topo.persistence(phi, topo.Graph(hare.vertex_count, edges))
    assert (on_mesh.minima.array == on_graph.minima.array).all()
    assert (on_mesh.maxima.array == on_graph.maxima.array).all()


def test_a_grid_has_the_pairs_of_its_graph():
    field = RANDOM.integers(0, 9, (7, 8))
    index = np.arange(56).reshape(7, 8)
    edges = np.concatenate(
        [np.stack([index[:, :-1], index[:, 1:]], -1).reshape(-1, 2), np.stack([index[:-1], index[1:]], -1).reshape(-1, 2)]
    )
    assert (topo.sublevel(field).array == topo.sublevel(field.ravel(), topo.Graph(56, edges)).array).all()
    round_x = np.concatenate([edges, np.stack([index[:, 0], index[:, -1]], -1)])
    periodic = topo.sublevel(field, periodic=[False, True])
    assert (periodic.array == topo.sublevel(field.ravel(), topo.Graph(56, round_x)).array).all()


def test_tables_are_ranked_selected_and_taken_by_pandas():
    field = RANDOM.random((20, 20))
    pairs = topo.superlevel(field)
    ranked = pairs.ranked()
    assert (np.diff(ranked["persistence"]) <= 0).all() and ranked["saddle"][0] == -1
    assert (pairs.top(5) == ranked[:5]).all()
    assert (pairs.above(0.3)["persistence"] > 0.3).all() and len(pairs.above(0.3)) == (ranked["persistence"] > 0.3).sum()
    assert (abs(ranked["birth"] - ranked["death"]) == ranked["persistence"]).all()
    pandas = pytest.importorskip("pandas")
    assert (pandas.DataFrame(ranked)["persistence"].to_numpy() == ranked["persistence"]).all()
    assert (pairs.to_pandas().columns == list(ranked.dtype.names)).all()
    assert pairs.gudhi()[0] == (0, (field.max(), -np.inf)) and len(pairs.gudhi()) == len(pairs)
    assert (pairs.positions(ranked["extremum"])[0] == np.unravel_index(field.argmax(), field.shape)).all()
    both = topo.persistence(field).extrema()
    assert both["persistence"][0] == both["persistence"][1] == field.max() - field.min()


def test_trees_segments_and_simplified_fields_agree():
    field = RANDOM.random((30, 30))
    tree = topo.merge_tree(field, kind="minimum")
    nodes = tree.nodes()
    assert tree.leaf_count == len(topo.sublevel(field, keep_zeros=True))
    inner = nodes["parent"] >= 0
    assert (nodes["value"][inner] <= nodes["value"][nodes["parent"][inner]]).all()
    branches = tree.branches()
    assert branches["size"][branches["saddle"] < 0].tolist() == [900]
    assert (tree.sums(np.ones(900)) == branches["size"]).all()
    simple = tree.simplify(0.2)
    assert len(topo.sublevel(simple.field())) == simple.leaf_count == len(topo.segmentation(field, kind="minimum", threshold=0.2).extrema)
    table, components = tree.components(0.4)
    assert (components.sizes() == table["size"]).all() and table["size"].sum() == (field <= 0.4).sum()
    assert ((components.labels >= 0) == (field <= 0.4)).all()
    smooth = topo.simplify(field, threshold=0.2)
    assert abs(smooth - field).max() <= 0.2
    assert (topo.persistence(smooth).minima.array["persistence"] > 0.2).all()
    far = topo.isolation(field, topo.superlevel(field).ranked()["extremum"][:3])
    assert far[0] == np.inf and np.isfinite(far[1:]).all()


def test_single_linkage_is_that_of_scipy():
    hierarchy = pytest.importorskip("scipy.cluster.hierarchy")
    from scipy.spatial.distance import pdist

    places = RANDOM.random((25, 2))
    weights = pdist(places)
    edges = np.column_stack(np.triu_indices(25, 1))
    linkage = topo.single_linkage(25, edges, weights)
    theirs = hierarchy.linkage(places, "single")
    assert np.allclose(linkage.links[:, 2], theirs[:, 2])
    labels, expected = linkage.clusters(4), hierarchy.fcluster(theirs, 4, "maxclust")
    assert len({(a, b) for a, b in zip(labels, expected)}) == 4


def test_what_is_no_table_of_edges_is_refused():
    for wrong in ([[0.9, 1.9], [1.9, 2.9]], [[0, 1, 2, 3], [1, 2, 3, 4]], [[0, 1, 1.5]], [0, 1], np.array([[0, 2**64 - 1]], np.uint64)):
        for build in (lambda: topo.Graph(5, wrong), lambda: topo.single_linkage(5, wrong, np.ones(len(wrong)))):
            with pytest.raises(cones.Error, match="edge"):
                build()
    for wrong in (3.7, "3", -1):
        with pytest.raises(cones.Error, match="vertices is a number of vertices"):
            topo.Graph(wrong, [])
    assert topo.TriangleMesh(3, []).vertex_count == 3
    with pytest.raises(cones.Error, match="n is a number of pairs, not -1"):
        topo.sublevel([1.0, 2.0]).top(-1)


def test_a_diagram_of_maxima_is_compared_with_an_empty_one():
    maxima, none = [[7.0, 2.0], [5.0, 4.0]], np.empty((0, 2))
    assert topo.bottleneck(maxima, none) == topo.bottleneck(none, maxima) == 2.5
    assert topo.wasserstein(maxima, [[3.0, 3.0]], order=1.0) == 3.0
    assert topo.matching(maxima, none).distance > 0
    with pytest.raises(cones.Error, match="one diagram is of minima"):
        topo.bottleneck(maxima, [[0.0, 1.0]])


def test_compressed_rows_are_the_graph_of_their_edges():
    sparse = pytest.importorskip("scipy.sparse")
    matrix = sparse.random(60, 60, 0.05, "csr", random_state=3)
    field = RANDOM.random(60)
    entries = matrix.tocoo()
    expected = topo.persistence(field, topo.Graph(60, np.column_stack([entries.row, entries.col])))
    both = (matrix + matrix.T).tocsr()
    for graph in [
        topo.Graph.from_rows(matrix.indptr, matrix.indices),
        topo.Graph.from_rows(matrix.indptr.astype("u8"), matrix.indices.astype("i8")),
        topo.Graph.from_rows(list(both.indptr), list(both.indices)),
        matrix.tocsc(),
        both,
    ]:
        found = topo.persistence(field, graph)
        assert (found.minima.array == expected.minima.array).all() and (found.maxima.array == expected.maxima.array).all()
    assert topo.Graph.from_rows([0], []).vertex_count == 0
    for starts, indices, sentence in [
        ([0, 2], [0], "do not rise"),
        ([1, 1], [0], "do not rise"),
        ([0, 2, 1, 3], [0, 1, 2], "do not rise"),
        ([], [], "two lists"),
        ([0, 1], [7], "vertex 7"),
        ([0, 1], [-1], "vertex"),
        ([0, 1], [0.5], "integers"),
    ]:
        with pytest.raises(cones.Error, match=sentence):
            topo.Graph.from_rows(starts, indices)


def test_tomato_has_as_many_clusters_as_are_wanted():
    spatial = pytest.importorskip("scipy.spatial")
    centres = np.array([[0, 0], [4, 0], [0, 4]])
    places = np.concatenate([RANDOM.normal(centre, 0.5, (60, 2)) for centre in centres])
    distances, near = spatial.cKDTree(places).query(places, 9)
    density = 1 / distances[:, 1:].mean(axis=1)
    graph = topo.Graph.from_rows(np.arange(181) * 8, near[:, 1:].reshape(-1))
    clusters = topo.tomato(density, graph, count=3)
    assert (clusters.labels.reshape(3, 60) == clusters.labels[::60, None]).all() and set(clusters.labels) == {0, 1, 2}
    ranked = topo.superlevel(density, graph).ranked()["persistence"]
    again = topo.tomato(density, graph, prominence=ranked[3])
    assert (again.labels == clusters.labels).all() and (again.extrema == clusters.extrema).all()
    assert (topo.merge_tree(density, graph).clusters(3).labels == clusters.labels).all()
    assert len(topo.tomato(density, graph, count=10**6).extrema) == topo.merge_tree(density, graph).leaf_count
    for choice in [{}, {"count": 2, "prominence": 1.0}, {"count": -1}]:
        with pytest.raises(cones.Error, match="clusters"):
            topo.tomato(density, graph, **choice)


def test_vectors_of_diagrams_have_their_shapes():
    diagram = topo.Diagram(topo.sublevel(RANDOM.random(100)))
    assert diagram.landscape(np.linspace(0, 1, 11), 3).shape == (3, 11)
    assert diagram.silhouette(np.linspace(0, 1, 11)).shape == (11,)
    assert diagram.image((0, 1), (0, 1), (4, 6), 0.1).shape == (4, 6)
    assert diagram.betti_curve().shape[1] == 2 and diagram.entropy() > 0
    assert diagram.landscape(0.5).shape == (5, 1) and diagram.silhouette(0.5).shape == (1,)
    for ask, sentence in [
        (lambda: diagram.landscape([0.5], 10**12), "ask for fewer"),
        (lambda: diagram.landscape([0.5], 1.5), "count is a number of functions"),
        (lambda: diagram.silhouette([0.5], -1), "power is a number of 0 at least"),
        (lambda: diagram.image((np.nan, 1), (0, 1), (2, 2), 0.1), "births is a range of finite numbers"),
    ]:
        with pytest.raises(cones.Error, match=sentence):
            ask()
    for shape, bandwidth, sentence in [((10**6, 10**6), 0.1, "a smaller shape"), ((4, 6), 0, "above 0, not 0"), ((4, -6), 1, "shape is a number of rows")]:
        with pytest.raises(cones.Error, match=sentence):
            diagram.image((0, 1), (0, 1), shape, bandwidth)
    pytest.importorskip("matplotlib").use("agg")
    from cones.topo import plot

    pairs = topo.superlevel(RANDOM.random((9, 9)))
    assert plot.diagram(pairs) and plot.barcode(pairs)
    assert plot.merge_tree(topo.merge_tree(RANDOM.random((9, 9))))


def test_what_is_no_field_is_refused_in_a_sentence():
    wrong = [
        (lambda: topo.sublevel(np.zeros((2, 2, 2, 2))), "one to three axes"),
        (lambda: topo.superlevel("a.npy"), "an array of numbers, not the name of a file"),
        (lambda: topo.sublevel(np.array(["a"])), "integers or floats"),
        (lambda: topo.sublevel(np.array([1j])), "integers or floats"),
        (lambda: topo.sublevel(np.zeros(3), connectivity="round"), "connectivity is"),
        (lambda: topo.sublevel(np.zeros(3), connectivity=8), "connectivity is"),
        (lambda: topo.sublevel(np.ma.array([1.0, np.nan, 2.0], mask=[0, 0, 1])), "1 values that are not masked are NaN"),
        (lambda: topo.single_linkage(3, [[0, 1]], [1.0]).at(np.nan), "weight is a number"),
        (lambda: topo.single_linkage(3, [[0, 1]], [1.0]).clusters(1.5), "count is a number of clusters"),
        (lambda: topo.sublevel(np.zeros(3), topo.Graph(4, [[0, 1]])), "has 3 values for 4 vertices"),
        (lambda: topo.segmentation(np.zeros(3), threshold=-1), "must be 0 at least"),
        (lambda: topo.segmentation(np.zeros(3), threshold=float("nan")), "must be 0 at least"),
        (lambda: topo.holes(np.zeros(3)), "two or three axes"),
        (lambda: topo.merge_tree(np.zeros(3), kind="saddle"), "minimum or maximum"),
        (lambda: topo.isolation(np.zeros(3), [7]), "extrema name vertex 7, which is not there: there are 3"),
        (lambda: topo.isolation(np.zeros(3), -1), "extrema name vertex -1"),
        (lambda: topo.isolation(np.zeros(3), [1.5]), "extrema are vertices, which are integers, not float64"),
        *(
            (lambda periodic=periodic: topo.sublevel(np.zeros((3, 3)), periodic=periodic), "one of them for each axis, 2 here; it is")
            for periodic in ("x", "no", (0, 1), {0: True}, (2, 3), 1, [True], None)
        ),
        (lambda: topo.bottleneck([[0, 1], [1, 0]], []), "die above their birth"),
        (lambda: topo.single_linkage(3, [[0, 1]], [1.0, 2.0]), "is 1 edge but 2 weights"),
        (lambda: topo.single_linkage(3, [[0, 1]], [[1.0]]), "one number for each edge"),
    ]
    for ask, sentence in wrong:
        with pytest.raises(cones.Error, match=sentence):
            ask()
    assert len(topo.sublevel([1, 2, 3], topo.Graph(3, []))) == 3
    assert len(topo.sublevel(np.zeros(0))) == 0 and len(topo.sublevel(np.zeros((0, 3)))) == 0
