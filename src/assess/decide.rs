//! The verdict: the most severe of the reasons against the pose and against both parts having one shape.
//!
//! Every limit is a length that the user sees and can set ([`super::ShapeTolerance`]), a ratio of scores,
//! or a fraction of the smaller part. None depends on the size of the elements.

use std::cmp::Ordering;

use super::ambiguity::{Ambiguity, Clarity};
use super::assessment::Assessment;
use super::borders::{HOLES_THAT_HOLD, LEAST_ACROSS};
use super::coverage::Coverage;
use super::pose::{PoseKind, PoseStatement};
use super::reason::Reason;
use super::shape::{BorderFit, OVERHANGS, ShapeReason, ShapeStatement, only_overhangs};
use super::tolerance::{AssessSettings, ShapeTolerance, UNREMARKABLE};
use super::verdict::Verdict;
use crate::registration::starts::StartKind;
use crate::registration::{MatchOutcome, MirrorCheck, Termination, UnitGuess, guess_unit};

/// Fraction of the smaller part that meets the other one for GOOD.
const ENOUGH_MET: f64 = 0.75;
/// Scores of the opposite hand below this fraction of the result's fit clearly better.
pub(super) const OPPOSITE_HAND: f64 = 0.8;
/// Below this fraction they do whatever else differs between the shapes.
const SURELY_OPPOSITE: f64 = 0.25;
/// Below this one they fit a little better.
pub(super) const NEAR_MIRROR: f64 = 0.98;
/// Several target parts so many times as large as the source hold more than it, …
const SEVERAL_FROM: f64 = 2.0;
/// … and larger than that no whole car is beside one of its parts.
const SEVERAL_TO: f64 = 500.0;
/// Borders hold a part whose surface can slide if at least this share of the smaller part's lies on one of the other.
pub(super) const LEAST_TOGETHER: f64 = 1.0 / 3.0;
/// Beside a hole that has its counterpart this share is enough: an end and a hole hardly ever lie together by chance.
const LEAST_ACROSS_BESIDE_HOLE: f64 = 0.1;
/// Parts whose sizes differ by more than this factor are not in one unit, whatever the units are.
const FAR_APART: f64 = 50.0;

/// Parts of which each has a piece that the other lacks share at least so much of the smaller one.
const LEAST_SHARED: f64 = 0.35;

/// What a verdict is decided by beside what is measured.
pub(super) struct Grounds<'a> {
    pub(super) outcome: &'a MatchOutcome,
    pub(super) shape: &'a ShapeStatement,
    /// Share of the smaller part's outlines across the free motion that lies together, if there are any.
    pub(super) held_across: Option<f64>,
    /// The statement about the shape of the opposite hand.
    pub(super) mirrored: Option<&'a ShapeStatement>,
    /// How far the scale of the pairs may be off.
    pub(super) most_scaled: f64,
    pub(super) settings: &'a AssessSettings,
}

