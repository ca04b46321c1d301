#!/usr/bin/env python3
"""Judges worlds that envgen wrote with programs that know nothing of it.

Each kind has judges: a module's function `judge(world, report)`. It complains of what is wrong, and
counts what it has proved. Exit code 1 where there is a complaint. Worlds with complaints are kept.
"""

import argparse
import os
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import bodies
import certificates
import landscapes
import pictures
import plans
import roads
import ros_maps
import stages
import worlds

JUDGES = {
    kind: [certificates, plans, ros_maps, pictures, bodies, stages]
    + {"road": [roads], "landscape": [landscapes]}.get(kind, [])
    for kind in worlds.KINDS
}


class Report:
    """What judges say of a world."""

    def __init__(self):
        self.complaints = []
        self.counts = Counter()

    def complain(self, text):
        """States that something is wrong."""
        self.complaints.append(text)

    def count(self, what, number=1):
        """Counts what was judged, so that one sees that it was."""
        self.counts[what] += number


def judge(module, world):
    """What one judge says. One that stumbles over a file complains, too."""
    report = Report()
    try:
        module.judge(world, report)
    except Exception as error:  # Readers raise whatever they like.
        report.complain(f"{type(error).__name__}: {error}")
    report.complaints = [f"{module.__name__}: {text}" for text in report.complaints]
    return report


def judge_world(binary, folder, order):
    """Makes a world, asks all its judges and removes its files if none complains."""
    kind, index = order
    report = Report()
    try:
        world, refusals = worlds.make(binary, kind, index, folder)
    except worlds.Crash as crash:
        report.complain(str(crash))
        return kind, index, report
    report.count("refused draws", refusals)
    for module in JUDGES[kind]:
        said = judge(module, world)
        report.complaints += said.complaints
        report.counts += said.counts
    if not report.complaints:
        for file in folder.glob(f"{world.stem.name}.*"):
            file.unlink()
    return kind, index, report


def add_envgen(parser):
    """The option that says where envgen is."""
    default = os.environ.get("ENVGEN", "target/release/envgen")
    parser.add_argument(
        "--envgen", type=Path, default=default, help="the command [%(default)s]"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    add_envgen(parser)
    parser.add_argument(
        "--count", type=int, default=3, help="worlds of each kind [%(default)s]"
    )
    parser.add_argument(
        "--first", type=int, default=0, help="number of the first [%(default)s]"
    )
    parser.add_argument(
        "--kinds", nargs="+", choices=worlds.KINDS, default=worlds.KINDS
    )
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count(), help="processes [all cores]"
    )
    parser.add_argument(
        "--keep", type=Path, help="where files of worlds with complaints stay"
    )
    options = parser.parse_args()
    folder = options.keep or Path(tempfile.mkdtemp(prefix="envgen-outside-"))
    folder.mkdir(parents=True, exist_ok=True)
    orders = [
        (k, options.first + i) for k in options.kinds for i in range(options.count)
    ]
    totals = {kind: Counter() for kind in options.kinds}
    complaints = 0
    with ProcessPoolExecutor(options.jobs) as pool:
        task = partial(judge_world, options.envgen.resolve(), folder)
        for kind, index, report in pool.map(task, orders):
            totals[kind] += report.counts + Counter(worlds=1)
            complaints += len(report.complaints)
            for text in report.complaints:
                print(f"{kind} {index}: {text}", flush=True)
    for kind, counts in totals.items():
        print(f"\n{kind}")
        for what, number in sorted(counts.items()):
            print(f"  {number:6}  {what}")
    if complaints:
        sys.exit(f"\n{complaints} complaints; the files are in {folder}")
    if not options.keep:
        folder.rmdir()
    print("\nno complaints")


if __name__ == "__main__":
    main()
