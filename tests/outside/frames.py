#!/usr/bin/env python3
"""Judges the pictures of a robot's camera that the guide's command with `--camera` wrote to `out/frames`.

`trimesh` reads the camera and MuJoCo casts the rays of its pixels into the world of the trial, as MJCF: depths and
labels must be what they meet. Exit code 1 where there is a complaint, or where a fault that is made on purpose is not
noticed.
"""

import argparse
import copy
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np
import shapely
from PIL import Image
from trimesh.scene.cameras import Camera

import bags
import bodies
from bags import Complaints

# Every so many pixels of every so many pictures are judged.
PIXELS, FRAMES = 7, 4

# Depths are in whole millimetres.
OFF = 1.5e-3

# Share of pixels that may differ: a ray along a silhouette hits one side or the other.
SILHOUETTES = 1e-3

# What MJCF does not have.
UNSEEN = {"ceiling", "leaf", "person", "robot"}


class Rays:
    """Casts rays into a world."""

    def __init__(self, mjcf):
        self.model = mujoco.MjModel.from_xml_path(str(mjcf))
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)

    def cast(self, origin, directions):
        """Distance along each direction of what it meets, -1 for nothing, and its name, or `none`."""
        count = len(directions)
        geoms, distances = np.zeros(count, np.int32), np.zeros(count)
        mujoco.mj_multiRay(
            self.model,
            self.data,
            origin,
            np.ascontiguousarray(directions).ravel(),
            None,
            1,
            -1,
            geoms,
            distances,
            None,
            count,
            1000.0,
        )
        names = [self.model.geom(geom).name if geom >= 0 else "none" for geom in geoms]
        return distances, np.array(names)


def is_part_of(part, point):
    """Whether a point is on a part: where two walls overlap, faces may coincide."""
    shape, bottom, top = part
    return (
        shapely.distance(shape, shapely.Point(point[:2])) < OFF
        and bottom - OFF < point[2] < top + OFF
    )


def judge(folder, description, rays, parts):
    """What is wrong with a folder of pictures, and the number of pixels that were judged."""
    said = Complaints()
    size = description["w"], description["h"]
    said.must(description["camera_model"] == "PINHOLE", "another camera model")
    said.must(
        (2 * description["cx"], 2 * description["cy"]) == size, "cx and cy are not the middle"
    )
    camera = Camera(resolution=size, focal=(description["fl_x"], description["fl_y"]))
    directions, pixels = camera.to_rays()
    # `trimesh` counts rows from below.
    columns, rows = pixels[::PIXELS, 0], size[1] - 1 - pixels[::PIXELS, 1]
    directions = directions[::PIXELS]
    labels = {label["id"]: label for label in description["labels"]}
    times = [frame["time"] for frame in description["frames"]]
    # Pictures are taken at ticks of 50 ms.
    mean = (times[-1] - times[0]) / (len(times) - 1)
    period = 1 / description["camera"]["rate"]
    said.must(abs(mean - period) <= 0.05 / (len(times) - 1), "pictures are not at the rate")
    judged, wrong_depths, wrong_labels = 0, 0, 0
    for frame in description["frames"][::FRAMES]:
        image = lambda kind: Image.open(folder / frame[f"{kind}file_path"])
        colours = image("")
        said.must(
            (colours.mode, colours.size) == ("RGB", size), f"a picture is {colours.mode}, {colours.size}"
        )
        said.must(np.ptp(np.asarray(colours)) > 30, "a picture shows nothing")
        pose = np.array(frame["transform_matrix"])
        said.must(np.allclose(pose[:3, 3], frame["position"]), "two positions differ")
        x, y, z, w = frame["orientation"]
        turned = np.zeros(9)
        mujoco.mju_quat2Mat(turned, np.array([w, x, y, z]))
        said.must(np.allclose(turned.reshape(3, 3), pose[:3, :3]), "two orientations differ")
        origin, towards = pose[:3, 3], directions @ pose[:3, :3].T
        distances, names = rays.cast(origin, towards)
        depths = np.asarray(image("depth_"))[rows, columns] * description["depth_unit_scale_factor"]
        seen = [labels.get(label) for label in np.asarray(image("label_"))[rows, columns]]
        said.must(None not in seen, "a label is not described")
        is_seen = np.array([label is not None and label["kind"] not in UNSEEN for label in seen])
        found = np.array([label["name"] if label else "" for label in seen])
        # The camera looks along -z.
        along = np.where(distances < 0, 0, distances * -directions[:, 2])
        wrong_depths += np.count_nonzero(is_seen & (np.abs(along - depths) > OFF))
        met = origin + distances[:, None] * towards
        wrong_labels += sum(
            found[i] not in parts or not is_part_of(parts[found[i]], met[i])
            for i in np.flatnonzero(is_seen & (found != names))
        )
        judged += np.count_nonzero(is_seen)
    said.must(judged > 0, "nothing is seen")
    said.must(wrong_depths <= SILHOUETTES * judged, f"{wrong_depths} of {judged} depths are off")
    said.must(wrong_labels <= SILHOUETTES * judged, f"{wrong_labels} of {judged} labels are off")
    return said, judged


