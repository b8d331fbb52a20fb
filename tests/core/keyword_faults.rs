//! Decks with faults: each is named once, with its place and what to do, and costs neither time
//! nor memory.

use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;
use shapematch::formats::keyword::write::{WriteOptions, write};
use shapematch::formats::{
    self, Diagnostic, DiagnosticKind, FormatError, MAX_LENGTH, Memory, Model, ReadOptions,
    Selection, Severity,
};
use shapematch::monitor::Monitor;

use super::keyword::read_text;

const NODES: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n";
const SHELL: &str = "*ELEMENT_SHELL\n1,1,1,2,3,4\n";
const PART: &str = "*PART\nsheet\n1,1\n";

fn read_files(files: &Memory) -> Model {
    let options = ReadOptions::default();
    formats::read_from(files, Path::new("main.k"), &options, &Monitor::silent()).unwrap()
}

fn all(model: &Model) -> Vec<String> {
    model.diagnostics.iter().map(ToString::to_string).collect()
}

#[track_caller]
fn only(model: &Model) -> Diagnostic {
    assert_eq!(model.diagnostics.iter().count(), 1, "{:?}", all(model));
    model.diagnostics.iter().next().unwrap().clone()
}

#[track_caller]
fn line(diagnostic: &Diagnostic) -> u64 {
    let position = diagnostic.position.as_ref();
    position.expect("the line is told").line
}

#[test]
fn an_encrypted_block_without_its_end_is_an_error() {
    let begin = "-----BEGIN PGP MESSAGE-----\nabc\n";
    let cut = read_text(format!("{NODES}{PART}{begin}{SHELL}*END\n"));
    let mut found = cut.diagnostics.iter();
    let error = found.find(|d| d.kind == DiagnosticKind::EncryptedNoEnd);
    let error = error.expect("the end of the block is missing");
    assert_eq!((line(error), error.severity()), (9, Severity::Error));
    assert_eq!(cut.diagnostics.n_geometry_errors(), 1);
    let whole = format!("{NODES}{PART}{begin}-----END PGP MESSAGE-----\n{SHELL}*END\n");
    assert_eq!(only(&read_text(whole)).kind, DiagnosticKind::Encrypted);
}

#[test]
fn text_that_looks_like_a_keyword_is_no_fault() {
    for text in [
        "*COMMENT\nreplaced:\n  *INCLUDE of before\n",
        "*TITLE\n *NODE of a door\n",
    ] {
        let model = read_text(format!("{text}{NODES}{PART}{SHELL}*END\n"));
        assert_eq!(all(&model), Vec::<String>::new(), "{text:?}");
    }
}

#[test]
fn the_width_of_fields_is_found_behind_other_options() {
    let wide = |values: [&str; 4]| values.map(|value| format!("{value:>20}")).concat() + "\n";
    let mut deck = String::from("*KEYWORD JOBID=LONGRUN_I10 LONG=Y\n*NODE\n");
    for (id, x, y) in [("1", "0.", "0."), ("2", "1.", "0."), ("3", "1.", "1.")] {
        deck += &wide([id, x, y, "0."]);
    }
    let model = read_text(deck + "*ELEMENT_SHELL\n1,1,1,2,3,3\n*END\n");
    assert_eq!((model.nodes.len(), model.shells.len()), (3, 1));
}

#[test]
fn line_ends_that_were_converted_twice_are_line_ends() {
    let deck = format!("{NODES}{PART}{SHELL}*END\n").replace('\n', "\r\r\n");
    let model = read_text(deck);
    assert_eq!(all(&model), Vec::<String>::new());
    assert_eq!((model.nodes.len(), model.shells.len()), (4, 1));
}

#[test]
fn keywords_behind_the_end_are_told() {
    let of = |behind: &str| read_text(format!("{NODES}{PART}{SHELL}*END\n{behind}"));
    let model = of("\n*SECTION_SHELL\n1\n1,1,1,1\n*END\n*TITLE\nlost\n");
    let finding = only(&model);
    assert_eq!(finding.kind, DiagnosticKind::BehindEnd);
    assert_eq!(line(&finding), 11);
    let told = finding.message;
    assert!(
        told.contains("the 2 keywords behind it") && told.contains("*SECTION_SHELL in line 13"),
        "{told}"
    );
    for behind in ["", "\n\n", "$ the end\n", "*END\n", "text\n"] {
        assert_eq!(all(&of(behind)), Vec::<String>::new(), "{behind:?}");
    }
}