/// Sets the verdict, its reasons, the most severe first, and the statement about the pose.
pub(super) fn decide(assessment: &mut Assessment, grounds: &Grounds<'_>) {
    let Grounds {
        outcome,
        shape,
        mirrored,
        settings,
        ..
    } = *grounds;
    let several = several_parts(assessment, settings.n_target_parts);
    let read = read_errors(settings);
    let sizes = || sizes_far_apart(assessment).filter(|_| several.is_none());
    let unit = unit(assessment, settings);
    if let Some(units) = unit.or_else(sizes) {
        // Whatever lies on the wrong size by chance is no evidence of pose and shape.
        assessment.verdict = units.severity();
        assessment.reasons = several.into_iter().chain([units]).chain(read).collect();
        if let Some(pose) = &mut assessment.pose {
            pose.kind = PoseKind::NotFound;
            pose.uncertainty = None;
        }
        return;
    }
    let of_pose = [
        ending(outcome),
        sliding(assessment, grounds),
        ambiguity(assessment),
        others_not_sought(outcome),
        uncertainty(assessment),
    ];
    let hand = hand(assessment, shape, mirrored);
    let is_open = hand.is_some() || of_pose.iter().any(Option::is_some);
    let is_held = is_held(assessment);
    let is_held_by_holes = is_firm(assessment) && is_held_by_holes(&shape.borders);
    let is_one = !is_open && is_held && shares_a_piece(shape);
    let of_shape = [
        hand,
        scale(assessment, grounds),
        overlap(&assessment.coverage, shape, is_held || is_held_by_holes),
        elsewhere(shape),
    ];
    let found = of_pose.into_iter().chain(of_shape).chain([read]).flatten();
    let differences = shape.reasons.iter().filter(|_| !is_one);
    let differences = differences.map(|&difference| Reason::Shape { difference });
    let mut reasons: Vec<Reason> = found.chain(differences).collect();
    let verdict = reasons.iter().map(Reason::severity).max();
    let verdict = verdict.unwrap_or(Verdict::Good);
    if verdict == Verdict::Good {
        reasons.push(Reason::InOrder {
            overlap: shape.met,
            p95: assessment.coverage.p95(),
            rivals_sought: outcome.rivals_sought,
        });
    }
    if let Some(pose) = &mut assessment.pose {
        pose.kind = pose_kind(&reasons);
    }
    if verdict == Verdict::Poor {
        // Where there is no pose, it does not matter how well one of them is held.
        reasons.retain(|reason| !is_about_hold(reason));
    }
    reasons.sort_by_key(|reason| std::cmp::Reverse(reason.severity()));
    // Nothing else that was found means anything beside it.
    reasons.splice(..0, several.filter(|_| verdict == Verdict::Poor));
    assessment.verdict = verdict;
    assessment.reasons = reasons;
}

/// True for what says how free a pose is, and not that it is none.
fn is_about_hold(reason: &Reason) -> bool {
    use Reason::{EqualAlternative, NearAlternative, Sliding, Uncertain};
    matches!(
        reason,
        EqualAlternative { .. } | NearAlternative { .. } | Sliding { .. } | Uncertain { .. }
    )
}

/// Adds a reason that the two parts alone do not give, and what follows from it.
pub(super) fn decide_with(assessment: &mut Assessment, reason: Reason) {
    let reasons = &mut assessment.reasons;
    reasons.retain(|known| !matches!(known, Reason::InOrder { .. }));
    if let Some(pose) = &mut assessment.pose {
        pose.kind = pose.kind.max(pose_kind(std::slice::from_ref(&reason)));
    }
    assessment.verdict = assessment.verdict.max(reason.severity());
    reasons.push(reason);
    reasons.sort_by_key(|reason| std::cmp::Reverse(reason.severity()));
}

/// The statement about the pose that follows from the reasons.
fn pose_kind(reasons: &[Reason]) -> PoseKind {
    let of = |reason: &Reason| match reason {
        // Of another part, the other hand or another unit there is no pose, however well this one is held.
        poor if poor.severity() == Verdict::Poor => PoseKind::NotFound,
        Reason::EqualAlternative { .. }
        | Reason::NearAlternative { .. }
        | Reason::AlikeParts { .. } => PoseKind::Ambiguous,
        Reason::Sliding { .. }
        | Reason::Elsewhere { .. }
        | Reason::Uncertain { .. }
        | Reason::OthersNotSought
        | Reason::Stopped => PoseKind::Uncertain,
        _ => PoseKind::Certain,
    };
    reasons.iter().map(of).max().unwrap_or(PoseKind::Certain)
}

/// The opposite hand, where its score speaks for it and its shape does not speak against it.
fn hand(
    assessment: &Assessment,
    shape: &ShapeStatement,
    mirrored: Option<&ShapeStatement>,
) -> Option<Reason> {
    let MirrorCheck {
        score_ratio,
        by_borders,
        ..
    } = assessment.mirror_check;
    let score_ratio = score_ratio?;
    if mirrored.is_some_and(|mirrored| fits_better(shape, mirrored)) {
        return None;
    }
    let is_sure = score_ratio < SURELY_OPPOSITE;
    let fits_better = |mirrored| fits_better(mirrored, shape);
    if is_sure || score_ratio < OPPOSITE_HAND && mirrored.is_none_or(fits_better) {
        return Some(Reason::OppositeHand {
            score_ratio,
            by_borders,
        });
    }
    (score_ratio < NEAR_MIRROR).then_some(Reason::NearMirrorImage {
        score_ratio,
        by_borders,
    })
}

