"""The operator, and where it stands in menus."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

import cones

from . import exchange

#: Blender's cursor counts up to this.
WHOLE = 1000
#: How far the work is when a stage begins, as it was on scans of 100 thousand vertices.
BEGINS = {"prepare": 0.0, "factor": 0.1, "hierarchy": 0.3, "curvature": 0.5, "cut": 0.55, "scale": 0.6, "layout": 0.8, "islands": 0.85, "pack": 0.9}


class UV_OT_cone_unwrap(bpy.types.Operator):
    """Unwrap the selected meshes conformally: with few cones, without overlap, packed"""

    bl_idname = "uv.cone_unwrap"
    bl_label = "Cone Unwrap"
    bl_options = {"REGISTER", "UNDO"}

    number: EnumProperty(
        name="Cones",
        items=[
            ("AUTOMATIC", "Automatic", "As few as keep the area distortion within the bound"),
            ("COUNT", "Number", "So many on each object"),
            ("SELECTED", "Selected Vertices", "The selected vertices, in edit mode"),
        ],
        default="AUTOMATIC",
    )
    count: IntProperty(name="Number", description="How many cones each object gets", default=8, min=0, soft_max=64)
    distortion: FloatProperty(
        name="Area Distortion",
        description="The mean ratio of areas, made sure of by unwrapping, that the number of cones is chosen for",
        default=1.25,
        min=1.001,
        soft_max=3.0,
    )
    islands: EnumProperty(
        name="Islands",
        items=[
            ("overlap-free", "Without Overlap", "Cut where the layout would lie over itself"),
            ("pack", "Fill", "Cut further where islands then fill more of the square"),
            ("single", "One", "One island for each part, even if it lies over itself"),
        ],
        default="overlap-free",
    )
    margin: FloatProperty(name="Margin", description="Texels between islands", default=4.0, min=0.0, soft_max=64.0)
    texture_size: IntProperty(name="Texture Size", description="Side of the texture in texels", default=1024, min=16, soft_max=8192)
    use_seams: BoolProperty(name="Respect Seams", description="Cut along edges that are marked as seams", default=True)
    mark_seams: BoolProperty(name="Mark Seams", description="Mark the edges that are cut as seams", default=True)

    @classmethod
    def poll(cls, context):
        return bool(_objects(context))

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "number")
        if self.number == "COUNT":
            layout.prop(self, "count")
        if self.number == "AUTOMATIC":
            layout.prop(self, "distortion")
        for name in ("islands", "margin", "texture_size", "use_seams", "mark_seams"):
            layout.prop(self, name)

    def execute(self, context):
        objects = _objects(context)
        done, refused = [], []
        progress = context.window_manager
        progress.progress_begin(0, WHOLE)
        try:
            for k, obj in enumerate(objects):
                try:
                    done.append((obj, self._unwrap(obj, _Cursor(progress, k, len(objects)))))
                except cones.Error as error:
                    refused.append(f"{obj.name}: {error}")
        finally:
            progress.progress_end()
        for obj, result in done:
            for warning in result.warnings:
                self.report({"INFO"}, f"{obj.name}: {warning}")
        if not done:
            self.report({"ERROR"}, "\n".join(refused))
            return {"CANCELLED"}
        for sentence in refused:
            self.report({"WARNING"}, sentence)
        self.report({"INFO"}, _summary([result for _, result in done]))
        return {"FINISHED"}

    def _unwrap(self, obj, progress):
        mesh = exchange.read(obj)
        which = {"max_distortion": self.distortion} if self.number == "AUTOMATIC" and self.distortion != 1.25 else {}
        if self.number == "COUNT":
            which = {"n": self.count}
        if self.number == "SELECTED":
            if obj.mode != "EDIT":
                raise cones.Error("cones are taken from selected vertices in edit mode")
            which = {"cones": exchange.selected_vertices(obj)}
        result = cones.unwrap(
            mesh,
            **which,
            keep_seams=exchange.marked_seams(obj) if self.use_seams else False,
            islands=self.islands,
            margin=self.margin,
            texture_size=self.texture_size,
            progress=progress,
        )
        exchange.write(obj, result.uv, result.seam_edges if self.mark_seams else [])
        return result


class _Cursor:
    """Shows how far the work on one of several objects is."""

    def __init__(self, manager, k, count):
        self.manager, self.k, self.count, self.most = manager, k, count, 0.0

    def __call__(self, stage, fraction):
        begins = BEGINS.get(stage, 0.0)
        self.most = max(self.most, begins + 0.1 * (fraction or 0.0))
        self.manager.progress_update(int(WHOLE * (self.k + self.most) / self.count))


def _objects(context):
    """The meshes that are worked on, each once."""
    if context.mode == "EDIT_MESH":
        return list(context.objects_in_mode_unique_data)
    if context.mode != "OBJECT":
        return []
    by_data = {obj.data: obj for obj in context.selected_objects if obj.type == "MESH"}
    return list(by_data.values())


def _summary(results):
    count = sum(len(result.report["cones"]) for result in results)
    islands = sum(result.island_count for result in results)
    worst = max(result.distortion["area_mean"] for result in results)
    many = f"{len(results)} meshes, " if len(results) > 1 else ""
    return f"{many}{count} cones, {islands} islands, area distortion {worst:.2f}"


def _menu(self, context):
    self.layout.separator()
    self.layout.operator(UV_OT_cone_unwrap.bl_idname)


#: In edit mode *UV*, in the UV editor *UV > Unwrap*, in object mode *Object*.
MENUS = ("VIEW3D_MT_uv_map", "IMAGE_MT_uvs_unwrap", "VIEW3D_MT_object")


def register():
    """Makes the operator known and puts it into menus."""
    bpy.utils.register_class(UV_OT_cone_unwrap)
    for menu in MENUS:
        if hasattr(bpy.types, menu):
            getattr(bpy.types, menu).append(_menu)


def unregister():
    """Takes it away again."""
    for menu in MENUS:
        if hasattr(bpy.types, menu):
            getattr(bpy.types, menu).remove(_menu)
    bpy.utils.unregister_class(UV_OT_cone_unwrap)
