"""Judges files for three dimensions: MuJoCo, drake's libsdformat, Khronos' glTF validator and trimesh read them,
and what they read is where the world's parts are."""

import json
import logging
import subprocess
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import shapely
import trimesh
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from shapely.geometry import MultiPoint, Point, Polygon

from shapes import core

# Metres by which a body may be beside its place: numbers in glTF and the corners of MuJoCo's meshes have 32 bits,
# meshes of discs have flat sides within 1 mm.
OFF = 2e-3

# Thickness of what is a line in the world.
LINE = 0.01

# Bottoms and tops in metres of parts that do not state theirs.
WALLS = {"partition": 1.4, "kerb": 0.5}
DOORWAY = 2.1
OBSTACLES = {
    "screen": 0.5,
    "rubble": 0.6,
    "panel": 0.6,
    "desk": 0.75,
    "crate": 0.8,
    "chair": 0.9,
    "counter": 1.1,
    "pipe": 1.2,
    "cabinet": 1.9,
    "boiler": 2.0,
    "statue": 2.0,
    "door_post": 2.1,
    "container": 2.4,
    "stairs": 2.6,
    "other": 1.0,
}

VALIDATE = """
const validator = require("gltf-validator");
const bytes = new Uint8Array(require("fs").readFileSync(process.argv[1]));
validator.validateBytes(bytes).then(report => console.log(JSON.stringify(report.issues)));
"""


def judge(world, report):
    """Reads the files of a world and compares them with its parts."""
    parts = expected(world.data)
    judge_mjcf(world.path("mjcf.xml"), world.data, parts, report)
    judge_sdf(world.path("sdf"), world.data, parts, report)
    judge_glb(world.path("glb"), world.data, parts, report)


def expected(data):
    """The outline, bottom and top of every solid part, by the name that it has in the files."""
    walls = [
        (outline(wall["shape"]), *ends(wall, WALLS.get(wall["kind"], 2.6)))
        for wall in data["walls"]
    ]
    parts = {f"wall_{i}": wall for i, wall in enumerate(walls)}
    tree = shapely.STRtree([wall[0] for wall in walls])
    for i, trunk in enumerate(data["trees"]):
        bottom, top = ends(trunk, tree_top(trunk))
        # A trunk ends in the middle of the crown, which begins at two fifths of the height.
        parts[f"tree_{i}"] = (
            outline({"disc": trunk}),
            bottom,
            bottom + 0.7 * (top - bottom),
        )
    for i, door in enumerate(data["doorways"]):
        opening = outline(door["shape"])
        bottom, top = ends(door, DOORWAY)
        if not door["open"]:
            parts[f"doorway_{i}"] = (opening, bottom, top)
        beside = tree.query(opening, predicate="dwithin", distance=1e-3)
        over = max((walls[wall][2] for wall in beside), default=top)
        if over > top:
            parts[f"doorway_{i}_lintel"] = (opening, top, over)
    for i, obstacle in enumerate(data["obstacles"]):
        shape = outline(obstacle["shape"])
        parts[f"obstacle_{i}"] = (shape, *ends(obstacle, OBSTACLES[obstacle["kind"]]))
    return parts


def outline(shape):
    """A shape as a polygon; round ones with so many sides that they count as round."""
    geometry, radius = core(shape)
    if "segment" in shape:
        return geometry.buffer(LINE / 2, cap_style="flat")
    return geometry.buffer(radius, quad_segs=64) if radius else geometry


def tree_top(tree):
    """The usual top of a tree."""
    return min(2.5 + 10 * tree["radius"], 40)


def ends(part, top):
    """The bottom and top that a part states, or those of its kind."""
    stated = part.get("height") or {}
    return stated.get("bottom", 0.0), stated.get("top", top)


def compare(reader, found, parts, report):
    """The bodies that a reader found, by name, are the parts."""
    if found.keys() != parts.keys():
        other = sorted(found.keys() ^ parts.keys())[:3]
        report.complain(f"{reader}: {len(found)} bodies, not {len(parts)}: {other}")
        return
    for name, (shape, bottom, top) in parts.items():
        seen, *heights = found[name]
        if np.abs(np.subtract(heights, (bottom, top))).max() > OFF:
            report.complain(f"{reader}: {name} is from {heights} m, not {bottom, top}")
        rest = seen.symmetric_difference(shape).area
        # A body beside its place by the tolerance differs by a strip around it.
        if rest > OFF * shape.length:
            report.complain(f"{reader}: {name} differs by {rest} m^2")
    report.count(f"bodies by {reader}", len(parts))


