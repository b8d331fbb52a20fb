//! Carries the forming results of stamped files onto a crash part: convert, map, check, write.

mod balance;
mod compare;
mod convert;
mod default_thickness;
mod freed_aside;
mod head;
mod includes;
mod lists;
mod old_states;
mod origin;
mod output;
mod peak;
mod place;
mod probe;
mod read_back;
mod ready;
mod record;
mod report;
mod thickness_sums;
mod unmapped;
mod values;
mod verdict;
mod warnings;

use std::collections::BTreeSet;
use std::time::Instant;

use serde::{Deserialize, Serialize};

pub use compare::{ComparedRow, ComparisonRecord, DifferenceRecord, OtherResult, compare_with};
pub use default_thickness::DefaultThickness;
pub use head::deck_comments;
pub use lists::{DoubtfulElement, ElementLists, GiverShare, UnmappedElement, element_lists};
pub use old_states::{NewStates, car_copies, mapped_by_solver};
pub use origin::{ChangedParts, PoseOrigin};
pub use output::{MapFile, MapFiles, MapOutput, WriteKind, elements_path, write_mapping};
pub use place::{FurtherPose, place, placing_recipe, pose_warning};
pub use probe::{ProbeRecord, ProbedValue, probe_records};
pub use ready::check_shells;
pub use record::{DistributionRecord, MapRecord, PairRecord, element_table, map_record};
pub use report::map_report;
pub(super) use thickness_sums::ThicknessSums;
pub use unmapped::unmapped_sets;
pub use values::{Profile, ShownValue};
pub(super) use verdict::LEAST_AREA;
pub use verdict::{CheckPicture, CheckReason, CheckRecord};
pub use warnings::unread_line;
pub(super) use warnings::{bare_elements, file_lines};

use super::load::LoadedPart;
use super::{PipelineError, millis_since};
use crate::geometry::Similarity;
use crate::mapping::{
    self, Distribution, LayerRule, MapBack, MapOptions, Mapped, PlacedSource, RuleKind, SourcePart,
    Status, TargetPart, distribution, limits,
};
use crate::monitor::Monitor;
use convert::{PartShells, TargetLayers, part_shells, source_part, target_part};

/// What a mapping depends on besides the decks and the poses.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MapRecipe {
    /// Quantities, method, limits.
    pub options: MapOptions,
    /// Layers of the crash elements; `None` takes them from the deck.
    pub n_layers: Option<usize>,
    /// Rule through their thickness; `None` takes it from the deck.
    pub rule: Option<RuleKind>,
    /// Points in the plane of each layer, 1 or 4; `None` takes them from the element formulation.
    pub n_plane: Option<u8>,
    /// Factors on the stresses of the stamped files, where their unit is another one: one for all, or one
    /// for each. Without one they are taken as they are, unless they are clearly in another unit, which is
    /// an error then.
    pub stress_factors: Vec<f64>,
    /// Material law of the stamped parts ("24"), for files that hold none; history variables are
    /// carried to parts of the same law alone.
    pub stamped_law: Option<String>,
    /// Share of the area that is to carry values; `None` takes the usual one.
    pub least_area: Option<f64>,
}

impl MapRecipe {
    /// The factor on the stresses of a stamped file, if one was given.
    pub fn stress_factor(&self, file: usize) -> Option<f64> {
        let factors = &self.stress_factors;
        factors.get(file).or_else(|| factors.first()).copied()
    }

    /// Share of the area that is to carry values.
    fn wanted_area(&self) -> f64 {
        self.least_area.unwrap_or(LEAST_AREA)
    }
}

/// A stamped part with its pose on the crash part.
#[derive(Debug, Clone, Copy)]
pub struct PlacedPart<'a> {
    /// The stamped part.
    pub part: &'a LoadedPart,
    /// `crash = c · R · stamped + t`.
    pub crash_from_stamped: Similarity,
    /// Where the pose comes from.
    pub origin: PoseOrigin,
}

/// Means, percentiles and the way back: is the mapping right?
#[derive(Debug, Clone, Default)]
pub struct MapChecks {
    /// Thickness of the covered elements of all stamped parts, times the thickness factor, and of the mapped crash
    /// elements, without those that were filled.
    pub thickness: Option<(Distribution, Distribution)>,
    /// The same for the plastic strain, mean over the layers.
    pub plastic_strain: Option<(Distribution, Distribution)>,
    /// What comes back when the values are mapped onto the stamped parts again.
    pub map_back: Option<MapBack>,
}

