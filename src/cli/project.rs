//! Projects on the command line: the match of one is run again, or it is described.

use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;

use super::args::MatchArgs;
use super::recipe::{Asked, take_typed, warn_of_unused};
use super::{UsageError, check_outputs, json_target, print, takes_stdout, write_json};
use crate::formats::{Disk, FileHash, Selection};
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::project::{PartEntry, Project, ProjectRequest, open_project};
use crate::registration::StartMethod;
use crate::role::PerRole;
use crate::settings::Choice as _;
use crate::text::{capital, counted, factor_note, grouped, length, percent};

/// Reads a project and its parts, and what its match is to be run with; the last value tells whether it is known which
/// parts of the crash model are meant.
pub fn open(
    args: &MatchArgs,
    monitor: &Monitor,
) -> anyhow::Result<(Asked, PerRole<LoadedPart>, bool)> {
    refuse_own(args)?;
    let path = args.crash.as_path();
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
    let is_same = parts.iter().all(|(_, found)| !found.is_changed);
    let is_part_chosen = is_part_chosen(&project, entries.crash, is_same);
    let begin = begin(&project, args)?;
    if let Some(note) = pose_note(&project, &begin.recipe) {
        warn(path, &[note]);
    }
    let asked = Asked {
        crash: entries.crash.load_settings(),
        stamped: entries.stamped.load_settings(),
        max_triangles: max_triangles(args, entries, &begin.recipe),
        recipe: begin.recipe,
        current: begin.pose,
        pose_number: begin.alternative.map_or(1, |index| index + 2),
    };
    let parts = parts.map(|found| found.part);
    Ok((asked, parts, is_part_chosen))
}

/// As in the window: the user chose them or said that all are meant, or they were matched as they are.
fn is_part_chosen(project: &Project, crash: &PartEntry, is_same: bool) -> bool {
    let is_usual = matches!(crash.selection, Selection::All | Selection::Sheet);
    let result = project.result.as_ref();
    let is_of_these = result.is_some_and(|result| result.exchanged == PerRole::both(false));
    !is_usual || crash.are_all_meant || (is_of_these && is_same)
}

/// Refuses options about what a project has its own of.
fn refuse_own(args: &MatchArgs) -> Result<(), UsageError> {
    let (input, typed) = (&args.input, &args.settings);
    input.read.refuse_beside_project("two files")?;
    for (is_typed, option) in [
        (input.crash_part.is_some(), "crash-part"),
        (input.stamped_part.is_some(), "stamped-part"),
        (input.crash_units.is_some(), "crash-units"),
        (input.stamped_units.is_some(), "stamped-units"),
        (input.crash_length_factor != 1.0, "crash-length-factor"),
        (input.stamped_length_factor != 1.0, "stamped-length-factor"),
        (typed.value("method").is_some(), "method"),
        (!typed.start_poses.is_empty(), "start-pose"),
    ] {
        if is_typed {
            let text = format!("--{option} is for two files; a project has its own");
            return Err(UsageError(text));
        }
    }
    Ok(())
}

/// The levels that the starts run on: those typed, else those that were made by hand, else the one of the recipe.
fn max_triangles(
    args: &MatchArgs,
    entries: PerRole<&PartEntry>,
    recipe: &MatchRecipe,
) -> PerRole<Option<usize>> {
    let levels = match entries.map(|entry| entry.max_triangles) {
        levels if is_reduced(levels) && args.settings.value("triangles").is_none() => levels,
        _ => PerRole::both(recipe.max_triangles),
    };
    let typed = PerRole::new(args.input.crash_triangles, args.input.stamped_triangles);
    PerRole::from_fn(|role| typed.get(role).or(*levels.get(role)))
}

fn is_reduced(levels: PerRole<Option<usize>>) -> bool {
    levels.iter().any(|(_, level)| level.is_some())
}

/// How the match of a project is made.
struct Begin {
    recipe: MatchRecipe,
    /// Where the stamped part lies before.
    pose: Similarity,
    /// The alternative that is taken instead of the best pose.
    alternative: Option<usize>,
}

/// A match that still stands for the pose is made again from where it began, which Refine and point pairs
/// leave out of the settings, unless another start is typed.
fn begin(project: &Project, args: &MatchArgs) -> anyhow::Result<Begin> {
    let typed = &args.settings;
    let mut begin = Begin {
        recipe: project.recipe.clone(),
        pose: project.pose,
        alternative: None,
    };
    let current = project.result.as_ref().filter(|result| result.is_current);
    if let Some(result) = current.filter(|_| typed.value("start").is_none()) {
        let starts = &result.run.recipe.settings.starts;
        if starts.method != StartMethod::SurfaceNormals {
            begin.recipe.settings.starts = starts.clone();
            begin.pose = result.run.start_pose;
        }
        begin.alternative = result.alternative;
    }
    take_typed(&mut begin.recipe, args)?;
    warn_of_unused(&begin.recipe, args);
    begin.recipe.settings.check().map_err(PipelineError::from)?;
    Ok(begin)
}

/// What is told of a pose that no match stands for, and that the match to come does not begin at.
fn pose_note(project: &Project, recipe: &MatchRecipe) -> Option<String> {
    if recipe.settings.starts.method == StartMethod::CurrentPose {
        return None;
    }
    let when = match &project.result {
        Some(result)
            if result.is_current || result.run.pose(result.alternative) == Some(project.pose) =>
        {
            return None;
        }
        Some(_) => " after the match",
        None if project.pose == Similarity::identity() => return None,
        None => "",
    };
    Some(format!(
        "the stamped part was moved{when}; it is matched anew here, and --start current --wide-search no begins at \
         its pose"
    ))
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
        let text = project.to_text(path)?;
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
    let angle = pose.angle_to(&Similarity::identity());
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
