"""Bakes a scene from Blender and exports its page:

    PATH=build/dev:$PATH blender --background --factory-startup --python blender/test_addon.py
"""

import json
import math
import os
import subprocess
import sys
import tempfile

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import phatextures  # noqa: E402
from phatextures import export  # noqa: E402

numpy.bool = bool  # the glTF importer of Debian's 3.4 is older than its numpy


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


def add_area_light():
    """An ellipse of 2 m by 1 m with 100 W, in a node that is scaled by 2 along one side."""
    bpy.ops.object.light_add(type="AREA", location=(2, 0, 3))
    light = bpy.context.object
    light.name = "Soft Box"
    light.scale = (2, 1, 1)
    light.data.shape = "ELLIPSE"
    light.data.size, light.data.size_y = 2, 1
    light.data.energy = 100
    light.data.color = (1, 0.5, 0.25)
    return light


def add_hidden():
    """What Blender does not show or not render."""
    for name, hide in (("unseen", "hide_viewport"), ("unrendered", "hide_render")):
        collection = bpy.data.collections.new(name)
        bpy.context.scene.collection.children.link(collection)
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        collection.objects.link(bpy.data.objects.new(name, mesh))
        setattr(collection, hide, True)


def info_of(path):
    printed = subprocess.run(["phat", "info", path, "--json"], check=True, capture_output=True).stdout
    return json.loads(printed)


def gltf_of(path):
    with open(path, "rb") as file:
        file.seek(12)
        size = int.from_bytes(file.read(4), "little")
        file.seek(20)
        return json.loads(file.read(size))


def check_lights(gltf):
    point = gltf["extensions"]["KHR_lights_punctual"]["lights"][0]
    assert math.isclose(point["intensity"], 1000 / (4 * math.pi), rel_tol=1e-3), point
    soft = next(m for m in gltf["materials"] if m["name"].startswith("Soft Box"))
    strength = soft.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    # Of a polygon in the ellipse, the sides of which are 4 m and 1 m long.
    corners = export.DISK_CORNERS
    area = 4 * 1 / 4 * corners / 2 * math.sin(2 * math.pi / corners)
    assert math.isclose(soft["emissiveFactor"][0] * strength, 100 / (math.pi * area), rel_tol=1e-3), soft
    assert math.isclose(soft["emissiveFactor"][1] / soft["emissiveFactor"][0], 0.5, rel_tol=1e-3), soft
    assert not soft.get("doubleSided", False), "an area light shines to one side"


def check_sky(folder):
    """The World's +X, -Y and +Z are glTF's +X, +Z and +Y."""
    world = bpy.data.worlds.new("directions")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    coordinates = nodes.new("ShaderNodeTexCoord")
    links.new(coordinates.outputs["Generated"], nodes["Background"].inputs["Color"])
    bpy.context.scene.world = world
    path = export.export_sky(bpy.context, os.path.join(folder, "sky.exr"))
    image = bpy.data.images.load(path)
    width, height = image.size
    pixels = list(image.pixels)  # the lowest row first

    def at(column, row):
        start = 4 * (row * width + column)
        return pixels[start:start + 3]
    # Column 0 is at azimuth -pi, azimuth 0 is +X, pi/2 is glTF's +Z. Negative coordinates are black.
    middle, quarter = width // 2, 3 * width // 4
    assert at(middle, height // 2)[0] > 0.99 and at(quarter, height // 2)[0] < 0.1, "+X is in the middle"
    assert at(width // 4, height // 2)[1] > 0.99 and at(quarter, height // 2)[1] < 0.1, "glTF's +Z is Blender's -Y"
    assert at(middle, height - 1)[2] > 0.99 and at(middle, 0)[2] < 0.1, "up is the first row"
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    assert export.export_sky(bpy.context, os.path.join(folder, "black.exr")) is None


def check_unsaved():
    bpy.context.scene.phat.texels = 10_000
    bpy.context.scene.phat.world = False
    assert bpy.ops.phat.bake() == {"FINISHED"}
    assert info_of(os.path.join(bpy.app.tempdir, "untitled.phat.glb"))
    bpy.context.scene.phat.world = True


def main():
    phatextures.register()
    build_room()
    light = add_area_light()
    add_hidden()
    objects = sorted(o.name for o in bpy.data.objects)
    check_unsaved()
    with tempfile.TemporaryDirectory() as folder:
        blend = os.path.join(folder, "my room.blend")
        own = os.path.join(folder, "my room.glb")
        with open(own, "w") as file:
            file.write("the user's own")
        bpy.ops.wm.save_as_mainfile(filepath=blend)
        bpy.context.scene.phat.texels = 40_000
        assert not bpy.ops.phat.site.poll(), "nothing to export before the bake"
        assert bpy.ops.phat.bake() == {"FINISHED"}
        assert sorted(o.name for o in bpy.data.objects) == objects, "the scene is as it was"
        assert len(bpy.data.scenes) == 1
        with open(own) as file:
            assert file.read() == "the user's own"
        baked = os.path.join(folder, "my room.phat.glb")
        check_lights(gltf_of(baked))
        info = info_of(baked)
        assert "floor" in json.dumps(info), info
        record = info["bake"]["record"]
        assert record["settings"].get("environment") == "my room.sky.exr", record  # the World is grey
        assert bpy.ops.phat.site() == {"FINISHED"}
        assert sorted(os.listdir(os.path.join(folder, "my room-site"))) == [
            "bench.js", "chunk.js", "index.html", "lamp_panel.js", "light_updates.js", "moves.js",
            "poster.jpg", "room.glb", "room.lamps.bin", "room.reflections.bin", "viewer.css", "viewer.js"]
        check_sky(folder)
        light.data.spread = 1
        assert export.export_scene(bpy.context, os.path.join(folder, "spread.glb")) == ["the spread of the area light Soft Box"]
        # What is baked is still a scene that Blender reads.
        bpy.ops.wm.read_homefile(use_empty=True)
        assert bpy.ops.import_scene.gltf(filepath=baked) == {"FINISHED"}
        meshes = sorted(o.name for o in bpy.data.objects if o.type == "MESH")
        assert meshes == ["Cube", "Plane", "Plane.001", "Soft Box (area light)"], meshes
        layers = [len(o.data.uv_layers) for o in bpy.data.objects if o.type == "MESH"]
        assert min(layers) == 2, layers  # the file's own and the atlas
    phatextures.unregister()
    print("the add-on bakes and exports, and Blender reads what it baked")


try:
    main()
except BaseException as error:  # Blender would go on and return 0
    print(f"failed: {error!r}", file=sys.stderr)
    sys.exit(1)
