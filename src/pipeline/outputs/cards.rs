//! LS-DYNA cards for a match, with the fields filled from what was measured.

use crate::formats::Selection;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::MatchRun;
use crate::pipeline::units::PairUnits;
use crate::report::cards::check_file_name;
use crate::report::{CardForm, CardOptions, Cards, Receiver, build_id, write_cards};
use crate::role::PerRole;
use crate::text::Lengths;

/// Writes the cards of a match and reads them back.
///
/// RMAX becomes the distance up to which nodes counted as lying on each other; PERCELE one percent
/// less than the measured share of the crash part that is covered, so that the solver stops where
/// much less is mapped than was seen here.
pub fn cards(
    form: CardForm,
    run: &MatchRun,
    parts: PerRole<&LoadedPart>,
) -> Result<Cards, PipelineError> {
    check(parts)?;
    let PerRole { crash, stamped } = parts;
    let coverage = &run.assessment.coverage;
    let units = PairUnits::of(parts.map(Some));
    let lengths = Lengths::new(units.lengths);
    let mut comments = vec![
        format!("{} on {}", stamped.file_name(), crash.file_name()),
        format!(
            "{}, RMS {}",
            run.assessment.verdict.label(),
            lengths.of(coverage.rmse())
        ),
    ];
    comments.extend(PairUnits::sentences(parts));
    comments.extend(PairUnits::stress_warning(parts));
    comments.push(build_id());
    let options = CardOptions {
        file_name: included_name(stamped),
        receiver: receiver(crash)?,
        search_radius: coverage.limit,
        mapped_percent: (100.0 * coverage.target_on_source.overlap - 1.0).max(0.0),
        bounds: stamped.mesh.aabb(),
        comments,
        ..CardOptions::default()
    };
    Ok(write_cards(form, &run.crash_from_stamped, &options)?)
}

/// What can be known before a match: that the cards can name the file and hold its unit, and that
/// one part or set receives the results.
pub fn check(parts: PerRole<&LoadedPart>) -> Result<(), PipelineError> {
    for part in [parts.stamped, parts.crash] {
        let factor = part.settings.length_factor;
        if factor != 1.0 {
            let name = part.file_name();
            return Err(PipelineError::CardsNeedOneUnit { name, factor });
        }
    }
    check_file_name(&included_name(parts.stamped))?;
    receiver(parts.crash).map(|_| ())
}

/// The name of the stamped file as the deck includes it: the solver reads the unpacked file.
fn included_name(stamped: &LoadedPart) -> String {
    stamped.file_name().trim_end_matches(".gz").to_owned()
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
