//! The mapping in figures: JSON record and element table.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use serde::ser::SerializeStruct as _;
use serde::{Serialize, Serializer};

use super::compare::{ComparisonRecord, OtherResult, compare_with};
use super::values::middle_of;
use super::verdict::{CheckRecord, checks_of};
use super::warnings::{bare, warnings};
use super::{MapFiles, MapRun, PlacedPart, PoseOrigin, ProbeRecord, ShownValue, covered_values};
use crate::geometry::Similarity;
use crate::geometry::chunks::for_chunks;
use crate::mapping::{
    BackDifference, Distribution, SourcePart, Status, ValueHistogram, distribution,
    histogram_distance,
};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::forming_values::{FormingValue, LayerChoice, nominal_thickness};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::names::told_apart;
use crate::pipeline::outputs::record::file_record;
use crate::pipeline::units::PairUnits;
use crate::report::command_line::{CommandSide, MapCommandLine};
use crate::report::{DIRECTION, FileRecord, build_id};
use crate::role::PerRole;
use crate::text::Lengths;

/// A mapping as it is kept and exchanged.
#[derive(Debug, Clone, Serialize)]
pub struct MapRecord {
    /// Which program made it.
    pub build: String,
    /// Version of this layout.
    pub schema: &'static str,
    /// What the matrices mean.
    pub direction: String,
    /// The crash deck.
    pub crash: String,
    /// Ids of the crash parts.
    pub crash_parts: Vec<u64>,
    /// The stamped decks with their poses (crash from stamped, rows).
    pub stamped: Vec<StampedRecord>,
    /// The files as they were read.
    pub files: PerRole<Vec<FileRecord>>,
    /// The line that maps the same again.
    pub command_line: String,
    /// Elements of the crash part.
    pub n_elements: usize,
    /// Elements and area by status.
    pub statuses: Vec<StatusRecord>,
    /// Share of the area that carries values.
    pub mapped_area: f64,
    /// Share of the area whose elements carry some of the values that were asked for, but no thickness or no stress
    /// card, which other elements have.
    pub bare_area: f64,
    /// Median signed distance between the sheets along the crash part's normals.
    pub median_offset: f64,
    /// Thickness before and after.
    pub thickness: Option<PairRecord>,
    /// 1 − thickness over that of the flat sheet, where the section of a part gives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thinning: Option<PairRecord>,
    /// Effective plastic strain before and after.
    pub plastic_strain: Option<PairRecord>,
    /// Von Mises stress before and after.
    pub von_mises: Option<PairRecord>,
    /// The way there and back.
    pub map_back: Option<MapBackRecord>,
    /// What was found beside what is asked for.
    pub checks: Vec<CheckRecord>,
    /// Largest relative difference when the written files are read back.
    pub read_back_error: Option<f64>,
    /// Beside another result, if one was given.
    pub comparison: Option<ComparisonRecord>,
    /// Elements that were pinned to be told, if any were.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<ProbeRecord>,
    /// What to look at.
    pub warnings: Vec<String>,
    /// Milliseconds for the mapping without files and checks.
    pub map_ms: f64,
    /// Milliseconds for the checks.
    pub check_ms: f64,
}

impl MapRecord {
    /// Share of the crash part's area whose elements have a status.
    pub fn area_share(&self, status: Status) -> f64 {
        let row = self.statuses.iter().find(|row| row.status == status);
        row.map_or(0.0, |row| row.area_share)
    }

    /// Share of the area that carries all that was asked for.
    pub fn full_area(&self) -> f64 {
        self.mapped_area - self.bare_area
    }

    /// Name of a stamped file, with as much of its folder as tells it from the others.
    pub(super) fn stamped_name(&self, of: &StampedRecord) -> String {
        let all = self.stamped.iter().map(|other| Path::new(&other.file));
        told_apart(Path::new(&of.file), all)
    }

    /// How many checks are met, of those that are judged.
    pub fn n_met(&self) -> (usize, usize) {
        let judged = self.checks.iter().filter_map(|check| check.is_met);
        judged.fold((0, 0), |(met, all), is_met| {
            (met + usize::from(is_met), all + 1)
        })
    }
}

/// One stamped deck.
#[derive(Debug, Clone, Serialize)]
pub struct StampedRecord {
    /// Path of the file.
    pub file: String,
    /// What its lengths were multiplied by.
    pub length_factor: f64,
    /// Its pose, rows of the 4×4 matrix.
    pub crash_from_stamped: [[f64; 4]; 4],
    /// Where this comes from.
    pub pose: PoseOrigin,
}

impl StampedRecord {
    fn of(placed: &PlacedPart<'_>) -> Self {
        Self {
            file: placed.part.path.display().to_string(),
            length_factor: placed.part.settings.length_factor,
            crash_from_stamped: placed.crash_from_stamped.to_rows(),
            pose: placed.origin,
        }
    }
}

