//! Whether files can be written, asked before any work begins.

use std::fs;
use std::path::{Path, PathBuf};

use super::deck::format_of;
use crate::formats::Format;
use crate::pipeline::write_file::{folder_of, followed, new_file_in};
use crate::report::cards::file_name_fault;

/// What a file is meant to hold, as far as its name is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Text for people or programs; any name will do but that of a packed file.
    Text,
    /// A deck, which other decks include by its name.
    Deck,
    /// A deck or a mesh; the extension of the name chooses.
    Mesh,
}

/// A file that is to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    /// What messages call it: `--moved`.
    pub name: String,
    /// Where it goes.
    pub path: PathBuf,
    /// What it holds.
    pub content: Content,
}

/// Why a file cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// It is one of the files that are read.
    #[error("{name} would overwrite {input:?}, which is read{}", elsewhere(.path, .input))]
    OverwritesInput {
        /// Name of the output.
        name: String,
        /// Where it was to go.
        path: PathBuf,
        /// The file that is read.
        input: PathBuf,
    },
    /// Two outputs go to one file.
    #[error("{name} and {other} name the same file: {path:?}")]
    SameFile {
        /// Name of the output.
        name: String,
        /// Another one, named before it.
        other: String,
        /// Where both were to go.
        path: PathBuf,
    },
    /// The extension chooses the format, and this one names none.
    #[error("{name} needs a name that ends in .k, .dynain, .stl, .ply or .obj: {path:?}")]
    Extension {
        /// Name of the output.
        name: String,
        /// Where it was to go.
        path: PathBuf,
    },
    /// The name is that of a file in another format.
    #[error(
        "{name} is written as a keyword file; give it a name that ends in .k, not in that of another format: {path:?}"
    )]
    OtherFormat {
        /// Name of the output.
        name: String,
        /// Where it was to go.
        path: PathBuf,
    },
    /// The name is that of a packed file.
    #[error("{name} is not written packed; give it a name without .gz: {path:?}")]
    Packed {
        /// Name of the output.
        name: String,
        /// Where it was to go.
        path: PathBuf,
    },
    /// No deck could include a file of this name.
    #[error("{name}: no deck can include a file whose name {fault}: {path:?}")]
    DeckName {
        /// Name of the output.
        name: String,
        /// Where it was to go.
        path: PathBuf,
        /// What is wrong with the name.
        fault: &'static str,
    },
    /// Nothing can be written there.
    #[error("{name} cannot be written ({reason}): {path:?}")]
    NotWritable {
        /// Name of the output.
        name: String,
        /// Where it was to go.
        path: PathBuf,
        /// Why it cannot be written.
        reason: String,
    },
}

/// Looks for every reason why these files could not be written or would destroy one of the files
/// that are read. Files count as the same by what they are, not by their names, also through
/// links. Makes and removes an empty file in each folder.
pub fn check_targets(targets: &[Target], inputs: &[PathBuf]) -> Vec<Refusal> {
    let mut refusals = overwritten_inputs(targets, inputs);
    for (index, target) in targets.iter().enumerate() {
        let same = |other: &&Target| is_same_file(&other.path, &target.path);
        if let Some(other) = targets[..index].iter().find(same) {
            refusals.push(Refusal::SameFile {
                name: target.name.clone(),
                other: other.name.clone(),
                path: target.path.clone(),
            });
        }
        refusals.extend(name_fault(target));
        refusals.extend(unwritable(&target.path).map(|reason| Refusal::NotWritable {
            name: target.name.clone(),
            path: target.path.clone(),
            reason,
        }));
    }
    refusals
}

/// Where an output was to go, if another name of the file was given.
fn elsewhere(path: &Path, input: &Path) -> String {
    if path == input {
        String::new()
    } else {
        format!(": {path:?}")
    }
}

/// The files among `inputs` that would be overwritten.
pub fn overwritten_inputs(targets: &[Target], inputs: &[PathBuf]) -> Vec<Refusal> {
    let overwritten = |target: &Target| {
        let input = inputs
            .iter()
            .find(|input| is_same_file(input, &target.path))?;
        Some(Refusal::OverwritesInput {
            name: target.name.clone(),
            path: target.path.clone(),
            input: input.clone(),
        })
    };
    targets.iter().filter_map(overwritten).collect()
}

fn name_fault(target: &Target) -> Option<Refusal> {
    let (name, path) = (target.name.clone(), target.path.clone());
    let is_packed = path
        .extension()
        .is_some_and(|of| of.eq_ignore_ascii_case("gz"));
    let is_deck = match target.content {
        Content::Text => return is_packed.then_some(Refusal::Packed { name, path }),
        Content::Deck if Format::of_name(&path).is_some_and(|of| of != Format::Keyword) => {
            return Some(Refusal::OtherFormat { name, path });
        }
        Content::Deck => true,
        Content::Mesh => match format_of(&path) {
            Ok(format) => format == Format::Keyword,
            Err(_) => return Some(Refusal::Extension { name, path }),
        },
    };
    let file_name = path.file_name()?;
    if is_deck && is_packed {
        return Some(Refusal::OtherFormat { name, path });
    }
    let fault = file_name_fault(&file_name.to_string_lossy()).filter(|_| is_deck)?;
    Some(Refusal::DeckName { name, path, fault })
}

