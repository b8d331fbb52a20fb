//! From what was typed to what a match depends on. [`crate::report::command_line`] goes the other way.

use std::fs;

use anyhow::Context as _;

use super::UsageError;
use super::args::{InputArgs, MatchArgs};
use super::setting_args::SettingArgs;
use crate::formats::Selection;
use crate::geometry::Similarity;
use crate::pipeline::load::{LoadSettings, parse_selection, usual_selection};
use crate::registration::{Hand, MatchSettings, Method, Motion, StartMethod};
use crate::report::matrix::ParseMatrixError;
use crate::report::parse_matrix;
use crate::role::{PerRole, Role};
use crate::settings::{Choice as _, MatchRecipe, Value, setting};

/// Everything a match depends on besides the two files.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// How the crash file is read.
    pub crash: LoadSettings,
    /// How the stamped file is read.
    pub stamped: LoadSettings,
    /// Method and parameters.
    pub recipe: MatchRecipe,
    /// Maximum number of triangles of each mesh the starts run on.
    pub max_triangles: PerRole<Option<usize>>,
    /// Where the stamped part lies at the start (crash from stamped).
    pub current: Similarity,
    /// The pose that is taken of those that fit nearly as well, counted from 1, the best.
    pub pose_number: usize,
}

/// Understands the options of `shapematch match`; reads the files of `--start-pose`.
pub fn asked(args: &MatchArgs) -> anyhow::Result<Asked> {
    let input = &args.input;
    let mut recipe = recipe(args)?;
    let current = start_poses(&args.settings, &mut recipe)?;
    warn_of_unused(&recipe, args);
    let level = |own: Option<usize>| own.or(recipe.max_triangles);
    Ok(Asked {
        crash: load_settings(input, Role::Crash),
        stamped: load_settings(input, Role::Stamped),
        max_triangles: PerRole {
            crash: level(input.crash_triangles),
            stamped: level(input.stamped_triangles),
        },
        recipe,
        current,
        pose_number: args.output.pose_number.unwrap_or(1),
    })
}

/// The method's defaults, changed by what was typed.
fn recipe(args: &MatchArgs) -> anyhow::Result<MatchRecipe> {
    let typed = |option: &str| args.settings.value(option);
    let method = match typed("method") {
        Some(Value::Choice(name)) => Method::from_name(name).unwrap_or_default(),
        _ => Method::default(),
    };
    let is_estimated = typed("overlap").is_none() && typed("pair-selection").is_none();
    let method = match method {
        Method::Trimmed if is_estimated => Method::TrimmedSearch,
        method => method,
    };
    let mut recipe = MatchRecipe {
        settings: MatchSettings::of(method),
        max_triangles: None,
    };
    take_typed(&mut recipe, args)?;
    Ok(recipe)
}

/// Changes a recipe by what was typed, except for its method.
pub(super) fn take_typed(recipe: &mut MatchRecipe, args: &MatchArgs) -> anyhow::Result<()> {
    let typed = args.settings.typed.iter();
    for (option, value) in typed.filter(|(option, _)| *option != "method") {
        let is_set = setting(option).is_some_and(|row| row.set(recipe, value));
        if !is_set {
            let kind = recipe.settings.selection.name();
            let text = format!("--{option} has no effect with the pair selection {kind}");
            return Err(UsageError(text).into());
        }
    }
    if args.shorthands.scale {
        recipe.settings.motion = Motion::Similarity;
    }
    if args.shorthands.mirror {
        recipe.settings.hand = Hand::Either;
    }
    Ok(())
}

/// Tells the settings that were typed and have no effect beside the others.
pub(super) fn warn_of_unused(recipe: &MatchRecipe, args: &MatchArgs) {
    let typed = args.settings.typed.iter();
    let unused = typed.filter_map(|(option, _)| Some((option, setting(option)?.unused(recipe)?)));
    for (option, reason) in unused {
        log::warn!("--{option} has no effect. {reason}");
    }
    let levels = [args.input.crash_triangles, args.input.stamped_triangles];
    let is_typed = args.settings.value("triangles").is_some();
    if is_typed && levels.iter().all(Option::is_some) {
        log::warn!("--triangles has no effect beside --crash-triangles and --stamped-triangles");
    }
}

