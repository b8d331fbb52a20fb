//! The `shapematch match …` line that does a match again, without a window and bit for bit.
//!
//! The other direction, from words to settings, is in the module of the command line; a test walks both.

use std::path::{Path, PathBuf};

use crate::formats::Selection as PartSelection;
use crate::geometry::Similarity;
use crate::registration::{
    Floor, MatchSettings, Method, Motion, Selection, StartMethod, StartSettings,
};
use crate::units::Units;

/// One file of a match and what is taken from it.
#[derive(Debug, Clone, Copy)]
pub struct CommandSide<'a> {
    /// The file.
    pub path: &'a Path,
    /// Its parts.
    pub selection: &'a PartSelection,
    /// Its lengths are multiplied by this.
    pub length_factor: f64,
    /// Its units, where the user set them.
    pub units: Option<Units>,
}

/// Everything a match depends on.
#[derive(Debug, Clone, Copy)]
pub struct CommandLine<'a> {
    /// The fixed part.
    pub crash: CommandSide<'a>,
    /// The moving part.
    pub stamped: CommandSide<'a>,
    /// Further folders for included files.
    pub include_folders: &'a [PathBuf],
    /// Method and parameters.
    pub settings: &'a MatchSettings,
    /// Ceilings of the crash and the stamped mesh the starts run on.
    pub max_triangles: [Option<usize>; 2],
    /// Where the stamped part lay (crash from stamped); counts only for starts from the current pose.
    pub current: &'a Similarity,
}

impl CommandLine<'_> {
    /// Program, subcommand, files and options, one word each. What is the default is left out.
    pub fn words(&self) -> Vec<String> {
        let mut words = Words(vec!["shapematch".into(), "match".into()]);
        for side in [&self.crash, &self.stamped] {
            words.0.push(file_word(side.path));
        }
        words.side("crash", &self.crash);
        words.side("stamped", &self.stamped);
        for folder in self.include_folders {
            words.option("include-folder", folder.display().to_string());
        }
        words.levels(self.max_triangles);
        words.settings(self.settings, self.current);
        words.0
    }

    /// The words as one line to paste into a shell.
    pub fn line(&self) -> String {
        shell_line(&self.words())
    }
}

/// A path that begins with a hyphen would be taken for an option.
fn file_word(path: &Path) -> String {
    let word = path.display().to_string();
    if word.starts_with('-') {
        format!("./{word}")
    } else {
        word
    }
}

/// Words joined to a line that a shell splits into the same words: plain words stay as they are,
/// others stand in quotes. On Windows these are double quotes, which both of its shells know.
pub fn shell_line(words: &[String]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    quoted.join(" ")
}

fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else if cfg!(windows) {
        format!("\"{}\"", word.replace('"', "\\\""))
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// The shortest text of a number that reads back to the same bits.
fn exact(value: f64) -> String {
    format!("{value:?}")
}

/// A pose as one word: 16 numbers by rows, or with a scale R by rows, t and c, so that nothing is
/// multiplied and divided again.
fn pose_word(pose: &Similarity) -> String {
    let numbers: Vec<String> = if pose.scale == 1.0 {
        pose.to_rows()
            .as_flattened()
            .iter()
            .map(|&v| exact(v))
            .collect()
    } else {
        let rows = pose.rotation.transpose();
        let values = rows
            .iter()
            .chain(pose.translation.iter())
            .chain([&pose.scale]);
        values.map(|&v| exact(v)).collect()
    };
    numbers.join(" ")
}

struct Words(Vec<String>);

impl Words {
    fn flag(&mut self, name: &str) {
        self.0.push(format!("--{name}"));
    }

    fn option(&mut self, name: &str, value: String) {
        self.flag(name);
        self.0.push(value);
    }

    /// An option that stands there only if it is not the default.
    fn unless<T: PartialEq>(
        &mut self,
        usual: &T,
        name: &str,
        value: &T,
        word: impl Fn(&T) -> String,
    ) {
        if value != usual {
            self.option(name, word(value));
        }
    }

    fn side(&mut self, role: &str, side: &CommandSide<'_>) {
        if let Some(parts) = side.selection.typed() {
            self.option(&format!("{role}-part"), parts);
        }
        let unit = format!("{role}-unit");
        if let Some(units) = side.units {
            self.option(&format!("{role}-units"), units.label().to_owned());
        }
        self.unless(&1.0, &unit, &side.length_factor, |&v| exact(v));
    }

    fn levels(&mut self, [crash, stamped]: [Option<usize>; 2]) {
        if let (Some(n), true) = (crash, crash == stamped) {
            return self.option("triangles", n.to_string());
        }
        for (name, level) in [("crash-triangles", crash), ("stamped-triangles", stamped)] {
            if let Some(n) = level {
                self.option(name, n.to_string());
            }
        }
    }

    fn settings(&mut self, settings: &MatchSettings, current: &Similarity) {
        // Every field by name: a new setting is not forgotten here.
        let MatchSettings {
            method,
            pair_with,
            selection,
            metric,
            motion,
            hand,
            starts,
            search,
            finish,
            data_side,
            allowance,
            max_normal_angle_deg,
            n_race_points,
            n_refine_points,
            max_iterations,
            motion_tolerance,
        } = settings;
        let usual = MatchSettings::of(*method);
        let word = |name: &'static str| name.to_owned();
        self.unless(&Method::default(), "method", method, |v| word(v.name()));
        self.selection(usual.selection, *selection);
        self.unless(&usual.pair_with, "pairs", pair_with, |v| word(v.name()));
        self.unless(&usual.metric, "residual", metric, |v| word(v.name()));
        if *motion == Motion::Similarity {
            self.flag("scale");
        }
        self.unless(&usual.hand, "hand", hand, |v| word(v.name()));
        self.unless(&usual.data_side, "points-of", data_side, |v| word(v.name()));
        self.unless(&usual.search, "search", search, |v| word(v.name()));
        self.unless(&usual.finish, "finish", finish, |&v| word(yes_or_no(v)));
        self.unless(&usual.allowance, "allowance", allowance, |&v| exact(v));
        let angle = &usual.max_normal_angle_deg;
        self.unless(angle, "normal-angle", max_normal_angle_deg, |&v| exact(v));
        let n_race = &usual.n_race_points;
        self.unless(n_race, "race-points", n_race_points, usize::to_string);
        let n_refine = &usual.n_refine_points;
        self.unless(n_refine, "refine-points", n_refine_points, usize::to_string);
        let n_iterations = &usual.max_iterations;
        self.unless(n_iterations, "iterations", max_iterations, usize::to_string);
        let tolerance = &usual.motion_tolerance;
        self.unless(tolerance, "tolerance", motion_tolerance, |&v| exact(v));
        self.starts(&usual.starts, starts, current);
    }

    fn selection(&mut self, usual: Selection, selection: Selection) {
        if usual.name() != selection.name() {
            self.option("keep", selection.name().to_owned());
        }
        let base = Selection::of_kind(selection.name(), usual);
        match (selection, base) {
            // The bare method "trimmed" searches the overlap.
            (Selection::Trimmed { overlap }, _) => self.option("overlap", exact(overlap)),
            (
                Selection::Fractional { lambda, floor },
                Some(Selection::Fractional {
                    lambda: usual_lambda,
                    floor: usual_floor,
                }),
            ) => {
                self.unless(&usual_lambda, "lambda", &lambda, |&v| exact(v));
                self.unless(&usual_floor, "floor", &floor, floor_word);
            }
            _ => {}
        }
    }

    fn starts(&mut self, usual: &StartSettings, starts: &StartSettings, current: &Similarity) {
        let StartSettings {
            method,
            angle_segment_deg,
            both_signs,
            poses,
            widen,
        } = starts;
        self.unless(&usual.method, "start", method, |v| v.name().to_owned());
        let poses: &[Similarity] = match method {
            StartMethod::SurfaceNormals => &[],
            StartMethod::CurrentPose if *current == Similarity::identity() => &[],
            StartMethod::CurrentPose => std::slice::from_ref(current),
            StartMethod::GivenPoses | StartMethod::All => poses,
        };
        for pose in poses {
            self.option("start-pose", pose_word(pose));
        }
        let segment = &usual.angle_segment_deg;
        self.unless(segment, "angle-segment", angle_segment_deg, |&v| exact(v));
        let yes_no = |value: &bool| yes_or_no(*value).to_owned();
        self.unless(&usual.both_signs, "both-directions", both_signs, yes_no);
        self.unless(&usual.widen, "widen", widen, yes_no);
    }
}

fn yes_or_no(value: bool) -> &'static str {
    if value { "yes" } else { "no" }
}

fn floor_word(floor: &Floor) -> String {
    match floor {
        Floor::Auto => "auto".to_owned(),
        Floor::None => "none".to_owned(),
        Floor::Length(length) => exact(*length),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(settings: &MatchSettings, current: &Similarity) -> String {
        let side = |path, selection, length_factor| CommandSide {
            path: Path::new(path),
            selection,
            length_factor,
            units: None,
        };
        let parts = PartSelection::Parts(vec![2001, 2002]);
        let command = CommandLine {
            crash: side("my car.k", &parts, 1.0),
            stamped: side("-it's.dynain", &PartSelection::All, 25.4),
            include_folders: &[],
            settings,
            max_triangles: [None, Some(2000)],
            current,
        };
        command.line()
    }

    #[test]
    #[cfg(not(windows))]
    fn only_what_differs_from_the_method_is_said() {
        let mut settings = MatchSettings::of(Method::Paper);
        settings.allowance = 0.1;
        let written = line(&settings, &Similarity::identity());
        let expected = r"shapematch match 'my car.k' './-it'\''s.dynain' --crash-part 2001,2002 --stamped-unit 25.4 --stamped-triangles 2000 --method paper --allowance 0.1";
        assert_eq!(written, expected);
    }

    #[test]
    fn a_pose_counts_only_where_the_match_starts_from_it() {
        let pose = Similarity::mirror_x();
        let mut settings = MatchSettings::default();
        assert!(!line(&settings, &pose).contains("pose"));
        settings.starts.method = StartMethod::CurrentPose;
        let written = line(&settings, &pose);
        assert!(
            written.contains("--start current --start-pose"),
            "{written}"
        );
        assert!(written.contains("-1.0 0.0 0.0 0.0 0.0 1.0"), "{written}");
        assert!(!line(&settings, &Similarity::identity()).contains("--start-pose"));
    }
}
