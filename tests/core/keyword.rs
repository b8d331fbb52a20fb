//! Hand-made decks and their dumps: every row of the format's tables is a small deck in
//! `tests/data/keyword`, each with what must be read from it beside it (`UPDATE_EXPECT=1`
//! rewrites the dumps).

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use shapematch::formats::{
    self, Diagnostic, DiagnosticKind, Disk, FileSource, FormatError, Memory, Model, ReadOptions,
    Selection, source::Bytes,
};
use shapematch::monitor::Monitor;

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
    fn open(&self, path: &Path) -> std::io::Result<Bytes> {
        Disk.open(&data_folder().join(path))
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        let found = Disk.find(&data_folder().join(path))?;
        Some(found.strip_prefix(data_folder()).unwrap().to_path_buf())
    }
}

pub fn read_text(text: impl Into<Vec<u8>>) -> Model {
    read_files(Memory::new().with("main.k", text))
}

fn read_files(files: Memory) -> Model {
    try_read(&files, "main.k").unwrap()
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
    for stress in model.forming.stresses() {
        writeln!(text, "stress {stress:?}").unwrap();
    }
    for strain in model.forming.strains() {
        writeln!(text, "strain {strain:?}").unwrap();
    }
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