#[test]
fn errors_that_concern_where_things_lie_are_told_from_others() {
    let of = |cards: &str| {
        let model = read_text(format!("{NODES}{PART}{SHELL}{cards}"));
        let found = &model.diagnostics;
        let is_error = |d: &&Diagnostic| d.severity() == Severity::Error;
        let n_errors = found.iter().filter(is_error).count() as u64;
        (n_errors, found.n_geometry_errors())
    };
    for cards in [
        "*ELEMENT_SHELL\n2,1,1,2,3,9\n",
        "*ELEMENT_SHELL\nx,1,1,2,3,4\n",
        "*NODE_TRANSFORM\nx,3\n",
        "*SET_NODE_LIST\n3\n1,2,3,4\n*NODE_TRANSFORM\n1,3\n",
        "*DEFINE_TRANSFORMATION\n1\n*NODE_TRANSFORM\n1,3\n",
        "*DEFINE_TRANSFORMATION\n1\nROTATE,x\n",
    ] {
        assert_eq!(of(cards), (1, 1), "{cards}");
    }
    for cards in [
        "*SECTION_SHELL\nx,2\n1.0\n",
        "*PART\nother\n-2,1\n",
        "*INITIAL_STRESS_SHELL\n1,1,1\n0.,x,1.,1.,1.,1.,1.,1.\n",
        "*NODE_THICKNESS\nx,1.0\n",
        "*NODE_THICKNESS\n1,-1.0\n",
        "*ELEMENT_SHELL_THICKNESS\n2,1,1,2,3,4\nx,1.,1.,1.\n",
        "*INCLUDE\nnowhere.k\n",
    ] {
        assert_eq!(of(cards), (1, 0), "{cards}");
    }
}

#[test]
fn ids_that_come_again_with_another_content_are_named_with_both_places() {
    let deck = format!("{NODES}{PART}{SHELL}");
    let base = deck.lines().count() as u64;
    for (cards, again, kind, n_errors) in [
        (
            "*DEFINE_TRANSFORMATION\n5\nTRANSL,1.\n",
            "TRANSL,2.",
            DiagnosticKind::BadTransformation,
            1,
        ),
        (
            "*SECTION_SHELL\n1,2\n1.5\n",
            "2.5",
            DiagnosticKind::DuplicateSection,
            0,
        ),
        (
            "*SET_SHELL_LIST\n7\n1\n",
            "1,2",
            DiagnosticKind::DuplicateSet,
            0,
        ),
    ] {
        let same = read_text(format!("{deck}{cards}{cards}"));
        assert!(same.diagnostics.is_empty(), "{:?}", all(&same));
        let line_of_content = cards.lines().last().unwrap();
        let other = cards.replace(line_of_content, again);
        let model = read_text(format!("{deck}{cards}{other}"));
        let found = only(&model);
        assert_eq!(
            (found.kind, model.diagnostics.n_geometry_errors()),
            (kind, n_errors)
        );
        assert!(line(&found) > base + 3, "{found}");
        let first = [base + 1, base + 2].map(|line| format!("at main.k:{line}:1)"));
        assert!(
            first.iter().any(|first| found.message.contains(first)),
            "{found}"
        );
    }
    // The first transformation and the first section count, in whatever order they are used.
    let include = "*INCLUDE_TRANSFORM\npart.k\n\n\n\n5\n";
    let moves = |x: f64| format!("*DEFINE_TRANSFORMATION\n5\nTRANSL,{x}\n");
    let main = format!(
        "*SECTION_SHELL\n1,2\n1.5\n{}{include}{}",
        moves(1.0),
        moves(2.0)
    );
    let part = deck + "*SECTION_SHELL\n1,2\n2.5\n";
    let model = read_files(&Memory::new().with("main.k", main).with("part.k", part));
    assert_eq!(model.nodes.position_of(1).unwrap().x, 1.0);
    assert_eq!(model.shell_thickness(0), Some([1.5; 4]));
}

#[test]
fn a_negative_thickness_is_named_and_not_taken() {
    for (cards, at) in [
        ("*ELEMENT_SHELL_THICKNESS\n2,1,1,2,3,4\n1.,1.,-1.,1.\n", 3),
        ("*SECTION_SHELL\n1,2\n-1.5\n", 3),
    ] {
        let deck = format!("{NODES}{PART}{SHELL}");
        let model = read_text(format!("{deck}{cards}"));
        let found = only(&model);
        assert_eq!(found.kind, DiagnosticKind::BadField, "{found}");
        assert_eq!(line(&found), deck.lines().count() as u64 + at);
        assert!(
            found
                .to_string()
                .contains("expected a thickness that is not negative"),
            "{found}"
        );
        assert_eq!(
            model.shells.len() as u64,
            1 + u64::from(cards.contains("ELEMENT"))
        );
        for shell in 0..model.shells.len() as u32 {
            assert_eq!(model.shell_thickness(shell), None);
        }
    }
}

