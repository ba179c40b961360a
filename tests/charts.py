#!/usr/bin/env python3
"""Compares maps of hard shapes with what xatlas and Blender's Smart UV Project make of them, measured by the independent judge.

    charts.py PROGRAM JUDGE JUDGE_PYTHON MESH...

Needs the packages xatlas and bpy beside numpy, the judge's python scipy. Ours: default options, and `--refine`; others: their defaults, a
margin of 4 texels of 1024. Fill is the triangles' area over that of the square.
"""
import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from packing import MARGIN, TEXTURE, area, read, run, write, xatlas_charts


def smart_project(points, faces, _):
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    mesh.uv_layers.new()
    body = bpy.data.objects.new("body", mesh)
    bpy.context.scene.collection.objects.link(body)
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(island_margin=MARGIN / TEXTURE)
    bpy.ops.object.mode_set(mode="OBJECT")
    places = np.empty(6 * len(faces), dtype=np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", places)
    return places.astype(float).reshape(-1, 3, 2)


def row(name, judge, mesh, out, fill, seconds):
    judged = json.loads(run(*judge, mesh, out, "--json"))
    islands = judged["islands"] if isinstance(judged["islands"], int) else len(judged["islands"])
    print(f"| {name} | {islands} | {judged['area_D']:.3f} | {judged['qc_mean']:.4f} | {judged['seam_rel']:.2f} "
          f"| {fill:.3f} | {seconds:.1f} |", flush=True)


def main(program, judge, python, *meshes):
    print("| mesh, program | islands | D | qc | seams | fill | s |\n|---|---|---|---|---|---|---|")
    judge = (python, judge)
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder, "ours.obj"), Path(folder, "theirs.obj")
        for mesh in meshes:
            name = Path(mesh).stem
            plain = [] if Path(mesh).suffix == ".stl" else [("`cones`", ["--refine=never"])]
            for label, more in [("`cones --refine`", ["--refine"]), *plain]:
                report = json.loads(run(program, "unwrap", mesh, "-o", ours, "--triangulate", "--json", *more))
                row(f"{name}, {label}", judge, ours, ours, report["distortion"]["fill"], report["times"]["total"])
            # What others get is the input's triangles, but of STL, which has no vertices, the refined ones.
            points, faces, uv = read(ours)
            for label, chart in [("xatlas", xatlas_charts), ("Smart UV Project", smart_project)]:
                began = time.time()
                try:
                    places = chart(points, faces, uv)
                except Exception as error:  # one that cannot take a mesh must not end the table
                    print(f"| {name}, {label} | {error} |", flush=True)
                    continue
                took = time.time() - began
                write(theirs, points, faces, places)
                side = max(1.0, np.ptp(places.reshape(-1, 2), axis=0).max())
                row(f"{name}, {label}", judge, theirs, theirs, area(places) / side**2, took)


if __name__ == "__main__":
    main(*sys.argv[1:])
