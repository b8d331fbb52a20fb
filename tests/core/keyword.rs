//! Hand-made decks and their dumps: every row of the format's tables is a small deck in
//! `tests/data/keyword`, each with what must be read from it beside it (`UPDATE_EXPECT=1`
//! rewrites the dumps).

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use shapematch::formats::model::{Forming, ShellStrain, ShellStress, StrainPoint, StressPoint};
use shapematch::formats::{
    self, Diagnostic, DiagnosticKind, Disk, FileBytes, FileSource, FormatError, Memory, Model,
    ReadOptions, Selection,
};
use shapematch::monitor::Monitor;
use shapematch::report::ModelInfo;

fn data_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/keyword")
}

/// The decks of the folder itself; those in folders below it are included by these.
fn decks() -> Vec<PathBuf> {
    let mut decks: Vec<PathBuf> = std::fs::read_dir(data_folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "k" || e == "gz"))
        .collect();
    decks.sort();
    decks
}

/// Opens files relative to the data folder, so that dumps do not hold its place.
struct DataFolder;

impl FileSource for DataFolder {
    fn open(&self, path: &Path, max: u64, monitor: &Monitor) -> std::io::Result<FileBytes> {
        Disk.open(&data_folder().join(path), max, monitor)
    }

    fn stream(&self, path: &Path) -> std::io::Result<Box<dyn std::io::Read + '_>> {
        let file = std::fs::File::open(data_folder().join(path))?;
        Ok(Box::new(file))
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        let found = Disk.find(&data_folder().join(path))?;
        Some(found.strip_prefix(data_folder()).unwrap().to_path_buf())
    }
}

pub fn read_text(text: impl Into<Vec<u8>>) -> Model {
    read_files(&Memory::new().with("main.k", text))
}

fn read_files(files: &Memory) -> Model {
    try_read(files, "main.k").unwrap()
}

fn try_read(source: &dyn FileSource, path: &str) -> Result<Model, FormatError> {
    let options = ReadOptions::default();
    formats::read_from(source, Path::new(path), &options, &Monitor::silent())
}

fn kinds(model: &Model) -> Vec<DiagnosticKind> {
    model.diagnostics.iter().map(|d| d.kind).collect()
}

fn first(model: &Model, kind: DiagnosticKind) -> &Diagnostic {
    let mut all = model.diagnostics.iter();
    all.find(|d| d.kind == kind).expect("a finding of the kind")
}

/// Turned tensors may differ in their last digit from machine to machine.
fn rounded(tensor: [f64; 6]) -> [f64; 6] {
    tensor.map(|x| (x * 1e9).round() / 1e9 + 0.0)
}

fn dump_forming(forming: &Forming, text: &mut String) {
    for stress in forming.stresses() {
        let turned = stress.points.iter().map(|point| StressPoint {
            stress: rounded(point.stress),
            ..*point
        });
        let points: &[StressPoint] = &turned.collect::<Vec<_>>();
        writeln!(text, "stress {:?}", ShellStress { points, ..stress }).unwrap();
    }
    for strain in forming.strains() {
        let turned = strain.points.iter().map(|point| StrainPoint {
            strain: rounded(point.strain),
            ..*point
        });
        let points: &[StrainPoint] = &turned.collect::<Vec<_>>();
        writeln!(text, "strain {:?}", ShellStrain { points, ..strain }).unwrap();
    }
    if !forming.others.is_empty() {
        writeln!(text, "{:?}", forming.others).unwrap();
    }
}

/// Everything in a model, as text.
fn dump(model: &Model) -> String {
    let mut text = String::new();
    let ids = model.nodes.ids();
    writeln!(text, "title {:?}", model.title).unwrap();
    for (id, p) in ids.iter().zip(model.nodes.positions()) {
        // Sines and cosines may differ in their last digit from machine to machine.
        let [x, y, z] = [p.x, p.y, p.z].map(|c| (c * 1e9).round() / 1e9 + 0.0);
        writeln!(text, "node {id} {x} {y} {z}").unwrap();
    }
    for (index, shell) in (0u32..).zip(&model.shells) {
        let corners: Vec<u64> = shell.corners().iter().map(|&n| ids[n as usize]).collect();
        let part = model.parts[shell.part as usize].id;
        write!(text, "shell {} part {part} nodes {corners:?}", shell.id).unwrap();
        if let Ok(at) = model.mid_side.binary_search_by_key(&index, |row| row.0) {
            let row = model.mid_side[at]
                .1
                .map(|n| ids.get(n as usize).copied().unwrap_or(0));
            write!(text, " mid {row:?}").unwrap();
        }
        if let Some(extra) = model.shell_extra(index) {
            write!(text, " own {:?} beta {}", extra.thickness, extra.beta).unwrap();
        }
        writeln!(text, " thickness {:?}", model.shell_thickness(index)).unwrap();
    }
    for solid in &model.solids {
        let corners = solid.nodes.map(|n| ids[n as usize]);
        let part = model.parts[solid.part as usize].id;
        let (kind, id) = (solid.kind, solid.id);
        writeln!(text, "solid {id} part {part} {kind:?} nodes {corners:?}").unwrap();
    }
    for part in &model.parts {
        writeln!(
            text,
            "part {} {:?} section {} thickness {:?} defined {}",
            part.id, part.title, part.section_id, part.thickness, part.is_defined
        )
        .unwrap();
    }
    let sets = &model.sets;
    for (kind, sets) in [
        ("part", &sets.parts),
        ("shell", &sets.shells),
        ("node", &sets.nodes),
    ] {
        for (id, set) in sets {
            writeln!(text, "{kind} set {id} {:?} {:?}", set.title, set.ids).unwrap();
        }
    }
    for motion in &model.motions {
        let (at, id, n) = (&motion.position, motion.transformation, motion.n_nodes);
        writeln!(text, "moved by {id}: {n} nodes, {at}").unwrap();
    }
    dump_forming(&model.forming, &mut text);
    if let Ok(surface) = model.surface(&Selection::All) {
        let (n, area) = (surface.mesh.n_triangles(), surface.mesh.area());
        writeln!(text, "surface {n} triangles, area {area:.6}").unwrap();
    }
    for file in &model.files {
        let path = file.path.to_str().unwrap().replace('\\', "/");
        writeln!(text, "file {path} {}", file.n_bytes).unwrap();
    }
    for diagnostic in model.diagnostics.iter() {
        writeln!(text, "{diagnostic}").unwrap();
    }
    text
}

