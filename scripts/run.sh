#!/usr/bin/env bash
# Opens shapematch on the bundled pair of parts. Where there is no display, it matches the pair on
# the command line instead. Arguments are handed on: scripts/run.sh crash.k stamped.dynain
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/setup.sh
need_rust

if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || [ "$(uname -s)" != Linux ]; then
    if [ "$(uname -s)" = Linux ]; then
        install_packages libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 \
            libegl1 libgl1-mesa-dri mesa-vulkan-drivers ||
            say "Going on; the window may not open."
    fi
    cargo build --release --locked
    if [ $# -eq 0 ]; then set -- --example; fi
    exec target/release/shapematch "$@"
fi

say "There is no display (DISPLAY and WAYLAND_DISPLAY are empty): matching on the command line."
cargo build --release --locked --no-default-features
if [ $# -eq 0 ]; then
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' EXIT
    target/release/shapematch sample "$folder" --bundled >&2
    set -- "$folder/crash.k.gz" "$folder/stamped.dynain.gz"
fi
target/release/shapematch match "$@"
