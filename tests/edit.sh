#!/usr/bin/env bash
# Drives the window `edit` with mouse and keys under Xvfb, on any Vulkan driver: pictures of every state go to the
# folder of the first argument, and what was saved is checked.
#
# Needs what windows.sh needs.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=tests/windows.sh
source tests/windows.sh

build --example edit --example teleop --bin envgen
cd "$scratch"

# Mistakes are reported without a window: refused TEXT ARGUMENTS..
refused() {
  local text=$1
  shift
  if timeout 20 "$programs/examples/edit" "$@" >said 2>&1; then fail "$*: not refused"; fi
  grep -qF -- "$text" said || { cat said >&2; fail "$*: not refused with '$text'"; }
}
echo 'World(schema: 1' >broken.ron
echo '<world depth="2"/>' >broken.xml
refused 'nonsense: no such file' nonsense
refused "missing.ron: No such file" missing.ron
refused "broken.ron: not the RON of a world" broken.ron
refused "broken.xml: \`world\` 1: \`width\`" broken.xml
touch notes.md
refused 'notes.md: unknown file ending' notes.md
refused '--set width=-3' indoor --set width=-3
refused '--set wdth=3' indoor --set wdth=3
refused '--rooms nowhere' indoor --rooms nowhere
VK_DRIVER_FILES=/nowhere VK_ICD_FILENAMES=/nowhere refused 'no Vulkan' indoor
DISPLAY='' refused 'no display' indoor
DISPLAY=:94 refused 'no display: `DISPLAY` is :94' indoor

display 93 1280x720

open() { open_window 'envgen: edit' 1280x720 "$programs/examples/edit" "$@"; sleep 2; }

ended() {
  for _ in $(seq 40); do kill -0 "$program" 2>/dev/null || return 0; sleep 0.25; done
  fail "the program continues"
}

at() { xdotool mousemove "$1" "$2"; sleep 0.15; }
click() { at "$1" "$2"; xdotool click 1; sleep 0.4; }
press() { for key in "$@"; do xdotool key "$key"; sleep 0.3; done; }

# Drags with the left button: drag X Y X Y
drag() {
  at "$1" "$2"
  xdotool mousedown 1
  for part in 1 2 3 4; do at $(($1 + ($3 - $1) * part / 4)) $(($2 + ($4 - $2) * part / 4)); done
  [ -z "${5:-}" ] || picture "$5"
  xdotool mouseup 1
  sleep 0.4
}

# A point in a cell of the plan: cell COLUMN ROW prints x and y of its middle in the window.
cell() { echo "$((348 + 40 * $1)) $((48 + 40 * $2))"; }

# Where a point of the plan is in the tilted view: tilted X Y
tilted() { echo "$1 $((348 + ($2 - 348) * 8 / 10))"; }

# Waits for a file.
written() { for _ in $(seq 12); do [ -s "$1" ] && return 0; sleep 0.25; done; return 1; }

# Types the name of the file to save to: name FILE
name() {
  click 100 61
  xdotool type --delay 12 "$1"
  sleep 0.3
  press Return
}

# Saves to a file, once more where the window was too slow for the keys: save FILE
save() {
  for _ in 1 2 3; do
    name "$1"
    written "$1" && break
  done
  [ -s "$1" ] || { picture failed; fail "$1 is not written"; }
  click 1150 600
}

checked() { "$programs/envgen" check "$1" >check || { cat check >&2; fail "$1 does not hold"; }; }
# The number of parts of a list in a saved world, one per line: parts FILE.ron LIST
parts() { awk -v list="$2:" '$1 == list && $2 == "[" { on = 1; next } /^  \],/ { on = 0 } on { n++ } END { print n + 0 }' "$1"; }
same() { [ "$1" = "$2" ] || fail "$3: $1, not $2"; }
# A saved world without its provenance, which lists the edits.
geometry() { sed '/^  provenance: (/,/^  ),/d' "$1"; }

