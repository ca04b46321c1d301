#!/usr/bin/env bash
# Walks through a world in the window `walk` with keys and mouse under Xvfb, on any Vulkan driver: pictures of both
# views go to the folder of the first argument.
#
# Needs what teleop.sh needs. CARGO_FLAGS may hold `--release`.
set -euo pipefail
cd "$(dirname "$0")/.."

pictures=${1:-out/walk_pictures}
scratch=$(mktemp -d)
mkdir -p "$pictures"
started=()
finish() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  rm -rf "$scratch"
}
trap finish EXIT

fail() { echo "walk: $*" >&2; exit 1; }

# shellcheck disable=SC2086  # each word is an argument
cargo build ${CARGO_FLAGS:-} --features window --example walk
case " ${CARGO_FLAGS:-} " in *" --release "*) built=release ;; *) built=debug ;; esac
program=${CARGO_TARGET_DIR:-target}/$built/examples/walk
export XDG_RUNTIME_DIR=$scratch

# Mistakes are said before a window opens.
for wrong in "nowhere" "indoor --set width=-3" "indoor --set nothing=1" "no.json"; do
  # shellcheck disable=SC2086  # each word is an argument
  if "$program" $wrong >"$scratch/said" 2>&1; then fail "$wrong is taken"; fi
  grep -q '^error: ' "$scratch/said" || fail "$wrong: $(cat "$scratch/said")"
done

Xvfb :95 -screen 0 640x360x24 -nolisten tcp >"$scratch/xvfb" 2>&1 &
started+=("$!")
export DISPLAY=:95
sleep 2

"$program" indoor --seed 3 --set width=8 --set height=8 --set doors=0.5 --set people=4 >"$scratch/said" 2>&1 &
walk=$!
started+=("$walk")
for _ in $(seq 120); do
  window=$(xdotool search --onlyvisible --name '^envgen: walk$' 2>/dev/null | head -n 1) && [ -n "$window" ] && break
  kill -0 "$walk" 2>/dev/null || { cat "$scratch/said" >&2; fail "the program has ended"; }
  sleep 0.5
done
[ -n "${window:-}" ] || fail "no window after a minute"
xdotool windowmove "$window" 0 0 windowsize --sync "$window" 640 360
xdotool windowfocus --sync "$window"
sleep 4

# A picture that shows something, and something else than the picture before.
before=""
picture() {
  import -window root "$pictures/$1.png"
  [ "$(identify -format '%k' "$pictures/$1.png")" -gt 20 ] || fail "$1.png shows nothing"
  if [ -n "$before" ]; then
    differs=$(compare -metric AE -fuzz 5% "$before" "$pictures/$1.png" null: 2>&1 || true)
    awk -v pixels="$differs" 'BEGIN { exit !(pixels > 2000) }' || fail "$1.png is as $before: $differs pixels"
  fi
  before=$pictures/$1.png
}

hold() { xdotool keydown "$1"; sleep "$2"; xdotool keyup "$1"; }

picture eyes
hold w 3
picture walked
hold Left 1
picture turned
xdotool key v
sleep 1
picture behind
xdotool mousemove 320 180 click 1
sleep 1
xdotool mousemove_relative 150 0
sleep 1
picture mouse
xdotool key Escape
sleep 1
kill -0 "$walk" 2>/dev/null || { cat "$scratch/said" >&2; fail "the program has ended"; }
echo "walk: pictures in $pictures"
