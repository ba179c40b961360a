#!/usr/bin/env python3
"""Unwraps a surface with normals, colours and materials into every format, reads these files with other programs, has them
write the surface again, and reads that: what each program and format can hold must be the same everywhere.

    round_trips.py PROGRAM [READER...]

Readers that cannot be imported (trimesh, meshio, pymeshlab, bpy; three by node) are skipped by name.
"""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

SCRIPT = Path(__file__).resolve()

# What must arrive: u texture coordinates, n normals, c colours, m materials. Where a letter is missing the program, not the
# file, has no place for it.
READ = {
    "trimesh": {"obj": "un", "ply": "unc", "glb": "uncm"},
    "meshio": {"ply": "unc"},
    # MeshLab cuts the linear colours of glTF off to eight bits, which is too coarse in the dark to compare.
    "pymeshlab": {"obj": "uc", "ply": "uc", "glb": "u"},
    "blender": {"obj": "uncm", "ply": "unc", "glb": "uncm"},
    "three": {"glb": "uncm"},
}
# What must be in what the program writes of the PLY or GLB that it has read.
WRITTEN = {
    "trimesh": {"ply": "c", "glb": ""},
    "meshio": {"ply": "c"},
    "pymeshlab": {"ply": "c", "obj": "c"},
    "blender": {"obj": "n", "ply": "nc", "glb": "nm"},
}
TOLERANCE = {"u": 2e-6, "n": 1e-5, "c": 0.6 / 255}
# MeshLab and Blender cut colours off to eight bits; Blender keeps normals as two numbers of 16 bits in a frame of the corner.
COARSER = {"pymeshlab": {"c": 1.1 / 255}, "blender": {"c": 1.1 / 255, "n": 2e-2}}


def key(point):
    """Positions of the surface are multiples of a thousandth, which f32 keeps apart."""
    return tuple(round(x, 3) + 0.0 for x in point)


def to_srgb(x):
    return 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055


# The surface

def parse_obj(text):
    """Triangles of an OBJ: each three corners of position, u, n, c, and a material."""
    v, vt, vn, material, faces = [], [], [], None, []
    for line in text.splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            numbers = [float(x) for x in rest]
            v.append((numbers[:3], numbers[3:6] or None))
        elif word == "vt":
            vt.append([float(x) for x in rest])
        elif word == "vn":
            vn.append([float(x) for x in rest])
        elif word == "usemtl":
            material = rest[0]
        elif word == "f":
            corners = []
            for corner in rest:
                i, t, n = (corner.split("/") + ["", ""])[:3]
                point, colour = v[int(i) - 1]
                corners.append({"p": point, "c": colour, "u": vt[int(t) - 1] if t else None,
                                "n": vn[int(n) - 1] if n else None})
            faces.append({"corners": corners, "m": material})
    return faces


def make_surface(program, folder):
    """A hare with a colour for each vertex, normals that jump across its middle, and two materials."""
    subprocess.run([program, "shape", "hare", "--vertices", "500", "-o", Path(folder, "plain.obj"), "-q"], check=True)
    faces = parse_obj(Path(folder, "plain.obj").read_text())
    number, lines, normals, out = {}, [], [], []
    for face in faces:
        points = [key([3 * x for x in corner["p"]]) for corner in face["corners"]]
        if len(set(points)) < 3:
            continue
        a, b, c = points
        e, f = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
        flat = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
        is_flat = sum(p[1] for p in points) < 0
        corners = []
        for point in points:
            if point not in number:
                number[point] = len(lines) + 1
                k = len(lines)
                red, green, blue = 37 * k % 256, 101 * k % 256, 11 * k % 256
                lines.append(f"v {point[0]} {point[1]} {point[2]} {red / 255:.6f} {green / 255:.6f} {blue / 255:.6f}")
            n = flat if is_flat else point
            size = math.sqrt(sum(x * x for x in n)) or 1.0
            normals.append("vn %.6f %.6f %.6f" % tuple(x / size for x in n))
            corners.append(f"{number[point]}//{len(normals)}")
        material = "fur" if points[0][0] < 0 else "skin"
        out += [f"usemtl {material}", "f " + " ".join(corners)]
    path = Path(folder, "hare.obj")
    path.write_text("\n".join(lines + normals + out) + "\n")
    return path