/// Why no file can be written there, in words.
fn unwritable(path: &Path) -> Option<String> {
    // A device or a pipe, which may have no name behind its links.
    if fs::metadata(path).is_ok_and(|old| !old.is_file() && !old.is_dir()) {
        return None;
    }
    let path = match followed(path) {
        Ok(path) => path,
        Err(error) => return Some(error.to_string()),
    };
    if let Ok(old) = fs::metadata(&path) {
        if old.is_dir() {
            return Some("it is a folder".to_owned());
        }
        if old.permissions().readonly() {
            return Some("it is read-only".to_owned());
        }
    }
    let folder = folder_of(&path);
    if !folder.is_dir() {
        return Some("its folder does not exist".to_owned());
    }
    let probe = new_file_in(folder).err()?;
    Some(format!("its folder takes no new file: {probe}"))
}

/// True if both paths lead to one file, or would if it were there.
fn is_same_file(a: &Path, b: &Path) -> bool {
    let is_file = |path: &Path| fs::metadata(path).map(|metadata| metadata.is_file());
    match (is_file(a), is_file(b)) {
        (Ok(true), Ok(true)) => same_file::is_same_file(a, b).unwrap_or(false),
        (Err(_), Err(_)) => match (place(a), place(b)) {
            (Some(a), Some(b)) if cfg!(any(windows, target_os = "macos")) => {
                a.to_string_lossy().to_lowercase() == b.to_string_lossy().to_lowercase()
            }
            (a, b) => a.is_some() && a == b,
        },
        // A device has no content that could be lost, and what is not there is no file that is.
        _ => false,
    }
}

/// Where a file would come to lie that is not there yet.
fn place(path: &Path) -> Option<PathBuf> {
    let path = followed(path).ok()?;
    let folder = fs::canonicalize(folder_of(&path)).ok()?;
    Some(folder.join(path.file_name()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(name: &str, path: PathBuf, content: Content) -> Target {
        Target {
            name: name.to_owned(),
            path,
            content,
        }
    }

    fn refusals(targets: &[Target], inputs: &[PathBuf]) -> Vec<String> {
        let refusals = check_targets(targets, inputs);
        refusals.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn files_are_the_same_whatever_leads_to_them() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("deep")).unwrap();
        fs::write(at("a.k"), b"").unwrap();
        fs::hard_link(at("a.k"), at("b.k")).unwrap();
        for path in [at("a.k"), at("deep/../a.k"), at("b.k")] {
            let found = refusals(&[target("--moved", path, Content::Mesh)], &[at("a.k")]);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].starts_with("--moved would overwrite"), "{found:?}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("a.k", at("link.k")).unwrap();
            let link = [target("--moved", at("link.k"), Content::Mesh)];
            assert_eq!(refusals(&link, &[at("a.k")]).len(), 1);
        }
        let other = [target("--moved", at("c.k"), Content::Mesh)];
        assert_eq!(refusals(&other, &[at("a.k"), at("gone.k")]), [""; 0]);
    }

    #[test]
    fn two_outputs_need_two_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("deep")).unwrap();
        let targets = [
            target("--json", at("r.json"), Content::Text),
            target("--matrix", at("deep/../r.json"), Content::Text),
        ];
        let found = refusals(&targets, &[]);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("--matrix and --json"), "{found:?}");
        #[cfg(unix)]
        {
            let null = |name| target(name, "/dev/null".into(), Content::Text);
            assert_eq!(refusals(&[null("--json"), null("--matrix")], &[]), [""; 0]);
        }
    }

    #[test]
    fn names_and_folders_are_looked_at() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("locked.k"), b"").unwrap();
        let mut permissions = fs::metadata(at("locked.k")).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(at("locked.k"), permissions).unwrap();
        let cases = [
            ("locked.k", Content::Mesh, "read-only"),
            ("nowhere/a.k", Content::Mesh, "folder does not exist"),
            ("", Content::Text, "is a folder"),
            ("a.xyz", Content::Mesh, "ends in .k"),
            ("a.k.gz", Content::Mesh, "ends in .k"),
            ("a.json.gz", Content::Text, "without .gz"),
            ("$a.k", Content::Deck, "begins with $"),
            ("*a.k", Content::Mesh, "begins with *"),
        ];
        for (name, content, words) in cases {
            let found = refusals(&[target("it", at(name), content)], &[]);
            assert_eq!(found.len(), 1, "{name}: {found:?}");
            assert!(found[0].contains(words), "{name}: {found:?}");
        }
        assert_eq!(
            refusals(&[target("it", at("$a.stl"), Content::Mesh)], &[]),
            [""; 0]
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
