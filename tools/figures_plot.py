"""Line plots as SVG."""

import html
import math

WIDTH, HEIGHT = 640, 400
LEFT, RIGHT, TOP, BOTTOM = 64, 190, 20, 48
# Okabe and Ito's colours, which colour-blind readers can tell apart.
COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999", "#b8a800", "#7a5230", "#8050c0"]


class Axis:
    def __init__(self, values, begin, end, log):
        self.log = log
        low, high = min(values), max(values)
        if log:
            margin = (high / low) ** 0.05 if high > low else 2
            low, high = low / margin, high * margin
        elif high == low:
            high = low + 1
        self.low, self.high, self.begin, self.end = low, high, begin, end

    def scale(self, value):
        return math.log(value) if self.log else value

    def place(self, value):
        share = (self.scale(value) - self.scale(self.low)) / (self.scale(self.high) - self.scale(self.low))
        return self.begin + share * (self.end - self.begin)

    def ticks(self):
        if self.log:
            decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
            wide = self.high / self.low > 300
            steps = [m * 10.0**d for d in decades for m in ((1,) if wide else (1, 2, 5))]
        else:
            step = 10 ** math.floor(math.log10((self.high - self.low) / 2))
            if (self.high - self.low) / step > 8:
                step *= 2
            steps = [step * i for i in range(math.floor(self.low / step), math.ceil(self.high / step) + 1)]
        return [tick for tick in steps if self.low * 0.9999 <= tick <= self.high * 1.0001]


def label_of(tick):
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if abs(tick) >= size:
            return f"{tick / size:g}{letter}"
    return f"{tick:.6g}"


def line_plot(path, series, x_label, y_label, log_x=False, log_y=False):
    """`series`: name -> [(x, y), ...]. A name that ends in " (dashed)" is drawn so."""
    points = [point for line in series.values() for point in line]
    x_axis = Axis([x for x, _ in points], LEFT, WIDTH - RIGHT, log_x)
    y_axis = Axis([y for _, y in points], HEIGHT - BOTTOM, TOP, log_y)
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}"'
        ' font-family="sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>',
    ]

    def text(x, y, words, anchor="middle", more=""):
        out.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {more}>{html.escape(words)}</text>')

    for tick in x_axis.ticks():
        x = x_axis.place(tick)
        out.append(f'<path d="M{x:.1f} {TOP}V{bottom}" stroke="#ddd"/>')
        text(x, bottom + 16, label_of(tick))
    for tick in y_axis.ticks():
        y = y_axis.place(tick)
        out.append(f'<path d="M{LEFT} {y:.1f}H{right}" stroke="#ddd"/>')
        text(LEFT - 6, y + 4, label_of(tick), "end")
    out.append(f'<rect x="{LEFT}" y="{TOP}" width="{right - LEFT}" height="{bottom - TOP}" fill="none" stroke="#444"/>')
    text((LEFT + right) / 2, HEIGHT - 12, x_label)
    text(16, (TOP + bottom) / 2, y_label, more=f'transform="rotate(-90 16 {(TOP + bottom) / 2:.0f})"')

    for i, (name, line) in enumerate(series.items()):
        color = COLORS[i % len(COLORS)]
        dashed = name.endswith(" (dashed)")
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        path_data = "M" + "L".join(f"{x_axis.place(x):.1f} {y_axis.place(y):.1f}" for x, y in line)
        out.append(f'<path d="{path_data}" fill="none" stroke="{color}" stroke-width="2"{dash}/>')
        if len(line) < 20:
            out += [f'<circle cx="{x_axis.place(x):.1f}" cy="{y_axis.place(y):.1f}" r="3" fill="{color}"/>' for x, y in line]
        legend_y = TOP + 12 + 18 * i
        out.append(f'<path d="M{right + 10} {legend_y - 4}h20" stroke="{color}" stroke-width="2"{dash}/>')
        text(right + 36, legend_y, name.removesuffix(" (dashed)"), "start")
    out.append("</svg>")
    path.write_text("\n".join(out) + "\n")


def slope(points):
    """Least-squares exponent of y ~ x^s."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean_x = sum(x for x, _ in logs) / len(logs)
    mean_y = sum(y for _, y in logs) / len(logs)
    return sum((x - mean_x) * (y - mean_y) for x, y in logs) / sum((x - mean_x) ** 2 for x, _ in logs)