# The readers: each gives triangles as `parse_obj` does. They run in a process of their own, as some libraries do not bear each other.

def corners_of(points, triangles, u=None, n=None, c=None, materials=None, by_corner=False):
    """Triangles of arrays by vertices; `u` by corners where that is asked."""
    faces = []
    for f, triangle in enumerate(triangles):
        corners = []
        for k, v in enumerate(triangle):
            take = lambda values, i: None if values is None else [float(x) for x in values[i]]
            corners.append({"p": take(points, v), "u": take(u, 3 * f + k if by_corner else v),
                            "n": take(n, v), "c": (take(c, v) or [])[:3] or None})
        faces.append({"corners": corners, "m": None if materials is None else materials[f]})
    return faces


def read_trimesh(path, form, again):
    import numpy
    import trimesh
    scene = trimesh.load(path, process=False, force="scene")
    faces = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        normals, u = mesh.vertex_normals, getattr(mesh.visual, "uv", None)
        held = getattr(mesh.visual, "vertex_attributes", {})
        c = held["color"] if "color" in held else None
        if c is None and mesh.visual.kind == "vertex":
            c = mesh.visual.vertex_colors
        if c is None and form == "ply":
            raw = mesh.metadata["_ply_raw"]["vertex"]["data"]
            c = numpy.stack([raw[name] for name in ("red", "green", "blue")], axis=1)
        if c is not None:
            c = numpy.asarray(c, dtype=float) / (numpy.iinfo(c.dtype).max if c.dtype.kind == "u" else 1.0)
            if form == "glb":
                c = numpy.vectorize(to_srgb)(c)
        material = getattr(getattr(mesh.visual, "material", None), "name", None)
        points = trimesh.transform_points(mesh.vertices, transform)
        faces += corners_of(points, mesh.faces, u, normals, c, [material] * len(mesh.faces))
    for other in WRITTEN["trimesh"] if form == "glb" else ():
        # What trimesh holds as a texture it writes as one, without colours: they are given to it as its colours.
        mesh = scene.to_geometry() if hasattr(scene, "to_geometry") else scene.dump(concatenate=True)
        plain = trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_normals=mesh.vertex_normals, process=False)
        colours = {key(corner["p"]): corner["c"] for face in faces for corner in face["corners"]}
        byte = [[round(255 * x) for x in colours[key(point)]] + [255] for point in plain.vertices]
        linear = [[round(255 * to_linear(x)) for x in colours[key(point)]] + [255] for point in plain.vertices]
        plain.visual.vertex_colors = linear if other == "glb" else byte
        plain.export(f"{again}.{other}")
    return faces


def to_linear(x):
    return x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4


def read_meshio(path, form, again):
    import meshio
    import numpy
    mesh = meshio.read(path)
    data = mesh.point_data
    u = numpy.stack([data["s"], data["t"]], axis=1)
    n = numpy.stack([data["nx"], data["ny"], data["nz"]], axis=1)
    c = numpy.stack([data["red"], data["green"], data["blue"]], axis=1) / 255
    meshio.write(f"{again}.ply", mesh, binary=True)
    return corners_of(mesh.points, mesh.cells_dict["triangle"], u, n, c)