/// Takes the start poses that were typed; the value is the pose the stamped part starts from.
fn start_poses(args: &SettingArgs, recipe: &mut MatchRecipe) -> anyhow::Result<Similarity> {
    let poses: anyhow::Result<Vec<Similarity>> = args
        .start_poses
        .iter()
        .map(|text| pose("--start-pose", text))
        .collect();
    let poses = poses?;
    let starts = &mut recipe.settings.starts;
    if args.value("start").is_none() {
        starts.method = match poses.len() {
            0 => starts.method,
            1 => StartMethod::CurrentPose,
            _ => StartMethod::GivenPoses,
        };
    }
    match (starts.method, &poses[..]) {
        (StartMethod::CurrentPose, []) => {}
        (StartMethod::CurrentPose, [pose]) => return Ok(*pose),
        (StartMethod::CurrentPose, _) => {
            let text = "--start current takes one --start-pose; --start given takes several";
            return Err(UsageError(text.to_owned()).into());
        }
        (StartMethod::SurfaceNormals, [_, ..]) => {
            let text = "--start surface-normal makes its own poses; omit --start-pose";
            return Err(UsageError(text.to_owned()).into());
        }
        _ => starts.poses = poses,
    }
    Ok(Similarity::identity())
}

/// A pose from the word of an option itself or from the file it names.
pub(super) fn pose(option: &str, word: &str) -> anyhow::Result<Similarity> {
    let typed = match parse_matrix(word) {
        Ok(parsed) => {
            for note in &parsed.notes {
                log::warn!("{option}: {note}");
            }
            return Ok(parsed.motion);
        }
        Err(error) => error,
    };
    let usage = |error: ParseMatrixError| UsageError(format!("{option} {word:?}: {error}"));
    let text = match fs::read_to_string(word) {
        Ok(text) => text,
        // Several numbers are no name of a file.
        Err(_) if !matches!(typed, ParseMatrixError::Count(0..=1)) => {
            return Err(usage(typed).into());
        }
        Err(error) => return Err(error).with_context(|| format!("{word:?} cannot be read")),
    };
    let parsed = parse_matrix(&text).map_err(usage)?;
    for note in &parsed.notes {
        log::warn!("{option} {word}: {note}");
    }
    Ok(parsed.motion)
}

/// The parts that an option names, else those that are usual for the role.
pub fn selection(role: Role, typed: Option<&str>) -> Selection {
    typed.map_or_else(|| usual_selection(role), parse_selection)
}

