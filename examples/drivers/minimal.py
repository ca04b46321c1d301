#!/usr/bin/env python3
"""Drives on while nothing is ahead and turns where something is: the least that a driver has to do."""

import json
import math
import sys


def say(message):
    print(json.dumps(message), flush=True)


hello = json.loads(sys.stdin.readline())
say({"protocol": hello["protocol"], "name": "minimal"})
laser = hello["laser"]
first = laser["pose"][2] + laser["first_angle"]
angles = [math.remainder(first + laser["angle_step"] * i, math.tau) for i in range(laser["beams"])]
is_ahead = [abs(angle) < 0.53 for angle in angles]
ahead = 0.0
for line in sys.stdin:
    seen = json.loads(line)
    if seen["type"] == "end":
        break
    if seen["scan"]:
        middle = [r for r, use in zip(seen["scan"], is_ahead) if use and r is not None]
        ahead = min(middle, default=0.0)
    free = ahead > 0.8 and not seen["bumped"]
    say({"speed": 0.4 if free else 0.0, "turn_rate": 0.0 if free else 0.8})
