#!/usr/bin/env python3
"""Reads what `cones` writes for VTK by VTK itself, and compares it with the report.

    vtk_files.py PROGRAM
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def run(program, *args, folder):
    done = subprocess.run([program, *args], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout


def read(path):
    """The data, by VTK's reader; any complaint of its is an error."""
    complaints = []
    reader = vtk.vtkXMLPolyDataReader()
    reader.AddObserver("ErrorEvent", lambda *what: complaints.append(what))
    reader.SetFileName(str(path))
    reader.Update()
    assert not complaints, complaints
    return reader.GetOutput()


def arrays(of):
    return {of.GetArrayName(k): vtk_to_numpy(of.GetArray(k)) for k in range(of.GetNumberOfArrays())}


def check_map(program, folder, shape, count):
    run(program, "shape", shape, "--vertices", "1500", "-o", "shape.obj", "-q", folder=folder)
    report = json.loads(run(program, "unwrap", "shape.obj", "-n", str(count), "-o", "out.obj", "--vtp", "out.vtp",
                            "--json", folder=folder))
    data = read(Path(folder, "out.vtp"))
    cells, points = arrays(data.GetCellData()), arrays(data.GetPointData())
    kind = cells["kind"]
    assert data.GetNumberOfPolys() == report["input"]["faces"] == (kind == 2).sum()
    assert data.GetNumberOfVerts() == len(report["cones"]) == (kind == 0).sum()
    curvature = {cone["vertex"]: cone["curvature"] for cone in report["cones"]}
    place = vtk_to_numpy(data.GetPoints().GetData())
    for k in range(data.GetNumberOfVerts()):
        vertex = points["vertex"][data.GetCell(k).GetPointId(0)]
        assert curvature[vertex] == cells["curvature"][k], vertex
    # The means are those of the report, weighted by areas as VTK measures them.
    size = vtk.vtkCellSizeFilter()
    size.SetInputData(data)
    size.Update()
    area = arrays(size.GetOutput().GetCellData())["Area"]
    flat = kind == 2
    ratio = cells["area"][flat]
    mean = numpy.average(numpy.maximum(ratio, 1 / ratio), weights=area[flat])
    assert abs(mean - report["distortion"]["area_mean"]) < 1e-6, mean
    mean = numpy.average(cells["stretch"][flat], weights=area[flat])
    assert abs(mean - report["distortion"]["quasi_conformal"]["mean"]) < 1e-6, mean
    assert numpy.isnan(cells["area"][~flat]).all() and (cells["island"][~flat] == -1).all()
    assert set(cells["island"][flat]) == set(range(len(report["islands"])))
    assert data.GetPointData().GetTCoords().GetName() == "uv"
    # Points are those of the file, at every copy.
    lines = Path(folder, "shape.obj").read_text().splitlines()
    file = numpy.array([[float(x) for x in line.split()[1:4]] for line in lines if line.startswith("v ")])
    assert (file[points["vertex"]] == place).all()
    # Seams are as long as the report says, and points are split along them.
    length = 0.0
    for k in numpy.flatnonzero(kind == 1):
        ids = data.GetCell(k).GetPointIds()
        chain = place[[ids.GetId(i) for i in range(ids.GetNumberOfIds())]]
        length += numpy.linalg.norm(numpy.diff(chain, axis=0), axis=1).sum()
    assert abs(length / numpy.sqrt(area[flat].sum()) - report["distortion"]["seam_length"]) < 1e-6, length
    assert data.GetNumberOfPoints() > len(file)
    return data.GetNumberOfPoints()


def check_pairs(program, folder):
    run(program, "shape", "terrain", "--vertices", "2000", "-o", "land.obj", "-q", folder=folder)
    report = json.loads(run(program, "persistence", "land.obj", "--field", "height:z", "--pairs", "pairs.vtp", "--json",
                            folder=folder))
    data = read(Path(folder, "pairs.vtp"))
    points = arrays(data.GetPointData())
    finite = sum(pair["saddle"] is not None for direction in ("sublevel", "superlevel") for pair in
                 (report[direction] or {}).get("pairs", []))
    assert data.GetNumberOfLines() == finite, (data.GetNumberOfLines(), finite)
    assert set(points["kind"]) == {0, 1, 2, 3}
    assert (points["persistence"] >= 0).all()


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        for shape, count in [("hare", 9), ("torus-2", 6), ("part", 8)]:
            print(f"VTK {vtk.VTK_VERSION} reads {shape}: {check_map(program, folder, shape, count)} points")
        check_pairs(program, folder)
        print(f"VTK {vtk.VTK_VERSION} reads pairs")


if __name__ == "__main__":
    main(str(Path(sys.argv[1]).resolve()))
