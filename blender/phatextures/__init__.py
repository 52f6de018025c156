"""Bakes the scene with the program `phat`, opens the result and exports it as a page.

Everything is done by the program; this panel writes the scene as glTF and calls it.
"""

import os
import shutil
import subprocess

import bpy

from . import export

bl_info = {  # for Blender before 4.2; later ones read blender_manifest.toml
    "name": "PHATextures",
    "author": "The authors of PHATextures",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > PHATextures",
    "description": "Bake a room's light for the web and for realtime, reflections included",
    "category": "Render",
}


def program(context):
    """The path of `phat`: from the preferences, else from PATH; None if there is none."""
    addon = context.preferences.addons.get(__package__)
    chosen = bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else "phat"
    return shutil.which(chosen)


def name():
    return os.path.splitext(os.path.basename(bpy.data.filepath))[0] or "untitled"


def output_path(suffix):
    """Beside the file; of a file that was never saved, in Blender's temporary folder."""
    return os.path.join(os.path.dirname(bpy.data.filepath) or bpy.app.tempdir, name() + suffix)


def baked_path():
    return output_path(".phat.glb")


def sky_arguments(context):
    settings = context.scene.phat
    if settings.environment:
        return ["--environment", bpy.path.abspath(settings.environment)]
    sky = export.export_sky(context, export.sky_path(name())) if settings.world else None
    return ["--environment", sky] if sky else []


class PhatSettings(bpy.types.PropertyGroup):
    texels: bpy.props.IntProperty(
        name="Texels", description="Of the whole atlas; more are sharper and slower",
        default=1_000_000, min=10_000, max=64_000_000)
    samples: bpy.props.IntProperty(
        name="Samples", description="PHATexels a texel", default=1, min=1, max=8)
    environment: bpy.props.StringProperty(
        name="Sky", description="A latitude-longitude picture, .hdr or .exr, in place of the World",
        subtype="FILE_PATH")
    world: bpy.props.BoolProperty(
        name="World", description="The World lights the scene, as in Blender's renders", default=True)


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
        return program(context) is not None

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
        scene_path = export.scene_path(name())
        for dropped in export.export_scene(context, scene_path):
            self.report({"WARNING"}, f"Not exported: {dropped}")
        settings = context.scene.phat
        self.done = f"Baked: {baked_path()}"
        if not bpy.data.filepath:
            self.report({"WARNING"}, "The file was never saved: the bake is deleted when Blender quits")
        return self.start(context, [
            "bake", scene_path, "-o", baked_path(), "--quiet", "--resolution", str(settings.texels),
            "--samples", str(settings.samples), *sky_arguments(context)])


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
        site = output_path("-site")
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
            layout.label(text="Save the file to keep its bake", icon="INFO")
        settings = context.scene.phat
        for setting in ("texels", "samples", "world", "environment"):
            layout.prop(settings, setting)
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
