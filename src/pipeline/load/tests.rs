//! Choices of parts as they are typed, and hashes of what is read.

use super::*;

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
