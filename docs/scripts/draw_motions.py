#!/usr/bin/env python3
"""Draws the pictures of docs/user/motions.md as SVG on standard output.

usage: draw_motions.py manoeuvres                    the motions that calibrate offers, seen from above
       draw_motions.py look-alikes                   why one speed cannot separate a late clock from slip
       draw_motions.py coverage GUIDED.tum LAZY.tum  two drives in the plane of speed and turn rate

docs/scripts/make_motion_pictures makes all three.
"""
import math
import sys

INK, GREY, RED, BLUE, GREEN = "#111111", "#9a9a9a", "#d62728", "#1f77b4", "#2ca02c"


def svg(width, height, body):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
            f'font-size="13"><rect width="100%" height="100%" fill="#ffffff"/>\n' + "\n".join(body) + "\n</svg>")


def text(x, y, words, size=13, colour=INK, anchor="start"):
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" text-anchor="{anchor}">{words}</text>'


def polyline(points, colour=INK, width=1.6, dashes=""):
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    where = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{where}" fill="none" stroke="{colour}" stroke-width="{width}"{dashed}/>'


def arrow_head(at, before, colour=INK, size=6.0):
    angle = math.atan2(at[1] - before[1], at[0] - before[0])
    corners = [at] + [(at[0] - size * math.cos(angle + side), at[1] - size * math.sin(angle + side))
                      for side in (0.45, -0.45)]
    where = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return f'<polygon points="{where}" fill="{colour}"/>'


def arrow(points, colour=INK, width=1.6):
    return [polyline(points, colour, width), arrow_head(points[-1], points[-2], colour)]


def circle_part(centre, radius, begin, end, steps=40):
    """Points of an arc; angles in degrees, counter-clockwise as seen."""
    angles = [math.radians(begin + (end - begin) * k / steps) for k in range(steps + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] - radius * math.sin(a)) for a in angles]


# --- The manoeuvres ------------------------------------------------------------------------------------------

PANEL_W, PANEL_H = 178.0, 176.0


def robot(x, y, heading=0.0):
    """A chassis with two wheels and a nose, heading in degrees."""
    return (f'<g transform="translate({x:.1f} {y:.1f}) rotate({-heading:.0f})"><circle r="9" fill="#e8e8e8" stroke="{INK}"/>'
            f'<rect x="-5" y="-11" width="10" height="3.5" fill="{INK}"/><rect x="-5" y="7.5" width="10" height="3.5" '
            f'fill="{INK}"/><path d="M 4 -3 L 9 0 L 4 3" fill="none" stroke="{INK}"/></g>')


def out_and_back(x, y, length, gap=4.0, colour=INK):
    return (arrow([(x + 13, y - gap), (x + length, y - gap)], colour)
            + arrow([(x + length, y + gap), (x + 13, y + gap)], GREY))


def straights(x, y):
    body = []
    for row, (length, speed) in enumerate(((120.0, "0.1 m/s"), (120.0, "0.2 m/s"), (120.0, "0.3 m/s"))):
        body += [robot(x - 55, y - 36 + 36 * row)] + out_and_back(x - 55, y - 36 + 36 * row, length)
        body.append(text(x + 6, y - 36 + 36 * row - 8, speed, 11, GREY, "middle"))
    return body


def slow_straights(x, y):
    """The wheels' turns are marked on the way."""
    body = [robot(x - 62, y)] + out_and_back(x - 62, y, 130)
    for k in range(6):
        body.append(f'<circle cx="{x - 38 + 18 * k:.1f}" cy="{y - 20:.1f}" r="7" fill="none" stroke="{BLUE}"/>')
        body.append(polyline([(x - 38 + 18 * k, y - 20), (x - 38 + 18 * k, y - 27)], BLUE, 1.2))
    return body + [text(x + 6, y - 36, "whole turns of a wheel", 11, BLUE, "middle")]


def turns(x, y):
    body = [robot(x, y)]
    for radius, end in ((18, 350), (30, 180), (42, 90)):
        body += arrow(circle_part((x, y), radius, 5, end))
    for radius, end in ((24, -170), (36, -90)):
        body += arrow(circle_part((x, y), radius, -10, end), GREY)
    return body


def arcs(x, y):
    body = [robot(x, y)]
    for radius, colour in ((36, INK), (66, BLUE)):
        sweep = 88 if radius == 36 else 62
        for side in (1, -1):
            centre = (x, y - side * radius)
            # Left bends turn counter-clockwise from the lowest point of their circle.
            low, begin = -90 * side, 16 * 36 / radius
            for way in (side, -side):  # ahead, and backward
                body += arrow(circle_part(centre, radius, low + way * begin, low + way * sweep), colour)
    return body