/// The result of a mapping.
#[derive(Debug, Clone)]
pub struct MapRun {
    /// What it was asked with.
    pub recipe: MapRecipe,
    /// Poses of the stamped parts, in their order.
    pub poses: Vec<Similarity>,
    /// Where each of them comes from.
    pub origins: Vec<PoseOrigin>,
    /// Errors of the reader about nodes, elements and transformations, in all files together.
    pub n_read_errors: u64,
    /// The crash part as it was mapped onto.
    pub target: TargetPart,
    /// For each element of `target` its index in the crash model's shells, rising.
    pub shells: Vec<u32>,
    /// The stamped parts as they were mapped from.
    pub sources: Vec<SourcePart>,
    /// For each stamped part the indices of its elements in its model's shells.
    pub source_shells: Vec<Vec<u32>>,
    /// Values and status of each element.
    pub mapped: Mapped,
    /// Statistics, balance and way back.
    pub checks: MapChecks,
    /// Milliseconds for converting and mapping, without the checks.
    pub map_ms: f64,
    /// Milliseconds for the checks.
    pub check_ms: f64,
}

impl MapRun {
    /// The element of `target` that a shell of the crash model is, if it was mapped onto. O(log elements).
    pub fn element_of(&self, shell: u32) -> Option<usize> {
        self.shells.binary_search(&shell).ok()
    }

    /// The stamped part that gave an element its values, and the shell of its model that did; `None` if none
    /// did. Both are numbers in the order of the parts and of the model.
    pub fn giver(&self, element: usize) -> Option<(usize, usize)> {
        let partner = self.mapped.elements.get(element)?.partner?;
        let shells = self.source_shells.get(partner.source as usize)?;
        let shell = *shells.get(partner.element as usize)?;
        Some((partner.source as usize, shell as usize))
    }

    /// The stamped part whose values an element carries; `None` if it carries none.
    pub fn values_from(&self, element: usize) -> Option<usize> {
        let report = self.mapped.elements.get(element)?;
        let partner = report.partner.filter(|_| report.status.has_values())?;
        Some(partner.source as usize)
    }

    /// True if no element carries values, so that there is nothing to be written.
    pub fn is_empty(&self) -> bool {
        self.mapped.mapped_area(&self.target.mesh) <= 0.0
    }

    /// Mapped thickness of an element; NaN if it has none.
    pub fn thickness(&self, element: usize) -> f64 {
        let value = self.mapped.thickness.get(element);
        value.copied().unwrap_or(f64::NAN)
    }

    /// Effective plastic strain of an element, weighted over its layers; NaN if it has none or it was not
    /// asked for.
    pub fn plastic_strain(&self, element: usize) -> f64 {
        if !self.recipe.options.quantities.plastic_strain {
            return f64::NAN;
        }
        self.mapped.mean_plastic_strain(&self.target, element)
    }

    /// The mapped thickness over the crash elements that have it, beside their own or their section's.
    pub(super) fn thickness_sums(&self) -> ThicknessSums {
        let mut sums = ThicknessSums::default();
        for (element, &area) in self.target.mesh.areas().iter().enumerate() {
            let section = self.target.nominal_thickness[element];
            sums.add(area, self.thickness(element), section);
        }
        sums
    }

    /// A quantity of the source element that an element took its values from, given by part and
    /// element; NaN without one.
    pub fn at_partner(&self, element: usize, of: impl Fn(&SourcePart, usize) -> f64) -> f64 {
        let partner = self.mapped.elements[element].partner;
        partner.map_or(f64::NAN, |partner| {
            of(
                &self.sources[partner.source as usize],
                partner.element as usize,
            )
        })
    }
}