/// Elements with one status.
#[derive(Debug, Clone, Serialize)]
pub struct StatusRecord {
    /// Status the elements share.
    pub status: Status,
    /// How many elements.
    pub n_elements: usize,
    /// Their share of the area.
    pub area_share: f64,
}

/// A quantity on both sides.
#[derive(Debug, Clone, Serialize)]
pub struct PairRecord {
    /// The layer that both were taken from; `None` for the thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<LayerChoice>,
    /// On the covered stamped elements.
    pub stamped: DistributionRecord,
    /// The factor that the stamped values are multiplied by, as the mapped ones are, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stamped_factor: Option<f64>,
    /// On the mapped crash elements.
    pub crash: DistributionRecord,
    /// Half the sum of the differences of both histograms, 0 to 1.
    pub histogram_distance: f64,
    /// Shares of the area in fifty equal bins from the smallest to the largest value of both, stamped
    /// and crash.
    pub histograms: [Vec<f64>; 2],
}

impl PairRecord {
    /// What the stamped values are called: "stamped", or "stamped × 1.1".
    pub fn stamped_word(&self) -> String {
        self.stamped_factor.map_or_else(
            || "stamped".to_owned(),
            |factor| format!("stamped × {factor}"),
        )
    }

    /// A stamped value beside the mapped one: "stamped 0.9", or "stamped × 1.1: 0.99".
    pub fn stamped_value(&self, value: &str) -> String {
        let colon = self.stamped_factor.map_or("", |_| ":");
        format!("{}{colon} {value}", self.stamped_word())
    }
}

/// An area-weighted distribution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DistributionRecord {
    /// Mean over the area.
    pub mean: f64,
    /// Smallest value.
    pub min: f64,
    /// 5 % of the area lie at or below.
    pub p5: f64,
    /// Half of the area lies at or below.
    pub p50: f64,
    /// 95 % of the area lie at or below.
    pub p95: f64,
    /// 99 % of the area lie at or below.
    pub p99: f64,
    /// Largest value.
    pub max: f64,
}

impl From<Distribution> for DistributionRecord {
    fn from(of: Distribution) -> Self {
        let [p5, p50, p95, p99] = of.percentiles;
        Self {
            mean: of.mean,
            min: of.min,
            p5,
            p50,
            p95,
            p99,
            max: of.max,
        }
    }
}

/// Differences after mapping there and back; the error of one way is about half.
#[derive(Debug, Clone, Copy)]
pub struct MapBackRecord {
    /// Difference of the thickness.
    pub thickness: BackDifference,
    /// Difference of the plastic strain.
    pub plastic: BackDifference,
}

impl Serialize for MapBackRecord {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { thickness, plastic } = self;
        let mut record = serializer.serialize_struct("MapBackRecord", 6)?;
        record.serialize_field("thickness_rms", &thickness.rms)?;
        record.serialize_field("thickness_p95", &thickness.p95)?;
        record.serialize_field("thickness_range", &thickness.range)?;
        record.serialize_field("plastic_rms", &plastic.rms)?;
        record.serialize_field("plastic_p95", &plastic.p95)?;
        record.serialize_field("plastic_range", &plastic.range)?;
        record.end()
    }
}

