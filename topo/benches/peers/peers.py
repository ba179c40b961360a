#!/usr/bin/env python3
"""Times of topo beside those of GUDHI, cripser and higra: the table of BENCHMARKS.md.

    peers.py [FOLDER [ROW...]]

Runs all rows, or those with these numbers, the first being 0. Makes a virtual environment in FOLDER (target/peers if none is named), installs the other libraries there from PyPI, builds
`--bench peers`, and runs all of them on the same fields, each call in a process of its own, in turn, three rounds of it. What is printed is
the least processor time of any round, on one thread; memory is how far the first call raises the peak of its process. The others give
values, topo vertices and values. Needs Linux and cargo.
"""
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

PACKAGES = ["numpy", "gudhi", "cripser", "higra"]
ROUNDS = 3
ROOT = Path(__file__).resolve().parents[3]

# Field, shape, what topo does, and what the others are asked for; connectivity is the same for all of a row.
ROWS = [
    ("random", (1 << 24,), "pairs", ["GUDHI, line"]),
    ("smooth", (1024, 1024), "pairs", ["GUDHI, rectangle (H0 and H1)", "cripser", "GUDHI, complex (H0 and H1)"]),
    ("smooth", (1024, 1024), "pairs and holes", ["GUDHI, rectangle (H0 and H1)"]),
    ("smooth", (4096, 4096), "pairs", ["GUDHI, rectangle (H0 and H1)"]),
    ("smooth", (4096, 4096), "pairs and holes", ["GUDHI, rectangle (H0 and H1)"]),
    ("random", (1024, 1024), "pairs", ["GUDHI, rectangle (H0 and H1)", "cripser"]),
    ("random", (1024, 1024), "pairs and holes", ["GUDHI, rectangle (H0 and H1)"]),
    ("smooth", (1024, 1024), "tree", ["higra"]),
    ("random", (1024, 1024), "tree", ["higra"]),
    ("smooth", (128, 128, 128), "pairs", ["cripser"]),
    ("smooth", (64, 64, 64), "pairs", ["cripser", "GUDHI, complex (H0 to H2)"]),
    ("smooth", (1024, 1024), "sort", []),
    ("random", (1024, 1024), "sort", []),
    ("smooth", (1024, 1024), "segmentation", []),
    ("random", (1024, 1024), "segmentation", []),
    ("smooth", (1024, 1024), "contour tree", []),
    ("random", (1024, 1024), "contour tree", []),
    ("smooth", (1024, 1024), "freudenthal pairs", []),
    ("smooth", (1024, 1024), "freudenthal tree", []),
    ("smooth", (1024, 1024), "freudenthal segmentation", []),
    ("smooth", (1024, 1024), "freudenthal contour tree", []),
]


def field(name, shape):
    """A field like that of `cargo bench`: long waves and three octaves of value noise; or white noise."""
    import numpy as np

    random = np.random.default_rng(7)
    if name == "random":
        return random.random(shape)
    values = np.zeros(shape)
    for axis, rate in zip(range(len(shape)), [0.031, 0.017, 0.023]):
        along = np.sin(rate * np.arange(shape[axis]))
        values += along.reshape([-1 if a == axis else 1 for a in range(len(shape))])
    for size, height in [(3.9, 0.25), (13.7, 0.6), (61.0, 2.0)]:
        noise = random.random([int(length / size) + 2 for length in shape])
        for axis, length in enumerate(shape):
            at = np.arange(length) / size
            cell = at.astype(int)
            t = (at - cell) ** 2 * (3 - 2 * (at - cell))
            t = t.reshape([-1 if a == axis else 1 for a in range(len(shape))])
            noise = np.take(noise, cell, axis) * (1 - t) + np.take(noise, cell + 1, axis) * t
        values += height * noise
    return values


def call(name, values):
    """Does what is named once; what is made before is not timed."""
    if name == "GUDHI, line":
        from gudhi._pers_cub_low_dim_ext import _persistence_on_a_line as line

        return lambda: line(values)
    if name.startswith("GUDHI, rectangle"):
        from gudhi._pers_cub_low_dim_ext import _persistence_on_rectangle_from_top_cells as rectangle

        return lambda: rectangle(values, 0.0)
    if name.startswith("GUDHI, complex"):
        import gudhi

        # Pixels are squares, as with eight neighbours; voxels are vertices, as with six.
        key = "top_dimensional_cells" if values.ndim == 2 else "vertices"
        return lambda: gudhi.CubicalComplex(**{key: values}).compute_persistence()
    if name == "cripser":
        import cripser

        return lambda: cripser.computePH(values, maxdim=0)
    import higra

    graph = higra.get_8_adjacency_implicit_graph(values.shape)
    return lambda: higra.component_tree_min_tree(graph, values)


def measure(name, path, shape):
    """Seconds on the processor of a call, and by how many bytes it raised the peak."""
    import time

    import numpy as np

    work = call(name, np.fromfile(path).reshape(shape))

    def resident(line):
        return 1024 * next(int(text.split()[1]) for text in open("/proc/self/status") if text.startswith(line))

    Path("/proc/self/clear_refs").write_text("5")
    before, start = resident("VmRSS"), time.process_time()
    work()
    seconds = time.process_time() - start
    print(json.dumps([seconds, max(0, resident("VmHWM") - before)]))


def prepared(folder):
    """The interpreter with the other libraries, and topo's program."""
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    build = ["cargo", "bench", "--no-run", "-p", "cones-topo", "--bench", "peers", "--message-format", "json"]
    lines = subprocess.run(build, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout.splitlines()
    made = [message["executable"] for message in map(json.loads, lines) if message.get("executable")]
    return python, made[-1]


def main(folder, rows):
    python, program = prepared(folder)
    one_thread = {**os.environ, "OMP_NUM_THREADS": "1"}

    def run(*command):
        done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=one_thread)
        return done.stdout.decode() if done.returncode == 0 else None

    print("| field | what | topo | bytes a vertex | beside it, seconds, times as long, bytes a vertex |\n|---|---|---|---|---|")
    for name, shape, what, others in [ROWS[row] for row in rows]:
        with tempfile.TemporaryDirectory() as scratch:
            path, text = Path(scratch) / "field", "x".join(map(str, shape))
            make = "import sys; sys.path.insert(0, sys.argv[1]); import peers; peers.field(sys.argv[2], eval(sys.argv[3])).tofile(sys.argv[4])"
            run(python, "-c", make, Path(__file__).parent, name, repr(shape), path)
            best = {}
            for _ in range(ROUNDS):
                found = {"topo": [float(x) for x in run(program, what, text, path, 3).split()]}
                for other in others:
                    told = run(python, __file__, "--measure", other, path, repr(shape))
                    found[other] = json.loads(told) if told else None
                for who, seconds in found.items():
                    best[who] = min(filter(None, [best.get(who), seconds]), default=None)
        vertices = math.prod(shape)
        ours, bytes_taken = best.pop("topo")
        told = [f"{who}: failed" if not of else f"{who} {of[0]:.3f}, {of[0] / ours:.1f}, {of[1] / vertices:.0f}" for who, of in best.items()]
        row = [f"{name}, {' × '.join(map(str, shape))}", what, f"{ours:.4f}", f"{bytes_taken / vertices:.1f}", "; ".join(told)]
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        measure(sys.argv[2], sys.argv[3], eval(sys.argv[4]))
    else:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "peers").resolve()
        main(folder, [int(row) for row in sys.argv[2:]] or range(len(ROWS)))
