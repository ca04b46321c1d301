#!/usr/bin/env python3
"""Drives on while nothing is ahead and turns where something is: the least that a driver has to do."""

import json
import sys


def say(message):
    print(json.dumps(message), flush=True)


hello = json.loads(sys.stdin.readline())
say({"protocol": hello["protocol"], "name": "minimal"})
ahead = 0.0
for line in sys.stdin:
    seen = json.loads(line)
    if seen["type"] == "end":
        break
    if seen["scan"]:
        middle = [r for r in seen["scan"][60:121] if r is not None]
        ahead = min(middle, default=0.0)
    free = ahead > 0.8 and not seen["bumped"]
    say({"speed": 0.4 if free else 0.0, "turn_rate": 0.0 if free else 0.8})