/// Springback raises the scores of both hands, but not by the same. One shape fits better where less remains of
/// it besides bends, if that is more than is accepted of the other; else where it has fewer differences other
/// than a bend; else where less remains.
fn fits_better(shape: &ShapeStatement, than: &ShapeStatement) -> bool {
    let remains_less = |shape: &ShapeStatement, than: &ShapeStatement, share: f64| {
        shape.remainder < OPPOSITE_HAND * than.remainder
            && than.remainder > share * than.tolerance.remainder
    };
    let n_differences = |shape: &ShapeStatement| {
        let reasons = shape.reasons.iter();
        reasons.filter(|reason| !reason.is_bend()).count()
    };
    if remains_less(shape, than, 1.0) {
        return true;
    }
    if remains_less(than, shape, 1.0) {
        return false;
    }
    match n_differences(shape).cmp(&n_differences(than)) {
        Ordering::Less => true,
        Ordering::Equal => remains_less(shape, than, UNREMARKABLE),
        Ordering::Greater => false,
    }
}

/// More parts than the source belongs to, by their size.
fn several_parts(assessment: &Assessment, n_parts: usize) -> Option<Reason> {
    let size_ratio = assessment.scale_check.size_ratio;
    let is_whole = n_parts > 1 && (SEVERAL_FROM..SEVERAL_TO).contains(&size_ratio);
    is_whole.then_some(Reason::SeveralParts {
        n_parts,
        size_ratio,
    })
}

/// Of a file that was read in part the rest was not compared.
fn read_errors(settings: &AssessSettings) -> Option<Reason> {
    let (in_source, in_target) = (settings.n_source_errors, settings.n_target_errors);
    (in_source + in_target > 0).then_some(Reason::ReadErrors {
        in_source,
        in_target,
    })
}

/// Several parts that are smaller together than the source are in another unit, but their size does not tell in which.
/// What is said of the units may be older than the file; a piece of a part differs from it by any factor.
fn unit(assessment: &Assessment, settings: &AssessSettings) -> Option<Reason> {
    let check = &assessment.scale_check;
    let size_ratio = check.size_ratio;
    let is_possible = settings.n_target_parts <= 1 || size_ratio > 1.0;
    let is_one_unit = |unit: &UnitGuess| settings.is_one_unit && !unit.is_factor_of(size_ratio);
    let unit = check.unit.filter(|unit| is_possible && !is_one_unit(unit));
    unit.map(|unit| Reason::DifferentUnits { size_ratio, unit })
}

/// Sizes that differ by far more than parts that belong together, by the factor of no unit that is known.
fn sizes_far_apart(assessment: &Assessment) -> Option<Reason> {
    let size_ratio = assessment.scale_check.size_ratio;
    let is_far = size_ratio.ln().abs() > FAR_APART.ln();
    is_far.then_some(Reason::SizesFarApart { size_ratio })
}

/// A scale that would move the ends of the part by more than springback may: beside that of a rigid pose, else beside
/// the factor between two units.
fn scale(assessment: &Assessment, grounds: &Grounds<'_>) -> Option<Reason> {
    let scale = assessment.scale_check.pair_scale;
    let expected = if grounds.settings.is_scale_free {
        guess_unit(scale).map_or(1.0, UnitGuess::factor)
    } else {
        grounds.outcome.target_from_source.scale
    };
    let is_off = (scale / expected - 1.0).abs() > grounds.most_scaled;
    is_off.then_some(Reason::PairScale { scale })
}

/// Whether the surfaces alone hold the part, within its tolerance.
fn is_held(assessment: &Assessment) -> bool {
    is_firm(assessment) && assessment.freedom.is_none()
}

/// Whether the pose is certain within its tolerance.
fn is_firm(assessment: &Assessment) -> bool {
    assessment.pose.as_ref().is_some_and(PoseStatement::is_firm)
}

/// Whether holes hold the part, and none speaks against its pose.
fn is_held_by_holes(borders: &BorderFit) -> bool {
    borders.n_holes >= HOLES_THAT_HOLD && borders.n_alone() == 0
}

/// Whether all that speaks against one shape is that little of the parts meets, while the rest of the smaller one lies
/// beyond the borders of the other. Pieces cut from both ends of one part meet so, and hardly ever two different parts.
fn shares_a_piece(shape: &ShapeStatement) -> bool {
    let hardly_meets = matches!(shape.reasons[..], [ShapeReason::HardlyMet { .. }]);
    let overhangs = |share| only_overhangs(shape.met, share);
    hardly_meets && shape.met >= LEAST_SHARED && shape.overhang.is_some_and(overhangs)
}

