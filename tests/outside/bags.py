#!/usr/bin/env python3
"""Judges bags that trials wrote: decodes them with `mcap` and `rosbags`, and holds them against world and map.

Exit code 1 where there is a complaint, or where a fault that is made on purpose is not noticed. `rosbags` brings the
definitions of ROS 2 Humble, with which those in the bags are compared.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
import shapely
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import ros_maps
import shapes

# Trials: arguments of the example, and whether nothing moves in their world.
TRIALS = {
    "indoor": (["--seed", "2", "--time-limit", "240"], True),
    "rough laser, two robots": (
        ["--seed", "3", "--robots", "2", "--laser", "lms200_mm_rough", "--slam", "pose_graph"]
        + ["--time-limit", "120"],
        False,
    ),
    "wide laser": (
        ["--seed", "4", "--laser", "wide_12m", "--robot", "assets/robots/clearpath_jackal.ron"]
        + ["--time-limit", "120"],
        True,
    ),
    "people and smoke": (
        ["--seed", "5", "--set", "people=4", "--set", "smoke=0.2", "--time-limit", "120"],
        False,
    ),
}

# Deviation of the LMS 200's ranges is 1 cm: none of 100,000 is farther off than this.
FARTHEST_ECHO = 0.06

SECOND = 1_000_000_000


class Complaints(list):
    """What is wrong."""

    def must(self, holds, text):
        """Complains unless something holds."""
        if not holds:
            self.append(text)


def drive(program, folder, arguments):
    """Runs a trial and gives the path of its bag."""
    bag = folder / "bag" / "trial.mcap"
    words = [program, *arguments, "--out", folder / "out", "--log", bag]
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=600)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return bag


def decoded(path):
    """The summary of a file, and every message: topic, log time and content. Checksums are checked."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        header = reader.get_header()
        messages = [
            (channel.topic, message.log_time, content, channel, schema)
            for schema, channel, message, content in reader.iter_decoded_messages()
        ]
        attachments = {one.name: bytes(one.data) for one in reader.iter_attachments()}
    return header, summary, messages, attachments


def nanoseconds(stamp):
    return stamp.sec * SECOND + stamp.nanosec


def heading(q):
    return 2 * math.atan2(q.z, q.w)


def tum(path):
    return np.loadtxt(path)


def judge(path, is_still):
    """What is wrong with a bag, and what was judged."""
    said, counts = Complaints(), Counter()
    header, summary, messages, attachments = decoded(path)
    said.must(header.profile == "ros2", f"the profile is {header.profile}")
    compressions = {chunk.compression for chunk in summary.chunk_indexes}
    said.must(compressions == {"lz4"}, f"chunks are compressed by {compressions}")
    said.must(len(messages) == summary.statistics.message_count, "messages are lost")
    metadata_counts(path, messages, summary, said)
    definitions(summary, said)
    times = [time for _, time, *_ in messages]
    said.must(times == sorted(times), "messages are not in the order of time")

    by_topic = {}
    for topic, time, content, *_ in messages:
        by_topic.setdefault(topic, []).append((time, content))
    counts["messages"] += len(messages)
    report = json.loads(attachments["report.json"])
    beside = json.loads((path.parents[1] / "out" / "report.json").read_text())
    said.must(report == beside, "the attached report is another one")
    world = json.loads(attachments["world.json"])
    said.must(world["provenance"]["seed"] is not None, "the attached world has no seed")
    end = max(robot["time"] for robot in report["robots"]) * SECOND
    said.must(abs(max(times) - end) < 0.21 * SECOND, "the bag does not last as long as the trial")
    clocks = [nanoseconds(clock.clock) for _, clock in by_topic["/clock"]]
    said.must(clocks == [time for time, _ in by_topic["/clock"]], "/clock is not the log's time")
    said.must(clocks[0] == 0 and np.diff(clocks).max() <= SECOND / 5, "/clock has gaps")

    maps(path, by_topic["/map"], said, counts)
    static = {one.child_frame_id: one for _, m in by_topic["/tf_static"] for one in m.transforms}
    for number in range(len(report["robots"])):
        prefix = f"robot_{number + 1}/" if number else ""
        robot(path, prefix, number, by_topic, static, said)
        scans = by_topic[f"/{prefix}scan"]
        counts["scans"] += len(scans)
        for time, scan in scans:
            one_scan(time, scan, report["settings"]["laser"], said)
        if is_still:
            counts["echoes on walls"] += echoes(path, world, scans, static["laser"], said)
    return said, counts


