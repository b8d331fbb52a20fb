//! LS-DYNA cards for a match, with the fields filled from what was measured.

mod shared_ids;

use std::path::{Component, Path, PathBuf};

use crate::assess::{Reason, Verdict};
use crate::formats::{Format, Selection};
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::MatchRun;
use crate::pipeline::units::PairUnits;
use crate::report::cards::{check_file_name, file_name_fault, two_sheets};
use crate::report::{CardForm, CardOptions, Cards, IdOffsets, Receiver, build_id, write_cards};
use crate::role::PerRole;
use crate::text::Lengths;
use shared_ids::SharedIds;

/// Writes the cards of a match and reads them back. They name the stamped file as it lies from `folder`, where
/// they will stand; by its name alone without one.
///
/// RMAX becomes the distance up to which nodes counted as lying on each other; PERCELE one percent
/// less than the measured share of the crash part that is covered, so that the solver stops where
/// much less is mapped than was seen here.
pub fn cards(
    form: CardForm,
    run: &MatchRun,
    parts: PerRole<&LoadedPart>,
    folder: Option<&Path>,
) -> Result<Cards, PipelineError> {
    check(form, parts)?;
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
    // No sign beyond ASCII comes into the deck by it.
    let alternative = run.told_alternative();
    comments.extend(alternative.map(|told| told.replace('×', "x")));
    let reasons = run.assessment.reasons.iter();
    let alike = reasons.filter(|reason| matches!(reason, Reason::AlikeParts { .. }));
    comments.extend(alike.map(|reason| reason.words(lengths)));
    comments.extend(PairUnits::sentences(parts));
    comments.extend(PairUnits::stress_warning(parts));
    comments.extend(no_deck(stamped));
    let mut offsets = IdOffsets::default();
    if form == CardForm::IncludeTransform
        && let Some(shared) = SharedIds::of(parts)
    {
        offsets = shared.offsets();
        comments.push(shared.told(stamped));
    }
    comments.push(build_id());
    let options = CardOptions {
        file_name: folder
            .and_then(|folder| name_from(folder, stamped))
            .unwrap_or_else(|| included_name(&stamped.file_name()).to_owned()),
        receiver: receiver(form, crash)?,
        search_radius: coverage.limit,
        mapped_percent: (100.0 * coverage.target_on_source.overlap - 1.0).max(0.0),
        transformation_id: shared_ids::free_transformation(parts),
        bounds: stamped.mesh.aabb(),
        offsets,
        deck_layout: crash.model.layout,
        stamped_layout: stamped.model.layout,
        comments,
    };
    Ok(write_cards(form, &run.crash_from_stamped, &options)?)
}

/// What is to be told of cards: what rounding costs, and why they may not be what is wanted.
pub fn notes(
    form: CardForm,
    run: &MatchRun,
    parts: PerRole<&LoadedPart>,
    cards: &Cards,
) -> Vec<String> {
    let error = cards.largest_node_error(parts.stamped.mesh.positions());
    let unit = Lengths::new(PairUnits::of(parts.map(Some)).lengths).suffix();
    let verdict = run.assessment.verdict;
    let poor = (verdict == Verdict::Poor).then(|| {
        let advice = verdict.advice(None).trim_end_matches('.').to_lowercase();
        format!("the pose is {}: {advice}", verdict.label())
    });
    let is_stamped = form != CardForm::IncludeTransform;
    let two_sheets = two_sheets(&run.crash_from_stamped, &parts.stamped.mesh.aabb());
    let shared = SharedIds::of(parts).filter(|_| !is_stamped);
    let rounding = format!("read back: rounding moves no node by more than {error:.1e}{unit}");
    let all = [
        Some(rounding),
        poor,
        two_sheets.filter(|_| is_stamped),
        shared.map(|shared| shared.told(parts.stamped)),
        receiver_note(parts.crash).filter(|_| is_stamped),
        no_deck(parts.stamped),
    ];
    all.into_iter().flatten().collect()
}

