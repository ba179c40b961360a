"""How work runs: without the lock, stopped by Ctrl-C, in many threads, after a fork, in flat memory, in place."""

import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import cones
from cones import topo


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_a_hundred_threads_get_what_one_gets(hare):
    analysis = cones.Analysis(hare)
    field = np.random.default_rng(1).random((60, 70))

    def ask(k):
        n = 4 + k % 5
        return n, analysis.flatten(analysis.place(n)).uv, topo.superlevel(field + k % 3).array["extremum"]

    expected = {n: (uv, extrema) for n, uv, extrema in map(ask, range(5))}
    with ThreadPoolExecutor(100) as pool:
        for n, uv, extrema in pool.map(ask, range(100)):
            assert (uv == expected[n][0]).all() and (extrema == expected[n][1]).all()


def test_other_threads_run_while_work_is_done():
    mesh = cones.shape("hare", 12_000)
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.005)

    ticker = threading.Thread(target=tick)
    ticker.start()
    begin = time.perf_counter()
    cones.unwrap(mesh, n=8)
    took = time.perf_counter() - begin
    done.set()
    ticker.join()
    during = [t for t in ticks if begin < t < begin + took]
    # With the lock held there would be none but at the ends.
    assert len(during) > 5 and max(np.diff(during)) < 0.5 * took + 0.1


def test_progress_is_told_in_the_callers_thread_and_may_stop_the_work():
    mesh = cones.shape("hare", 12_000)
    told = []
    cones.unwrap(mesh, n=8, progress=lambda stage, fraction: told.append((stage, fraction, threading.get_ident())))
    stages = [stage for stage, _, _ in told]
    assert stages and set(stages) <= {"prepare", "factor", "hierarchy", "curvature", "cut", "scale", "layout", "islands", "pack"}
    assert {thread for _, _, thread in told} == {threading.get_ident()}
    assert all(fraction is None or 0 <= fraction <= 1 for _, fraction, _ in told)

    class Enough(Exception):
        pass

    def enough(stage, fraction):
        raise Enough(stage)

    with pytest.raises(Enough):
        cones.unwrap(mesh, n=32, progress=enough)


@pytest.mark.skipif(os.name == "nt", reason="signals are sent")
def test_ctrl_c_stops_the_work():
    program = """
        import cones, signal
        # Whoever starts the tests in the background has them ignore it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        mesh = cones.shape("hare", 60_000)
        print("ready", flush=True)
        try:
            while True:
                cones.unwrap(mesh, n=48)
        except KeyboardInterrupt:
            print("stopped", flush=True)
    """
    running = subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, text=True)
    assert running.stdout.readline() == "ready\n"
    time.sleep(1.0)
    begin = time.perf_counter()
    running.send_signal(signal.SIGINT)
    assert running.stdout.readline() == "stopped\n"
    assert time.perf_counter() - begin < 5
    assert running.wait(30) == 0


def _interrupted(prepared, asked, share):
    """How long some work takes, and how long after an interrupt it stops, a share of that work later."""
    program = f"""
import cones, numpy as np, signal, time
from cones import topo
signal.signal(signal.SIGINT, signal.default_int_handler)
{textwrap.dedent(prepared)}
begin = time.perf_counter()
{asked}
print(time.perf_counter() - begin, flush=True)
try:
    while True:
        {asked}
except KeyboardInterrupt:
    print("stopped", flush=True)
"""
    running = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    takes = float(running.stdout.readline())
    time.sleep(share * takes)
    begin = time.perf_counter()
    running.send_signal(signal.SIGINT)
    assert running.stdout.readline() == "stopped\n"
    waited = time.perf_counter() - begin
    assert running.wait(30) == 0
    return takes, waited


@pytest.mark.skipif(os.name == "nt", reason="signals are sent")
@pytest.mark.parametrize("asked", ["sublevel(field)", "merge_tree(field)", "segmentation(field)", "simplify(field, threshold=0.1)", "holes(field)"])
def test_ctrl_c_stops_what_is_asked_of_one_array(asked):
    field = "field = np.random.default_rng(6).random((220, 220, 220), dtype=np.float32)"
    takes, waited = _interrupted(field, f"topo.{asked}", 0.2)
    # Work that is not stopped would go on for most of its time.
    assert waited < 0.5 * takes + 0.1


