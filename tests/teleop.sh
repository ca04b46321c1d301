#!/usr/bin/env bash
# Drives the window `teleop` with keys under Xvfb, on any Vulkan driver: pictures of every panel go to the folder of
# the first argument, and the sessions that were saved are run again. In a larger window, where other things have
# other places, a session is short.
#
# Needs what windows.sh needs.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tests/windows.sh
source tests/windows.sh

build --example teleop --example mapping_trial --bin envgen

open() { open_window 'envgen: drive' "$size" "$programs/examples/teleop" "$@"; sleep 4; }

# Interrupts the program, as Ctrl+C and the window's close button do, and waits for it.
shut() {
  kill -INT "$program"
  for _ in $(seq 60); do kill -0 "$program" 2>/dev/null || return 0; sleep 0.5; done
  fail "the program is interrupted and goes on"
}

# Clicks on a point of the window as it is at 1280x720; texts grow with the window.
click() {
  xdotool mousemove "$(($1 * scale / 100))" "$(($2 * scale / 100))" click 1
  sleep 0.3
}

# The ticks of the simulation in the last row of the frame log.
ticks() { tail -n 1 "$scratch/$size.csv" | cut -d, -f4 | grep '^[0-9][0-9]*$' || echo 0; }

# Holds a key for so many ticks of 50 ms, which take longer where drawing is slow.
drive() {
  local until=$(($(ticks) + $2))
  xdotool keydown "$1"
  for _ in $(seq 240); do
    [ "$(ticks)" -lt "$until" ] || break
    is_running
    sleep 0.5
  done
  xdotool keyup "$1"
}

field() { grep -m 1 -o "\"$2\": *[0-9.]*" "$1" | grep -o '[0-9.]*$'; }

# Where the panels have what is clicked on.
seed=59 training=428 advanced=545 lines=276 form_name=74