#[test]
fn every_deck_is_read_as_its_dump_says() {
    let mut wrong = Vec::new();
    for path in decks() {
        let name = path.file_name().unwrap().to_str().unwrap();
        let got = match try_read(&DataFolder, name) {
            Ok(model) => dump(&model),
            Err(error) => format!("{error}\n"),
        };
        let beside = path.with_file_name(format!("{name}.dump"));
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            std::fs::write(&beside, &got).unwrap();
        }
        let expected = std::fs::read_to_string(&beside).unwrap_or_default();
        if got != expected.replace("\r\n", "\n") {
            wrong.push(format!("--- {name}, expected\n{expected}--- got\n{got}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_deck_cut_off_anywhere_is_read_without_panic() {
    for path in decks() {
        let bytes = std::fs::read(&path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let by_line = bytes
            .iter()
            .enumerate()
            .filter(|(_, b)| **b == b'\n')
            .map(|(i, _)| i + 1);
        let cuts: Vec<usize> = if bytes.len() < 1500 {
            (0..bytes.len()).collect()
        } else {
            by_line.collect()
        };
        for cut in cuts {
            let files = Memory::new().with(name, &bytes[..cut]);
            if let Ok(model) = try_read(&files, name) {
                let _ = model.surface(&Selection::All);
                let _ = model.part_summaries();
            }
        }
    }
}

/// The cases in which public readers hang, drop elements or give wrong numbers.
mod gaps {
    use super::*;

    const SHELL: &str = "*ELEMENT_SHELL\n       1       1       1       2       3       4\n";

    fn check(nodes: &str) {
        let model = read_text(format!("*KEYWORD\n{nodes}{SHELL}*END\n"));
        assert_eq!(
            kinds(&model),
            [DiagnosticKind::UndefinedPart],
            "{}",
            dump(&model)
        );
        assert_eq!(model.nodes.ids(), [1, 2, 3, 4]);
        let surface = model.surface(&Selection::All).unwrap();
        assert_eq!(surface.mesh.n_triangles(), 2);
        assert!((surface.mesh.area() - 1.5e-3).abs() < 1e-15);
    }

    #[test]
    fn fortran_exponents() {
        check(concat!(
            "*NODE\n       1           0.0-3           0.0d0           0.0+0\n",
            "       2           1.5-3           0.0d0           0.0+0\n",
            "       3           1.5-3           1.0d0           0.0+0\n",
            "       4             0.0          10.d-1              0.\n",
        ));
    }

    #[test]
    fn comma_lines() {
        check("*NODE\n1,0,0,0\n2,1.5e-3,,\n3, 1.5e-3, 1.0, 0.0, 0, 0\n4,,1.\n");
    }

    #[test]
    fn expressions_in_fields() {
        check(concat!(
            "*PARAMETER\nR        w    1.5E-3\nI        n         2\n",
            "*NODE\n       1             0.0             0.0             0.0\n",
            "    <&n>        <&w/2*2>             0.0             0.0\n",
            "<&n + 1>              &w        <n - 1.>             0.0\n",
            "       4             0.0             1.0             <0>\n",
        ));
    }

    #[test]
    fn i10_suffix() {
        check(concat!(
            "*NODE %\n         1             0.0             0.0             0.0\n",
            "         2          1.5E-3             0.0             0.0         0         0\n",
            "         3          1.5E-3             1.0             0.0\n",
            "         4             0.0             1.0             0.0\n",
        ));
    }

    #[test]
    fn long_keyword_line() {
        let wide = |values: &[&str]| -> String {
            let fields: String = values.iter().map(|v| format!("{v:>20}")).collect();
            fields + "\n"
        };
        let nodes = [
            ["1", "0", "0", "0"],
            ["2", "1.5e-3", "0", "0"],
            ["3", "1.5e-3", "1", "0"],
        ];
        let mut deck = "*KEYWORD LONG=Y\n*NODE\n".to_owned();
        nodes.iter().for_each(|node| deck += &wide(node));
        deck += &wide(&["4", "0", "1", "0"]);
        deck += "*ELEMENT_SHELL\n";
        deck += &wide(&["1", "1", "1", "2", "3", "4"]);
        let model = read_text(deck);
        assert_eq!(model.shells.len(), 1);
        assert!((model.surface(&Selection::All).unwrap().mesh.area() - 1.5e-3).abs() < 1e-15);
    }

    #[test]
    fn keywords_in_lower_case() {
        let deck = "*keyword\n*node\n1,0,0,0\n2,1,0,0\n3,1,1,0\n*element_shell\n1,1,1,2,3\n*end\n";
        let model = read_text(deck);
        assert_eq!((model.nodes.len(), model.shells.len()), (3, 1));
    }

    #[test]
    fn thickness_cards_are_no_elements_and_none_is_dropped() {
        let nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n";
        let shells =
            "1,1,1,2,3,4\n1.0,1.0,1.0,1.0\n$ between\n2,1,1,2,3\n2.0,2.0,2.0\n3,1,2,3,4\n1,1,1,1\n";
        let model = read_text(format!("{nodes}*ELEMENT_SHELL_THICKNESS\n{shells}"));
        let ids: Vec<u64> = model.shells.iter().map(|shell| shell.id).collect();
        assert_eq!(ids, [1, 2, 3]);
        assert_eq!(model.shell_thickness(1), Some([2.0; 4]));
    }

    #[test]
    fn line_ends_comments_and_missing_constraints() {
        check(concat!(
            "*NODE\r\n$ one\r\n       1             0.0             0.0             0.0\r\n$ two\r\n",
            "       2          0.0015             0.0             0.0       0       0\r\n",
            "       3          0.0015             1.0             0.0\r\n",
            "       4             0.0             1.0\r\n",
        ));
    }
}

/// A deck of `n` strips of quads, large enough to be read in pieces.
fn large_deck(n: usize, thickness: bool, mid_side_at: Option<usize>) -> String {
    let mut deck = "*KEYWORD\n*NODE\n".to_owned();
    for i in 0..=n {
        let x = i as f64 * 0.37;
        for (row, y) in [0.0, 1.25].into_iter().enumerate() {
            let id = 2 * i + row + 1;
            writeln!(deck, "{id:8}{x:16.7}{y:16.7}{:16.7}{:8}{:8}", x.sin(), 0, 0).unwrap();
            if i % 97 == 0 {
                deck += "$ a comment between the nodes\n";
            }
        }
    }
    deck += if thickness {
        "*ELEMENT_SHELL_THICKNESS\n"
    } else {
        "*ELEMENT_SHELL\n"
    };
    for i in 0..n {
        let (a, part) = (2 * i + 1, 1 + i / 1000);
        write!(
            deck,
            "{:8}{part:8}{a:8}{:8}{:8}{:8}",
            i + 1,
            a + 2,
            a + 3,
            a + 1
        )
        .unwrap();
        let has_mid_side = mid_side_at == Some(i);
        deck += if has_mid_side {
            "       1       2       3       4\n"
        } else {
            "\n"
        };
        if thickness {
            if i % 53 == 0 {
                deck += "$#         thic1           thic2\n";
            }
            let t = 1.0 + i as f64 * 1e-5;
            writeln!(deck, "{t:16.9}{t:16.9}{t:16.9}{t:16.9}").unwrap();
            if has_mid_side {
                writeln!(deck, "{t:16.9}{t:16.9}{t:16.9}{t:16.9}").unwrap();
            }
        }
    }
    deck += "\n*END\n";
    deck
}

#[test]
fn large_blocks_are_read_in_pieces_and_nothing_is_lost_at_the_cuts() {
    let n = 30_000;
    for (thickness, mid_side) in [(false, None), (true, None), (true, Some(17_123))] {
        let deck = large_deck(n, thickness, mid_side);
        assert!(deck.len() > 3 << 20);
        let model = read_text(deck);
        assert_eq!(kinds(&model), [DiagnosticKind::UndefinedPart; 20]);
        assert_eq!((model.nodes.len(), model.shells.len()), (2 * n + 2, n));
        assert_eq!(model.mid_side.len(), usize::from(mid_side.is_some()));
        assert_eq!(model.shell_extras.len(), if thickness { n } else { 0 });
        for (i, shell) in model.shells.iter().enumerate() {
            let a = 2 * i as u32;
            assert_eq!(
                (shell.id, shell.nodes),
                (i as u64 + 1, [a, a + 2, a + 3, a + 1])
            );
            assert_eq!(model.parts[shell.part as usize].id, 1 + i as u64 / 1000);
            if thickness {
                let expected = format!("{:.9}", 1.0 + i as f64 * 1e-5).parse().unwrap();
                assert_eq!(model.shell_thickness(i as u32), Some([expected; 4]));
            }
        }
        let last = model.nodes.positions()[2 * n];
        assert_eq!(
            last.x,
            format!("{:.7}", n as f64 * 0.37).parse::<f64>().unwrap()
        );
    }
}

#[test]
fn findings_in_large_blocks_have_their_line() {
    let mut deck = large_deck(30_000, true, None);
    let wanted = format!("{:8}{:8}{:8}", 25_001, 26, 50_001);
    let at = deck.find(&wanted).unwrap();
    deck.replace_range(at + 16..at + 24, "99999999");
    let line = deck[..at].lines().count() as u64 + 1;
    let model = read_text(deck);
    let finding = first(&model, DiagnosticKind::MissingNode);
    assert_eq!(finding.position.as_ref().unwrap().line, line);
    assert!(finding.message.contains("25001") && finding.message.contains("99999999"));
    assert_eq!(model.shells.len(), 29_999);
    // The thickness stays with its shell when a shell before it is left out.
    let last = model.shell_thickness(29_998).unwrap();
    assert_eq!(
        last[0],
        format!("{:.9}", 1.0 + 29_999.0 * 1e-5)
            .parse::<f64>()
            .unwrap()
    );
}

#[test]
fn a_million_broken_lines_cost_no_memory() {
    let deck = format!("*NODE\n{}", "       x\n".repeat(200_000));
    let model = read_text(deck);
    assert_eq!(model.diagnostics.count(DiagnosticKind::BadField), 200_000);
    let kept = model.diagnostics.iter();
    let kept = kept.filter(|d| d.kind == DiagnosticKind::BadField);
    assert_eq!(kept.count(), 20);
    assert_eq!(
        first(&model, DiagnosticKind::BadField)
            .position
            .as_ref()
            .unwrap()
            .line,
        2
    );
}

#[test]
fn reading_can_be_cancelled() {
    let monitor = Monitor::silent();
    monitor.request_cancel();
    let files = Memory::new().with("main.k", large_deck(100, false, None));
    let read = formats::read_from(
        &files,
        Path::new("main.k"),
        &ReadOptions::default(),
        &monitor,
    );
    assert!(matches!(read, Err(FormatError::Cancelled(_))));
}

#[test]
fn a_missing_or_binary_file_is_named() {
    let files = Memory::new().with("dynain", [8u8, 8, 8, 1, 1, 0, 0, 0].repeat(9));
    let missing = try_read(&files, "none.k").unwrap_err();
    assert!(missing.to_string().contains("none.k"), "{missing}");
    let binary = try_read(&files, "dynain").unwrap_err();
    assert!(binary.to_string().contains("binary dynain"), "{binary}");
}

#[test]
fn includes_that_double_at_every_level_come_to_an_end() {
    let mut files = Memory::new().with("main.k", "*INCLUDE\n1.k\n1.k\n");
    for level in 1..40 {
        let text = format!("*INCLUDE\n{n}.k\n{n}.k\n", n = level + 1);
        files = files.with(format!("{level}.k"), text);
    }
    let model = read_files(&files);
    assert!(model.diagnostics.count(DiagnosticKind::LimitReached) > 0);
}

#[test]
fn selections_choose_what_they_name() {
    let model = try_read(&DataFolder, "sets.k").unwrap();
    let area = |selection| model.surface(&selection).map(|surface| surface.mesh.area());
    assert_eq!(area(Selection::Parts(vec![7])), Ok(200.0));
    assert_eq!(area(Selection::Parts(vec![7, 8])), Ok(400.0));
    assert_eq!(area(Selection::PartSet(3)), Ok(200.0));
    assert_eq!(area(Selection::ShellSet(1)), Ok(200.0));
    assert_eq!(area(Selection::NodeSet(3)), Ok(400.0));
    let refused = [
        (Selection::Parts(vec![9]), "there is no part 9"),
        (Selection::PartSet(9), "there is no part set 9"),
        (
            Selection::PartTitle("no".into()),
            "there is no part with the title \"no\"",
        ),
        (
            Selection::NodeSet(1),
            "there is no shell or solid with area",
        ),
    ];
    for (selection, message) in refused {
        assert_eq!(area(selection).unwrap_err().to_string(), message);
    }
    let titled = try_read(&DataFolder, "standard.k").unwrap();
    let by_title = titled
        .surface(&Selection::PartTitle(" floor PANEL ".into()))
        .unwrap();
    assert_eq!(by_title.mesh.n_triangles(), 4);
    assert_eq!(by_title.triangle_element, [0, 0, 1, 1]);
}

#[test]
fn solids_show_a_closed_skin_that_looks_outward() {
    for deck in ["solids_old_layout.k", "thick_shells.k"] {
        let model = try_read(&DataFolder, deck).unwrap();
        let mesh = model.surface(&Selection::All).unwrap().mesh;
        let volume: f64 = (0..mesh.n_triangles())
            .map(|t| {
                let [a, b, c] = mesh.corners(t).map(|p| p.coords);
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        assert!((volume - 2.0).abs() < 1e-12, "{deck}: {volume}");
    }
}

/// Public decks, where a checkout has them.
fn public_decks() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let root = std::env::var_os("SHAPEMATCH_TEST_DATA").map_or(beside, PathBuf::from);
    Some(root.join("lsdyna")).filter(|folder| folder.is_dir())
}

/// Path below the folder, nodes and shells as its README counts them.
fn counts_of_readme(folder: &Path) -> Vec<(String, usize, usize)> {
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let mut rows = Vec::new();
    for line in readme.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, file, _, nodes, shells, ..] = cells[..] else {
            continue;
        };
        let shells = shells.split(' ').next().unwrap_or_default();
        if let (Some((_, path)), Ok(nodes), Ok(shells)) =
            (file.split_once(": "), nodes.parse(), shells.parse())
        {
            rows.push((path.to_owned(), nodes, shells));
        }
    }
    rows
}

#[test]
fn public_decks_are_read_with_their_nodes_and_shells() {
    let Some(folder) = public_decks() else {
        return;
    };
    let counts = counts_of_readme(&folder);
    assert!(counts.len() > 40, "the README's table is understood");
    let mut todo = vec![folder];
    let mut wrong = Vec::new();
    while let Some(path) = todo.pop() {
        if path.is_dir() {
            todo.extend(
                std::fs::read_dir(path)
                    .unwrap()
                    .map(|entry| entry.unwrap().path()),
            );
            continue;
        }
        // Each file by itself: the table counts what stands in it.
        let name = path.file_name().unwrap().to_str().unwrap();
        let files = Memory::new().with(name, std::fs::read(&path).unwrap());
        let Ok(model) = try_read(&files, name) else {
            continue;
        };
        let _ = model.surface(&Selection::All);
        let _ = formats::read(&path, &ReadOptions::default(), &Monitor::silent());
        let text = path.to_str().unwrap();
        let row = counts
            .iter()
            .find(|row| text.ends_with(&format!("/{}", row.0)));
        let count = |kind| model.diagnostics.count(kind) as usize;
        let broken = count(DiagnosticKind::MissingNode) + count(DiagnosticKind::DegenerateElement);
        // The table counts lines; a node repeated at the same place is one node.
        let nodes = model.nodes.len() + count(DiagnosticKind::RepeatedNode);
        let got = (nodes, model.shells.len() + broken);
        if row.is_some_and(|row| row.1 != got.0 || row.2 > got.1) {
            let found: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
            wrong.push(format!(
                "{text}: {got:?}, not {row:?}\n{}",
                found.join("\n")
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The units a deck states, in words.
fn units_of(deck: &str) -> Option<String> {
    read_text(deck).stated_units.map(|known| known.words())
}

#[test]
fn units_are_read_from_comments_titles_control_cards_and_materials() {
    let says = |words: &str| Some(words.to_owned());
    assert_eq!(
        units_of("*KEYWORD\n$ Unit system: mm, ms, kg, kN\n*END\n"),
        says("kg-mm-ms, from title or comment")
    );
    assert_eq!(
        units_of("*KEYWORD\n*TITLE\nPillar in ton-mm-s\n*END\n"),
        says("ton-mm-s, from title or comment")
    );
    assert_eq!(
        units_of("*KEYWORD\n*CONTROL_UNITS\n        MM        MS        KG\n*END\n"),
        says("kg-mm-ms, from title or comment")
    );
    let steel =
        "*MAT_PIECEWISE_LINEAR_PLASTICITY_TITLE\nDC04\n         1  7.85E-09    2.1E+5       0.3\n";
    let from_steel = says("ton-mm-s, from density and modulus");
    assert_eq!(units_of(&format!("*KEYWORD\n{steel}*END\n")), from_steel);
    assert_eq!(units_of("*KEYWORD\n*MAT_ELASTIC\n1, &RHO, x\n*END\n"), None);
}

#[test]
fn a_node_that_comes_twice_keeps_its_own_thickness() {
    let cards = [
        ("1,1,2,3", "0.7,0.7,0.8,0.9"),
        ("1,2,2,3", "0.7,0.8,0.8,0.9"),
        ("1,2,3,3", "0.7,0.8,0.9,0.9"),
        ("1,2,3,1", "0.7,0.8,0.9,0.7"),
    ];
    for (nodes, thickness) in cards {
        let model = read_text(format!(
            "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n*ELEMENT_SHELL_THICKNESS\n1,1,{nodes}\n{thickness}\n"
        ));
        assert_eq!(model.shells[0].nodes, [0, 1, 2, 2], "{nodes}");
        let found = model.shell_thickness(0).unwrap();
        assert_eq!(found[..3], [0.7, 0.8, 0.9], "{nodes}");
        assert!((found[3] - 0.8).abs() < 1e-15, "{nodes}");
    }
}

/// Parts and materials of plies may be parameters, whatever letters these have.
#[test]
fn parameters_stand_for_the_parts_and_materials_of_plies() {
    let nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,2,0,0\n6,2,1,0\n";
    for name in ["pid", "p", "part"] {
        let parameters =
            format!("*PARAMETER\nI{name:>9}         7I      mid         3R      thk      0.50\n");
        let field = format!("&{name}");
        let ply = "      &mid      &thk       0.0              &mid      0.25       0.0\n";
        let elements = format!(
            "*ELEMENT_SHELL_COMPOSITE\n       1{field:>8}       1       2       3       4\n{ply}{ply}\
             \x20      2{field:>8}       2       5       6       3\n{ply}"
        );
        let model = read_text(format!("{parameters}{nodes}{elements}"));
        let of_part = "undefined part";
        let faults = model
            .diagnostics
            .iter()
            .filter(|d| d.kind.label() != of_part);
        assert_eq!(faults.count(), 0, "{name}: {:?}", kinds(&model));
        let thickness = |shell| model.shell_thickness(shell).map(|corners| corners[0]);
        assert_eq!([thickness(0), thickness(1)], [Some(1.5), Some(0.75)]);
        assert_eq!(model.shell_plies(0).unwrap().1, [0.5, 0.25, 0.5, 0.25]);
        assert_eq!(model.parts[0].id, 7);

        let part = format!(
            "*PART_COMPOSITE\nplies\n{field:>10}         2\n{ply}second\n         8\n{ply}"
        );
        let shell = format!("*ELEMENT_SHELL\n       1{field:>8}       1       2       3       4\n");
        let model = read_text(format!("{parameters}{nodes}{part}{shell}"));
        assert_eq!(kinds(&model), [], "{name}");
        assert_eq!(model.shell_thickness(0), Some([0.75; 4]));
        let ids: Vec<u64> = model.parts.iter().map(|part| part.id).collect();
        assert_eq!(ids, [7, 8]);
    }
}

#[test]
fn a_negative_part_set_ends_a_range_of_sets() {
    let lists = "*SET_PART_LIST\n5\n50\n*SET_PART_LIST\n6\n60\n*SET_PART_LIST\n9\n90,91\n*SET_PART_LIST\n12\n120\n";
    let members = |cards: &str| {
        let model = read_text(format!("{lists}*SET_PART_ADD\n7\n{cards}\n"));
        let told: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
        let told = told.into_iter().filter(|told| told.contains("set"));
        (model.sets.parts[&7].ids.clone(), told.collect::<Vec<_>>())
    };
    assert_eq!(members("5,-9"), (vec![50, 60, 90, 91], vec![]));
    assert_eq!(members("12,5,-6"), (vec![120, 50, 60], vec![]));
    // A range goes on over the end of a card, and holds the set itself if its id is in it.
    assert_eq!(
        members("12,0,0,0,0,0,0,6\n-10"),
        (vec![120, 60, 90, 91], vec![])
    );
    // Ranges that overlap give each set once.
    assert_eq!(
        members("5,-9,6,-12,5,-7"),
        (vec![50, 60, 90, 91, 120], vec![])
    );
    let (ids, told) = members("-9");
    assert_eq!((ids, told.len()), (vec![], 1));
    assert!(told[0].contains("ends a range of sets"), "{told:?}");
    let (ids, told) = members("20,-30");
    assert_eq!(ids, Vec::<u64>::new());
    assert!(
        told.iter()
            .any(|told| told.contains("in which no set is defined")),
        "{told:?}"
    );
}

#[test]
fn an_intersection_has_the_members_of_the_first_set_that_are_in_all() {
    for (kind, key) in [("SHELL", "shell"), ("NODE", "node"), ("PART", "part")] {
        let lists = format!(
            "*SET_{kind}_LIST\n5\n4,3,2,1\n*SET_{kind}_LIST\n6\n1,2,4,9\n*SET_{kind}_LIST\n9\n7,4,1\n"
        );
        let read = |option: &str, card: &str| {
            let model = read_text(format!(
                "{lists}*SET_{kind}_{option}_TITLE\nname\n7\n{card}\n"
            ));
            let sets = match key {
                "shell" => &model.sets.shells,
                "node" => &model.sets.nodes,
                _ => &model.sets.parts,
            };
            let told = model.diagnostics.iter().map(ToString::to_string);
            let told = told.filter(|told| told.contains("set"));
            (sets[&7].ids.clone(), told.collect::<Vec<_>>())
        };
        assert_eq!(read("INTERSECT", "5,6,9"), (vec![4, 1], vec![]));
        assert_eq!(
            read("INTERSECT", "0,0,0,0,0,0,0,5\n6"),
            (vec![4, 2, 1], vec![])
        );
        let (ids, told) = read("INTERSECT", "5,8");
        assert_eq!((ids, told.len()), (vec![], 1));
        assert!(told[0].contains("names") && told[0].contains("set 8, which is not defined"));
        let (ids, told) = read("TREE", "5,6");
        assert_eq!((ids, told.len()), (vec![], 1));
        let named = format!("*SET_{kind}_TREE_TITLE is not carried out; the set has no members");
        assert!(
            told[0].contains(&named) && told[0].contains("TREE"),
            "{told:?}"
        );
    }
}

/// A corner of 0 has the thickness of the section.
#[test]
fn the_range_of_thicknesses_is_that_of_the_shells() {
    let section = "*PART\nsheet\n1,1\n*SECTION_SHELL\n1,2\n1.5\n";
    let shell = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n*ELEMENT_SHELL_THICKNESS\n1,1,1,2,3,4\n0.9,0.,1.1,1.\n";
    let range = |text: String| {
        let info = shapematch::report::FormingInfo::of(&read_text(text));
        (info.thickness, info.thickness_range)
    };
    assert_eq!(range(format!("{section}{shell}")), (1, Some([0.9, 1.5])));
    assert_eq!(range(shell.to_owned()), (1, Some([0.9, 1.1])));
}

#[test]
fn the_mark_that_ends_files_of_dos_is_no_card() {
    let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n*PART\nsheet\n1\n*ELEMENT_SHELL\n1,1,1,2,3";
    for end in [
        "",
        "\u{1a}",
        "\n\u{1a}",
        "\r\n\u{1a}\u{1a}\r\n",
        "\n*END\n\u{1a}",
        "\n*END\u{1a}",
    ] {
        let model = read_text(format!("{deck}{end}"));
        assert_eq!(kinds(&model), [], "{end:?}");
        assert_eq!(model.shells.len(), 1, "{end:?}");
    }
}

#[test]
fn units_in_a_comment_that_are_not_those_of_the_materials_are_told() {
    let told = |comment: &str| {
        let steel = "*MAT_024\n1,7.85E-9,2.1E5,0.3\n";
        let model = read_text(format!("*KEYWORD\n$ {comment}\n{steel}*END\n"));
        let found = model.diagnostics.iter();
        let mut found = found.filter(|d| d.kind == DiagnosticKind::OtherUnits);
        found.next().map(|d| d.message.clone())
    };
    for comment in ["units: ton, mm, s", "units mm", "no word of it"] {
        assert_eq!(told(comment), None, "{comment}");
    }
    for (comment, label) in [("units: kg, mm, ms", "kg-mm-ms"), ("units m", "m")] {
        let message = told(comment).unwrap();
        let both =
            format!("names {label}, density and modulus of the materials are those of ton-mm-s");
        assert!(message.contains(&both), "{message}");
    }
}

#[test]
fn materials_of_an_include_are_in_the_units_of_the_deck_around_it() {
    // Steel in kg-mm-ms with a comment that says so, in kg-m-s, and in ton-mm-s.
    let files = [
        ("7.85E-6,210.", "1e-3,1e-3,1."),
        ("7850.,2.1E11", "1e-3,1.,1e3"),
        ("7.85E-9,2.1E5", ""),
    ];
    for (steel, factors) in files {
        let part =
            format!("$ units: kg, mm, ms\n*MAT_024\n5,{steel},0.3\n*MAT_RIGID\n6,{steel},0.3\n");
        let part = if factors.is_empty() {
            part.replace("$ units: kg, mm, ms\n", "")
        } else {
            part
        };
        let main = format!("*KEYWORD\n*INCLUDE_TRANSFORM\npart.k\n0,0,0,10\n\n{factors}\n\n*END\n");
        let files = Memory::new().with("main.k", main).with("part.k", part);
        let model = read_files(&files);
        let known = model.stated_units.map(|known| known.words());
        let from_steel = "ton-mm-s, from density and modulus";
        assert_eq!(known.as_deref(), Some(from_steel), "{factors}");
        let found = model.materials.iter();
        let found = found.map(|material| (material.id, &*material.law, material.modulus.round()));
        let expected = [(15, "24", 2.1e5), (16, "20", 2.1e5)];
        assert_eq!(found.collect::<Vec<_>>(), expected, "{factors}");
    }
}

#[test]
fn lengths_of_a_transformation_are_in_the_unit_of_the_file_that_defines_it() {
    const SHEET: &str =
        "*NODE\n1,0,0,0\n2,10,0,0\n3,10,10,0\n4,0,10,0\n*ELEMENT_SHELL\n1,1,1,2,3,4\n";
    const BY_ONE: &str = "*DEFINE_TRANSFORMATION\n5\nTRANSL,1.\n";
    const SET: &str = "*SET_NODE_LIST\n3\n1,2,3,4\n";
    let included = |file: &str, factor: &str, id: &str| {
        format!("*INCLUDE_TRANSFORM\n{file}\n\n\n1.,1.,{factor}\n{id}\n")
    };
    let thousand = included("a.k", "1000.", "");
    let ways = [
        // Nodes are moved where all else is done, or at once.
        (
            thousand.clone(),
            format!("{BY_ONE}{SET}*NODE_TRANSFORM\n5,3\n{SHEET}"),
            String::new(),
        ),
        (
            thousand.clone(),
            format!("{BY_ONE}{SET}{SHEET}*NODE_TRANSFORM\n5,3,1\n"),
            String::new(),
        ),
        // An include below it is moved.
        (
            thousand.clone(),
            BY_ONE.to_owned() + &included("b.k", "1.", "5"),
            SHEET.to_owned(),
        ),
        // It is used beside the file.
        (
            thousand + &included("b.k", "1000.", "5"),
            BY_ONE.to_owned(),
            SHEET.to_owned(),
        ),
    ];
    for (main, a, b) in ways {
        let files = Memory::new()
            .with("main.k", main)
            .with("a.k", &*a)
            .with("b.k", b);
        let nodes = read_files(&files).nodes;
        let first = nodes.position_of(1).unwrap();
        let second = nodes.position_of(2).unwrap();
        assert_eq!([first.x, second.x], [1000.0, 11_000.0], "{a}");
    }
    let rows = "MIRROR,1.,,,2.\nROTATE,,,1.,1.,,,180.\nPOINT,1,1.\nPOINT,2,1.,1.\nPOINT,3,,1.\n\
                POINT,4,2.\nPOINT,5,2.,1.\nPOINT,6,1.,1.\nPOS6P,1,2,3,4,5,6\n";
    let move_in = |factor: f64| {
        let a = format!("*DEFINE_TRANSFORMATION\n5\n{rows}{SET}*NODE_TRANSFORM\n5,3\n{SHEET}");
        let main = included("a.k", &factor.to_string(), "");
        let model = read_files(&Memory::new().with("main.k", main).with("a.k", a));
        model.nodes.positions().to_vec()
    };
    for (small, large) in move_in(1.0).iter().zip(move_in(8.0)) {
        assert!((large - small * 8.0).norm() < 1e-9, "{small} {large}");
    }
}

#[test]
fn nodes_that_lie_off_the_mid_surface_are_told() {
    let deck = |rest: &str| {
        let nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n";
        read_text(format!("{nodes}*PART\nsheet\n1,1\n{rest}"))
    };
    let shell = "*ELEMENT_SHELL\n1,1,1,2,3,4\n";
    let cases = [
        (
            format!("{shell}*SECTION_SHELL\n1,16\n2.,2.,2.,2.,1\n"),
            "lie 1 off",
        ),
        (
            format!("{shell}*SECTION_SHELL\n1,16\n2.,2.,2.,2.,-0.5\n"),
            "lie 0.5 off",
        ),
        (
            "*ELEMENT_SHELL_THICKNESS_OFFSET\n1,1,1,2,3,4\n1.,1.,1.,1.\n-0.25\n".to_owned(),
            "1 shell lie up to 0.25 off",
        ),
        (
            format!("{shell}*PART_COMPOSITE\nlaminate\n2,16,,1\n3,0.5,,,3,0.5\n"),
            "lie 0.5 off",
        ),
    ];
    for (rest, told) in cases {
        let model = deck(&rest);
        let found = first(&model, DiagnosticKind::OffMidSurface);
        assert!(found.message.contains(told), "{}", found.message);
    }
    for rest in [
        format!("{shell}*SECTION_SHELL\n1,16\n2.,2.,2.,2.,0\n"),
        "*ELEMENT_SHELL_OFFSET\n1,1,1,2,3,4\n0.\n".to_owned(),
    ] {
        assert!(!kinds(&deck(&rest)).contains(&DiagnosticKind::OffMidSurface));
    }
}

/// Rows of ranges with steps, and of sets, beside a plain loop over all of them; ids of nodes with and without gaps.
#[test]
fn the_last_row_that_names_a_node_gives_its_thickness() {
    for gap in [1, 7] {
        let ids: Vec<u64> = (0..40).map(|k| 3 + gap * k).collect();
        let mut deck = "*NODE\n".to_owned();
        for (k, id) in ids.iter().enumerate() {
            deck += &format!("{id},{k}.,{}.,0.\n", k % 2);
        }
        deck += "*ELEMENT_SHELL\n";
        for (shell, nodes) in ids.windows(3).enumerate() {
            let [a, b, c] = nodes else { unreachable!() };
            deck += &format!("{},1,{a},{b},{c},{c}\n", shell + 1);
        }
        deck += &format!("*SET_NODE_LIST\n5\n{},{},{}\n", ids[4], ids[9], ids[33]);
        let mut expected = vec![0.0; ids.len()];
        for row in 0..24_u64 {
            let thickness = 1.0 + row as f64;
            if row % 8 == 3 {
                deck += &format!("*NODE_THICKNESS_SET\n5,{thickness}\n");
                [4, 9, 33]
                    .into_iter()
                    .for_each(|node| expected[node] = thickness);
                continue;
            }
            let step = [1, 2, 3, 7, 14, 40][row as usize % 6];
            let (first, last) = (1 + 11 * row % 97, 60 + 37 * row % 251);
            deck += &format!("*NODE_THICKNESS_GENERATE\n{first},{thickness},{last},{step}\n");
            for (id, expected) in ids.iter().zip(&mut expected) {
                let is_range = last > first;
                let is_named = (first..=last).contains(id) && (id - first).is_multiple_of(step);
                if *id == first || is_range && is_named {
                    *expected = thickness;
                }
            }
        }
        let model = read_text(deck + "*END\n");
        for (shell, expected) in expected.windows(3).enumerate() {
            let extra = model.shell_extra(shell as u32);
            let found = extra.map_or([0.0; 4], |extra| extra.thickness);
            assert_eq!(&found[..3], expected, "gap {gap}, shell {shell}");
        }
    }
}

#[test]
fn folders_of_includes_are_read_as_file_names_are() {
    let shell = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n*ELEMENT_SHELL\n1,1,1,2,3\n";
    for folder in ["sub\\deep", ".\\sub\\deep\\", "sub/&where", "sub\\&where"] {
        let main = format!(
            "*PARAMETER\nC where,deep\n*INCLUDE_PATH_RELATIVE\n{folder}\n*INCLUDE\nmesh.k\n*END\n"
        );
        let files = Memory::new()
            .with("main.k", main)
            .with("sub/deep/mesh.k", shell);
        let model = read_files(&files);
        let found: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(model.shells.len(), 1, "{folder}: {found:?}");
    }
}

#[cfg(unix)]
#[test]
fn an_include_that_is_no_file_is_named_for_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("folder")).unwrap();
    std::os::unix::fs::symlink("b", at("a")).unwrap();
    std::os::unix::fs::symlink("a", at("b")).unwrap();
    for (name, told) in [
        ("folder", "is a folder"),
        ("a", "is a link that leads nowhere"),
        ("/dev/null", "is a pipe or a device"),
        ("nowhere.k", "is not found"),
    ] {
        std::fs::write(at("main.k"), format!("*KEYWORD\n*INCLUDE\n{name}\n*END\n")).unwrap();
        let model = try_read(&Disk, at("main.k").to_str().unwrap()).unwrap();
        let found = first(&model, DiagnosticKind::MissingInclude);
        assert!(found.message.contains(told), "{}", found.message);
    }
}

#[test]
fn plastic_strains_of_shells_that_are_elsewhere_are_not_counted() {
    let state = |id: u64, strain: f64| format!("{id},1,1\n0.,1.,1.,1.,1.,1.,1.,{strain}\n");
    let states = format!(
        "*INITIAL_STRESS_SHELL\n{}{}",
        state(1, 0.25),
        state(99, 7.0)
    );
    let mesh = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n*ELEMENT_SHELL\n1,1,1,2,3\n";
    let range = |deck: String| ModelInfo::of(&read_text(deck)).forming.plastic_strain_range;
    assert_eq!(range(mesh.to_owned() + &states), Some([0.25, 0.25]));
    // A file of states alone has them for shells of another.
    assert_eq!(range(states), Some([0.25, 7.0]));
}

#[test]
fn numbers_with_one_tab_between_them_are_read_one_by_one() {
    let by_commas = "*KEYWORD\n*NODE\n12345678,0.,0.,0.\n2,10.5,-.25,1.E-3\n3,-682.94918123456789,10.,1234567.8\n\
         *ELEMENT_SHELL_THICKNESS\n12345679,7,12345678,2,3,3\n1.5,1.25,1.,1.\n*END\n";
    let tabs = by_commas.replace(',', "\t");
    let [by_commas, by_tabs] = [by_commas.to_owned(), tabs]
        .map(|deck| read_files(&Memory::new().with("main.k", deck.into_bytes())));
    assert_eq!(by_tabs.nodes, by_commas.nodes);
    assert_eq!(by_tabs.shells, by_commas.shells);
    assert_eq!(by_tabs.shell_extras, by_commas.shell_extras);
    assert_eq!(by_tabs.diagnostics.count(DiagnosticKind::Tabs), 1);
    assert_eq!(by_tabs.diagnostics.n_geometry_errors(), 0);
}
