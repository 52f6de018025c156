#!/usr/bin/env python3
"""Measures what PHATextures give on glossy surfaces, by roughness, texel size, view and material, against `path`.

usage: goals.py [--rows GLOB] [--methods GLOB] [--seeds 1,2,3] [--keep-bakes] [-o FILE]

A row is a surface in a view: SCENE-TEXEL-CAMERA-MATERIAL-ROUGHNESS for tabletop, SCENE-MASK for the others; --list
prints them. Everything is kept in out/figures/goals/ and used again; --keep-bakes uses bakes that are older than the
program, too (after changes of the renderer alone).

All pictures show the middles of pixels (--pixel-filter center): a single frame without anti-aliasing has no other
places, and eight frames of a still view average only what the estimator draws. The references have the same filter, so
edges and textures do not count as errors. A reference is the path tracer's at a few thousand pixels that are scattered
over the surface, with as many samples as its noise needs to stay well below what is measured.
Materials that are changed after the bake see the light of the baked file (--keep-light).
"""

import argparse
import dataclasses
import fnmatch
import json
import math
import statistics
import sys

from figures_page import table
from figures_run import PEERS, PHAT, ROOT, Workshop, compare

TABLE = "table_top"
ROUGHNESS = (0.15, 0.25, 0.4, 0.6)
SEEDS = (1, 2, 3)
# Side of the table's texels, mm -> flags. The table's density (src/core/glossy_density.cpp) is 3.59 where it is not held.
TEXELS = {"3.9": ("--texel-size", 0.0117, "--glossy-density", 3), "1.95": ("--texel-size", 0.0070, "--glossy-density", 8)}
CAMERAS = {"file": (), "steep": ((0.3, 2.2, 0.75), (0.0, 0.75, -0.05))}  # eye, target
MATERIALS = {"metal": (), "dielectric": (f"{TABLE}.metallic=0",)}
OTHERS = {  # scene: (size, [mask])
    "cornell-glossy": ("360x360", ["cornell-glossy.mask-glossy"]),
    "gallery": ("480x270", ["gallery.mask-floor", "gallery.mask-curved"]),
}
# Method of this table: (phat's --method, flags).
METHODS = {
    "phat, 1 frame": ("phat", ("--spp", 1)),
    "phat, 8 frames": ("phat", ("--spp", 8)),
    "lookup alone, 1 frame": ("phat", ("--spp", 1, "--reflections", "lookup")),
    "phat-gather": ("phat-gather", ("--spp", 1)),
}
# MAE/mean: {row: {method: goal}}
GOALS = {}
for _roughness, _one, _eight, _coarse in zip(ROUGHNESS, (0.050, 0.032, 0.024, 0.021), (0.035, 0.022, 0.020, 0.020),
                                             (0.070, 0.042, 0.032, 0.027)):
    GOALS[f"tabletop-1.95-file-metal-{_roughness}"] = {
        "phat, 1 frame": _one, "phat, 8 frames": _eight, "phat-gather": _eight}
    GOALS[f"tabletop-3.9-file-metal-{_roughness}"] = {"phat, 1 frame": _coarse}
for _scene, (_, _masks) in OTHERS.items():
    for _mask in _masks:
        GOALS[f"{_scene}-{_mask.split('-')[-1]}"] = {"phat, 1 frame": 0.06}


@dataclasses.dataclass(frozen=True)
class Row:
    name: str
    scene: str
    size: str
    bake_flags: tuple
    bake_name: str
    view: tuple = ()  # eye, target
    edits: tuple = ()
    mask: str = ""  # of tests/data/references; empty: the table
    traced: bool = False  # partly by rays, by default

    def edit_flags(self):
        return ("--set", *self.edits) if self.edits else ()

    def view_flags(self):
        return sum(((flag, ",".join(map(str, place))) for flag, place in zip(("--eye", "--target"), self.view)), ())


@dataclasses.dataclass(frozen=True)
class Plan:
    pixels: int = 1000
    spp: int = 16384


def all_rows():
    rows = []
    for texel, flags in TEXELS.items():
        for camera, view in CAMERAS.items():
            for material, edits in MATERIALS.items():
                for roughness in ROUGHNESS:
                    rows.append(Row(f"tabletop-{texel}-{camera}-{material}-{roughness}", "tabletop", "480x270", flags,
                                    f"tabletop-{texel}mm", view, (*edits, f"{TABLE}.roughness={roughness}"),
                                    traced=roughness < 0.2))
    for scene, (size, masks) in OTHERS.items():
        rows += [Row(f"{scene}-{mask.split('-')[-1]}", scene, size, (), scene, mask=mask, traced="curved" in mask)
                 for mask in masks]
    return rows


