#!/usr/bin/env python3
"""Shows that each judge notices what it is for: worlds are broken in one place, and it must complain."""

import argparse
import json
import re
import shutil
import sys
import tempfile
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

import bodies
import certificates
import judge
import landscapes
import pictures
import plans
import roads
import ros_maps
import stages
import worlds

HALLWAY = {"segments": 6, "start": 3, "p_st": 0.2}
FOREST = {"width": 20, "height": 20, "min_distance": 2.5, "border": "torus"}
ROAD = {"length": 200, "lanes": 3, "width": 9, "transition": 0.2, "speed": 8}
INDOOR = {"width": 6, "height": 6, "doorway_probability": 0.1}
LANDSCAPE = {
    "rows": 20,
    "cols": 30,
    "classes": 4,
    "entropy": 1.2,
    "algorithm": "mixed",
    "total_edge": 300,
    "speeds": "0,0.5,1,1",
}


def change(ending, pattern, by, count=1):
    """Replaces what a pattern finds in a file; `by` is a text, or a function of the match."""

    def act(world):
        path = world.path(ending)
        text, found = re.subn(pattern, by, path.read_text(), count=count)
        assert found, f"{pattern} is not in {path}"
        path.write_text(text)

    return act


def add(number):
    """Adds to the number that a match has between its groups 1 and 2."""
    return lambda match: f"{match[1]}{float(match[2]) + number!r}"


def edit(act):
    """Changes the content of the JSON file."""

    def act_on(world):
        act(world.data)
        world.path("json").write_text(json.dumps(world.data))

    return act_on


def claim(data, name):
    """The first claim of a name."""
    return next(claim[name] for claim in data["certificate"] if name in claim)


def crate(gap):
    """Leaves a gap in the corridor before the start, which leads up, so much wider than the robot."""

    def act(data):
        x, y = data["start"]["position"]
        free = 2 * (claim(data, "connected")["radius"] + gap)
        low, high = x - 1, x + 1 - free
        shape = {
            "center": [(low + high) / 2, y + 1.5],
            "half_size": [(high - low) / 2, 0.1],
        }
        box = {"box": shape | {"heading": 0.0}}
        data["obstacles"].append({"kind": "crate", "shape": box})

    return edit(act)


def move_tree(data):
    """Puts a tree beside another one, across the torus's side."""
    data["trees"][0]["center"] = [0.5, 10.0]
    data["trees"][1]["center"] = [19.5, 10.0]


def close_rooms(data):
    """Closes the doors of all rooms."""
    for doorway in data["doorways"]:
        doorway["open"] = False


def close_added(data):
    """Closes the doorway that the certificate says was added."""
    data["doorways"][claim(data, "added_doorway")["doorway"]]["open"] = False


def tighten(data):
    """Claims a little more of the bends."""
    claim(data, "bend_radius")["radius"] *= 1.01


def lie(name, value):
    """Has `envgen metrics` say something else."""

    class Liar(worlds.World):
        def run(self, *arguments):
            measures = json.loads(super().run(*arguments))
            inner = measures
            *groups, last = name.split(".")
            for group in groups:
                inner = inner[group]
            inner[last] = value(inner[last])
            return json.dumps(measures)

    return lambda world: Liar(
        world.kind, world.stem, world.settings, world.data, world.envgen
    )


def paint(ending, choose, grey):
    """Gives the first pixel that is chosen another grey."""

    def act(world):
        path = world.path(ending)
        with Image.open(path) as image:
            pixels = np.array(image)
        row, col = np.argwhere(choose(pixels))[0][:2]
        pixels[row, col] = grey
        Image.fromarray(pixels).save(path)

    return act


