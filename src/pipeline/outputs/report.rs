//! The report of a match: measures, draws and collects what [`crate::report::html`] lays out.

use super::cards::cards;
use super::record::match_record;
use super::report_figures::FigureRenderer;
use crate::assess::deviation::{Deviation, DeviationSettings, compare};
use crate::assess::{Ambiguity, PoseUncertainty, Twin, fit_beside};
use crate::colormap::{ColorMap, ColorScale};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::MatchRun;
use crate::registration::{Extent, StartGroup, Surface, group_starts};
use crate::report::html::{CardsInfo, Figure, Figures, Report};
use crate::report::{AlternativeRecord, CardForm, MatchRecord};
use crate::role::PerRole;
use crate::text::Lengths;

/// Groups of starts that get a picture.
const N_PICTURED_GROUPS: usize = 8;

/// Writes the report of a run as one HTML file. Draws about twenty small pictures, so its time grows
/// with the triangles of both meshes.
pub fn report(
    run: &MatchRun,
    parts: PerRole<&LoadedPart>,
    monitor: &Monitor,
) -> Result<String, PipelineError> {
    let PerRole { crash, stamped } = parts;
    let record = match_record(run, parts);
    monitor.progress("measure", 0, None);
    let (target, source) = (&crash.surface, &stamped.surface);
    let pose = &run.crash_from_stamped;
    let settings = DeviationSettings {
        limit: Some(run.assessment.coverage.limit),
        thickness: crash.mean_thickness().or_else(|| stamped.mean_thickness()),
        ..DeviationSettings::default()
    };
    let deviation = compare(source, target, pose, &settings, monitor)?;
    let scale = color_scale(&deviation, run.assessment.noise);
    let measures = source.measures();
    let groups = group_starts(&run.outcome.starts, &Extent::from(&stamped.mesh.aabb()));
    let distances: Vec<(f64, f64)> = groups
        .iter()
        .map(|group| {
            let last = &run.outcome.starts[group.best()].last;
            let apart = (last.apply(&measures.centroid) - pose.apply(&measures.centroid)).norm();
            (apart, last.angle_to(pose).to_degrees())
        })
        .collect();
    let lengths = Lengths::new(record.units.length);
    let renderer = FigureRenderer::new(parts, *pose, &deviation, scale, lengths, monitor)?;
    let mut figures = draw(&renderer, run, &groups, monitor)?;
    figures.rivals = rivals(&renderer, run, source, &record)?;
    let stated = run.assessment.uncertainty();
    let uncertainty_scale = stated.map(uncertainty_scale);
    if let (Some(stated), Some(scale)) = (stated, uncertainty_scale) {
        figures.uncertainty = renderer.uncertainty(stated, &scale)?;
    }
    let cards = cards_of(run, parts);
    let report = Report {
        record: &record,
        outcome: &run.outcome,
        groups: &groups,
        group_distances: &distances,
        deviation: &deviation,
        scale,
        uncertainty_scale,
        figures: &figures,
        cards: &cards,
    };
    Ok(report.write())
}

/// Colours from nothing to the largest uncertainty.
fn uncertainty_scale(stated: &PoseUncertainty) -> ColorScale {
    let most = Some(stated.largest).filter(|most| most.is_finite() && *most > 0.0);
    ColorScale::new(ColorMap::Viridis, 0.0, most.unwrap_or(1.0))
}

/// Both parts at each pose that fits nearly as well, with how it differs.
fn rivals(
    renderer: &FigureRenderer<'_>,
    run: &MatchRun,
    source: &Surface,
    record: &MatchRecord,
) -> Result<Vec<Figure>, PipelineError> {
    let lengths = Lengths::new(record.units.length);
    let mut figures = Vec::new();
    let near = Ambiguity::near(&run.outcome.alternatives);
    for (other, AlternativeRecord { number, .. }) in near.iter().zip(&record.alternatives) {
        let pose = &other.target_from_source;
        let twin = Twin::of(source, &run.crash_from_stamped, pose);
        let title = format!("{number}: {}", twin.words(lengths));
        let caption = format!("({}).", fit_beside(other.score_ratio, other.by_shape));
        figures.push(renderer.rival(pose, title, caption)?);
    }
    Ok(figures)
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
    renderer: &FigureRenderer<'_>,
    run: &MatchRun,
    groups: &[StartGroup],
    monitor: &Monitor,
) -> Result<Figures, PipelineError> {
    let mut figures = Figures::default();
    monitor.progress("draw", 0, None);
    figures.parts = renderer.parts()?;
    figures.overlays = renderer.overlays()?;
    figures.maps = renderer.maps()?;
    figures.spots = renderer.spots()?;
    for group in groups.iter().take(N_PICTURED_GROUPS) {
        let pose = &run.outcome.starts[group.best()].last;
        let number = figures.starts.len() + 1;
        figures.starts.push(renderer.start(pose, number)?);
    }
    Ok(figures)
}

/// The cards that map the stamped part, and those that place it.
fn cards_of(run: &MatchRun, parts: PerRole<&LoadedPart>) -> Vec<CardsInfo> {
    let forms = [CardForm::StampedPart, CardForm::IncludeTransform];
    forms
        .into_iter()
        .map(|form| CardsInfo {
            name: form.label(),
            text: match cards(form, run, parts, None) {
                Ok(cards) => {
                    let error = cards.largest_node_error(parts.stamped.mesh.positions());
                    Ok((cards.text, error))
                }
                Err(error) => Err(error.to_string()),
            },
        })
        .collect()
}
