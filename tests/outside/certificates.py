"""Judges what a world promises, by shapely and scipy, on the shapes of the JSON file alone."""

import math

import numpy as np
import shapely
from scipy.spatial import cKDTree

import shapes
import worlds
from curves import strip_outline
from shapes import Freedom

# Distance by which a disc must have room to spare for a place of a floor to count.
PLACE_MARGIN = 0.0625

# Height of doorways that state none.
DOORWAY_TOP = 2.1


def judge(world, report):
    """Judges bounds, shapes and each claim of the certificate, and that `envgen check` agrees."""
    data = world.data
    judge_shapes(data, report)
    for claim in data["certificate"]:
        [(name, promise)] = claim.items()
        CLAIMS[name](data, promise, report)
    try:
        world.run("check", world.path("json"))
    except worlds.Refusal as error:
        report.complain(f"envgen check: {error}")


def judge_shapes(data, report):
    """All shapes are simple polygons within the bounds, and so are start and goal."""
    floors = [
        part["shape"] for key in ("rooms", "surfaces", "doorways") for part in data[key]
    ]
    everything = shapes.solids(data) + floors
    for shape in everything:
        polygon, _ = shapes.core(shape)
        if not polygon.is_valid:
            report.complain(f"a shape is not valid: {shapely.is_valid_reason(polygon)}")
    everything = [*shapes.grown(everything, 0, outside=False)]
    everything += [strip_outline(strip) for strip in data["road_strips"]]
    bounds = shapes.rectangle(data["bounds"])
    # Circles and offset curves are polygons here, whose rounding is under a micrometre.
    around = bounds.buffer(1e-6, join_style="mitre")
    outside = sum(not around.covers(shape) for shape in everything)
    if outside:
        report.complain(f"{outside} shapes reach out of the bounds")
    for name in ("start", "goal"):
        if data[name] and not around.covers(shapely.Point(data[name]["position"])):
            report.complain(f"the {name} lies outside of the bounds")


def connected(data, promise, report):
    """A disc fits at the start and the goal, and can move between them."""
    ends = [data["start"]["position"], data["goal"]["position"]]
    decide(
        report,
        "connected",
        lambda strict: joined(data, promise["radius"], ends, strict),
    )


def joined(data, radius, ends, strict):
    """Whether a disc can move between two points."""
    area = shapes.rectangle(data["bounds"])
    freedom = Freedom(area, shapes.solids(data), radius, strict)
    start, goal = map(freedom.around, ends)
    return start is not None and start is goal


def crosses_west_east(data, promise, report):
    """A disc can cross an area from west to east, or cannot, as it is claimed."""
    area = shapes.rectangle(promise["area"])

    def holds(strict):
        # That no way exists is certain where none is found at best.
        strict = strict == promise["crosses"]
        freedom = Freedom(area, shapes.solids(data), promise["radius"], strict)
        return freedom.crosses(area) == promise["crosses"]

    decide(report, "crosses" if promise["crosses"] else "does not cross", holds)


def every_place_reachable(data, promise, report):
    """The start's disc reaches every place on a floor where it has a margin, and every room."""
    radius = promise["radius"]
    water = [part["shape"] for part in data["surfaces"] if part["speed"] == 0]
    floors = [room["shape"] for room in data["rooms"]]
    halls = [
        part for part in data["surfaces"] if part["kind"] in ("hallway", "open_area")
    ]
    barriers = shapes.solids(data) + water
    bounds = shapes.rectangle(data["bounds"])
    inner = bounds.buffer(-PLACE_MARGIN, join_style="mitre")
    rooms = shapes.grown(floors, 0, outside=False)
    floors = shapes.grown(floors + [part["shape"] for part in halls], 0, outside=False)

    def holds(strict):
        reached = Freedom(bounds, barriers, radius, strict).around(
            data["start"]["position"]
        )
        if reached is None:
            return False
        # A place that is there for certain must be reached at best, and the other way round.
        roomy = Freedom(inner, barriers, radius + PLACE_MARGIN, not strict).parts
        lost = [part for part in roomy if not part.intersects(reached)]
        touching = any(
            shapely.intersection(part, floor).area > 1e-6
            for part in lost
            for floor in floors
        )
        return not touching and all(room.intersects(reached) for room in rooms)

    decide(report, "every place reachable", holds)


def decide(report, name, holds):
    """Complains of what is wrong at best, and counts what is right for certain."""
    if not holds(strict=False):
        report.complain(f"broken: {name}")
    elif holds(strict=True):
        report.count(f"{name}: proved")
    else:
        report.count(f"{name}: too close for polygons")


def added_doorway(data, promise, report):
    """The doorway that was added is there and open."""
    number = promise["doorway"]
    if not (number < len(data["doorways"]) and data["doorways"][number]["open"]):
        report.complain(f"broken: doorway {number} was added")
    report.count("added doorway: proved")


def headroom(data, promise, report):
    """No doorway is lower than the height, where the wall over it is higher."""
    for doorway in data["doorways"]:
        top = (doorway.get("height") or {}).get("top", DOORWAY_TOP)
        if top < promise["height"]:
            report.complain(f"broken: a doorway is {top} m high")
    report.count("headroom: proved")


def tree_distance(data, promise, report):
    """No two trees are nearer than a distance, across the sides of a torus neither."""
    distance, torus = promise["distance"], promise["torus"]
    centers = np.array([tree["center"] for tree in data["trees"]]).reshape(-1, 2)
    if torus:
        centers = np.mod(centers, torus)
    pairs = (
        cKDTree(centers, boxsize=torus).query_pairs(distance * (1 - 1e-12))
        if len(centers)
        else ()
    )
    if pairs:
        report.complain(
            f"broken: {len(pairs)} pairs of trees are nearer than {distance} m"
        )
    report.count("tree distance: proved")


def bend_radius(data, promise, report):
    """Between waypoints the road turns no more than a circle of the radius does over the same chord."""
    for strip in data["road_strips"]:
        poses = [point["pose"] for point in strip["centreline"]]
        chords = np.hypot(*np.diff([pose["position"] for pose in poses], axis=0).T)
        turns = np.diff([pose["heading"] for pose in poses])
        turns = np.abs((turns + math.pi) % (2 * math.pi) - math.pi)
        tight = 2 * promise["radius"] * np.sin(turns / 2) > chords + 1e-6
        stated = [abs(point["curvature"]) for point in strip["centreline"]]
        if tight.any() or max(stated) * promise["radius"] > 1 + 1e-9:
            report.complain(f"broken: no bend is tighter than {promise['radius']} m")
    report.count("bend radius: proved")


CLAIMS = {
    "connected": connected,
    "crosses_west_east": crosses_west_east,
    "every_place_reachable": every_place_reachable,
    "added_doorway": added_doorway,
    "headroom": headroom,
    "tree_distance": tree_distance,
    "bend_radius": bend_radius,
}
