//! The state of the window as a line for a shell.

use std::path::{Path, PathBuf};

use crate::app::{Document, Part, Reason};
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::jobs::PartSource;
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::outputs::record;
use crate::registration::StartMethod;
use crate::report::command_line::{CommandLine, CommandSide, MapCommandLine};
use crate::role::{PerRole, Role};

/// Where the line puts the example pairs, which are in no file, and the option that writes them.
const EXAMPLES: [(PartSource, &str, &str); 2] = [
    (PartSource::Example, "shapematch-example", "--bundled"),
    (
        PartSource::RealisticExample,
        "shapematch-realistic-example",
        "--realistic",
    ),
];

impl Document {
    /// `Ok` if a line can give the pose that is shown: not where it was moved by hand after a match,
    /// unless the match starts there, nor before the pairs that it starts with fix a pose.
    pub fn can_copy_command_line(&self) -> Result<(), Reason> {
        self.has_both_parts()?;
        let begins_here = self.recipe.settings.starts.method == StartMethod::CurrentPose;
        if self.match_of_parts().is_err() || begins_here {
            return self.has_start_pose();
        }
        self.has_result()
    }

    /// The line that gives the pose that is shown without the window and bit for bit: that of the record
    /// where there is a result, which may have begun elsewhere than the form says; else the match that the
    /// present files, parts, levels, settings and pose ask for. `None` without both parts, and while the pairs
    /// that it begins with fix no pose.
    pub fn command_line(&self) -> Option<String> {
        let both = self.both()?;
        let paths = both.map(path);
        let recipe = self.recipe_to_run();
        let mut line = if let Some(result) = self.current_result() {
            CommandLine {
                alternative: result.alternative,
                ..record::command_line(&result.run, both.map(|part| &*part.loaded))
            }
        } else {
            self.unmatched_line(both, recipe.as_ref()?)
        };
        line.sides.crash.path = &paths.crash;
        line.sides.stamped.path = &paths.stamped;
        Some(examples(both) + &line.line())
    }

    /// The match that Run would do.
    fn unmatched_line<'a>(
        &'a self,
        both: PerRole<&'a Part>,
        recipe: &'a MatchRecipe,
    ) -> CommandLine<'a> {
        let ceilings = both.map(Part::ceiling);
        let is_reduced = ceilings.iter().any(|(_, ceiling)| ceiling.is_some());
        let read = &both.crash.loaded.settings;
        let mut sides = record::match_sides(both.map(|part| &*part.loaded), &recipe.settings);
        // All parts of a model are no choice: the match finds those that fit.
        if read.selection == Selection::All {
            sides.crash.selection = None;
        }
        CommandLine {
            sides,
            read: &read.read,
            settings: &recipe.settings,
            max_triangles: if is_reduced {
                ceilings
            } else {
                PerRole::both(recipe.max_triangles)
            },
            current: self.crash_from_stamped(),
            alternative: None,
        }
    }

    /// `Ok` if a line can do the mapping that section 4 asks for.
    pub fn can_copy_map_command_line(&self) -> Result<(), Reason> {
        self.can_map()?;
        let crash = self.part(Role::Crash);
        if crash.is_some_and(|crash| crash.length_factor() != 1.0) {
            return Err(Reason(
                "The command line maps in the unit of the crash file, which has a factor here.",
            ));
        }
        if self.current_mapping().is_none() {
            return Err(Reason("Map the forming results first."));
        }
        Ok(())
    }

    /// The line that maps with the present files, parts, poses and choices, bit for bit; `None` without
    /// both parts, and while a stamped file has no pose.
    pub fn map_command_line(&self) -> Option<String> {
        let both = self.both()?;
        let paths = both.map(path);
        let recipe = self.wanted_mapping();
        let side = |role: Role| CommandSide {
            path: paths.get(role),
            ..both.get(role).loaded.command_side()
        };
        let further: Vec<(CommandSide<'_>, Similarity)> = self
            .mapping
            .further
            .iter()
            .map(|further| further.loaded.command_side())
            .zip(self.further_poses().ok()?)
            .collect();
        let line = MapCommandLine {
            sides: PerRole::from_fn(side),
            read: &both.crash.loaded.settings.read,
            pose: self.crash_from_stamped(),
            further: &further,
            options: &recipe.options,
            layers: (recipe.n_layers, recipe.rule, recipe.n_plane),
            stress_factors: &recipe.stress_factors,
            stamped_law: recipe.stamped_law.as_deref(),
        };
        Some(examples(both) + &line.line())
    }
}

/// What writes the example pairs, before a line that reads them.
fn examples(both: PerRole<&Part>) -> String {
    let mut before = String::new();
    for (source, folder, option) in EXAMPLES {
        if both.iter().any(|(_, part)| part.source == source) {
            before += &format!("shapematch sample {folder} {option} && ");
        }
    }
    before
}

fn path(part: &Part) -> PathBuf {
    let example = EXAMPLES.iter().find(|(source, ..)| *source == part.source);
    match example {
        Some((_, folder, _)) => Path::new(folder).join(&part.loaded.path),
        None => part.loaded.path.clone(),
    }
}