/// Puts a run into figures. `files` are what was made of it, `other` is what it is to be compared with, if
/// anything.
pub fn map_record(
    run: &MapRun,
    crash: &LoadedPart,
    stamped: &[PlacedPart<'_>],
    files: Option<&MapFiles>,
    other: Option<&OtherResult>,
    monitor: &Monitor,
) -> Result<MapRecord, Cancelled> {
    let counts = run.mapped.counts();
    let statuses = Status::ALL.iter().zip(counts).filter(|(_, n)| *n > 0);
    let statuses = statuses.map(|(&status, n_elements)| StatusRecord {
        status,
        n_elements,
        area_share: run.mapped.area_share(status, &run.target.mesh),
    });
    let checks = &run.checks;
    monitor.check()?;
    let thickness = checks.thickness.map(|pair| thickness_pair(run, pair));
    monitor.check()?;
    let plastic_strain = checks
        .plastic_strain
        .map(|pair| pair_record(Some(LayerChoice::Mean), pair, &plastic_values(run)));
    monitor.check()?;
    let first = stamped.first().map(|placed| placed.part);
    let flat = nominal_thickness(crash).or_else(|| nominal_thickness(first?));
    let is_mapped = thickness.is_some();
    let thinning = flat.filter(|_| is_mapped);
    let thinning = thinning.and_then(|flat| pair_of(None, &thinning_values(run, flat)));
    monitor.check()?;
    let von_mises = von_mises(run);
    monitor.check()?;
    let units = PairUnits::of(PerRole::new(Some(crash), first));
    let lengths = Lengths::new(units.lengths);
    let of_pose = |placed: &PlacedPart<'_>| {
        let all = stamped.iter().map(|placed| placed.part.path.as_path());
        let name = told_apart(&placed.part.path, all);
        placed.origin.warning(&name, lengths)
    };
    let mut record = MapRecord {
        build: build_id(),
        schema: "shapematch.map/1",
        direction: DIRECTION.to_owned(),
        crash: crash.path.display().to_string(),
        crash_parts: crash.chosen_part_ids(),
        stamped: stamped.iter().map(StampedRecord::of).collect(),
        files: file_records(crash, stamped, &units),
        command_line: command_line(run, crash, stamped),
        n_elements: run.shells.len(),
        statuses: statuses.collect(),
        mapped_area: run.mapped.mapped_area(&run.target.mesh),
        bare_area: bare_area(run),
        median_offset: run.mapped.median_offset,
        thickness,
        thinning,
        plastic_strain,
        von_mises,
        checks: Vec::new(),
        map_back: checks.map_back.as_ref().map(|back| MapBackRecord {
            thickness: back.thickness,
            plastic: back.plastic,
        }),
        read_back_error: files.map(|files| files.read_back_error),
        comparison: other
            .map(|other| compare_with(run, crash, other, monitor))
            .transpose()?,
        probes: Vec::new(),
        // At a wrong pose everything else is wrong as well.
        warnings: stamped
            .iter()
            .filter_map(of_pose)
            .chain(warnings(run, crash, stamped, files))
            .collect(),
        map_ms: run.map_ms,
        check_ms: run.check_ms,
    };
    record.checks = checks_of(run, &record, lengths, monitor)?;
    for check in &mut record.checks {
        let id = |element: usize| crash.model.shells[run.shells[element] as usize].id;
        check.worst_element = check.worst.map(id);
    }
    Ok(record)
}

