//! `shapematch match`: from two files to the matrix.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context as _;

use super::args::{CardName, MatchArgs, MethodName, PairName, ResidualName, StartName};
use super::text::short;
use super::{EXIT_POOR, match_text, print, progress, takes_stdout, write_json, write_output};
use crate::assess::Verdict;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::load::{LoadSettings, LoadedPart, load, parse_selection};
use crate::pipeline::match_parts::{MatchRecipe, MatchRun, match_parts};
use crate::pipeline::{cards as pipeline_cards, export, record};
use crate::registration::{
    Floor, Hand, MatchSettings, Method, Metric, Motion, PairWith, Selection, StartMethod,
};
use crate::report::{CardForm, MatchRecord, MatrixForm, parse_matrix};

/// Reads, matches, writes what was asked for, and prints the report.
pub fn run(args: &MatchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let monitor = progress::monitor(quiet);
    let current = initial_pose(args)?;
    let recipe = recipe(args);
    let (crash, stamped) = load_both(args, &monitor)?;
    let run = match_parts(&crash, &stamped, None, &recipe, &current, &monitor)?;
    let record = record::match_record(&run, &crash, &stamped);
    drop(monitor);
    for warning in &record.warnings {
        log::warn!("{warning}");
    }
    if !takes_stdout(args.output.json.as_deref()) {
        print(&match_text::report(&record, &crash, &stamped))?;
    }
    write_files(args, &crash, &stamped, &run, &record)?;
    Ok(match run.assessment.verdict {
        Verdict::Good | Verdict::Check => ExitCode::SUCCESS,
        Verdict::Poor => ExitCode::from(EXIT_POOR),
    })
}

fn load_both(args: &MatchArgs, monitor: &Monitor) -> anyhow::Result<(LoadedPart, LoadedPart)> {
    let choice = &args.choice;
    let settings = |part: Option<&str>, length_factor: f64| LoadSettings {
        selection: part.map(parse_selection).unwrap_or_default(),
        length_factor,
        ..LoadSettings::default()
    };
    let crash = settings(choice.crash_part.as_deref(), 1.0);
    let stamped = settings(choice.stamped_part.as_deref(), choice.stamped_unit);
    let (crash, stamped) = rayon::join(
        || load(&args.crash, &crash, monitor),
        || load(&args.stamped, &stamped, monitor),
    );
    Ok((crash?, stamped?))
}

/// The pose of `--initial-pose`, else the files as they lie.
fn initial_pose(args: &MatchArgs) -> anyhow::Result<Similarity> {
    let Some(path) = &args.starts.initial_pose else {
        return Ok(Similarity::identity());
    };
    let text =
        fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let parsed = parse_matrix(&text).with_context(|| format!("no pose in {}", path.display()))?;
    for note in &parsed.notes {
        log::warn!("{}: {note}", path.display());
    }
    Ok(parsed.motion)
}

fn recipe(args: &MatchArgs) -> MatchRecipe {
    let typed = &args.method;
    let method = match typed.method {
        MethodName::Fractional => Method::Fractional,
        MethodName::Trimmed if typed.overlap.is_some() => Method::Trimmed,
        MethodName::Trimmed => Method::TrimmedSearch,
        MethodName::Icp => Method::Icp,
        MethodName::Umeyama => Method::Umeyama,
        MethodName::Paper => Method::Paper,
    };
    let mut settings = MatchSettings::of(method);
    match typed.pairs {
        Some(PairName::Node) => settings.pair_with = PairWith::Node,
        Some(PairName::Triangle) => settings.pair_with = PairWith::Triangle,
        None => {}
    }
    match typed.residual {
        Some(ResidualName::PointToPoint) => settings.metric = Metric::PointToPoint,
        Some(ResidualName::PointToPlane) => settings.metric = Metric::PointToPlane,
        Some(ResidualName::Symmetric) => settings.metric = Metric::Symmetric,
        None => {}
    }
    if let (Some(share), Selection::Trimmed { overlap }) = (typed.overlap, &mut settings.selection)
    {
        *overlap = share;
    }
    if let Selection::Fractional { lambda, floor } = &mut settings.selection {
        *lambda = typed.lambda.unwrap_or(*lambda);
        *floor = typed.floor.map_or(*floor, Floor::Length);
    }
    if typed.scale {
        settings.motion = Motion::Similarity;
    }
    if typed.mirror {
        settings.hand = Hand::Either;
    }
    settings.finish &= !typed.no_finish;
    settings.starts.angle_segment_deg = args.starts.angle_segment;
    settings.starts.method = match args.starts.start {
        _ if args.starts.initial_pose.is_some() => StartMethod::CurrentPose,
        StartName::SurfaceNormal => StartMethod::SurfaceNormals,
        StartName::Current => StartMethod::CurrentPose,
        StartName::All => StartMethod::All,
    };
    MatchRecipe {
        settings,
        max_triangles: typed.triangles,
    }
}

fn write_files(
    args: &MatchArgs,
    crash: &LoadedPart,
    stamped: &LoadedPart,
    run: &MatchRun,
    record: &MatchRecord,
) -> anyhow::Result<()> {
    let output = &args.output;
    if let Some(path) = &output.json {
        write_json(path, record)?;
    }
    if let Some(path) = &output.matrix {
        write_output(
            path,
            MatrixForm::Rows.write(&run.crash_from_stamped).as_bytes(),
        )?;
    }
    if let Some(path) = &output.moved {
        let comments = [record.direction.to_owned(), record.build.clone()];
        let silent = Monitor::silent();
        export::write_moved(path, stamped, &run.crash_from_stamped, &comments, &silent)?;
    }
    if let Some(path) = &output.cards {
        let cards = pipeline_cards::cards(output.card_form.into(), run, crash, stamped)?;
        write_output(path, cards.text.as_bytes())?;
        let error = cards.largest_node_error(stamped.surface.mesh.positions());
        if !takes_stdout(output.json.as_deref()) && path != Path::new("-") {
            let error = short(error);
            print(&format!(
                "Cards    {}; rounding moves no node by more than {error}\n",
                path.display()
            ))?;
        }
    }
    Ok(())
}

impl From<CardName> for CardForm {
    fn from(name: CardName) -> Self {
        match name {
            CardName::Stamped => Self::StampedPart,
            CardName::StampedInverse => Self::StampedPartInverse,
            CardName::Transform => Self::IncludeTransform,
        }
    }
}
