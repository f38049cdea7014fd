#!/usr/bin/env python3
"""Draws where a robot was, and where its odometry said it was, as SVG on standard output.

usage: draw_paths.py TRUE.tum NOMINAL.tum CALIBRATED.tum
Each path is moved so that it begins where the true one begins (position and heading).
"""
import bisect
import math
import sys

SIZE, MARGIN, TOP = 560.0, 24.0, 64.0  # pixels
STYLES = (("#d62728", "odometry, nominal values"), ("#1f77b4", "odometry, calibrated"), ("#111111", "where it was"))


def read(path):
    """@return list of (t, x, y, yaw)"""
    poses = []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            t, x, y, _, _, _, qz, qw = map(float, line.split())
            poses.append((t, x, y, 2.0 * math.atan2(qz, qw)))
    return poses


def begin_at(path, start):
    """The path turned and moved so that it begins at `start`."""
    _, x0, y0, yaw0 = path[0]
    turn = start[3] - yaw0
    c, s = math.cos(turn), math.sin(turn)
    return [(t, start[1] + c * (x - x0) - s * (y - y0), start[2] + s * (x - x0) + c * (y - y0), yaw + turn)
            for t, x, y, yaw in path]


def end_error(path, truth):
    """@return distance in m and angle in degrees between the ends of two paths"""
    end = path[-1]
    true = truth[min(bisect.bisect_left([p[0] for p in truth], end[0]), len(truth) - 1)]
    angle = math.remainder(end[3] - true[3], 2.0 * math.pi)
    return math.hypot(end[1] - true[1], end[2] - true[2]), math.degrees(abs(angle))


def main():
    truth, nominal, calibrated = (read(path) for path in sys.argv[1:4])
    paths = [begin_at(nominal, truth[0]), begin_at(calibrated, truth[0]), truth]
    left, right = min(p[1] for path in paths for p in path), max(p[1] for path in paths for p in path)
    low, high = min(p[2] for path in paths for p in path), max(p[2] for path in paths for p in path)
    scale = (SIZE - 2 * MARGIN) / (right - left)
    height = TOP + MARGIN + scale * (high - low)

    def place(p):
        return f"{MARGIN + scale * (p[1] - left):.1f},{TOP + scale * (high - p[2]):.1f}"

    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIZE:.0f} {height:.0f}" font-family="sans-serif" '
          f'font-size="13"><rect width="100%" height="100%" fill="#ffffff"/>')
    for (colour, label), path, row in zip(STYLES, paths, range(3)):
        if path is not truth:
            distance, angle = end_error(path, truth)
            label += f": {1000 * distance:.0f} mm and {angle:.1f}° off after {path[-1][0] - path[0][0]:.0f} s"
        style = 'stroke-width="1.2" stroke-dasharray="1 4" stroke-linecap="round"' if path is truth else 'stroke-width="1.4"'
        points = " ".join(place(p) for p in path[::5])
        print(f'<polyline fill="none" stroke="{colour}" {style} points="{points}"/>')
        x, y = place(path[-1]).split(",")
        print(f'<circle cx="{x}" cy="{y}" r="{3 if path is truth else 5}" fill="{colour}"/>')
        y = 18 + 17 * row
        print(f'<path d="M{MARGIN:.0f} {y - 4}h24" stroke="{colour}" stroke-width="2.5"/>'
              f'<text x="{MARGIN + 32:.0f}" y="{y}" fill="#111111">{label}</text>')
    x, y = place(truth[0]).split(",")
    print(f'<circle cx="{x}" cy="{y}" r="5" fill="none" stroke="#111111"/>')
    bar = MARGIN + 0.5 * scale
    print(f'<path d="M{MARGIN:.0f} {height - 8:.0f}H{bar:.1f}" stroke="#111111" stroke-width="2"/>'
          f'<text x="{bar + 6:.1f}" y="{height - 4:.0f}">0.5 m</text></svg>')


if __name__ == "__main__":
    main()
