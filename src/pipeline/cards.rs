//! LS-DYNA cards for a match, with the fields filled from what was measured.

use super::PipelineError;
use super::load::LoadedPart;
use super::match_parts::MatchRun;
use super::units::PairUnits;
use crate::formats::Selection;
use crate::report::{CardForm, CardOptions, Cards, Receiver, build_id, write_cards};

/// Writes the cards of a match and reads them back.
///
/// RMAX becomes the distance up to which nodes counted as lying on each other; PERCELE one percent
/// less than the measured share of the crash part that is covered, so that the solver stops where
/// much less is mapped than was seen here.
pub fn cards(
    form: CardForm,
    run: &MatchRun,
    crash: &LoadedPart,
    stamped: &LoadedPart,
) -> Result<Cards, PipelineError> {
    for part in [stamped, crash] {
        let factor = part.settings.length_factor;
        if factor != 1.0 {
            let name = part.file_name();
            return Err(PipelineError::CardsNeedOneUnit { name, factor });
        }
    }
    let coverage = &run.assessment.coverage;
    let mut comments = vec![
        format!("{} on {}", stamped.file_name(), crash.file_name()),
        format!(
            "{}, rmse {:.4}",
            run.assessment.verdict.label(),
            coverage.rmse()
        ),
    ];
    comments.extend(PairUnits::sentences(crash, stamped));
    comments.extend(PairUnits::stress_warning(crash, stamped));
    comments.push(build_id());
    let options = CardOptions {
        // The solver reads the unpacked file.
        file_name: stamped.file_name().trim_end_matches(".gz").to_owned(),
        receiver: receiver(crash)?,
        search_radius: coverage.limit,
        mapped_percent: (100.0 * coverage.target_on_source.overlap - 1.0).max(0.0),
        bounds: stamped.mesh.aabb(),
        comments,
        ..CardOptions::default()
    };
    Ok(write_cards(form, &run.crash_from_stamped, &options)?)
}

fn receiver(crash: &LoadedPart) -> Result<Receiver, PipelineError> {
    if let Selection::PartSet(id) = crash.settings.selection {
        return Ok(Receiver::Set(id));
    }
    match crash.chosen_part_ids()[..] {
        [id] => Ok(Receiver::Part(id)),
        ref ids => Err(PipelineError::SeveralReceivers(ids.len())),
    }
}