def leak(world):
    """Makes all free outside of a corridor, and a hole in its walls."""
    path = world.path("pgm")
    with Image.open(path) as image:
        pixels = np.array(image)
    pixels[pixels == 205] = 254
    pixels[len(pixels) // 2] = 254
    Image.fromarray(pixels).save(path)


def turn_inside_out(world):
    """Swaps two corners of the first triangle of the last mesh in a GLB file."""
    path = world.path("glb")
    content = bytearray(path.read_bytes())
    length = int.from_bytes(content[12:16], "little")
    described = json.loads(content[20 : 20 + length])
    accessor = described["accessors"][-1]
    view = described["bufferViews"][accessor["bufferView"]]
    at = 28 + length + view["byteOffset"] + accessor["byteOffset"]
    content[at : at + 8] = content[at + 4 : at + 8] + content[at : at + 4]
    path.write_bytes(content)


def truncate(world):
    """Cuts a GLB file short."""
    path = world.path("glb")
    path.write_bytes(path.read_bytes()[:-8])


def beside_free(pixels):
    """Unknown cells beside free ones, and not below them."""
    return (pixels == 205) & (np.roll(pixels, 1, axis=1) == 254)


def blot(world):
    """Paints over a hundredth of a picture."""
    with Image.open(world.path("png")) as image:
        picture = image.convert("RGB")
    width, height = picture.size
    picture.paste("black", (0, 0, width // 10, height // 10))
    picture.save(world.path("png"))


# The judge, the world, what is done to it, and what the judge must say. None: only envgen itself notices
# that the world is not what its seed makes.
CASES = [
    (certificates, "hallway", HALLWAY, crate(-0.001), "broken: connected"),
    (certificates, "hallway", HALLWAY, crate(0.001), None),
    (
        certificates,
        "hallway",
        HALLWAY,
        edit(lambda d: d["goal"].update(position=[99, 99])),
        "goal lies",
    ),
    (
        certificates,
        "hallway",
        HALLWAY,
        edit(lambda d: d["bounds"].update(max=[1, 1])),
        "out of the bounds",
    ),
    (
        certificates,
        "hallway",
        HALLWAY,
        change("json", r'"seed":\s*5', '"seed":6'),
        "envgen check",
    ),
    (
        certificates,
        "forest",
        FOREST,
        edit(lambda d: claim(d, "crosses_west_east").update(crosses=False)),
        "broken: does not cross",
    ),
    (
        certificates,
        "forest",
        FOREST,
        edit(lambda d: claim(d, "crosses_west_east").update(radius=5)),
        "broken: crosses",
    ),
    (certificates, "forest", FOREST, edit(move_tree), "pairs of trees"),
    (certificates, "indoor", INDOOR, edit(close_rooms), "broken: every place"),
    (certificates, "indoor", INDOOR, edit(close_added), "was added"),
    (
        certificates,
        "indoor",
        INDOOR,
        edit(lambda d: d["certificate"].append({"headroom": {"height": 2.2}})),
        "a doorway is 2.1 m high",
    ),
    (certificates, "road", ROAD, edit(tighten), "no bend is tighter"),
    (
        certificates,
        "road",
        ROAD,
        edit(
            lambda d: d["walls"][0]["shape"]["polygon"]["vertices"].insert(0, [0, 999])
        ),
        "not valid",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(s="[1-9][^"]*" x=")([^"]+)', add(0.02)),
        "horizontal_gaps",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(s="[1-9][^"]*" x=")([^"]+)', add(1e-5)),
        "a gap of",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(s="[1-9].*hdg=")([^"]+)', add(1e-5)),
        "a kink of",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(<road .*length=")([^"]+)', add(1e-5)),
        "the length is",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'( s=")([1-9][^"]*)', add(1e-5)),
        "begins at",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(north=")([^"]+)', add(-0.5)),
        "header's box",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r"<laneOffset[^>]*>", ""),
        "pyxodr: the border of lane",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r"<laneOffset[^>]*>", ""),
        "netconvert: a lane is",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(<width .* a=")([^"]+)', add(0.01), 9),
        "border of lane",
    ),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(<width .* a=")([^"]+)', add(0.15), 9),
        "netconvert: a lane is",
    ),
    (roads, "road", ROAD, change("xodr", r'( u=")([^"]+)', add(1)), "wall_0 differs"),
    (
        roads,
        "road",
        ROAD,
        change("xodr", r'(zOffset=")([^"]+)', add(0.01)),
        "OpenDRIVE: wall_0 is from",
    ),
    (roads, "road", ROAD, change("xodr", 'rule="RHT"', 'rule="XYZ"'), "valid_schema"),
    (roads, "road", ROAD, change("xodr", "(?s)<lanes>.*</lanes>", ""), "valid_schema"),
    (
        roads,
        "road",
        ROAD,
        change("xodr", 'type="driving"', 'type="none"', 9),
        "netconvert:",
    ),
    (roads, "road", ROAD, change("xodr", "</OpenDRIVE>", ""), "Error"),
    (
        roads,
        "road",
        ROAD,
        change("csv", r"(\n0,10.0,)([^,]+)", add(1e-9)),
        "CSV and JSON",
    ),
    (
        roads,
        "road",
        ROAD,
        change("csv", r"(\n0,)(10.0)", add(1e-4)),
        "from the reference line",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("geojson", r"(\[\[\[[-0-9.]+,[-0-9.]+\],\[)([-0-9.]+)", add(1e-6)),
        "has another shape",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("geojson", '"part":"room"', '"part":"surface"'),
        "GeoJSON",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("house.json", r'("verts":\[\[)([-0-9.]+)', add(1.5)),
        "house",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("building.yaml", r"motion_degrees: \[3, 90\], ", ""),
        "without motion_degrees",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("building.yaml", r"(top: \[3, )(2.6)", add(0.1)),
        "walls are not as high",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("building.yaml", r"(top: \[3, )(2.1)", add(0.1)),
        "doors are not as high",
    ),
    (
        plans,
        "indoor",
        INDOOR,
        change("building.yaml", r"(doors:\n +- \[)([0-9]+)", r"\g<1>0"),
        "not along its doorway",
    ),
    (
        plans,
        "forest",
        FOREST,
        change("obstacles.csv", r"(tree,0,,disc,)([-0-9.]+)", add(1e-9)),
        "another tree 0",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        change("asc", "cellsize 1", "cellsize 1.001"),
        "the place is",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        change("asc", "xllcorner 0", "xllcorner 1"),
        "the place is",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        change("asc", "value 0", "value 9"),
        "no data is",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        change("asc", r"(\n[1-4] )[12]( )", r"\1 3\2"),
        "other classes",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        paint("classes.png", lambda p: p == 1, 2),
        "the image of the classes",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        edit(lambda d: d["provenance"]["spec"].update(total_edge=301)),
        "301 asked",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        edit(lambda d: d["provenance"]["spec"].update(entropy=1.25)),
        "beside the one asked",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        change("map", r"(\n[.@S]*)\.", r"\1@"),
        "what the classes' speeds",
    ),
    (
        landscapes,
        "landscape",
        LANDSCAPE,
        change("scen", r"(\d\t)(\d+\.\d+)\n", "\\g<1>0.5\n"),
        "a task of",
    ),
    *(
        (
            landscapes,
            "landscape",
            LANDSCAPE,
            lie(name, lambda value: value * 1.001),
            f"{said} is",
        )
        for name, said in [
            ("shdi", "shdi"),
            ("total_edge_m", "total_edge_m"),
            ("joint_entropy_bits", "joint_entropy_bits"),
            ("contag_percent", "contag_percent"),
            ("iji_percent", "iji_percent"),
            ("patches_8.count", "patches_8 count"),
            ("patches_4.mesh_m2", "patches_4 mesh"),
        ]
    ),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        paint("pgm", lambda p: p == 0, 254),
        "are not occupied",
    ),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        paint("pgm", lambda p: p == 254, 0),
        "where nothing stands",
    ),
    (ros_maps, "hallway", HALLWAY, paint("pgm", lambda p: p == 205, 254), "2 parts"),
    (ros_maps, "hallway", HALLWAY, leak, "where no way leads"),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        paint("pgm", lambda p: p == 254, 205),
        "reaches are not free",
    ),
    (ros_maps, "forest", FOREST, paint("pgm", beside_free, 254), "outside of the area"),
    (ros_maps, "road", ROAD, paint("pgm", beside_free, 254), "outside of the area"),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        change("yaml", r"(origin: \[)([^,]+)", add(0.01)),
        "the origin is",
    ),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        change("yaml", r"(resolution: )(.*)", add(0.001)),
        "cells, not",
    ),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        change("yaml", "negate: 0", "negate: 1"),
        "are not occupied",
    ),
    (
        ros_maps,
        "hallway",
        HALLWAY,
        change("yaml", "free_thresh: .*", "free_thresh: 0.25"),
        "2 parts",
    ),
    (pictures, "indoor", INDOOR, blot, "pictures differ"),
    (
        pictures,
        "indoor",
        INDOOR,
        change("svg", r"<path [^>]*>", "", 40),
        "pictures differ",
    ),
    (
        pictures,
        "indoor",
        INDOOR,
        change("svg", r'( width=")([^"]+)', add(10)),
        "px, not",
    ),
    (pictures, "indoor", INDOOR, change("svg", "</svg>", ""), "Error"),
    (
        bodies,
        "indoor",
        INDOOR,
        edit(lambda d: d["walls"][0].update(height={"bottom": 0.0, "top": 2.61})),
        "wall_0 is from",
    ),
    (bodies, "indoor", INDOOR, edit(lambda d: d["walls"].pop()), "bodies, not"),
    (
        bodies,
        "indoor",
        INDOOR,
        edit(lambda d: d["start"]["position"].reverse()),
        "start is at",
    ),
    (
        bodies,
        "indoor",
        INDOOR,
        edit(lambda d: d["provenance"].update(seed=6)),
        "glTF: the provenance",
    ),
    (
        bodies,
        "landscape",
        LANDSCAPE,
        change("mjcf.xml", r'( vertex=")([^ ]+)', add(5), 0),
        "MuJoCo: obstacle_",
    ),
    (
        bodies,
        "forest",
        FOREST,
        change("mjcf.xml", r'(name="tree_0" .*size=")([^ ]+)', add(0.05)),
        "MuJoCo: tree_0 differs",
    ),
    (
        bodies,
        "indoor",
        INDOOR,
        change("mjcf.xml", 'type="box"', 'type="bocks"'),
        "Error",
    ),
    (
        bodies,
        "road",
        ROAD,
        change("sdf", r"(<height>)([^<]+)", add(0.1)),
        "SDF: wall_0 is from",
    ),
    (bodies, "road", ROAD, change("sdf", "<static>", "<statik>"), "Error"),
    (bodies, "indoor", INDOOR, change("sdf", "<radius>|<size>", "<sise>", 3), "Error"),
    (bodies, "indoor", INDOOR, turn_inside_out, "trimesh:"),
    (bodies, "indoor", INDOOR, truncate, "gltf-validator"),
    (stages, "indoor", INDOOR, edit(lambda d: d["walls"].pop()), "bodies, not"),
    (
        stages,
        "indoor",
        INDOOR,
        edit(lambda d: d["start"]["position"].reverse()),
        "start is at",
    ),
    (
        stages,
        "indoor",
        INDOOR,
        edit(lambda d: d["provenance"].update(seed=6)),
        "USD: the provenance",
    ),
    (
        stages,
        "forest",
        FOREST,
        change("usda", r"(double radius = )(\S+)", add(0.05)),
        "USD: tree_0 differs",
    ),
    (
        stages,
        "road",
        ROAD,
        change("usda", r"(int\[\] faceVertexIndices = \[)(\d+), (\d+)", r"\1\3, \2"),
        "closed surface",
    ),
    (
        stages,
        "indoor",
        INDOOR,
        change("usda", r"(extent = \[\()([^,]+)", add(0.1)),
        "states the extent",
    ),
    (stages, "indoor", INDOOR, change("usda", 'upAxis = "Z"', 'upAxis = "Y"'), "z up"),
    (stages, "indoor", INDOOR, change("usda", "def Cube", "def Cubo"), "is a Cubo"),
    (stages, "indoor", INDOOR, change("usda", '"floor_plane"', '"carpet"'), "bodies, not"),
    (stages, "indoor", INDOOR, change("usda", '"guide"', '"render"'), "what robots drive on"),
    (stages, "indoor", INDOOR, change("usda", "double", "dubble"), "Error"),
]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    judge.add_envgen(parser)
    options, _ = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as folder:
        sound = Sound(options.envgen.resolve(), Path(folder))
        wrong = [case for case in CASES if not passes(sound, *case)]
    if not worlds_notice_crashes():
        sys.exit("a command that is killed passes for one that refuses")
    if wrong:
        sys.exit(f"{len(wrong)} of {len(CASES)} faults are not noticed")
    print(f"{len(CASES)} faults: each judge says what it must")