def accelerations(x, y):
    """Speed over time: equal ramps to a low and to a high speed."""
    left, base = x - 70.0, y + 34.0
    profile = [(0, 0), (10, 60), (26, 60), (36, 0), (46, 0), (49.3, 20), (66, 20), (69.3, 0), (79, 0), (89, -60 * 0.45)]
    profile += [(103, -27), (112, 0), (120, 0), (123.3, 20), (136, 20), (140, 0)]
    return [polyline([(left, base), (left + 148, base)], GREY, 1.0), polyline([(left, base), (left, base - 72)], GREY, 1.0),
            text(left + 5, base - 66, "speed", 11, GREY), text(left + 148, base + 14, "time", 11, GREY, "end"),
            polyline([(left + t, base - v) for t, v in profile], INK, 1.8)]


def reversals(x, y):
    spin, left, right = (x + 42, y - 24), (x - 6, y + 8), (x - 6, y + 60)
    body = [robot(x - 50, y - 24)] + out_and_back(x - 50, y - 24, 50)
    body += [robot(*spin)] + arrow(circle_part(spin, 17, 10, 100)) + arrow(circle_part(spin, 22, 100, 10), GREY)
    body += [robot(x - 6, y + 34)] + arrow(circle_part(left, 26, -64, -15)) + arrow(circle_part(right, 26, 64, 15))
    return body + arrow(circle_part(left, 26, -116, -165), GREY) + arrow(circle_part(right, 26, 116, 165), GREY)


def headings(x, y):
    body = [robot(x, y)]
    for dx, dy in ((1, 0), (0, -1), (-1, 0), (0, 1)):
        start, end = (x + 14 * dx, y + 14 * dy), (x + 56 * dx, y + 56 * dy)
        shift = (4 * dy, 4 * dx)
        body += arrow([(start[0] + shift[0], start[1] + shift[1]), (end[0] + shift[0], end[1] + shift[1])])
        body += arrow([(end[0] - shift[0], end[1] - shift[1]), (start[0] - shift[0], start[1] - shift[1])], GREY)
    return body


def manoeuvres():
    panels = (("straights", straights), ("slow_straights", slow_straights), ("turns", turns), ("arcs", arcs),
              ("accelerations", accelerations), ("reversals", reversals), ("headings", headings))
    body = []
    for k, (name, draw) in enumerate(panels):
        left, top = PANEL_W * (k % 4), PANEL_H * (k // 4)
        body.append(f'<rect x="{left + 3:.0f}" y="{top + 3:.0f}" width="{PANEL_W - 6:.0f}" height="{PANEL_H - 6:.0f}" '
                    'fill="none" stroke="#dddddd"/>')
        body.append(text(left + PANEL_W / 2, top + 22, name, 13, INK, "middle"))
        body += draw(left + PANEL_W / 2, top + 98)
    left, top = PANEL_W * 3 + 14, PANEL_H + 60
    body += arrow([(left, top), (left + 34, top)]) + [text(left + 44, top + 4, "there, or left")]
    body += arrow([(left, top + 24), (left + 34, top + 24)], GREY) + [text(left + 44, top + 28, "back, or right")]
    body.append(text(left, top + 52, "black and blue: two radii"))
    return svg(int(4 * PANEL_W), int(2 * PANEL_H), body)


# --- Two effects that one speed cannot separate ------------------------------------------------------------------

OFFSET, SLIP = 0.010, 0.10  # s; s^2/m: of both a robot is 2 mm off at 0.2 m/s


def look_alikes():
    """What the position by odometry is off by when a speed is reached: offset v, and slip v^2 / 2."""
    width, height, left, bottom, across, up = 620, 330, 64, 270, 520.0, 200.0

    def place(speed, error):
        return left + across * speed / 0.32, bottom - up * error / 5.0

    speeds = [0.32 * k / 60 for k in range(61)]
    body = [text(left, 24, "What a position is off by while the robot speeds up")]
    for error in range(6):
        body += [polyline([place(0, error), place(0.32, error)], "#e4e4e4", 1.0),
                 text(left - 8, place(0, error)[1] + 4, f"{error}", 12, GREY, "end")]
    for speed in (0.0, 0.1, 0.2, 0.3):
        body += [polyline([place(speed, 0), place(speed, 5)], "#e4e4e4", 1.0),
                 text(place(speed, 0)[0], bottom + 18, f"{speed:.1f}", 12, GREY, "middle")]
    body += [text(left + across / 2, bottom + 42, "speed reached, m/s", 12, GREY, "middle"),
             text(18, bottom - up / 2, "mm", 12, GREY)]
    body.append(polyline([place(v, 1e3 * OFFSET * v) for v in speeds], BLUE, 2.2))
    body.append(polyline([place(v, 1e3 * SLIP * v * v / 2) for v in speeds], RED, 2.2))
    x, y = place(0.2, 2.0)
    body += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="7" fill="none" stroke="{INK}" stroke-width="1.6"/>',
             text(x + 14, y + 20, "a drive at one speed sees"),
             text(x + 14, y + 36, "this point: both explain it")]
    body += [text(*place(0.015, 1.35), "late clock: grows with speed", 13, BLUE),
             text(place(0.225, 4.62)[0], place(0.225, 4.62)[1], "acceleration slip: with its square", 13, RED, "end")]
    for v in (0.1, 0.3):
        for error in (1e3 * OFFSET * v, 1e3 * SLIP * v * v / 2):
            body.append(f'<circle cx="{place(v, error)[0]:.1f}" cy="{place(v, error)[1]:.1f}" r="3.5" fill="{INK}"/>')
    return svg(width, height, body)


