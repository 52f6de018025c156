"""docs/results.md, from what figures.py measured."""

from figures_plot import slope

MADE_BY = "make figures"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])


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


def name_of(method, figures):
    return f"`{method}`" if method in figures.methods or method == "path" else method


def four(row):
    return [f"{row['relMse']:.3g}", f"{row['maeOverMean']:.3f}", signed(row["bias"]), f"{row['flip']:.3f}"]


def roughness_summary(figures, rows):
    names = list(dict.fromkeys(row["method"] for row in rows))
    values = sorted({row["roughness"] for row in rows})
    found = {(row["method"], row["roughness"]): row for row in rows}
    body = []
    for name in names[1:] + names[:1]:
        label = "noise of the reference" if name == "path" else name_of(name, figures)
        facts = figures.peer_facts.get(name)
        size = f"{(facts['bytes'] if facts else found_bytes(figures)) / 1e6:.2f}" if facts or name.startswith("phat-") or name == "phat" else ""
        body.append([label, size] + [f"{found[name, value]['maeOverMean']:.3f}" for value in values])
    return table(["MAE/mean at roughness", "MB on the table"] + [f"{value:g}" for value in values], body)


def found_bytes(figures):
    return next(iter(figures.peer_facts.values()))["phatexelBytes"]


def roughness_details(figures, rows):
    body = []
    for row in rows:
        noise = row["method"] == "path"
        label = "`path` against itself" if noise else name_of(row["method"], figures)
        body.append([f"{row['roughness']:g}", label, seconds(row["seconds"]), *four(row)])
    return table(["roughness", "method", "s", "relMSE", "MAE/mean", "bias", "FLIP"], body)


def convergence_table(figures, series):
    body = []
    for method, points in series.items():
        kept = [point for point in points if point["relMse"] > 0]
        exponent = f"{slope([(p['work'], p['relMse']) for p in kept]):+.2f}" if len(kept) > 1 else ""
        for point in points:
            work = f"{point['work']:,.0f} {point['unit']}"
            last = exponent if point is points[-1] else ""
            body.append([name_of(method, figures), work, seconds(point["seconds"]), *four(point), last])
    return table(["method", "work", "s", "relMSE", "MAE/mean", "bias", "FLIP", "slope"], body)


def equal_error(series, method, error, pixels):
    """(seconds, how they were found) in which a method reaches an error, for `pixels` times the series' picture."""
    points = [(pixels * point["seconds"], point["maeOverMean"]) for point in series[method]]
    exponent = slope(points)
    if exponent > -0.1:
        return "", "its error does not fall with more rays"
    nearest = min(points, key=lambda point: abs(point[1] - error))
    found = nearest[0] * (error / nearest[1]) ** (1 / exponent)
    inside = min(p[1] for p in points) <= error <= max(p[1] for p in points)
    return seconds(found), "between measured points" if inside else f"extrapolated with slope {exponent:.2f}"


def pixels_of(size):
    width, height = size.split("x")
    return int(width) * int(height)


def equal_tables(figures, results):
    pixels = pixels_of(figures.plan.table_size) / pixels_of(figures.plan.series_size)
    best, frame = figures.methods[0], results["frame"]
    time_rows = [[f"`{best}`", seconds(frame["seconds"]), "", *four(frame)]]
    time_rows += [[f"`{row['method']}`", seconds(row["seconds"]), row["spp"], *four(row)] for row in results["equal_time"]]
    error_rows = [[f"`{best}`", seconds(frame["seconds"]), "measured"]]
    for method in ("path", "photons-gather"):
        error_rows.append([f"`{method}`", *equal_error(results["series"], method, frame["maeOverMean"], pixels)])
    return (table(["equal time", "s", "samples a pixel", "relMSE", "MAE/mean", "bias", "FLIP"], time_rows),
            table([f"equal error: MAE/mean {frame['maeOverMean']:.3f}", "s", "how found"], error_rows))


def whole_table(figures, rows):
    body = [[f"`{row['scene']}`", f"`{row['test']}` against {row['against'] if row['against'] == 'Cycles' else '`path`'}",
             *four(row["all"]), row["kept"], *four(row["masked"])] for row in rows]
    head = ["relMSE", "MAE/mean", "bias", "FLIP"]
    return table(["scene", "", *head, "glossy part", *head], body)


