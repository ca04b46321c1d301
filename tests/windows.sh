# What the scripts share that drive windows under Xvfb, on any Vulkan driver. They source it in the root of the project
# with their own arguments: the first is the folder for pictures.
#
# Needs, of Debian or Ubuntu: imagemagick libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0 libxrandr2
# mesa-vulkan-drivers xdotool xvfb. CARGO_FLAGS may hold `--release`.
# shellcheck shell=bash

script=$(basename "$0" .sh)
pictures=${1:-out/${script}_pictures}
mkdir -p "$pictures"
pictures=$(realpath "$pictures")
scratch=$(mktemp -d)
export XDG_RUNTIME_DIR=$scratch
started=()
finish() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  rm -rf "$scratch"
}
trap finish EXIT

fail() { echo "$script: $*" >&2; exit 1; }

# Builds what arguments of Cargo name; `programs` is then the folder of binaries, and `programs/examples`.
build() {
  # shellcheck disable=SC2086  # each word is an argument
  cargo build ${CARGO_FLAGS:-} --features window "$@"
  case " ${CARGO_FLAGS:-} " in *" --release "*) programs=release ;; *) programs=debug ;; esac
  programs=$(realpath "${CARGO_TARGET_DIR:-target}/$programs")
}

# Starts a display: display NUMBER WIDTHxHEIGHT. `xvfb` is its process.
display() {
  Xvfb ":$1" -screen 0 "${2}x24" -nolisten tcp >"$scratch/xvfb" 2>&1 &
  xvfb=$!
  started+=("$xvfb")
  export DISPLAY=":$1"
  sleep 2
}

# Starts a program and waits for its window, as large as the display: open_window TITLE WIDTHxHEIGHT PROGRAM ARGUMENTS..
open_window() {
  local title=$1 size=$2
  shift 2
  # Bash starts what runs in the background deaf to Ctrl+C.
  env --default-signal=INT "$@" >"$scratch/said" 2>&1 &
  program=$!
  started+=("$program")
  for _ in $(seq 120); do
    window=$(xdotool search --onlyvisible --name "^$title\$" 2>/dev/null | head -n 1) && [ -n "$window" ] && break
    is_running
    sleep 0.5
  done
  [ -n "${window:-}" ] || fail "no window after a minute"
  # Without a window manager nobody else gives it its size and the keys.
  xdotool windowmove "$window" 0 0 windowsize --sync "$window" "${size%x*}" "${size#*x}"
  xdotool windowfocus --sync "$window"
}

# Fails where the program has ended.
is_running() { kill -0 "$program" 2>/dev/null || { cat "$scratch/said" >&2; fail "the program has ended"; }; }

hold() { xdotool keydown "$1"; sleep "$2"; xdotool keyup "$1"; }

# Takes a picture of the display: picture NAME. One of one colour shows nothing: a slow driver has not drawn yet.
picture() {
  for _ in $(seq 20); do
    sleep 0.5
    is_running
    import -window root "$pictures/$1.png"
    [ "$(identify -format '%k' "$pictures/$1.png")" -le 20 ] || return 0
  done
  fail "$1.png shows nothing"
}
