//! From what was typed to what a match depends on. [`crate::report::command_line`] goes the other way.

use std::fs;

use anyhow::Context as _;

use super::args::{ChoiceArgs, MatchArgs, MethodArgs, SearchArgs, StartArgs};
use crate::formats::ReadOptions;
use crate::geometry::Similarity;
use crate::pipeline::load::{LoadSettings, parse_selection};
use crate::pipeline::match_parts::MatchRecipe;
use crate::registration::{
    Hand, MatchSettings, Method, Motion, Selection, StartMethod, StartSettings,
};
use crate::report::parse_matrix;

/// Everything a match depends on besides the two files.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// How the crash file is read.
    pub crash: LoadSettings,
    /// How the stamped file is read.
    pub stamped: LoadSettings,
    /// Method and parameters.
    pub recipe: MatchRecipe,
    /// Ceilings of the crash and the stamped mesh the starts run on.
    pub max_triangles: [Option<usize>; 2],
    /// Where the stamped part lies at the start (crash from stamped).
    pub current: Similarity,
}

/// Understands the options of `shapematch match`; reads the files of `--start-pose`.
pub fn asked(args: &MatchArgs) -> anyhow::Result<Asked> {
    let poses: anyhow::Result<Vec<Similarity>> = args
        .starts
        .start_pose
        .iter()
        .map(|text| pose(text))
        .collect();
    let (settings, current) = settings(&args.method, &args.search, &args.starts, poses?)?;
    let [crash, stamped] = load_settings(&args.choice);
    let search = &args.search;
    let level = |own: Option<usize>| own.or(search.triangles);
    Ok(Asked {
        crash,
        stamped,
        recipe: MatchRecipe {
            settings,
            max_triangles: search.triangles,
        },
        max_triangles: [
            level(search.crash_triangles),
            level(search.stamped_triangles),
        ],
        current,
    })
}

/// A pose from the word itself or from the file it names.
fn pose(word: &str) -> anyhow::Result<Similarity> {
    if let Ok(parsed) = parse_matrix(word) {
        return Ok(parsed.motion);
    }
    let text = fs::read_to_string(word).with_context(|| format!("cannot read {word}"))?;
    let parsed = parse_matrix(&text).with_context(|| format!("no pose in {word}"))?;
    for note in &parsed.notes {
        log::warn!("{word}: {note}");
    }
    Ok(parsed.motion)
}

fn load_settings(choice: &ChoiceArgs) -> [LoadSettings; 2] {
    let settings = |part: Option<&str>, length_factor: f64, units| LoadSettings {
        selection: part.map(parse_selection).unwrap_or_default(),
        length_factor,
        units,
        read: ReadOptions {
            include_folders: choice.include_folder.clone(),
        },
    };
    [
        settings(
            choice.crash_part.as_deref(),
            choice.crash_unit,
            choice.crash_units,
        ),
        settings(
            choice.stamped_part.as_deref(),
            choice.stamped_unit,
            choice.stamped_units,
        ),
    ]
}

/// The settings and the pose to start from.
fn settings(
    typed: &MethodArgs,
    search: &SearchArgs,
    starts: &StartArgs,
    poses: Vec<Similarity>,
) -> anyhow::Result<(MatchSettings, Similarity)> {
    let is_searched = typed.overlap.is_none() && typed.keep.is_none();
    let method = match typed.method {
        Method::Trimmed if is_searched => Method::TrimmedSearch,
        method => method,
    };
    let usual = MatchSettings::of(method);
    let (starts, current) = start_settings(starts, &usual.starts, poses)?;
    let hand = if typed.mirror {
        Some(Hand::Either)
    } else {
        typed.hand
    };
    let settings = MatchSettings {
        method,
        pair_with: typed.pairs.unwrap_or(usual.pair_with),
        selection: selection(typed, usual.selection),
        metric: typed.residual.unwrap_or(usual.metric),
        motion: if typed.scale {
            Motion::Similarity
        } else {
            usual.motion
        },
        hand: hand.unwrap_or(usual.hand),
        starts,
        search: search.search.unwrap_or(usual.search),
        finish: search.finish.unwrap_or(usual.finish),
        data_side: typed.points_of.unwrap_or(usual.data_side),
        allowance: typed.allowance.unwrap_or(usual.allowance),
        max_normal_angle_deg: typed.normal_angle.unwrap_or(usual.max_normal_angle_deg),
        n_race_points: search.race_points.unwrap_or(usual.n_race_points),
        n_refine_points: search.refine_points.unwrap_or(usual.n_refine_points),
        max_iterations: typed.iterations.unwrap_or(usual.max_iterations),
        motion_tolerance: typed.tolerance.unwrap_or(usual.motion_tolerance),
    };
    Ok((settings, current))
}

