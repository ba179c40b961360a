#!/usr/bin/env python3
"""Compares our maps, and our packing, with what xatlas and Blender make of the same meshes; the independent judge measures each.

    packing.py PROGRAM JUDGE JUDGE_PYTHON MESH...            32 cones; others pack our islands, xatlas its own charts as well
    packing.py --charts PROGRAM JUDGE JUDGE_PYTHON MESH...   hard shapes: default options and `--refine`; xatlas and Smart UV Project by their defaults

Needs the packages xatlas and bpy beside numpy, the judge's python scipy. Fill is the triangles' area over that of the square; seconds of
ours are of packing alone with 32 cones, of all with --charts. Margin: 4 texels of 1024.
"""
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

TEXTURE, MARGIN, CONES = 1024, 4, 32


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def read(path):
    """Points, triangles, and texture coordinates at their corners."""
    points, texture, faces, corners = [], [], [], []
    for line in Path(path).read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([float(x) for x in rest[:3]])
        elif word == "vt":
            texture.append([float(x) for x in rest[:2]])
        elif word == "f":
            parts = [[int(x) - 1 if x else 0 for x in part.split("/")] for part in rest]
            for k in range(1, len(parts) - 1):
                fan = [parts[0], parts[k], parts[k + 1]]
                faces.append([part[0] for part in fan])
                corners.append([part[1] if len(part) > 1 else 0 for part in fan])
    texture = np.array(texture) if texture else np.zeros((1, 2))
    return np.array(points), np.array(faces), texture[np.array(corners)]


def write(path, points, faces, uv):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    lines += [f"vt {u!r} {v!r}" for u, v in uv.reshape(-1, 2).tolist()]
    lines += ["f " + " ".join(f"{v + 1}/{3 * t + k + 1}" for k, v in enumerate(f)) for t, f in enumerate(faces.tolist())]
    Path(path).write_text("\n".join(lines) + "\n")


def xatlas_charts(points, faces, _):
    import xatlas
    atlas = xatlas.Atlas()
    atlas.add_mesh(points.astype(np.float32), faces.astype(np.uint32))
    return xatlas_packed(xatlas, atlas)


def xatlas_islands(points, faces, uv):
    """Packs given islands: triangles meet in texture space where their corners have the same place."""
    import xatlas
    place, corner = np.unique(uv.reshape(-1, 2), axis=0, return_inverse=True)
    atlas = xatlas.Atlas()
    atlas.add_uv_mesh(place.astype(np.float32), corner.reshape(-1, 3).astype(np.uint32))
    return xatlas_packed(xatlas, atlas)


def xatlas_packed(xatlas, atlas):
    options = xatlas.PackOptions()
    options.padding, options.resolution, options.bruteForce = MARGIN, TEXTURE, True
    atlas.generate(pack_options=options)
    _, corners, places = atlas.get_mesh(0)
    # A whole atlas is measured by the square about it.
    places = places * np.array([atlas.width, atlas.height]) / max(atlas.width, atlas.height)
    return places[corners].astype(float)


def in_blender(points, faces, uv, operate):
    """What an operator on all faces in edit mode makes of texture coordinates."""
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    mesh.uv_layers.new().data.foreach_set("uv", uv.reshape(-1).astype(np.float32))
    body = bpy.data.objects.new("body", mesh)
    bpy.context.scene.collection.objects.link(body)
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.select_all(action="SELECT")
    operate(bpy.ops.uv)
    bpy.ops.object.mode_set(mode="OBJECT")
    places = np.empty(6 * len(faces), dtype=np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", places)
    return places.astype(float).reshape(-1, 3, 2)


def blender(points, faces, uv):
    options = dict(rotate=True, rotate_method="ANY", margin_method="FRACTION", margin=MARGIN / TEXTURE, shape_method="CONCAVE")
    return in_blender(points, faces, uv, lambda uv: uv.pack_islands(**options))


def smart_project(points, faces, uv):
    return in_blender(points, faces, uv, lambda uv: uv.smart_project(island_margin=MARGIN / TEXTURE))


def area(uv):
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    return np.abs(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])).sum()


def row(name, judge, mesh, out, fill, seconds):
    judged = json.loads(run(*judge, mesh, out, "--json"))
    islands = judged["islands"] if isinstance(judged["islands"], int) else len(judged["islands"])
    print(f"| {name} | {fill:.3f} | {islands} | {judged['seam_rel']:.2f} | {100 * judged['overlap']:.2f} % | {judged['area_D']:.3f} "
          f"| {judged['qc_mean']:.4f} | {seconds:.2f} |", flush=True)


# What we are asked for, each with its options; what others do; and which of our times counts.
PACKING = ([("`--islands pack`", ["-n", CONES, "--islands", "pack"]), ("default", ["-n", CONES])],
           [("Blender, our islands", blender), ("xatlas, our islands", xatlas_islands), ("xatlas", xatlas_charts)], "pack")
CHARTS = ([("`cones --refine`", ["--refine"]), ("`cones`", ["--refine=never"])],
          [("xatlas", xatlas_charts), ("Smart UV Project", smart_project)], "total")


def main(program, judge, python, *meshes, compared=PACKING):
    options, packers, time_of = compared
    judge = (python, judge)
    print("| mesh, packer | fill | islands | seams | overlap | D | qc | s |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder, "ours.obj"), Path(folder, "theirs.obj")
        for mesh in meshes:
            name = Path(mesh).stem
            for label, more in options:
                report = json.loads(run(program, "unwrap", mesh, "-o", ours, "--triangulate", "--json", *more))
                row(f"{name}, {label}", judge, ours, ours, report["distortion"]["fill"], report["times"][time_of])
            # What others get is our last triangles, since STL has no vertices.
            points, faces, uv = read(ours)
            for label, pack in packers:
                began = time.time()
                try:
                    places = pack(points, faces, uv)
                except Exception as error:  # one that cannot take a mesh must not end the table
                    print(f"| {name}, {label} | {error} |", flush=True)
                    continue
                took = time.time() - began
                write(theirs, points, faces, places)
                side = max(1.0, np.ptp(places.reshape(-1, 2), axis=0).max())
                row(f"{name}, {label}", judge, theirs, theirs, area(places) / side**2, took)


if __name__ == "__main__":
    arguments = [argument for argument in sys.argv[1:] if argument != "--charts"]
    main(*arguments, compared=CHARTS if "--charts" in sys.argv else PACKING)
