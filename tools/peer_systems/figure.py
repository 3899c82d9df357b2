"""Curves as SVG, in the manner of src/core/plot.cpp."""
import html
import math

WIDTH, HEIGHT, LEFT, LEGEND, TOP, BOTTOM = 900, 330, 74, 290, 34, 44  # of a panel, its margins
# M. Okabe and K. Ito, "Color universal design" (2008).
COLOURS = ("#0072b2", "#56b4e9", "#d55e00", "#009e73", "#e69f00", "#cc79a7", "#555555")


def _text(x, y, anchor, what, more=""):
    return f"<text x='{x:.1f}' y='{y:.1f}' text-anchor='{anchor}'{more}>{html.escape(what)}</text>\n"


def _decades(values):
    logs = [math.log10(value) for value in values]
    return math.floor(min(logs) + 1e-9), math.ceil(max(logs) - 1e-9)


def _label(decade):
    return f"{10.0 ** decade:g}" if -4 <= decade <= 3 else f"1e{decade}"


def _panel(down, title, curves, colours, x_range, y_range):
    right, bottom, top = WIDTH - LEGEND, down + HEIGHT - BOTTOM, down + TOP

    def across(value):
        return LEFT + (math.log10(value) - x_range[0]) / (x_range[1] - x_range[0]) * (right - LEFT)

    def up(value):
        return bottom - (math.log10(value) - y_range[0]) / (y_range[1] - y_range[0]) * (bottom - top)

    svg = _text(LEFT, down + 20, "start", title, " font-size='14'")
    for decade in range(x_range[0], x_range[1] + 1):
        at = across(10.0 ** decade)
        svg += f"<path d='M{at:.1f} {top}V{bottom}' stroke='#ddd'/>\n"
        svg += _text(at, bottom + 16, "middle", _label(decade))
    for decade in range(y_range[0], y_range[1] + 1):
        at = up(10.0 ** decade)
        svg += f"<path d='M{LEFT} {at:.1f}H{right}' stroke='#ddd'/>\n" + _text(LEFT - 6, at + 4, "end", _label(decade))
    svg += f"<path d='M{LEFT} {top}V{bottom}H{right}' fill='none' stroke='#333'/>\n"
    svg += _text((LEFT + right) / 2, bottom + 36, "middle", "CPU time without start-up [s]")
    svg += _text(0, 0, "middle", "relative RMSE", f" transform='translate(14 {(top + bottom) / 2}) rotate(-90)'")
    row = top + 8
    for curve in curves:
        is_ours = curve.system == "vitrum"
        stroke = f"stroke='{colours[curve.name]}' stroke-width='{2.5 if is_ours else 1.5}'"
        places = [(across(point.compute), up(point.error)) for point in curve.points]
        svg += f"<polyline fill='none' {stroke} points='{' '.join(f'{x:.1f},{y:.1f}' for x, y in places)}'/>\n"
        svg += "".join(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='2.5' fill='{colours[curve.name]}'/>\n" for x, y in places)
        svg += f"<path d='M{right + 12} {row - 4}h22' {stroke}/>\n" + _text(right + 40, row, "start", curve.name)
        svg += _text(right + 40, row + 14, "start", f"slope {curve.slope('compute'):.2f}", " fill='#555'")
        row += 34
    return svg


def figure_svg(panels):
    """Panels, each a title and its curves, one above the other on the same axes."""
    every = [point for _, curves in panels for curve in curves for point in curve.points]
    x_range, y_range = _decades(p.compute for p in every), _decades(p.error for p in every)
    names = dict.fromkeys(curve.name for _, curves in panels for curve in curves)
    colours = {name: COLOURS[min(k, len(COLOURS) - 1)] for k, name in enumerate(names)}
    height = HEIGHT * len(panels)
    svg = (f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {height}' width='{WIDTH}' height='{height}' "
           f"font-family='sans-serif' font-size='12'>\n<rect width='{WIDTH}' height='{height}' fill='#fff'/>\n")
    for k, (title, curves) in enumerate(panels):
        svg += _panel(k * HEIGHT, title, curves, colours, x_range, y_range)
    return svg + "</svg>\n"
