"""Judges roads as OpenDRIVE and CSV: by asam-qc-opendrive, netconvert, pyxodr and quadrature."""

import csv
import logging
import os
import re
import subprocess
from xml.etree import ElementTree

import numpy as np
import pyxodr.road_objects.network as pyxodr
import qc_opendrive.main as asam
import shapely
import sumo
from qc_baselib import Configuration, Result, StatusType

import bodies
from curves import Curve, Path

logging.disable(logging.INFO)

# Metres and radians by which two ways to compute the same curve may differ, a kilometre from the axes.
EXACT = 1e-6

# pyxodr joins points by straight lines: 5 cm apart they leave an arc of 1 m radius by 0.3 mm.
PYXODR_STEP, PYXODR_OFF = 0.05, 2e-3

# netconvert takes points of the reference line, and moves lanes beside the straight lines between them, which
# in sharp bends puts the outer of six lanes some centimetres off.
SUMO_STEP, SUMO_OFF = 0.25, 0.1
# Share of a lane's length that its corners may cut.
SUMO_SHORT = 0.01

# A rule about junctions, which these files do not have; it comes with OpenDRIVE 1.8.
SKIPPED = {"check_asam_xodr_junctions_connection_one_link_to_incoming"}

# Warnings of netconvert that say nothing against a file, with the reason.
HARMLESS = [
    # SUMO has no edges from a junction to itself: it cuts circuits into two edges.
    r"^Warning: Edge '-?0' has to be split as it connects same junctions\.$",
]


def judge(world, report):
    """Asks all judges of roads about each road of a world."""
    tree = ElementTree.parse(world.path("xodr"))
    strips = world.data["road_strips"]
    roads = tree.getroot().findall("road")
    if len(roads) != len(strips):
        report.complain(f"{len(roads)} roads in OpenDRIVE, {len(strips)} in the world")
    rows = read_csv(world.path("csv"))
    objects = {}
    for number, (road, strip) in enumerate(zip(roads, strips)):
        path = read_path(road, report)
        judge_csv(strip, path, rows[rows[:, 0] == number], report)
        judge_header(tree.getroot().find("header"), strip, path, report)
        objects |= read_objects(road, path)
    bodies.compare("OpenDRIVE", objects, bodies.expected(world.data), report)
    judge_by_asam(world.path("xodr"), report)
    judge_by_pyxodr(world.path("xodr"), strips, report)
    judge_by_netconvert(world.path("xodr"), strips, report)


def read_path(road, report):
    """The reference line, whose pieces must follow each other without a gap, a kink or a wrong length."""
    curves, s = [], 0.0
    for geometry in road.findall("planView/geometry"):
        number = {name: float(value) for name, value in geometry.attrib.items()}
        [form] = geometry
        first = float(form.get("curvature", form.get("curvStart", 0)))
        last = float(form.get("curvature", form.get("curvEnd", 0)))
        curve = Curve(
            number["x"], number["y"], number["hdg"], number["length"], first, last
        )
        if curves:
            gap = np.abs(curves[-1].points([curves[-1].length])[0] - curve.start).max()
            kink = angle(curves[-1].headings(curves[-1].length) - curve.heading)
            if gap > EXACT or kink > EXACT:
                report.complain(f"a gap of {gap} m and a kink of {kink} rad at {s} m")
        if abs(number["s"] - s) > EXACT:
            report.complain(f"a piece at {number['s']} m begins at {s} m")
        s += curve.length
        curves.append(curve)
    if abs(float(road.get("length")) - s) > EXACT:
        report.complain(f"the length is {s} m, stated {road.get('length')} m")
    return Path(curves)


def read_csv(path):
    """The waypoints, a row each: road, s, x, y, heading, curvature."""
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    if header != ["road", "s", "x", "y", "heading", "curvature"]:
        raise ValueError(f"columns {header}")
    return np.array(rows, float)