def metadata_counts(path, messages, summary, said):
    """`metadata.yaml` agrees with the file."""
    text = yaml.safe_load((path.parent / "metadata.yaml").read_text())
    bag = text["rosbag2_bagfile_information"]
    said.must(bag["relative_file_paths"] == [path.name], "metadata.yaml names another file")
    said.must(bag["message_count"] == len(messages), "metadata.yaml counts otherwise")
    times = [time for _, time, *_ in messages]
    said.must(bag["duration"]["nanoseconds"] == max(times) - min(times), "another duration")
    counted = Counter(topic for topic, *_ in messages)
    channels = {channel.topic: channel for channel in summary.channels.values()}
    for entry in bag["topics_with_message_count"]:
        topic = entry["topic_metadata"]
        name = topic["name"]
        said.must(entry["message_count"] == counted[name], f"{name} is counted otherwise")
        schema = summary.schemas[channels[name].schema_id]
        said.must(topic["type"] == schema.name, f"{name} has another type")
        qos = channels[name].metadata["offered_qos_profiles"]
        said.must(topic["offered_qos_profiles"] == qos, f"{name} has another QoS")
        [profile] = yaml.safe_load(qos)
        latched = name in ("/map", "/tf_static")
        said.must(profile["durability"] == (1 if latched else 2), f"{name} has a wrong durability")
    said.must(len(bag["topics_with_message_count"]) == len(channels), "topics are missing")


def definitions(summary, said):
    """The definitions in the file are those of ROS 2."""
    humble = get_typestore(Stores.ROS2_HUMBLE)
    for schema in summary.schemas.values():
        said.must(schema.encoding == "ros2msg", f"{schema.name} is encoded as {schema.encoding}")
        own = get_typestore(Stores.EMPTY)
        own.register(get_types_from_msg(schema.data.decode(), schema.name))
        same = own.hash_rihs01(schema.name) == humble.hash_rihs01(schema.name)
        said.must(same, f"the definition of {schema.name} is another one")


