//! The `shapematch match …` and `shapematch map …` lines that do a match and a mapping again, without a
//! window and bit for bit.
//!
//! The other direction, from words to settings, is in the module of the command line; a test walks both.

use std::path::Path;

use crate::formats::{ReadOptions, Selection};
use crate::geometry::Similarity;
use crate::mapping::{MapOptions, RuleKind};
use crate::registration::{MatchSettings, StartMethod};
use crate::role::{PerRole, Role};
use crate::settings::{Domain, MAP_SETTINGS, MatchRecipe, SETTINGS, Setting, exact};
use crate::units::Units;

/// One file of a match and what is taken from it.
#[derive(Debug, Clone, Copy)]
pub struct CommandSide<'a> {
    /// Path of the file.
    pub path: &'a Path,
    /// Parts that are used of it; `None` leaves the choice to the program.
    pub selection: Option<&'a Selection>,
    /// Its lengths are multiplied by this.
    pub length_factor: f64,
    /// Its units, where the user set them.
    pub units: Option<Units>,
}

/// Everything a match depends on.
#[derive(Debug, Clone, Copy)]
pub struct CommandLine<'a> {
    /// The two files.
    pub sides: PerRole<CommandSide<'a>>,
    /// Further folders for included files, and the limit on what is read.
    pub read: &'a ReadOptions,
    /// Method and parameters.
    pub settings: &'a MatchSettings,
    /// Maximum number of triangles of each mesh the starts run on.
    pub max_triangles: PerRole<Option<usize>>,
    /// Where the stamped part lay (crash from stamped); counts only for starts from the current pose.
    pub current: &'a Similarity,
    /// The pose that is taken instead of the best: the first, second … of those that fit nearly as well.
    pub alternative: Option<usize>,
}

impl CommandLine<'_> {
    /// Program, subcommand, files and options, one word each. What is the default is left out.
    pub fn words(&self) -> Vec<String> {
        let mut words = Words(vec!["shapematch".into(), "match".into()]);
        for (_, side) in self.sides.iter() {
            words.0.push(file_word(side.path));
        }
        for (role, side) in self.sides.iter() {
            words.side(role, side);
        }
        words.reading(self.read);
        let PerRole { crash, stamped } = self.max_triangles;
        let is_common = crash == stamped;
        if !is_common {
            words.levels(self.max_triangles);
        }
        let recipe = MatchRecipe {
            settings: self.settings.clone(),
            max_triangles: crash.filter(|_| is_common),
        };
        words.settings(&recipe, self.current);
        if let Some(index) = self.alternative {
            // The best pose is the first one.
            words.option("pose-number", (index + 2).to_string());
        }
        words.0
    }

    /// The words as one line to paste into a shell.
    pub fn line(&self) -> String {
        shell_line(&self.words())
    }
}

/// Everything a mapping depends on.
#[derive(Debug, Clone, Copy)]
pub struct MapCommandLine<'a> {
    /// The crash file, and the first of the stamped ones.
    pub sides: PerRole<CommandSide<'a>>,
    /// Further folders for included files.
    pub read: &'a ReadOptions,
    /// Where the stamped part lies (crash from stamped).
    pub pose: &'a Similarity,
    /// Further stamped files with their poses.
    pub further: &'a [(CommandSide<'a>, Similarity)],
    /// Quantities, method, limits.
    pub options: &'a MapOptions,
    /// Layers of the crash elements, the rule through their thickness, and points in the plane, where they
    /// are not the deck's.
    pub layers: (Option<usize>, Option<RuleKind>, Option<u8>),
    /// Factors on the stamped stresses: none, one for all files or one for each.
    pub stress_factors: &'a [f64],
    /// Material law of the stamped parts.
    pub stamped_law: Option<&'a str>,
}