def read_pymeshlab(path, form, again):
    import pymeshlab
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(str(path))
    if meshes.mesh_number() > 1:
        meshes.generate_by_merging_visible_meshes(mergevertices=False)
    # A node of glTF stands as a matrix beside the mesh.
    meshes.apply_matrix_freeze(alllayers=True)
    mesh = meshes.current_mesh()
    by_corner = mesh.has_wedge_tex_coord()
    u = mesh.wedge_tex_coord_matrix() if by_corner else mesh.vertex_tex_coord_matrix()
    c = mesh.vertex_color_matrix() if mesh.has_vertex_color() else None
    points, triangles = mesh.vertex_matrix(), mesh.face_matrix()
    for other in WRITTEN["pymeshlab"] if form == "ply" else ():
        meshes.save_current_mesh(f"{again}.{other}")
    return corners_of(points, triangles, u, None, c, by_corner=by_corner)


def read_blender(path, form, again):
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if form == "obj":
        bpy.ops.wm.obj_import(filepath=str(path), forward_axis="Y", up_axis="Z")
    elif form == "ply":
        bpy.ops.wm.ply_import(filepath=str(path))
    else:
        bpy.ops.import_scene.gltf(filepath=str(path))
    faces = []
    for thing in bpy.context.scene.objects:
        if thing.type != "MESH":
            continue
        mesh = thing.data
        turn = (lambda p: [p[0], p[2], -p[1]]) if form == "glb" else list
        mesh.calc_loop_triangles()
        uv = mesh.uv_layers.active
        colour = mesh.color_attributes[0] if len(mesh.color_attributes) else None
        for triangle in mesh.loop_triangles:
            corners = []
            for loop, v in zip(triangle.loops, triangle.vertices):
                c = None
                if colour is not None:
                    c = [to_srgb(x) for x in colour.data[v if colour.domain == "POINT" else loop].color[:3]]
                corners.append({"p": turn(thing.matrix_world @ mesh.vertices[v].co), "c": c,
                                "u": list(uv.data[loop].uv) if uv else None,
                                "n": turn(mesh.corner_normals[loop].vector)})
            slots = thing.material_slots
            material = slots[triangle.material_index].name if len(slots) else None
            faces.append({"corners": corners, "m": material})
    if form == "glb":
        bpy.ops.export_scene.gltf(filepath=f"{again}.glb", export_format="GLB")
        bpy.ops.wm.obj_export(filepath=f"{again}.obj", forward_axis="NEGATIVE_Z", up_axis="Y")
    if form == "ply":
        bpy.ops.wm.ply_export(filepath=f"{again}.ply", export_colors="SRGB", export_normals=True, export_uv=True)
    return faces


THREE = """
import { readFileSync } from 'node:fs';
globalThis.self = globalThis;
const { GLTFLoader } = await import(process.argv[2] + '/examples/jsm/loaders/GLTFLoader.js');
const bytes = readFileSync(process.argv[3]);
const loader = new GLTFLoader();
// There are no pictures without a browser: the loader gets an empty texture.
loader.register(parser => { parser.loadTexture = async () => null; return { name: 'none' }; });
loader.parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), '', gltf => {
  const faces = [];
  gltf.scene.updateMatrixWorld(true);
  gltf.scene.traverse(mesh => {
    if (!mesh.isMesh) return;
    const g = mesh.geometry, index = g.index, at = name => g.getAttribute(name);
    const row = (name, i, n) => at(name) ? ['getX', 'getY', 'getZ'].slice(0, n).map(get => at(name)[get](i)) : null;
    for (let f = 0; f < index.count; f += 3) {
      const corners = [0, 1, 2].map(k => {
        const i = index.getX(f + k), p = mesh.localToWorld(mesh.position.clone().fromBufferAttribute(at('position'), i));
        const uv = row('uv', i, 2);
        return { p: [p.x, p.y, p.z], u: [uv[0], 1 - uv[1]], n: row('normal', i, 3), c: row('color', i, 3) };
      });
      faces.push({ corners, m: mesh.material.name });
    }
  });
  process.stdout.write(JSON.stringify(faces));
}, error => { console.error(error); process.exit(1); });
"""


