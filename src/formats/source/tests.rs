//! Files on disk and in memory, packed and not, and what is told of those that cannot be read.

use std::io::Write as _;

use super::*;

const NO_LIMIT: u64 = u64::MAX;

fn open(path: &Path) -> io::Result<FileBytes> {
    Disk.open(path, NO_LIMIT, &Monitor::silent())
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

fn unpacked(bytes: Vec<u8>, max_bytes: u64) -> io::Result<FileBytes> {
    let source = Memory::new().with("deck.k", bytes);
    let path = Path::new("deck.k");
    Ok(open_unpacked(&source, path, max_bytes, &Monitor::silent())?.0)
}

#[test]
fn bytes_behind_gzip_data_are_passed_over_and_counted() {
    let deck = packed(b"*KEYWORD\n");
    let end = packed(b"*END\n");
    let zeros = vec![0; 70_000];
    for (after, n_after) in [(&b""[..], 0), (&zeros, 0), (b"garbage", 7)] {
        let all = [&deck[..], &end, after].concat();
        let source = Memory::new().with("deck.k", all);
        let path = Path::new("deck.k");
        let (bytes, n) = open_unpacked(&source, path, NO_LIMIT, &Monitor::silent()).unwrap();
        assert_eq!(&bytes[..], b"*KEYWORD\n*END\n");
        assert_eq!(n, n_after);
    }
}

#[test]
fn gzip_is_unpacked_by_content() {
    let bytes = unpacked(packed(b"*KEYWORD\n*END\n"), NO_LIMIT).unwrap();
    assert_eq!(&bytes[..], b"*KEYWORD\n*END\n");
    assert_eq!(unpacked(vec![0x1f], NO_LIMIT).unwrap()[..], [0x1f]);
    let mut cut = packed(&[b'x'; 5000]);
    cut.truncate(20);
    let error = unpacked(cut, NO_LIMIT).unwrap_err();
    assert!(error.to_string().contains("cut off"), "{error}");
}

#[test]
fn limits_are_told_as_they_were_asked_for() {
    let asked = [4.0, 0.5, 1e-6, 0.1];
    let told = asked.map(|gib| in_gib((gib * f64::from(1u32 << 30)).round() as u64));
    assert_eq!(told, ["4 GiB", "0.5 GiB", "0.000001 GiB", "0.1 GiB"]);
}

#[test]
fn a_gzip_bomb_stops_at_the_limit() {
    let bomb = packed(&vec![b' '; 50 << 20]);
    assert!(bomb.len() < 1 << 20);
    let error = unpacked(bomb, 1 << 20).unwrap_err();
    assert!(error.to_string().contains("--read-limit"), "{error}");
    let error = unpacked(vec![b' '; 100], 99).unwrap_err();
    assert!(error.to_string().contains("limit"), "{error}");
}

#[test]
fn names_are_found_whatever_their_case() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Mesh.K");
    std::fs::write(&path, b"*END").unwrap();
    assert_eq!(Disk.find(&folder.path().join("mesh.k")), Some(path.clone()));
    assert_eq!(Disk.find(&folder.path().join("other.k")), None);
    assert_eq!(&open(&path).unwrap()[..], b"*END");
    let memory = Memory::new().with("a/./B.k", b"x".to_vec());
    assert_eq!(memory.find(Path::new("a/c/../b.K")), Some("a/B.k".into()));
}

#[test]
fn an_empty_file_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("empty.k");
    std::fs::write(&path, b"").unwrap();
    assert!(open(&path).unwrap().is_empty());
    assert!(open(folder.path()).is_err());
}

#[test]
fn a_large_file_is_read_whole_and_a_cancel_request_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large");
    let bytes: Vec<u8> = (0..5 * PIECE + 77).map(|i| (i % 251) as u8).collect();
    std::fs::write(&path, &bytes).unwrap();
    assert!(open(&path).unwrap()[..] == bytes);
    let error = Disk.open(&path, 1000, &Monitor::silent()).unwrap_err();
    assert!(error.to_string().contains("limit"), "{error}");
    let monitor = Monitor::silent();
    monitor.request_cancel();
    let ended = Disk.open(&path, NO_LIMIT, &monitor).unwrap_err();
    assert_eq!(ended.kind(), io::ErrorKind::Interrupted);
}

#[test]
fn files_and_their_folders_are_found_in_any_case() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("Mesh/Floor")).unwrap();
    std::fs::write(at("Mesh/Floor/Part.K"), b"").unwrap();
    for name in [
        "Mesh/Floor/Part.K",
        "Mesh/Floor/part.k",
        "mesh/FLOOR/part.k",
    ] {
        let found = Disk.find(&at(name)).expect(name);
        assert!(same_file::is_same_file(found, at("Mesh/Floor/Part.K")).unwrap());
    }
    assert_eq!(Disk.find(&at("mesh/Floor")), None);
    assert_eq!(Disk.find(&at("other/Part.K")), None);
}

#[test]
fn a_file_that_is_cut_while_it_is_read_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut");
    std::fs::write(&path, vec![b'x'; 10_000]).unwrap();
    let file = File::open(&path).unwrap();
    let n_bytes = file.metadata().unwrap().len();
    // What happens between the question for the length and the reading.
    std::fs::write(&path, b"short").unwrap();
    let error = read_whole(&file, n_bytes, NO_LIMIT, &Monitor::silent()).unwrap_err();
    assert!(error.to_string().contains("changed"), "{error}");
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_at_once() {
    for path in ["/dev/zero", "/dev/null"] {
        let error = open(Path::new(path)).unwrap_err();
        assert!(error.to_string().contains("device"), "{error}");
    }
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.k");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    if made.is_ok_and(|status| status.success()) {
        let error = open(&pipe).unwrap_err();
        assert!(error.to_string().contains("pipe"), "{error}");
    }
}
