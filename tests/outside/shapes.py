"""The shapes of a world as polygons of shapely, and where a disc can move between them."""

import math

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon, box

# Straight sides to a quarter of a circle. Polygons of shapely have their corners on the circle, so they
# lie inside of it; grown by OUTSIDE they hold it.
QUARTER = 32
OUTSIDE = 1 / math.cos(math.pi / (4 * QUARTER))


def core(shape):
    """A shape as geometry and the radius around it: a disc is its middle, all else has radius 0."""
    [(kind, value)] = shape.items()
    if kind == "disc":
        return Point(value["center"]), value["radius"]
    if kind == "segment":
        return LineString([value["a"], value["b"]]), 0.0
    if kind == "polygon":
        return Polygon(value["vertices"]), 0.0
    (x, y), (dx, dy), heading = value["center"], value["half_size"], value["heading"]
    c, s = math.cos(heading), math.sin(heading)
    corners = [(-dx, -dy), (dx, -dy), (dx, dy), (-dx, dy)]
    return Polygon([(x + c * u - s * v, y + s * u + c * v) for u, v in corners]), 0.0


def solids(data):
    """The shapes of all that stops a robot."""
    shapes = [wall["shape"] for wall in data["walls"]]
    shapes += [{"disc": {key: tree[key] for key in ("center", "radius")}} for tree in data["trees"]]
    shapes += [door["shape"] for door in data["doorways"] if not door["open"]]
    return shapes + [obstacle["shape"] for obstacle in data["obstacles"]]


def grown(shapes, distance, outside, corners="round"):
    """Shapes grown by a distance, as an array of polygons.

    They hold the true shapes if `outside`, else lie inside of them. Corners may be `mitre`, which has few
    vertices, where a distance is so small that it does not matter.
    """
    cores = [core(shape) for shape in shapes]
    radii = np.array([radius for _, radius in cores]) + distance
    return shapely.buffer(
        [geometry for geometry, _ in cores],
        radii * (OUTSIDE if outside else 1),
        quad_segs=QUARTER,
        join_style=corners,
    )


def rectangle(rect):
    """A rectangle of a world file."""
    return box(*rect["min"], *rect["max"])


class Freedom:
    """Where the middle of a disc can be inside an area: for certain, or at best.

    The polygons of round shapes are not exact. With `strict` they hold the true shapes, so a way that is
    found exists; without they lie inside, so a way that is not found does not exist.
    """

    def __init__(self, area, shapes, radius, strict, corners="round"):
        blocked = shapely.union_all(grown(shapes, radius, strict, corners))
        parts = shapely.get_parts(area.difference(blocked))
        self.parts = [part for part in parts if part.area > 0]

    def around(self, point):
        """The part that a disc at a point can reach, or None if it does not fit there."""
        point = Point(point)
        return next((part for part in self.parts if part.distance(point) < 1e-9), None)

    def crosses(self, area):
        """Whether one part reaches from the west side of an area to its east side."""
        low, _, high, _ = area.bounds
        return any(
            part.bounds[0] <= low + 1e-9 and part.bounds[2] >= high - 1e-9
            for part in self.parts
        )