def rosbags_reads(path, expected, said):
    """`rosbags` decodes every message of the folder, as `ros2 bag play` does, and of the file alone."""
    for place in (path.parent, path):
        with AnyReader([place], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            counted = Counter()
            for connection, _, data in reader.messages():
                content = reader.deserialize(data, connection.msgtype)
                written = reader.typestore.serialize_cdr(content, connection.msgtype)
                said.must(bytes(written) == bytes(data), f"{connection.topic} is encoded otherwise")
                counted[connection.topic] += 1
        said.must(counted.total() == expected, f"rosbags finds {counted.total()} in {place.name}")


def maps(path, found, said, counts):
    """Maps every 60 s, the last of which is the one that the trial wrote as a file."""
    times = [time for time, _ in found]
    said.must(times[0] == 0, "there is no first map")
    gaps = np.diff(times)
    said.must((gaps[:-1] == 60 * SECOND).all() and gaps[-1] <= 60 * SECOND, "maps are not every 60 s")
    for _, grid in found:
        cells = np.array(grid.data)
        said.must(cells.size == grid.info.width * grid.info.height, "a map has another size")
        said.must(np.isin(cells, (-1, 0, 100)).all(), "a map has other values")
    counts["maps"] += len(found)
    cells, resolution, origin = ros_maps.read(path.parents[1] / "out" / "ros_map.yaml")
    last = found[-1][1]
    shape = last.info.height, last.info.width
    said.must((np.array(last.data).reshape(shape) == cells).all(), "the last map is another one")
    said.must(abs(last.info.resolution - resolution) < 1e-6, "the map has another resolution")
    at = last.info.origin.position
    said.must(np.allclose([at.x, at.y], origin[:2]), "the map has another origin")


def robot(path, prefix, number, by_topic, static, said):
    """Frames join up, and poses are those of the trajectories."""
    suffix = f"_{number + 1}" if number else ""
    truth = tum(path.with_name(f"{path.stem}.truth{suffix}.tum"))
    estimate = tum(path.with_name(f"{path.stem}.estimate{suffix}.tum"))
    said.must(static[f"{prefix}laser"].header.frame_id == f"{prefix}base_link", "no laser frame")
    odom = {}
    for time, message in by_topic["/tf"]:
        for one in message.transforms:
            if one.child_frame_id == f"{prefix}base_link":
                said.must(one.header.frame_id == f"{prefix}odom", "odom is not the wheels' frame")
                odom[time] = one.transform
    for time, pose in by_topic[f"/{prefix}ground_truth"]:
        said.must(pose.header.frame_id == "map", "true poses are in another frame")
        said.must(nanoseconds(pose.header.stamp) == time, "a stamp is not the log's time")
        row = truth[round(time / SECOND * 20)]
        at = pose.pose.position
        said.must(np.allclose([time / SECOND, at.x, at.y], row[:3]), "a true pose is another one")
    last = None
    for time, message in by_topic["/tf_map"]:
        for one in message.transforms:
            if one.child_frame_id == f"{prefix}odom":
                said.must(one.header.frame_id == "map", "map is not the frame of maps")
                last = time, one.transform
    time, correction = last
    turn = heading(correction.rotation)
    x, y = odom[time].translation.x, odom[time].translation.y
    x, y = (
        correction.translation.x + math.cos(turn) * x - math.sin(turn) * y,
        correction.translation.y + math.sin(turn) * x + math.cos(turn) * y,
    )
    row = estimate[round(time / SECOND * 20)]
    said.must(np.allclose([x, y], row[1:3], atol=1e-6), "the transforms give another estimate")
    for time, odometry in by_topic[f"/{prefix}odom"]:
        at = odometry.pose.pose.position
        of_tf = odom[time].translation
        said.must((at.x, at.y) == (of_tf.x, of_tf.y), "/odom and /tf differ")
        said.must(odometry.child_frame_id == f"{prefix}base_link", "/odom is of another frame")


def one_scan(time, scan, laser, said):
    """A scan keeps to its own limits."""
    ranges = np.array(scan.ranges)
    said.must(nanoseconds(scan.header.stamp) == time, "a stamp of a scan is not the log's time")
    beams = round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1
    said.must(len(ranges) == beams == laser["beams"], f"{len(ranges)} ranges, {beams} beams")
    width = scan.angle_max - scan.angle_min
    said.must(abs(width - laser["field_of_view"]) < 1e-5, f"the field of view is {width}")
    said.must(abs(scan.scan_time - 0.05 * laser["ticks_a_scan"]) < 1e-6, "another period")
    measured = ranges[np.isfinite(ranges)]
    within = (measured >= scan.range_min) & (measured <= scan.range_max)
    said.must(within.all(), "a range is beyond the limits of its scan")


def echoes(path, world, scans, mount, said):
    """Echoes, seen from the true pose, lie on solid parts of the world."""
    truth = tum(path.with_name(f"{path.stem}.truth.tum"))
    cores = [shapes.core(solid) for solid in shapes.solids(world)]
    solid = [geometry.buffer(radius) if radius else geometry for geometry, radius in cores]
    tree = shapely.STRtree(solid)
    offset = mount.transform.translation
    turn = heading(mount.transform.rotation)
    judged = 0
    for time, scan in scans[::7]:
        _, x, y, _, _, _, qz, qw = truth[round(time / SECOND * 20)]
        facing = 2 * math.atan2(qz, qw)
        x += math.cos(facing) * offset.x - math.sin(facing) * offset.y
        y += math.sin(facing) * offset.x + math.cos(facing) * offset.y
        ranges = np.array(scan.ranges)
        angles = facing + turn + scan.angle_min + scan.angle_increment * np.arange(len(ranges))
        hit = np.isfinite(ranges)
        points = shapely.points(
            x + ranges[hit] * np.cos(angles[hit]), y + ranges[hit] * np.sin(angles[hit])
        )
        _, distances = tree.query_nearest(points, return_distance=True, all_matches=False)
        far = distances.max(initial=0)
        # Within a solid the distance is 0.
        said.must(far < FARTHEST_ECHO, f"an echo at {time / SECOND} s is {far:.3f} m from any solid")
        judged += len(distances)
    return judged


def faults_are_noticed(path, is_still):
    """Whether files that are broken on purpose are complained of."""
    good = path.read_bytes()
    middle = len(good) // 2

    def complains(content):
        path.write_bytes(content)
        try:
            return bool(judge(path, is_still)[0])
        except Exception:  # Readers raise whatever they like.
            return True
        finally:
            path.write_bytes(good)

    flipped = good[:middle] + bytes([good[middle] ^ 1]) + good[middle + 1 :]
    metadata = path.with_name("metadata.yaml")
    text = metadata.read_text()
    metadata.write_text(text.replace("durability: 1", "durability: 2"))
    qos = complains(good)
    metadata.write_text(text)
    truth = path.with_name(f"{path.stem}.truth.tum")
    poses = truth.read_text()
    truth.write_text("\n".join(poses.splitlines()[1:] + [poses.splitlines()[-1]]))
    late = complains(good)
    truth.write_text(poses)
    return {
        "a flipped bit": complains(flipped),
        "a file that ends early": complains(good[:-100]),
        "another QoS": qos,
        "a trajectory that is a tick late": late,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    default = os.environ.get("MAPPING_TRIAL", "target/release/examples/mapping_trial")
    parser.add_argument("--mapping-trial", type=Path, default=default, help="[%(default)s]")
    program = parser.parse_args().mapping_trial.resolve()
    wrong = 0
    for name, (arguments, is_still) in TRIALS.items():
        folder = Path(tempfile.mkdtemp(prefix="envgen-bag-"))
        path = drive(program, folder, arguments)
        said, counts = judge(path, is_still)
        rosbags_reads(path, counts["messages"], said)
        for text, times in Counter(said).items():
            print(f"{name}: {text} ({times} times)")
        wrong += len(said)
        size = path.stat().st_size / 1e6
        print(f"{name}: {size:.2f} MB, {', '.join(f'{n} {what}' for what, n in counts.items())}")
        if name == "indoor":
            for fault, noticed in faults_are_noticed(path, is_still).items():
                if not noticed:
                    print(f"{fault} is not noticed")
                    wrong += 1
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