mod titles {
    use super::*;

    /// Latin-1, the five characters of Windows-1252, a control character, and UTF-8 beside them.
    fn deck() -> Vec<u8> {
        let mut deck = format!("*TITLE\n%\n{NODES}{SHELL}*PART\n%\n1,1\n*PART\nTür\n2,1\n");
        deck += "*SET_PART_LIST_TITLE\n%\n7\n1\n*END\n";
        let pieces: [&[u8]; 4] = [b"Stra\xdfe", b"T\xfcr \x96 5 \x80", b"\x1b[31mred", b""];
        let mut bytes = Vec::new();
        for (text, piece) in deck.split('%').zip(pieces) {
            bytes.extend_from_slice(text.as_bytes());
            bytes.extend_from_slice(piece);
        }
        bytes
    }

    #[test]
    fn german_titles_are_shown_and_chosen_by() {
        let model = read_text(deck());
        assert_eq!(model.title, "Straße");
        assert_eq!(model.parts[0].title, "Tür – 5 €");
        assert_eq!(model.parts[1].title, "Tür");
        let by_title = Selection::PartTitle("TÜR – 5 €".into());
        assert_eq!(model.surface(&by_title).unwrap().mesh.n_triangles(), 2);
        // A terminal must not obey what a title holds.
        assert_eq!(model.sets.parts[&7].title, "␛[31mred");
    }

    #[test]
    fn titles_are_written_back_byte_by_byte() {
        let model = read_text(deck());
        let bytes = write(&model, &WriteOptions::default(), &Monitor::silent()).unwrap();
        let lines: Vec<&[u8]> = bytes.split(|&b| b == b'\n').collect();
        let expected: [&[u8]; 4] = [
            b"Stra\xdfe",
            b"T\xfcr \x96 5 \x80",
            "Tür".as_bytes(),
            b"\x1b[31mred",
        ];
        for title in expected {
            assert!(
                lines.contains(&title),
                "{:?}",
                String::from_utf8_lossy(title)
            );
        }
        assert_eq!(read_text(bytes).parts, model.parts);
    }
}

mod numbers {
    use super::*;

    fn is_finite(model: &Model) -> bool {
        let of_nodes = model
            .nodes
            .positions()
            .iter()
            .flat_map(|p| p.iter().copied());
        let of_parts = model.parts.iter().filter_map(|p| p.thickness).flatten();
        let of_shells = model.shell_extras.iter().flat_map(|extra| extra.thickness);
        let stresses = model.forming.stresses();
        let of_stress = stresses.flat_map(|s| s.points.iter().flat_map(|p| p.stress));
        let mut all = of_nodes.chain(of_parts).chain(of_shells).chain(of_stress);
        all.all(f64::is_finite)
            && model
                .part_summaries()
                .iter()
                .all(|row| row.thickness.is_none_or(f64::is_finite))
    }

    #[test]
    fn unit_factors_of_includes_are_sane() {
        let part = format!(
            "{NODES}{PART}*ELEMENT_SHELL_THICKNESS\n1,1,1,2,3,4\n1.5,1.5,1.5,1.5\n\
             *SECTION_SHELL\n1,2\n1e15\n\
             *INITIAL_STRESS_SHELL\n1,1,1\n0.,9e99,1.,1.,1.,1.,1.,1.\n"
        );
        for factors in [
            "1,1,1e308",
            "1,1,-2",
            "1,1e-300,1",
            "1e308,1,1",
            "1,1,1e-308",
        ] {
            let main = format!("*INCLUDE_TRANSFORM\npart.k\n,0\n,\n{factors}\n\n*END\n");
            let files = Memory::new()
                .with("main.k", main)
                .with("part.k", part.as_str());
            let model = read_files(&files);
            assert!(is_finite(&model), "{factors}");
            for finding in model.diagnostics.iter() {
                assert_eq!(finding.kind, DiagnosticKind::BadTransformation, "{finding}");
                assert_eq!(line(finding), 2);
            }
            assert!(!model.diagnostics.is_empty(), "{factors}");
        }
    }

