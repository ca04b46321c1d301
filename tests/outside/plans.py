"""Judges GeoJSON, houses of HouseExpo, buildings of Open-RMF and tables of obstacles, by shapely and PyYAML."""

import csv
import itertools
import json
import math

import numpy as np
import shapely
import yaml
from shapely.geometry import LineString, Point, Polygon

import bodies
import shapes

# Corners of the polygon that represents a disc, which lie on its circle.
CORNERS = 64

# Lengths that are the same but for rounding.
EXACT = 1e-9

# The lists of a world's parts in GeoJSON.
PARTS = {
    "wall": "walls",
    "road_strip": "road_strips",
    "room": "rooms",
    "doorway": "doorways",
    "obstacle": "obstacles",
    "surface": "surfaces",
}

# What RMF's tools read of a door and of a lane, and the type of each value.
DOOR = {
    "name": 1,
    "type": 1,
    "motion_axis": 1,
    "motion_degrees": 3,
    "motion_direction": 2,
}
# What ours state, and RMF's tools ignore.
HEIGHT = {"bottom": 3, "top": 3}
LANE = {"bidirectional": 4, "graph_idx": 2, "orientation": 1}
TYPES = {1: str, 2: int, 3: (int, float), 4: bool}

# RMF's walls are this thick.
RMF_WALL = 0.1

# Lanes are at least this far from solids: a robot's radius less the diagonal of a cell.
LANE_ROOM = 0.15


def judge(world, report):
    """Compares each file with the shapes of the JSON file."""
    judge_geojson(world, report)
    judge_house(world, report)
    judge_building(world, report)
    judge_table(world, report)


def differ(found, shape, slack=EXACT):
    """Whether a geometry is another one than a shape."""
    core, radius = shapes.core(shape)
    if radius:
        slack += radius * (1 - math.cos(math.pi / CORNERS))
        return (
            found.centroid.distance(core) > EXACT
            or abs(found.exterior.hausdorff_distance(core) - radius) > slack
        )
    return found.hausdorff_distance(core) > slack


def judge_geojson(world, report):
    """Every feature is valid, and is the part that it is named after."""
    text = world.path("geojson").read_text()
    collection = json.loads(text)
    shapely.from_geojson(text)
    data = world.data
    low, high = data["bounds"]["min"], data["bounds"]["max"]
    if collection["bbox"] != [*low, *high]:
        report.complain(f"GeoJSON has the bbox {collection['bbox']}")
    if collection["provenance"] != data["provenance"]:
        report.complain("GeoJSON has another provenance")
    left = {name: dict(enumerate(data[name])) for name in [*PARTS.values(), "trees"]}
    for feature in collection["features"]:
        geometry = shapely.from_geojson(json.dumps(feature["geometry"]))
        if not geometry.is_valid and feature["properties"]["part"] != "road_strip":
            why = shapely.is_valid_reason(geometry)
            report.complain(f"GeoJSON {feature['id']}: {why}")
        part = feature["properties"]["part"]
        if part in ("start", "goal"):
            pose = data[part]
            if geometry != Point(pose["position"]):
                report.complain(f"GeoJSON has another {part}")
            continue
        if part == "victim":
            continue
        name = "trees" if part == "tree" else PARTS[part]
        original = left[name].pop(int(feature["id"].rsplit(" ", 1)[1]))
        if part == "road_strip":
            points = [point["pose"]["position"] for point in original["centreline"]]
            points += points[:1] if original["closed"] else []
            wrong = geometry != LineString(points)
        else:
            shape = {"disc": original} if part == "tree" else original["shape"]
            wrong = differ(geometry, shape)
        if wrong:
            report.complain(f"GeoJSON {feature['id']} has another shape")
        report.count("features of GeoJSON")
    for name, parts in left.items():
        if parts:
            report.complain(f"GeoJSON lacks {len(parts)} {name}")


