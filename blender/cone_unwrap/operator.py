"""The operator, and where it stands in menus."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

import cones

from . import exchange
from .work import Work

#: Blender's cursor counts up to this.
WHOLE = 1000
#: Seconds between two looks at the work.
INTERVAL = 0.1
#: What one may do while the work runs: nothing of it changes a mesh.
LOOKING_ROUND = {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "WINDOW_DEACTIVATE"}


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
    free_seams: EnumProperty(
        name="Free Seams",
        description="Whether the two sides of a seam may differ, for less distortion",
        items=[
            ("auto", "Automatic", "Where triangles are coarse for what they bend"),
            ("never", "Never", "Both sides of a seam fit"),
            ("always", "Always", "Less distortion everywhere, for seams that do not fit"),
        ],
        default="auto",
    )
    rotations: EnumProperty(
        name="Rotations",
        description="How islands are turned to be packed",
        items=[
            ("any", "Any", "By any angle"),
            ("quarter", "Quarter Turns", "Straight sides lie along the axes, turned by quarters"),
            ("none", "None", "Straight sides lie along the axes"),
        ],
        default="any",
    )
    margin: FloatProperty(name="Margin", description="Texels between islands", default=4.0, min=0.0, soft_max=64.0)
    texture_size: IntProperty(name="Texture Size", description="Side of the texture in texels", default=1024, min=16, soft_max=8192)
    fill_holes: BoolProperty(
        name="Fill Small Holes", description="Unwrap as if small holes were filled, so that seams need not run to them. The mesh keeps its holes", default=False
    )
    use_seams: BoolProperty(name="Respect Seams", description="Cut along edges that are marked as seams", default=True)
    mark_seams: BoolProperty(name="Mark Seams", description="Mark the edges that are cut as seams", default=True)
    triangulate: BoolProperty(name="Triangulate", description="Cut polygons into the triangles that the map is computed with", default=False)

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
        for name in ("islands", "free_seams", "rotations", "margin", "texture_size", "fill_holes", "use_seams", "mark_seams", "triangulate"):
            layout.prop(self, name)

    def invoke(self, context, event):
        """From a menu: beside Blender, which can be looked around in; Esc stops it."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._begin(context)
        self.work = Work(self.jobs)
        self.work.start()
        self.timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Looks up now and then whether the work is done."""
        if event.type == "ESC":
            self.cancel(context)
            self.report({"INFO"}, "Cone Unwrap was stopped; nothing is changed")
            return {"CANCELLED"}
        if event.type in LOOKING_ROUND:
            return {"PASS_THROUGH"}
        if event.type != "TIMER":
            # Meshes must stay as they were read.
            return {"RUNNING_MODAL"}
        context.window_manager.progress_update(int(WHOLE * self.work.fraction))
        context.workspace.status_text_set(f"Cone Unwrap   {100 * self.work.fraction:.0f} %   {self.work.stage}   Esc stops")
        try:
            if not self.work.is_done():
                return {"RUNNING_MODAL"}
        except BaseException:
            self._end(context)
            raise
        self._end(context)
        return self._finish()

    def cancel(self, context):
        """Stops the work: by Esc, or because Blender is closed."""
        self.work.stop()
        self._end(context)

    def execute(self, context):
        """From a script, without a window, or with other options from the panel of the last operation: Blender waits."""
        self._begin(context)
        manager = context.window_manager
        self.work = Work(self.jobs, lambda fraction: manager.progress_update(int(WHOLE * fraction)))
        try:
            self.work.run()
        finally:
            self._end(context)
        return self._finish()

    def _begin(self, context):
        self.timer = None
        self.parts, self.jobs, self.refused = [], [], []
        for obj in _objects(context):
            try:
                part = self._part(obj)
                if part is not None:
                    self.jobs.append((obj.name, self._keywords(part)))
                    self.parts.append(part)
            except cones.Error as error:
                self.refused.append(f"{obj.name}: {error}")
        if not self.parts and not self.refused:
            self.refused.append("no face is selected: select those that are to be unwrapped")
        context.window_manager.progress_begin(0, WHOLE)

    def _end(self, context):
        context.window_manager.progress_end()
        if self.timer is not None:
            context.window_manager.event_timer_remove(self.timer)
            context.workspace.status_text_set(None)
            self.timer = None

    def _finish(self):
        """Writes what came out, and tells of it."""
        done, told, warnings = [], [], []
        for part, outcome in zip(self.parts, self.work.outcomes):
            obj = part.obj
            if isinstance(outcome, cones.Error):
                self.refused.append(f"{obj.name}: {outcome}")
                continue
            exchange.write(part, outcome.uv, outcome.seam_edges if self.mark_seams else None)
            if self.triangulate:
                exchange.triangulate(part, outcome.triangles)
            done.append(outcome)
            repairs = [repair["text"] for repair in outcome.report["repairs"]]
            told += [f"{obj.name}: {sentence}" for sentence in [*repairs, *_of_scale(obj)]]
            warnings += [f"{obj.name}: {sentence}" for sentence in outcome.warnings]
        if not done:
            self.report({"ERROR"}, "\n".join(self.refused))
            return {"CANCELLED"}
        for sentence in [*told, _summary(done)]:
            self.report({"INFO"}, sentence)
        # Last, as the status bar shows what was said last.
        for sentence in [*warnings, *self.refused]:
            self.report({"WARNING"}, sentence)
        return {"FINISHED"}

    def _part(self, obj):
        """What is unwrapped of an object: in edit mode its selected faces, or nothing if there are none."""
        if not obj.data.is_editable:
            raise cones.Error("its mesh is linked from another file and cannot be written: make it local (Object > Relations > Make Local)")
        if obj.mode != "EDIT" or self.number == "SELECTED":
            return exchange.Part(obj)
        faces = exchange.selected_faces(obj)
        return None if faces.size and not faces.any() else exchange.Part(obj, faces)

    def _keywords(self, part):
        """What is asked of the library for a part of an object."""
        obj = part.obj
        which = {"max_distortion": self.distortion} if self.number == "AUTOMATIC" and self.distortion != 1.25 else {}
        if self.number == "COUNT":
            which = {"n": self.count}
        if self.number == "SELECTED":
            if obj.mode != "EDIT":
                raise cones.Error("cones are taken from selected vertices in edit mode")
            which = {"cones": exchange.selected_vertices(obj)}
        return {
            "vertices": part.mesh,
            **which,
            "keep_seams": part.marked_seams() if self.use_seams else False,
            "islands": self.islands,
            "free_seams": self.free_seams,
            "rotations": self.rotations,
            "fill_holes": self.fill_holes,
            "margin": self.margin,
            "texture_size": self.texture_size,
        }


def _objects(context):
    """The meshes that are worked on, each once."""
    if context.mode == "EDIT_MESH":
        return list(context.objects_in_mode_unique_data)
    if context.mode != "OBJECT":
        return []
    by_data = {obj.data: obj for obj in context.selected_objects if obj.type == "MESH"}
    return list(by_data.values())


def _of_scale(obj):
    """What Blender's own Unwrap says where it matters."""
    sizes = [abs(size) for size in obj.scale]
    if max(sizes) - min(sizes) > 1e-4 * max(sizes):
        yield "it has non-uniform scale, and is unwrapped without it: apply the scale first (Object > Apply > Scale)"


def _summary(results):
    count = sum(len(result.report["cones"]) for result in results)
    islands = sum(result.island_count for result in results)
    worst = max(result.distortion["area_mean"] for result in results)
    many = f"{len(results)} meshes, " if len(results) > 1 else ""
    cones_and_islands = f"{count} {'cone' if count == 1 else 'cones'}, {islands} {'island' if islands == 1 else 'islands'}"
    return f"{many}{cones_and_islands}, area distortion {worst:.2f}"


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