    #[test]
    fn unit_factors_may_not_multiply_up_either() {
        let nest = "*INCLUDE_TRANSFORM\nnext.k\n,0\n,\n1,1,1e9\n\n";
        let mut files = Memory::new().with("main.k", nest.replace("next", "1"));
        for level in 1..6 {
            let text = nest.replace("next", &(level + 1).to_string());
            files = files.with(format!("{level}.k"), text);
        }
        let part = format!("{NODES}{PART}{SHELL}*SECTION_SHELL\n1,2\n2.\n");
        let model = read_files(&files.with("6.k", part));
        assert!(is_finite(&model));
        assert!(model.diagnostics.count(DiagnosticKind::BadTransformation) > 0);
    }

    #[test]
    fn numbers_too_large_are_named_as_such() {
        let mut deck = NODES.to_owned();
        deck += "5,1e999,0,0\n6,1e300,0,0\n7,-2e15,0,0\n1234567890123456789,0,0,0\n";
        let model = read_text(deck + PART + SHELL);
        assert_eq!(model.diagnostics.count(DiagnosticKind::NumberTooLarge), 4);
        assert_eq!(model.diagnostics.total(), 4, "{:?}", all(&model));
        assert!(is_finite(&model) && MAX_LENGTH == 1e15);
        let by_motion = "*DEFINE_TRANSFORMATION\n1\nSCALE,1e14,1e14,1e14\nSCALE,1e9\n\
            *SET_NODE_LIST\n3\n1,2,3,4\n*NODE_TRANSFORM\n1,3\n";
        let model = read_text(format!("{NODES}{PART}{SHELL}{by_motion}"));
        let finding = only(&model);
        assert_eq!(finding.kind, DiagnosticKind::BadTransformation, "{finding}");
        assert!(is_finite(&model));
        let stress = "*INITIAL_STRESS_SHELL\n1,1,1\n0.,1e307,1e307,1e307,0.,0.,0.,0.\n";
        let model = read_text(format!("{NODES}{PART}{SHELL}{stress}"));
        assert_eq!(only(&model).kind, DiagnosticKind::NumberTooLarge);
        assert_eq!(model.forming.n_stress(), 0);
    }

    #[test]
    fn a_mean_of_equal_thicknesses_is_that_thickness() {
        let mut deck = format!("{NODES}{PART}*SECTION_SHELL\n1,2\n1.2\n*ELEMENT_SHELL\n");
        for id in 1..3000 {
            writeln!(deck, "{id},1,1,2,3,4").unwrap();
        }
        assert_eq!(read_text(deck).part_summaries()[0].thickness, Some(1.2));
    }
}

mod columns {
    use super::*;

    fn wide(width: usize, n: usize) -> String {
        let mut deck = "*KEYWORD\n*NODE\n".to_owned();
        for id in 1..=n {
            let real = width.max(16);
            writeln!(
                deck,
                "{id:width$}{:real$}{:real$}{:real$}",
                id as f64, 1.5, 0.0
            )
            .unwrap();
        }
        deck += "*ELEMENT_SHELL\n";
        for id in 1..n - 2 {
            let [a, b, c, d] = [id, id + 1, id + 2, id + 3];
            writeln!(
                deck,
                "{id:width$}{:width$}{a:width$}{b:width$}{c:width$}{d:width$}",
                1
            )
            .unwrap();
        }
        deck + "*END\n"
    }

    #[test]
    fn a_deck_of_other_columns_gets_one_message() {
        for (width, layout) in [(10, "I10=Y"), (20, "LONG=Y")] {
            let model = read_text(wide(width, 265));
            let shifted = DiagnosticKind::ShiftedColumns;
            let found: Vec<_> = model.diagnostics.iter().collect();
            let told: Vec<_> = found
                .iter()
                .filter(|d| d.severity() == Severity::Error)
                .collect();
            assert_eq!(told.len(), 1, "{:?}", all(&model));
            let text = told[0].to_string();
            assert_eq!(told[0].kind, shifted, "{text}");
            assert!(
                text.contains("is this an I10 or long deck without the keyword?"),
                "{text}"
            );
            assert!(text.contains(layout), "{text}");
            assert_eq!(line(told[0]), 3);
            // Both blocks are of that kind, and nothing is read by chance.
            assert_eq!(model.diagnostics.count(shifted), 2);
            assert_eq!((model.nodes.len(), model.shells.len()), (0, 0));
            // And with the keyword it is read.
            let right = wide(width, 265).replace("*KEYWORD", &format!("*KEYWORD {layout}"));
            assert_eq!(read_text(right).nodes.len(), 265);
        }
        let narrow = wide(8, 10).replace("*KEYWORD", "*KEYWORD LONG=Y");
        let text = all(&read_text(narrow)).join("\n");
        assert!(text.contains("is this a standard deck"), "{text}");
    }

