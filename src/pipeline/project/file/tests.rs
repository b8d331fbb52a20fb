//! What a project file keeps.

use super::*;

#[test]
fn paths_are_seen_from_the_project() {
    let seen = |path: &str, folder: &str| {
        let seen = relative(Path::new(path), Path::new(folder));
        seen.to_string_lossy().into_owned()
    };
    assert_eq!(seen("/a/b/c.k", "/a/b"), "c.k");
    assert_eq!(seen("/a/b/c.k", "/a/d/e"), "../../b/c.k");
    assert_eq!(seen("/c.k", "/a"), "../c.k");
    assert_eq!(seen("c.k", "/a"), "c.k");
    assert_eq!(seen("data/c.k", "data"), "c.k");
}
