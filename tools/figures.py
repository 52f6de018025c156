#!/usr/bin/env python3
"""Renders the counterparts of the paper's figures and measures every method: docs/figures/, docs/results.md.

usage: figures.py [--quick] [--fresh]

Pictures, bakes and references are kept in out/figures/; a second run makes only what is missing or older than
the program. The methods are those that `phat render --help` names.
"""

import argparse
import dataclasses
import re
import shutil
import sys

import goals
from figures_cost import cost, path_speed
from figures_live import live, plot_live
from figures_motion import motion
from figures_page import write_page
from figures_plot import line_plot, slope
from figures_profile import pyramid_profile
from figures_run import LIVE, PEERS, PHAT, ROOT, Workshop, compare, run
from figures_storage import storage
from figures_surfaces import (DATA, DEFAULT_TEXELS, ROUGHNESS, SEEDS, TABLE, Reference, Surface, Surfaces, default_bake,
                              scene_surfaces, table_surfaces)

SHOWN_ROUGHNESS = 0.25  # of the figures, of the convergence and of equal times
EXPOSURE = 1  # of every picture and of FLIP
WINDOW = (150, 140, 180, 60)  # of 480x270: where the crate, the globe and the cone touch the table


@dataclasses.dataclass(frozen=True)
class Plan:
    """How much of everything."""

    name: str
    reference: Reference
    window_spp: int  # of the references that FLIP is measured against
    shown_spp: int  # of a path-traced picture that is shown
    gather_rays: int
    path_spp: tuple
    photons: tuple
    rays: tuple
    texels: tuple
    whole_spp: int
    pan_spp: int
    pan_frames: int
    goals: tuple  # ((rows' pattern, methods, seeds), ...)


FULL = Plan(
    "full", Reference(), 512, 256, 32, (1, 4, 16, 64), ("30k", "125k", "500k", "2M"), (4, 16, 64),
    ("64k", "256k", "1048576"), 128, 1024, 60,
    (("tabletop-.*-file-metal-.*", tuple(goals.METHODS), SEEDS), ("tabletop-.*-(steep|.*dielectric).*", goals.FRAMES, SEEDS[:1]),
     ("(cornell|gallery).*", tuple(goals.METHODS), SEEDS)),
)
QUICK = Plan(
    "quick", Reference(400, 1024), 64, 32, 8, (1, 4, 16), ("30k", "125k", "500k"), (4, 16), ("64k", "256k", "1048576"), 16,
    128, 8, (("tabletop-3.9-file-metal-.*", goals.FRAMES, SEEDS[:1]),),
)
WHOLE = {  # scene: (size, Cycles' picture, mask, what the mask keeps)
    "tabletop": ("480x270", "tabletop-spec", "tabletop.mask-table", "table top"),
    "cornell-glossy": ("360x360", "cornell-glossy", "cornell-glossy.mask-glossy", "floor and box"),
    "gallery": ("480x270", "gallery-spec", "gallery.mask-floor", "wood floor"),
}
FLOORS = {"cornell-glossy": ("360x360", "floor_glossy"), "gallery": ("480x270", "floor_wood")}  # scene: (size, material)
PEER_KINDS = {  # name: flags of phat_peers
    "probe, middle of the room": ("--peer", "probe"),
    "probe, over the table": ("--peer", "probe", "--at", 0, 1.2, 0.3),
    "9 gaussians": ("--peer", "gaussians"),
    "9 gaussians, exact BRDF": ("--peer", "gaussians", "--reading", "exact"),
}


def count_of(text):
    return float(text.replace("k", "e3").replace("M", "e6"))


def stem_of(name):
    return re.sub("[^a-z0-9]+", "-", name.lower())


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


def pixels_of(size):
    width, height = size.split("x")
    return int(width) * int(height)