def faults_are_noticed(folder, description, rays, parts):
    """Whether descriptions that are wrong on purpose are complained of."""

    def complains(change):
        wrong = copy.deepcopy(description)
        change(wrong)
        return bool(judge(folder, wrong, rays, parts)[0])

    def turn(wrong):
        for frame in wrong["frames"]:
            matrix = np.array(frame["transform_matrix"])
            matrix[:3, :3] = matrix[:3, :3] @ np.diag([1, -1, -1])
            frame["transform_matrix"] = matrix.tolist()
            x, y, z, w = frame["orientation"]
            frame["orientation"] = [w, z, -y, -x]

    def move(wrong):
        for frame in wrong["frames"]:
            frame["transform_matrix"][2][3] += 0.01
            frame["position"][2] += 0.01

    def shift(wrong):
        names = [label["name"] for label in wrong["labels"]]
        for label, name in zip(wrong["labels"], names[1:] + names[:1]):
            label["name"] = name

    def zoom(wrong):
        wrong.update(fl_x=1.01 * wrong["fl_x"], fl_y=1.01 * wrong["fl_y"])

    def slow(wrong):
        for frame in wrong["frames"]:
            frame["time"] *= 1.1

    return {
        "pictures at another rate": complains(slow),
        "a focal length of 1 % more": complains(zoom),
        "another unit of depth": complains(lambda d: d.update(depth_unit_scale_factor=1.01e-3)),
        "the axes of OpenCV": complains(turn),
        "a camera 1 cm higher": complains(move),
        "labels of others": complains(shift),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    trial = os.environ.get("MAPPING_TRIAL", "target/release/examples/mapping_trial")
    parser.add_argument("--mapping-trial", type=Path, default=trial, help="[%(default)s]")
    envgen = os.environ.get("ENVGEN", "target/release/envgen")
    parser.add_argument("--envgen", type=Path, default=envgen, help="[%(default)s]")
    parser.add_argument("--frames", type=Path, default="out/frames", help="[%(default)s]")
    options = parser.parse_args()
    description = json.loads((options.frames / "frames.json").read_text())
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        # The command has the world of the trial without other arguments.
        bag = bags.drive(options.mapping_trial.resolve(), scratch, ["--time-limit", "1"])
        world, mjcf = scratch / "world.json", scratch / "world.mjcf.xml"
        world.write_bytes(bags.decoded(bag)[3]["world.json"])
        words = [options.envgen, "convert", world, "--out", mjcf]
        subprocess.run(list(map(str, words)), check=True, timeout=600)
        rays, parts = Rays(mjcf), bodies.expected(json.loads(world.read_text()))
    said, judged = judge(options.frames, description, rays, parts)
    for text in said:
        print(f"camera: {text}")
    print(f"camera: {judged} pixels judged")
    missed = [
        fault
        for fault, is_noticed in faults_are_noticed(
            options.frames, description, rays, parts
        ).items()
        if not is_noticed
    ]
    for fault in missed:
        print(f"camera: {fault} is not noticed")
    return 1 if said or missed else 0


if __name__ == "__main__":
    sys.exit(main())
