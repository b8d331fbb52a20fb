//! The report of a match: measures, draws and collects what [`crate::report::html`] lays out.

use super::PipelineError;
use super::cards::cards;
use super::load::LoadedPart;
use super::match_parts::MatchRun;
use super::record::match_record;
use super::report_figures::Draughtsman;
use crate::assess::deviation::{Deviation, DeviationSettings, compare};
use crate::colormap::{ColorMap, ColorScale};
use crate::monitor::Monitor;
use crate::report::html::{CardsInfo, Figures, Report};
use crate::report::{CardForm, StartGroup, start_groups};

/// Groups of starts that get a picture.
const N_PICTURED_GROUPS: usize = 8;

/// Writes the report of a run as one HTML file. Draws about twenty small pictures, so its time grows
/// with the triangles of both meshes.
pub fn report(
    run: &MatchRun,
    crash: &LoadedPart,
    stamped: &LoadedPart,
    monitor: &Monitor,
) -> Result<String, PipelineError> {
    let record = match_record(run, crash, stamped);
    monitor.progress("measure", 0, None);
    let (target, source) = (crash.surface_for_match()?, stamped.surface_for_match()?);
    let pose = &run.crash_from_stamped;
    let settings = DeviationSettings {
        limit: Some(run.assessment.coverage.limit),
        thickness: crash.mean_thickness().or_else(|| stamped.mean_thickness()),
        ..DeviationSettings::default()
    };
    let deviation = compare(&source, &target, pose, &settings, monitor)?;
    let scale = color_scale(&deviation, run.assessment.noise);
    let measures = source.measures();
    let groups = start_groups(&run.outcome, &measures.centroid, measures.diagonal);
    let distances: Vec<(f64, f64)> = groups
        .iter()
        .map(|group| {
            let last = &run.outcome.starts[group.best].last;
            let apart = (last.apply(&measures.centroid) - pose.apply(&measures.centroid)).norm();
            (apart, last.angle_to(pose).to_degrees())
        })
        .collect();
    let draughtsman = Draughtsman::new(
        crash,
        stamped,
        *pose,
        &deviation,
        scale,
        record.units.length,
    );
    let figures = draw(&draughtsman, run, &groups, monitor)?;
    let cards = cards_of(run, crash, stamped);
    let report = Report {
        record: &record,
        outcome: &run.outcome,
        groups: &groups,
        group_distances: &distances,
        deviation: &deviation,
        scale,
        figures: &figures,
        cards: &cards,
    };
    Ok(report.write())
}

/// Colours from − to + the limit that holds nearly all distances, the faceting neutral.
fn color_scale(deviation: &Deviation, noise: f64) -> ColorScale {
    let [a, b] = [&deviation.source_on_target, &deviation.target_on_source];
    let limit = a.stats.round_limit().max(b.stats.round_limit());
    if deviation.is_signed {
        let band = if noise < 0.5 * limit { noise } else { 0.0 };
        ColorScale::symmetric(limit, band)
    } else {
        ColorScale::new(ColorMap::Viridis, 0.0, limit)
    }
}

fn draw(
    draughtsman: &Draughtsman<'_>,
    run: &MatchRun,
    groups: &[StartGroup],
    monitor: &Monitor,
) -> Result<Figures, PipelineError> {
    let mut figures = Figures::default();
    monitor.progress("draw", 0, None);
    figures.parts = draughtsman.parts();
    monitor.check()?;
    figures.overlays = draughtsman.overlays();
    monitor.check()?;
    figures.maps = draughtsman.maps();
    monitor.check()?;
    figures.spots = draughtsman.spots();
    for group in groups.iter().take(N_PICTURED_GROUPS) {
        monitor.check()?;
        let pose = &run.outcome.starts[group.best].last;
        figures
            .starts
            .push(draughtsman.start(pose, figures.starts.len() + 1));
    }
    Ok(figures)
}

/// The cards that map the stamped part, and those that place it.
fn cards_of(run: &MatchRun, crash: &LoadedPart, stamped: &LoadedPart) -> Vec<CardsInfo> {
    let forms = [CardForm::StampedPart, CardForm::IncludeTransform];
    forms
        .into_iter()
        .map(|form| CardsInfo {
            name: form.label(),
            text: match cards(form, run, crash, stamped) {
                Ok(cards) => {
                    let error = cards.largest_node_error(stamped.mesh.positions());
                    Ok((cards.text, error))
                }
                Err(error) => Err(error.to_string()),
            },
        })
        .collect()
}