    #[test]
    fn decimal_commas_blanks_and_misplaced_keywords_are_named() {
        let node = format!("*NODE\n{:8}{:>16}{:>16}{:>16}\n", 9, "0,5", "1,25", "3,0");
        let model = read_text(format!("{NODES}{PART}{SHELL}{node}"));
        let text = only(&model).to_string();
        assert!(
            text.contains("the node cannot be read: a decimal comma?"),
            "{text}"
        );
        for (keyword, card) in [("NODE", "9 0.5 1.25 3.0"), ("ELEMENT_SHELL", "9 1 1 2 3 4")] {
            let model = read_text(format!("{NODES}{PART}{SHELL}*{keyword}\n{card}\n"));
            let text = only(&model).to_string();
            assert!(text.contains("blanks between its values?"), "{text}");
            assert!(text.contains("or commas between the values"), "{text}");
        }
        for deck in [
            format!("{NODES}{PART}{SHELL} *ELEMENT_SHELL\n"),
            format!("{NODES}{PART}{SHELL}*NODE\n *SET_NODE\n"),
            format!("{NODES}{PART}{SHELL}*MAT_ELASTIC\n1,7.8e-9\n  *NODE\n7,0,0,0\n"),
            format!("{NODES}{SHELL}{PART}*MAT_ELASTIC\n1,7.8e-9\n$ *NODE\n *NODE\n7,0,0,0\n"),
        ] {
            let model = read_text(deck);
            assert_eq!(only(&model).kind, DiagnosticKind::MisplacedKeyword);
        }
        // A written title that begins with a star has a blank before it.
        let titled = read_text(format!("{NODES}{SHELL}*PART\n *node of the frame*\n1,1\n"));
        assert_eq!(titled.parts[0].title, "*node of the frame*");
    }

    #[test]
    fn a_title_line_without_its_option_is_explained() {
        let model = read_text(format!(
            "{NODES}{PART}{SHELL}*SET_NODE_LIST\nall of it\n3\n1,2\n"
        ));
        let text = only(&model).to_string();
        assert!(text.contains("needs _TITLE"), "{text}");
    }
}

mod places {
    use super::*;

    #[test]
    fn undefined_parts_and_sets_have_their_line() {
        let model = read_text(format!("{NODES}{SHELL}2,7,1,2,3,4\n"));
        let found: Vec<_> = model.diagnostics.iter().collect();
        assert_eq!(found.iter().map(|d| line(d)).collect::<Vec<_>>(), [7, 8]);
        // Usual in a dynain, and nothing is missing.
        assert!(found.iter().all(|d| d.severity() == Severity::Note));
        let solid = "*ELEMENT_SOLID\n1,5\n1,2,3,4,4,4,4,4\n";
        assert_eq!(line(&only(&read_text(format!("{NODES}{solid}")))), 7);
        let set = format!("{NODES}{PART}{SHELL}*SET_NODE_ADD\n5\n8\n");
        let finding = only(&read_text(set));
        assert!(
            finding.message.contains("node set 5 names node set 8"),
            "{finding}"
        );
        assert_eq!(line(&finding), 12);
        let results = "*INITIAL_STRAIN_SHELL_SET\n9\n1.,1.,1.,1.,1.,1.,-1.\n1.,1.,1.,1.,1.,1.,1.\n";
        let finding = only(&read_text(format!("{NODES}{PART}{SHELL}{results}")));
        assert!(finding.message.contains("shell set 9"), "{finding}");
        assert_eq!(line(&finding), 12);
    }

    #[test]
    fn includes_of_moved_trees_are_found_by_the_end_of_their_path() {
        let part = format!("{NODES}{PART}{SHELL}");
        let main = "*INCLUDE\nP:\\project\\v7\\mesh\\sub\\x.k\n*END\n";
        let files = Memory::new()
            .with("main.k", main)
            .with("mesh/sub/x.k", part.as_str())
            .with("other/x.k", "*NODE\n");
        assert_eq!(read_files(&files).shells.len(), 1);
        let finding = only(&read_files(
            &Memory::new().with("main.k", format!("{part}{main}")),
        ));
        assert_eq!(finding.kind, DiagnosticKind::MissingInclude);
        assert!(finding.message.contains("\"v7/mesh/sub/x.k\""), "{finding}");
        assert!(finding.message.contains("the deck's folder"), "{finding}");
    }

