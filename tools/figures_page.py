"""docs/results.md, from what figures.py measured."""

from figures_live import live_section
from figures_plot import slope
from figures_run import table
from figures_storage import storage_section
from goals import goals_table

MADE_BY = "make figures"


def pictures(shown, columns=3):
    """Captions above pictures, in rows of a table."""
    parts = []
    for first in range(0, len(shown), columns):
        part = shown[first:first + columns]
        parts.append(table([caption for _, caption in part], [[f"![]({path})" for path, _ in part]]))
    return "\n\n".join(parts)


def seconds(value):
    return "" if value is None else f"{value:.2f}" if value < 10 else f"{value:.0f}"


def signed(value):
    return f"{value:+.3f}"


def decimal(value):
    return f"{value:.1f}" if value < 100 else f"{value:,.0f}"


def name_of(method, figures):
    return f"`{method}`" if method in figures.methods or method == "path" else method


def three(row):
    """Of scattered pixels, which FLIP cannot see."""
    return [f"{row['relMse']:.3g}", f"{row['clean']:.3f}", signed(row["bias"])]


def four(row):
    return [f"{row['relMse']:.3g}", f"{row['maeOverMean']:.3f}", signed(row["bias"]), f"{row['flip']:.3f}"]


def phatexel_bytes(figures):
    return next(facts["phatexelBytes"] for (scene, _), facts in figures.peer_facts.items() if scene == "tabletop")


def roughness_summary(figures, rows):
    names = list(dict.fromkeys(row["method"] for row in rows))
    values = sorted({row["roughness"] for row in rows})
    found = {(row["method"], row["roughness"]): row for row in rows}
    body = []
    for name in names:
        facts = figures.peer_facts.get(("tabletop", name))
        used = facts["bytes"] if facts else phatexel_bytes(figures) if name.startswith("phat") else None
        body.append([name_of(name, figures), f"{used / 1e6:.2f}" if used else "", *(f"{found[name, value]['clean']:.3f}" for value in values)])
    body.append(["noise of the reference, taken off", "", *(f"{found[names[0], value]['noise']:.3f}" for value in values)])
    return table(["MAE/mean at roughness", "MB on the table"] + [f"{value:g}" for value in values], body)


def roughness_details(figures, rows):
    body = [[f"{row['roughness']:g}", name_of(row["method"], figures), "" if row["microseconds"] is None else decimal(row["microseconds"]),
             *three(row), f"{row['flip']:.3f}"] for row in rows]
    return table(["roughness", "method", "us a pixel", "relMSE", "MAE/mean", "bias", "FLIP"], body)


def convergence_table(figures, series):
    body = []
    for method, points in series.items():
        exponent = f"{slope([(p['work'], p['relMse']) for p in points]):+.2f}"
        for point in points:
            work = f"{point['work']:,.0f} {point['unit']}"
            body.append([name_of(method, figures), work, decimal(point["microseconds"]), *three(point),
                         exponent if point is points[-1] else ""])
    return table(["method", "work", "us a pixel", "relMSE", "MAE/mean", "bias", "slope"], body)


def equal_tables(figures, results):
    best, frame, took = figures.methods[0], results["frame"], results["frame_seconds"]
    time_rows = [[f"`{best}`", seconds(took), "", *three(frame)]]
    time_rows += [[f"`{row['method']}`", seconds(row["seconds"]), row["spp"], *three(row)] for row in results["equal_time"]]
    error_rows = [[f"`{best}`", "", seconds(took), "1", "measured"]]
    for method, found in results["equal_error"].items():
        if not found:
            error_rows.append([f"`{method}`", "", "", "", "its error does not fall with more rays"])
            continue
        error_rows.append([f"`{method}`", f"{found['work']:.0f} {found['unit']}", seconds(found["seconds"]),
                           f"{found['seconds'] / took:.1f}", found["how"]])
    return (table(["equal time", "s", "samples a pixel", "relMSE", "MAE/mean", "bias"], time_rows),
            table([f"equal error: MAE/mean {frame['clean']:.3f}", "work", "s", "times a frame", "how found"], error_rows))


def whole_table(figures, rows):
    body = [[f"`{row['scene']}`", f"`{row['test']}` against {row['against'] if row['against'] == 'Cycles' else '`path`'}",
             *four(row["all"]), row["kept"], *four(row["masked"])] for row in rows]
    head = ["relMSE", "MAE/mean", "bias", "FLIP"]
    return table(["scene", "", *head, "glossy part", *head], body)


def elsewhere_table(figures, rows):
    return table(["scene", "surface", "method", "MB", "relMSE", "MAE/mean", "bias", "reference's noise"],
                 [[f"`{row['scene']}`", row["material"], name_of(row["method"], figures), f"{row['bytes'] / 1e6:.2f}", *three(row),
                   f"{row['noise']:.3f}"] for row in rows])


def reads_text(reads):
    return "; ".join(f"{reads[of]['mean']:.0f} / {reads[of]['max']:.0f}" for of in ("indirect", "area"))