def judge_places(reader, found, data, report):
    """Start, goal and victims are where the world has them; `found` has x, y and heading by name."""
    poses = places_of(data)
    for name in sorted(found.keys() ^ poses.keys()):
        report.complain(f"{reader}: {name} is there, or not, against the world")
    for name in found.keys() & poses.keys():
        place = [*poses[name]["position"], poses[name]["heading"]]
        off = np.subtract(found[name], place)
        off[2] = np.arctan2(np.sin(off[2]), np.cos(off[2]))
        if np.abs(off).max() > OFF:
            report.complain(f"{reader}: {name} is at {found[name]}, not {place}")


def places_of(data):
    """The poses of start, goal and victims, by the names that they have in the files."""
    victims = {f"victim_{i}": pose for i, pose in enumerate(data.get("victims", []))}
    return {name: data[name] for name in ("start", "goal") if data[name]} | victims


def judge_provenance(reader, text, data, report):
    """A file says where its world comes from."""
    if json.loads(text) != data["provenance"]:
        report.complain(f"{reader}: the provenance is another one")


def judge_mjcf(file, data, parts, report):
    """MuJoCo compiles the model without a warning, and has the bodies."""
    model = mujoco.MjModel.from_xml_path(str(file))
    state = mujoco.MjData(model)
    mujoco.mj_forward(model, state)
    warned = sum(warning.number for warning in state.warning)
    if warned:
        report.complain(f"MuJoCo: {warned} warnings")
    pieces = defaultdict(list)
    for geom in range(model.ngeom):
        name = model.geom(geom).name
        if name == "floor" or not model.geom_contype[geom]:
            continue
        turn, at = state.geom_xmat[geom].reshape(3, 3), state.geom_xpos[geom]
        size, kind = model.geom_size[geom], model.geom_type[geom]
        if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            shape = Point(at[:2]).buffer(size[0], quad_segs=64)
            piece = shape, at[2] - size[1], at[2] + size[1]
        else:
            if kind == mujoco.mjtGeom.mjGEOM_BOX:
                signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
                corners = signs * size
            else:
                mesh = model.geom_dataid[geom]
                first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
                corners = model.mesh_vert[first : first + count]
            corners = corners @ turn.T + at
            hull = MultiPoint(corners[:, :2]).convex_hull
            piece = hull, corners[:, 2].min(), corners[:, 2].max()
        pieces[name.partition(".")[0]].append(piece)
    found = {}
    for name, of in pieces.items():
        low, high = min(p[1] for p in of), max(p[2] for p in of)
        # Pieces that only touch after rounding are one outline.
        found[name] = shapely.union_all([p[0] for p in of], grid_size=1e-6), low, high
    compare("MuJoCo", found, parts, report)
    places = {}
    for site in range(model.nsite):
        turn = state.site_xmat[site].reshape(3, 3)
        heading = np.arctan2(turn[1, 0], turn[0, 0])
        places[model.site(site).name] = [*state.site_xpos[site][:2], heading]
    judge_places("MuJoCo", places, data, report)
    text = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXT, "provenance")
    first, size = model.text_adr[text], model.text_size[text]
    content = bytes(model.text_data)[first : first + size].rstrip(b"\0")
    judge_provenance("MuJoCo", content, data, report)


class Said(logging.Handler):
    """What drake logs."""

    def __init__(self):
        super().__init__()
        self.lines = []

    def emit(self, record):
        self.lines.append(record.getMessage())