impl MapCommandLine<'_> {
    /// A word about each stamped file, where they differ in it; else nothing.
    fn of_each_stamped(&self, word: impl Fn(&CommandSide<'_>) -> String) -> Vec<String> {
        let further = self.further.iter().map(|(side, _)| side);
        let all = std::iter::once(&self.sides.stamped).chain(further);
        let mut words: Vec<String> = all.map(word).collect();
        if words.iter().all(|word| *word == words[0]) {
            words.clear();
        }
        words
    }

    /// The line to paste into a shell. What is the default is left out.
    pub fn line(&self) -> String {
        let mut words = Words(vec!["shapematch".into(), "map".into()]);
        for (_, side) in self.sides.iter() {
            words.0.push(file_word(side.path));
        }
        for (side, _) in self.further {
            words.0.push(file_word(side.path));
        }
        let parts = self.of_each_stamped(|side| {
            let usual = Selection::Sheet;
            side.selection.unwrap_or(&usual).typed()
        });
        let factors = self.of_each_stamped(|side| exact(side.length_factor));
        for (role, side) in self.sides.iter() {
            // A mapping takes factors, not units.
            let mut side = CommandSide {
                units: None,
                ..*side
            };
            if role == Role::Stamped && !parts.is_empty() {
                words.repeated("stamped-part", &parts);
                side.selection = None;
            }
            if role == Role::Stamped && !factors.is_empty() {
                words.repeated("stamped-length-factor", &factors);
                side.length_factor = 1.0;
            }
            words.side(role, &side);
        }
        words.reading(self.read);
        words.option("pose", pose_word(self.pose));
        for (_, pose) in self.further {
            words.option("pose", pose_word(pose));
        }
        let mut quantities = self.options.quantities;
        if quantities != MapOptions::default().quantities {
            let chosen = quantities.named().into_iter().filter(|(_, is_on)| **is_on);
            let names: Vec<&str> = chosen.map(|(name, _)| name).collect();
            words.option("quantities", names.join(","));
        }
        let usual = MapOptions::default();
        for setting in &MAP_SETTINGS {
            let value = setting.get(self.options);
            let value = value.filter(|value| Some(value) != setting.get(&usual).as_ref());
            if let Some(word) = value.and_then(|value| value.word()) {
                words.option(setting.option, word);
            }
        }
        let (layers, rule, n_plane) = self.layers;
        let rule = rule.map(|rule| rule.name().to_owned());
        for (name, word) in [
            ("layers", layers.map(|n| n.to_string())),
            ("rule", rule),
            ("n-plane", n_plane.map(|n| n.to_string())),
            ("stamped-material", self.stamped_law.map(str::to_owned)),
        ] {
            if let Some(word) = word {
                words.option(name, word);
            }
        }
        let factors: Vec<String> = self.stress_factors.iter().copied().map(exact).collect();
        words.repeated("stress-factor", &factors);
        shell_line(&words.0)
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

    fn repeated(&mut self, name: &str, values: &[String]) {
        for value in values {
            self.option(name, value.clone());
        }
    }

    /// How the files are read.
    fn reading(&mut self, read: &ReadOptions) {
        for folder in &read.include_folders {
            self.option("include-folder", folder.display().to_string());
        }
        let limit = read.limit();
        if limit != ReadOptions::USUAL_LIMIT {
            self.option("read-limit", exact(limit));
        }
    }

    fn side(&mut self, role: Role, side: &CommandSide<'_>) {
        // Where none are named, the crash parts are found, and of the stamped file the sheet is taken.
        let is_usual = role == Role::Stamped && side.selection == Some(&Selection::Sheet);
        let role = role.word();
        if let Some(parts) = side.selection.filter(|_| !is_usual) {
            self.option(&format!("{role}-part"), parts.typed());
        }
        if let Some(units) = side.units {
            self.option(&format!("{role}-units"), units.label().to_owned());
        }
        if side.length_factor != 1.0 {
            let factor = exact(side.length_factor);
            self.option(&format!("{role}-length-factor"), factor);
        }
    }

    /// Where the parts are reduced to different levels, each has an option of its own.
    fn levels(&mut self, max_triangles: PerRole<Option<usize>>) {
        for (role, level) in max_triangles.iter() {
            if let Some(n) = level {
                self.option(&format!("{}-triangles", role.word()), n.to_string());
            }
        }
    }

    /// What has to be said to turn the defaults of the method into the recipe, row by row.
    fn settings(&mut self, recipe: &MatchRecipe, current: &Similarity) {
        let mut base = MatchRecipe::default();
        for setting in &SETTINGS {
            let value = setting.get(recipe);
            if let Domain::Poses = setting.domain {
                self.poses(setting, recipe, current);
            } else if (value != setting.get(&base) || is_always_said(setting))
                && let Some(value) = value
                && let Some(word) = value.word()
            {
                self.option(setting.option, word);
                setting.set(&mut base, &value);
            }
            if setting.option == "method" {
                base.settings = MatchSettings::of(recipe.settings.method);
            }
        }
    }

    fn poses(&mut self, setting: &Setting, recipe: &MatchRecipe, current: &Similarity) {
        let starts = &recipe.settings.starts;
        let poses: &[Similarity] = match starts.method {
            StartMethod::SurfaceNormals => &[],
            StartMethod::CurrentPose if *current == Similarity::identity() => &[],
            StartMethod::CurrentPose => std::slice::from_ref(current),
            StartMethod::GivenPoses | StartMethod::All => &starts.poses,
        };
        for pose in poses {
            self.option(setting.option, pose_word(pose));
        }
    }
}

/// Trimmed ICP estimates its overlap unless it is told one.
fn is_always_said(setting: &Setting) -> bool {
    setting.option == "overlap"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::Method;

    fn line(settings: &MatchSettings, current: &Similarity) -> String {
        let side = |path, selection, length_factor| CommandSide {
            path: Path::new(path),
            selection: Some(selection),
            length_factor,
            units: None,
        };
        let parts = Selection::Parts(vec![2001, 2002]);
        let command = CommandLine {
            sides: PerRole {
                crash: side("my car.k", &parts, 1.0),
                stamped: side("-it's.dynain", &Selection::Sheet, 25.4),
            },
            read: &ReadOptions::default(),
            settings,
            max_triangles: PerRole::new(None, Some(2000)),
            current,
            alternative: None,
        };
        command.line()
    }

    #[test]
    #[cfg(not(windows))]
    fn only_what_differs_from_the_method_is_said() {
        let mut settings = MatchSettings::of(Method::Paper);
        settings.allowance = 0.1;
        let written = line(&settings, &Similarity::identity());
        let expected = r"shapematch match 'my car.k' './-it'\''s.dynain' --crash-part 2001,2002 --stamped-length-factor 25.4 --stamped-triangles 2000 --method paper --allowance 0.1";
        assert_eq!(written, expected);
    }

    #[test]
    fn the_limit_of_reading_is_said_where_it_is_not_the_usual_one() {
        let read = ReadOptions::default().with_limit(12.5);
        let selection = Selection::Sheet;
        let side = |path| CommandSide {
            path: Path::new(path),
            selection: Some(&selection),
            length_factor: 1.0,
            units: None,
        };
        let line = |read: &ReadOptions| {
            let command = MapCommandLine {
                sides: PerRole::new(side("crash.k"), side("stamped.k")),
                read,
                pose: &Similarity::identity(),
                further: &[],
                options: &MapOptions::default(),
                layers: (None, None, None),
                stress_factors: &[],
                stamped_law: None,
            };
            command.line()
        };
        assert!(line(&read).contains("--read-limit 12.5"), "{}", line(&read));
        assert!(!line(&ReadOptions::default()).contains("--read-limit"));
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
