#!/usr/bin/env python3
"""Renders the counterparts of the paper's figures and measures every method: docs/figures/, docs/results.md.

usage: figures.py [--quick] [--fresh]

Pictures, bakes and references are kept in out/figures/; a second run makes only what is missing or older than
the program. The methods are those that `phat render --help` names.
"""

import argparse
import dataclasses
import json
import re
import shutil
import sys

from figures_page import write_page
from figures_plot import line_plot
from figures_profile import pyramid_profile
from figures_run import PEERS, PHAT, ROOT, Workshop, compare, run

TABLE = "table_top"  # the material of tabletop.glb that is measured
ROUGHNESS = [0.15, 0.25, 0.4, 0.6]
SHOWN_ROUGHNESS = 0.25  # of the figures, of the convergence and of equal times
EXPOSURE = 1  # of every picture and of FLIP
# The check of a reference has a quarter of its samples: the two differ by the root of 1 + 4 times its noise.
CHECK_SHARE = 4


@dataclasses.dataclass(frozen=True)
class Plan:
    """How much of everything."""

    name: str
    table_size: str
    reference_spp: int
    gather_rays: int
    series_size: str
    series_reference_spp: int
    path_spp: tuple
    photons: tuple
    rays: tuple
    texels: tuple
    whole_spp: int
    filter_size: str


FULL = Plan(
    "full", "240x135", 1024, 32, "160x90", 1024, (1, 4, 16, 64), ("30k", "125k", "500k", "2M"), (4, 16, 64),
    ("64k", "256k", "1048576", "4M"), 48, "240x135",
)
QUICK = Plan(
    "quick", "128x72", 128, 8, "96x54", 512, (1, 4, 16), ("30k", "125k", "500k"), (4, 16),
    ("64k", "256k", "1048576"), 16, "240x135",
)
DEFAULT_TEXELS = "1048576"

WHOLE = {  # scene: (size, Cycles' picture, mask, what the mask keeps)
    "tabletop": ("480x270", "tabletop-spec", "tabletop.mask-table", "table top"),
    "cornell-glossy": ("360x360", "cornell-glossy", "cornell-glossy.mask-glossy", "floor and box"),
    "gallery": ("480x270", "gallery-spec", "gallery.mask-floor", "wood floor"),
}


def count_of(text):
    return float(text.replace("k", "e3").replace("M", "e6"))


def render_methods():
    """The program's methods but for the reference."""
    names = re.search(r"--method NAME:\{([^}]*)\}", run(PHAT, "render", "--help")).group(1).split(",")
    return [name.strip() for name in names if name.strip() != "path"]


def seconds_of(said):
    """Of a picture; of a drawn one, of what every frame repeats (shadow maps are drawn once)."""
    seconds = said["seconds"]
    if isinstance(seconds, dict):
        return sum(value for key, value in seconds.items() if key != "shadows")
    return seconds


