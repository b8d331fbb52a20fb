//! The checks of a mapping: what was found, what is asked for, and where to look.

use serde::{Serialize, Serializer};

use super::balance::force_balance;
use super::origin::PoseOrigin;
use super::peak::peak_at_best;
use super::record::{MapRecord, PairRecord, StampedRecord};
use super::warnings::absent;
use super::{MapRun, ShownValue};
use crate::mapping::{Quantities, Status};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::forming_values::FormingValue;
use crate::text::{
    Lengths, compared_percents, counted, fixed, length, percent, share, signed_percent,
    signed_percent_beside,
};

/// Share of the area that is to carry values where no other is asked for.
pub(in crate::pipeline) const LEAST_AREA: f64 = 0.95;
/// A mean may change by this fraction.
const MEAN_CHANGE: f64 = 0.005;
/// The largest value may change by this fraction: less where the crash elements are larger.
const PEAK_CHANGE: [f64; 2] = [-0.10, 0.05];
/// A peak whose mean over a crash element is below this share of it is narrower than the element.
const NARROW_PEAK: f64 = 0.98;
/// A mapped thickness over that of the section beyond these is no forming.
const POSSIBLE_THICKNESS: [f64; 2] = [0.2, 2.0];
/// Confidence below which an element is doubtful, and the share of the area that may be.
const DOUBTFUL: f64 = 0.5;
const DOUBTFUL_AREA: f64 = 0.05;

/// The picture in which a check is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckPicture {
    /// Status of the elements.
    #[default]
    Status,
    /// Distance between the sheets.
    Distance,
    /// How far each element can be trusted.
    Confidence,
    /// Difference of the thickness.
    Thickness,
    /// Difference of the plastic strain.
    PlasticStrain,
    /// Difference of the von Mises stress.
    Stress,
}

/// Why a check is not judged, or against something else than the stamped values as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckReason {
    /// A peak that is narrower than a crash element is lost in part whoever maps it.
    PeakNarrowerThanElement,
    /// Of a pose that was given nothing is known, so that the command line has one judged check fewer than the
    /// window, which knows the match.
    GivenPose,
    /// Everything was asked for, whatever the stamped files hold, and they lack what many lack.
    NotInFiles,
}

impl CheckReason {
    /// The reason in a sentence.
    pub fn label(self) -> &'static str {
        match self {
            Self::PeakNarrowerThanElement => {
                "The stamped peak is narrower than a crash element, which can carry no more than the \
                 mean over its area: it is judged against that mean."
            }
            Self::GivenPose => {
                "Only the match that found a pose says whether it is right, and this one was given. Where the \
                 match is known, as in the window, the pose is one more check."
            }
            Self::NotInFiles => {
                "Everything that the stamped files hold was asked for, and many files hold no such \
                 results."
            }
        }
    }
}

fn with_words<S: Serializer>(reason: &Option<CheckReason>, to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Told {
        name: CheckReason,
        text: &'static str,
    }
    let told = reason.map(|name| Told {
        name,
        text: name.label(),
    });
    told.serialize(to)
}

/// One check.
#[derive(Debug, Clone, Default, Serialize)]
pub struct CheckRecord {
    /// What is checked.
    pub name: String,
    /// What was found, with its unit.
    pub found: String,
    /// What is asked for.
    pub limit: String,
    /// Whether it is met; `None` for what is stated and not judged.
    pub is_met: Option<bool>,
    /// Why it is not judged, or against something else than the stamped values as they are; in a record by
    /// its name and in words.
    #[serde(serialize_with = "with_words")]
    pub reason: Option<CheckReason>,
    /// Where it is seen.
    pub picture: CheckPicture,
    /// The element of the run that is farthest off, by its place there, if one stands out.
    #[serde(skip)]
    pub worst: Option<usize>,
    /// Its id, as it stands in a record.
    pub worst_element: Option<u64>,
}

