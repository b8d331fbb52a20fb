//! Files that change after they were read: told once they are at rest, and only if their content is new.

use std::path::Path;
use std::time::{Duration, SystemTime};

use shapematch::formats::FileHash;
use shapematch::formats::model::ReadFile;
use shapematch::pipeline::file_watch::FileWatch;

const PAUSE: Duration = Duration::from_millis(10);
const LONG: Duration = Duration::from_secs(60);
/// Long enough for many looks.
const QUIET: Duration = Duration::from_millis(400);

fn read(path: &Path) -> ReadFile {
    let bytes = std::fs::read(path).unwrap();
    ReadFile {
        path: path.to_owned(),
        n_bytes: bytes.len() as u64,
        hash: Some(FileHash::of(&bytes)),
        ..ReadFile::default()
    }
}

#[test]
fn a_changed_file_is_told_and_a_touched_one_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one.k", "two.k"].map(|name| folder.path().join(name));
    for path in [&one, &two] {
        std::fs::write(path, "first").unwrap();
    }
    let watch = FileWatch::start(PAUSE, || {}).unwrap();
    watch.watch(vec![read(&one), read(&two)]);
    assert_eq!(watch.wait_for_news(QUIET), None, "nothing happened");
    // Touched, and written anew with the same content.
    let file = std::fs::File::open(&one).unwrap();
    file.set_modified(SystemTime::now() + Duration::from_secs(5))
        .unwrap();
    std::fs::write(&two, "first").unwrap();
    assert_eq!(watch.wait_for_news(QUIET), None, "the content is the same");
    // Gone for a moment.
    std::fs::remove_file(&two).unwrap();
    assert_eq!(watch.wait_for_news(QUIET), None, "it may come back");
    // As long as before, so that only its content tells.
    std::fs::write(&two, "other").unwrap();
    assert_eq!(watch.wait_for_news(LONG), Some([two.clone()].into()));
    let other = read(&two);
    // Put back as it was.
    std::fs::write(&two, "first").unwrap();
    assert_eq!(watch.wait_for_news(LONG), Some([].into()));
    // Read again, then back to what was read first.
    std::fs::write(&two, "other").unwrap();
    assert_eq!(watch.wait_for_news(LONG), Some([two.clone()].into()));
    let first = ReadFile {
        hash: Some(FileHash::of(b"first")),
        ..other.clone()
    };
    watch.watch(vec![other]);
    assert_eq!(watch.wait_for_news(LONG), Some([].into()));
    watch.watch(vec![first]);
    assert_eq!(watch.wait_for_news(LONG), Some([two].into()));
    // Without files there is nothing to tell any more.
    watch.watch(Vec::new());
    assert_eq!(watch.wait_for_news(LONG), Some([].into()));
}

/// Saved and read again before the watch has looked: nothing is told.
#[test]
fn a_file_that_is_read_again_at_once_has_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.k");
    std::fs::write(&path, "first").unwrap();
    let watch = FileWatch::start(QUIET / 2, || {}).unwrap();
    watch.watch(vec![read(&path)]);
    assert_eq!(watch.wait_for_news(3 * QUIET), None, "nothing happened");
    std::fs::write(&path, "other").unwrap();
    watch.watch(vec![read(&path)]);
    assert_eq!(watch.wait_for_news(3 * QUIET), None, "it was read again");
}
