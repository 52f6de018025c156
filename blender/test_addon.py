"""Bakes a scene from Blender and exports its page:

    PATH=build/dev:$PATH blender --background --factory-startup --python blender/test_addon.py
"""

import os
import subprocess
import sys
import tempfile

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import phatextures  # noqa: E402


def build_room():
    """The cube of Blender's first scene on a glossy floor, under a lamp."""
    bpy.ops.mesh.primitive_plane_add(size=8, location=(0, 0, -1))
    floor = bpy.context.object
    floor.data.materials.append(bpy.data.materials.new("floor"))
    floor.data.materials[0].use_nodes = True
    principled = floor.data.materials[0].node_tree.nodes["Principled BSDF"]
    principled.inputs["Metallic"].default_value = 1
    principled.inputs["Roughness"].default_value = 0.3
    bpy.ops.mesh.primitive_plane_add(size=2, location=(0, 0, 4), rotation=(3.14159, 0, 0))
    lamp = bpy.data.materials.new("lamp")
    lamp.use_nodes = True
    emission = lamp.node_tree.nodes["Principled BSDF"].inputs
    emission["Emission" if "Emission" in emission else "Emission Color"].default_value = (1, 1, 1, 1)
    emission["Emission Strength"].default_value = 20
    bpy.context.object.data.materials.append(lamp)


def main():
    phatextures.register()
    build_room()
    with tempfile.TemporaryDirectory() as folder:
        blend = os.path.join(folder, "room.blend")
        assert not bpy.ops.phat.bake.poll(), "nothing to bake before the file is saved"
        bpy.ops.wm.save_as_mainfile(filepath=blend)
        bpy.context.scene.phat.texels = 40_000
        assert not bpy.ops.phat.site.poll(), "nothing to export before the bake"
        assert bpy.ops.phat.bake() == {"FINISHED"}
        info = subprocess.run(
            ["phat", "info", os.path.join(folder, "room.phat.glb"), "--json"], check=True, capture_output=True)
        assert b'"floor"' in info.stdout, info.stdout
        assert bpy.ops.phat.site() == {"FINISHED"}
        assert sorted(os.listdir(os.path.join(folder, "room-site"))) == [
            "index.html", "poster.jpg", "room.glb", "room.lamps.bin", "room.reflections.bin", "viewer.css", "viewer.js"]
        # What is baked is still a scene that Blender reads.
        bpy.ops.wm.read_homefile(use_empty=True)
        # (Flat: the importer of Debian's 3.4 asks for smooth normals by a name that its numpy has not.)
        baked = os.path.join(folder, "room.phat.glb")
        assert bpy.ops.import_scene.gltf(filepath=baked, import_shading="FLAT") == {"FINISHED"}
        meshes = sorted(o.name for o in bpy.data.objects if o.type == "MESH")
        assert meshes == ["Cube", "Plane", "Plane.001"], meshes
        layers = [len(o.data.uv_layers) for o in bpy.data.objects if o.type == "MESH"]
        assert min(layers) == 2, layers  # the file's own and the atlas
    phatextures.unregister()
    print("the add-on bakes and exports, and Blender reads what it baked")


try:
    main()
except BaseException as error:  # Blender would go on and return 0
    print(f"failed: {error!r}", file=sys.stderr)
    sys.exit(1)
