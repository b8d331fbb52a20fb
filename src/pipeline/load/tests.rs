//! Choices of parts as they are typed, and hashes of what is read.

use std::io;

use super::*;
use crate::formats::{FileBytes, FileStamp};

#[test]
fn choices_are_understood_as_typed() {
    assert_eq!(parse_selection(" 12 "), Selection::Parts(vec![12]));
    assert_eq!(parse_selection("1, 2,3"), Selection::Parts(vec![1, 2, 3]));
    assert_eq!(parse_selection("set:7"), Selection::PartSet(7));
    assert_eq!(parse_selection("shell-set: 8"), Selection::ShellSet(8));
    assert_eq!(parse_selection("node-set:9"), Selection::NodeSet(9));
    assert_eq!(
        parse_selection("B pillar, inner"),
        Selection::PartTitle("B pillar, inner".into())
    );
    assert_eq!(
        parse_selection("title:12"),
        Selection::PartTitle("12".into())
    );
}

#[test]
fn choices_are_typed_as_they_are_understood() {
    let choices = [
        Selection::All,
        Selection::Sheet,
        Selection::Parts(vec![1, 22]),
        Selection::PartTitle("all".into()),
        Selection::PartTitle("set:7".into()),
        Selection::PartSet(7),
        Selection::ShellSet(8),
        Selection::NodeSet(9),
    ];
    for choice in choices {
        assert_eq!(parse_selection(&choice.typed()), choice);
    }
}

#[test]
fn the_file_and_its_includes_are_hashed() {
    let bytes: [&[u8]; 2] = [
        b"*KEYWORD\n*INCLUDE\nmesh.k\n*PART\nsheet\n1,1,1\n*END\n",
        b"*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n*ELEMENT_SHELL\n1,1,1,2,3,3\n*END\n",
    ];
    let source = formats::Memory::new()
        .with("deck.k", bytes[0])
        .with("mesh.k", bytes[1]);
    let (path, settings) = (Path::new("deck.k"), LoadSettings::default());
    let part = load_from(&source, path, &settings, &Monitor::silent()).unwrap();
    let hashes: Vec<_> = part.model.files.iter().map(|file| file.hash).collect();
    assert_eq!(hashes, bytes.map(|bytes| Some(FileHash::of(bytes))));
    assert_eq!(part.hash(), Some(FileHash::of(bytes[0])));
}

/// The disk, on which the file is written anew as soon as it was read.
struct WrittenAnew(PathBuf);

impl FileSource for WrittenAnew {
    fn open(&self, path: &Path, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
        let bytes = Disk.open(path, max_bytes, monitor)?;
        if path == self.0 {
            std::fs::write(path, [&bytes[..], b"$ longer\n"].concat())?;
        }
        Ok(bytes)
    }

    fn stream(&self, path: &Path) -> io::Result<Box<dyn io::Read + '_>> {
        Disk.stream(path)
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        Disk.find(path)
    }

    fn stamp(&self, path: &Path) -> Option<FileStamp> {
        Disk.stamp(path)
    }
}

#[test]
fn a_file_that_is_written_before_it_is_hashed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let deck = b"*KEYWORD\n*INCLUDE\nmesh.k\n*PART\nsheet\n1,1,1\n*END\n";
    let mesh = b"*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n*ELEMENT_SHELL\n1,1,1,2,3,3\n*END\n";
    std::fs::write(at("deck.k"), deck).unwrap();
    let settings = LoadSettings::default();
    for changing in ["none.k", "deck.k", "mesh.k"] {
        std::fs::write(at("mesh.k"), mesh).unwrap();
        let source = WrittenAnew(at(changing));
        let read = load_from(&source, &at("deck.k"), &settings, &Monitor::silent());
        match read {
            Ok(_) => assert_eq!(changing, "none.k"),
            Err(error) => {
                let text = error.to_string();
                assert!(text.contains(changing), "{text}");
                assert!(text.contains("changed while it was read"), "{text}");
            }
        }
    }
}