class Figures:
    def __init__(self, plan, shop):
        self.plan, self.shop = plan, shop
        self.docs = ROOT / "docs/figures"
        self.docs.mkdir(parents=True, exist_ok=True)
        self.written = {"figure-7.svg", "roughness.svg", "convergence.svg"}
        self.methods = render_methods()

    # --- what everything is made of

    def scene(self, name="tabletop"):
        return ROOT / "scenes" / f"{name}.glb"

    def bake(self, scene="tabletop", texels=DEFAULT_TEXELS):
        name = f"{scene}-{texels}.phat.glb"
        self.shop.make(name, PHAT, "bake", self.scene(scene), "--resolution", texels, "--json", "--quiet")
        return self.shop.path(name)

    def finest_texel(self):
        """Side of the table top's texels in the default bake, in metres."""
        self.bake()
        record = self.shop.path(f"tabletop-{DEFAULT_TEXELS}.phat.glb.json")
        return json.loads(record.read_text())["said"]["atlas"]["finestTexelSize"]

    def picture(self, name, method, *flags, scene="tabletop", texels=DEFAULT_TEXELS, keep=False):
        source = self.bake(scene, texels) if method.startswith("phat") else self.scene(scene)
        if method == "photons-direct" and "--spp" not in flags:
            flags += ("--spp", 16)
        if method == "photons-gather" and "--gather-rays" not in flags:
            flags += ("--gather-rays", self.plan.gather_rays)
        return self.shop.make(name, PHAT, "render", source, "--method", method, *flags, "--json", "--quiet", keep=keep)

    def mask(self, size):
        name = f"mask-{size}.exr"
        self.shop.make(name, PEERS, "mask", self.scene(), "--material", TABLE, "--size", size, keep=True)
        return self.shop.path(name)

    def screen(self, source, name, *flags):
        """A picture of docs/figures."""
        run(PEERS, "screen", source, "-o", self.docs / name, "--exposure", EXPOSURE, *flags)
        self.written.add(name)
        return f"figures/{name}"

    def reference(self, name, size, roughness, spp):
        """The path tracer's glossy indirect light on the table, and its own noise."""
        flags = ["--component", "glossy-indirect", "--set", f"{TABLE}.roughness={roughness}", "--size", size]
        said = self.picture(f"{name}.exr", "path", *flags, "--spp", spp, "--seed", 11, keep=True)
        self.picture(f"{name}-check.exr", "path", *flags, "--spp", spp // CHECK_SHARE, "--seed", 12, keep=True)
        path = self.shop.path(f"{name}.exr")
        noise = compare(self.shop.path(f"{name}-check.exr"), path, self.mask(size), EXPOSURE)
        noise["relMse"] /= 1 + CHECK_SHARE
        noise["maeOverMean"] /= (1 + CHECK_SHARE) ** 0.5
        return path, {"seconds": seconds_of(said), "spp": spp, **noise}

    # --- what is measured

    def by_roughness(self):
        """[{method, roughness, seconds, relMse ...}], one method "path" with the reference's own noise."""
        size, rows = self.plan.table_size, []
        peers = self.peers(size)
        for roughness in ROUGHNESS:
            reference, noise = self.reference(f"table-path-{roughness}", size, roughness, self.plan.reference_spp)
            rows.append({"method": "path", "roughness": roughness, **noise})
            for method in self.methods:
                name = f"table-{method}-{roughness}.exr"
                said = self.picture(name, method, "--component", "glossy-indirect", "--size", size,
                                    "--set", f"{TABLE}.roughness={roughness}")
                rows.append(self.row(method, roughness, name, reference, seconds_of(said)))
            rows += [self.row(peer, roughness, f"{stem}-{roughness}.exr", reference, None) for peer, stem in peers]
        return rows

    def row(self, method, roughness, name, reference, seconds):
        figures = compare(self.shop.path(name), reference, self.mask(self.plan.table_size), EXPOSURE)
        return {"method": method, "roughness": roughness, "seconds": seconds, "picture": name, **figures}

    def peers(self, size):
        """[(name, stem of its pictures)], drawn at every roughness."""
        kinds = {
            "probe, middle of the room": ("peer-probe", ["--peer", "probe"]),
            "probe, over the table": ("peer-probe-near", ["--peer", "probe", "--at", 0, 1.2, 0.3]),
            "9 gaussians": ("peer-gaussians", ["--peer", "gaussians"]),
            "9 gaussians, exact BRDF": ("peer-gaussians-exact", ["--peer", "gaussians", "--reading", "exact"]),
        }
        self.peer_facts = {}
        for name, (stem, flags) in kinds.items():
            self.peer_facts[name] = self.shop.make(
                stem, PEERS, "render", self.bake(), "--material", TABLE, *flags, "--size", size,
                "--roughness", *ROUGHNESS, output=self.shop.path(stem + "-{}.exr"))
        return [(name, stem) for name, (stem, _) in kinds.items()]

    def convergence(self):
        """{method: [{work, unit, seconds, maeOverMean ...}]} and the reference's noise, which is taken off relMse."""
        plan, size = self.plan, self.plan.series_size
        reference, noise = self.reference("series-path", size, SHOWN_ROUGHNESS, plan.series_reference_spp)
        flags = ["--component", "glossy-indirect", "--set", f"{TABLE}.roughness={SHOWN_ROUGHNESS}", "--size", size]
        series = {}

        def add(method, work, unit, *more, texels=DEFAULT_TEXELS):
            name = f"series-{method}-{work}.exr"
            said = self.picture(name, method, *flags, *more, texels=texels)
            figures = compare(self.shop.path(name), reference, self.mask(size), EXPOSURE)
            # Squares of independent errors add up.
            figures["relMse"] = max(figures["relMse"] - noise["relMse"], 0)
            series.setdefault(method, []).append(
                {"work": count_of(str(work)), "unit": unit, "seconds": seconds_of(said), **figures})

        for spp in plan.path_spp:
            add("path", spp, "samples a pixel", "--spp", spp)
        for photons in plan.photons:
            add("photons-direct", photons, "photons", "--photons", photons)
        for rays in plan.rays:
            add("photons-gather", rays, "gather rays", "--gather-rays", rays)
        for method in (name for name in self.methods if name.startswith("phat")):
            for texels in plan.texels:
                add(method, texels, "texels", texels=texels)
        return series, noise

    def equal_time(self, seconds):
        """What the traced methods reach in about the time of a frame."""
        size, rows = self.plan.table_size, []
        flags = ["--component", "glossy-indirect", "--set", f"{TABLE}.roughness={SHOWN_ROUGHNESS}", "--size", size]
        for method, more in (("path", []), ("photons-gather", ["--gather-rays", 1])):
            name = f"equal-time-{method}.exr"
            # The limit in milliseconds, so that the same frame time finds the same picture again.
            said = self.picture(name, method, *flags, *more, "--time", f"{seconds:.3f}")
            reference = self.shop.path(f"table-path-{SHOWN_ROUGHNESS}.exr")
            figures = compare(self.shop.path(name), reference, self.mask(size), EXPOSURE)
            rows.append({"method": method, "seconds": said["seconds"], "spp": said["samplesPerPixel"], **figures})
        return rows

    def whole(self):
        """Pictures of the scenes against Cycles and against the path tracer."""
        rows = []
        data = ROOT / "tests/data/references"
        for scene, (size, cycles, mask, kept) in WHOLE.items():
            names = {}
            for method, flags in (("path", ["--spp", self.plan.whole_spp]), (self.methods[0], [])):
                names[method] = f"whole-{scene}-{method}.exr"
                self.picture(names[method], method, *flags, "--size", size, scene=scene, keep=method == "path")
            self.screen(self.shop.path(names[self.methods[0]]), f"{scene}-{self.methods[0]}.png", "--shrink", 2)
            cycles_path = data / f"{cycles}.exr"
            self.screen(cycles_path, f"{scene}-cycles.png", "--shrink", 2)
            for test, against, reference in (
                (self.methods[0], "Cycles", cycles_path),
                (self.methods[0], "path", self.shop.path(names["path"])),
                ("path", "Cycles", cycles_path),
            ):
                picture = self.shop.path(names[test])
                rows.append({"scene": scene, "test": test, "against": against, "kept": kept,
                             "all": compare(picture, reference, None, EXPOSURE),
                             "masked": compare(picture, reference, data / f"{mask}.exr", EXPOSURE)})
        return rows

    # --- the paper's figures

    def paper_figures(self):
        """{figure: [(picture, caption), ...]}"""
        figures = {}
        best = self.methods[0]
        self.picture("figure-1.exr", best, "--size", "480x270")
        figures["1"] = [(self.screen(self.shop.path("figure-1.exr"), "figure-1.png"), f"`{best}`")]

        self.shop.make("chart.exr", PEERS, "chart", self.bake(), "--material", TABLE)
        figures["4"] = [
            (self.screen(self.shop.path("chart.exr"), "figure-4-phatexels.png", "--zoom", 2), "radiance of the PHATexels"),
            (self.screen(self.shop.path("figure-1.exr"), "figure-4-result.png", "--zoom", 2), f"`{best}`"),
        ]
        figures["5"] = []
        for texels in (1.5, 6, 24):
            radius = round(texels * self.finest_texel(), 5)
            name = f"figure-5-{texels}.exr"
            self.picture(name, "phat-gather", "--radius", radius, "--size", self.plan.filter_size)
            figures["5"].append((self.screen(self.shop.path(name), f"figure-5-{texels}.png"), f"radius of {texels} texels"))
        figures["6"] = []
        for method, caption in (("photons-direct", "approximate"), ("photons-gather", "exact"), ("path", "reference")):
            name = f"figure-6-{method}.exr"
            more = ["--spp", self.plan.whole_spp] if method == "path" else []
            self.picture(name, method, *more, "--size", self.plan.table_size, keep=method == "path")
            figures["6"].append((self.screen(self.shop.path(name), f"figure-6-{method}.png"), f"{caption}: `{method}`"))
        pyramid_profile(self.docs / "figure-7.svg")
        figures["7"] = [("figures/figure-7.svg", "section through the filters")]
        return figures

    def shown_methods(self, rows):
        """[(picture, caption)] of the table top's glossy indirect light."""
        shown = [(self.shop.path(f"table-path-{SHOWN_ROUGHNESS}.exr"), "path")]
        shown += [(self.shop.path(row["picture"]), row["method"])
                  for row in rows if row["roughness"] == SHOWN_ROUGHNESS and "picture" in row]
        def file_name(name):
            return "glossy-" + re.sub("[^a-z0-9]+", "-", name.lower()) + ".png"

        own = {*self.methods, "path"}
        return [(self.screen(path, file_name(name)), f"`{name}`" if name in own else name) for path, name in shown]


def plot_results(docs, rows, series):
    by_method = {}
    for row in rows:
        name = "noise of the reference (dashed)" if row["method"] == "path" else row["method"]
        by_method.setdefault(name, []).append((row["roughness"], row["maeOverMean"]))
    line_plot(docs / "roughness.svg", by_method, "roughness of the table top", "MAE / mean", log_y=True)
    line_plot(docs / "convergence.svg",
              {method: [(point["work"] / points[0]["work"], point["relMse"]) for point in points if point["relMse"] > 0]
               for method, points in series.items()},
              "work, in multiples of each method's first point", "relMSE", log_x=True, log_y=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="small pictures, few samples: a few minutes")
    parser.add_argument("--fresh", action="store_true", help="forget what earlier runs made")
    options = parser.parse_args()
    for program in (PHAT, PEERS):
        if not program.exists():
            sys.exit(f"{program.relative_to(ROOT)} is not built: make figures builds it")
    plan = QUICK if options.quick else FULL
    folder = ROOT / "out/figures" / plan.name
    if options.fresh:
        shutil.rmtree(folder, ignore_errors=True)

    shop = Workshop(folder)
    figures = Figures(plan, shop)
    paper = figures.paper_figures()
    rows = figures.by_roughness()
    series, series_noise = figures.convergence()
    frame = next(row for row in rows if row["method"] == figures.methods[0] and row["roughness"] == SHOWN_ROUGHNESS)
    equal_time = figures.equal_time(frame["seconds"])
    whole = figures.whole()
    plot_results(figures.docs, rows, series)
    write_page(ROOT / "docs/results.md", plan, figures, {
        "paper": paper, "shown": figures.shown_methods(rows), "rows": rows, "series": series,
        "series_noise": series_noise, "frame": frame, "equal_time": equal_time, "whole": whole})
    for left_over in figures.docs.iterdir():
        if left_over.name not in figures.written:
            left_over.unlink()
    shop.say("docs/results.md")


if __name__ == "__main__":
    main()