def bakes_table(bakes):
    """Of the first seed's."""
    body = []
    for one in bakes:
        bake, drawn = one["bake"], one["drawn"]
        body.append([one["name"], f"{bake['atlas']['finestTexelSize'] * 1e3:.2f} to {bake['atlas']['texelSize'] * 1e3:.1f}",
                     f"{bake['atlas']['width'] * bake['atlas']['height'] / 1e6:.2f} M", seconds(bake["seconds"]),
                     f"{one['fileBytes'] / 1e6:.1f}", f"{drawn['bytesPerPhatexel']:.1f}",
                     reads_text(one["reads"])])
    return table(["bake", "texels, mm", "texels in the atlas", "bake, s", "file, MB", "bytes a PHATexel",
                  "reads a pixel, mean / most: indirect; area lights"], body)


def cost_table(rows):
    body = []
    for row in rows:
        ms, counts = row["milliseconds"], row["instructions"]
        label = f"`{row['method']}`" + (f", `--quality {row['quality']}`" if row["quality"] else "")
        total = sum(value for key, value in ms.items() if key != "shadows")
        drawn = sum(ms[key] for key in ("depth", "lookup", "pool", "display"))
        body.append([label, *map(decimal, (ms["relight"], ms["pyramid"], drawn, ms["reflections"], total)),
                     "" if row["reads"] is None else reads_text(row["reads"]),
                     ", ".join(f"{name} {count}" for name, count in counts.items())])
    return table(["frame", "relight, ms", "pyramid, ms", "lookup and display, ms", "rays, ms", "all, ms", "reads a pixel, mean / most: indirect; area lights",
                  "SPIR-V instructions"], body)


def steadiness_table(motion):
    def cells(kind, name):
        one = motion[kind][name]
        return [f"{one['mean']:.4f}", f"{one['worst']:.4f}", f"{one['mean'] / motion[kind]['path']['mean']:.2f}"]

    return table(["method", "pan: mean", "most", "times that of `path`", "dolly: mean", "most", "times that of `path`"],
                 [[name if " " in name else f"`{name}`", *cells("pan", name), *cells("dolly", name)] for name in motion["pan"]])


def lag_table(lag):
    return table(["method", "error in the first frame at rest", "settled", "frames until within a tenth of it"],
                 [[name, f"{one['first']:.4f}", f"{one['settled']:.4f}", one["frames"]] for name, one in lag.items()])


