"""What pictures cost (shader instructions, reads, milliseconds), how still a pan is, and how fast the path tracer is."""

import json
import math
import re
import statistics
import struct

from figures_run import PEERS, PHAT, ROOT, SHADERS, compare, run
from figures_surfaces import DATA, TABLE, Surface

# Passes of a frame of tabletop, which has area lights: method -> [(name, file, defines)]. src/gl has the same lists.
PASSES = {
    "phat": [("lobes", "lobes.frag", ()), ("lookup", "lookup.frag", ("AREA", "SCRAMBLES")), ("pool", "pool.frag", ("AREA",)),
             ("display", "display.frag", ("LOOKUP", "AREA"))],
    "phat-pyramid": [("relight", "relight.frag", ()), ("pyramid", "pyramid.frag", ()), ("radius", "radius.frag", ()),
                     ("display", "display.frag", ("AREA",))],
    "phat-paper": [("relight", "relight_paper.frag", ()), ("pyramid", "pyramid.frag", ()), ("display", "display.frag", ("PAPER", "AREA"))],
}
FRAME = "640x360"


def instructions(shop, file, defines):
    """Of a fragment shader as SPIR-V: all functions inlined, nothing dead, loops counted once."""
    source, binary, small = (shop.path(f"shader.{end}") for end in ("frag", "spv", "small.spv"))
    run(PEERS, "shader", SHADERS / file, "-o", source, *sum((("--define", define) for define in defines), ()))
    run("glslangValidator", "-G", "--aml", "--amb", "-S", "frag", "-o", binary, source)
    run("spirv-opt", "-O", "--target-env=opengl4.5", binary, "-o", small)
    inside, count = False, 0
    for line in run("spirv-dis", "--no-color", "--raw-id", small).splitlines():
        name = re.match(r"\s*(?:%\d+ = )?(Op\w+)", line)
        if not name:
            continue
        if name.group(1) == "OpFunction":
            inside = True
        elif name.group(1) == "OpFunctionEnd":
            inside = False
        elif inside and name.group(1) not in ("OpLabel", "OpVariable", "OpName", "OpLine", "OpNoLine", "OpSelectionMerge",
                                              "OpLoopMerge"):
            count += 1
    return count


def cost(figures):
    """[{method, quality, passes: {name: ms}, instructions: {name: count}, reads}] of tabletop, all light."""
    rows = []
    for method, passes in PASSES.items():
        counts = {name: instructions(figures.shop, file, defines) for name, file, defines in passes}
        for quality in ("fast", "default", "high") if method == "phat" else (None,):
            flags = ("--quality", quality) if quality else ()
            name = f"cost-{method}-{quality}.exr"
            said = figures.picture(name, method, *flags, "--size", FRAME, "--spp", 1)
            reads = None
            if quality:
                reads = figures.picture(f"reads-{name}", method, *flags, "--size", FRAME, "--count-reads")["reads"]
            rows.append({"method": method, "quality": quality, "instructions": counts, "reads": reads,
                         "milliseconds": {key: 1e3 * value for key, value in said["seconds"].items()}})
    return rows


# --- a pan

PAN_SIZE, PAN_DEGREES = "320x180", 6.0


def with_cameras(source, target, rotations):
    """A copy of a .glb whose first camera node is repeated, turned about the vertical by so many degrees."""
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    scene = json.loads(data[20:20 + length])
    index, node = next((i, node) for i, node in enumerate(scene["nodes"]) if "camera" in node)
    x, y, z, w = node["rotation"]
    for degrees in rotations:
        s, c = math.sin(math.radians(degrees) / 2), math.cos(math.radians(degrees) / 2)
        turned = {**node, "name": f"pan{len(scene['nodes']):04d}", "rotation": [c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y]}
        for nodes in (one["nodes"] for one in scene["scenes"] if index in one["nodes"]):
            nodes.append(len(scene["nodes"]))
        scene["cameras"].append({**scene["cameras"][node["camera"]], "name": turned["name"]})
        scene["nodes"].append({**turned, "camera": len(scene["cameras"]) - 1})
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    target.write_bytes(struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") + text + rest)


def pan(figures):
    """Mean change from frame to frame over the mean, of the table's glossy indirect light at fixed pixels, while the
    camera turns: {frames, degrees, spp, path: {mean, worst}, METHOD: ...}"""
    shop, plan = figures.shop, figures.plan
    count = plan.pan_frames
    rotations = [PAN_DEGREES * (i / (count - 1) - 0.5) for i in range(count)]
    result = {"frames": count, "degrees": PAN_DEGREES, "spp": plan.pan_spp}
    surface = Surface("pan", "tabletop", PAN_SIZE, (), "")
    # Pixels in the middle of the table, which show it in all frames.
    mask = shop.path("pan-mask.exr")
    window = (195, 105, 70, 25)
    thin = shop.path("pan-thin.exr")
    shop.make(mask.name, PEERS, "mask", ROOT / "scenes/tabletop.glb", "--material", TABLE, "--size", PAN_SIZE, "--window", *window,
              keep=True)
    shop.make(thin.name, PEERS, "thin", mask, "--count", 300, keep=True)
    for method in ("path", "phat", "phat-pyramid"):
        baked = method != "path"
        scene = shop.path(f"pan{'.phat' if baked else ''}.glb")
        with_cameras(figures.bake()[0] if baked else ROOT / "scenes/tabletop.glb", scene, rotations)
        flags = () if baked else ("--pixels", thin)
        shop.make(f"pan-{method}.json", PHAT, "render", scene, "--method", method, "--camera", "all", "--size", PAN_SIZE,
                  "--component", "glossy-indirect", "--pixel-filter", "center", "--spp", 1 if baked else plan.pan_spp, *flags,
                  "--json", "--quiet", keep=not baked, output=shop.path(f"pan-{method}.exr"))
        frames = sorted(shop.folder.glob(f"pan-{method}.pan*.exr"))
        changes = [compare(b, a, thin)["maeOverMean"] for a, b in zip(frames, frames[1:])]
        result[method] = {"mean": statistics.mean(changes), "worst": max(changes)}
    return result


# --- the path tracer's speed

def path_speed(figures):
    """Samples and seconds to a relMSE of .01 against Cycles' tabletop, from a picture of fewer: the error of a mean of n
    samples falls with 1 / n. {spp, relMse, seconds, samples, secondsToError}"""
    spp = figures.plan.whole_spp
    said = figures.picture("whole-tabletop-path.exr", "path", "--spp", spp, "--size", "480x270", keep=True)
    found = compare(figures.shop.path("whole-tabletop-path.exr"), DATA / "tabletop-spec.exr")["relMse"]
    samples = spp * found / 0.01
    return {"spp": spp, "relMse": found, "seconds": said["seconds"], "guideSeconds": said["guideSeconds"], "samples": samples,
            "secondsToError": said["guideSeconds"] + samples * said["seconds"] / spp}
