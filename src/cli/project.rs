//! Projects on the command line: the match of one is run again, or it is described.

use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;

use super::recipe::Asked;
use super::text::{count, short};
use super::{print, takes_stdout, write_json};
use crate::formats::{Disk, FileHash};
use crate::monitor::Monitor;
use crate::pipeline::load::{LoadedPart, load, load_bundled};
pub use crate::pipeline::project::EXTENSION;
use crate::pipeline::project::{PartEntry, Project};

/// True if a path is that of a project.
pub fn is_project(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy());
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case(EXTENSION))
}

/// Reads a project and its parts, and what its match is to be run with.
pub fn open(path: &Path, monitor: &Monitor) -> anyhow::Result<(Asked, LoadedPart, LoadedPart)> {
    let project = read(path)?;
    let (Some(crash), Some(stamped)) = (&project.crash, &project.stamped) else {
        anyhow::bail!(
            "the project has only one of the two parts: {}",
            path.display()
        );
    };
    let asked = Asked {
        crash: crash.load_settings(),
        stamped: stamped.load_settings(),
        recipe: project.recipe.clone(),
        max_triangles: match [crash.max_triangles, stamped.max_triangles] {
            // Nothing was reduced by hand: the recipe says what to do.
            [None, None] => [project.recipe.max_triangles; 2],
            levels => levels,
        },
        current: project.pose,
    };
    let load = |entry, starts| load_part(path, entry, starts, monitor);
    let (crash, stamped) = rayon::join(|| load(crash, "crash"), || load(stamped, "stamped"));
    Ok((asked, crash?, stamped?))
}

fn read(path: &Path) -> anyhow::Result<Project> {
    let (project, notes) = Project::read(path)?;
    for note in notes {
        log::warn!("{}: {note}", path.display());
    }
    Ok(project)
}

fn load_part(
    project: &Path,
    entry: &PartEntry,
    starts: &str,
    monitor: &Monitor,
) -> anyhow::Result<LoadedPart> {
    let settings = entry.load_settings();
    let Some(file) = &entry.file else {
        return Ok(load_bundled(starts, &settings, monitor)?);
    };
    let Some(found) = entry.locate(project) else {
        anyhow::bail!("a file of the project is neither where it was nor beside it: {file:?}");
    };
    let part = load(&found, &settings, monitor)?;
    if entry.has_changed(&part) {
        log::warn!("the file has changed since the project was saved: {found:?}");
    }
    Ok(part)
}

/// Tells what a project holds.
pub fn info(path: &Path, json: Option<&Path>) -> anyhow::Result<ExitCode> {
    let project = read(path)?;
    if !takes_stdout(json) {
        print(&describe(&project, path))?;
    }
    if let Some(json) = json {
        let text = project.to_text(path);
        write_json(json, &serde_json::from_str::<serde_json::Value>(&text)?)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn describe(project: &Project, path: &Path) -> String {
    let mut text = format!("Project  {}\n", path.display());
    // Writing to a string cannot fail.
    let _ = writeln!(text, "Saved by {}", project.program);
    for (role, entry) in ["Crash", "Stamped"].into_iter().zip(project.parts()) {
        if let Some(entry) = entry {
            let _ = writeln!(text, "{role:<8} {}", describe_part(entry, path));
        }
    }
    let pose = &project.pose;
    let [x, y, z] = [0, 1, 2].map(|axis| short(pose.translation[axis]));
    let angle = pose.angle_to(&crate::geometry::Similarity::identity());
    let _ = writeln!(
        text,
        "Pose     turned by {}°, moved by ({x}, {y}, {z})",
        short(angle.to_degrees())
    );
    let method = project.recipe.settings.method.label();
    let _ = writeln!(text, "Method   {method}");
    let _ = match &project.result {
        None => writeln!(text, "Result   none"),
        Some(result) => {
            let assessment = &result.run.assessment;
            let age = if result.is_current {
                ""
            } else {
                ", out of date"
            };
            writeln!(
                text,
                "Result   {}{age}: overlap {:.1} %, rms {}",
                assessment.verdict.label(),
                100.0 * assessment.coverage.better_overlap(),
                short(assessment.coverage.rmse())
            )
        }
    };
    text
}

fn describe_part(entry: &PartEntry, project: &Path) -> String {
    let Some(file) = &entry.file else {
        return "the example that comes with the program".to_owned();
    };
    let mut text = format!("{}, {} triangles", file.display(), count(entry.triangles));
    if let Some(n) = entry.max_triangles {
        let _ = write!(text, " reduced to {}", count(n));
    }
    if let Some(units) = entry.units {
        let _ = write!(text, ", in {}", units.label());
    }
    if entry.length_factor != 1.0 {
        let _ = write!(text, ", lengths × {}", entry.length_factor);
    }
    let state = match entry.locate(project) {
        None => "not found",
        Some(found) => match FileHash::of_file(&Disk, &found, &Monitor::silent()) {
            Ok(hash) if Some(hash) == entry.hash => "unchanged",
            Ok(_) => "changed since",
            Err(_) => "not readable",
        },
    };
    let _ = write!(text, " ({state})");
    text
}