def write_page(path, figures, results):
    plan, best = figures.plan, figures.methods[0]
    quick = plan.name == "quick"
    equal_time, equal_error_table = equal_tables(figures, results)
    paper, frame, speed, motion = results["paper"], results["frame"], results["path_speed"], results["motion"]
    rays_a_texel = next(facts["raysPerTexel"] for facts in figures.peer_facts.values() if "raysPerTexel" in facts)
    pixels, spp = plan.reference.pixels, plan.reference.spp
    body = f"""# Results in detail

This page, its tables and its pictures are written by `{MADE_BY}{' QUICK=1' if quick else ''}` (`tools/figures.py`); nothing
on it is typed. {'**It is from a quick run: few pixels, few samples, noisy references. `make figures` makes the whole one.**' if quick else '`make figures QUICK=1` makes a smaller one.'}
Intermediate results are cached in `out/figures/` and reused by the next run.

All times are of a machine with **2 cores and no GPU**: OpenGL is Mesa's software driver. The bake (and the tracing of
photons) is not counted. Pictures are shown one stop brighter than they are. The metrics are those of `phat compare`
([reference.md](reference.md#metrics)). Paper: Hensley et al. 2003.

**How errors are measured.** But for whole pictures, of glossy indirect light alone, against `path` with {spp:,} samples in each of {pixels:,}
pixels at random on the surface. All show the centres of pixels (`--pixel-filter center`): one
frame, no anti-aliasing. Where a material is changed after the bake, the reference's light is that of the file's materials, too
(`--keep-light`), since a bake cannot contain any other. The reference's noise is known from its variance and subtracted:
MAE/mean is `sqrt(MAE^2 - noise^2)`, as squares of independent errors add up. FLIP, which looks at neighbourhoods, is measured in a
window of 180x60 pixels where objects touch the table, against {plan.window_spp} samples a pixel.

## The paper's figures

**Figure 1.** A metal table top reflects a chequered crate, a globe, a cone and coloured walls: `scenes/tabletop.glb`,
drawn by `{best}` from a bake with default settings.

{pictures(paper["1"])}

**Figure 4.** What the PHATexels in the middle of the table top hold, and what is drawn from them. Neighbours look in different directions;
black are those whose rays hit nothing that reflects, and those under the objects.

{pictures(paper["4"])}

**Figure 5.** The paper's filter (`phat-gather` with `--radius`) over neighbourhoods of three sizes.
A small one has too few samples, which is noise; a large one blurs and smears what touches the table.

{pictures(paper["5"])}

**Figure 6.** The paper's two photon-map solutions: photons gathered at the visible point, and at the first bounce
({plan.gather_rays} rays a pixel). The third is `path` with {plan.shown_spp} samples a pixel.

{pictures(paper["6"])}

**Figure 7.** How a cone of 12 texels is approximated: by the paper's bilinear taps of several pyramid levels (`phat-paper`),
and by the taps of one level that `phat-pyramid` weighs by the cone. The levels' squares are not centred at the pixel; the taps' are steps.

{pictures(paper["7"])}

## Methods by roughness

The table top in the file's view, 480x270, from a bake with default settings. `photons-gather` has {plan.gather_rays} rays a pixel.

The last rows are **peers** (`bench/peers`): a box-projected, prefiltered reflection probe, and a lightmap of 9 spherical gaussians. Each
may use as many bytes as the PHATexels of the table have, and is baked with the same path tracing. Both are given more than
engines give them: the probe a prefiltered level for exactly this roughness, the gaussians {rays_a_texel} rays a texel. "Exact BRDF" reads the gaussians
by sampling instead of engines' closed form. Their times would say nothing: they are not drawn by OpenGL.

{roughness_summary(figures, results["rows"])}

![](figures/roughness.svg)

At roughness .25, 240x135 (`path` with {plan.shown_spp} samples a pixel):

{pictures(results["shown"])}

{roughness_details(figures, results["rows"])}

The default bakes of the other scenes against peers of as many bytes, on their floors:

{elsewhere_table(figures, results["peers_elsewhere"])}

## Goals

`{best}` in a single frame and in the mean of eight frames of a still view, and `phat-gather`, by the size of the table's texels (mm), view,
material and roughness. Errors are two standard errors over bakes with different seeds, where there are several.
`phat` traces what PHATexels are too coarse for on the CPU, "GPU rays" are those of moving views and of the page (`--trace gpu`), and
"lookup alone" is without rays (`--reflections lookup`). "Met" is judged without the reference's noise.

{goals_table(results["goals"])}

What these bakes take and hold; reads of a single frame at the size above, for glossy light:

{bakes_table(results["bakes"])}

{storage_section(results["storage"])}## Equal time, equal error

A frame of `{best}` against what tracing reaches in its time, and the time that tracing takes to its error: the table top at roughness .25,
480x270. At equal time `photons-gather` has one ray a sample; one sample is the least that either takes. The work to
an equal error is read off the convergence below, its time is that of the same samples in the whole frame.

{equal_time}

{equal_error_table}

## Cost of a frame

`scenes/tabletop.glb` with all its light, 640x360, one sample a pixel. `phat-paper` is the paper's three passes. Instructions are those of the
fragment shaders as SPIR-V (`glslangValidator`, `spirv-opt -O`), with all functions inlined and loops counted once. `relight` and `pyramid` are
drawn by the texel, the others by the pixel. Reads are those of the indirect glossy light.

{cost_table(results["cost"])}

## Moving views

The camera turns by {motion['degrees']:g} degrees, or moves forward by {100 * motion['meters']:g} cm, in {motion['frames']} frames; mean change of a pixel from one
frame to the next over the mean, of 300 pixels in the middle of the table, one sample each; `path` has {motion['spp']} samples a pixel in
every frame. Most of it is the picture's own motion. "GPU rays" are those of a window that moves: earlier frames' rays
count (`--follow`).

{steadiness_table(motion)}

A turn by {motion['turnDegrees']:g} degrees in {motion['turnFrames']} frames, after which the view rests while frames go on being drawn; MAE/mean against `path`:

{lag_table(motion["lag"])}

{live_section(results["live"])}## The path tracer

On `scenes/tabletop.glb`, 480x270, all light, `path` with {speed['spp']} samples a pixel has a relMSE of {speed['relMse']:.4f} against Cycles' picture in {speed['seconds']:.1f} s.
The error of independent samples falls with their number: .01 takes about **{speed['samples']:.0f} samples and {speed['secondsToError']:.0f} s**, {speed['guideSeconds']:.1f} s of them to learn the guide.
Cycles takes .22 s a sample on 2 such cores and about 145 samples: 32 s.

## Convergence

The table top at roughness .25 while each method is given more: photons, gather rays, texels, samples. The slope is a least-squares fit
of log relMSE over log work; -1 is that of independent samples, 0 that of a method whose error is not noise.

![](figures/convergence.svg)

{convergence_table(figures, results["series"])}

## Whole pictures

All light, 4 samples a pixel, at the size of the references in `tests/data/references/`, which are Blender Cycles'; `path` has {plan.whole_spp} samples a pixel,
whose noise is part of every comparison with it. FLIP with an exposure of one stop. Shown at half size.

{whole_table(figures, results["whole"])}

""" + "\n\n".join(
        f"`{scene}`\n\n" + pictures([(f"figures/{scene}-{method}.png", label) for method, label in
                                    ((best, f"`{best}`"), ("cycles", "Cycles"))])
        for scene in dict.fromkeys(row["scene"] for row in results["whole"])) + "\n"
    path.write_text(body)