/// Parts of which each has a large piece that the other lacks, unless the surface they share is one and holds the
/// pose by itself or with its holes, and the rest of the smaller part lies beyond the borders of the other. Where one
/// lies on the other and much of it without a counterpart, normals differ.
fn overlap(coverage: &Coverage, shape: &ShapeStatement, is_held: bool) -> Option<Reason> {
    let overhangs = shape.overhang;
    let only_overhangs = overhangs.is_some_and(|share| only_overhangs(shape.met, share));
    let is_one = shape.reasons.is_empty() && only_overhangs && is_held;
    let hardly_meets = |reason: &ShapeReason| matches!(reason, ShapeReason::HardlyMet { .. });
    let is_told = shape.reasons.iter().any(hardly_meets) && !shares_a_piece(shape);
    if shape.met >= ENOUGH_MET || is_one {
        None
    } else if coverage.better_overlap() < OVERHANGS {
        Some(Reason::BothOverhang {
            source: coverage.source_on_target.overlap,
            target: coverage.target_on_source.overlap,
        })
    } else {
        (!is_told).then_some(Reason::PartlyMet { share: shape.met })
    }
}

/// Parts of which the smaller one lies in places where the other is not, while it does not end there, and neither
/// outlines nor holes show that the pose is right all the same.
fn elsewhere(shape: &ShapeStatement) -> Option<Reason> {
    let borders = &shape.borders;
    let is_confirmed = borders.n_holes >= HOLES_THAT_HOLD
        || borders.offset.is_some() && borders.other_trim.is_none();
    let overhang = shape.overhang?;
    let lies_elsewhere = shape.met < OVERHANGS && !only_overhangs(shape.met, overhang);
    // Where less meets, `overlap` says so.
    let is_open = shape.met >= ENOUGH_MET && !is_confirmed;
    (lies_elsewhere && is_open).then_some(Reason::Elsewhere {
        share: 1.0 - shape.met - overhang,
    })
}

/// A motion that the surfaces do not resist, unless holes hold the part, or borders that were compared
/// with those of all other poses along it: the borders of a plate fit after half a turn.
fn sliding(assessment: &Assessment, grounds: &Grounds<'_>) -> Option<Reason> {
    let Grounds { outcome, shape, .. } = *grounds;
    let motion = assessment.freedom.motion?;
    let was_searched = outcome.rivals_sought && motion.kind.is_searched();
    let is_clear = was_searched && assessment.ambiguity.clarity == Clarity::Clear;
    let borders = &shape.borders;
    let least = least_across(borders);
    let is_held_across = grounds.held_across.is_none_or(|held| held >= least);
    let borders_hold =
        is_clear && is_held_across && borders_lie_together(borders, &shape.tolerance);
    let is_held = is_firm(assessment) && (borders.n_holes >= HOLES_THAT_HOLD || borders_hold);
    let held_across = grounds.held_across.filter(|_| !is_held_across);
    (!is_held).then_some(Reason::Sliding {
        motion,
        held_across,
    })
}

/// Share of the outlines across a free motion that hold the part.
fn least_across(borders: &BorderFit) -> f64 {
    if borders.n_holes > 0 && borders.n_alone() == 0 {
        LEAST_ACROSS_BESIDE_HOLE
    } else {
        LEAST_ACROSS
    }
}

/// Whether borders that lie beside each other do so where they belong, and enough of them: along a free motion some
/// place can always be found where one trimmed edge lies beside another.
fn borders_lie_together(borders: &BorderFit, tolerance: &ShapeTolerance) -> bool {
    let is_within = |apart| apart <= tolerance.remainder;
    borders.offset.is_some_and(is_within) && borders.together >= LEAST_TOGETHER
}

fn uncertainty(assessment: &Assessment) -> Option<Reason> {
    let pose = assessment.pose.as_ref()?;
    let stated = pose.uncertainty.as_ref()?;
    (!pose.is_firm()).then_some(Reason::Uncertain {
        by: stated.largest,
        limit: pose.tolerance,
        along: stated.along,
    })
}

