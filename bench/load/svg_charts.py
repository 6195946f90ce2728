"""Charts as SVG elements: lines over a logarithmic scale, and stacked bars.

A chart is drawn in units of one pixel, WIDTH x HEIGHT, and scales with its page. Whatever is drawn
has a <title> with its numbers, which browsers show where the pointer is.
"""
import math
import xml.etree.ElementTree as ET

WIDTH, HEIGHT = 560, 300
LEFT, RIGHT, TOP, BOTTOM = 64, 16, 12, 40
PLOT_WIDTH, PLOT_HEIGHT = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

# Okabe and Ito (2008): told apart by those who do not see all colours, too.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#f0e442"]


def colour(index):
    return COLOURS[index % len(COLOURS)]


def add(parent, tag, text=None, **attributes):
    """A child; `class_` and `text_anchor` are written as `class` and `text-anchor`."""
    names = {key.rstrip("_").replace("_", "-"): str(value) for key, value in attributes.items()}
    child = ET.SubElement(parent, tag, names)
    child.text = text
    return child


def short(number):
    """Three digits and a suffix: 1234567 is 1.23M."""
    for suffix in ("", "k", "M"):
        if abs(number) < 999.5:
            return f"{number:.3g}{suffix}"
        number /= 1000
    return f"{number:.3g}G"


def new_chart(parent):
    return add(parent, "svg", viewBox=f"0 0 {WIDTH} {HEIGHT}", xmlns="http://www.w3.org/2000/svg",
               role="img")


def label(svg, text, x, y, anchor="middle"):
    add(svg, "text", text, x=f"{x:.1f}", y=f"{y:.1f}", text_anchor=anchor)


def grid_line(svg, y, text):
    add(svg, "line", class_="grid", x1=LEFT, x2=WIDTH - RIGHT, y1=f"{y:.1f}", y2=f"{y:.1f}")
    label(svg, text, LEFT - 6, y + 4, "end")


def log_ticks(low, high):
    """1, 2 and 5 times powers of ten that enclose [low, high], thinned to the powers when many."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    steps = (1, 2, 5) if last - first <= 2 else (1,)
    ticks = [step * 10.0**power for power in range(first, last + 1) for step in steps]
    below = [tick for tick in ticks if tick <= low * (1 + 1e-9)]
    above = [tick for tick in ticks if tick >= high * (1 - 1e-9)]
    bottom, top = (below or ticks)[-1], (above or ticks)[0]
    top = top if top > bottom else bottom * 10
    return [tick for tick in ticks if bottom <= tick <= top] or [bottom, top]


def add_marker(svg, x, y, ink, told, hollow):
    circle = add(svg, "circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=4, stroke=ink,
                 fill="#fff" if hollow else ink)
    add(circle, "title", told)


def line_chart(parent, series, x_ticks, y_unit):
    """One line each of `series`, over a logarithmic y axis.

    series: (name, [(x, y, hollow), ...]) with y > 0; x_ticks: [(x, text), ...], which span the x
    axis.
    """
    svg = new_chart(parent)
    values = [y for _, points in series for _, y, _ in points]
    if not values:
        label(svg, "nothing was measured", WIDTH / 2, HEIGHT / 2)
        return svg
    ticks = log_ticks(min(values), max(values))
    low, high = math.log10(ticks[0]), math.log10(ticks[-1])
    x_low, x_high = x_ticks[0][0], x_ticks[-1][0]

    def place(x, y):
        along = (x - x_low) / ((x_high - x_low) or 1)
        up = (math.log10(y) - low) / (high - low)
        return LEFT + PLOT_WIDTH * (0.03 + 0.94 * along), TOP + PLOT_HEIGHT * (1 - up)

    for tick in ticks:
        grid_line(svg, place(x_low, tick)[1], f"{short(tick)} {y_unit}")
    for x, text in x_ticks:
        label(svg, text, place(x, ticks[0])[0], HEIGHT - BOTTOM + 18)
    for index, (name, points) in enumerate(series):
        places = [place(x, y) for x, y, _ in points]
        add(svg, "polyline", fill="none", stroke=colour(index), stroke_width=2,
            points=" ".join(f"{x:.1f},{y:.1f}" for x, y in places))
        for (x, y), (_, value, hollow) in zip(places, points):
            add_marker(svg, x, y, colour(index), f"{name}: {value:.4g} {y_unit}", hollow)
    return svg


def bar_chart(parent, names, parts, unit):
    """A bar for each of `names`, stacked of `parts`: [(part's name, ink, a value for each bar)]."""
    svg = new_chart(parent)
    totals = [sum(values[i] for _, _, values in parts) for i in range(len(names))]
    top = max(totals, default=0) or 1
    for step in range(5):
        y = TOP + PLOT_HEIGHT * (1 - step / 4)
        grid_line(svg, y, short(top * step / 4))
    pitch = PLOT_WIDTH / max(len(names), 1)
    for i, name in enumerate(names):
        x, y = LEFT + pitch * (i + 0.2), TOP + PLOT_HEIGHT
        for part, ink, values in parts:
            height = PLOT_HEIGHT * values[i] / top
            y -= height
            bar = add(svg, "rect", x=f"{x:.1f}", y=f"{y:.1f}", width=f"{pitch * 0.6:.1f}",
                      height=f"{height:.1f}", fill=ink(i) if callable(ink) else ink)
            add(bar, "title", f"{name}, {part}: {values[i]:.6g} {unit}".strip())
        label(svg, name if len(names) < 6 else str(i + 1), x + pitch * 0.3, HEIGHT - BOTTOM + 18)
    return svg
