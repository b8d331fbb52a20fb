//! The state of the window as a line for a shell.

use super::{AppState, Part};
use crate::jobs::PartSource;
use crate::report::command_line::{CommandLine, CommandSide};
use std::path::{Path, PathBuf};

/// Where the line puts the example pair, which is in no file.
const EXAMPLE_FOLDER: &str = "shapematch-example";

impl AppState {
    /// The line that does the match with the present files, parts, levels, settings and pose, without
    /// the window and bit for bit; `None` without both parts.
    pub fn command_line(&self) -> Option<String> {
        let (crash, stamped) = self.document.both()?;
        let recipe = &self.document.recipe;
        let ceilings = [crash, stamped].map(Part::ceiling);
        let is_reduced = ceilings.iter().any(Option::is_some);
        let (crash_path, stamped_path) = (path(crash), path(stamped));
        let line = CommandLine {
            crash: CommandSide {
                path: &crash_path,
                ..crash.loaded.command_side()
            },
            stamped: CommandSide {
                path: &stamped_path,
                ..stamped.loaded.command_side()
            },
            include_folders: &crash.loaded.settings.read.include_folders,
            settings: &recipe.settings,
            max_triangles: if is_reduced {
                ceilings
            } else {
                [recipe.max_triangles; 2]
            },
            current: self.document.crash_from_stamped(),
        };
        let is_example = [crash, stamped]
            .iter()
            .any(|part| part.source == PartSource::Example);
        let before = if is_example {
            format!("shapematch sample {EXAMPLE_FOLDER} --bundled && ")
        } else {
            String::new()
        };
        Some(before + &line.line())
    }
}

fn path(part: &Part) -> PathBuf {
    match part.source {
        PartSource::File(_) => part.loaded.path.clone(),
        PartSource::Example => Path::new(EXAMPLE_FOLDER).join(&part.loaded.path),
    }
}