def read_three(path, form, again):
    script = Path(f"{again}.mjs")
    script.write_text(THREE)
    faces = json.loads(subprocess.run(["node", script, three_folder(), path], check=True, stdout=subprocess.PIPE).stdout)
    for face in faces:
        for corner in face["corners"]:
            corner["c"] = corner["c"] and [to_srgb(x) for x in corner["c"]]
    return faces


def three_folder():
    """Where `npm install three` has put it: beside the Python that runs this."""
    return str(Path(sys.prefix, "node_modules", "three"))


def is_there(reader):
    if reader == "three":
        return Path(three_folder()).is_dir()
    module = {"blender": "bpy"}.get(reader, reader)
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


# The comparison

def compare(expected, found, letters, reader):
    """What is wrong with triangles that were read."""
    there = {}
    for face in found:
        there.setdefault(frozenset(key(c["p"]) for c in face["corners"]), []).append(face)
    faults, worst = [], dict.fromkeys(TOLERANCE, 0.0)
    if len(found) != len(expected):
        faults.append(f"{len(found)} triangles in place of {len(expected)}")
    for face in expected:
        place = frozenset(key(c["p"]) for c in face["corners"])
        other = (there.get(place) or [None])[0]
        if other is None:
            faults.append(f"no triangle at {sorted(place)}")
            continue
        if "m" in letters and other["m"] != face["m"]:
            faults.append(f"material {other['m']} in place of {face['m']}")
        corner_at = {key(c["p"]): c for c in other["corners"]}
        for corner in face["corners"]:
            for letter in set(letters) - {"m"}:
                a, b = corner[letter], corner_at[key(corner["p"])][letter]
                if b is None:
                    faults.append(f"no {letter}")
                else:
                    worst[letter] = max([worst[letter]] + [abs(x - y) for x, y in zip(a, b)])
    faults += [f"{letter} differs by {worst[letter]:.1e}" for letter in worst if worst[letter] > COARSER.get(reader, {}).get(letter, TOLERANCE[letter])]
    return faults


def report(what, faults):
    text = "; ".join(sorted(set(faults))[:3])
    print(f"{what:44} {text or 'ok'}", flush=True)
    return bool(faults)


def main(program, readers):
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        source = make_surface(program, folder)
        files = {form: Path(folder, f"out.{form}") for form in ("obj", "ply", "glb")}
        for path in files.values():
            subprocess.run([program, "unwrap", source, "-n", "6", "-o", path, "-q"], check=True)
        expected = parse_obj(files["obj"].read_text())
        for reader in readers:
            if not is_there(reader):
                print(f"skipped: {reader} (it is not installed)")
                continue
            for form, letters in READ[reader].items():
                again = Path(folder, f"{reader}-{form}")
                command = [sys.executable, SCRIPT, "--read", reader, files[form], form, again]
                done = subprocess.run(command, stdout=subprocess.PIPE)
                if done.returncode != 0:
                    failed |= report(f"{reader} reads {form}", ["it ended with an error"])
                    continue
                faces = json.loads(Path(f"{again}.json").read_text())
                failed |= report(f"{reader} reads {form}", compare(expected, faces, letters, reader))
                for other, letters in WRITTEN.get(reader, {}).items():
                    path = Path(f"{again}.{other}")
                    if path.is_file():
                        back = Path(folder, "back.obj")
                        # Colours and the like must pass through a GLB or PLY of ours, not only through the reader.
                        command = [program, "unwrap", path, "-n", "6", "-o", back, "-q", "--weld"]
                        subprocess.run(command, check=True)
                        faults = compare(expected, parse_obj(back.read_text()), letters, reader)
                        failed |= report(f"cones reads {other} of {reader} (from {form})", faults)
    return int(failed)


if __name__ == "__main__":
    if sys.argv[1] == "--read":
        _, _, name, file, kind, target = sys.argv
        result = globals()[f"read_{name}"](Path(file), kind, target)
        Path(f"{target}.json").write_text(json.dumps(result))
    else:
        sys.exit(main(sys.argv[1], sys.argv[2:] or list(READ)))