/// All checks; that of the pose stands first, then those that are not met, where they are seen.
pub(super) fn checks_of(
    run: &MapRun,
    record: &MapRecord,
    lengths: Lengths,
    monitor: &Monitor,
) -> Result<Vec<CheckRecord>, Cancelled> {
    let mut checks = vec![area(run, record)];
    checks.extend(quantities(run));
    checks.extend(doubled(run));
    checks.extend(read_errors(run));
    monitor.check()?;
    checks.push(distance(run, lengths));
    monitor.check()?;
    checks.push(confidence(run));
    let plastic = Some(FormingValue::PlasticStrain);
    for (name, pair, picture, value) in [
        (
            "Mean thickness",
            &record.thickness,
            CheckPicture::Thickness,
            None,
        ),
        (
            "Mean plastic strain",
            &record.plastic_strain,
            CheckPicture::PlasticStrain,
            plastic,
        ),
    ] {
        checks.extend(
            pair.as_ref()
                .map(|pair| mean(run, name, pair, (picture, value))),
        );
    }
    monitor.check()?;
    checks.extend(beside_section(run));
    checks.extend(volume(run));
    checks.extend(balance(run, monitor)?);
    if let Some(pair) = &record.plastic_strain {
        checks.push(peak(run, pair, monitor)?);
    }
    if let Some(back) = &record.map_back {
        for (name, difference, picture, value) in [
            (
                "Thickness there and back",
                &back.thickness,
                CheckPicture::Thickness,
                None,
            ),
            (
                "Plastic strain there and back",
                &back.plastic,
                CheckPicture::PlasticStrain,
                plastic,
            ),
        ] {
            monitor.check()?;
            if let Some(of_range) = difference.share_of_range() {
                checks.push(CheckRecord {
                    name: name.to_owned(),
                    // What the crash elements are too large for comes back smoothed, however it is
                    // mapped, so this is no verdict.
                    found: share(of_range),
                    limit: "of the range, P95".to_owned(),
                    picture,
                    worst: worst_difference(run, value),
                    ..CheckRecord::default()
                });
            }
        }
    }
    checks.sort_by_key(|check| check.is_met != Some(false));
    checks.splice(0..0, pose(record, lengths));
    Ok(checks)
}

/// Whether a match stands for the pose of every stamped part; of several the most doubtful is named.
fn pose(record: &MapRecord, lengths: Lengths) -> Option<CheckRecord> {
    let of = |stamped: &StampedRecord| (record.stamped_name(stamped), stamped.pose);
    let poses: Vec<_> = record.stamped.iter().map(of).collect();
    let (most, found) = PoseOrigin::most_doubtful(&poses, lengths)?;
    let (_, most) = poses[most];
    Some(CheckRecord {
        name: "Pose".to_owned(),
        found,
        limit: "a match that is GOOD".to_owned(),
        is_met: most.is_good(),
        reason: (most == PoseOrigin::Given).then_some(CheckReason::GivenPose),
        picture: CheckPicture::Distance,
        ..CheckRecord::default()
    })
}

fn area(run: &MapRun, record: &MapRecord) -> CheckRecord {
    let elements = &run.mapped.elements;
    let wanted = run.recipe.wanted_area();
    let [found, limit] = compared_percents([record.full_area(), wanted]);
    CheckRecord {
        name: "Area with values".to_owned(),
        found,
        limit: format!("at least {limit}"),
        is_met: Some(record.full_area() >= wanted),
        picture: CheckPicture::Status,
        worst: elements
            .iter()
            .position(|report| !report.status.has_values()),
        ..CheckRecord::default()
    }
}

/// Quantities that were asked for and that no stamped file holds, if there are any. Where everything was asked for,
/// strains and history variables are told and not judged.
fn quantities(run: &MapRun) -> Option<CheckRecord> {
    let [usual, further] = absent(run);
    let is_told = usual.is_empty() && run.recipe.options.quantities == Quantities::FULL;
    let names = [usual, further].concat();
    (!names.is_empty()).then(|| CheckRecord {
        name: "Quantities".to_owned(),
        found: format!("no {} in the stamped files", names.join(", no ")),
        limit: "all of them".to_owned(),
        is_met: (!is_told).then_some(false),
        reason: is_told.then_some(CheckReason::NotInFiles),
        ..CheckRecord::default()
    })
}

/// Elements that lie near two sheets or on two parts, if there are any.
fn doubled(run: &MapRun) -> Option<CheckRecord> {
    let is_doubled = |status: Status| matches!(status, Status::TwoLayers | Status::Conflict);
    let elements = &run.mapped.elements;
    let n = elements.iter().filter(|e| is_doubled(e.status)).count();
    (n > 0).then(|| CheckRecord {
        name: "Near two sheets".to_owned(),
        found: counted(n, "element"),
        limit: "none".to_owned(),
        is_met: Some(false),
        picture: CheckPicture::Status,
        worst: elements.iter().position(|e| is_doubled(e.status)),
        ..CheckRecord::default()
    })
}

/// Errors of the reader by which elements may be missing or lie elsewhere, if there are any.
fn read_errors(run: &MapRun) -> Option<CheckRecord> {
    let n = usize::try_from(run.n_read_errors).unwrap_or(usize::MAX);
    (n > 0).then(|| CheckRecord {
        name: "Read errors".to_owned(),
        found: format!("{n} in nodes, elements or transformations"),
        limit: "none".to_owned(),
        is_met: Some(false),
        picture: CheckPicture::Status,
        ..CheckRecord::default()
    })
}

