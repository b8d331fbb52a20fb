#!/usr/bin/env bash
# Drives the real window through the story of the README, with real mouse and keys on a virtual
# screen, and writes the pictures to screenshots/. SHAPEMATCH=path takes a binary that is built.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/setup.sh
install_packages xvfb xdotool scrot mesa-vulkan-drivers || exit 1
if [ -z "${SHAPEMATCH:-}" ]; then
    need_rust
    cargo build --release --locked
    SHAPEMATCH=target/release/shapematch
fi

folder=$(mktemp -d)
pids=()
cleanup() {
    for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
    rm -rf "$folder"
}
trap cleanup EXIT
# A home of its own: no settings of before, none left behind.
export HOME=$folder XDG_CONFIG_HOME=$folder/config XDG_DATA_HOME=$folder/data
export XDG_RUNTIME_DIR=$folder/run WGPU_BACKEND=${WGPU_BACKEND:-vulkan} RUST_BACKTRACE=0
# The window tells when no work runs and its pictures are exact.
export RUST_LOG=warn,shapematch=debug
mkdir -m 700 "$XDG_RUNTIME_DIR"

# The server picks a free display and tells its number. It stays as it is between two windows.
Xvfb -noreset -screen 0 1400x900x24 -nolisten tcp -displayfd 3 3>"$folder/display" >/dev/null 2>&1 &
pids+=($!)
until [ -s "$folder/display" ]; do sleep 0.1; done
DISPLAY=:$(cat "$folder/display")
export DISPLAY

# open_window WIDTH HEIGHT ARGS…: starts the program anew.
program=
open_window() {
    local width=$1 height=$2 window
    shift 2
    if [ -n "$program" ]; then
        kill "$program" 2>/dev/null || true
        wait "$program" 2>/dev/null || true
    fi
    "$SHAPEMATCH" "$@" >"$folder/log" 2>&1 &
    program=$!
    pids+=("$program")
    window=$(timeout 60 xdotool search --sync --onlyvisible --pid "$program" | tail -n 1)
    xdotool windowmove "$window" 0 0 windowsize "$window" "$width" "$height" windowfocus "$window"
}
# prefer JSON: preferences of the windows to come.
prefer() {
    mkdir -p "$XDG_CONFIG_HOME/shapematch"
    printf '{"settings":%s}' "$1" >"$XDG_CONFIG_HOME/shapematch/settings.json"
}

shot() { scrot -o "$1"; }
is_at_rest() { [ "$(grep -ao 'at rest$\|at work$' "$folder/log" | tail -n 1)" = "at rest" ]; }
# settle: waits until the work is done, the pictures are exact, and nothing moves.
settle() {
    local end=$((SECONDS + 600))
    while [ "$SECONDS" -lt "$end" ]; do
        if is_at_rest; then
            shot "$folder/a.png"
            sleep 0.7
            shot "$folder/b.png"
            is_at_rest && cmp -s "$folder/a.png" "$folder/b.png" && return 0
        fi
        sleep 0.2
    done
    say "The window does not come to rest."
    exit 1
}
# await_rest: the same after work was asked for, which the window has to take up first.
await_rest() { sleep 2; settle; }
keep() { settle; cp "$folder/b.png" "screenshots/$1.png"; say "screenshots/$1.png"; }
click() { xdotool mousemove "$1" "$2"; sleep 0.2; xdotool click 1; sleep 0.3; }
press() { xdotool key "$@"; sleep 0.3; }
# drag X Y DX DY: with the left button, in steps as a hand does.
drag() {
    local i
    xdotool mousemove "$1" "$2"
    sleep 0.3
    xdotool mousedown 1
    for i in $(seq 10); do xdotool mousemove_relative --sync -- $(($3 / 10)) $(($4 / 10)); sleep 0.03; done
    xdotool mouseup 1
    sleep 0.5
}
# matched: reads the files and matches.
matched() {
    await_rest
    press ctrl+Return
    await_rest
}
# Where nothing reacts to the pointer.
rest() { xdotool mousemove 700 12; }
# choose WORDS: a command by its name in the search over all commands, as Ctrl+K opens it.
choose() {
    press ctrl+k
    sleep 0.5
    xdotool type --delay 40 -- "$1"
    sleep 0.5
    press Return
    settle
}

