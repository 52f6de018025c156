#!/usr/bin/env python3
"""Measures what PHATextures give on glossy surfaces, by roughness, texel size, view and material, against `path`.

usage: goals.py [--rows GLOB] [--methods GLOB] [--seeds 1,2,3] [--keep-bakes] [-o FILE]

A row is a surface in a view: SCENE-TEXEL-CAMERA-MATERIAL-ROUGHNESS for tabletop, SCENE-MASK for the others; --list
prints them. Everything is kept in out/figures/full/ and used again; --keep-bakes uses bakes that are older than the
program, too (after changes of the renderer alone). How it is measured: tools/figures_surfaces.py.
"""

import argparse
import fnmatch
import statistics
import subprocess
import sys

from figures_run import ROOT, Workshop, table
from figures_surfaces import ROUGHNESS, SEEDS, Surfaces, scene_surfaces, table_surfaces, with_error

# Method of the table: (phat's --method, flags).
METHODS = {
    "phat, 1 frame": ("phat", ("--spp", 1, "--trace", "cpu")),
    "phat, 8 frames": ("phat", ("--spp", 8, "--trace", "cpu")),
    "lookup alone, 1 frame": ("phat", ("--spp", 1, "--reflections", "lookup")),
    "lookup alone, 8 frames": ("phat", ("--spp", 8, "--reflections", "lookup")),
    "GPU rays, 1 frame": ("phat", ("--spp", 1, "--trace", "gpu")),
    "GPU rays, 8 frames": ("phat", ("--spp", 8, "--trace", "gpu")),
    "phat-gather": ("phat-gather", ("--spp", 1)),
}
FRAMES = ("phat, 1 frame", "phat, 8 frames", "GPU rays, 1 frame", "GPU rays, 8 frames")
# MAE/mean: {row: {method: goal}}
GOALS = {surface.name: {"phat, 1 frame": 0.06, "GPU rays, 1 frame": one, "GPU rays, 8 frames": eight}
         for surface, one, eight in zip(scene_surfaces(), (0.065, 0.060, 0.075), (0.042, 0.050, 0.055))}
for _roughness, _one, _eight, _coarse in zip(ROUGHNESS, (0.050, 0.032, 0.024, 0.021), (0.035, 0.022, 0.020, 0.020),
                                             (0.070, 0.042, 0.032, 0.027)):
    GOALS[f"tabletop-1.95-file-metal-{_roughness}"] = {
        "phat, 1 frame": _one, "phat, 8 frames": _eight, "phat-gather": _eight}
    GOALS[f"tabletop-3.9-file-metal-{_roughness}"] = {"phat, 1 frame": _coarse}
for _roughness, _one, _eight in zip(ROUGHNESS, (0.022, 0.022, 0.022, 0.021), (0.018, 0.018, 0.017, 0.016)):
    GOALS[f"tabletop-1.95-file-metal-{_roughness}"].update({"GPU rays, 1 frame": _one, "GPU rays, 8 frames": _eight})


def build():
    """Builds the programs that draw and compare; ends the script where that fails."""
    release = ROOT / "build/release"
    commands = [] if (release / "build.ninja").exists() else [["cmake", "--preset", "release"]]
    commands.append(["cmake", "--build", str(release), "--target", "phat", "phat_peers"])
    for command in commands:
        try:
            subprocess.run(command, cwd=ROOT, stdout=sys.stderr, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            sys.exit(f"goals: {error}; `make setup` installs what the build needs")


def measure(surfaces, rows, methods=tuple(METHODS), seeds=SEEDS):
    """[{row, method, goal, maeOverMean: [by seed], clean: [...], bias: [...], noise}]"""
    results = []
    for surface in rows:
        for label in methods:
            method, flags = METHODS[label]
            found = [surfaces.errors(surface, surfaces.draw(surface, method, *flags, seed=seed,
                                                            masked=method == "phat-gather")[0]) for seed in seeds]
            results.append({"row": surface.name, "method": label, "goal": GOALS.get(surface.name, {}).get(label),
                            **{key: [one[key] for one in found] for key in ("maeOverMean", "clean", "bias")},
                            "noise": found[0]["noise"]})
            surfaces.shop.say(f"{surface.name}, {label}: {with_error(results[-1]['maeOverMean'], '.4f')}")
    return results


def met(result):
    """Judged by the printed digits."""
    if result["goal"] is None:
        return ""
    return "yes" if round(statistics.mean(result["clean"]), 3) <= result["goal"] else "no"


def goals_table(results):
    body = [[result["row"], result["method"], with_error(result["maeOverMean"], ".3f"), f"{result['noise']:.3f}",
             f"{statistics.mean(result['clean']):.3f}", "" if result["goal"] is None else f"{result['goal']:.3f}", met(result),
             with_error(result["bias"], "+.3f")] for result in results]
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
    rows = [row for row in table_surfaces() + scene_surfaces() if fnmatch.fnmatch(row.name, options.rows)]
    methods = [name for name in METHODS if fnmatch.fnmatch(name, options.methods)]
    if options.list:
        print("\n".join([row.name for row in rows] + methods))
        return
    if not rows or not methods:
        sys.exit("no such row or method; --list prints them")
    build()
    surfaces = Surfaces(Workshop(ROOT / "out/figures/full"), keep_bakes=options.keep_bakes)
    text = goals_table(measure(surfaces, rows, methods, [int(seed) for seed in options.seeds.split(",")]))
    print(text)
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write(text + "\n")


if __name__ == "__main__":
    main()
