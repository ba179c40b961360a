"""Chunked fields have the pairs of the field in one piece."""

import itertools

import numpy as np
import pytest

import cones
from cones import topo

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")

from cones import dask as many  # noqa: E402


def chunks(rng, length):
    cuts = np.unique(rng.integers(0, length + 1, rng.integers(0, 4)))
    return tuple(np.diff([0, *[c for c in cuts if 0 < c < length], length]).tolist())


def same(found, expected):
    assert (found.array == expected.array).all() and found.array.dtype == expected.array.dtype
    assert (found.ranked() == expected.ranked()).all()
    assert (found.top(3) == expected.top(3)).all()
    assert found.zero_count == expected.zero_count and found.shape == expected.shape
    assert sorted(map(tuple, found.diagram())) == sorted(map(tuple, expected.diagram()))


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_random_fields_in_random_chunks(axes):
    rng = np.random.default_rng(axes)
    for k in range(24):
        shape = tuple(rng.integers(1, (300, 40, 14)[axes - 1], axes))
        # Many ties in every second, NaN in every third, and several kinds of numbers.
        field = rng.integers(0, 6, shape).astype((np.int8, np.uint16, np.int32, np.float32)[k // 2 % 4]) if k % 2 else rng.random(shape)
        options = {"connectivity": ("axis", "full", "freudenthal")[k % 3], "keep_zeros": k % 5 == 0}
        if k % 3 == 0 and field.dtype.kind == "f":
            field[rng.random(shape) < 0.1] = np.nan
            options["nan"] = "mask"
        if k % 4 == 0:
            options["periodic"] = [bool(b) for b in rng.integers(0, 2, axes)]
        chunked = da.from_array(field, chunks=tuple(chunks(rng, length) for length in shape))
        found = many.persistence(chunked, **options)
        expected = topo.persistence(field, **options)
        same(found.minima, expected.minima)
        same(found.maxima, expected.maxima)


@pytest.mark.parametrize("kind", [np.float32, np.int32, np.uint8, ">f4", ">f8"])
def test_masked_arrays_in_chunks_are_taken_with_their_mask(kind):
    rng = np.random.default_rng(4)
    field = np.ma.masked_array((100 * rng.random((40, 50))).astype(kind), rng.random((40, 50)) < 0.3)
    # Chunks without a masked cell, and some without any other.
    field.mask[:20, :20], field.mask[20:, :10] = False, True
    chunked = da.from_array(field, chunks=(13, 10))
    same(many.superlevel(chunked, periodic=[False, True]), topo.superlevel(field, periodic=[False, True]))
    unsaid = da.from_array(field.data, chunks=(13, 10)).map_blocks(lambda chunk: np.ma.masked_array(chunk, chunk > 50), meta=np.empty((0, 0), kind))
    with pytest.raises(cones.Error, match="give it a meta that is one"):
        many.superlevel(unsaid)


def test_summaries_join_in_any_order():
    rng = np.random.default_rng(9)
    field = rng.integers(0, 9, (30, 30)).astype(np.float64)
    from cones.topo import _blocks as blocks

    ends = [0, 11, 19, 30]
    for _ in range(5):
        parts, tables, zeros = [], [], 0
        for i, j in itertools.product(range(3), repeat=2):
            start, stop = (ends[i], ends[j]), (ends[i + 1], ends[j + 1])
            ((y0, y1),), ((x0, x1),) = blocks.reach(start, stop, field.shape, (False, False))
            parts.append(blocks.summarise(field[y0:y1, x0:x1], start, stop, field.shape, superlevel=True))
        tables, zeros = [part.table for part in parts], sum(part.zero_count for part in parts)
        with pytest.raises(cones.Error, match="have not been joined"):
            blocks.collect(parts[0], tables, zeros, superlevel=True, shape=field.shape)
        while len(parts) > 1:
            k, m = sorted(rng.choice(len(parts), 2, replace=False))
            joined = blocks.join(parts.pop(m), parts.pop(k))
            parts.append(joined)
            tables.append(joined.table)
            zeros += joined.zero_count
        same(blocks.collect(parts[0], tables, zeros, superlevel=True, shape=field.shape), topo.superlevel(field))


def test_other_arrays_are_taken_and_what_is_none_is_refused(tmp_path):
    field = np.random.default_rng(2).random((50, 60))
    expected = topo.sublevel(field)
    same(many.sublevel(field), expected)
    same(many.sublevel(da.from_array(field, chunks=17)[::1]), expected)
    assert len(many.superlevel(np.zeros((0, 3)))) == 0
    try:
        import zarr
    except ImportError:
        pass
    else:
        stored = zarr.open(str(tmp_path / "field.zarr"), mode="w", shape=field.shape, chunks=(20, 20), dtype="f8")
        stored[:] = field
        same(many.sublevel(da.from_zarr(stored)), expected)
        same(many.sublevel(stored), expected)
    try:
        import xarray
    except ImportError:
        pass
    else:
        same(many.sublevel(xarray.DataArray(field).chunk(25)), expected)
    for wrong, sentence in [
        (lambda: many.sublevel(np.zeros((2, 2, 2, 2))), "one to three axes"),
        (lambda: many.sublevel(field, nan="drop"), "nan is"),
        (lambda: many.sublevel(field, periodic=[True]), "for each axis"),
        (lambda: many.sublevel(field, periodic="no"), "for each axis, 2 here; it is 'no'"),
        (lambda: many.sublevel(da.from_array(np.where(field > 0.5, field, np.nan), chunks=20)), "is NaN"),
    ]:
        with pytest.raises(cones.Error, match=sentence):
            wrong()


def test_little_moves_between_workers_and_killed_ones_lose_nothing():
    distributed = pytest.importorskip("distributed")
    import os
    import signal

    def smooth(block_info=None):
        (y0, y1), (x0, x1) = block_info[None]["array-location"]
        y, x = np.mgrid[y0:y1, x0:x1].astype(np.float64)
        return np.sin(x / 31) + np.cos(y / 27) + 0.3 * np.sin((x + 2 * y) / 11)

    array = da.map_blocks(smooth, chunks=((512,) * 4, (512,) * 4), dtype=np.float64)
    whole = array.compute(scheduler="threads")
    expected = topo.persistence(whole)
    # Left to itself the scheduler may give a whole chunk to a worker that idles.
    with dask.config.set({"distributed.scheduler.allowed-failures": 20, "distributed.scheduler.work-stealing": False}):
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with distributed.Client(cluster) as client:
                kept = array.persist()
                distributed.wait(kept)
                found = many.persistence(kept)
                same(found.minima, expected.minima)
                same(found.maxima, expected.maxima)
                moved = client.run(lambda dask_worker: sum(e["total"] for e in dask_worker.transfer_incoming_log))
                assert sum(moved.values()) <= 0.03 * array.nbytes
                victim = next(iter(client.run(os.getpid).values()))
                os.kill(victim, signal.SIGKILL)
                same(many.superlevel(kept), expected.maxima)


def test_no_result_is_as_large_as_a_chunk_so_that_none_can_be_moved(tmp_path):
    zarr = pytest.importorskip("zarr")
    from dask.callbacks import Callback
    from dask.sizeof import sizeof

    place = np.indices((96, 96, 96)) / 9
    field = np.sin(place[0]) + np.cos(1.3 * place[1]) * np.sin(0.7 * place[2] + place[0])
    stored = zarr.open(str(tmp_path / "field.zarr"), mode="w", shape=field.shape, chunks=(48, 48, 48), dtype="f4")
    stored[:] = field
    largest = {}

    def note(key, result, *_):
        name = str(key).split("-")[0]
        largest[name] = max(largest.get(name, 0), sizeof(result))

    with Callback(posttask=note):
        found = many.superlevel(da.from_zarr(stored))
    same(found, topo.superlevel(field.astype("f4")))
    chunk = 4 * 48**3
    largest.pop("original", None)  # the store itself, of which every worker has a handle
    assert len(largest) > 2 and max(largest.values()) < chunk / 2, largest
