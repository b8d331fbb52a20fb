//! Holds the table "who may use whom" of ARCHITECTURE.md and fails when a `crate::` path breaks it.

use std::path::{Path, PathBuf};

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

/// Each module with the modules it may use besides itself, as the table of ARCHITECTURE.md says. Everything
/// else is forbidden.
fn may_use() -> Vec<(String, Vec<String>)> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (_, table) = page.split_once("| module | may use |").unwrap();
    let quoted = |cell: &str| -> Vec<String> {
        let words = cell.split('`').skip(1).step_by(2);
        words.map(str::to_owned).collect()
    };
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for line in table.lines().skip(2).take_while(|line| !line.is_empty()) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
        let [modules, allowed] = cells[..] else {
            panic!("{line} has not two cells");
        };
        let above: Vec<String> = rows.iter().map(|(name, _)| name.clone()).collect();
        let allowed = match allowed.trim() {
            "nothing of ours" => Vec::new(),
            "every row above" => above,
            names => {
                let names = quoted(names);
                for name in &names {
                    assert!(above.contains(name), "{name} stands below its user: {line}");
                }
                names
            }
        };
        let modules = quoted(modules);
        assert!(!modules.is_empty(), "{line} names no module");
        rows.extend(modules.into_iter().map(|module| (module, allowed.clone())));
    }
    rows
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
    let may_use = may_use();
    let mut broken = Vec::new();
    for path in rust_files(&source_root()) {
        let module = module_of(&path);
        if ["lib", "main"].contains(&module.as_str()) {
            continue;
        }
        let row = may_use.iter().find(|(name, _)| *name == module);
        let (_, allowed) = row.unwrap_or_else(|| panic!("ARCHITECTURE.md has no row for {module}"));
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap();
            for used in crate_paths(code) {
                let known = may_use.iter().any(|(name, _)| *name == used);
                if known && used != module && !allowed.contains(&used) {
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
fn every_row_is_a_module() {
    let rows = may_use();
    assert!(rows.len() > 15, "{rows:?}");
    for (module, _) in rows {
        let root = source_root();
        let is_there = root.join(&module).is_dir() || root.join(format!("{module}.rs")).is_file();
        assert!(
            is_there,
            "ARCHITECTURE.md has a row for {module}, src has none"
        );
    }
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