/// Maps the stamped parts onto `crash` and checks the result.
pub fn map_parts(
    crash: &LoadedPart,
    stamped: &[PlacedPart<'_>],
    recipe: &MapRecipe,
    monitor: &Monitor,
) -> Result<MapRun, PipelineError> {
    let start = Instant::now();
    check_shells(crash, stamped.iter().map(|placed| placed.part))?;
    let crash_shells = part_shells(crash, monitor)?;
    let layers = Layers { crash, recipe };
    let crash_parts = parts_in_use(&crash_shells);
    let wanted = recipe.options.quantities;
    if wanted.stress || wanted.history {
        ready::check_axes(crash, &crash_parts)?;
    }
    let target = target_part(crash, &crash_shells, &layers, monitor)?;
    let mut shells = Vec::with_capacity(stamped.len());
    for placed in stamped {
        shells.push(part_shells(placed.part, monitor)?);
    }
    let mut sources = Vec::with_capacity(stamped.len());
    for (file, (placed, shells)) in stamped.iter().zip(&shells).enumerate() {
        let factor = recipe.stress_factor(file).unwrap_or(1.0);
        sources.push(source_part(placed.part, shells, recipe, factor, monitor)?);
    }
    monitor.check()?;
    for (file, ((placed, shells), source)) in stamped.iter().zip(&shells).zip(&sources).enumerate()
    {
        if wanted.stress || wanted.history {
            ready::check_axes(placed.part, &parts_in_use(shells))?;
        }
        if wanted.stress && recipe.stress_factor(file).is_none() {
            ready::check_stress_unit(crash, &crash_parts, placed.part, source)?;
        }
    }
    let placed: Vec<PlacedSource<'_>> = sources
        .iter()
        .zip(stamped)
        .map(|(part, placed)| PlacedSource {
            part,
            target_from_source: placed.crash_from_stamped,
        })
        .collect();
    let mapped = match mapping::map(&placed, &target, &recipe.options, monitor) {
        Err(mapping::MappingError::NoResults) => {
            let names: Vec<String> = stamped
                .iter()
                .map(|placed| placed.part.file_name())
                .collect();
            let parts = stamped.iter().map(|placed| placed.part);
            let reasons = parts
                .filter(|_| wanted.strain)
                .filter_map(warnings::local_strains);
            let mut what = names.join(", ");
            for reason in reasons {
                what += &format!("; {reason}");
            }
            return Err(PipelineError::NoResults(what));
        }
        other => other?,
    };
    let map_ms = millis_since(start);
    let start = Instant::now();
    let checks = check(&placed, &target, &mapped, &recipe.options, monitor)?;
    Ok(MapRun {
        recipe: recipe.clone(),
        poses: stamped
            .iter()
            .map(|placed| placed.crash_from_stamped)
            .collect(),
        origins: stamped.iter().map(|placed| placed.origin).collect(),
        n_read_errors: n_read_errors(crash, stamped),
        target,
        shells: crash_shells.shells,
        source_shells: shells.into_iter().map(|shells| shells.shells).collect(),
        sources,
        mapped,
        checks,
        map_ms,
        check_ms: millis_since(start),
    })
}

/// Errors about the geometry of all files.
fn n_read_errors(crash: &LoadedPart, stamped: &[PlacedPart<'_>]) -> u64 {
    let parts = stamped.iter().map(|placed| placed.part).chain([crash]);
    let found = parts.map(|part| part.model.diagnostics.n_geometry_errors());
    found.sum()
}

/// The parts of some shells, each once, in rising order.
fn parts_in_use(shells: &PartShells) -> Vec<u32> {
    let parts: BTreeSet<u32> = shells.mesh.parts().iter().copied().collect();
    parts.into_iter().collect()
}

fn mesh_error(error: crate::geometry::MeshError) -> PipelineError {
    PipelineError::Mapping(mapping::MappingError::from(error))
}

/// Where the layers of the crash elements are known from.
struct Layers<'a> {
    crash: &'a LoadedPart,
    recipe: &'a MapRecipe,
}

impl Layers<'_> {
    /// The layers of a part's shells: as asked for, else `own` plies or those of the part, else as its section
    /// says; an error if none does and layer values are wanted.
    fn of(&self, part: u32, own: Option<&[f64]>) -> Result<TargetLayers, PipelineError> {
        let model = &self.crash.model;
        let section = model.shell_formulation(part);
        let wanted = self.recipe.options.quantities;
        let needs_layers =
            wanted.plastic_strain || wanted.stress || wanted.strain || wanted.history;
        let id = model.parts[part as usize].id;
        let of_part = model.parts[part as usize].plies.as_ref();
        let plies = own.or(of_part.map(|plies| &plies.thickness[..]));
        let n_layers = match (self.recipe.n_layers, section) {
            (Some(n), _) => n,
            (None, _) if plies.is_some() => plies.map_or(0, <[f64]>::len),
            (None, Some(section)) if section.own_rule.is_none() => section.n_layers as usize,
            (None, _) if !needs_layers => 1,
            (None, Some(_)) => return Err(PipelineError::OwnLayerRule { part: id }),
            (None, None) => return Err(PipelineError::UnknownLayers { part: id }),
        };
        if !limits::LAYERS.contains(&n_layers) {
            return Err(PipelineError::TooManyLayers { part: id, n_layers });
        }
        let of_deck = if section.is_some_and(|section| section.is_trapezoidal) {
            RuleKind::Equal
        } else if model.shell_control.is_lobatto {
            RuleKind::Lobatto
        } else {
            RuleKind::Gauss
        };
        let rule = match (plies, self.recipe.n_layers, self.recipe.rule) {
            (Some(plies), None, None) => LayerRule::of_plies(plies),
            (_, _, rule) => LayerRule::new(rule.unwrap_or(of_deck), n_layers),
        };
        Ok(TargetLayers {
            rule,
            n_plane: self
                .recipe
                .n_plane
                .unwrap_or_else(|| section.map_or(1, |section| section.n_plane())),
        })
    }
}