number=90
for size in 1280x720 1920x1080; do
  number=$((number + 1))
  scale=$((${size#*x} > 800 ? ${size#*x} / 8 : 100))
  display "$number" "$size"

  # The settings: what a setting does, under the pointer; all groups; in training the world that they make.
  open --seed 3 --set doors=0.5 --set people=4 --set smoke=0.3 --out "$scratch/$size-settings" --no-camera
  picture "$size-setup"
  xdotool mousemove "$((40 * scale / 100))" "$((125 * scale / 100))"
  sleep 2
  picture "$size-help"
  click 60 "$advanced"
  sleep 2
  picture "$size-advanced"
  click 60 "$advanced"
  click 152 "$training"
  sleep 4
  picture "$size-preview"
  # Another world, and one that is not allowed.
  click 212 "$seed"
  sleep 4
  picture "$size-next"
  shut

  if [ "$size" != 1280x720 ]; then
    session=$scratch/$size-person
    open --seed 11 --set doors=0.5 --set people=3 --out "$session"
    xdotool key Return
    sleep 4
    hold w 2
    picture "$size-camera"
    xdotool key End
    sleep 3
    picture "$size-form"
    shut
    [ -s "$session/001/report.json" ] || fail "$size: the session is not kept"
    kill "$xvfb"
    continue
  fi

  # A person drives two robots by the camera and by the map, pauses, looks at the truth, ends the trial.
  session=$scratch/$size-person
  open --seed 11 --set doors=0.5 --set people=3 --out "$session" --frame-log "$scratch/$size.csv"
  xdotool key Return
  sleep 4
  drive w 80
  drive Left 20
  sleep 1
  picture "$size-camera"
  xdotool key c
  drive w 40
  sleep 2
  picture "$size-drive"
  xdotool key Tab
  drive Up 40
  xdotool key t
  sleep 3
  picture "$size-training"
  # All lines over the world.
  for x in 14 87 136 214 266; do click "$x" "$lines"; sleep 1; done
  sleep 2
  picture "$size-lines"
  # Without the training view there is none of them.
  xdotool key t
  sleep 3
  picture "$size-blind"
  xdotool key t
  sleep 1
  xdotool key p
  sleep 3
  picture "$size-paused"
  xdotool key p
  drive w 20
  xdotool key End
  sleep 3
  picture "$size-form"
  shut
  # The truth was seen.
  session=$session/001_training
  for file in log.json report.json map.png truth.png overlay.png ros_map.yaml ros_map.pgm; do
    [ -s "$session/$file" ] || fail "$size: no $file"
  done
  awk -v way="$(field "$session/report.json" distance)" 'BEGIN { exit !(way > 1) }' ||
    fail "$size: the robot has not moved"
  "$programs/examples/mapping_trial" --replay "$session/log.json" --out "$scratch/again" >/dev/null
  cmp "$session/report.json" "$scratch/again/report.json" || fail "$size: the replay is another trial"

  # What is interrupted while the robot drives loses nothing.
  session=$scratch/$size-interrupted
  open --robots 1 --seed 4 --out "$session"
  xdotool key Return
  sleep 2
  hold w 2
  shut
  session=$session/001
  "$programs/examples/mapping_trial" --replay "$session/log.json" --out "$scratch/again" >/dev/null
  cmp "$session/report.json" "$scratch/again/report.json" || fail "$size: interrupted, and another trial"

  # A world from a file stays when the seed of the noise changes, and who knows it drives for training. The pictures of
  # eight robots leave the map free. A form that lacks ratings is kept.
  "$programs/envgen" generate indoor --seed 5 --set width=8 --set height=8 --out "$scratch/given.ron" >/dev/null
  session=$scratch/$size-given
  open --world "$scratch/given.ron" --known --robots 8 --camera-rows 60 --seed 8 --out "$session"
  click 212 "$seed"
  picture "$size-given"
  xdotool key Return
  sleep 8
  picture "$size-eight"
  xdotool key End
  sleep 4
  # The form is as large as it will be after some frames with inputs.
  for y in 500 520 540; do click 180 "$y"; sleep 1; done
  click 850 "$form_name"
  sleep 1
  xdotool type Ada
  sleep 2
  picture "$size-begun"
  shut
  session=$session/001_training
  [ -s "$session/report.json" ] || fail "$size: a trial in a known world counts as blind"
  grep -q '"seed": 9' "$session/report.json" || fail "$size: the noise has another seed"
  grep -q '"name": "Ada"' "$session/feedback_draft.json" || fail "$size: an incomplete form is lost"

  # A program drives, and another one is compared with it.
  open --robots 1 --policy nearest --time-limit 12 --out "$scratch/$size-program"
  for _ in $(seq 120); do [ -s "$scratch/$size-program/001/report.json" ] && break; sleep 0.5; done
  sleep 2
  picture "$size-scores"
  click 143 100
  sleep 4
  picture "$size-compared"
  # Another trial, in the same world.
  click 45 42
  sleep 1
  xdotool key Return
  sleep 3
  picture "$size-again"
  shut
  [ -s "$scratch/$size-program/002/report.json" ] || fail "$size: the second trial is not kept"

  # The simulation kept its step: a tick per 50 ms of the frames, of which Bevy lets at most 250 ms pass, so that
  # slow drawing slows the world down and never skips. 100 ms without a tick are a pause.
  awk -F, -v size="$size" '
    NR > 1 {
      frames++; sum += $3; if ($3 > most) most = $3
      since += $3; due += ($3 < 250 ? $3 : 250) / 50
      if ($4 > last) {
        if (last > 0 && since - $3 < 100) { ticks += $4 - last; expected += due }
        last = $4; since = 0; due = 0
      }
    }
    END {
      kept = expected > 0 ? ticks / expected : 0
      printf "%s: %d frames of %.1f ms, at most %.0f ms; %d ticks, %.3f of those due\n", size, frames, sum / frames, most, ticks, kept
      exit !(ticks > 60 && kept > 0.95 && kept < 1.05)
    }' "$scratch/$size.csv" || fail "$size: the simulation did not keep its step"
  kill "$xvfb"
done
echo "teleop: pictures in $pictures"