class Goals:
    def __init__(self, shop, plan, keep_bakes):
        self.shop, self.plan, self.keep_bakes = shop, plan, keep_bakes

    def scene(self, row):
        return ROOT / "scenes" / f"{row.scene}.glb"

    def bake(self, row, seed):
        name = f"{row.bake_name}-{seed}.phat.glb"
        said = self.shop.make(name, PHAT, "bake", self.scene(row), *row.bake_flags, "--seed", seed, "--json", "--quiet",
                              keep=self.keep_bakes)
        return self.shop.path(name), said

    def mask(self, row):
        """The reference's pixels."""
        if row.mask:
            whole = ROOT / f"tests/data/references/{row.mask}.exr"
            stem = row.mask
        else:
            stem = f"mask-{'steep' if row.view else 'file'}"
            places = sum(((flag, *place) for flag, place in zip(("--eye", "--target"), row.view)), ())
            self.shop.make(f"{stem}.exr", PEERS, "mask", self.scene(row), "--material", TABLE, "--size", row.size, *places,
                           keep=True)
            whole = self.shop.path(f"{stem}.exr")
        thin = f"{stem}-thin.exr"
        self.shop.make(thin, PEERS, "thin", whole, "--count", self.plan.pixels, keep=True)
        return self.shop.path(thin)

    def common(self, row):
        return ("--component", "glossy-indirect", "--pixel-filter", "center", "--size", row.size, *row.view_flags(),
                *row.edit_flags())

    def reference(self, row):
        """(picture, variance) of `path`; rows that differ in the bake alone share it."""
        where = "-".join((row.mask or row.scene, "steep" if row.view else "file", *row.edits))
        name, variance = f"reference-{where}.exr", self.shop.path(f"variance-{where}.exr")
        self.shop.make(name, PHAT, "render", self.scene(row), "--method", "path", *self.common(row), "--spp", self.plan.spp,
                       "--seed", 11, "--pixels", self.mask(row), "--variance", variance,
                       *(("--keep-light",) if row.edits else ()), "--json", "--quiet", keep=True)
        return self.shop.path(name), variance

    def measure(self, row, method, seed):
        name, flags = METHODS[method]
        bake, _ = self.bake(row, seed)
        picture = f"{row.name}-{method.replace(', ', '-').replace(' ', '-')}-{seed}.exr"
        masked = ("--pixels", self.mask(row)) if name == "phat-gather" else ()
        self.shop.make(picture, PHAT, "render", bake, "--method", name, *flags, *self.common(row), *masked, "--json", "--quiet")
        reference, variance = self.reference(row)
        return compare(self.shop.path(picture), reference, self.mask(row), variance=variance)


def two_sigma(values):
    """Of the mean."""
    return 2 * statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else 0


def without_noise(mae, noise):
    """Squares of independent errors add up."""
    return math.sqrt(max(mae**2 - noise**2, 0))


def with_error(values, form):
    error = f" ± {two_sigma(values):.3f}" if len(values) > 1 else ""
    return f"{statistics.mean(values):{form}}{error}"


def applies(row, method):
    return row.traced or not method.startswith("lookup alone")


def measure_all(goals, rows, methods, seeds):
    """[{row, method, goal, maeOverMean: [by seed], bias: [...], relMse, flip, noise}]"""
    results = []
    for row in rows:
        for method in methods:
            if not applies(row, method):
                continue
            found = [goals.measure(row, method, seed) for seed in seeds]
            results.append({"row": row.name, "method": method, "goal": GOALS.get(row.name, {}).get(method),
                            **{key: [one[key] for one in found] for key in ("maeOverMean", "bias", "relMse", "flip")},
                            "noise": found[0]["noise"]})
            goals.shop.say(f"{row.name}, {method}: {with_error(results[-1]['maeOverMean'], '.4f')}")
    return results


def goals_table(results):
    body = []
    for result in results:
        clean = [without_noise(mae, result["noise"]) for mae in result["maeOverMean"]]
        goal = result["goal"]
        body.append([result["row"], result["method"], with_error(result["maeOverMean"], ".3f"),
                     f"{result['noise']:.3f}", f"{statistics.mean(clean):.3f}",
                     "" if goal is None else f"{goal:.3f}",
                     "" if goal is None else "yes" if statistics.mean(clean) < goal + 0.0005 else "no",
                     with_error(result["bias"], "+.3f")])
    return table(["surface", "method", "MAE/mean", "reference's noise", "without it", "goal", "met", "bias"], body)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rows", default="*")
    parser.add_argument("--methods", default="*")
    parser.add_argument("--seeds", default=",".join(map(str, SEEDS)))
    parser.add_argument("--keep-bakes", action="store_true")
    parser.add_argument("--list", action="store_true", help="print the rows and the methods")
    parser.add_argument("-o", "--output", help="write the table there, too")
    options = parser.parse_args()
    rows = [row for row in all_rows() if fnmatch.fnmatch(row.name, options.rows)]
    methods = [name for name in METHODS if fnmatch.fnmatch(name, options.methods)]
    if options.list:
        print("\n".join([row.name for row in rows] + methods))
        return
    if not rows or not methods:
        sys.exit("no such row or method; --list prints them")
    goals = Goals(Workshop(ROOT / "out/figures/goals"), Plan(), options.keep_bakes)
    text = goals_table(measure_all(goals, rows, methods, [int(seed) for seed in options.seeds.split(",")]))
    print(text)
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write(text + "\n")


if __name__ == "__main__":
    main()
