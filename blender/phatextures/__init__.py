"""Bakes the scene with the program `phat`, opens the result and exports it as a page.

Everything is done by the program; this panel writes the scene as glTF and calls it.
"""

import os
import shutil
import subprocess

import bpy

bl_info = {  # for Blender before 4.2; later ones read blender_manifest.toml
    "name": "PHATextures",
    "author": "The authors of PHATextures",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > PHATextures",
    "description": "Bake a room's light for the web and for realtime, reflections included",
    "category": "Render",
}

LOST = {"AREA": "area lights (use a mesh with an emissive material)"}


def program(context):
    """The path of `phat`: from the preferences, else from PATH; None if there is none."""
    addon = context.preferences.addons.get(__package__)
    chosen = bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else "phat"
    return shutil.which(chosen)


def path_beside_blend(suffix):
    return os.path.splitext(bpy.data.filepath)[0] + suffix


def baked_path():
    return path_beside_blend(".phat.glb")


def export_scene(path):
    """Writes the scene as phat wants it: with cameras and lights, and lights without photometric factors."""
    options = {
        "filepath": path,
        "export_format": "GLB",
        "export_cameras": True,
        "export_lights": True,
        "export_apply": True,
        "export_animations": False,
        "export_import_convert_lighting_mode": "RAW",
    }
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    bpy.ops.export_scene.gltf(**{key: value for key, value in options.items() if key in known})


def lost_in_export(scene):
    kinds = {o.data.type for o in scene.objects if o.type == "LIGHT" and o.visible_get()}
    return [text for kind, text in LOST.items() if kind in kinds]


def bake_arguments(settings):
    arguments = ["--resolution", str(settings.texels), "--samples", str(settings.samples)]
    if settings.environment:
        arguments += ["--environment", bpy.path.abspath(settings.environment)]
    return arguments


class PhatSettings(bpy.types.PropertyGroup):
    texels: bpy.props.IntProperty(
        name="Texels", description="Of the whole atlas; more are sharper and slower",
        default=1_000_000, min=10_000, max=64_000_000)
    samples: bpy.props.IntProperty(
        name="Samples", description="PHATexels a texel", default=1, min=1, max=8)
    environment: bpy.props.StringProperty(
        name="Sky", description="A latitude-longitude picture, .hdr or .exr; none: black", subtype="FILE_PATH")


class PhatPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program", description="Where phat is; empty: found by itself", subtype="FILE_PATH")

    def draw(self, _context):
        self.layout.prop(self, "program")


class PhatOperator:
    """An operator that runs phat while Blender stays usable; Escape stops it."""

    @classmethod
    def poll(cls, context):
        return bool(bpy.data.filepath) and program(context) is not None

    def start(self, context, arguments):
        self.process = subprocess.Popen(
            [program(context), *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if bpy.app.background:
            return self.finish(self.process.communicate()[1])
        self.timer = context.window_manager.event_timer_add(0.5, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set(f"{self.bl_label}: Escape stops")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.process.terminate()
        elif event.type != "TIMER" or self.process.poll() is None:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)
        return self.finish(self.process.communicate()[1])

    def finish(self, complaint):
        if self.process.returncode == 0:
            self.report({"INFO"}, self.done)
            return {"FINISHED"}
        lines = complaint.strip().splitlines() or ["phat was stopped"]
        self.report({"ERROR"}, lines[-1])
        return {"CANCELLED"}


class PHAT_OT_bake(PhatOperator, bpy.types.Operator):
    bl_idname = "phat.bake"
    bl_label = "Bake"
    bl_description = "Write the scene as glTF and bake its light"

    def execute(self, context):
        scene_path = path_beside_blend(".glb")
        export_scene(scene_path)
        for lost in lost_in_export(context.scene):
            self.report({"WARNING"}, f"Not exported: {lost}")
        self.done = f"Baked: {baked_path()}"
        arguments = bake_arguments(context.scene.phat)
        return self.start(context, ["bake", scene_path, "-o", baked_path(), "--quiet", *arguments])


class PHAT_OT_open(bpy.types.Operator):
    bl_idname = "phat.open"
    bl_label = "Open"
    bl_description = "Walk through the bake"

    @classmethod
    def poll(cls, context):
        return PhatOperator.poll(context) if os.path.exists(baked_path()) else False

    def execute(self, context):
        subprocess.Popen([program(context), "view", baked_path()])
        return {"FINISHED"}


class PHAT_OT_site(PhatOperator, bpy.types.Operator):
    bl_idname = "phat.site"
    bl_label = "Export Page"
    bl_description = "Write a folder that any web server can host"

    @classmethod
    def poll(cls, context):
        return PhatOperator.poll(context) if os.path.exists(baked_path()) else False

    def execute(self, context):
        site = path_beside_blend("-site")
        self.done = f"Written: {site}"
        return self.start(context, ["web", baked_path(), "-o", site, "--quiet"])


class PHAT_PT_panel(bpy.types.Panel):
    bl_label = "PHATextures"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "PHATextures"

    def draw(self, context):
        layout = self.layout
        if program(context) is None:
            layout.label(text="phat is not found: see the preferences", icon="ERROR")
        elif not bpy.data.filepath:
            layout.label(text="Save the file first", icon="INFO")
        settings = context.scene.phat
        for name in ("texels", "samples", "environment"):
            layout.prop(settings, name)
        for operator in (PHAT_OT_bake, PHAT_OT_open, PHAT_OT_site):
            layout.operator(operator.bl_idname)


CLASSES = (PhatSettings, PhatPreferences, PHAT_OT_bake, PHAT_OT_open, PHAT_OT_site, PHAT_PT_panel)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.phat = bpy.props.PointerProperty(type=PhatSettings)


def unregister():
    del bpy.types.Scene.phat
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
