"""Judges maps for ROS: reads them as Nav2's map_server does, and holds them against the shapes."""

import numpy as np
import shapely
import yaml
from PIL import Image
from scipy import ndimage

import curves
import shapes

# Distance from a shape's border, in metres, within which a cell's middle may count either way.
# Roads are drawn to a centimetre; of other shapes only the polygons' circles are not exact.
ROUNDING = 1e-6
EDGE_OF_ROAD = 0.02

# Cells in a square that are free behind a solid part: less is a pocket beside round
# parts, which cells join across a place that is thinner than they are.
LEAK = 5

OCCUPIED, FREE, UNKNOWN = 100, 0, -1


def judge(world, report):
    """Compares each cell with the shapes at its middle."""
    cells, resolution, origin = read(world.path("yaml"))
    low, high = (np.array(world.data["bounds"][side]) for side in ("min", "max"))
    rows, cols = cells.shape
    if not np.allclose(origin, [*low, 0], atol=1e-9):
        report.complain(f"the origin is {origin}, the bounds begin at {low}")
    needed = np.ceil((high - low) / resolution - 1e-9)
    if (cols, rows) != tuple(np.maximum(needed, 1)):
        report.complain(f"{cols} x {rows} cells, not {needed}")
        return
    x = low[0] + (np.arange(cols) + 0.5) * resolution
    y = low[1] + (np.arange(rows) + 0.5) * resolution
    grid = Grid(x, y, resolution)

    occupied = cells == OCCUPIED
    must, may = solid_cells(grid, world.data)
    complain_of(report, must & ~occupied, "cells in a solid part are not occupied")
    complain_of(report, occupied & ~may, "cells are occupied where nothing stands")

    # Free is what the start reaches by the sides of cells; roads and forests end at their borders.
    free = cells == FREE
    inner, outer = (area & ~occupied for area in domain(grid, world))
    start = world.data["start"]
    if start is None:
        reached = inner
    else:
        reached = part_around(grid, inner, free, start["position"])
        parts = ndimage.label(free)[1]
        if parts > 1:
            report.complain(f"the free cells are {parts} parts")
        lost = free & ~grid.within([true_part(world.data)])
        lost = ndimage.binary_erosion(lost, np.ones((LEAK, LEAK)))
        complain_of(report, lost, "cells are free where no way leads from the start")
    complain_of(report, reached & ~free, "cells that the start reaches are not free")
    complain_of(report, free & ~outer, "cells are free outside of the area")
    complain_of(
        report,
        ndimage.binary_dilation(free) & inner & ~free,
        "unknown cells beside free",
    )
    report.count("cells of ROS maps", cells.size)
    report.count("ROS maps with unknown cells", int((cells == UNKNOWN).any()))


def read(path):
    """Cells as in an OccupancyGrid, the lowest row first, with their side and origin.

    As `loadMapFromFile` of nav2_map_server has it in the mode trinary.
    """
    text = yaml.safe_load(path.read_text())
    if text["mode"] != "trinary":
        raise ValueError(f"mode {text['mode']}")
    image = np.asarray(Image.open(path.parent / text["image"]).convert("L"), float)
    shade = image / 255 if text["negate"] else (255 - image) / 255
    cells = np.full(image.shape, UNKNOWN)
    cells[shade < text["free_thresh"]] = FREE
    cells[shade > text["occupied_thresh"]] = OCCUPIED
    return cells[::-1], text["resolution"], text["origin"]


class Grid:
    """The middles of the cells."""

    def __init__(self, x, y, resolution):
        self.x, self.y, self.resolution = x, y, resolution
        self.shape = len(y), len(x)

    def window(self, geometry):
        """The cells whose middles may lie in a geometry, as slices of rows and columns."""
        low_x, low_y, high_x, high_y = geometry.bounds
        rows = np.searchsorted(self.y, [low_y, high_y])
        cols = np.searchsorted(self.x, [low_x, high_x])
        return slice(rows[0], rows[1] + 1), slice(cols[0], cols[1] + 1)

    def within(self, geometries):
        """Which middles lie in one of the geometries."""
        found = np.zeros(self.shape, bool)
        for geometry in geometries:
            if geometry.is_empty:
                continue
            rows, cols = self.window(geometry)
            x, y = np.meshgrid(self.x[cols], self.y[rows])
            if x.size:
                shapely.prepare(geometry)
                found[rows, cols] |= shapely.contains_xy(geometry, x, y)
        return found

    def cell(self, point):
        """Row and column of the cell at a point."""
        return (
            int(
                np.clip(
                    np.floor((point[1] - self.y[0]) / self.resolution + 0.5),
                    0,
                    len(self.y) - 1,
                )
            ),
            int(
                np.clip(
                    np.floor((point[0] - self.x[0]) / self.resolution + 0.5),
                    0,
                    len(self.x) - 1,
                )
            ),
        )