class Figures:
    def __init__(self, plan, shop):
        self.plan, self.shop = plan, shop
        self.surfaces = Surfaces(shop, plan.reference)
        self.docs = ROOT / "docs/figures"
        self.docs.mkdir(parents=True, exist_ok=True)
        self.written = {"figure-7.svg", "roughness.svg", "convergence.svg", "live.svg"}
        self.methods = render_methods()
        self.peer_facts = {}  # (scene, name): what phat_peers said

    # --- what everything is made of

    def bake(self, scene="tabletop", texels=DEFAULT_TEXELS):
        flags, name = default_bake(scene, texels)
        return self.surfaces.bake(Surface(name, scene, "", flags, name))

    def table(self, roughness, texels=DEFAULT_TEXELS):
        flags, name = default_bake("tabletop", texels)
        return Surface(f"table-{texels}-{roughness}", "tabletop", "480x270", flags, name, edits=(f"{TABLE}.roughness={roughness}",))

    def picture(self, name, method, *flags, scene="tabletop", keep=False):
        """All light, or what the flags say, as users see it."""
        source = self.bake(scene)[0] if method.startswith("phat") else ROOT / "scenes" / f"{scene}.glb"
        return self.shop.make(name, PHAT, "render", source, "--method", method, *flags, "--json", "--quiet", keep=keep)

    def screen(self, source, name, *flags):
        """A picture of docs/figures."""
        run(PEERS, "screen", source, "-o", self.docs / name, "--exposure", EXPOSURE, *flags)
        self.written.add(name)
        return f"figures/{name}"

    def work_of(self, method):
        return {"photons-direct": ("--spp", 16), "photons-gather": ("--gather-rays", self.plan.gather_rays)}.get(method, ("--spp", 1))

    def flip(self, surface, picture):
        """In the window, where all pixels have a reference; black around it, since FLIP looks at neighbours."""
        mask = self.surfaces.whole_mask(surface, WINDOW)
        name = f"window-{surface.where()}.exr"
        self.shop.make(name, PHAT, "render", self.surfaces.scene(surface), "--method", "path", *surface.flags(), "--keep-light",
                       "--spp", self.plan.window_spp, "--pixels", mask, "--json", "--quiet", keep=True)
        kept = self.shop.path("kept.exr")
        run(PEERS, "keep", picture, "-o", kept, "--mask", mask)
        return compare(kept, self.shop.path(name), mask, EXPOSURE)["flip"]

    # --- what is measured

    def by_roughness(self):
        """[{method, roughness, microseconds (a pixel), relMse, maeOverMean, clean, bias, noise, flip, picture}]"""
        rows = []
        for roughness in ROUGHNESS:
            surface = self.table(roughness)
            for method in self.methods:
                traced = not method.startswith("phat") or method == "phat-gather"
                picture, said = self.surfaces.draw(surface, method, *self.work_of(method), masked=traced)
                shown = picture
                if traced:
                    shown = self.shop.path(f"{surface.name}-{method}-window.exr")
                    source, keep = (self.bake()[0], ()) if method == "phat-gather" else (self.surfaces.scene(surface), ("--keep-light",))
                    self.shop.make(shown.name, PHAT, "render", source, "--method", method, *self.work_of(method), *surface.flags(),
                                   *keep, "--pixels", self.surfaces.whole_mask(surface, WINDOW), "--json", "--quiet")
                count = self.plan.reference.pixels if traced else pixels_of(surface.size)
                rows.append({"method": method, "roughness": roughness, "microseconds": 1e6 * seconds_of(said) / count,
                             "flip": self.flip(surface, shown), "picture": picture, **self.surfaces.errors(surface, picture)})
            rows += [{"method": peer, "roughness": roughness, "microseconds": None, "flip": self.flip(surface, picture),
                      "picture": picture, **self.surfaces.errors(surface, picture)}
                     for peer, picture in self.peers_of(surface, PEER_KINDS)]
        return rows

    def peers_of(self, surface, kinds):
        """[(name, picture)] of a surface as it is in the file, or with its edited roughness."""
        pictures = []
        for name, flags in kinds.items():
            stem = f"peer-{surface.scene}-{surface.material}-{stem_of(name)}"
            edited = ("--roughness", *ROUGHNESS) if surface.edits else ()
            output = self.shop.path(stem + ("-{}.exr" if edited else ".exr"))
            self.peer_facts[surface.scene, name] = self.shop.make(
                stem, PEERS, "render", self.surfaces.bake(surface)[0], "--material", surface.material, *flags, "--size", surface.size,
                "--center", "--spp", 1, *edited, output=output)
            value = surface.edits[0].split("=")[1] if edited else ""
            pictures.append((name, output.with_name(output.name.format(value))))
        return pictures

    def peers_elsewhere(self):
        """The default bake against its peers on the floors of the other scenes: [{scene, method, bytes, ...}]"""
        rows = []
        kinds = {name: flags for name, flags in PEER_KINDS.items() if "--at" not in flags}
        for scene, (size, material) in FLOORS.items():
            flags, name = default_bake(scene)
            surface = Surface(f"{scene}-{material}", scene, size, flags, name, material=material)
            ours, _ = self.surfaces.draw(surface, self.methods[0], "--spp", 1)
            theirs = self.peers_of(surface, kinds)
            for method, picture in [(self.methods[0], ours), *theirs]:
                facts = self.peer_facts.get((scene, method))
                rows.append({"scene": scene, "material": material, "method": method,
                             "bytes": facts["bytes"] if facts else self.peer_facts[scene, theirs[0][0]]["phatexelBytes"],
                             **self.surfaces.errors(surface, picture)})
        return rows

    def convergence(self):
        """{method: [{work, unit, microseconds, maeOverMean ...}]}"""
        plan, series = self.plan, {}

        def add(method, work, unit, *flags, texels=DEFAULT_TEXELS):
            surface = self.table(SHOWN_ROUGHNESS, texels)
            traced = not method.startswith("phat") or method == "phat-gather"
            picture, said = self.surfaces.draw(surface, method, *flags, masked=traced)
            count = plan.reference.pixels if traced else pixels_of(surface.size)
            series.setdefault(method, []).append(
                {"work": count_of(str(work)), "unit": unit, "microseconds": 1e6 * seconds_of(said) / count,
                 **self.surfaces.errors(surface, picture)})

        for spp in plan.path_spp:
            add("path", spp, "samples a pixel", "--spp", spp)
        for photons in plan.photons:
            add("photons-direct", photons, "photons", "--spp", 16, "--photons", photons)
        for rays in plan.rays:
            add("photons-gather", rays, "gather rays", "--gather-rays", rays)
        for method in (name for name in self.methods if name.startswith("phat")):
            for texels in plan.texels:
                add(method, texels, "texels", "--spp", 1, texels=texels)
        return series

    def equal_time(self, seconds):
        """What the traced methods reach in about the time of a frame."""
        surface, rows = self.table(SHOWN_ROUGHNESS), []
        for method, more in (("path", ()), ("photons-gather", ("--gather-rays", 1))):
            # The limit in milliseconds, so that the same frame time finds the same picture again.
            picture, said = self.surfaces.draw(surface, method, *more, "--time", f"{seconds:.3f}")
            rows.append({"method": method, "seconds": said["seconds"], "spp": said["samplesPerPixel"],
                         **self.surfaces.errors(surface, picture)})
        return rows

    def whole(self):
        """Pictures of the scenes against Cycles and against the path tracer."""
        rows = []
        for scene, (size, cycles, mask, kept) in WHOLE.items():
            names = {}
            for method, flags in (("path", ["--spp", self.plan.whole_spp]), (self.methods[0], [])):
                names[method] = f"whole-{scene}-{method}.exr"
                self.picture(names[method], method, *flags, "--size", size, scene=scene, keep=method == "path")
            self.screen(self.shop.path(names[self.methods[0]]), f"{scene}-{self.methods[0]}.png", "--shrink", 2)
            cycles_path = DATA / f"{cycles}.exr"
            self.screen(cycles_path, f"{scene}-cycles.png", "--shrink", 2)
            for test, against, reference in (
                (self.methods[0], "Cycles", cycles_path),
                (self.methods[0], "path", self.shop.path(names["path"])),
                ("path", "Cycles", cycles_path),
            ):
                picture = self.shop.path(names[test])
                rows.append({"scene": scene, "test": test, "against": against, "kept": kept,
                             "all": compare(picture, reference, None, EXPOSURE),
                             "masked": compare(picture, reference, DATA / f"{mask}.exr", EXPOSURE)})
        return rows

    def goals(self):
        results = []
        for pattern, methods, seeds in self.plan.goals:
            rows = [row for row in table_surfaces() + scene_surfaces() if re.fullmatch(pattern, row.name)]
            results += goals.measure(self.surfaces, rows, methods, seeds)
        return results

    def bakes(self):
        """What the bakes of the goals took: [{name, texels, mm, seconds, bytes ...}]"""
        rows = {}
        for pattern, _, _ in self.plan.goals:
            for surface in table_surfaces() + scene_surfaces():
                if re.fullmatch(pattern, surface.name) and surface.bake_name not in rows:
                    file, said = self.surfaces.bake(surface)
                    _, drawn = self.surfaces.draw(surface, self.methods[0], "--spp", 1)
                    _, counted = self.surfaces.draw(surface, self.methods[0], "--count-reads")
                    rows[surface.bake_name] = {"name": surface.bake_name, "bake": said, "fileBytes": file.stat().st_size,
                                               "drawn": drawn, "reads": counted["reads"]}
        return list(rows.values())

    # --- the paper's figures

    def paper_figures(self):
        """{figure: [(picture, caption), ...]}"""
        figures = {}
        best = self.methods[0]
        self.picture("figure-1.exr", best, "--size", "480x270")
        figures["1"] = [(self.screen(self.shop.path("figure-1.exr"), "figure-1.png"), f"`{best}`")]

        self.shop.make("chart.exr", PEERS, "chart", self.bake()[0], "--material", TABLE)
        figures["4"] = [
            (self.screen(self.shop.path("chart.exr"), "figure-4-phatexels.png", "--zoom", 2), "radiance of the PHATexels"),
            (self.screen(self.shop.path("figure-1.exr"), "figure-4-result.png", "--zoom", 2), f"`{best}`"),
        ]
        figures["5"] = []
        for texels in (1.5, 6, 24):
            radius = round(texels * self.bake()[1]["atlas"]["finestTexelSize"], 5)
            name = f"figure-5-{texels}.exr"
            self.picture(name, "phat-gather", "--radius", radius, "--size", "240x135")
            figures["5"].append((self.screen(self.shop.path(name), f"figure-5-{texels}.png"), f"radius of {texels} texels"))
        figures["6"] = []
        for method, caption in (("photons-direct", "approximate"), ("photons-gather", "exact"), ("path", "reference")):
            name = f"figure-6-{method}.exr"
            more = ("--spp", self.plan.shown_spp) if method == "path" else self.work_of(method)
            self.picture(name, method, *more, "--size", "240x135", keep=method == "path")
            figures["6"].append((self.screen(self.shop.path(name), f"figure-6-{method}.png"), f"{caption}: `{method}`"))
        pyramid_profile(self.docs / "figure-7.svg")
        figures["7"] = [("figures/figure-7.svg", "section through the filters")]
        return figures

    def shown_methods(self, rows):
        """[(picture, caption)] of the table top's glossy indirect light."""
        own = {*self.methods, "path"}
        flags = ("--component", "glossy-indirect", "--set", f"{TABLE}.roughness={SHOWN_ROUGHNESS}", "--size", "240x135")
        shown = []
        for method in ("path", *self.methods):
            name = f"shown-{method}.exr"
            more = ("--spp", self.plan.shown_spp) if method == "path" else self.work_of(method)
            more = more if method.startswith("phat") else ("--keep-light", *more)
            self.picture(name, method, *flags, *more, keep=method == "path")
            shown.append((self.shop.path(name), method, ()))
        shown += [(row["picture"], row["method"], ("--shrink", 2))
                  for row in rows if row["roughness"] == SHOWN_ROUGHNESS and row["method"] not in own]
        return [(self.screen(path, f"glossy-{stem_of(name)}.png", *more), f"`{name}`" if name in own else name)
                for path, name, more in shown]