/// Says that the part the cards name takes no forming results, or is more than what was matched.
fn receiver_note(crash: &LoadedPart) -> Option<String> {
    if !crash.has_shells() {
        let note =
            "the crash part has no shells, and the solver maps forming results onto shells only";
        return Some(note.to_owned());
    }
    let set = match crash.settings.selection {
        Selection::ShellSet(id) => format!("shell set {id}"),
        Selection::NodeSet(id) => format!("node set {id}"),
        _ => return None,
    };
    Some(format!(
        "the cards name the whole part, of which only {set} was matched"
    ))
}

/// Says that the solver cannot read the stamped file.
fn no_deck(stamped: &LoadedPart) -> Option<String> {
    let format = stamped.model.format;
    (format != Format::Keyword).then(|| {
        format!(
            "{} is {}, which the solver cannot include; write it as a keyword file (--converted) and name that on the \
             cards",
            stamped.file_name(),
            format.label()
        )
    })
}

/// What can be known before a match: that the cards can name the file and hold its unit, and that
/// one part or set receives the results.
pub fn check(form: CardForm, parts: PerRole<&LoadedPart>) -> Result<(), PipelineError> {
    for part in [parts.stamped, parts.crash] {
        let factor = part.settings.length_factor;
        if factor != 1.0 {
            let name = part.file_name();
            return Err(PipelineError::CardsNeedOneUnit { name, factor });
        }
    }
    check_file_name(included_name(&parts.stamped.file_name()))?;
    receiver(form, parts.crash).map(|_| ())
}

/// The name of a stamped file as a deck includes it: the solver reads the unpacked file.
pub fn included_name(stamped: &str) -> &str {
    stamped.trim_end_matches(".gz")
}

/// The same as it lies from a folder. `None` if that is not known, or no name that a card holds.
fn name_from(folder: &Path, stamped: &LoadedPart) -> Option<String> {
    let whole = |folder: &Path| {
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        std::fs::canonicalize(folder).ok()
    };
    let there = whole(stamped.path.parent()?)?;
    let way = way_from(&whole(folder)?, &there)?;
    let mut name = String::new();
    for folder in &way {
        name.push_str(folder.to_str()?);
        // Solvers take it on every system.
        name.push('/');
    }
    name.push_str(included_name(&stamped.file_name()));
    file_name_fault(&name).is_none().then_some(name)
}

/// The relative path from one folder to another; both are absolute.
fn way_from(here: &Path, there: &Path) -> Option<PathBuf> {
    let (mut here, mut there) = (here.components().peekable(), there.components().peekable());
    let mut has_common = false;
    while here.peek().is_some() && here.peek() == there.peek() {
        here.next();
        there.next();
        has_common = true;
    }
    let up = here.map(|_| Component::ParentDir);
    has_common.then(|| up.chain(there).collect())
}

/// Who receives the forming results; `*INCLUDE_TRANSFORM` names nobody.
fn receiver(form: CardForm, crash: &LoadedPart) -> Result<Receiver, PipelineError> {
    if form == CardForm::IncludeTransform {
        return Ok(Receiver::Part(0));
    }
    if let Selection::PartSet(id) = crash.settings.selection {
        return Ok(Receiver::Set(id));
    }
    match crash.chosen_part_ids()[..] {
        [id] => Ok(Receiver::Part(id)),
        ref ids => Err(PipelineError::SeveralReceivers(ids.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_between_folders() {
        for (here, there, way) in [
            ("/a/b", "/a/b", ""),
            ("/a", "/a/b/c", "b/c"),
            ("/a/b/c", "/a/d", "../../d"),
        ] {
            let found = way_from(Path::new(here), Path::new(there));
            assert_eq!(found, Some(PathBuf::from(way)), "{here} to {there}");
        }
        assert_eq!(way_from(Path::new("a"), Path::new("/b")), None);
    }
}
