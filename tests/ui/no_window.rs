//! The program where it cannot open a window.

use std::process::Command;

/// No display is one of the ways to be without a window that every machine can be put in.
#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_program_says_what_it_needs_and_fails() {
    let output = Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .arg("--example")
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .env_remove("RUST_LOG")
        .output()
        .unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8(output.stderr).unwrap();
    for words in [
        "the window could not be opened",
        "DISPLAY",
        "Graphics adapters found: ",
        "WGPU_BACKEND",
        "shapematch --help",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(!said.contains(".rs:"), "{said}");
}
