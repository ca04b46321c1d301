"""Judges landscapes: by rasterio, pylandstats, PIL, and shortest paths of scipy."""

import json
import math

import numpy as np
import pylandstats
import rasterio
from PIL import Image
from scipy import sparse
from scipy.sparse import csgraph

# Share by which two ways to compute a measure may differ.
EXACT = 1e-9

# Tasks of a scenario file that are solved again; each searches the whole map.
TASKS = 20


def judge(world, report):
    """Compares all files of a landscape with its cells, and its measures with pylandstats."""
    raster = world.data["raster"]
    cells = np.array(raster["cells"]).reshape(raster["rows"], raster["cols"])
    judge_grid(world.path("asc"), raster, cells, report)
    with Image.open(world.path("classes.png")) as image:
        if not np.array_equal(np.asarray(image), cells):
            report.complain("the image of the classes has other classes")
    judge_spec(world.data["provenance"]["spec"], cells, report)
    judge_measures(world, raster["cell"], report)
    judge_map(world, raster, cells, report)


def judge_grid(file, raster, cells, report):
    """rasterio reads the ASCII grid with the right place, cell side, classes and no data."""
    with rasterio.open(file) as grid:
        x, y, cell = *raster["origin"], raster["cell"]
        expected = rasterio.Affine(cell, 0, x, 0, -cell, y + raster["rows"] * cell)
        if grid.driver != "AAIGrid" or grid.count != 1 or grid.nodata != 0:
            report.complain(
                f"{grid.driver}, {grid.count} bands, no data is {grid.nodata}"
            )
        if not grid.transform.almost_equals(expected, precision=1e-6 * cell):
            report.complain(f"the place is {grid.transform}, not {expected}")
        if not np.array_equal(grid.read(1), cells):
            report.complain("the ASCII grid has other classes")
    report.count("cells of ASCII grids by rasterio", cells.size)


def judge_spec(spec, cells, report):
    """The classes have the entropy that was asked for, and as many sides as asked lie between them."""
    sides = (cells[1:] != cells[:-1]).sum() + (cells[:, 1:] != cells[:, :-1]).sum()
    if spec["total_edge"] is not None:
        if sides != spec["total_edge"]:
            report.complain(
                f"{sides} sides between classes, {spec['total_edge']} asked"
            )
        report.count("Total Edge as asked")
    # Moving one cell between classes of n and m cells changes the entropy by about ln(n / m) / cells.
    shares = np.unique(cells, return_counts=True)[1] / cells.size
    off = abs(entropy(shares) - spec["entropy"])
    if off > math.log(cells.size) / cells.size:
        report.complain(f"the entropy is {off} beside the one asked")


def entropy(shares):
    """Entropy of shares, in nats."""
    shares = shares[shares > 0]
    return float(-(shares * np.log(shares)).sum())


def judge_measures(world, cell, report):
    """`envgen metrics` and pylandstats measure the ASCII grid alike."""
    ours = json.loads(world.run("metrics", "--json", world.path("asc")))
    file = str(world.path("asc"))
    eight = pylandstats.Landscape(file, neighborhood_rule="8")
    four = pylandstats.Landscape(file, neighborhood_rule="4")
    with rasterio.open(file) as grid:
        cells = grid.read(1)
    # In cells: of areas in square metres the last digit is lost, and 57 x 58 cells are taken for more.
    unit = pylandstats.Landscape(cells, res=(1, 1), nodata=0)

    for name, expected in fragstats(cells).items():
        if expected is None and ours[name] is not None:
            report.complain(f"{name} is {ours[name]} of one or two classes")
        elif expected is not None:
            compare(report, name, ours[name], expected)
    for name, expected in (
        ("total_edge_m", eight.total_edge()),
        ("edge_density_m_per_ha", eight.edge_density()),
        ("lsi", unit.landscape_shape_index()),
        ("joint_entropy_bits", eight.joint_entropy()),
        ("conditional_entropy_bits", eight.conditional_entropy()),
        ("mutual_information_bits", eight.mutual_information()),
    ):
        compare(report, name, ours[name], expected)
    for name, landscape in (("patches_8", eight), ("patches_4", four)):
        patches = ours[name]
        compare(
            report, f"{name} count", patches["count"], landscape.number_of_patches()
        )
        compare(
            report,
            f"{name} density",
            patches["density_per_100ha"],
            landscape.patch_density(),
        )
        compare(
            report,
            f"{name} largest",
            patches["largest_percent"],
            landscape.largest_patch_index(),
        )
        compare(
            report,
            f"{name} area",
            patches["mean_area_m2"],
            landscape.area_mn(hectares=False),
        )
        compare(
            report,
            f"{name} mesh",
            patches["mesh_m2"],
            landscape.effective_mesh_size(hectares=False),
        )
    for kind in ours["by_class"]:
        number = kind["class"]
        compare(
            report,
            "class area",
            kind["area_m2"],
            eight.total_area(class_val=number, hectares=False),
        )
        compare(
            report,
            "class edge",
            kind["total_edge_m"],
            eight.total_edge(class_val=number),
        )
        for name, landscape in (("patches_8", eight), ("patches_4", four)):
            patches = landscape.number_of_patches(class_val=number)
            compare(report, f"class {name}", kind[name]["count"], patches)


