#!/usr/bin/env bash
# Everything that must hold before a change lands: format, lints, docs, tests.
# Needs no graphics card: pictures are drawn by the software Vulkan driver.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/setup.sh
need_rust
if [ "$(uname -s)" = Linux ]; then
    install_packages mesa-vulkan-drivers xvfb xdotool || say "Going on; picture tests may fail."
fi

export RUST_BACKTRACE=0 CARGO_TERM_COLOR=${CARGO_TERM_COLOR:-never}
export WGPU_BACKEND=${WGPU_BACKEND:-vulkan}
# The same random inputs every time, so that a failure is the change's. To look for new ones, run
# `PROPTEST_CASES=20000 cargo test`.
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-1997}
if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
    XDG_RUNTIME_DIR=$(mktemp -d)
    export XDG_RUNTIME_DIR
    chmod 700 "$XDG_RUNTIME_DIR"
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
fi

# step CMD…: runs one check and says how long it took.
step() {
    local begin=$SECONDS
    say "== $*"
    "$@"
    say "== $((SECONDS - begin)) s"
}
step cargo fmt --check
# Below the window first: it must build without egui and wgpu.
step cargo clippy --locked --no-default-features --all-targets -- -D warnings
step cargo clippy --locked --features ui-tests --all-targets -- -D warnings
RUSTDOCFLAGS="-D warnings" step cargo doc --locked --no-deps --features ui-tests
step cargo test --locked --features ui-tests
