//! Hands the source revision to the release build, which states it in every result.
//!
//! A debug build states that it is one: it would have to be compiled anew after every commit.

use std::path::Path;
use std::process::Command;

/// Where git keeps what the revision is read from, as far as it is there.
const SOURCES: [&str; 3] = [".git/HEAD", ".git/refs/heads", ".git/packed-refs"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let revision = if is_release {
        // A path that is not there would count as changed at every build.
        for source in SOURCES.iter().filter(|source| Path::new(source).exists()) {
            println!("cargo::rerun-if-changed={source}");
        }
        revision()
    } else {
        "debug build".to_owned()
    };
    println!("cargo::rustc-env=SHAPEMATCH_REVISION={revision}");
}

/// Empty in a source archive, which has no history; the version number alone then names the build.
fn revision() -> String {
    let git = Command::new("git")
        .args(["rev-parse", "--short=10", "HEAD"])
        .output();
    match git {
        Ok(output) if output.status.success() => {
            String::from_utf8_lossy(&output.stdout).trim().to_owned()
        }
        _ => String::new(),
    }
}