fn ambiguity(assessment: &Assessment) -> Option<Reason> {
    let ambiguity = &assessment.ambiguity;
    let Ambiguity { by_shape, twin, .. } = *ambiguity;
    let score_ratio = ambiguity.ratio?;
    match ambiguity.clarity {
        Clarity::Clear => None,
        Clarity::Verify => Some(Reason::NearAlternative {
            score_ratio,
            by_shape,
            twin,
        }),
        Clarity::Ambiguous => Some(Reason::EqualAlternative {
            score_ratio,
            by_shape,
            twin,
            n_equivalent: ambiguity.n_equivalent,
        }),
    }
}

/// A match that began at given poses has not looked for others. Pairs of equal nodes leave none.
fn others_not_sought(outcome: &MatchOutcome) -> Option<Reason> {
    let winner = outcome.starts.get(outcome.winner)?;
    let is_given = matches!(
        winner.kind,
        StartKind::CurrentPose | StartKind::Given { .. }
    );
    let was_searched = outcome.rivals_sought
        || matches!(
            outcome.termination,
            Termination::ClosedForm | Termination::Stopped
        );
    (is_given && !was_searched).then_some(Reason::OthersNotSought)
}

fn ending(outcome: &MatchOutcome) -> Option<Reason> {
    let termination = outcome.termination;
    match termination {
        Termination::Converged
        | Termination::ClosedForm
        | Termination::MaxIterations
        | Termination::NoGain => None,
        Termination::Stopped => Some(Reason::Stopped),
        Termination::Degenerate | Termination::NoPairs => Some(Reason::EndedEarly { termination }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assess::OneSided;
    use crate::geometry::Point3;

    #[test]
    fn a_poor_match_has_found_no_pose() {
        let opposite = Reason::OppositeHand {
            score_ratio: 0.5,
            by_borders: true,
        };
        assert_eq!(pose_kind(&[Reason::Stopped, opposite]), PoseKind::NotFound);
        assert_eq!(pose_kind(&[Reason::Stopped]), PoseKind::Uncertain);
        assert_eq!(pose_kind(&[]), PoseKind::Certain);
    }

    fn shape(remainder: f64, reasons: &[ShapeReason]) -> ShapeStatement {
        let tolerance = ShapeTolerance {
            remainder: 1.0,
            springback: 5.0,
        };
        ShapeStatement {
            remainder,
            reasons: reasons.to_vec(),
            ..ShapeStatement::nothing_met(tolerance)
        }
    }

    #[test]
    fn borders_of_which_few_lie_together_hold_no_part_that_slides() {
        let tolerance = shape(0.1, &[]).tolerance;
        let holds = |offset, together| {
            let borders = BorderFit {
                offset,
                together,
                ..BorderFit::default()
            };
            borders_lie_together(&borders, &tolerance)
        };
        assert!(holds(Some(0.7), 0.4));
        // Edges that were trimmed lie beside each other by chance, but hardly along a third of the outline.
        assert!(!holds(Some(0.9), 0.3));
        assert!(!holds(Some(1.1), 0.9) && !holds(None, 0.9));
    }

    #[test]
    fn an_end_and_a_hole_hold_a_part_and_one_of_them_does_not() {
        let holds_with = |n_holes, only_target, across| {
            let borders = BorderFit {
                n_holes,
                only_target,
                ..BorderFit::default()
            };
            across >= least_across(&borders)
        };
        assert!(holds_with(1, 0, 0.14) && !holds_with(1, 0, 0.05));
        // The end alone, or beside a hole that lies where the other part is solid.
        assert!(!holds_with(0, 0, 0.5) && !holds_with(1, 1, 0.5));
        assert!(holds_with(0, 0, 0.7));
    }

    #[test]
    fn two_holes_hold_a_part_unless_a_third_has_no_counterpart() {
        let holds = |n_holes, only_source, only_target| {
            is_held_by_holes(&BorderFit {
                n_holes,
                only_source,
                only_target,
                ..BorderFit::default()
            })
        };
        assert!(holds(2, 0, 0));
        assert!(!holds(1, 0, 0) && !holds(2, 1, 0) && !holds(5, 0, 1));
    }

    #[test]
    fn pieces_of_one_part_share_enough_and_lie_beyond_each_other_otherwise() {
        let hardly = ShapeReason::HardlyMet { share: 0.4 };
        let shares = |met, overhang, reasons: &[ShapeReason]| {
            let mut shape = shape(0.1, reasons);
            (shape.met, shape.overhang) = (met, overhang);
            shares_a_piece(&shape)
        };
        assert!(shares(0.4, Some(0.59), &[hardly]));
        assert!(!shares(0.4, Some(0.5), &[hardly]) && !shares(0.4, None, &[hardly]));
        assert!(!shares(0.3, Some(0.7), &[hardly]));
        let bend = ShapeReason::Bent {
            by: 6.0,
            limit: 5.0,
        };
        assert!(!shares(0.4, Some(0.59), &[hardly, bend]) && !shares(0.6, Some(0.4), &[bend]));
    }

    #[test]
    fn of_a_part_that_lies_on_the_other_it_is_not_said_that_neither_contains_the_other() {
        let told = |overlaps: [f64; 2], met, reasons: &[ShapeReason]| {
            let [source_on_target, target_on_source] = overlaps.map(|overlap| OneSided {
                overlap,
                rmse: 0.1,
                p95: 0.2,
                max: 0.4,
                max_anywhere: 9.0,
            });
            let coverage = Coverage {
                source_on_target,
                target_on_source,
                limit: 1.0,
            };
            let mut shape = shape(0.1, reasons);
            shape.met = met;
            overlap(&coverage, &shape, true)
        };
        let both = told([0.8, 0.7], 0.7, &[]);
        assert!(matches!(both, Some(Reason::BothOverhang { .. })));
        assert_eq!(
            told([1.0, 1.0], 0.7, &[]),
            Some(Reason::PartlyMet { share: 0.7 })
        );
        assert_eq!(told([1.0, 1.0], 0.8, &[]), None);
        // That it hardly meets says so already.
        let hardly = ShapeReason::HardlyMet { share: 0.4 };
        assert_eq!(told([1.0, 0.9], 0.4, &[hardly]), None);
    }

    #[test]
    fn a_piece_that_lies_elsewhere_is_told_where_nothing_confirms_the_pose() {
        let meets = |met, overhang, n_holes, offset| {
            let mut shape = shape(0.1, &[]);
            (shape.met, shape.overhang) = (met, Some(overhang));
            shape.borders.n_holes = n_holes;
            shape.borders.offset = offset;
            elsewhere(&shape)
        };
        let Some(Reason::Elsewhere { share }) = meets(0.79, 0.15, 0, None) else {
            panic!("nothing is told");
        };
        assert!((share - 0.06).abs() < 1e-9, "{share}");
        // It ends beyond the other part, holes or outlines confirm the pose, or all of it meets.
        assert_eq!(meets(0.79, 0.2, 0, None), None);
        assert_eq!(meets(0.79, 0.15, 2, None), None);
        assert_eq!(meets(0.79, 0.15, 0, Some(0.3)), None);
        assert_eq!(meets(0.96, 0.0, 0, None), None);
    }

    #[test]
    fn a_bend_does_not_speak_for_the_opposite_hand() {
        let bend = ShapeReason::Bent {
            by: 6.0,
            limit: 5.0,
        };
        let bent = shape(0.2, &[bend]);
        assert!(!fits_better(&shape(0.3, &[]), &bent));
        assert!(fits_better(&shape(0.1, &[]), &bent));
        let hardly = ShapeReason::HardlyMet { share: 0.4 };
        assert!(fits_better(
            &shape(0.3, &[bend]),
            &shape(0.2, &[bend, hardly])
        ));
    }

    #[test]
    fn a_hand_with_a_misplaced_hole_is_no_better_for_a_remainder_that_nobody_sees() {
        let hole = ShapeReason::Hole {
            by: 6.0,
            limit: 1.5,
            at: Point3::origin(),
            is_mean: false,
        };
        let (held, misplaced) = (shape(0.07, &[]), shape(0.04, &[hole]));
        assert!(fits_better(&held, &misplaced) && !fits_better(&misplaced, &held));
        let unseen = shape(0.04, &[]);
        assert!(!fits_better(&unseen, &held) && !fits_better(&held, &unseen));
        // Surfaces that lie apart by more than is accepted outweigh a hole.
        let apart = shape(3.0, &[]);
        assert!(fits_better(&misplaced, &apart) && !fits_better(&apart, &misplaced));
    }
}
