//! Names of files, with as much of the folder as distinguishes those of the same name.

use std::path::{Path, PathBuf};

/// Name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Name of a file, after as much of its folder as tells it from others of that name: cut at its end, it is still told
/// apart.
pub fn told_apart<'a>(path: &Path, all: impl Iterator<Item = &'a Path>) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    let folder = path.parent().unwrap_or(Path::new(""));
    let same_name = all.filter(|other| *other != path);
    let same_name = same_name.filter(|other| other.file_name() == path.file_name());
    let others: Vec<&Path> = same_name.filter_map(|other| other.parent()).collect();
    if others.is_empty() {
        return file_name(path);
    }
    let n_folders = folder.components().count();
    let end_of = |folder: &Path, n: usize| -> PathBuf {
        let skip = folder.components().count().saturating_sub(n);
        folder.components().skip(skip).collect()
    };
    let is_own = |n: &usize| {
        others
            .iter()
            .all(|other| end_of(other, *n) != end_of(folder, *n))
    };
    let n = (1..=n_folders).find(is_own).unwrap_or(n_folders);
    let folder = end_of(folder, n);
    // A file named from the folder that the program runs in.
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        &folder
    };
    folder.join(name).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the separator of this system.
    fn as_here(path: &str) -> String {
        path.replace('/', std::path::MAIN_SEPARATOR_STR)
    }

    #[test]
    fn files_of_one_name_have_their_folder() {
        let paths = ["/a/b/part.k", "/a/c/part.k", "/a/b/other.k"].map(Path::new);
        let told = paths.map(|path| told_apart(path, paths.into_iter()));
        let expected = ["b/part.k", "c/part.k", "other.k"].map(as_here);
        assert_eq!(told, expected);
        let paths = ["part.k", "/a/part.k"].map(Path::new);
        let told = paths.map(|path| told_apart(path, paths.into_iter()));
        assert_eq!(told, ["./part.k", "a/part.k"].map(as_here));
    }
}