def judge_house(world, report):
    """The outline is a valid polygon, holds the start, and no solid lies on its border or ends inside it."""
    house = json.loads(world.path("house.json").read_text())
    outline = Polygon(house["verts"])
    # A region may touch itself at a corner, where the outline does too.
    inner = outline.buffer(-1e-6, join_style="mitre")
    if abs(inner.area - outline.area) > 1e-5 * outline.length + 1e-9:
        report.complain(f"the house is not valid: {shapely.is_valid_reason(outline)}")
    low, high = house["bbox"]["min"], house["bbox"]["max"]
    if outline.bounds != (*low, *high):
        report.complain("the house has another bbox than its outline")
    start = world.data["start"]
    if start and house["start"] != [*start["position"], start["heading"]]:
        report.complain("the house has another start")
    rooms = sum(len(boxes) for boxes in house["room_category"].values())
    if house["room_num"] != rooms or rooms != len(world.data["rooms"]):
        report.complain(f"the house has {rooms} rooms")
    solids = shapes.grown(shapes.solids(world.data), 0, outside=False)
    # A solid is all outside, or free of the outline inside and was left out.
    for i in shapely.STRtree(solids).query(outline.exterior, predicate="intersects"):
        if solids[i].buffer(-1e-6).intersects(outline.exterior):
            report.complain("a solid crosses the outline of the house")
            break
    report.count("corners of houses", len(house["verts"]))


def judge_building(world, report):
    """A building is what RMF's tools read; its doors are the doorways, its lanes are free."""
    building = yaml.safe_load(world.path("building.yaml").read_text())
    if building["coordinate_system"] != "cartesian_meters" or not building["name"]:
        report.complain("the building has no name, or other coordinates")
    parameter = building["parameters"]["provenance"]
    if json.loads(parameter[1]) != world.data["provenance"] or parameter[0] != 1:
        report.complain("the building has another provenance")
    [(_, level)] = building["levels"].items()
    float(level["elevation"])
    points = []
    for vertex in level["vertices"]:
        x, y, z, name, parameters = vertex
        points.append((float(x), float(y)))
        if float(z) != 0 or not isinstance(name, str):
            report.complain(f"the building has a vertex {vertex}")
        typed(parameters, {}, report)
    names = [vertex[3] for vertex in level["vertices"] if vertex[3]]
    if len(names) != len(set(names)):
        report.complain("two vertices of the building have one name")
    for floor in level["floors"]:
        if not Polygon([points[i] for i in floor["vertices"]]).is_valid:
            report.complain("the building's floor is not valid")
    edges = {name: [] for name in ("walls", "doors", "lanes")}
    for name, needed in (("walls", HEIGHT), ("doors", DOOR | HEIGHT), ("lanes", LANE)):
        for start, end, parameters in level[name]:
            typed(parameters, needed, report)
            if start == end:
                report.complain(f"{name} of the building have an edge without length")
                continue
            edges[name].append(LineString([points[start], points[end]]))
    judge_doors(world.data, edges["doors"], report)
    judge_heights(world.data, level, report)
    solids = shapes.grown(shapes.solids(world.data), 0, outside=False)
    near, _ = within(edges["lanes"], solids, LANE_ROOM)
    if near:
        report.complain(f"{near} lanes are less than {LANE_ROOM} m from a solid")
    # Where closed doors are, RMF has doors and no walls.
    outlines = [shapes.core(wall["shape"])[0] for wall in world.data["walls"]]
    near, total = within(outlines, edges["walls"], RMF_WALL / 2 + EXACT)
    if near < total:
        report.complain(f"the building lacks {total - near} walls")
    report.count("edges of buildings", sum(len(lines) for lines in edges.values()))


def within(some, others, distance):
    """How many geometries have another one so near, and how many there are."""
    if len(some) == 0 or len(others) == 0:
        return 0, len(some)
    pairs = shapely.STRtree(others).query(some, "dwithin", distance)
    return len(set(pairs[0])), len(some)


