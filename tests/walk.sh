#!/usr/bin/env bash
# Walks through a world in the window `walk` with keys and mouse under Xvfb, on any Vulkan driver: pictures of both
# views go to the folder of the first argument.
#
# Needs what windows.sh needs.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tests/windows.sh
source tests/windows.sh

build --example walk

# Mistakes are reported before a window opens.
for wrong in "nowhere" "indoor --set width=-3" "indoor --set nothing=1" "no.json"; do
  # shellcheck disable=SC2086  # each word is an argument
  if "$programs/examples/walk" $wrong >"$scratch/said" 2>&1; then fail "$wrong is taken"; fi
  grep -q '^error: ' "$scratch/said" || fail "$wrong: $(cat "$scratch/said")"
done

# A kind is one although a folder has its name.
mkdir "$scratch/indoor"
if (cd "$scratch" && DISPLAY='' "$programs/examples/walk" indoor) >"$scratch/said" 2>&1; then fail "no display is taken"; fi
grep -q 'no display' "$scratch/said" || fail "indoor beside a folder: $(cat "$scratch/said")"

display 95 640x360
open_window 'envgen: walk .*' 640x360 "$programs/examples/walk" \
  indoor --seed 3 --set width=8 --set height=8 --set doors=0.5 --set people=4
sleep 4

# Takes a picture; whether it shows something else than the one before.
before=""
is_new() {
  picture "$1"
  [ -n "$before" ] || return 0
  differs=$(compare -metric AE -fuzz 5% "$before" "$pictures/$1.png" null: 2>&1 || true)
  awk -v pixels="$differs" 'BEGIN { exit !(pixels > 2000) }'
}

view() {
  is_new "$1" || fail "$1.png is as $before: $differs pixels"
  before=$pictures/$1.png
}

view eyes
hold w 3
view walked
hold Left 1
view turned
xdotool key v
sleep 1
view behind
# A click between two slow frames may be missed.
for _ in 1 2 3 4 5; do
  xdotool mousemove 320 180 click 1
  sleep 1
  xdotool mousemove_relative 150 0
  sleep 1
  ! is_new mouse || break
done
view mouse
xdotool key Escape
sleep 1
is_running
kill "$program"
sleep 1

# Under low ceilings, the eyes and the camera behind are below them and see no sky, which is bluer than all else. The
# walker is greener than blue.
open_window 'envgen: walk .*' 640x360 "$programs/examples/walk" \
  indoor --seed 3 --set width=8 --set height=8 --set wall_height=1.2
# The world is not drawn in the first frames.
below() {
  for _ in $(seq 20); do
    picture "$1"
    sky=$(convert "$pictures/$1.png" -fx 'b > 1.06 * r && b > g ? 1 : 0' -format '%[fx:mean]' info:)
    ! awk -v sky="$sky" 'BEGIN { exit !(sky < 0.02) }' || return 0
    sleep 1
  done
  fail "$1.png is from above the ceilings: $sky of it is sky"
}
below low_eyes
xdotool key v
sleep 2
below low_behind
echo "walk: pictures in $pictures"
