#!/usr/bin/env python3
"""Explores with envgen's mapping trials, in the standard library alone.

    mapping_trial --driver "python3 examples/drivers/explorer.py"

Each robot drives to the nearest frontier, where free ground meets unknown ground, on a grid that its
scans are drawn into. The poses are the trial's own estimates; with --own-slam they are this
program's, from the wheels and from matching scans to the grid, and pose and map are scored instead
of the trial's. The lines are described in docs/driver-protocol.md.
"""

import base64
import heapq
import json
import math
import sys

CELL = 0.1  # side of a cell in metres
SIDE = 2048  # cells along a side of the grid, with the first start in its middle
SEEN = 5.0  # metres up to which neighbouring beams leave no cell between them out
UNKNOWN, HIT, MISS = 128, 30, 4  # a cell is a byte: below 128 rather free, above rather occupied
LEAST, FREE, OCCUPIED = UNKNOWN - 40, UNKNOWN - 6, UNKNOWN + 10
# Plans step over every other cell; what blocks the robot is wider than that.
AROUND = (2, -2, 2 * SIDE, -2 * SIDE)
STEPS = [(step, 10) for step in AROUND] + [(a + b, 14) for a in AROUND[:2] for b in AROUND[2:]]
RIDGE = [(x + y * SIDE, (2 - abs(x)) * (2 - abs(y))) for x in (-1, 0, 1) for y in (-1, 0, 1)]
PERCENT = bytes(0 if i < FREE else 100 if i > OCCUPIED else 255 for i in range(256))


def wrapped(angle):
    return math.remainder(angle, math.tau)


def disc(radius):
    """Offsets of the cells whose middle lies within a radius in metres."""
    reach = int(radius / CELL)
    cells = [(x, y) for x in range(-reach, reach + 1) for y in range(-reach, reach + 1)]
    return [x + y * SIDE for x, y in cells if math.hypot(x, y) * CELL <= radius]