mkdir -p screenshots
open_window 1400 900
rest
keep start
choose "open the example pair"
drag 560 420 60 -40
rest
keep loaded
click 139 353 # Reduce
settle
press e
rest
keep reduced
press m
rest
keep moved-over
press a
settle
press alt+Return
settle
# The program stands still for the moment of the picture: a match is over in a tenth of a second.
press ctrl+Return
kill -STOP "$program"
sleep 0.3
shot screenshots/live.png
kill -CONT "$program"
say "screenshots/live.png"
await_rest
rest
keep matched-reduced
press e
press shift+d
rest
keep matched-detailed
press s
rest
keep section
press s

# More room for tables and curves.
prefer '{"theme":"Dark","is_mouse_asked":true,"pane_sizes":[null,385]}'
open_window 1400 900 --example
matched
press m
settle
click 492 530 # Starts
rest
keep starts
click 653 530 # Sweep
settle
click 400 558 # Run the sweep
await_rest
rest
keep sweep

# The forming results on the crash part.
prefer '{"theme":"Dark","is_mouse_asked":true}'
open_window 1400 900 --example
matched
press ctrl+m
await_rest
press shift+c
click 560 300 # an element, which is probed
rest
keep mapped

# The other pose of a part that is nearly symmetric.
"$SHAPEMATCH" -q sample --part bracket --variant missing-flanges "$folder/bracket" >/dev/null
open_window 1400 900 "$folder/bracket/crash.k" "$folder/bracket/stamped.dynain"
matched
press m
settle
press v
rest
keep alternative

# The light theme, and a small screen at 200 %.
prefer '{"theme":"Light","is_mouse_asked":true}'
open_window 1400 900 --example
matched
press m
settle
press shift+d
rest
keep light
prefer '{"theme":"Dark","is_mouse_asked":true,"ui_scale":2.0}'
open_window 1280 720 --example
matched
press m
# Its top line is full there; the strip of the folded sections is not.
xdotool mousemove 40 500
settle
scrot -o -a 0,0,1280,720 screenshots/large-text.png
say "screenshots/large-text.png"

# A deck of a million triangles beside one of half as many.
# wave FILE COLUMNS ROWS PITCH: a wavy sheet of quads.
wave() {
    awk -v w="$2" -v h="$3" -v d="$4" 'BEGIN {
        print "*KEYWORD\n*PART\nwavy sheet\n         1         1         1\n*SECTION_SHELL\n         1         2"
        print "       1.0       1.0       1.0       1.0\n*NODE"
        for (j = 0; j <= h; j++) for (i = 0; i <= w; i++) {
            x = i * d; y = j * d
            z = 40 * sin(x / 170) * cos(y / 130) + x * x / 9000 + 12 * sin(x / 41 + y / 67)
            printf "%8d%16.6f%16.6f%16.6f\n", j * (w + 1) + i + 1, x, y, z
        }
        print "*ELEMENT_SHELL"
        for (j = 0; j < h; j++) for (i = 0; i < w; i++) {
            a = j * (w + 1) + i + 1
            printf "%8d%8d%8d%8d%8d%8d\n", ++n, 1, a, a + 1, a + w + 2, a + w + 1
        }
        print "*END"
    }' >"$1"
}
wave "$folder/large_crash.k" 1000 500 2
wave "$folder/large_stamped.k" 710 355 2.816
prefer '{"theme":"Dark","is_mouse_asked":true}'
open_window 1400 900 "$folder/large_crash.k" "$folder/large_stamped.k"
await_rest
press ctrl+Return
await_rest
press m
await_rest
rest
keep large
