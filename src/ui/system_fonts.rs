//! Glyphs that the fonts of the program lack, Chinese, Japanese and Korean ones above all, come from a font of the
//! system, where there is one.

use std::path::{Path, PathBuf};

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{FontData, FontFamily};

use super::background::run_once;

/// A larger file is no font that is worth its memory.
const MAX_BYTES: u64 = 64 << 20;
/// Folders in folders that are looked into.
const MAX_DEPTH: usize = 5;

/// Fonts that have the glyphs, the best first; together the fonts of a row have all.
#[cfg(target_os = "windows")]
const FONTS: &[&[&str]] = &[&["msyh.ttc", "malgun.ttf"], &["simsun.ttc"]];
#[cfg(target_os = "macos")]
const FONTS: &[&[&str]] = &[
    &["Hiragino Sans GB.ttc", "AppleSDGothicNeo.ttc"],
    &["Arial Unicode.ttf"],
];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const FONTS: &[&[&str]] = &[
    &["NotoSansCJK-Regular.ttc"],
    &["NotoSansCJKsc-Regular.otf"],
    &["wqy-microhei.ttc"],
    &["wqy-zenhei.ttc"],
    &["DroidSansFallbackFull.ttf"],
    &["DroidSansFallback.ttf"],
    &["NotoSansCJK-VF.ttc"],
];

/// Reads the fonts on a thread of its own; text is drawn with them as soon as they are there. They come last, so
/// what could be drawn before looks as it did.
pub(super) fn add(ctx: &egui::Context) {
    let ctx = ctx.clone();
    // Without a thread such glyphs stay boxes.
    run_once("fonts", move || {
        for (name, bytes) in read() {
            let families = [FontFamily::Proportional, FontFamily::Monospace];
            let families = families.map(|family| InsertFontFamily {
                family,
                priority: FontPriority::Lowest,
            });
            let font = FontInsert::new(&name, FontData::from_owned(bytes), families.to_vec());
            ctx.add_font(font);
        }
        ctx.request_repaint();
    });
}

/// Names and bytes of the fonts that are taken.
fn read() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for folder in folders() {
        list(&folder, MAX_DEPTH, &mut files);
    }
    let read = |path: PathBuf| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let is_small = std::fs::metadata(&path).ok()?.len() <= MAX_BYTES;
        Some((name, is_small.then(|| std::fs::read(&path).ok())??))
    };
    chosen(&files).into_iter().filter_map(read).collect()
}

/// The files of the first row of [`FONTS`] of which there is one.
fn chosen(files: &[PathBuf]) -> Vec<PathBuf> {
    let find = |name: &&str| files.iter().find(|file| file.ends_with(name)).cloned();
    let rows = FONTS
        .iter()
        .map(|row| row.iter().filter_map(find).collect::<Vec<_>>());
    let mut rows = rows.filter(|row| !row.is_empty());
    rows.next().unwrap_or_default()
}

fn list(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            if depth > 0 {
                list(&path, depth - 1, files);
            }
        } else {
            files.push(path);
        }
    }
}

/// Where the system keeps its fonts.
fn folders() -> Vec<PathBuf> {
    let home = directories::BaseDirs::new();
    let own = |path: &str| home.as_ref().map(|home| home.home_dir().join(path));
    let all = if cfg!(target_os = "windows") {
        let windows =
            std::env::var_os("WINDIR").map(|windows| PathBuf::from(windows).join("Fonts"));
        vec![windows]
    } else if cfg!(target_os = "macos") {
        let system = ["/System/Library/Fonts", "/Library/Fonts"];
        system.map(|path| Some(PathBuf::from(path))).to_vec()
    } else {
        let [system, local] = ["/usr/share/fonts", "/usr/local/share/fonts"];
        vec![
            Some(PathBuf::from(system)),
            Some(PathBuf::from(local)),
            own(".local/share/fonts"),
            own(".fonts"),
        ]
    };
    all.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_that_is_there_is_taken() {
        let at = |name: &str| PathBuf::from("/fonts").join(name);
        assert_eq!(chosen(&[at("Other.ttf")]), Vec::<PathBuf>::new());
        for row in FONTS {
            let there: Vec<PathBuf> = row.iter().map(|name| at(name)).collect();
            assert_eq!(chosen(&there), there);
        }
        let last = FONTS.last().unwrap()[0];
        let first = FONTS[0][0];
        assert_eq!(chosen(&[at(last), at(first)]), [at(first)]);
    }
}
