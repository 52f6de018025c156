"""The scene as phat wants it: a glTF file, and the World as a latitude-longitude picture.

The glTF exporter drops what the format has no word for: area lights and the World. Area lights are written as meshes
that emit light, the World is rendered.
"""

import contextlib
import math
import os

import bpy

SKY_WIDTH = 2048  # pixels; the sun of a sky texture is three wide
PLAIN_SKY_WIDTH = 64  # of a World without textures
DISK_CORNERS = 48


def export_scene(context, path):
    """Writes the visible objects that render, with cameras and lights; returns what could not be written, in words."""
    options = {
        "filepath": path,
        "export_format": "GLB",
        "export_cameras": True,
        "export_lights": True,
        "export_extras": True,  # custom properties, by which the page of phat web knows what may be moved
        "export_apply": True,
        "export_animations": False,
        "use_visible": True,
        "use_renderable": True,
        "use_active_scene": True,
        # Watts become W/sr and W/m2, without a factor of 683. The name is one of Blender 3.4 or of later ones.
        "convert_lighting_mode": "COMPAT",
        "export_import_convert_lighting_mode": "COMPAT",
    }
    known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    with area_light_meshes(context.scene):
        bpy.ops.export_scene.gltf(**{key: value for key, value in options.items() if key in known})
    return not_exported(context.scene)


def export_sky(context, path):
    """Renders the World of the scene; returns the path, or None for a World without light."""
    world = context.scene.world
    if world is None:
        return None
    scene = bpy.data.scenes.new("phat sky")
    camera = bpy.data.cameras.new("phat sky")
    eye = bpy.data.objects.new("phat sky", camera)
    try:
        scene.collection.objects.link(eye)
        scene.camera = eye
        scene.world = world
        camera.type = "PANO"
        (camera if hasattr(camera, "panorama_type") else camera.cycles).panorama_type = "EQUIRECTANGULAR"
        # Its middle column is +X, as in phat's environments; glTF's Z is Blender's -Y.
        eye.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
        render_to(scene, path, SKY_WIDTH if has_texture(world) else PLAIN_SKY_WIDTH)
    finally:
        bpy.data.objects.remove(eye)
        bpy.data.cameras.remove(camera)
        bpy.data.scenes.remove(scene)
    return path if has_light(path) else None


def render_to(scene, path, width):
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = width, width // 2
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = False
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True, scene=scene.name)


def has_texture(world):
    return world.use_nodes and any(node.type.startswith("TEX_") for node in world.node_tree.nodes)


def has_light(path):
    image = bpy.data.images.load(path)
    try:
        values = [0.0] * len(image.pixels)
        image.pixels.foreach_get(values)
        return any(value > 0 for channel in range(3) for value in values[channel::4])
    finally:
        bpy.data.images.remove(image)


def exported_lights(scene):
    return [o for o in scene.objects if o.type == "LIGHT" and o.visible_get() and not o.hide_render]


def not_exported(scene):
    spread = [o.name for o in exported_lights(scene) if o.data.type == "AREA" and o.data.spread < math.pi - 1e-3]
    return [f"the spread of the area light {name}" for name in spread]


@contextlib.contextmanager
def area_light_meshes(scene):
    """While it lasts, a mesh that emits the same light stands in the place of each area light."""
    meshes = []
    try:
        for light in exported_lights(scene):
            if light.data.type == "AREA":
                meshes.append(emissive_mesh(light))
                scene.collection.objects.link(meshes[-1])
        yield
    finally:
        for stand_in in meshes:
            mesh = stand_in.data
            material = mesh.materials[0]
            bpy.data.objects.remove(stand_in)
            bpy.data.meshes.remove(mesh)
            bpy.data.materials.remove(material)


def emissive_mesh(light):
    """A flat mesh of the light's shape. A Lambertian emitter of P watts and area A has the radiance P / (pi A)."""
    corners = corners_of(light.data)
    mesh = bpy.data.meshes.new(light.name)
    mesh.from_pydata(corners, [], [range(len(corners))])
    placed = light.matrix_world
    mesh_in_world = mesh.copy()
    mesh_in_world.transform(placed)
    area = mesh_in_world.polygons[0].area
    bpy.data.meshes.remove(mesh_in_world)

    watts = light.data.energy * 2 ** getattr(light.data, "exposure", 0.0)
    mesh.materials.append(emissive_material(light.name, light.data.color, watts / (math.pi * area) if area > 0 else 0))
    stand_in = bpy.data.objects.new(f"{light.name} (area light)", mesh)
    stand_in.matrix_world = placed
    return stand_in


def corners_of(light):
    """Counter-clockwise seen from below: area lights shine along -Z."""
    width = light.size
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    if light.shape in {"SQUARE", "RECTANGLE"}:
        unit = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)]
    else:
        angles = [-2 * math.pi * i / DISK_CORNERS for i in range(DISK_CORNERS)]
        unit = [(0.5 * math.cos(a), 0.5 * math.sin(a)) for a in angles]
    return [(width * x, height * y, 0) for x, y in unit]


def emissive_material(name, color, radiance):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (*color, 1)
    emission.inputs["Strength"].default_value = radiance
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(emission.outputs["Emission"], output.inputs["Surface"])
    return material


def scene_path(name):
    """Where the exported scene waits for the bake: not beside the user's files, which it must not overwrite."""
    return os.path.join(bpy.app.tempdir, name + ".glb")


def sky_path(name):
    return os.path.join(bpy.app.tempdir, name + ".sky.exr")