# --- What two drives cover ---------------------------------------------------------------------------------------

def motion_of(path):
    """Speed in m/s and turn rate in rad/s over half a second each, of poses with time stamps."""
    poses = []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            t, x, y, _, _, _, qz, qw = map(float, line.split())
            poses.append((t, x, y, 2.0 * math.atan2(qz, qw)))
    out, k = [], 0
    for i, (t, x, y, yaw) in enumerate(poses):
        while k < i and t - poses[k][0] > 0.5:
            k += 1
        begin = poses[k]
        if t - begin[0] < 0.45 or i % 10:
            continue
        turn = math.remainder(yaw - begin[3], 2.0 * math.pi)
        middle = begin[3] + turn / 2
        way = (x - begin[1]) * math.cos(middle) + (y - begin[2]) * math.sin(middle)
        out.append((way / (t - begin[0]), turn / (t - begin[0])))
    return out


def coverage(guided, lazy):
    width, height, size, top, speeds, rates = 700, 360, 290.0, 38.0, 0.5, 1.5
    body = []
    for panel, (path, title) in enumerate(((guided, "a guided drive"), (lazy, "laps at one speed"))):
        left = 46 + 340 * panel
        middle_x, middle_y = left + size / 2, top + size / 2

        def place(speed, rate, x=middle_x, y=middle_y):
            return x + size / 2 * speed / speeds, y - size / 2 * rate / rates

        body += [text(middle_x, 22, title, 14, INK, "middle"),
                 f'<rect x="{left}" y="{top}" width="{size}" height="{size}" fill="none" stroke="#bbbbbb"/>',
                 polyline([place(-speeds, 0), place(speeds, 0)], "#bbbbbb", 1.0),
                 polyline([place(0, -rates), place(0, rates)], "#bbbbbb", 1.0)]
        # One dot for all that would lie within the same two pixels.
        dots = sorted({(2 * round(x / 2), 2 * round(y / 2)) for x, y in (place(*p) for p in motion_of(path))})
        body += [f'<circle cx="{x}" cy="{y}" r="2.4" fill="{BLUE}"/>' for x, y in dots]
        body += [text(place(0, 0)[0] + 6, top + 14, "turns on the spot", 11, INK),
                 text(left + size - 4, place(0, 0)[1] - 6, "straight on", 11, INK, "end"),
                 text(left + 4, place(0, 0)[1] - 6, "backward", 11, INK)]
        for speed in (-0.3, 0.3):
            body.append(text(place(speed, 0)[0], top + size + 16, f"{speed:+.1f} m/s", 11, GREY, "middle"))
        for rate in (-0.5, 0.5):
            body.append(text(left - 5, place(0, rate)[1] + 4, f"{rate:+.1f}", 11, GREY, "end"))
        body.append(text(left - 5, place(0, 0)[1] + 4, "rad/s", 11, GREY, "end"))
    return svg(width, height, body)


def main():
    if sys.argv[1:] == ["manoeuvres"]:
        print(manoeuvres())
    elif sys.argv[1:] == ["look-alikes"]:
        print(look_alikes())
    elif len(sys.argv) == 4 and sys.argv[1] == "coverage":
        print(coverage(*sys.argv[2:]))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
