"""Worlds to judge: settings drawn from a number, and the files that envgen writes for them."""

import json
import math
import random
import subprocess
from dataclasses import dataclass
from pathlib import Path

KINDS = ["hallway", "forest", "road", "indoor", "landscape", "cellular"]

# What is written of every kind, and of one kind alone.
ENDINGS = [
    "json", "svg", "png", "geojson", "building.yaml", "obstacles.csv", "sdf", "mjcf.xml", "glb", "usda",
]
ENDINGS_OF = {"road": ["xodr", "csv"], "landscape": ["asc", "map", "classes.png"]}

# Rules between settings refuse some draws; so many in a row mean that the draw is wrong.
MOST_REFUSALS = 30

# Cells of the longer side of a map for ROS: judging takes a step for each cell.
MAP_CELLS = 500


class Refusal(Exception):
    """envgen ended with an error that it stated."""


class Crash(Exception):
    """envgen ended otherwise than by success or an error that it states."""


@dataclass(frozen=True)
class World:
    """A world's files, which all have the same name but for the ending, and the JSON's content."""

    kind: str
    stem: Path
    settings: dict
    data: dict
    envgen: Path

    def path(self, ending):
        """The file with this ending."""
        return self.stem.parent / f"{self.stem.name}.{ending}"

    def run(self, *arguments):
        """What envgen prints."""
        return envgen(self.envgen, *arguments)