fn distance(run: &MapRun, lengths: Lengths) -> CheckRecord {
    let mapped = &run.mapped;
    let apart = |element: usize| {
        let report = &mapped.elements[element];
        let distance = (report.normal_distance - mapped.median_offset).abs();
        if report.partner.is_some() {
            distance
        } else {
            f64::NAN
        }
    };
    let worst = largest(run, apart);
    CheckRecord {
        name: "Distance of the sheets".to_owned(),
        found: worst.map_or_else(|| "–".to_owned(), |worst| lengths.of(apart(worst))),
        limit: match run.recipe.options.max_distance {
            Some(reach) => format!("at most {}", lengths.of(reach / 2.0)),
            None => half_an_element(run, worst, lengths),
        },
        is_met: worst.map(|_| mapped.n_distant == 0),
        picture: CheckPicture::Distance,
        worst,
        ..CheckRecord::default()
    }
}

/// What each element is held against, with its length at the one that is farthest.
fn half_an_element(run: &MapRun, worst: Option<usize>, lengths: Lengths) -> String {
    let size = worst.and_then(|element| {
        let partner = run.mapped.elements[element].partner?;
        let source = run.sources.get(partner.source as usize)?;
        let of_source = source.mesh.size(partner.element as usize);
        Some(run.target.mesh.size(element).max(of_source))
    });
    let at_worst = size.map_or_else(String::new, |size| {
        format!(", {} there", lengths.of(size / 2.0))
    });
    format!("half an element{at_worst}")
}

fn confidence(run: &MapRun) -> CheckRecord {
    let of = |element: usize| {
        let report = &run.mapped.elements[element];
        if report.partner.is_some() {
            report.confidence
        } else {
            f64::NAN
        }
    };
    let areas = run.target.mesh.areas();
    let all = (0..areas.len()).filter(|&element| of(element).is_finite());
    let (mut doubtful, mut area) = (0.0, 0.0);
    for element in all {
        area += areas[element];
        if of(element) < DOUBTFUL {
            doubtful += areas[element];
        }
    }
    // Nothing is said of what is not there.
    let share = (area > 0.0).then(|| doubtful / area);
    let [found, limit] = match share {
        Some(share) => compared_percents([share, DOUBTFUL_AREA]),
        None => ["–".to_owned(), percent(DOUBTFUL_AREA)],
    };
    CheckRecord {
        name: format!("Confidence below {}", fixed(DOUBTFUL, 1)),
        found,
        limit: format!("at most {limit}"),
        is_met: share.map(|share| share <= DOUBTFUL_AREA),
        picture: CheckPicture::Confidence,
        worst: largest(run, |element| -of(element)),
        ..CheckRecord::default()
    }
}

/// What a value has changed by, as a fraction of what it was; `None` where nothing stands to compare it with.
pub(super) fn change(now: f64, before: f64) -> Option<f64> {
    if now == before {
        return Some(0.0);
    }
    let change = now / before - 1.0;
    change.is_finite().then_some(change)
}

/// A change as it is told; a dash where there is none.
pub(super) fn change_text(change: Option<f64>) -> String {
    change.map_or_else(no_change, signed_percent)
}

fn no_change() -> String {
    "–".to_owned()
}

fn mean(
    run: &MapRun,
    name: &str,
    pair: &PairRecord,
    (picture, value): (CheckPicture, Option<FormingValue>),
) -> CheckRecord {
    let change = change(pair.crash.mean, pair.stamped.mean);
    CheckRecord {
        name: name.to_owned(),
        found: change.map_or_else(no_change, |change| {
            signed_percent_beside(change, MEAN_CHANGE)
        }),
        limit: format!("±{}", percent(MEAN_CHANGE)),
        is_met: change.map(|change| change.abs() <= MEAN_CHANGE),
        picture,
        worst: worst_difference(run, value),
        ..CheckRecord::default()
    }
}

