#!/usr/bin/env python3
"""Dynamic lighting: the error over time after an object has moved, and what updates cost the window.

usage: figures_live.py      writes that section of docs/results.md and its plot anew; figures.py does so, too

The crate of `scenes/tabletop.glb` jumps to the left; frames with a fixed number of rays each follow. The reference is the
path tracer's of the new state, at pixels scattered over the table top.
"""

import json
import math
import re
import struct

from figures_plot import line_plot
from figures_run import LIVE, PEERS, PHAT, ROOT, Workshop, compare, table

METERS = -0.2
SIZE = "480x270"
TEXELS = "1048576"
WORK, FRAMES = 1_500_000, 24  # rays a frame
DRAWN = ("--size", SIZE, "--spp", 8, "--pixel-filter", "center", "--reflections", "lookup")
PIXELS, SPP = 1500, 2048  # of the reference
GHOST = (192, 128, 34, 70)  # x, y, width, height: where the crate stood and was reflected
GHOST_PIXELS = 600
TITLE = "## Dynamic lighting"


def with_crate(source, target, jumps):
    """A copy of the tabletop whose crate has moved, or (`jumps`) does so after a second."""
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, binary = json.loads(data[20:20 + length]), bytearray(data[28 + length:])
    index, crate = next((i, node) for i, node in enumerate(gltf["nodes"]) if node["name"] == "crate")
    x, y, z = crate["translation"]
    if jumps:
        offset = len(binary)
        binary += struct.pack("<2f6f", 0, 1, x, y, z, x + METERS, y, z)
        gltf["bufferViews"] += [{"buffer": 0, "byteOffset": offset, "byteLength": 8}, {"buffer": 0, "byteOffset": offset + 8, "byteLength": 24}]
        gltf["accessors"] += [{"bufferView": len(gltf["bufferViews"]) - 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
                              {"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, "count": 2, "type": "VEC3"}]
        keys = len(gltf["accessors"]) - 2
        gltf["animations"] = [{"name": "jump", "samplers": [{"input": keys, "output": keys + 1, "interpolation": "STEP"}],
                               "channels": [{"sampler": 0, "target": {"node": index, "path": "translation"}}]}]
    else:
        crate["translation"] = [x + METERS, y, z]
    gltf["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(gltf, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    target.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") + text
                       + struct.pack("<I4s", len(binary), b"BIN\0") + bytes(binary))


def errors(picture, reference, variance, mask):
    found = compare(picture, reference, mask, variance=variance)
    return {"clean": math.sqrt(max(found["maeOverMean"] ** 2 - found["noise"] ** 2, 0)), "bias": found["bias"], "noise": found["noise"]}


def live(shop):
    """{before, frames: [{rays, seconds, table, ghost}], bake: {table, ghost, seconds, rays}, cost}"""
    scene = ROOT / "scenes/tabletop.glb"
    jumping, moved = shop.path("live-jumping.glb"), shop.path("live-moved.glb")
    with_crate(scene, jumping, True)
    with_crate(scene, moved, False)
    parts = {}
    for name, count, window in (("table", PIXELS, ()), ("ghost", GHOST_PIXELS, ("--window", *GHOST))):
        whole, thin = f"live-mask-{name}.exr", f"live-thin-{name}.exr"
        shop.make(whole, PEERS, "mask", moved, "--material", "table_top", "--size", SIZE, *window, keep=True)
        shop.make(thin, PEERS, "thin", shop.path(whole), "--count", count, keep=True)
        reference, variance = f"live-reference-{name}.exr", shop.path(f"live-variance-{name}.exr")
        shop.make(reference, PHAT, "render", moved, "--method", "path", "--size", SIZE, "--pixel-filter", "center", "--spp", SPP, "--seed", 11,
                  "--pixels", shop.path(thin), "--variance", variance, "--json", "--quiet", keep=True)
        parts[name] = (shop.path(reference), variance, shop.path(thin))

    def measured(picture):
        return {name: errors(picture, *part) for name, part in parts.items()}

    bakes = {}
    for name, source in (("jumping", jumping), ("moved", moved)):
        bakes[name] = shop.make(f"live-{name}.phat.glb", PHAT, "bake", source, "--resolution", TEXELS, "--json", "--quiet")
    shop.make("live-bake.exr", PHAT, "render", shop.path("live-moved.phat.glb"), *DRAWN, "--json", "--quiet")
    said = shop.make("live-frames.json", PHAT, "render", shop.path("live-jumping.phat.glb"), "--animate", f"0:{FRAMES}", "--fps", 1,
                     "--work-per-frame", WORK, *DRAWN, "--json", "--quiet", output=shop.path("live-frame.exr"))
    frames, rays, seconds = [], 0, 0.0
    for i, frame in enumerate(said):
        rays += frame["work"]
        seconds += frame["seconds"]["follow"] + frame["seconds"]["move"] + frame["seconds"]["upload"]
        frames.append({"rays": rays, "seconds": seconds, **measured(shop.path(f"live-frame.{i:04}.exr"))})
    small = shop.path("live-256k.phat.glb")
    shop.make(small.name, PHAT, "bake", scene, "--resolution", "256k", "--json", "--quiet")
    shop.make("live-cost.json", LIVE, small)
    bake = {**measured(shop.path("live-bake.exr")), "rays": bakes["moved"]["rays"], "seconds": bakes["moved"]["seconds"]}
    return {"before": frames[0], "frames": frames[1:], "bake": bake, "cost": json.loads(shop.path("live-cost.json").read_text())}


def plot_live(path, result):
    first, last = result["frames"][0]["rays"], result["frames"][-1]["rays"]
    bake = result["bake"]["table"]["clean"]
    goal = [(first / 1e6, 1), (last / 1e6, 1)]
    line_plot(path, {
        "table top": [(f["rays"] / 1e6, f["table"]["clean"] / bake) for f in result["frames"]],
        "where the crate stood": [(f["rays"] / 1e6, f["ghost"]["clean"] / result["bake"]["ghost"]["clean"]) for f in result["frames"]],
        "a full bake (dashed)": goal,
    }, "million rays since the crate moved", "MAE / mean, in multiples of a full bake's", log_y=True)


def live_section(result):
    bake, cost = result["bake"], result["cost"]

    def row(rays, seconds, at):
        times = at["table"]["clean"] / bake["table"]["clean"]
        return [rays, seconds, f"{at['table']['clean']:.4f}", f"{times:.2f}", f"{at['table']['bias']:+.3f}", f"{at['ghost']['clean']:.4f}",
                f"{at['ghost']['bias']:+.3f}"]

    body = [row("before", "", result["before"])]
    body += [row(f"{at['rays'] / 1e6:.1f}", f"{at['seconds']:.1f}", at) for i, at in enumerate(result["frames"]) if i < 6 or i % 3 == 2]
    body.append(row(f"a bake, {bake['rays'] / 1e6:.0f}", f"{bake['seconds']:.1f}", bake))
    idle, updating, renewal, full = cost["idle"], cost["updating"], cost["renewal"], cost["bake"]
    frames = table(["frames of 640x360", "number", "median, ms", "95th percentile, ms"],
                   [["at rest", idle["frames"], f"{idle['medianMs']:.0f}", f"{idle['p95Ms']:.0f}"],
                    ["during updates", updating["frames"], f"{updating['medianMs']:.0f}", f"{updating['p95Ms']:.0f}"],
                    ["ratio", "", f"{updating['medianMs'] / idle['medianMs']:.2f}", f"{updating['p95Ms'] / idle['p95Ms']:.2f}"]])
    return f"""{TITLE}

The crate of `scenes/tabletop.glb` jumps {-100 * METERS:.0f} cm to the left; `phat render --animate` follows with {WORK / 1e6:g} million rays a frame, from a
bake of about a million texels. All light at the middles of {PIXELS} pixels of the table top, and of {GHOST_PIXELS} in a window of
{GHOST[2]}x{GHOST[3]} where the crate and its reflection were, against `path` with {SPP} samples in the new state, whose noise is removed;
8 samples a pixel, all looked up: traced reflections would show the crate at its new position before its light is updated. Seconds are those of the incremental baker on both cores under their other load.

{table(["million rays", "s", "table: MAE/mean", "of the bake's", "bias", "old position: MAE/mean", "bias"], body)}

![](figures/live.svg)

Cost of updates in the window (`phat_live`): drawing has one core, the baker the other; the crate moves back and forth, a quarter
of a million texels. Frames at rest and frames during updates are measured in turn. The machine's load before it began was {cost['loadBefore']:.1f}; far
from 0, these times mean little.

{frames}

PHATexels updated to convergence while drawing, per second of processor time: {renewal['phatexelsPerSecond']:,.0f}, each counted once; a
bake's photons and gathering on one thread reach {full['phatexelsPerSecond']:,.0f}: **{100 * renewal['phatexelsPerSecond'] / full['phatexelsPerSecond']:.0f} %**. With the first responses, which are
updated again before convergence, {renewal['updatesPerSecond']:,.0f}. No slice of work took more than {cost['longestPieceMs']:.0f} ms.

"""


def main():
    shop = Workshop(ROOT / "out/figures/live")
    result = live(shop)
    plot_live(ROOT / "docs/figures/live.svg", result)
    page = ROOT / "docs/results.md"
    text = page.read_text()
    old = re.search(rf"^{TITLE}\n.*?(?=^## )", text, re.M | re.S)
    span = old.span() if old else (re.search(r"^## (The path tracer|Convergence)$", text, re.M).start(),) * 2
    page.write_text(text[:span[0]] + live_section(result) + text[span[1]:])
    shop.say("docs/results.md")


if __name__ == "__main__":
    main()