def plot_results(docs, rows, series):
    by_method = {}
    for row in rows:
        by_method.setdefault(row["method"], []).append((row["roughness"], row["clean"]))
        if row["method"] == rows[0]["method"]:
            by_method.setdefault("noise of the reference (dashed)", []).append((row["roughness"], row["noise"]))
    line_plot(docs / "roughness.svg", by_method, "roughness of the table top", "MAE / mean", log_y=True)
    line_plot(docs / "convergence.svg",
              {method: [(point["work"] / points[0]["work"], point["relMse"]) for point in points]
               for method, points in series.items()},
              "work, in multiples of each method's first point", "relMSE", log_x=True, log_y=True)


def equal_error(series, equal_time, method, error):
    """{seconds, work, how}, or None: what a whole frame of a traced method takes to this error."""
    points = [(point["work"], point["clean"]) for point in series[method]]
    exponent = slope(points)
    if exponent > -0.1:
        return None
    nearest = min(points, key=lambda point: abs(point[1] - error))
    work = nearest[0] * (error / nearest[1]) ** (1 / exponent)
    inside = min(p[1] for p in points) <= error <= max(p[1] for p in points)
    timed = next(row for row in equal_time if row["method"] == method)
    return {"work": work, "unit": series[method][0]["unit"], "seconds": work * timed["seconds"] / timed["spp"],
            "how": "between measured points" if inside else f"extrapolated with slope {exponent:.2f}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="few pixels, few samples: a few minutes")
    parser.add_argument("--fresh", action="store_true", help="forget what earlier runs made")
    options = parser.parse_args()
    for program in (PHAT, PEERS, LIVE):
        if not program.exists():
            sys.exit(f"{program.relative_to(ROOT)} is not built: make figures builds it")
    plan = QUICK if options.quick else FULL
    folder = ROOT / "out/figures" / plan.name
    if options.fresh:
        shutil.rmtree(folder, ignore_errors=True)

    shop = Workshop(folder)
    figures = Figures(plan, shop)
    results = {"paper": figures.paper_figures(), "rows": figures.by_roughness()}
    results["shown"] = figures.shown_methods(results["rows"])
    results["series"] = figures.convergence()
    results["frame"] = next(row for row in results["rows"]
                            if row["method"] == figures.methods[0] and row["roughness"] == SHOWN_ROUGHNESS)
    frame_seconds = results["frame"]["microseconds"] * pixels_of("480x270") / 1e6
    results["frame_seconds"] = frame_seconds
    results["equal_time"] = figures.equal_time(frame_seconds)
    results["equal_error"] = {method: equal_error(results["series"], results["equal_time"], method, results["frame"]["clean"])
                              for method in ("path", "photons-gather")}
    results["peers_elsewhere"] = figures.peers_elsewhere()
    results["cost"] = cost(figures)
    results["motion"] = motion(figures)
    results["live"] = live(shop)
    plot_live(figures.docs / "live.svg", results["live"])
    results["path_speed"] = path_speed(figures)
    results["goals"] = figures.goals()
    results["bakes"] = figures.bakes()
    results["storage"] = storage(figures.surfaces)
    results["whole"] = figures.whole()
    plot_results(figures.docs, results["rows"], results["series"])
    write_page(ROOT / "docs/results.md", figures, results)
    for left_over in figures.docs.iterdir():
        if left_over.name not in figures.written:
            left_over.unlink()
    shop.say("docs/results.md")


if __name__ == "__main__":
    main()