/// The mapped thickness of each element over that of its section, where this is known.
fn beside_section(run: &MapRun) -> Option<CheckRecord> {
    let ratio = |element: usize| {
        let ratio = run.thickness(element) / run.target.nominal_thickness[element];
        // A section without thickness says nothing.
        if ratio.is_finite() { ratio } else { f64::NAN }
    };
    let off = |element: usize| ratio(element).ln().abs();
    let worst = largest(run, off)?;
    let ratios = (0..run.shells.len()).map(ratio);
    let (low, high) = ratios.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), ratio| {
        (low.min(ratio), high.max(ratio))
    });
    let [least, most] = POSSIBLE_THICKNESS;
    Some(CheckRecord {
        name: "Thickness / section".to_owned(),
        found: format!("{}–{}", thickness_ratio(low), thickness_ratio(high)),
        limit: format!("{} to {}", fixed(least, 1), fixed(most, 0)),
        is_met: Some(low >= least && high <= most),
        picture: CheckPicture::Thickness,
        worst: Some(worst),
        ..CheckRecord::default()
    })
}

/// With two decimals, and three digits where that leaves nothing: thicknesses in another unit are far apart.
fn thickness_ratio(ratio: f64) -> String {
    if ratio < 0.1 {
        length(ratio)
    } else {
        fixed(ratio, 2)
    }
}

/// Thickness times area of the crash elements with values beside that of the stamped elements they cover.
/// Told and not judged: a finer mesh of a radius has more area.
fn volume(run: &MapRun) -> Option<CheckRecord> {
    let (stamped, crash) = run.checks.thickness.as_ref()?;
    let change = change(crash.mean * crash.area, stamped.mean * stamped.area)?;
    Some(CheckRecord {
        name: "Volume of the sheet".to_owned(),
        found: signed_percent(change),
        limit: "for information".to_owned(),
        picture: CheckPicture::Thickness,
        ..CheckRecord::default()
    })
}

/// What is left of the forces at the nodes inside the sheet. Told and not judged: what the stamped stresses leave
/// tells what can be asked of the mapped ones.
fn balance(run: &MapRun, monitor: &Monitor) -> Result<Option<CheckRecord>, Cancelled> {
    let found = force_balance(run, monitor)?;
    Ok(found.map(|[crash, stamped]| CheckRecord {
        name: "Forces left at nodes".to_owned(),
        found: format!("{} (stamped {})", percent(crash), percent(stamped)),
        limit: "for information".to_owned(),
        picture: CheckPicture::Stress,
        ..CheckRecord::default()
    }))
}

/// The largest value against the stamped one, or against what the crash element there can carry of it.
fn peak(run: &MapRun, pair: &PairRecord, monitor: &Monitor) -> Result<CheckRecord, Cancelled> {
    let of_stamped = pair.stamped.max;
    let at_best = peak_at_best(run, monitor)?.filter(|best| *best < NARROW_PEAK * of_stamped);
    let change = change(pair.crash.max, at_best.unwrap_or(of_stamped));
    let [least, most] = PEAK_CHANGE.map(|change| fixed(100.0 * change, 0));
    let limit = format!("{least} % to +{most} %");
    Ok(CheckRecord {
        name: "Largest plastic strain".to_owned(),
        found: change_text(change),
        limit: match at_best {
            Some(_) => format!("{limit} of the mean there"),
            None => limit,
        },
        is_met: change.map(|change| (PEAK_CHANGE[0]..=PEAK_CHANGE[1]).contains(&change)),
        reason: at_best.map(|_| CheckReason::PeakNarrowerThanElement),
        picture: CheckPicture::PlasticStrain,
        worst: largest(run, |element| run.plastic_strain(element)),
        ..CheckRecord::default()
    })
}

fn worst_difference(run: &MapRun, value: Option<FormingValue>) -> Option<usize> {
    let shown = ShownValue::compared(value);
    largest(run, |element| run.difference(element, &shown).abs())
}

/// The element with the largest number; none if no number is finite.
fn largest(run: &MapRun, number: impl Fn(usize) -> f64) -> Option<usize> {
    let numbers = (0..run.shells.len()).map(|element| (element, number(element)));
    let finite = numbers.filter(|(_, number)| number.is_finite());
    let first = |best: (usize, f64), next: (usize, f64)| if next.1 > best.1 { next } else { best };
    finite.reduce(first).map(|(element, _)| element)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thicknesses_in_another_unit_show_their_digits() {
        let ratios = [0.000_98, 0.062, 0.876, 1.18].map(thickness_ratio);
        assert_eq!(ratios, ["0.000980", "0.0620", "0.88", "1.18"]);
    }

    #[test]
    fn a_change_is_told_only_of_what_was_there() {
        assert_eq!(change(1.5, 1.0), Some(0.5));
        assert_eq!(change(0.0, 0.2), Some(-1.0));
        assert_eq!(change(0.0, 0.0), Some(0.0));
        assert_eq!(change(0.1, 0.0), None);
        assert_eq!(change(f64::NAN, 1.0), None);
        assert_eq!(change_text(None), "–");
    }
}
