"""Figure 7: sections through the cone, through pyramid levels that stand for it, and through this program's taps."""

import math

from figures_plot import line_plot

RADIUS = 12.0  # texels
CENTER = (0.37, 0.21)  # of the pixel within its texel: nowhere in particular
LEVELS = range(4)  # whose texels are up to as wide as the radius
TAPS_RADIUS = 3.0  # kRadiusInTaps of shaders/lib/cone.glsl


def bilinear_weight(level, offset, center):
    """Weight along one axis of what is `offset` texels from the pixel in a bilinear tap at `level`."""
    size = 2**level
    place = center / size - 0.5
    low = math.floor(place)
    cell = math.floor((offset + center) / size)
    share = {low: 1 - (place - low), low + 1: place - low}.get(cell, 0)
    return share / size


def levels_profile(offset_x):
    """A bilinear tap of each level. A cone is a mean of discs of growing radius, a disc's part in proportion to
    its area and to the step of the radius: 8 times as much a level."""
    return sum(8**level * bilinear_weight(level, offset_x, CENTER[0]) * bilinear_weight(level, 0, CENTER[1])
               for level in LEVELS)


def taps_profile(offset_x):
    """Cone-weighted taps of the finest level at which the radius is at most TAPS_RADIUS texels."""
    size = 2 ** max(math.ceil(math.log2(RADIUS / TAPS_RADIUS)), 0)
    center_x, center_y = CENTER[0] / size, CENTER[1] / size
    tap_x = math.floor((offset_x + CENTER[0]) / size)
    tap_y = math.floor(center_y)
    distance = math.hypot(tap_x + 0.5 - center_x, tap_y + 0.5 - center_y)
    return max(1 - distance / (RADIUS / size), 0)


def pyramid_profile(path):
    offsets = [i / 20 for i in range(-320, 321)]
    profiles = {
        "cone": [max(1 - abs(x) / RADIUS, 0) for x in offsets],
        "bilinear, 4 levels": [levels_profile(x) for x in offsets],
        "taps of one level": [taps_profile(x) for x in offsets],
    }
    lines = {}
    for name, values in profiles.items():
        total = sum(values)
        lines[name] = [(x, value / total * len(values)) for x, value in zip(offsets, values)]
    line_plot(path, lines, "texels from the pixel, along a row", "weight, mean 1")