    #[test]
    fn nodes_are_counted_once() {
        let twice = format!("{NODES}{NODES}5,2,0,0\n1,9,9,9\n{PART}{SHELL}2,1,2,5,3,3\n");
        let model = read_text(twice);
        assert_eq!(model.nodes.ids(), [1, 2, 3, 4, 5]);
        assert_eq!(model.diagnostics.count(DiagnosticKind::RepeatedNode), 4);
        assert_eq!(model.diagnostics.count(DiagnosticKind::DuplicateNode), 1);
        let mesh = model.surface(&Selection::All).unwrap().mesh;
        assert!((mesh.area() - 1.5).abs() < 1e-12);
    }

    #[test]
    fn plies_may_be_written_in_whole_numbers() {
        for plies in [
            "         1         1        45                   2         3        90\n",
            "   2000001         1        45\n         2         3\n",
            "1,1,45,,2,3,90\n",
            "1,1,45\n2,3\n",
        ] {
            let shells = format!("1,1,1,2,3,4\n{plies}2,1,1,2,3,3\n1,0.5,0\n");
            let model = read_text(format!(
                "{NODES}{PART}*ELEMENT_SHELL_COMPOSITE\n{shells}*END\n"
            ));
            assert_eq!(all(&model), Vec::<String>::new(), "{plies}");
            assert_eq!(model.shells.len(), 2, "{plies}");
            assert_eq!(model.ply_stacks, [vec![1.0, 3.0], vec![0.5]], "{plies}");
        }
        for broken in ["       2       1       2       x", "2,1,1,2,x"] {
            let shells = format!("1,1,1,2,3,4\n1,0.5\n{broken}\n");
            let model = read_text(format!("{NODES}{PART}*ELEMENT_SHELL_COMPOSITE\n{shells}"));
            assert_eq!(only(&model).severity(), Severity::Error, "{broken}");
            assert_eq!(model.ply_stacks, [vec![0.5]], "{broken}");
        }
    }

    #[test]
    fn quads_whose_edges_cross_are_told() {
        let of = |cards: &str| {
            let nodes = "*NODE\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n5,1.2,0.8,0\n6,2,1,1.9\n";
            read_text(format!("{nodes}{PART}*ELEMENT_SHELL\n{cards}*END\n"))
        };
        for crossed in ["1,1,1,3,2,4\n", "1,1,1,2,4,3\n"] {
            let model = of(crossed);
            let finding = only(&model);
            assert_eq!(finding.kind, DiagnosticKind::CrossedEdges);
            assert_eq!(line(&finding), 12);
            assert_eq!(model.shells.len(), 1);
        }
        // In order, concave, warped, a triangle.
        for whole in [
            "1,1,1,2,3,4\n",
            "1,1,1,2,5,4\n",
            "1,1,1,2,6,4\n",
            "1,1,1,3,2,2\n",
        ] {
            assert_eq!(all(&of(whole)), Vec::<String>::new(), "{whole}");
        }
    }

    #[test]
    fn concave_quads_are_cut_along_their_inner_diagonal() {
        let arrow = "*NODE\n1,0,0,0\n2,2,1,0\n3,0,2,0\n4,1.2,1,0\n*ELEMENT_SHELL\n";
        for corners in ["1,2,3,4", "2,3,4,1"] {
            let model = read_text(format!("{arrow}1,1,{corners}\n"));
            let area = model.surface(&Selection::All).unwrap().mesh.area();
            assert!((area - 0.8).abs() < 1e-12, "{area}");
        }
    }

    #[test]
    fn blank_lines_between_parts_are_no_parts() {
        let cards = "\n\n\nfloor\n1,1\n\n\n\n2,1\n\n\nroof\n3,1\n\n\n";
        let model = read_text(format!("{NODES}{SHELL}*PART\n{cards}*END\n"));
        assert!(model.diagnostics.is_empty(), "{:?}", all(&model));
        let parts: Vec<_> = model
            .parts
            .iter()
            .map(|p| (p.id, p.title.as_str()))
            .collect();
        assert_eq!(parts, [(1, "floor"), (2, ""), (3, "roof")]);
    }
}

mod bounds {
    use super::*;

    #[test]
    fn counts_of_a_header_take_no_memory() {
        let results = "*INITIAL_STRESS_SHELL\n1,10000,10000,10000\n";
        let model = read_text(format!("{NODES}{PART}{SHELL}{results}"));
        assert_eq!(only(&model).kind, DiagnosticKind::MissingCard);
        let composite = format!(
            "*ELEMENT_SHELL_COMPOSITE\n\n1,1,1,2,3,4\n{}",
            "\n".repeat(2_000_000)
        );
        let model = read_text(format!("{NODES}{PART}{composite}"));
        assert_eq!(model.shells.len(), 1);
    }

