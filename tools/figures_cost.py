"""What pictures cost (shader instructions, reads, milliseconds), and how fast the path tracer is."""

import re

from figures_run import PEERS, SHADERS, compare, run
from figures_surfaces import DATA

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
