//! Holds the table "who may use whom" of ARCHITECTURE.md and fails when a `crate::` path breaks it.

use std::path::{Path, PathBuf};

/// Each module with the modules it may use besides itself. Everything else is forbidden.
const MAY_USE: &[(&str, &str)] = &[
    ("monitor", ""),
    ("role", ""),
    ("colormap", ""),
    ("units", ""),
    ("text", "units"),
    ("palette", "colormap role"),
    ("geometry", "monitor"),
    ("formats", "geometry monitor units"),
    ("simplify", "geometry monitor"),
    ("search", "geometry monitor"),
    ("samples", "formats geometry monitor"),
    ("registration", "search geometry monitor"),
    ("mapping", "search geometry monitor"),
    ("assess", "registration search geometry monitor text units"),
    (
        "settings",
        "registration search geometry monitor text units",
    ),
    (
        "report",
        "settings assess mapping registration formats geometry colormap role text units",
    ),
    (
        "pipeline",
        "report settings assess mapping registration samples search simplify formats geometry colormap \
         monitor palette role text units",
    ),
    (
        "jobs",
        "pipeline report settings assess mapping registration samples search simplify formats geometry \
         colormap monitor palette role text units",
    ),
    (
        "app",
        "jobs pipeline report settings assess mapping registration samples search simplify formats \
         geometry colormap monitor palette role text units",
    ),
    (
        "cli",
        "pipeline report settings assess mapping registration samples search simplify formats geometry \
         colormap monitor palette role text units",
    ),
    ("render", "geometry colormap monitor palette"),
    (
        "ui",
        "render app jobs pipeline report settings assess mapping registration samples search simplify \
         formats geometry colormap monitor palette role text units",
    ),
];

/// Modules above the UI boundary, the only ones that may name egui, eframe or wgpu.
const ABOVE_THE_BOUNDARY: &[&str] = &["ui", "render"];

pub fn rust_files(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut todo = vec![root.to_path_buf()];
    while let Some(folder) = todo.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                todo.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

pub fn source_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The module of the first floor a file belongs to: `src/ui/shell.rs` → `ui`.
fn module_of(path: &Path) -> String {
    let relative = path.strip_prefix(source_root()).unwrap();
    let first = relative.iter().next().unwrap().to_str().unwrap();
    first.trim_end_matches(".rs").to_owned()
}

/// Names that follow `crate::` in a line, with groups `crate::{a, b}` taken apart.
fn crate_paths(line: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        text.chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    let mut names = Vec::new();
    for rest in line.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            Some(group) => names.extend(group.split(',').map(|part| name(part.trim()))),
            None => names.push(name(rest)),
        }
    }
    names.retain(|n| !n.is_empty());
    names
}

#[test]
fn modules_look_down_only() {
    let mut broken = Vec::new();
    for path in rust_files(&source_root()) {
        let module = module_of(&path);
        if ["lib", "main"].contains(&module.as_str()) {
            continue;
        }
        let row = MAY_USE.iter().find(|(name, _)| *name == module);
        let (_, allowed) = row.unwrap_or_else(|| panic!("module {module} has no row in MAY_USE"));
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap();
            for used in crate_paths(code) {
                let known = MAY_USE.iter().any(|(name, _)| *name == used);
                if known && used != module && !allowed.split(' ').any(|name| name == used) {
                    let line = number + 1;
                    broken.push(format!("{}:{line}: {module} uses {used}", path.display()));
                }
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn nothing_below_the_ui_boundary_knows_the_window() {
    let mut broken = Vec::new();
    for path in rust_files(&source_root()) {
        let module = module_of(&path);
        if ABOVE_THE_BOUNDARY.contains(&module.as_str()) || module == "main" {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap();
            if ["egui", "eframe", "wgpu"]
                .iter()
                .any(|name| code.contains(&format!("{name}::")))
            {
                broken.push(format!("{}:{}: {line}", path.display(), number + 1));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn the_reader_of_use_lines_sees_groups() {
    assert_eq!(
        crate_paths("use crate::{search::Bvh, geometry::TriMesh};"),
        ["search", "geometry"]
    );
    assert_eq!(
        crate_paths("let x: crate::ui::Shell = crate::app::f();"),
        ["ui", "app"]
    );
}