@pytest.mark.skipif(os.name == "nt", reason="signals are sent")
@pytest.mark.parametrize(
    ("distance", "points"),
    [("bottleneck(*diagrams)", 3000), ("wasserstein(*diagrams, relative_error=0)", 1600), ("matching(*diagrams, relative_error=1e-6)", 3000)],
)
def test_ctrl_c_stops_distances(distance, points):
    diagrams = f"""
        points = np.random.default_rng(6).random((2, {points}, 2))
        points[..., 1] += points[..., 0]
        diagrams = [topo.Diagram(of_one) for of_one in points]
    """
    takes, waited = _interrupted(diagrams, f"topo.{distance}", 0.2)
    assert waited < 0.5 * takes + 0.1


@pytest.mark.skipif(os.name == "nt", reason="signals are sent")
def test_ctrl_c_stops_measuring():
    grid = """
        n = 700
        at = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2) / n
        points = np.column_stack([at, 0.1 * np.sin(9 * at[:, 0])])
        first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        faces = np.concatenate([np.stack([first, first + 1, first + n + 1], 1), np.stack([first, first + n + 1, first + n], 1)])
        mesh, uv = cones.Mesh(points, faces), at[faces.ravel()]
    """
    takes, waited = _interrupted(grid, "cones.measure(mesh, uv=uv)", 0.3)
    # Measuring that is not stopped would go on for most of its time.
    assert waited < 0.4 * takes + 0.1, (waited, takes)


def _extrema(field):
    return topo.superlevel(field).array["extremum"]


def _write(path):
    # Long enough to be written on several threads.
    cones.shape("hare", 40_000).write(path)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_forked_processes_work_too(tmp_path):
    field = np.random.default_rng(2).random((300, 400))
    expected = _extrema(field)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        got = pool.map_async(_extrema, [field] * 4).get(timeout=60)
    assert all((extrema == expected).all() for extrema in got)
    parent, child = (tmp_path / name for name in ("parent.obj", "child.obj"))
    _write(parent)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        pool.map_async(_write, [child]).get(timeout=60)
    assert parent.read_bytes() == child.read_bytes()


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="memory is read from /proc")
def test_memory_stays_flat_over_hundreds_of_calls():
    mesh = cones.shape("capsule", 300)
    field = np.random.default_rng(3).random((128, 128))

    def once():
        cones.unwrap(mesh, n=4)
        topo.persistence(field)
        topo.merge_tree(field).segmentation(0.2)

    for _ in range(100):
        once()
    gc.collect()
    before = resident()
    for _ in range(400):
        once()
    gc.collect()
    # So many fields that were kept would be 52 MB, as many maps 16 MB.
    assert resident() - before < 8e6


def test_fields_are_read_where_they_lie():
    field = np.random.default_rng(4).random((2048, 2048))
    field.flags.writeable = False
    from cones.topo._domain import Field

    for kind in ("u1", "u2", "i2", "i4", "i8", "u8", "f4", "f8"):
        values = field.astype(kind) if kind[0] == "f" else (field * 200).astype(kind)
        assert np.shares_memory(Field(values).values, values)
    turned = np.asfortranarray(field)
    assert (topo.sublevel(turned[:64, :64]).array == topo.sublevel(field[:64, :64]).array).all()


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="memory is read from /proc")
def test_a_large_field_is_not_copied():
    program = """
        import numpy as np, resource
        from cones import topo
        x = np.linspace(0, 20, 4000)
        field = np.sin(x)[:, None] + np.cos(1.3 * x)[None, :]
        topo.sublevel(field[:100, :100].copy())
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        topo.sublevel(field)
        print(1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / field.nbytes)
    """
    told = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], capture_output=True, text=True, check=True)
    # A scan keeps 5 bytes a vertex, of which a value has 8.
    assert float(told.stdout) < 0.9


def unaligned(values):
    """A copy that lies one byte off, as what comes over a network may."""
    bytes_ = np.empty(values.nbytes + 1, dtype=np.uint8)
    off = bytes_[1:].view(values.dtype).reshape(values.shape)
    off[...] = values
    assert not off.flags.aligned
    return off


def test_arrays_that_are_not_aligned_are_read_too(hare):
    field = np.random.default_rng(5).random((40, 50))
    assert (topo.sublevel(unaligned(field)).array == topo.sublevel(field).array).all()
    expected = cones.unwrap(hare, n=5)
    found = cones.unwrap(unaligned(hare.vertices), unaligned(hare.faces), n=5)
    assert (found.uv == expected.uv).all()
    assert cones.measure(hare, uv=unaligned(found.uv)).distortion == cones.measure(hare, uv=found.uv).distortion
