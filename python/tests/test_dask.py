"""Many meshes with dask."""

import pytest

import cones

dask = pytest.importorskip("dask")


@pytest.fixture
def folder(tmp_path):
    """Meshes, some of them broken."""
    source = tmp_path / "in"
    (source / "deep").mkdir(parents=True)
    for k in range(12):
        cones.shape("capsule", 200 + 10 * k).write(source / ("deep" if k % 3 == 0 else "") / f"mesh{k}.obj")
    (source / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")
    (source / "empty.obj").write_text("")
    return source


def items(folder, out, **options):
    from cones import dask as many

    paths = sorted(folder.rglob("*.obj")) + [folder / "missing.obj"]
    return dask.compute(*many.unwrap(paths, out, **options), scheduler="threads")


def test_each_mesh_is_a_map_or_an_error(folder, tmp_path):
    found = items(folder, tmp_path / "out", n=4)
    errors = {item.path.rsplit("/", 1)[1]: item.error for item in found if item.error}
    assert set(errors) == {"broken.obj", "empty.obj", "missing.obj"}
    assert all("broken.obj, line 2" in errors["broken.obj"] or name != "broken.obj" for name in errors)
    for item in found:
        if not item.error:
            expected = cones.unwrap(item.path, n=4)
            assert (cones.read(item.output).uv == expected.uv).all()
            assert (item.cones, item.islands) == (4, expected.island_count)


def test_a_run_goes_on_where_it_was(folder, tmp_path):
    out = tmp_path / "out"
    first = items(folder, out, n=4)
    again = items(folder, out, n=4)
    assert not any(item.was_done for item in first)
    assert all(item.was_done for item in again if not item.error) and sum(item.was_done for item in again) == 12
    # Another option, another input, a result that has gone: these are done again.
    assert not any(item.was_done for item in items(folder, out, n=5))
    cones.shape("sphere", 300).write(folder / "mesh1.obj")
    (out / "mesh2.obj").unlink()
    third = {item.path.rsplit("/", 1)[1]: item.was_done for item in items(folder, out, n=5)}
    assert not third["mesh1.obj"] and not third["mesh2.obj"] and third["mesh4.obj"]


def test_no_line_about_another_output_is_believed(folder, tmp_path):
    out = tmp_path / "out"
    items(folder, out, n=4)
    lines = sorted(out.rglob("*.json"))
    before = {line: line.read_bytes() for line in lines}
    items(folder, out, n=5)
    # As if the second run had ended between an output and the line about it, which is gone by then.
    lines[0].unlink()
    lines[1].write_text("[]")
    lines[2].write_text("null")
    found = {f"{item.output}.json": item for item in items(folder, out, n=5) if not item.error}
    assert [found[str(line)].was_done for line in lines[:4]] == [False, False, False, True]
    assert all(item.cones == 5 for item in found.values())
    assert all(line.read_bytes() != text for line, text in before.items())


def test_an_output_that_is_replaced_has_no_line_while_it_is(folder, tmp_path, monkeypatch):
    from cones import dask as many

    source, output = folder / "mesh1.obj", tmp_path / "mesh1.obj"
    many._item(str(source), str(output), True, {"n": 4})
    line = tmp_path / "mesh1.obj.json"
    assert line.exists()
    there = []
    monkeypatch.setattr(cones.Unwrapping, "write", lambda self, path: there.append(line.exists()))
    many._item(str(source), str(output), True, {"n": 5})
    assert there == [False]


def test_a_gltf_depends_on_its_buffers(tmp_path):
    from cones import dask as many

    path = tmp_path / "a.gltf"
    path.write_text('{"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:;base64,AA=="}, {}, {"uri": "none.bin"}]}')
    (tmp_path / "a b.bin").write_bytes(b"1")
    first = many._key(str(path), {})
    (tmp_path / "a b.bin").write_bytes(b"2")
    assert many._key(str(path), {}) != first
    for text in ["{", "[]", '{"buffers": 1}', '{"buffers": [1]}', '{"buffers": [{"uri": 1}]}']:
        path.write_text(text)
        many._key(str(path), {})


def test_options_of_any_kind_make_a_key(tmp_path):
    import numpy as np

    from cones import dask as many

    path = tmp_path / "a.obj"
    path.write_text("")
    keys = [many._key(str(path), {"cones": given}) for given in ({np.int64(3): 1.0}, {3: 1.0}, {3: 2.0}, np.array([3]), [3], None)]
    assert keys[0] == keys[1] and keys[3] == keys[4] and len(set(keys)) == 4


def test_outputs_that_would_collide_are_refused(folder, tmp_path):
    from cones import dask as many

    with pytest.raises(cones.Error, match="would both be written"):
        many.unwrap([folder / "a.obj", folder / "a.ply"], tmp_path)
    with pytest.raises(cones.Error, match="not as '.stl'"):
        many.unwrap([folder / "a.obj"], tmp_path, ending=".stl")
    assert many.unwrap([], tmp_path) == []
    with pytest.raises(cones.Error, match="a list of files, not one: give"):
        many.unwrap(str(folder / "mesh1.obj"), tmp_path)


def test_no_input_is_overwritten(folder, tmp_path):
    from cones import dask as many

    (tmp_path / "link").symlink_to(folder)
    for target in (folder, tmp_path / "link"):
        with pytest.raises(cones.Error, match="mesh1.obj is an input, which is never overwritten"):
            many.unwrap([folder / "mesh1.obj", folder / "mesh2.obj"], target)
    assert len(many.unwrap([folder / "mesh1.obj"], folder, ending=".ply")) == 1


def test_workers_that_are_killed_lose_nothing(folder, tmp_path):
    distributed = pytest.importorskip("distributed")
    import os
    import signal

    from cones import dask as many

    paths = sorted(folder.rglob("mesh*.obj"))
    with dask.config.set({"distributed.scheduler.allowed-failures": 10}):
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client:
                futures = client.compute(many.unwrap(paths, tmp_path / "out", n=5))
                distributed.wait(futures, return_when="FIRST_COMPLETED")
                victim = next(iter(client.run(os.getpid).values()))
                os.kill(victim, signal.SIGKILL)
                found = client.gather(futures)
    assert [item.error for item in found] == [None] * 12
    assert all((cones.read(item.output).uv == cones.unwrap(item.path, n=5).uv).all() for item in found)