def typed(parameters, needed, report):
    """Values have the type that they state, and those that are needed are there."""
    for name, (kind, value) in parameters.items():
        if not isinstance(value, TYPES[kind]):
            report.complain(f"the building's {name} is {value!r} of type {kind}")
    for name, kind in needed.items():
        if name not in parameters or parameters[name][0] != kind:
            report.complain(f"the building has an edge without {name} of type {kind}")


def judge_doors(data, doors, report):
    """Doors lie along the middle of the doorways, from end to end."""
    if len(doors) != len(data["doorways"]):
        report.complain(
            f"the building has {len(doors)} doors for {len(data['doorways'])} doorways"
        )
    for door, doorway in zip(doors, data["doorways"]):
        opening, _ = shapes.core(doorway["shape"])
        sides = [
            LineString(pair).length
            for pair in zip(opening.exterior.coords, opening.exterior.coords[1:])
        ]
        middle = opening.centroid.distance(door.interpolate(0.5, normalized=True))
        if middle > EXACT or abs(door.length - max(sides)) > EXACT:
            report.complain("a door of the building is not along its doorway")


def judge_heights(data, level, report):
    """Doors are as high as the doorways, and walls as the other solids."""
    stated = lambda edge: tuple(edge[2][end][1] for end in ("bottom", "top"))
    doors = [bodies.ends(doorway, bodies.DOORWAY) for doorway in data["doorways"]]
    if [stated(door) for door in level["doors"]] != doors:
        report.complain("the building's doors are not as high as the doorways")
    solids = (
        [bodies.ends(wall, bodies.WALLS.get(wall["kind"], 2.6)) for wall in data["walls"]]
        + [bodies.ends(tree, bodies.tree_top(tree)) for tree in data["trees"]]
        + [bodies.ends(one, bodies.OBSTACLES[one["kind"]]) for one in data["obstacles"]]
    )
    # A solid has one edge or several, after those of the solid before.
    runs = lambda ends: [pair for pair, _ in itertools.groupby(np.round(list(ends), 9).tolist())]
    if runs(map(stated, level["walls"])) != runs(solids):
        report.complain("the building's walls are not as high as the solids")


def judge_table(world, report):
    """Lines are start and goal and the solids, in order."""
    with world.path("obstacles.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    for name in ("start", "goal"):
        if pose := world.data[name]:
            row = rows.pop(0)
            place = [float(row["x"]), float(row["y"])]
            if (row["part"], place) != (name, pose["position"]):
                report.complain(f"the table has another {name}")
    for i, pose in enumerate(world.data.get("victims", [])):
        row = rows.pop(0)
        place = [float(row["x"]), float(row["y"])]
        if ([row["part"], row["index"]], place) != (["victim", str(i)], pose["position"]):
            report.complain(f"the table has another victim {i}")
    expected = shapes.solids(world.data)
    if len(rows) != len(expected):
        report.complain(f"the table has {len(rows)} solids, not {len(expected)}")
    for row, shape in zip(rows, expected):
        if table_shape(row) != shape:
            report.complain(f"the table has another {row['part']} {row['index']}")
            break
        if not float(row["bottom"]) < float(row["top"]):
            report.complain(f"{row['part']} {row['index']} of the table has no height")
            break
    report.count("lines of tables", len(rows))


def table_shape(row):
    """The shape of a line, as in the JSON file."""
    if row["shape"] in ("segment", "polygon"):
        points = [[float(x) for x in point.split()] for point in row["points"].split(";")]
        if row["shape"] == "segment":
            return {"segment": {"a": points[0], "b": points[1]}}
        return {"polygon": {"vertices": points}}
    center = [float(row["x"]), float(row["y"])]
    if row["shape"] == "disc":
        return {"disc": {"center": center, "radius": float(row["radius"])}}
    half = [float(row["length"]) / 2, float(row["width"]) / 2]
    heading = float(row["heading"])
    return {"box": {"center": center, "half_size": half, "heading": heading}}
