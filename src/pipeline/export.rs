//! Writing results to disk.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::PipelineError;
use super::load::LoadedPart;
use super::units::PairUnits;
use crate::formats::keyword::write::{WriteOptions, write};
use crate::formats::moved::moved;
use crate::formats::{Format, Model, obj, ply, stl};
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::report::build_id;
use crate::samples::SampleFile;

/// Writes bytes to a file.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    fs::write(path, bytes).map_err(|error| PipelineError::Write {
        path: path.to_path_buf(),
        reason: error.to_string(),
    })
}

/// Writes beside the file and renames, so that a crash leaves either the old or the new one whole.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    let failed = |error: std::io::Error| PipelineError::Write {
        path: path.to_path_buf(),
        reason: error.to_string(),
    };
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    let beside = path.with_file_name(name);
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder.map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    let write = || {
        let mut file = fs::File::create(&beside)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&beside, path)
    };
    write().map_err(|error| {
        // What is left of the attempt helps no one.
        let _ = fs::remove_file(&beside);
        failed(error)
    })
}

/// Writes a mesh; the ending of the path chooses the format.
pub fn write_mesh(
    path: &Path,
    mesh: &TriMesh,
    title: &str,
    monitor: &Monitor,
) -> Result<(), PipelineError> {
    let bytes = match format_of(path)? {
        Format::Keyword => write(
            &Model::from_mesh(mesh, title),
            &WriteOptions::default(),
            monitor,
        )?,
        Format::Stl => stl::write_binary(mesh),
        Format::Obj => obj::write(mesh, title),
        Format::Ply => ply::write(mesh, title),
    };
    write_bytes(path, &bytes)
}

/// Writes the stamped model moved onto the crash part, with its own ids. The unit factor of the
/// part is applied as well, so the file is in the crash model's unit. Mesh formats without ids get
/// the matched surface only.
pub fn write_moved(
    path: &Path,
    stamped: &LoadedPart,
    crash_from_stamped: &Similarity,
    comments: &[String],
    monitor: &Monitor,
) -> Result<(), PipelineError> {
    if format_of(path)? != Format::Keyword {
        let mesh = stamped.mesh.transformed(crash_from_stamped);
        let title = comments.join(", ");
        return write_mesh(path, &mesh, &title, monitor);
    }
    let unit = Similarity::from_scale(stamped.settings.length_factor);
    let model = moved(&stamped.model, &crash_from_stamped.after(&unit));
    let options = WriteOptions {
        comments: comments.to_vec(),
        ..WriteOptions::default()
    };
    write_bytes(path, &write(&model, &options, monitor)?)
}

/// What the head of a written deck says: where it comes from, units, build.
pub fn head_lines(part: &LoadedPart, other: Option<&LoadedPart>) -> Vec<String> {
    let factor = part.settings.length_factor;
    let mut lines = vec![format!("made from {}", part.file_name())];
    let units = PairUnits::of(other, Some(part));
    lines.push(match units.lengths {
        Some(unit) => format!("lengths in {unit}"),
        None => "unit of lengths unknown".to_owned(),
    });
    if factor != 1.0 {
        lines.push(format!(
            "lengths and thicknesses were multiplied by {factor}; stresses keep their unit"
        ));
    }
    lines.push(build_id());
    lines
}

/// The format that the ending names; unlike in reading, no ending is no format.
fn format_of(path: &Path) -> Result<Format, PipelineError> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_lowercase());
    let of_ending = |format: &&Format| {
        let packed = "gz";
        ending
            .as_deref()
            .is_some_and(|e| e != packed && format.extensions().contains(&e))
    };
    let found = Format::ALL.iter().find(of_ending).copied();
    found.ok_or_else(|| PipelineError::UnknownEnding(path.to_path_buf()))
}

/// Writes the files of a sample into a folder, which is made if it does not exist. Returns their
/// paths.
pub fn write_sample(folder: &Path, files: &[SampleFile]) -> Result<Vec<PathBuf>, PipelineError> {
    fs::create_dir_all(folder).map_err(|error| PipelineError::Write {
        path: folder.to_path_buf(),
        reason: error.to_string(),
    })?;
    let mut paths = Vec::new();
    for file in files {
        let path = folder.join(file.name);
        write_bytes(&path, &file.bytes)?;
        paths.push(path);
    }
    Ok(paths)
}
