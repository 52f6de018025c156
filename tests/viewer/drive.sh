#!/bin/sh
# Uses the viewer by mouse and keys on a display of its own: drive.sh PHAT BAKED FOLDER < STEPS
# STEPS, one a line: `keep N` (presses P and waits for picture N), `click X Y`, `drag X Y X Y`, `type WORD`,
# `key NAME`, `ctrl-click X Y`. The viewer must be alive at the end; its messages go to FOLDER/log.
set -eu
phat=$1 baked=$2 folder=$3

for tool in Xvfb xdotool; do
    command -v $tool >/dev/null || { echo "$tool is missing" >&2; exit 1; }
done
mkfifo "$folder/display"
Xvfb -displayfd 3 -screen 0 1280x720x24 3>"$folder/display" >/dev/null 2>&1 &
server=$!
viewer=
trap 'kill $viewer $server 2>/dev/null || true' EXIT
DISPLAY=:$(head -n 1 "$folder/display")
export DISPLAY XDG_STATE_HOME="$folder/state"

(cd "$folder" && exec "$phat" view "$baked" --size 700x400 --ui-scale 1 >log 2>&1) &
viewer=$!

# Waits for a condition, at most a minute; fails when the viewer has ended.
await() {
    tries=0
    until eval "$1"; do
        kill -0 $viewer 2>/dev/null || { echo "the viewer has ended:" >&2; cat "$folder/log" >&2; exit 1; }
        tries=$((tries + 1))
        [ $tries -lt 600 ] || { echo "waited in vain for: $1" >&2; exit 1; }
        sleep .1
    done
}
await 'window=$(xdotool search --name "PHATextures" 2>/dev/null | head -n 1) && [ -n "$window" ]'
xdotool windowfocus --sync "$window"

# Frames of software OpenGL take a while; a press and its release in one frame would not be seen. A viewer that has
# nothing to draw uses no time.
used() { cut -d ' ' -f 14,15 "/proc/$viewer/stat"; }
pause() { await 'before=$(used); sleep .3; [ "$before" = "$(used)" ]'; }
press() { xdotool mousemove "$1" "$2"; pause; xdotool mousedown 1; pause; }
release() { xdotool mouseup 1; pause; }
hit() { xdotool keydown "$1"; pause; xdotool keyup "$1"; pause; }

pause
while read -r step a b c d; do
    case $step in
        keep) hit p; await "[ -s '$folder/phat-$a.exr' ]" ;;
        click) press "$a" "$b"; release ;;
        ctrl-click) xdotool keydown ctrl; press "$a" "$b"; release; xdotool keyup ctrl; pause ;;
        drag) press "$a" "$b"; xdotool mousemove "$c" "$d"; pause; release ;;
        type) for letter in $(echo "$a" | sed 's/./& /g; s/\./period/g'); do hit "$letter"; done; hit Return ;;
        key) hit "$a" ;;
        ctrl-key) xdotool keydown ctrl; pause; hit "$a"; xdotool keyup ctrl; pause ;;
        *) echo "unknown step $step" >&2; exit 1 ;;
    esac
done
kill -0 $viewer