fn check(
    placed: &[PlacedSource<'_>],
    target: &TargetPart,
    mapped: &Mapped,
    options: &MapOptions,
    monitor: &Monitor,
) -> Result<MapChecks, PipelineError> {
    let mut checks = MapChecks::default();
    let back = match mapping::map_back(placed, target, mapped, options, monitor) {
        Ok(back) => back,
        // Nothing was mapped, which the counts say, or only strains, which are not mapped back.
        Err(mapping::MappingError::NoResults) => return Ok(checks),
        Err(error) => return Err(error.into()),
    };
    monitor.check()?;
    let sources = placed
        .iter()
        .map(|placed| (placed.part, placed.target_from_source.scale));
    let on_sources = |value: &dyn Fn(&SourcePart, usize) -> f64| {
        covered_values(sources.clone().zip(&back.is_covered), value)
    };
    let on_target = |value: &dyn Fn(usize) -> f64| {
        // A filled element repeats its neighbours where the stamped sheet has nothing to compare with.
        let is_filled = |element: usize| mapped.elements[element].status == Status::Filled;
        let all = (0..target.mesh.len()).filter(|&element| !is_filled(element));
        distribution(all.map(|element| (value(element), target.mesh.areas()[element])))
    };
    let factor = options.thickness_scale;
    let thickness = on_sources(&|part, element| factor * part.mean_thickness(element));
    let mapped_thickness =
        |element: usize| mapped.thickness.get(element).copied().unwrap_or(f64::NAN);
    checks.thickness = distribution(thickness.into_iter()).zip(on_target(&mapped_thickness));
    monitor.check()?;
    if options.quantities.plastic_strain {
        let plastic = on_sources(&SourcePart::mean_plastic_strain);
        let mapped_plastic = |element: usize| mapped.mean_plastic_strain(target, element);
        checks.plastic_strain = distribution(plastic.into_iter()).zip(on_target(&mapped_plastic));
    }
    checks.map_back = Some(back);
    Ok(checks)
}

/// Values of the covered elements of all stamped parts, given with the scale of their poses, and the area that each
/// stands for on the crash part.
fn covered_values<'a>(
    sources: impl Iterator<Item = ((&'a SourcePart, f64), &'a Vec<bool>)>,
    value: impl Fn(&SourcePart, usize) -> f64,
) -> Vec<(f64, f64)> {
    let mut values = Vec::new();
    for ((source, scale), is_covered) in sources {
        let areas = source.mesh.areas().iter().zip(is_covered).enumerate();
        let covered = areas.filter(|(_, (_, is_covered))| **is_covered);
        let on_crash = |area: &f64| area * scale * scale;
        values.extend(covered.map(|(element, (area, _))| (value(source, element), on_crash(area))));
    }
    values
}