def judge_csv(strip, path, rows, report):
    """The waypoints are those of the world, and lie on OpenDRIVE's reference line."""
    points = [
        [*point["pose"]["position"], point["pose"]["heading"], point["curvature"]]
        for point in strip["centreline"]
    ]
    if strip["closed"]:
        points.append(points[0])
    if not np.array_equal(rows[:, 2:], points):
        report.complain("waypoints in CSV and JSON are not the same")
        return
    at, headings = path.at(rows[:, 1])
    off = np.abs(at - rows[:, 2:4]).max()
    turned = angle(headings - rows[:, 4]).max()
    if off > EXACT or turned > EXACT:
        report.complain(
            f"waypoints are {off} m and {turned} rad from the reference line"
        )
    if (
        rows[0, 1] != 0
        or abs(rows[-1, 1] - path.length) > EXACT
        or (np.diff(rows[:, 1]) <= 0).any()
    ):
        report.complain("waypoints do not go from the start to the end")
    report.count("waypoints on the reference line", len(rows))


def judge_header(header, strip, path, report):
    """The header's box holds the road."""
    low = np.array([header.get("west"), header.get("south")], float)
    high = np.array([header.get("east"), header.get("north")], float)
    for offset in (strip["width"] / 2, -strip["width"] / 2):
        points = path.beside(offset, 1.0)
        if (points < low - EXACT).any() or (points > high + EXACT).any():
            report.complain("the road leaves the header's box")


def read_objects(road, path):
    """Kerbs and other solids beside a road: the outline, bottom and top of each, by its name."""
    things = road.findall("objects/object")
    points, headings = path.at([float(thing.get("s")) for thing in things])
    found = {}
    for thing, point, heading in zip(things, points, headings):
        u = np.array([np.cos(heading), np.sin(heading)])
        v = np.array([-u[1], u[0]])
        origin = point + float(thing.get("t")) * v
        if thing.get("radius"):
            shape = shapely.Point(origin).buffer(float(thing.get("radius")), 64)
        else:
            corners = [
                origin + float(corner.get("u")) * u + float(corner.get("v")) * v
                for corner in thing.findall("outlines/outline/cornerLocal")
            ]
            shape = shapely.Polygon(corners)
        bottom = float(thing.get("zOffset"))
        found[thing.get("id")] = shape, bottom, bottom + float(thing.get("height"))
    return found


def judge_by_asam(file, report):
    """Schema, rules and smoothness, as asam-qc-opendrive checks them."""
    config, result = Configuration(), Result()
    config.set_config_param("InputFile", str(file))
    bundle, version = asam.constants.BUNDLE_NAME, asam.constants.BUNDLE_VERSION
    result.register_checker_bundle(name=bundle, description="", version=version)
    asam.run_checks(config, result)
    checkers = result.get_checker_results(bundle)
    for checker in checkers:
        for issue in checker.issues:
            report.complain(
                f"asam-qc-opendrive, {checker.checker_id}: {issue.description}"
            )
        if checker.status == StatusType.COMPLETED:
            report.count("rules of asam-qc-opendrive")
        elif not (
            checker.status == StatusType.SKIPPED and checker.checker_id in SKIPPED
        ):
            report.complain(
                f"asam-qc-opendrive, {checker.checker_id}: {checker.status}"
            )


def judge_by_pyxodr(file, strips, report):
    """Reference line and lane borders as pyxodr draws them lie where the world has them."""
    roads = pyxodr.RoadNetwork(str(file), resolution=PYXODR_STEP).get_roads()
    for road, strip in zip(roads, strips):
        path = Path.of_strip(strip)
        compare_lines(road.reference_line, path, 0, "reference line", report)
        lanes = {lane.id: lane for part in road.lane_sections for lane in part.lanes}
        left = strip["lanes"] // 2
        expected = set(range(left - strip["lanes"], left + 1)) - {0}
        if set(lanes) != expected:
            report.complain(f"lanes {sorted(lanes)}, not {sorted(expected)}")
            continue
        for number, lane in lanes.items():
            what = f"border of lane {number}"
            compare_lines(lane.boundary_line, path, border(strip, number), what, report)
            report.count("lanes by pyxodr")