def fragstats(cells):
    """What pylandstats lacks, or calls by the same name: the formulas of FRAGSTATS 4.

    Its Shannon's diversity index is the entropy of the adjacency table's margin, and its contagion
    takes the classes' shares from that table, too.
    """
    classes, numbers = np.unique(cells, return_inverse=True)
    numbers = numbers.reshape(cells.shape)
    several = len(classes)
    shares = np.bincount(numbers.ravel()) / cells.size
    sides = np.zeros((several, several))
    for one, other in ((numbers[1:], numbers[:-1]), (numbers[:, 1:], numbers[:, :-1])):
        np.add.at(sides, (one.ravel(), other.ravel()), 1)
    sides += sides.T
    beside = shares[:, None] * sides / sides.sum(axis=1, keepdims=True)
    edges = sides[np.triu_indices(several, 1)]
    return {
        "shdi": entropy(shares),
        "sidi": 1 - (shares**2).sum(),
        "shei": entropy(shares) / math.log(several) if several > 1 else None,
        "contag_percent": (
            100 - 50 * entropy(beside) / math.log(several) if several > 1 else None
        ),
        "iji_percent": (
            100 * entropy(edges / edges.sum()) / math.log(len(edges))
            if several > 2
            else None
        ),
    }


def compare(report, name, ours, theirs):
    """Complains of a measure that differs."""
    if ours is None or not math.isclose(ours, theirs, rel_tol=EXACT, abs_tol=EXACT):
        report.complain(f"{name} is {ours}, not {theirs}")
    report.count("measures by pylandstats and numpy")


def judge_map(world, raster, cells, report):
    """The MovingAI map is passable where the classes are, and its tasks have the lengths stated."""
    kind, height, width, word, *rows = world.path("map").read_text().splitlines()
    sizes = [f"height {raster['rows']}", f"width {raster['cols']}"]
    if (kind, word) != ("type octile", "map") or [height, width] != sizes:
        report.complain(f"the map begins with {kind}, {height}, {width}, {word}")
        return
    speeds = np.array(raster.get("speeds") or np.ones(cells.max() + 1))[cells]
    expected = np.where(speeds == 0, "@", np.where(speeds < 1, "S", "."))
    if rows != ["".join(row) for row in expected]:
        report.complain("the map is not what the classes' speeds are")
        return
    tasks = [
        line.split("\t") for line in world.path("scen").read_text().splitlines()[1:]
    ]
    roads = octile(speeds > 0)
    for task in tasks[:: max(1, len(tasks) // TASKS)]:
        x, y, to_x, to_y = map(int, task[4:8])
        start, goal = y * raster["cols"] + x, to_y * raster["cols"] + to_x
        length = csgraph.dijkstra(roads, indices=start)[goal]
        # Scenario files have eight decimals.
        if not abs(length - float(task[8])) < 1e-6:
            report.complain(f"a task of {task[8]} cells takes {length}")
        report.count("tasks of scenarios by scipy")


def octile(passable):
    """Steps between passable cells: sides of length 1, diagonals that cut no corner."""
    numbers = np.arange(passable.size).reshape(passable.shape)
    steps = []
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        rows, cols = passable.shape
        here = np.s_[: rows - dy, max(0, -dx) : cols - max(0, dx)]
        there = np.s_[dy:, max(0, dx) : cols - max(0, -dx)]
        ok = passable[here] & passable[there]
        if dy and dx:
            ok &= passable[: rows - dy, there[1]] & passable[dy:, here[1]]
        steps.append((numbers[here][ok], numbers[there][ok], np.hypot(dy, dx)))
    starts = np.concatenate([start for start, _, _ in steps])
    ends = np.concatenate([end for _, end, _ in steps])
    lengths = np.concatenate(
        [np.full(len(start), length) for start, _, length in steps]
    )
    graph = sparse.csr_matrix((lengths, (starts, ends)), shape=(passable.size,) * 2)
    return graph + graph.T
