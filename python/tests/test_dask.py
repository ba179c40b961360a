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
