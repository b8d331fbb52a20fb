# Sourced by run.sh and test.sh: finds out what this machine lacks and installs it where it may.
# shellcheck shell=bash

say() { printf '%s\n' "$*" >&2; }

# as_root CMD…: runs a command as root, or fails without asking for a password in a script.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null 2>&1 && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
        sudo "$@"
    else
        return 1
    fi
}

# install_packages NAME…: installs Debian packages that are missing; elsewhere only names them.
# Returns 1 if something is still missing, so that the caller decides whether it can go on.
install_packages() {
    local missing=() name
    if ! command -v dpkg-query >/dev/null 2>&1; then
        say "This system has no apt; please see that it has what these Debian packages hold: $*"
        return 1
    fi
    for name in "$@"; do
        dpkg-query -W -f '${db:Status-Abbrev}' "$name" 2>/dev/null | grep -q '^ii' || missing+=("$name")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    say "Installing: ${missing[*]}"
    if as_root apt-get update -qq >&2 &&
        as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2; then
        return 0
    fi
    say "Could not install them; please run: sudo apt-get install ${missing[*]}"
    return 1
}

# need_rust: a C linker and the Rust toolchain that rust-toolchain.toml names.
need_rust() {
    command -v cc >/dev/null 2>&1 || install_packages gcc libc6-dev || exit 1
    # A fresh rustup puts cargo where only a new shell would look.
    [ -d "$HOME/.cargo/bin" ] && PATH="$HOME/.cargo/bin:$PATH"
    if ! command -v cargo >/dev/null 2>&1; then
        if apt-cache show rustup >/dev/null 2>&1; then
            install_packages rustup || exit 1
        else
            say "Rust is not installed. Get rustup as https://www.rust-lang.org/tools/install says, then run this again."
            exit 1
        fi
    fi
    if ! cargo --version >/dev/null 2>&1; then
        say "The Rust toolchain of rust-toolchain.toml does not start; 'rustup toolchain install' in this folder fetches it."
        exit 1
    fi
}
