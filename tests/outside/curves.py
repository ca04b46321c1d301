"""Lines, arcs and spirals by quadrature: neither envgen's closed forms nor a judge's."""

import numpy as np
from shapely import union_all
from shapely.geometry import Polygon

# Nodes and weights on [0, 1]; over half a radian the error is below 1e-15 of the length.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2


class Curve:
    """A curve from a pose, whose curvature changes evenly along its length."""

    def __init__(self, x, y, heading, length, start_curvature, end_curvature):
        self.start = np.array([x, y])
        self.heading = heading
        self.length = length
        self.curvatures = start_curvature, end_curvature

    @classmethod
    def of_piece(cls, piece):
        """A piece of a road in a world file."""
        (x, y), heading = piece["start"]["position"], piece["start"]["heading"]
        return cls(
            x,
            y,
            heading,
            piece["length"],
            piece["start_curvature"],
            piece["end_curvature"],
        )

    def headings(self, s):
        """Headings at distances from the start."""
        first, last = self.curvatures
        return self.heading + first * s + (last - first) * s**2 / (2 * self.length)

    def points(self, s):
        """Points at distances from the start, a row each."""
        s = np.asarray(s, float)
        turn = self.length * max(map(abs, self.curvatures))
        panels = int(np.ceil(2 * turn)) + 1
        # Each distance is cut into as many panels.
        at = (np.arange(panels)[:, None] + NODES).ravel() / panels
        weights = np.tile(WEIGHTS, panels) / panels
        headings = self.headings(np.multiply.outer(s, at))
        steps = np.stack([np.cos(headings), np.sin(headings)], axis=-1)
        return self.start + s[:, None] * np.einsum("ijk,j->ik", steps, weights)


class Path:
    """Curves one after another."""

    def __init__(self, curves):
        self.curves = curves
        self.ends = np.cumsum([curve.length for curve in curves])
        self.length = self.ends[-1]
        self.sharpest = max(abs(c) for curve in curves for c in curve.curvatures)

    @classmethod
    def of_strip(cls, strip):
        """The centreline of a road in a world file."""
        return cls([Curve.of_piece(piece) for piece in strip["pieces"]])

    def at(self, s):
        """Points and headings at distances from the start."""
        s = np.asarray(s, float)
        which = np.minimum(
            np.searchsorted(self.ends, s, side="left"), len(self.curves) - 1
        )
        points, headings = np.empty((len(s), 2)), np.empty(len(s))
        for number, curve in enumerate(self.curves):
            here = which == number
            along = s[here] - (self.ends[number] - curve.length)
            points[here], headings[here] = curve.points(along), curve.headings(along)
        return points, headings

    def beside(self, offset, step):
        """Points at a distance to the left of the path, at most a step of the path apart."""
        s = [
            np.linspace(e - c.length, e, int(c.length / step) + 2)
            for e, c in zip(self.ends, self.curves)
        ]
        points, headings = self.at(np.unique(np.concatenate(s)))
        return points + offset * np.stack([-np.sin(headings), np.cos(headings)], axis=1)


def strip_outline(strip, step=0.5):
    """The area of a road, quad by quad, so that roads that cross themselves have one, too."""
    path, half = Path.of_strip(strip), strip["width"] / 2
    left, right = path.beside(half, step), path.beside(-half, step)
    quads = [
        Polygon([left[i], right[i], right[i + 1], left[i + 1]])
        for i in range(len(left) - 1)
    ]
    return union_all(quads)
