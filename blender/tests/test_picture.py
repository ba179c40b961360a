"""What Blender renders of a map is what the map says: a checkerboard, pixel by pixel."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import cones  # noqa: E402
from test_operator import cone_unwrap, from_mesh, scene, select, uv_of  # noqa: E402, F401

PIXELS = 96
SQUARES = 12


def checkerboard():
    """A material that shines by a checkerboard of the map, whatever the light."""
    material = bpy.data.materials.new("checker")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    squares, shine = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeEmission")
    squares.inputs["Scale"].default_value = SQUARES
    squares.inputs["Color1"].default_value, squares.inputs["Color2"].default_value = (1, 1, 1, 1), (0, 0, 0, 1)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["UV"], squares.inputs["Vector"])
    links.new(squares.outputs["Color"], shine.inputs["Color"])
    links.new(shine.outputs["Emission"], nodes["Material Output"].inputs["Surface"])
    return material


def rendered_from_above(width, path):
    """The red of each pixel of a picture of the square of some width about the origin, the lowest row first."""
    scene = bpy.context.scene
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", width
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = (0, 0, 10)
    scene.collection.objects.link(scene.camera)
    scene.render.engine = "CYCLES"
    # One ray a pixel, through its middle.
    scene.cycles.samples, scene.cycles.pixel_filter_type, scene.cycles.filter_width = 1, "BLACKMAN_HARRIS", 0.01
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.view_settings.view_transform = "Raw"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    pixels = np.array(bpy.data.images.load(str(path)).pixels).reshape(PIXELS, PIXELS, 4)
    return pixels[..., 0]


def seen_from_above(obj, width):
    """The coordinates on the map of what is seen at each pixel; NaN where nothing is."""
    points = np.array([vertex.co for vertex in obj.data.vertices])
    triangles = np.array([polygon.vertices for polygon in obj.data.polygons])
    uv = uv_of(obj).reshape(-1, 3, 2)
    middle = ((np.arange(PIXELS) + 0.5) / PIXELS - 0.5) * width
    at = np.stack(np.meshgrid(middle, middle), axis=-1)
    seen, height = np.full((PIXELS, PIXELS, 2), np.nan), np.full((PIXELS, PIXELS), -np.inf)
    for (a, b, c), corners in zip(points[triangles], uv):
        turn = np.array([b - a, c - a])[:, :2].T
        if abs(np.linalg.det(turn)) < 1e-12:
            continue
        weights = (at - a[:2]) @ np.linalg.inv(turn).T
        weights = np.dstack([1 - weights.sum(axis=-1), weights])
        z = weights @ np.array([a[2], b[2], c[2]])
        is_first = (weights >= 0).all(axis=-1) & (z > height)
        height[is_first] = z[is_first]
        seen[is_first] = (weights @ corners)[is_first]
    return seen


def test_a_rendered_checkerboard_is_the_one_of_the_map(tmp_path):
    mesh = cones.shape("hare", 700)
    obj = from_mesh(mesh, "hare")
    select(obj)
    obj.data.materials.append(checkerboard())
    assert bpy.ops.uv.cone_unwrap(number="COUNT", count=12) == {"FINISHED"}
    width = 2.1 * np.abs(mesh.vertices[:, :2]).max()
    picture, seen = rendered_from_above(width, tmp_path / "picture.png"), seen_from_above(obj, width)
    is_surface = ~np.isnan(seen[..., 0])
    squares = np.floor(np.nan_to_num(seen) * SQUARES).astype(int).sum(axis=-1) % 2
    is_right = (picture > 0.5) == (squares == 1)
    assert is_surface.sum() > 500 and 0.3 < squares[is_surface].mean() < 0.7
    # Rays through the sides of squares and triangles may go either way.
    assert is_right[is_surface].mean() > 0.98