def border(strip, lane):
    """How far to the left of the centreline a lane's outer border lies."""
    left = strip["lanes"] // 2
    return strip["width"] * (lane + 0.5 * strip["lanes"] - left) / strip["lanes"]


def compare_lines(theirs, path, offset, what, report):
    """Complains where a line that pyxodr has drawn is not beside the path, or ends elsewhere."""
    theirs, ours = theirs[:, :2], path.beside(offset, 0.5)
    away = Line(theirs).distances(ours).max()
    ends = np.hypot(*(theirs[[0, -1]] - ours[[0, -1]]).T).max()
    # The heading at an end is that of the last chord.
    if max(away, ends) > PYXODR_OFF + abs(offset) * path.sharpest * PYXODR_STEP:
        report.complain(f"pyxodr: the {what} is {away} m off, its ends {ends} m")


def judge_by_netconvert(file, strips, report):
    """SUMO imports the road without a complaint, with as many lanes where the world has them."""
    net = file.with_suffix(".net.xml")
    binary = os.path.join(sumo.SUMO_HOME, "bin", "netconvert")
    words = [
        binary,
        "--opendrive-files",
        str(file),
        "--output-file",
        str(net),
        "--precision",
        "4",
    ]
    words += ["--opendrive.curve-resolution", str(SUMO_STEP)]
    environment = os.environ | {"SUMO_HOME": sumo.SUMO_HOME}
    done = subprocess.run(
        words, capture_output=True, text=True, env=environment, timeout=300
    )
    lines = (done.stdout + done.stderr).splitlines()
    for line in lines:
        if line.strip() not in ("", "Success.") and not any(
            re.search(h, line) for h in HARMLESS
        ):
            report.complain(f"netconvert: {line.strip()}")
    if done.returncode:
        report.complain(f"netconvert: exit code {done.returncode}")
        return
    [strip] = strips
    lanes = read_net(net)
    path = Path.of_strip(strip)
    middles = (np.arange(strip["lanes"]) + 0.5) * strip["width"] / strip[
        "lanes"
    ] - strip["width"] / 2
    expected = [Line(path.beside(middle, 0.25)) for middle in middles]
    lengths = np.zeros(len(expected))
    for points in lanes:
        away = [line.distances(points).max() for line in expected]
        lengths[np.argmin(away)] += Line(points).length
        if min(away) > SUMO_OFF:
            report.complain(f"netconvert: a lane is {min(away)} m beside its place")
    for line, length in zip(expected, lengths):
        if abs(length - line.length) > SUMO_SHORT * line.length:
            report.complain(
                f"netconvert: a lane is {length} m long, not {line.length} m"
            )
    report.count("lanes by netconvert", len(expected))


def read_net(file):
    """The lanes of a SUMO network as points in the world's place."""
    root = ElementTree.parse(file).getroot()
    moved = np.array(root.find("location").get("netOffset").split(","), float)
    for edge in root.findall("edge"):
        if edge.get("function") != "internal":
            for lane in edge.findall("lane"):
                points = [point.split(",")[:2] for point in lane.get("shape").split()]
                yield np.array(points, float) - moved


class Line:
    """Points joined by straight lines, of which the nearest is found quickly."""

    def __init__(self, points):
        sides = shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1))
        self.length = shapely.length(sides).sum()
        self.tree = shapely.STRtree(sides)

    def distances(self, points):
        """How far points are from the line."""
        nearest = self.tree.query_nearest(
            shapely.points(points), return_distance=True, all_matches=False
        )
        return nearest[1]


def angle(difference):
    """The size of a difference of headings, whole turns aside."""
    return np.abs((np.asarray(difference) + np.pi) % (2 * np.pi) - np.pi)