/// What is recorded of the files. The units of the first stamped file may be told as they follow from the crash file's.
fn file_records(
    crash: &LoadedPart,
    stamped: &[PlacedPart<'_>],
    units: &PairUnits,
) -> PerRole<Vec<FileRecord>> {
    let of_stamped = stamped.iter().enumerate().map(|(file, placed)| {
        let known = units.files.stamped.filter(|_| file == 0);
        file_record(placed.part, known.or_else(|| placed.part.units()))
    });
    PerRole::new(
        vec![file_record(crash, units.files.crash)],
        of_stamped.collect(),
    )
}

/// The line that maps the same again; empty where the crash file has a factor, which only the window gives.
fn command_line(run: &MapRun, crash: &LoadedPart, stamped: &[PlacedPart<'_>]) -> String {
    let Some((first, further)) = stamped.split_first() else {
        return String::new();
    };
    if crash.settings.length_factor != 1.0 {
        return String::new();
    }
    let further = further.iter();
    let further: Vec<(CommandSide<'_>, Similarity)> = further
        .map(|placed| (placed.part.command_side(), placed.crash_from_stamped))
        .collect();
    let recipe = &run.recipe;
    let line = MapCommandLine {
        sides: PerRole::new(crash, first.part).map(LoadedPart::command_side),
        read: &crash.settings.read,
        pose: &first.crash_from_stamped,
        further: &further,
        options: &recipe.options,
        layers: (recipe.n_layers, recipe.rule, recipe.n_plane),
        stress_factors: &recipe.stress_factors,
        stamped_law: recipe.stamped_law.as_deref(),
    };
    line.line()
}

/// Von Mises stress of both sides, where stresses were mapped.
fn von_mises(run: &MapRun) -> Option<PairRecord> {
    if !run.recipe.options.quantities.stress {
        return None;
    }
    let value = FormingValue::VonMises;
    let shown = ShownValue::compared(Some(value));
    let on_target = |element| run.shown(element, &shown);
    let layer = LayerChoice::compared(value);
    pair_of(Some(layer), &both_sides(run, von_mises_of, on_target))
}

/// Von Mises stress in the middle of a stamped element; NaN if it has none.
pub(super) fn von_mises_of(part: &SourcePart, element: usize) -> f64 {
    middle_of(&part.strains, &part.states, element, FormingValue::VonMises)
}

/// Values with areas, on the covered stamped elements and on the crash elements.
pub(super) type BothSides = [Vec<(f64, f64)>; 2];

fn both_sides(
    run: &MapRun,
    on_source: impl Fn(&SourcePart, usize) -> f64,
    on_target: impl Fn(usize) -> f64,
) -> BothSides {
    let back = run.checks.map_back.as_ref();
    let covered = back.map(|back| &back.is_covered[..]).unwrap_or_default();
    let target = run.target.mesh.areas().iter().enumerate();
    let scales = run.poses.iter().map(|pose| pose.scale);
    let sources = run.sources.iter().zip(scales);
    [
        covered_values(sources.zip(covered), on_source),
        target
            .map(|(element, area)| (on_target(element), *area))
            .collect(),
    ]
}

/// What no element has is told as missing, and no element lacks it.
fn bare_area(run: &MapRun) -> f64 {
    let n_mapped = run.mapped.elements.iter();
    let n_mapped = n_mapped.filter(|report| report.status.has_values()).count();
    let of_some = bare(run).into_iter().filter(|bare| bare.len() < n_mapped);
    let bare: BTreeSet<usize> = of_some.flatten().collect();
    let areas = run.target.mesh.areas();
    let total: f64 = areas.iter().sum();
    let area: f64 = bare.into_iter().map(|element| areas[element]).sum();
    if total > 0.0 { area / total } else { 0.0 }
}

fn thickness_values(run: &MapRun) -> BothSides {
    let factor = run.recipe.options.thickness_scale;
    let on_source = |part: &SourcePart, element| factor * part.mean_thickness(element);
    both_sides(run, on_source, |element| run.thickness(element))
}

fn thickness_pair(run: &MapRun, pair: (Distribution, Distribution)) -> PairRecord {
    let factor = run.recipe.options.thickness_scale;
    PairRecord {
        stamped_factor: (factor != 1.0).then_some(factor),
        ..pair_record(None, pair, &thickness_values(run))
    }
}

fn thinning_values(run: &MapRun, flat: f64) -> BothSides {
    let thickness = thickness_values(run);
    thickness.map(|side| {
        let values = side.into_iter();
        values.map(|(t, area)| (1.0 - t / flat, area)).collect()
    })
}

fn plastic_values(run: &MapRun) -> BothSides {
    both_sides(run, SourcePart::mean_plastic_strain, |element| {
        run.plastic_strain(element)
    })
}

/// The distributions of both sides with their distance; `None` if one side has no values.
pub(super) fn pair_of(layer: Option<LayerChoice>, values: &BothSides) -> Option<PairRecord> {
    let [a, b] = values
        .each_ref()
        .map(|side| distribution(side.iter().copied()));
    Some(pair_record(layer, (a?, b?), values))
}

fn pair_record(
    layer: Option<LayerChoice>,
    (stamped, crash): (Distribution, Distribution),
    values: &BothSides,
) -> PairRecord {
    let (min, max) = (stamped.min.min(crash.min), stamped.max.max(crash.max));
    let [a, b] = values
        .each_ref()
        .map(|side| ValueHistogram::new(side.iter().copied(), min, max));
    PairRecord {
        layer,
        stamped: stamped.into(),
        stamped_factor: None,
        crash: crash.into(),
        histogram_distance: histogram_distance(&a, &b),
        histograms: [a.shares, b.shares],
    }
}

/// One row for each crash element: id, part, status, distances, angle, coverage, confidence, source,
/// thickness and mean plastic strain; with another result also its thickness and plastic strain.
pub fn element_table(
    run: &MapRun,
    crash: &LoadedPart,
    stamped: &[PlacedPart<'_>],
    other: Option<&OtherResult>,
    monitor: &Monitor,
) -> Result<String, Cancelled> {
    let mut table = String::from(
        "element,part,status,normal_distance,tangential_distance,angle_deg,coverage,confidence,\
         source,source_element,thickness,plastic_strain",
    );
    if other.is_some() {
        table.push_str(",other_thickness,other_plastic_strain");
    }
    table.push('\n');
    let number = |value: f64| {
        if value.is_finite() {
            format!("{value}")
        } else {
            String::new()
        }
    };
    for_chunks(run.shells.len(), monitor, |elements| {
        for element in elements {
            let report = &run.mapped.elements[element];
            let shell = &crash.model.shells[run.shells[element] as usize];
            let giver = run.giver(element);
            let (source, source_element) =
                giver.map_or_else(Default::default, |(number, shell)| {
                    let id = stamped[number].part.model.shells[shell].id;
                    ((number + 1).to_string(), id.to_string())
                });
            let _ = write!(
                table,
                "{},{},{},{},{},{},{},{},{source},{source_element},{},{}",
                shell.id,
                crash.model.parts[shell.part as usize].id,
                report.status.name(),
                number(report.normal_distance),
                number(report.tangential_distance),
                number(report.angle_deg),
                number(report.coverage),
                number(report.confidence),
                number(run.thickness(element)),
                number(run.plastic_strain(element)),
            );
            if let Some(other) = other {
                let values = [other.thickness[element], other.plastic_strain(element)];
                let _ = write!(table, ",{},{}", number(values[0]), number(values[1]));
            }
            table.push('\n');
        }
    })?;
    Ok(table)
}