# A plan: a room is added, moved and turned.
open indoor --seed 3 --out first.ron
picture plan
press ctrl+s
written first.ron || fail "Ctrl+S does not save"
checked first.ron
rooms=$(parts first.ron rooms)
press 2
click 100 215
# shellcheck disable=SC2046  # two words
{
  at $(cell 4 2)
  picture room
  click $(cell 4 2)
  at $(cell 3 6)
  sleep 0.3
  at $(cell 4 2)
  picture refused
  press 1
  drag $(cell 4 2) $(cell 4 5) moving
}
save moved.ron
same "$(parts moved.ron rooms)" $((rooms + 1)) "rooms after one was added"
grep -q 'edited: *true' moved.ron || fail "an edited world does not say so"
# A promise that an edit has broken is not saved.
checked moved.ron
! grep -q every_place_reachable moved.ron || fail "a room without doorways can be reached"
picture unreached
# With a doorway it can be reached.
press 4
# The wall to the left of column 4 in row 5.
click 488 248
press 1
save open.ron
grep -q every_place_reachable open.ron || fail "a room with a doorway cannot be reached"
checked open.ron
# The selected doorway is removed, which is undone and done again.
click 488 248
press Delete
sleep 1
picture closed
press ctrl+z
save again.ron
cmp open.ron again.ron || fail "undo leads to another world"
press ctrl+shift+z
save closed.ron
cmp <(geometry moved.ron) <(geometry closed.ron) || fail "redo leads to another world"
press ctrl+z
# A room of 2 by 1 cells is turned in place.
press 2
click 100 310
click 468 148
press 1
click 468 148
press r
sleep 0.7
picture turned
# An object in the room.
press 5
# shellcheck disable=SC2046  # two words
{ click $(cell 4 5); }
press r
picture object
save plan.ron
checked plan.ron
grep -q 'with its edits' check || fail "the edits of a plan are not made again"
same "$(parts plan.ron rooms)" $((rooms + 2)) "rooms after two were added"
same "$(parts plan.ron obstacles)" $(($(parts open.ron obstacles) + 1)) "obstacles after one was added"
for ending in xml svg png yaml geojson; do save "plan.$ending"; done
checked plan.xml
same "$(grep '<room ' plan.xml | grep -vc hallway)" $((rooms + 2)) "rooms in the project"
checked plan.yaml
checked plan.geojson
[ -s plan.pgm ] || fail "no image of the map"
cp plan.png "$pictures/saved.png"
# What cannot be saved is said, and leaves no file.
name plan.doc
picture wrong_ending
[ ! -e plan.doc ] || fail "a file of no format"
# A trial on the edited world.
click 1150 600
press t
for _ in $(seq 60); do xdotool search --onlyvisible --name '^envgen: drive$' >/dev/null 2>&1 && break; sleep 0.25; done
xdotool search --onlyvisible --name '^envgen: drive$' >/dev/null || fail "no trial"
trial=$(pgrep -P "$program")
tr '\0' ' ' <"/proc/$trial/cmdline" | grep -q -- ' --known --world ' || fail "a trial in an edited world counts as blind"
kill "$trial"
# Without a window manager nobody gives the keys back.
xdotool windowfocus --sync "$window"
sleep 0.5
# A change that is not saved keeps the window.
press 1
click 468 148
press Delete ctrl+q
sleep 0.5
picture question
press Escape
kill -0 "$program" || fail "the window is closed without an answer"
press ctrl+q
# Discards them; a slow driver may not show the question yet.
for _ in $(seq 10); do
  sleep 1
  click 525 396
  kill -0 "$program" 2>/dev/null || break
done
ended

# In the tilted view the same clicks lead to the same world. Drivers in software need seconds for a frame of it.
shot() { import -window root "$1.png"; }
# Waits until the window shows something else than in a picture: seen PICTURE
seen() {
  for _ in $(seq 60); do
    shot now
    cmp -s now.png "$1.png" || { sleep 3; return 0; }
    sleep 0.5
  done
  fail "the window does not change"
}
open indoor --seed 3 --out tilted.ron
press 2
click 100 215
shot before
press v
seen before
# shellcheck disable=SC2046  # two words
click $(tilted $(cell 4 2))
sleep 3
press 1
# The wall before it hides the near half of its floor.
read -r x y <<<"$(cell 4 2)"
# shellcheck disable=SC2046  # two words
{
  at $(tilted "$x" $((y - 14)))
  sleep 3
  xdotool mousedown 1
  at $(tilted "$x" $((y + 46)))
  sleep 2
  at $(tilted "$x" $((y + 106)))
}
sleep 4
picture tilted
xdotool mouseup 1
sleep 3
press ctrl+s
for _ in 1 2 3 4; do written tilted.ron && break; done
[ -s tilted.ron ] || fail "Ctrl+S does not save in the tilted view"
cmp tilted.ron moved.ron || fail "the tilted view leads to another world"
shot before
press q
seen before
picture tilted_turned
press ctrl+q
ended