class Grid:
    """What is known of each cell, and how near it is to something occupied."""

    def __init__(self, start, radius):
        self.left = math.floor(start[0] / CELL) - SIDE // 2
        self.low = math.floor(start[1] / CELL) - SIDE // 2
        self.odds = bytearray([UNKNOWN]) * (SIDE * SIDE)
        self.blocked = bytearray(SIDE * SIDE)  # occupied cells that a robot here would touch
        self.close = bytearray(SIDE * SIDE)  # occupied cells a little farther away
        self.ridge = bytearray(SIDE * SIDE)  # high where scans should end
        # Cells that are half in a wall narrow doors: half a cell less keeps them open.
        self.touching, self.closing = disc(radius - CELL / 2), disc(radius + 0.25)
        self.box = [SIDE // 2, SIDE // 2, SIDE // 2, SIDE // 2]
        self.odd = False

    def index(self, x, y):
        return math.floor(x / CELL) - self.left + (math.floor(y / CELL) - self.low) * SIDE

    def middle(self, cell):
        row, col = divmod(cell, SIDE)
        return (col + self.left + 0.5) * CELL, (row + self.low + 0.5) * CELL

    def reaches(self, x, y):
        """Whether everything that is seen from a place lies on the grid."""
        least, most = (SEEN + 1.0) / CELL, SIDE - (SEEN + 1.0) / CELL
        return least < x / CELL - self.left < most and least < y / CELL - self.low < most

    def draw(self, laser, beams, ranges, max_range):
        """Draws a scan that was taken from a pose of the laser, every other beam at a time."""
        self.odd = not self.odd
        x, y, heading = laser
        if not self.reaches(x, y):
            return
        column, row = x / CELL - self.left, y / CELL - self.low
        free, hits = set(), set()
        cos, sin = math.cos(heading), math.sin(heading)
        for (c, s), r in zip(beams[self.odd::2], ranges[self.odd::2]):
            if r is None:
                continue
            dx, dy = cos * c - sin * s, sin * c + cos * s
            length = min(r, SEEN) / CELL
            free.update([int(column + k * dx) + int(row + k * dy) * SIDE for k in range(int(length))])
            if r < max_range and r <= SEEN:
                hits.add(int(column + length * dx) + int(row + length * dy) * SIDE)
        self.widen(column, row)
        odds = self.odds
        for cell in free - hits:
            old = odds[cell]
            if old > LEAST:
                odds[cell] = old - MISS
                if old > OCCUPIED >= old - MISS:
                    self.change(cell, -1)
        for cell in hits:
            old = odds[cell]
            if old < 255 - HIT:
                odds[cell] = old + HIT
                if old <= OCCUPIED < old + HIT:
                    self.change(cell, 1)

    def mark(self, x, y, odds):
        """Something that no laser sees is at a place, such as water or what was bumped into."""
        cell = self.index(x, y)
        if self.reaches(x, y) and self.odds[cell] <= OCCUPIED:
            self.odds[cell] = odds
            self.change(cell, 1)

    def change(self, cell, by):
        for offset in self.touching:
            self.blocked[cell + offset] += by
        for offset in self.closing:
            self.close[cell + offset] += by
        for offset, weight in RIDGE:
            self.ridge[cell + offset] += by * weight

    def widen(self, column, row):
        """The part of the grid that was drawn into grows around a place."""
        reach = int(SEEN / CELL) + 2
        left, low, right, high = self.box
        self.box = [
            min(left, int(column) - reach), min(low, int(row) - reach),
            max(right, int(column) + reach), max(high, int(row) + reach),
        ]

    def is_frontier(self, cell):
        odds = self.odds
        return odds[cell] < FREE and any(odds[cell + step] == UNKNOWN for step in AROUND)

    def path_to_frontier(self, start, skipped):
        """The cheapest path from a cell to a frontier; None where there is none."""
        odds, blocked, close = self.odds, self.blocked, self.close
        costs, origins, queue, up = {start: 0}, {}, [(0, start)], 2 * SIDE
        while queue:
            cost, cell = heapq.heappop(queue)
            if cost > costs[cell]:
                continue
            if (
                UNKNOWN in (odds[cell + 2], odds[cell - 2], odds[cell + up], odds[cell - up])
                and not blocked[cell] and cell not in skipped
            ):
                # A few cells alone are a gap between two beams.
                if sum(self.is_frontier(cell + step) for step, _ in STEPS) >= 2:
                    path = [cell]
                    while path[-1] != start:
                        path.append(origins[path[-1]])
                    return path[::-1]
            # A robot that is too near to an obstacle may leave.
            leaving = blocked[cell] and cost < 1000
            for step, length in STEPS:
                after = cell + step
                if odds[after] < FREE and (leaving or not blocked[after]):
                    # The nearer to walls the dearer, so that paths lead through the middle of doors.
                    total = cost + length * (4 + close[after])
                    if total < costs.get(after, 1 << 30):
                        costs[after], origins[after] = total, cell
                        heapq.heappush(queue, (total, after))
        return None

    def match(self, pose, points, far, turn):
        """The pose near a given one from which points in the robot's frame fit the grid best, at
        most so far and turned by so much: along a wall everything fits.
        """
        def fit(x, y, heading):
            cos, sin = math.cos(heading) / CELL, math.sin(heading) / CELL
            column, row = x / CELL - self.left, y / CELL - self.low
            ridge = self.ridge
            return sum([
                ridge[int(column + cos * px - sin * py) + int(row + sin * px + cos * py) * SIDE]
                for px, py in points
            ])

        if not self.reaches(pose[0], pose[1]) or len(points) < 20:
            return pose
        best, most = pose, fit(*pose)
        for part in (0.5, 0.25, 0.125):
            step, angle, better = part * far, part * turn, True
            while better:
                better = False
                x, y, heading = best
                for tried in (
                    (x + step, y, heading), (x - step, y, heading), (x, y + step, heading),
                    (x, y - step, heading), (x, y, heading + angle), (x, y, heading - angle),
                ):
                    near = math.dist(tried[:2], pose[:2]) <= far and abs(tried[2] - pose[2]) <= turn
                    found = fit(*tried) if near else 0
                    if found > most:
                        best, most, better = tried, found, True
        return best

    def message(self):
        """The part that was drawn into, as lines hold maps."""
        left, low, right, high = self.box
        rows = [self.odds[row * SIDE + left : row * SIDE + right] for row in range(low, high)]
        cells = b"".join(rows).translate(PERCENT)
        return {
            "origin": [(left + self.left) * CELL, (low + self.low) * CELL],
            "resolution": CELL, "cols": right - left, "rows": high - low,
            "cells": base64.b64encode(cells).decode(),
        }


class Robot:
    """Drives one robot."""

    def __init__(self, hello, number, grid, own_slam):
        laser = hello["laser"]
        angles = [laser["first_angle"] + laser["angle_step"] * i for i in range(laser["beams"])]
        self.beams = [(math.cos(angle), math.sin(angle)) for angle in angles]
        self.laser, self.max_range = laser["pose"], laser["max_range"]
        self.body = hello["robot"]
        self.speed = min(0.5, self.body["max_speed"])
        self.turn_rate = min(1.2, self.body["max_turn_rate"])
        self.radius = self.body["swing_radius"]
        self.grid, self.own_slam = grid, own_slam
        self.pose = hello["starts"][number]
        self.drawn = None  # where the last scan was drawn
        self.ahead = 0.0  # metres that are free ahead
        self.path, self.skipped = [], set()
        self.planned = -1e9
        self.spin = math.tau  # radians still to turn on the spot, to look around; negative is right
        self.back_until = -1e9
        self.free_since, self.free_at = 0.0, self.pose
        self.map_sent = -1e9
        self.given_up = False

    def reply(self, seen):
        turned = seen["odometry"]["turn"]
        left = self.spin - turned
        self.spin = left if left * self.spin > 0.0 else 0.0
        if self.own_slam:
            x, y, heading = self.pose
            way, middle = seen["odometry"]["distance"], heading + 0.5 * turned
            self.pose = [x + way * math.cos(middle), y + way * math.sin(middle), heading + turned]
        else:
            self.pose = seen["pose"]
        if seen["scan"] is not None:
            self.look(seen)
        reply = self.command(seen["time"], seen["bumped"])
        if self.own_slam:
            reply["pose"] = self.pose
            if seen["time"] - self.map_sent >= 10.0:
                reply["map"] = self.grid.message()
                self.map_sent = seen["time"]
        return reply

    def look(self, seen):
        """Takes in a scan: what is ahead, and where it is drawn."""
        ranges = seen["scan"]
        lx, ly, turn = self.laser
        cos, sin = math.cos(turn), math.sin(turn)
        points = [
            (lx + r * (cos * c - sin * s), ly + r * (sin * c + cos * s))
            for (c, s), r in zip(self.beams, ranges)
            if r is not None and r < self.max_range
        ]
        beside = [px for px, py in points if abs(py) < self.radius and px > 0.0]
        self.ahead = min(beside, default=self.max_range) - self.radius
        moved = self.drawn is None or (
            math.dist(self.pose[:2], self.drawn[:2]) > 0.2
            or abs(wrapped(self.pose[2] - self.drawn[2])) > 0.2
            or seen["time"] - self.drawn[3] > 2.0
        )
        if not moved:
            return
        if self.own_slam and self.drawn is not None:
            near = [point for point in points[::2] if abs(point[0]) + abs(point[1]) < SEEN]
            # What the wheels may be wrong by since the last scan.
            far = 0.02 + 0.1 * math.dist(self.pose[:2], self.drawn[:2])
            turned = 0.01 + 0.1 * abs(self.pose[2] - self.drawn[2])
            self.pose = list(self.grid.match(tuple(self.pose), near, far, turned))
        self.drawn = [*self.pose, seen["time"]]
        x, y, heading = self.pose
        cos, sin = math.cos(heading), math.sin(heading)
        laser = (x + cos * lx - sin * ly, y + sin * lx + cos * ly, heading + turn)
        self.grid.draw(laser, self.beams, ranges, self.max_range)
        for px, py in seen["water"]:
            self.grid.mark(x + cos * px - sin * py, y + sin * px + cos * py, 254)

    def command(self, time, bumped):
        x, y, heading = self.pose
        if bumped and time > self.back_until:
            # Scans that see nothing there soon win over a bump.
            ahead = x + self.radius * math.cos(heading), y + self.radius * math.sin(heading)
            self.grid.mark(*ahead, OCCUPIED + 4 * MISS)
            self.back_until, self.path = time + 1.0, []
        if math.dist(self.free_at[:2], (x, y)) > 0.15 or self.spin:
            self.free_since, self.free_at = time, self.pose
        elif time - self.free_since > 8.0:
            # It gets nowhere: back, and somewhere else.
            self.skip(self.path[-1:])
            self.back_until, self.free_since, self.spin = time + 2.0, time, 2.0
        if time < self.back_until:
            return {"speed": -0.2, "turn_rate": 0.0}
        if self.spin:
            return {"speed": 0.0, "turn_rate": math.copysign(self.turn_rate, self.spin)}
        if time - self.planned > 4.0 or not self.leads_on():
            self.plan(time)
            if not self.path:
                if self.given_up:
                    return {"finished": True}
                self.given_up, self.spin = True, math.tau
                self.skipped.clear()
                return {"speed": 0.0, "turn_rate": self.turn_rate}
            self.given_up = False
        return self.follow()

    def leads_on(self):
        """Whether the path is free and still leads to a frontier."""
        grid = self.grid
        return bool(self.path) and grid.is_frontier(self.path[-1]) and not any(
            grid.blocked[cell] for cell in self.path[:8]
        )

    def plan(self, time):
        self.planned = time
        start = self.grid.index(self.pose[0], self.pose[1])
        self.path = self.grid.path_to_frontier(start, self.skipped) or []
        if 0 < len(self.path) <= 2:
            # It is there and does not see it: it looks there once.
            goal = self.path[-1]
            unknown = [step for step in AROUND if self.grid.odds[goal + step] == UNKNOWN]
            x, y = self.grid.middle(goal + 3 * unknown[0])
            off = wrapped(math.atan2(y - self.pose[1], x - self.pose[0]) - self.pose[2])
            self.spin = off
            self.skip([goal])

    def skip(self, cells):
        for cell in cells:
            self.skipped.update(cell + offset for offset in self.grid.closing)

    def follow(self):
        x, y, heading = self.pose
        middle = self.grid.middle
        # What is behind is dropped: the nearest of the next cells is where it is on the path.
        near = [math.dist((x, y), middle(cell)) for cell in self.path[:6]]
        self.path = self.path[near.index(min(near)):]
        tight = self.grid.close[self.path[0]] > 0
        target = middle(self.path[min(2 if tight else 3, len(self.path) - 1)])
        off = wrapped(math.atan2(target[1] - y, target[0] - x) - heading)
        turn_rate = max(-self.turn_rate, min(self.turn_rate, 2.5 * off))
        speed = self.speed * max(0.0, 1.0 - abs(off) / 0.7)
        speed = min(speed, 0.25 if tight else self.speed, max(0.0, self.ahead - 0.08))
        return {"speed": speed, "turn_rate": turn_rate}


def main():
    own_slam = "--own-slam" in sys.argv[1:]
    hello = json.loads(sys.stdin.readline())
    name = "explorer with SLAM" if own_slam else "explorer"
    say({"protocol": hello["protocol"], "name": name, "rate": 1, "slam": own_slam})
    grid = Grid(hello["starts"][0], hello["robot"]["swing_radius"])
    robots = [Robot(hello, number, grid, own_slam) for number in range(hello["robots"])]
    for line in sys.stdin:
        seen = json.loads(line)
        if seen["type"] == "end":
            break
        say({"id": seen["id"], **robots[seen["robot"]].reply(seen)})


def say(message):
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