def envgen(binary, *arguments):
    """Runs envgen and gives what it prints."""
    words = [str(binary), *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    if done.returncode == 0:
        return done.stdout
    said = (done.stdout + done.stderr).strip()
    if done.returncode in (1, 2) and said and "panicked" not in said:
        raise Refusal(said)
    raise Crash(f"{' '.join(words)}\nexit code {done.returncode}\n{said}")


def make(binary, kind, index, folder):
    """The world number `index` of a kind, the first with the defaults, and how many draws envgen refused."""
    for attempt in range(MOST_REFUSALS):
        draw = random.Random(f"{kind} {index} {attempt}")
        settings = {} if index == 0 else DRAWS[kind](draw)
        try:
            return (
                write(binary, kind, index, settings, folder / f"{kind}-{index:03}"),
                attempt,
            )
        except Refusal as error:
            refusal = error
    raise Crash(
        f"{kind} {index}: {MOST_REFUSALS} draws refused, the last with {refusal}"
    )


def write(binary, kind, seed, settings, stem):
    """Has envgen write all files of a world."""
    words = ["generate", kind, "--seed", seed]
    for name, value in settings.items():
        words += ["--set", f"{name}={value}"]
    endings = ENDINGS + ENDINGS_OF.get(kind, [])
    outs = [word for ending in endings for word in ("--out", f"{stem}.{ending}")]
    envgen(binary, *words, *outs)
    data = json.loads(Path(f"{stem}.json").read_text())
    low, high = data["bounds"]["min"], data["bounds"]["max"]
    side = max(high[0] - low[0], high[1] - low[1])
    resolution = max(0.05, side / MAP_CELLS)
    gridded = [f"{stem}.yaml", "--out", f"{stem}.house.json"]
    envgen(binary, *words, "--out", *gridded, "--resolution", resolution)
    return World(kind, stem, settings, data, binary)


def hallway(draw):
    """Settings of a hallway: all shapes and features, corridors from narrow to as wide as allowed."""
    p_tt = draw.choice([0, 0, draw.random()])
    pitch = draw.uniform(0.6, 6)
    wall = draw.uniform(0.02, 0.3)
    width = draw.uniform(0.2, 1) * ((1 if p_tt > 0 else 2) * pitch - wall)
    settings = {
        "segments": draw.randint(1, 150),
        "p_st": draw.random(),
        "p_tt": p_tt,
        "start": draw.choice([1, 2, 3, 4, 5, 6, 7, 8, "stationary"]),
        "pitch": pitch,
        "wall": wall,
        "width": width,
        "corners": draw.choice(["square", "rounded"]),
        "ends": draw.choice(["closed", "open"]),
    }
    for feature in draw.sample(
        ["alcove", "door_frame", "narrowing"], draw.randint(0, 3)
    ):
        settings[f"{feature}_rate"] = draw.uniform(0, 0.3 / pitch)
        settings[f"{feature}_width"] = draw.uniform(0.3, 0.9) * min(
            width, pitch - 2 * wall
        )
    if "alcove_rate" in settings:
        settings["alcove_depth"] = draw.uniform(0.1, 0.4) * pitch
    if draw.random() < 0.5:
        settings["wall_height"] = draw.uniform(0.1, 5)
    return settings


def forest(draw):
    """Settings of a forest on both sides of the density at which no way leads through."""
    width, height = draw.uniform(5, 60), draw.uniform(5, 60)
    radius = draw.uniform(0.1, 1.2)
    robot_radius = draw.choice([0.01, 0.36, draw.uniform(0.05, 1)])
    # Discs percolate near intensity times pi times (radius + robot radius) squared = 1.128.
    crowding = draw.uniform(0.1, 1.5)
    settings = {
        "width": width,
        "height": height,
        "radius": radius,
        "robot_radius": robot_radius,
        "intensity": min(crowding / (math.pi * (radius + robot_radius) ** 2), 2),
        "border": draw.choice(["open", "inset", "torus"]),
        "clearing": draw.choice([0, draw.uniform(0, 2)]),
    }
    if draw.random() < 0.6:
        settings["radius_law"] = draw.choice(["uniform", "log_normal"])
        settings["radius_min"] = radius * draw.uniform(0.3, 0.9)
        settings["radius_max"] = radius * draw.uniform(1.1, 2)
    if draw.random() < 0.4:
        settings["min_distance"] = draw.uniform(0, 0.7) / settings["intensity"] ** 0.5
    if draw.random() < 0.3:
        rows = range(draw.randint(1, 4))
        cols = range(draw.randint(1, 4))
        settings["density"] = [[round(draw.random(), 2) for _ in cols] for _ in rows]
    if draw.random() < 0.5:
        settings["tree_height"] = draw.uniform(0.1, 30)
    return settings


def road(draw):
    """Settings of a road: lines, arcs and spirals, one to six lanes, open and closed, aimed and not."""
    lanes = draw.randint(1, 6)
    settings = {
        "length": draw.uniform(100, 2000),
        "step": draw.uniform(0.3, 5),
        "speed": draw.uniform(0, 15),
        "friction": draw.uniform(0.3, 1),
        "theta_min": draw.uniform(5, 40),
        "theta_max": draw.uniform(40, 170),
        "turns": draw.choice(["uniform_radius", "uniform_angle"]),
        "transition": draw.choice([0, 0.5, draw.uniform(0, 0.5)]),
        "lengths": draw.choice(["reserve", "reserve", "as_published"]),
        "alpha": 10 ** draw.uniform(-1, 2),
        "lanes": lanes,
        "width": lanes * draw.uniform(2.5, 4),
        "kerb": draw.choice([0, draw.uniform(0.05, 0.4)]),
        "crossing": draw.choice(["allow", "resample"]),
    }
    if draw.random() < 0.6:
        settings |= {"random": draw.randint(1, 8), "p_turn": draw.random()}
    else:
        segments = ["straight", "left", "right", "turn"]
        settings["prefabs"] = ",".join(draw.choices(segments, k=draw.randint(1, 8)))
    if draw.random() < 0.5:
        settings |= {
            "start_x": draw.uniform(-1e3, 1e3),
            "start_y": draw.uniform(-1e3, 1e3),
        }
        settings["start_heading"] = draw.uniform(-360, 360)
    if draw.random() < 0.2:
        settings |= {"closed": "true", "random": draw.randint(4, 8), "p_turn": 0.7}
    elif draw.random() < 0.2:
        settings |= {"aim_x": draw.uniform(50, 900), "aim_y": draw.uniform(-300, 300)}
    if draw.random() < 0.5:
        settings["kerb_height"] = draw.uniform(0.05, 1)
    return settings


def indoor(draw):
    """Settings of an indoor map: both profiles and layouts, robots from 1 cm to what doorways allow."""
    doorway = draw.uniform(0.5, 1.2)
    settings = {
        "difficulty": draw.uniform(0, 10),
        "width": draw.randint(4, 14),
        "height": draw.randint(4, 14),
        "unit": draw.uniform(2.4, 4),
        "profile": draw.choice(["thesis", "guaranteed", "guaranteed"]),
        "layout": draw.choice(["grid", "l_system"]),
        "branching": draw.random(),
        "room_choice": draw.choice(["difficulty", "uniform"]),
        "turn": draw.choice(["profile", "never", "allowed"]),
        "cycles": draw.choice(["difficulty", "allow", "prevent"]),
        "wall": draw.uniform(0.02, 0.25),
        "doorway": doorway,
        "footprint": draw.choice(
            [0.01, doorway / 2 - 0.05, draw.uniform(0.05, doorway / 2 - 0.05)]
        ),
    }
    if draw.random() < 0.3:
        settings["doorway_probability"] = draw.random()
    if draw.random() < 0.3:
        settings["clearance"] = draw.uniform(0, 1)
    if draw.random() < 0.5:
        settings["wall_height"] = draw.uniform(0.5, 5)
        settings["doorway_height"] = draw.uniform(0.5, 3)
    return settings


def landscape(draw):
    """Settings of a landscape: all algorithms, with and without a Total Edge and impassable classes."""
    rows, cols, classes = draw.randint(3, 70), draw.randint(3, 70), draw.randint(2, 9)
    settings = {
        "rows": rows,
        "cols": cols,
        "classes": classes,
        "entropy": draw.uniform(0.2, 0.95) * math.log(classes),
        "keep_classes": draw.choice(["true", "false"]),
        "order": draw.choice(["shuffled", "descending"]),
        "algorithm": draw.choice(["random", "automaton", "mixed", "bands", "smooth"]),
        "cell": draw.choice([0.1, 1, 30, draw.uniform(0.05, 50)]),
    }
    if draw.random() < 0.5:
        sides = rows * (cols - 1) + cols * (rows - 1)
        settings["total_edge"] = round(draw.uniform(0.2, 0.7) * sides)
    if draw.random() < 0.5:
        speeds = [draw.choice([0, 1, round(draw.random(), 2)]) for _ in range(classes)]
        settings["speeds"] = ",".join(map(str, speeds))
    if draw.random() < 0.5:
        settings["rock_height"] = draw.uniform(0.05, 20)
    return settings


def cellular(draw):
    """Settings of a block field: all rules, with fields that are often accepted."""
    robot_cells = draw.randint(0, 2)
    return {
        "rows": draw.randint(12, 60),
        "cols": draw.randint(12, 60),
        "cell_size": draw.choice([0.05, 0.15, 1, draw.uniform(0.05, 5)]),
        "fill": draw.uniform(0, [0.45, 0.3, 0.22][robot_cells]),
        "smoothing": draw.randint(0, 6),
        "open_sides": draw.choice(["none", "left_right", "all"]),
        "robot_cells": robot_cells,
        "acceptance": draw.choice(["largest_regions", "crossing", "all"]),
        "attempts": 1000,
        "ends": draw.choice(["random", "middle"]),
    }


DRAWS = {
    "hallway": hallway,
    "forest": forest,
    "road": road,
    "indoor": indoor,
    "landscape": landscape,
    "cellular": cellular,
}