# The project is edited as a plan again.
open plan.xml --out second.xml
press ctrl+s
written second.xml || fail "Ctrl+S does not save a project"
sed 's/name="second"/name="plan"/' second.xml | cmp - plan.xml || fail "the project has changed"
press ctrl+q
ended
# A project with a name of its own would lose it.
sed 's/name="plan"/name="another"/' plan.xml >named.xml
cp named.xml named.before
open named.xml
press ctrl+s
written out/edit/named.ron || fail "no out/edit/named.ron"
cmp named.xml named.before || fail "the name of a project is lost"
press ctrl+q
ended

# The parts of another world.
open forest --seed 2 --set width=20 --set height=20 --out forest.ron
press 5
click 560 300
press 1
drag 560 300 620 330
picture world
press ctrl+s
written forest.ron || fail "Ctrl+S does not save a forest"
checked forest.ron
same "$(parts forest.ron obstacles)" 1 "obstacles in the forest"
press Delete ctrl+s
sleep 1
same "$(parts forest.ron obstacles)" 0 "obstacles after it was removed"
# Files of others are replaced after a question only.
press ctrl+z
echo kept >kept.ron
name kept.ron
picture asks_to_replace
press Escape
same "$(cat kept.ron)" kept "a file that exists"
name kept.ron
sleep 0.5
click 507 375
sleep 1
same "$(parts kept.ron obstacles)" 1 "obstacles in the file that was replaced"
# A slow click is no change: nothing is asked.
at 620 330
xdotool mousedown 1
sleep 1.5
xdotool mouseup 1
picture slow_click
press ctrl+q
ended

# A fast drag adds all cells under it. A picture does not hold the change: the window stays.
open indoor --seed 3 --out hall.png
press 3
# shellcheck disable=SC2046  # two words
{
  at $(cell 3 13)
  xdotool mousedown 1
  sleep 1
  at $(cell 3 15)
}
sleep 1
xdotool mouseup 1
press ctrl+s
written hall.png || fail "Ctrl+S does not save a picture"
picture picture_saved
press ctrl+q
sleep 1
picture asks_after_picture
# Saves the picture again.
click 540 372
sleep 1
is_running
picture stays_after_picture
save hall.ron
same "$(grep -o add_hallway hall.ron | wc -l)" 3 "cells of hallway added"
# They are one step of undo.
press ctrl+z
save undone.ron
same "$(grep -o add_hallway undone.ron | wc -l)" 0 "cells of hallway after one undo"
press ctrl+q
ended

# Files of other programs are not replaced by what was read of them, and files that were saved before are not either.
cat >trees.geojson <<'END'
{ "type": "FeatureCollection", "features": [
  { "type": "Feature", "properties": {}, "geometry": { "type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]] } },
  { "type": "Feature", "properties": {}, "geometry": { "type": "Polygon", "coordinates": [[[20, 20], [19, 20], [19, 19], [20, 20]]] } },
  { "type": "Feature", "properties": { "part": "tree", "radius": 0.3 }, "geometry": { "type": "Point", "coordinates": [10, 10] } } ] }
END
echo '{ "id": "house", "verts": [[0, 0], [8, 0], [8, 6], [0, 6]], "room_category": { "Hall": [[0, 0, 8, 6]] } }' >house.json
cp trees.geojson trees.before
cp house.json house.before
for saved in trees.ron trees_2.ron house.ron; do
  case $saved in house*) open house.json ;; *) open trees.geojson ;; esac
  press ctrl+s
  written "out/edit/$saved" || fail "no out/edit/$saved"
  press ctrl+q
  ended
done
cmp trees.geojson trees.before || fail "GeoJSON of another program is replaced"
cmp house.json house.before || fail "a house is replaced"
# A world is written again. In the tilted view, the crown of its tree is what is clicked on.
"$programs/envgen" convert out/edit/trees.ron --out own.json >/dev/null
grep -q '"trees": *\[ *{' own.json || tr -d ' \n' <own.json | grep -q '"trees":\[{' || fail "no tree"
open own.json
shot before
press v
seen before
click 648 300
picture crown
press Delete ctrl+s
for _ in $(seq 12); do tr -d ' \n' <own.json | grep -q '"trees":\[{' || break; sleep 0.5; done
! tr -d ' \n' <own.json | grep -q '"trees":\[{' || fail "the tree is not selected by its crown"
press ctrl+q
ended
echo "edit: pictures in $pictures, $SECONDS s"