    #[test]
    fn lines_and_names_of_any_length_take_no_time() {
        for text in ["1 * ", "  *"] {
            let curve = format!("*DEFINE_CURVE\n{}\n", text.repeat(1_000_000));
            let model = read_text(format!("{NODES}{PART}{SHELL}{curve}"));
            assert!(model.diagnostics.is_empty(), "{:?}", all(&model));
        }
        let deck = format!("{NODES}{PART}{SHELL}*{}\n", "A".repeat(5_000_000));
        assert_eq!(only(&read_text(deck)).kind, DiagnosticKind::UnknownKeyword);
        let name = "a/".repeat(200_000);
        let deck = format!("{NODES}{PART}{SHELL}*INCLUDE\n{name}x.k\n");
        let told = only(&read_text(deck)).message;
        assert!(told.contains("more than 4096 characters"), "{told}");
    }

    #[test]
    fn broken_shells_in_many_blocks_take_no_time() {
        let n = 200_000;
        let mut deck = format!("{NODES}{PART}");
        for id in 1..=n {
            writeln!(deck, "*ELEMENT_SHELL\n{id},1,1,2,9,4").unwrap();
        }
        deck += "*ELEMENT_SHELL\n300000,1,1,2,3,4\n300001,1,2,2,2,2\n300002,5,1,2,3,4\n";
        let model = read_text(&*deck);
        assert_eq!(model.diagnostics.count(DiagnosticKind::MissingNode), n);
        assert_eq!(model.shells.len(), 2);
        let mut found = model.diagnostics.iter();
        let part = found.find(|d| d.kind == DiagnosticKind::UndefinedPart);
        assert_eq!(line(part.unwrap()), deck.lines().count() as u64);
    }

    #[test]
    fn a_chain_of_many_sets_is_followed_to_its_end() {
        let n = 100_000;
        let mut deck = format!("{NODES}{PART}{SHELL}*SET_NODE_LIST\n{n}\n1,2,3\n");
        for id in 1..n {
            writeln!(deck, "*SET_NODE_ADD\n{id}\n{}", id + 1).unwrap();
        }
        let model = read_text(deck);
        assert!(model.diagnostics.is_empty(), "{:?}", all(&model));
        assert_eq!(model.sets.nodes[&1].ids, [1, 2, 3]);
        let ring = format!("{NODES}{PART}{SHELL}*SET_NODE_ADD\n1\n2\n*SET_NODE_ADD\n2\n1\n");
        assert_eq!(only(&read_text(ring)).kind, DiagnosticKind::BadSet);
    }

    #[test]
    fn sums_of_sets_of_several_kinds_take_those_of_nodes() {
        let sets = "*SET_NODE_LIST\n5\n1,2\n*SET_NODE_LIST\n6\n4\n*SET_SHELL_LIST\n1\n1\n";
        let add = "*SET_NODE_ADD_ADVANCED_TITLE\nsum\n9\n5,1,6\n";
        let model = read_text(format!("{NODES}{PART}{SHELL}{sets}{add}"));
        assert!(model.diagnostics.is_empty(), "{:?}", all(&model));
        assert_eq!(model.sets.nodes[&9].ids, [1, 2, 4]);
        let model = read_text(format!("{NODES}{PART}{SHELL}{sets}{add}1,2\n"));
        let told = only(&model);
        assert_eq!(told.kind, DiagnosticKind::Unsupported);
        assert_eq!((line(&told), told.found.as_deref()), (24, Some("2")));
        assert_eq!(model.sets.nodes[&9].ids, [1, 2, 4]);
    }

    /// Nodes in a row with ids from 1.
    fn row_of_nodes(n: usize) -> String {
        let mut deck = "*NODE\n".to_owned();
        for id in 1..=n {
            writeln!(deck, "{id},{id},0,0").unwrap();
        }
        deck
    }

    #[test]
    fn overlapping_ranges_cost_what_is_new_in_them() {
        let n = 100_000;
        let mut deck = row_of_nodes(n) + "*SET_NODE_LIST_GENERATE\n1\n";
        for first in 1..=20_000 {
            writeln!(deck, "{first},{}", n - first).unwrap();
        }
        deck += "*SET_NODE_GENERAL\n2\n";
        for _ in 0..20_000 {
            deck += "ALL\n";
        }
        let options = ReadOptions {
            // Twice as many as come out; ten thousand times as many would be named.
            max_set_ids: 4 * n as u64,
            ..ReadOptions::default()
        };
        let files = Memory::new().with("main.k", deck);
        let read = formats::read_from(&files, Path::new("main.k"), &options, &Monitor::silent());
        let model = read.unwrap();
        assert_eq!(model.diagnostics.count(DiagnosticKind::LimitReached), 0);
        assert_eq!(model.sets.nodes[&1].ids.len(), n - 1);
        assert_eq!(model.sets.nodes[&2].ids.len(), n);
    }