def write_page(path, plan, figures, results):
    best = figures.methods[0]
    noise = results["series_noise"]
    equal_time, equal_error_table = equal_tables(figures, results)
    paper = results["paper"]
    quick = plan.name == "quick"
    size = plan.table_size
    body = f"""# Results in detail

This page, its tables and its pictures are written by `{MADE_BY}{' QUICK=1' if quick else ''}` (`tools/figures.py`); nothing
on it is typed. {'**It is from a quick run: small pictures, few samples, noisy references. `make figures` makes the whole one.**' if quick else '`make figures QUICK=1` makes a smaller one in five minutes.'}
What a run made is kept in `out/figures/` and used again by the next.

All times are of a machine with **2 cores and no GPU**: OpenGL is Mesa's software driver. The bake (and the tracing of
photons) is not counted. Pictures are shown one stop brighter than they are. The metrics are those of `phat compare`
([pipeline.md](pipeline.md), section 12), FLIP with the same exposure. Paper: Hensley et al. 2003.

## The paper's figures

**Figure 1.** A metal table top reflects a chequered crate, a globe, a cone and coloured walls: `scenes/tabletop.glb`,
drawn by `{best}` from a bake with default settings.

{pictures(paper["1"])}

**Figure 4.** What the PHATexels in the middle of the table top hold, and what is drawn from them. Neighbours look in different directions;
black are those that see nothing that reflects, and those under the objects.

{pictures(paper["4"])}

**Figure 5.** The paper's filter (`phat-gather` with `--radius`) over neighbourhoods of three sizes.
A small one has too few samples, which is noise; a large one blurs and smears what touches the table.

{pictures(paper["5"])}

**Figure 6.** The paper's two photon-map solutions, {size}: photons gathered at the visible point, and at the first bounce
({plan.gather_rays} rays a pixel). The third is `path` with {plan.whole_spp} samples a pixel.

{pictures(paper["6"])}

**Figure 7.** How a cone of 12 texels is approximated: by the paper's bilinear taps of several pyramid levels (`phat-paper`),
and by the taps of one level that `phat-pyramid` weighs by the cone. The levels' squares are not centred at the pixel; the taps' are steps.

{pictures(paper["7"])}

## Methods by roughness

The table top's glossy indirect light, on the pixels that show the table top and nothing else, {size}. The bake was made
with the file's roughness; the material is changed when the picture is made (`--set`). The reference is `path` at the same roughness,
{plan.reference_spp} samples a pixel; its noise is estimated from a second picture with other random numbers, and is part of every figure. `photons-gather` has {plan.gather_rays} rays a pixel.

The last rows are **peers** (`bench/peers`): a box-projected, prefiltered reflection probe, and a lightmap of 9 spherical gaussians. Each
may use as many bytes as the PHATexels of the table have, and is baked with the same path tracing. Both are given more than
engines give them: the probe a prefiltered level for exactly this roughness, the gaussians {next(f['raysPerTexel'] for f in figures.peer_facts.values() if 'raysPerTexel' in f)} rays a texel. "Exact BRDF" reads the gaussians
by sampling instead of engines' closed form. Their times would say nothing: they are not drawn by OpenGL.

{roughness_summary(figures, results["rows"])}

![](figures/roughness.svg)

At roughness .25:

{pictures(results["shown"])}

{roughness_details(figures, results["rows"])}

## Equal time, equal error

A frame of `{best}` against what tracing reaches in its time, and the time that tracing takes to its error: glossy indirect light of the table
top at roughness .25, {size}. At equal time `photons-gather` has one ray a sample; one sample is the least that either takes. The times to
an equal error are those of the convergence below, by the number of pixels. Both cost by the pixel, but for the lamps' light,
which a frame of `{best}` first shades on all texels.

{equal_time}

{equal_error_table}

## Convergence

The same light while each method is given more: photons, gather rays, texels, samples. The slope is a least-squares fit
of log relMSE over log work; -1 is that of independent samples, 0 that of a method whose error is not noise. The reference has
{noise['spp']} samples a pixel and a noise of {noise['relMse']:.3g} (relMSE), which is taken off, and {noise['maeOverMean']:.3f} (MAE/mean), which is not.

![](figures/convergence.svg)

{convergence_table(figures, results["series"])}

## Whole pictures

All light, at the size of the references in `tests/data/references/`, which are Blender Cycles'; `path` has {plan.whole_spp} samples a pixel,
whose noise is part of every comparison with it. Shown at half size.

{whole_table(figures, results["whole"])}

""" + "\n\n".join(
        f"`{scene}`\n\n" + pictures([(f"figures/{scene}-{method}.png", label) for method, label in
                                    ((best, f"`{best}`"), ("cycles", "Cycles"))])
        for scene in dict.fromkeys(row["scene"] for row in results["whole"])) + "\n"
    path.write_text(body)