class Sound:
    """Worlds before they are broken, each made and judged once."""

    def __init__(self, binary, folder):
        self.binary, self.folder = binary, folder
        self.worlds, self.judged = {}, set()

    def copy(self, module, kind, settings):
        """A copy of a world to break, in which the judge finds nothing wrong."""
        if kind not in self.worlds:
            self.worlds[kind] = worlds.write(
                self.binary, kind, 5, settings, self.folder / kind
            )
        world = self.worlds[kind]
        if (module, kind) not in self.judged:
            complaints = judge.judge(module, world).complaints
            assert not complaints, complaints
            self.judged.add((module, kind))
        copy = Path(tempfile.mkdtemp(dir=self.folder))
        for file in self.folder.glob(f"{kind}.*"):
            shutil.copy(file, copy)
        return replace(world, stem=copy / kind, data=deepcopy(world.data))


def passes(sound, module, kind, settings, act, expected):
    """Whether a judge minds what is done to a world."""
    world = sound.copy(module, kind, settings)
    said = judge.judge(module, act(world) or world).complaints
    if expected is None:
        right = all("envgen check" in text for text in said)
    else:
        right = any(expected in text for text in said)
    if not right:
        print(f"{module.__name__} should say {expected!r}, but says {said}")
    return right


def worlds_notice_crashes():
    """Whether a command that is killed does not pass for one that refuses its settings."""
    try:
        worlds.envgen("sh", "-c", "kill -9 $$")
    except worlds.Crash:
        return True
    return False


if __name__ == "__main__":
    main()
