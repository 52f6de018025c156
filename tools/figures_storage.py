#!/usr/bin/env python3
"""What the paper's storage of PHATexels takes and costs beside the packed one: a section of docs/results.md.

usage: figures_storage.py      writes that section of docs/results.md anew; figures.py does so, too
"""

import json
import re
import struct

from figures_run import ROOT, Workshop, table
from figures_surfaces import TABLE, Surface, Surfaces, default_bake, scene_surfaces

TITLE = "## Storage"
STORAGES = {"packed": (), "paper": ("--storage", "paper")}
METHODS = ("phat", "phat-pyramid", "phat-paper")
PHATEXEL_KEYS = ("radiance", "direction", "phatexels")


def measured_surfaces():
    """Of tabletop and gallery, [(Surface, what its pixels show)]; without what tells the storages apart."""
    flags, name = default_bake("tabletop")
    floor = next(surface for surface in scene_surfaces() if surface.name == "gallery-floor")
    return [(Surface("storage-table", "tabletop", "480x270", flags, name, edits=(f"{TABLE}.roughness=0.25",)), "table top, roughness .25"),
            (floor, "wood floor")]


def stored(path):
    """{raw, compressed}: bytes a PHATexel of a baked file."""
    with open(path, "rb") as file:
        file.seek(12)
        gltf = json.loads(file.read(struct.unpack("<II", file.read(8))[0]))
    bake = gltf["extensions"]["PHAT_photon_accumulation_texture"]
    width, height = bake["atlas"]["size"]
    layers = bake["indirect"]["layers"] + bake["area"]["layers"]
    payloads = [layer[key] for layer in layers for key in PHATEXEL_KEYS if key in layer]
    count = width * height * len(layers)
    return {"raw": sum(payload["byteLength"] for payload in payloads) / count,
            "compressed": sum(gltf["bufferViews"][payload["bufferView"]]["byteLength"] for payload in payloads) / count}


def storage(surfaces):
    """[{scene, part, storage, raw, compressed, fileBytes, errors: {method: {...}}}]"""
    rows = []
    for surface, part in measured_surfaces():
        for name, flags in STORAGES.items():
            stem = surface.bake_name + ("" if name == "packed" else f"-{name}")
            of_storage = Surface(f"{surface.name}-{name}", surface.scene, surface.size, (*surface.bake_flags, *flags), stem,
                                 surface.view, surface.edits, surface.mask, surface.material)
            file, _ = surfaces.bake(of_storage)
            errors = {method: surfaces.errors(of_storage, surfaces.draw(of_storage, method, "--spp", 1)[0]) for method in METHODS}
            rows.append({"scene": surface.scene, "part": part, "storage": name, "fileBytes": file.stat().st_size, **stored(file),
                         "errors": errors})
    return rows


def storage_section(rows):
    sizes = table(["scene", "`--storage`", "bytes a PHATexel", "of them in the file", "file, MB"],
                  [[f"`{row['scene']}`", f"`{row['storage']}`", f"{row['raw']:.0f}", f"{row['compressed']:.2f}",
                    f"{row['fileBytes'] / 1e6:.1f}"] for row in rows])
    body = []
    for packed, paper in zip(rows[::2], rows[1::2]):
        for method in METHODS:
            pair = [row["errors"][method] for row in (packed, paper)]
            body.append([f"`{packed['scene']}`, {packed['part']}", f"`{method}`",
                         *(f"{one['clean']:.3f}" for one in pair), *(f"{one['relMse']:.3g}" for one in pair)])
    errors = table(["surface", "method", "MAE/mean: packed", "paper", "relMSE: packed", "paper"], body)
    return f"""{TITLE}

`phat bake --storage paper` writes the paper's 16 bytes (section 6): three floats and two half angles, no distance. Bakes with default
settings, both layers counted, with the texels that hold none. The file's bytes are after zlib: the floats are those of the baked RGB9E5, so
that at least 15 of their 32 bits are zero and all but vanish; floats of full precision would not.

{sizes}

Errors are those of single frames of glossy indirect light, as above. `phat` and `phat-pyramid` count on distances; without, all that
is reflected is infinitely far. `phat-paper` reads none, and shows what the rounding of the angles alone does.

{errors}

"""


def main():
    shop = Workshop(ROOT / "out/figures/full")
    section = storage_section(storage(Surfaces(shop)))
    page = ROOT / "docs/results.md"
    text = page.read_text()
    old = re.search(rf"^{TITLE}\n.*?(?=^## )", text, re.M | re.S)
    place = old.span() if old else (re.search(r"^## Equal time, equal error$", text, re.M).start(),) * 2
    page.write_text(text[:place[0]] + section + text[place[1]:])
    shop.say("docs/results.md")


if __name__ == "__main__":
    main()
