//! Projects on the command line: the match of one is run again, or it is described.

use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;

use super::recipe::Asked;
use super::{check_outputs, json_target, print, takes_stdout, write_json};
use crate::formats::{Disk, FileHash};
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::project::{PartEntry, Project, ProjectRequest, open_project};
use crate::role::PerRole;
use crate::settings::Choice as _;
use crate::text::{capital, counted, factor_note, grouped, length, percent};

/// Reads a project and its parts, and what its match is to be run with.
pub fn open(path: &Path, monitor: &Monitor) -> anyhow::Result<(Asked, PerRole<LoadedPart>)> {
    let request = ProjectRequest {
        path: path.to_path_buf(),
        ..ProjectRequest::default()
    };
    let found = open_project(request, monitor)?;
    warn(path, &found.notes);
    if let Some((_, file)) = found.missing.first() {
        anyhow::bail!(
            "a file of the project was not found at its path or beside the project: {file:?}"
        );
    }
    let project = found.project;
    let entries = project.parts.as_ref().map(Option::as_ref).all();
    let (Some(entries), Some(parts)) = (entries, found.parts.all()) else {
        anyhow::bail!(
            "the project has only one of the two parts: {}",
            path.display()
        );
    };
    for (_, found) in parts.iter().filter(|(_, found)| found.is_changed) {
        let path = &found.part.path;
        log::warn!("the file has changed since the project was saved: {path:?}");
    }
    let asked = Asked {
        crash: entries.crash.load_settings(),
        stamped: entries.stamped.load_settings(),
        recipe: project.recipe.clone(),
        max_triangles: match entries.map(|entry| entry.max_triangles) {
            // Nothing was reduced by hand: the recipe says what to do.
            PerRole {
                crash: None,
                stamped: None,
            } => PerRole::both(project.recipe.max_triangles),
            levels => levels,
        },
        current: project.pose,
        pose_number: project
            .result
            .as_ref()
            .and_then(|result| result.alternative)
            .map_or(1, |index| index + 2),
    };
    Ok((asked, parts.map(|found| found.part)))
}

fn warn(path: &Path, notes: &[String]) {
    for note in notes {
        log::warn!("{}: {note}", path.display());
    }
}

/// Shows the contents of a project.
pub fn info(path: &Path, json: Option<&Path>) -> anyhow::Result<ExitCode> {
    check_outputs(json_target(json), &[path.to_path_buf()])?;
    let (project, notes) = Project::read(path)?;
    warn(path, &notes);
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
    for (role, entry) in project.parts.iter() {
        if let Some(entry) = entry {
            let role = capital(role.word());
            let _ = writeln!(text, "{role:<8} {}", describe_part(entry, path));
        }
    }
    for further in &project.further_stamped {
        let _ = writeln!(text, "Stamped  {}", describe_part(&further.part, path));
    }
    let pose = &project.pose;
    let shift: [f64; 3] = pose.translation.into();
    let angle = pose.angle_to(&crate::geometry::Similarity::identity());
    let _ = writeln!(
        text,
        "Pose     rotated by {}°, translated by ({})",
        length(angle.to_degrees()),
        shift.map(length).join(", ")
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
                "Result   {}{age}: overlap stamped {}, crash {}, RMS {}",
                assessment.verdict.label(),
                percent(assessment.coverage.source_on_target.overlap),
                percent(assessment.coverage.target_on_source.overlap),
                length(assessment.coverage.rmse())
            )
        }
    };
    text
}

fn describe_part(entry: &PartEntry, project: &Path) -> String {
    let Some(file) = &entry.file else {
        return if entry.is_realistic_example {
            "the realistic pair that comes with the program".to_owned()
        } else {
            "the example pair that comes with the program".to_owned()
        };
    };
    let mut text = format!(
        "{}, {}",
        file.display(),
        counted(entry.triangles, "triangle")
    );
    if let Some(n) = entry.max_triangles {
        let _ = write!(text, " reduced to {}", grouped(n));
    }
    if let Some(units) = entry.units {
        let _ = write!(text, ", in {}", units.label());
    }
    text += &factor_note(entry.length_factor);
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