def solid_cells(grid, data):
    """Cells that must be occupied, and those that may: parts thinner than a cell fill all they touch."""
    solids = shapes.solids(data)
    if not solids:
        return np.zeros(grid.shape, bool), np.zeros(grid.shape, bool)
    must = grid.within(shapes.grown(solids, -ROUNDING, False, "mitre"))
    may = grid.within(shapes.grown(solids, ROUNDING, True, "mitre"))
    half = grid.resolution / 2
    for solid in solids:
        if thickness(solid) > grid.resolution:
            continue
        [shape] = shapes.grown([solid], ROUNDING, True, "mitre")
        rows, cols = grid.window(shape.buffer(grid.resolution))
        x, y = np.meshgrid(grid.x[cols], grid.y[rows])
        may[rows, cols] |= shapely.intersects(shape, squares(x, y, half + ROUNDING))
        if "polygon" not in solid:
            sure = shape.buffer(-2 * ROUNDING)
            must[rows, cols] |= shapely.intersects(sure, squares(x, y, half - ROUNDING))
    return must, may


def squares(x, y, half):
    """Squares around points."""
    return shapely.box(x - half, y - half, x + half, y + half)


def thickness(solid):
    """How thin a part is: of a polygon about, and at most, the width of a strip of its outline's length."""
    [(kind, value)] = solid.items()
    if kind == "box":
        return 2 * min(value["half_size"])
    if kind == "disc":
        return 2 * value["radius"]
    shape, _ = shapes.core(solid)
    return 2 * shape.area / shape.length


def domain(grid, world):
    """Cells that are surely part of the area that can be mapped, and those that may be."""
    if world.kind == "road":
        areas = [curves.strip_outline(strip) for strip in world.data["road_strips"]]
        inner = grid.within(area.buffer(-EDGE_OF_ROAD) for area in areas)
        return inner, grid.within(area.buffer(EDGE_OF_ROAD) for area in areas)
    if world.kind == "forest":
        [area] = [
            c["crosses_west_east"]["area"]
            for c in world.data["certificate"]
            if "crosses_west_east" in c
        ]
        area = shapes.rectangle(area)
        return grid.within([area.buffer(-ROUNDING)]), grid.within(
            [area.buffer(ROUNDING)]
        )
    # Of the last row and column the middles may lie beyond the bounds.
    inside = grid.within([shapes.rectangle(world.data["bounds"]).buffer(-ROUNDING)])
    return inside, np.ones(grid.shape, bool)


def part_around(grid, cells, free, point):
    """The part of some cells, joined by sides, around a point or the free cell nearest to it."""
    labels = ndimage.label(cells)[0]
    at = grid.cell(point)
    if not labels[at]:
        distances, nearest = ndimage.distance_transform_edt(
            ~(free & cells), return_indices=True
        )
        at = tuple(nearest[:, at[0], at[1]])
    return labels == labels[at] if labels[at] else np.zeros_like(cells)


def true_part(data):
    """The free space around the start by the shapes alone, whatever the cells' size."""
    bounds = shapes.rectangle(data["bounds"])
    freedom = shapes.Freedom(bounds, shapes.solids(data), ROUNDING, True, "mitre")
    return freedom.around(data["start"]["position"])


def complain_of(report, cells, what):
    """Complains if there are such cells."""
    if cells.any():
        row, col = np.argwhere(cells)[0]
        report.complain(f"{cells.sum()} {what}, the first at row {row}, column {col}")