fn load_settings(input: &InputArgs, role: Role) -> LoadSettings {
    let (part, length_factor, units) = match role {
        Role::Crash => (
            &input.crash_part,
            input.crash_length_factor,
            input.crash_units,
        ),
        Role::Stamped => (
            &input.stamped_part,
            input.stamped_length_factor,
            input.stamped_units,
        ),
    };
    LoadSettings {
        selection: selection(role, part.as_deref()),
        length_factor,
        units,
        read: input.read.options(),
        ..LoadSettings::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::args::{Cli, Task};
    use super::*;
    use crate::formats::{self, ReadOptions};
    use crate::geometry::{Pose, Vector3};
    use crate::registration::{DataSide, Floor, Metric, PairSelection, PairWith, Search};
    use crate::report::command_line::{CommandLine, CommandSide};
    use crate::settings::{Domain, SETTINGS, Setting};
    use crate::units::{LengthUnit, UnitSystem};
    use clap::Parser as _;
    use std::path::Path;

    fn understood(words: &[String]) -> Asked {
        let cli = Cli::try_parse_from(words).unwrap_or_else(|e| panic!("{words:?}: {e}"));
        match cli.command {
            Some(Task::Match(args)) => asked(&args).unwrap(),
            other => panic!("{other:?}"),
        }
    }

    fn typed(asked: &Asked) -> Vec<String> {
        let side = |path, load: &'static LoadSettings| CommandSide {
            path: Path::new(path),
            selection: Some(&load.selection),
            length_factor: load.length_factor,
            units: load.units,
        };
        let leak =
            |load: &LoadSettings| -> &'static LoadSettings { Box::leak(Box::new(load.clone())) };
        CommandLine {
            sides: PerRole {
                crash: side("crash.k", leak(&asked.crash)),
                stamped: side("stamped.k", leak(&asked.stamped)),
            },
            read: &asked.crash.read,
            settings: &asked.recipe.settings,
            max_triangles: asked.max_triangles,
            current: &asked.current,
            alternative: None,
        }
        .words()
    }

    fn usual() -> Asked {
        understood(&["shapematch", "match", "a", "b"].map(String::from))
    }

    fn odd_pose() -> Similarity {
        Pose::new(
            Vector3::new(-0.1, 1e5, 1.0 / 3.0),
            Vector3::new(1.0, -2.0, 0.3),
        )
        .into()
    }

    /// Every setting away from its default, one after another and on every method.
    fn variations() -> Vec<Asked> {
        let changes: &[fn(&mut Asked)] = &[
            |_| {},
            |a| a.recipe.settings.pair_with = PairWith::Node,
            |a| a.recipe.settings.pair_with = PairWith::Triangle,
            |a| a.recipe.settings.metric = Metric::PointToPoint,
            |a| a.recipe.settings.metric = Metric::PointToPlane,
            |a| a.recipe.settings.selection = PairSelection::All,
            |a| a.recipe.settings.selection = PairSelection::TrimmedSearch,
            |a| a.recipe.settings.selection = PairSelection::Trimmed { overlap: 0.1 + 0.2 },
            |a| {
                a.recipe.settings.selection = PairSelection::Fractional {
                    lambda: 1.3,
                    floor: Floor::Length(1e-7),
                }
            },
            |a| {
                a.recipe.settings.selection = PairSelection::Fractional {
                    lambda: 1.5,
                    floor: Floor::None,
                }
            },
            |a| a.recipe.settings.motion = Motion::Similarity,
            |a| a.recipe.settings.hand = Hand::Mirrored,
            |a| a.recipe.settings.hand = Hand::Either,
            |a| a.recipe.settings.search = Search::EveryStart,
            |a| a.recipe.settings.refine_on_full ^= true,
            |a| a.recipe.settings.data_side = DataSide::Target,
            |a| a.recipe.settings.allowance = 1.0 / 3.0,
            |a| a.recipe.settings.max_normal_angle_deg = 45.5,
            |a| a.recipe.settings.n_coarse_points = 501,
            |a| a.recipe.settings.n_refine_points = 7,
            |a| a.recipe.settings.max_iterations = 50,
            |a| a.recipe.settings.motion_tolerance = 1e-9,
            |a| a.recipe.settings.starts.angle_segment_deg = 33.3,
            |a| a.recipe.settings.starts.both_signs ^= true,
            |a| a.recipe.settings.starts.wide_search ^= true,
            |a| a.recipe.settings.starts.method = StartMethod::All,
            |a| {
                a.recipe.settings.starts.method = StartMethod::GivenPoses;
                let scaled = Similarity {
                    scale: 1.1,
                    ..odd_pose()
                };
                a.recipe.settings.starts.poses = vec![odd_pose(), scaled];
            },
            |a| {
                a.recipe.settings.starts.method = StartMethod::CurrentPose;
                a.current = odd_pose();
            },
            |a| a.crash.length_factor = 25.4,
            |a| a.stamped.length_factor = 1e-3,
            |a| a.crash.units = Some(LengthUnit::Meter.into()),
            |a| a.stamped.units = Some(UnitSystem::ALL[0].into()),
            |a| a.crash.selection = formats::Selection::PartTitle("7, rail 'left'".into()),
            |a| a.stamped.selection = formats::Selection::ShellSet(4),
            |a| {
                a.recipe.max_triangles = Some(2000);
                a.max_triangles = PerRole::both(Some(2000));
            },
            |a| a.max_triangles = PerRole::new(None, Some(500)),
            |a| a.max_triangles = PerRole::new(Some(700), Some(500)),
            |a| {
                let folders = vec!["my includes".into(), "b".into()];
                a.crash.read.include_folders = folders;
                a.stamped.read = a.crash.read.clone();
            },
            |a| {
                a.crash.read = ReadOptions::default().with_limit(0.1);
                a.stamped.read = a.crash.read.clone();
            },
        ];
        let of_method = |method: Method| {
            changes.iter().map(move |change| {
                let mut asked = usual();
                asked.recipe.settings = MatchSettings::of(method);
                change(&mut asked);
                asked
            })
        };
        Method::ALL.iter().copied().flat_map(of_method).collect()
    }

    /// Values unlike the one that a setting has, as odd as its domain allows.
    fn other_values(setting: &Setting, value: &Value) -> Vec<Value> {
        let candidates = match &setting.domain {
            Domain::Choice(words) => words().iter().map(|w| Value::Choice(w.name)).collect(),
            Domain::Switch => [true, false].map(Value::Switch).to_vec(),
            Domain::Count(range) => [*range.start(), 12_347].map(Value::Count).to_vec(),
            Domain::Limit(range) => {
                let limits = [None, Some(*range.start()), Some(777)];
                limits.map(Value::Limit).to_vec()
            }
            Domain::Number { range, .. } => {
                let (low, high) = (*range.start(), range.end().min(range.start() + 3.0));
                let odd = low + (high - low) / 3.0;
                [low, odd, *range.end()].map(Value::Number).to_vec()
            }
            Domain::Floor => [Floor::Auto, Floor::None, Floor::Length(0.1 + 0.2)]
                .map(Value::Floor)
                .to_vec(),
            Domain::Reach => [None, Some(0.1 + 0.2)].map(Value::Reach).to_vec(),
            Domain::Poses => vec![Value::Poses(vec![odd_pose(), odd_pose()])],
        };
        let others = candidates.into_iter().filter(|other| other != value);
        others.collect()
    }

    /// Every value of every row, on every method: what the window copies is understood by the command
    /// line, and what a project stores is read back.
    #[test]
    fn every_row_comes_back_from_command_line_and_json() {
        let mut n_tried = 0;
        for &method in Method::ALL {
            let mut base = usual();
            base.recipe.settings = MatchSettings::of(method);
            for setting in &SETTINGS {
                let Some(value) = setting.get(&base.recipe) else {
                    continue;
                };
                for other in other_values(setting, &value) {
                    let mut asked = base.clone();
                    if let Domain::Poses = setting.domain {
                        asked.recipe.settings.starts.method = StartMethod::GivenPoses;
                    }
                    assert!(setting.set(&mut asked.recipe, &other), "{}", setting.option);
                    assert_eq!(setting.get(&asked.recipe), Some(other));
                    let json = serde_json::to_string(&asked.recipe).unwrap();
                    let back: MatchRecipe = serde_json::from_str(&json).unwrap();
                    assert_eq!(back, asked.recipe, "{json}");
                    if setting.option == "method" {
                        // The other settings of this row are those of another method.
                        continue;
                    }
                    asked.max_triangles = PerRole::both(asked.recipe.max_triangles);
                    let words = typed(&asked);
                    assert_eq!(understood(&words), asked, "{words:?}");
                    n_tried += 1;
                }
            }
        }
        assert!(n_tried > 200, "{n_tried}");
    }

    #[test]
    fn an_option_without_effect_is_refused() {
        let words = "shapematch match a b --method icp --lambda 2".split(' ');
        let cli = Cli::try_parse_from(words).unwrap();
        let Some(Task::Match(args)) = cli.command else {
            panic!("no match");
        };
        let error = asked(&args).unwrap_err().to_string();
        assert!(
            error.contains("--lambda") && error.contains("all"),
            "{error}"
        );
    }

    #[test]
    fn a_written_command_line_is_understood_as_what_it_was_written_from() {
        let all = variations();
        assert!(all.len() > 200);
        for asked in all {
            let words = typed(&asked);
            assert_eq!(understood(&words), asked, "{words:?}");
        }
    }

    #[test]
    fn a_start_pose_is_a_word_or_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("pose.txt");
        fs::write(&file, "1 0 0 -5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n").unwrap();
        let typed = [file.to_str().unwrap(), "-1 0 0 7 0 -1 0 0 0 0 1 0 0 0 0 1"];
        let x = typed.map(|word| {
            let words = ["shapematch", "match", "a", "b", "--start-pose", word];
            let asked = understood(&words.map(String::from));
            assert_eq!(
                asked.recipe.settings.starts.method,
                StartMethod::CurrentPose
            );
            asked.current.translation.x
        });
        assert_eq!(x, [-5.0, 7.0]);
    }
}