    #[test]
    fn sets_beyond_the_limit_are_named() {
        let mut deck = row_of_nodes(5_000);
        for id in 1..100 {
            writeln!(deck, "*SET_NODE_GENERAL\n{id}\nALL").unwrap();
        }
        let options = ReadOptions {
            max_set_ids: 12_000,
            ..ReadOptions::default()
        };
        let files = Memory::new().with("main.k", deck);
        let read = formats::read_from(&files, Path::new("main.k"), &options, &Monitor::silent());
        let model = read.unwrap();
        assert_eq!(model.diagnostics.count(DiagnosticKind::LimitReached), 96);
        let mut found = model.diagnostics.iter();
        let first = found
            .find(|d| d.kind == DiagnosticKind::LimitReached)
            .unwrap();
        assert!(first.message.contains("--read-limit"), "{first}");
        let n: usize = model.sets.nodes.values().map(|set| set.ids.len()).sum();
        assert_eq!(n, 12_000);
    }

    #[test]
    fn the_work_on_sets_can_be_cancelled() {
        let mut deck = row_of_nodes(1_000);
        for id in 1..2_000 {
            writeln!(deck, "*SET_NODE_GENERAL\n{id}\nALL").unwrap();
        }
        let files = Memory::new().with("main.k", deck);
        let monitor = Monitor::silent();
        monitor.request_cancel();
        let options = ReadOptions::default();
        let read = formats::read_from(&files, Path::new("main.k"), &options, &monitor);
        assert!(matches!(read, Err(FormatError::Cancelled(_))));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Against the plainest way: a list that is searched for every id.
        #[test]
        fn sets_are_what_a_plain_list_gives(
            steps in proptest::collection::vec((0..6u8, 1u64..40, 0u64..40, 1u64..4), 1..12),
        ) {
            let existing: Vec<u64> = (1..=30).collect();
            let mut deck = row_of_nodes(30) + PART + "*ELEMENT_SHELL\n1,1,1,2,3,3\n";
            let mut expected: Vec<u64> = Vec::new();
            let mut general = "*SET_NODE_GENERAL\n1\n".to_owned();
            for (kind, first, length, step) in steps {
                let add = |id: u64, expected: &mut Vec<u64>| {
                    if !expected.contains(&id) {
                        expected.push(id);
                    }
                };
                match kind {
                    0 | 1 => {
                        writeln!(general, "NODE,{first}").unwrap();
                        add(first, &mut expected);
                    }
                    2 => {
                        general += "ALL\n";
                        existing.iter().for_each(|&id| add(id, &mut expected));
                    }
                    3 => {
                        general += "PART,1\n";
                        [1, 2, 3].iter().for_each(|&id| add(id, &mut expected));
                    }
                    4 => {
                        writeln!(general, "DNODE,{first},{}", first + step).unwrap();
                        expected.retain(|&id| id != first && id != first + step);
                    }
                    _ => {
                        general += "DPART,1\n";
                        expected.retain(|id| ![1, 2, 3].contains(id));
                    }
                }
                let _ = length;
            }
            deck += &general;
            prop_assert_eq!(&read_text(deck).sets.nodes[&1].ids, &expected);
        }

        #[test]
        fn ranges_are_what_a_plain_list_gives(
            rows in proptest::collection::vec((1u64..4000, 0u64..4000, 1u64..4), 1..12),
        ) {
            let n = 3000u64;
            let mut deck = row_of_nodes(n as usize) + "*SET_NODE_LIST_GENERATE_INCREMENT\n1\n";
            let mut expected: Vec<u64> = Vec::new();
            let mut seen = std::collections::HashSet::new();
            for (first, length, step) in rows {
                let last = first + length;
                writeln!(deck, "{first},{last},{step}").unwrap();
                // Short ranges are listed whether their nodes exist or not.
                let is_short = length / step < 1024;
                let ids = (first..=last).step_by(step as usize);
                expected.extend(ids.filter(|&id| (is_short || id <= n) && seen.insert(id)));
            }
            let read = read_text(deck);
            prop_assert_eq!(&read.sets.nodes[&1].ids, &expected);
        }
    }
}