def judge_sdf(file, data, parts, report):
    """libsdformat takes the world without a warning; its elements are the bodies."""
    said = Said()
    logger = logging.getLogger("drake")
    logger.addHandler(said)
    logger.propagate = False
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(file))
    plant.Finalize()
    logger.removeHandler(said)
    for line in said.lines:
        if not any(text in line for text in HARMLESS):
            report.complain(f"drake: {line}")
    world = ElementTree.parse(file).getroot().find("world")
    found = {}
    for link in world.find("model[@name='parts']").findall("link"):
        collision = link.find("collision")
        if not plant.HasBodyNamed(link.get("name")):
            report.complain(f"drake: there is no {link.get('name')}")
        if collision is None:
            continue
        x, y, z, _, _, heading = numbers(link.find("pose"))
        [form] = collision.find("geometry")
        turn = np.array(
            [[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]]
        )
        if form.tag == "cylinder":
            half = float(form.findtext("length")) / 2
            radius = float(form.findtext("radius"))
            body = Point(x, y).buffer(radius, quad_segs=64), z - half, z + half
        elif form.tag == "box":
            dx, dy, dz = numbers(form.find("size")) / 2
            corners = [(-dx, -dy), (dx, -dy), (dx, dy), (-dx, dy)]
            body = Polygon(corners @ turn.T + (x, y)), z - dz, z + dz
        else:
            corners = np.array([numbers(point) for point in form.findall("point")])
            top = z + float(form.findtext("height"))
            body = Polygon(corners @ turn.T + (x, y)), z, top
        found[link.get("name")] = body
    compare("SDF", found, parts, report)
    frames = {f.get("name"): numbers(f.find("pose"))[[0, 1, 5]] for f in world.findall("frame")}
    judge_places("SDF", frames, data, report)
    tag = "{https://docs.rs/envgen}provenance"
    judge_provenance("SDF", world.findtext(tag), data, report)
    report.count("worlds by drake's libsdformat")


# What drake says that it does not use: Gazebo does, or it is no element of SDFormat.
HARMLESS = [
    "Ignoring unsupported SDFormat element in world: light",
    "Ignoring unsupported SDFormat element in world: envgen:provenance",
    "polyline",
]


def numbers(element):
    """The numbers in an element."""
    return np.array(element.text.split(), float)


def judge_glb(file, data, parts, report):
    """The validator finds nothing; trimesh finds closed meshes, oriented outwards, of the right volume."""
    modules = Path(__file__).parents[2] / "target/outside/node"
    words = ["node", "-e", VALIDATE, str(file.resolve())]
    done = subprocess.run(words, cwd=modules, capture_output=True, text=True, timeout=300)
    if done.returncode:
        report.complain(f"gltf-validator: {done.stderr}")
        return
    issues = json.loads(done.stdout)
    if issues["numErrors"] or issues["numWarnings"]:
        report.complain(f"gltf-validator: {issues['messages'][:3]}")
    described = read_json(file)
    extras = {node["name"]: node.get("extras") for node in described["nodes"]}
    scene = trimesh.load(file, process=False)
    found = {}
    for name in scene.graph.nodes_geometry:
        place, geometry = scene.graph[name]
        mesh = scene.geometry[geometry].copy()
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        if not (mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0):
            report.complain(f"trimesh: {name} is not a closed surface seen from outside")
        if mesh.area_faces.min() <= 0:
            report.complain(f"trimesh: {name} has a degenerate triangle")
        report.count("closed meshes by trimesh")
        solid = name in parts
        if solid != extras[name]["solid"]:
            report.complain(f"glTF: {name} has the extras {extras[name]}")
        if not solid:
            continue
        # From y-up to z-up.
        mesh.apply_transform(place)
        x, y, z = mesh.vertices[:, 0], -mesh.vertices[:, 2], mesh.vertices[:, 1]
        top = mesh.faces[(mesh.face_normals @ [0, 1, 0]) > 0.5]
        faces = shapely.polygons(np.stack([x, y], axis=1)[top])
        found[name] = shapely.union_all(faces, grid_size=1e-6), z.min(), z.max()
        shape, bottom, high = parts[name]
        volume = shape.area * (high - bottom)
        # A disc has flat sides.
        if abs(mesh.volume - volume) > OFF * (shape.length * (high - bottom) + shape.area):
            report.complain(f"trimesh: {name} has {mesh.volume} m^3, not {volume}")
    compare("glTF", found, parts, report)
    places = {}
    for name in scene.graph.nodes:
        if name in ("start", "goal") or name.startswith("victim_"):
            matrix = scene.graph[name][0]
            # The direction of the node's x.
            heading = np.arctan2(-matrix[2, 0], matrix[0, 0])
            places[name] = [matrix[0, 3], -matrix[2, 3], heading]
    judge_places("glTF", places, data, report)
    provenance = described["asset"]["extras"]["provenance"]
    judge_provenance("glTF", json.dumps(provenance), data, report)


def read_json(file):
    """The JSON of a GLB file."""
    content = file.read_bytes()
    length = int.from_bytes(content[12:16], "little")
    return json.loads(content[20 : 20 + length])