fn selection(typed: &MethodArgs, usual: Selection) -> Selection {
    let kind = typed.keep.as_deref().unwrap_or(usual.name());
    match Selection::of_kind(kind, usual).unwrap_or(usual) {
        Selection::Trimmed { overlap } => Selection::Trimmed {
            overlap: typed.overlap.unwrap_or(overlap),
        },
        Selection::Fractional { lambda, floor } => Selection::Fractional {
            lambda: typed.lambda.unwrap_or(lambda),
            floor: typed.floor.unwrap_or(floor),
        },
        plain => plain,
    }
}

fn start_settings(
    typed: &StartArgs,
    usual: &StartSettings,
    poses: Vec<Similarity>,
) -> anyhow::Result<(StartSettings, Similarity)> {
    let method = typed.start.unwrap_or(match poses.len() {
        0 => usual.method,
        1 => StartMethod::CurrentPose,
        _ => StartMethod::GivenPoses,
    });
    let (current, poses) = match (method, &poses[..]) {
        (StartMethod::CurrentPose, []) => (Similarity::identity(), Vec::new()),
        (StartMethod::CurrentPose, [pose]) => (*pose, Vec::new()),
        (StartMethod::CurrentPose, _) => {
            anyhow::bail!("--start current takes one --start-pose; --start given takes several")
        }
        (StartMethod::SurfaceNormals, [_, ..]) => {
            anyhow::bail!("--start surface-normal makes its own poses; leave --start-pose out")
        }
        _ => (Similarity::identity(), poses),
    };
    let starts = StartSettings {
        method,
        angle_segment_deg: typed.angle_segment.unwrap_or(usual.angle_segment_deg),
        both_signs: typed.both_directions.unwrap_or(usual.both_signs),
        poses,
        widen: typed.widen.unwrap_or(usual.widen),
    };
    Ok((starts, current))
}

#[cfg(test)]
mod tests {
    use super::super::args::{Cli, Task};
    use super::*;
    use crate::formats;
    use crate::geometry::{Pose, Vector3};
    use crate::registration::{DataSide, Floor, Metric, PairWith, Search};
    use crate::report::command_line::{CommandLine, CommandSide};
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
            selection: &load.selection,
            length_factor: load.length_factor,
            units: load.units,
        };
        let leak =
            |load: &LoadSettings| -> &'static LoadSettings { Box::leak(Box::new(load.clone())) };
        CommandLine {
            crash: side("crash.k", leak(&asked.crash)),
            stamped: side("stamped.k", leak(&asked.stamped)),
            include_folders: &asked.crash.read.include_folders,
            settings: &asked.recipe.settings,
            max_triangles: asked.max_triangles,
            current: &asked.current,
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
            |a| a.recipe.settings.selection = Selection::All,
            |a| a.recipe.settings.selection = Selection::TrimmedSearch,
            |a| a.recipe.settings.selection = Selection::Trimmed { overlap: 0.1 + 0.2 },
            |a| {
                a.recipe.settings.selection = Selection::Fractional {
                    lambda: 1.3,
                    floor: Floor::Length(1e-7),
                }
            },
            |a| {
                a.recipe.settings.selection = Selection::Fractional {
                    lambda: 1.5,
                    floor: Floor::None,
                }
            },
            |a| a.recipe.settings.motion = Motion::Similarity,
            |a| a.recipe.settings.hand = Hand::Mirrored,
            |a| a.recipe.settings.hand = Hand::Either,
            |a| a.recipe.settings.search = Search::EveryStart,
            |a| a.recipe.settings.finish ^= true,
            |a| a.recipe.settings.data_side = DataSide::Target,
            |a| a.recipe.settings.allowance = 1.0 / 3.0,
            |a| a.recipe.settings.max_normal_angle_deg = 45.5,
            |a| a.recipe.settings.n_race_points = 501,
            |a| a.recipe.settings.n_refine_points = 7,
            |a| a.recipe.settings.max_iterations = 50,
            |a| a.recipe.settings.motion_tolerance = 1e-9,
            |a| a.recipe.settings.starts.angle_segment_deg = 33.3,
            |a| a.recipe.settings.starts.both_signs ^= true,
            |a| a.recipe.settings.starts.widen ^= true,
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
                a.max_triangles = [Some(2000); 2];
            },
            |a| a.max_triangles = [None, Some(500)],
            |a| a.max_triangles = [Some(700), Some(500)],
            |a| {
                let folders = vec!["my includes".into(), "b".into()];
                a.crash.read.include_folders = folders;
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
        Method::ALL.into_iter().flat_map(of_method).collect()
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
