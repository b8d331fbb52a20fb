//! Another mapper's result, or the solver's own file of mapped states, beside ours, element by element.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::convert::element_index;
use super::record::{DistributionRecord, PairRecord, pair_of};
use super::{MapRun, PipelineError, ShownValue};
use crate::formats::keyword::write::write_nodes;
use crate::formats::model::Shell;
use crate::formats::{self, Disk, Memory, Model, ReadOptions, Replaced};
use crate::mapping::{Layered, PLASTIC_STRAIN, distribution};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::forming_values::{FormingValue, LayerChoice};
use crate::pipeline::load::LoadedPart;

/// Values that are read between two questions to the monitor.
const CHUNK: usize = 1 << 14;

/// What other files say of the elements of a mapping.
#[derive(Debug, Clone)]
pub struct OtherResult {
    /// Where it was read from.
    pub files: Vec<PathBuf>,
    /// Thickness in the crash model's unit of lengths; NaN where no file has one.
    pub thickness: Vec<f64>,
    pub(super) states: Layered<7>,
    pub(super) strains: Layered<6>,
}

impl OtherResult {
    /// Reads `files` for the elements of `run`. Elements are found by their id. A file without nodes, such
    /// as an include or the solver's `dyna.inc`, is read as part of the crash deck. An error if a file
    /// cannot be read or if none of them says anything of these elements.
    pub fn read(
        files: &[PathBuf],
        run: &MapRun,
        crash: &LoadedPart,
        monitor: &Monitor,
    ) -> Result<Self, PipelineError> {
        let index = element_index(&crash.model, &run.shells, monitor)?;
        let factor = crash.settings.length_factor;
        let mut thickness = vec![f64::NAN; run.shells.len()];
        let mut states = Layered::new(run.shells.len());
        let mut strains = Layered::new(run.shells.len());
        let mut n_found = 0_usize;
        for path in files {
            let model = read_other(path, crash, monitor)?;
            check_mesh(path, &model, (run, crash), &index)?;
            for (number, extra) in model.shell_extras.iter().enumerate() {
                if number % CHUNK == 0 {
                    monitor.check()?;
                }
                let has_own = extra.thickness != [0.0; 4];
                let mean = model.mean_shell_thickness(extra.shell).filter(|_| has_own);
                let id = model.shells[extra.shell as usize].id;
                if let (Some(mean), Some(&element)) = (mean, index.get(&id)) {
                    thickness[element] = mean * factor;
                    n_found += 1;
                }
            }
            for (number, stress) in model.forming.stresses().enumerate() {
                if number % CHUNK == 0 {
                    monitor.check()?;
                }
                if let Some(&element) = index.get(&stress.element_id) {
                    let points = stress.points.iter();
                    states.set(element, points.map(|p| (p.t, p.state(1.0))));
                    n_found += 1;
                }
            }
            for (number, strain) in model.forming.strains().enumerate() {
                if number % CHUNK == 0 {
                    monitor.check()?;
                }
                if let Some(&element) = index.get(&strain.element_id) {
                    let points = strain.points.iter().map(|point| (point.t, point.strain));
                    strains.set(element, points);
                    n_found += 1;
                }
            }
        }
        if n_found == 0 {
            return Err(PipelineError::NothingToCompare(files.to_vec()));
        }
        Ok(Self {
            files: files.to_vec(),
            thickness,
            states,
            strains,
        })
    }

    /// Effective plastic strain of an element, weighted over its layers; NaN if it has none.
    pub fn plastic_strain(&self, element: usize) -> f64 {
        self.states.mean(element, PLASTIC_STRAIN)
    }

    fn has_values(&self, element: usize) -> bool {
        self.thickness[element].is_finite()
            || self.states.of(element).is_some()
            || self.strains.of(element).is_some()
    }
}

/// An error where most of the elements of a file with the ids of ours have other nodes: it says nothing of this mesh.
fn check_mesh(
    path: &Path,
    other: &Model,
    (run, crash): (&MapRun, &LoadedPart),
    index: &HashMap<u64, usize>,
) -> Result<(), PipelineError> {
    let nodes = |model: &Model, shell: &Shell| {
        let mut ids = shell.nodes.map(|node| model.nodes.ids()[node as usize]);
        ids.sort_unstable();
        ids
    };
    let (mut n_same_id, mut n_other_nodes) = (0_usize, 0_usize);
    for shell in &other.shells {
        let Some(&element) = index.get(&shell.id) else {
            continue;
        };
        let own = &crash.model.shells[run.shells[element] as usize];
        n_same_id += 1;
        n_other_nodes += usize::from(nodes(other, shell) != nodes(&crash.model, own));
    }
    if 2 * n_other_nodes > n_same_id {
        return Err(PipelineError::OtherMesh {
            path: path.to_owned(),
            n_same_id,
            n_other_nodes,
        });
    }
    Ok(())
}

fn read_other(path: &Path, crash: &LoadedPart, monitor: &Monitor) -> Result<Model, PipelineError> {
    let model = formats::read(path, &crash.settings.read, monitor)?;
    if !model.nodes.is_empty() {
        return Ok(model);
    }
    let bytes = formats::read_text(&Disk, path, &crash.settings.read, monitor)?;
    read_beside_nodes(&crash.model, &[], &bytes, monitor)
}

/// Reads a file as an include of a deck that holds the nodes of `crash` and includes the `others` before it.
pub(super) fn read_beside_nodes(
    crash: &Model,
    others: &[Vec<u8>],
    bytes: &[u8],
    monitor: &Monitor,
) -> Result<Model, PipelineError> {
    let mut deck = write_nodes(crash, crash.layout, monitor)?;
    let mut memory = Memory::new();
    for (number, other) in others.iter().enumerate() {
        let name = format!("other_{number}.k");
        deck.extend_from_slice(format!("*INCLUDE\n{name}\n").as_bytes());
        memory = memory.with(name, other.clone());
    }
    deck.extend_from_slice(b"*INCLUDE\nmapped.k\n*END\n");
    let root = Path::new("nodes.k");
    let source = Replaced {
        others: &memory,
        files: &[(root, &deck), (Path::new("mapped.k"), bytes)],
    };
    let options = ReadOptions::default();
    Ok(formats::read_from(&source, root, &options, monitor)?)
}

/// Our values less another's, over the elements that have both.
#[derive(Debug, Clone, Serialize)]
pub struct DifferenceRecord {
    /// The layer that both were taken from; `None` for the thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer: Option<LayerChoice>,
    /// Elements with both values.
    pub n_elements: usize,
    /// Our distribution over these elements.
    pub here: DistributionRecord,
    /// The other's.
    pub other: DistributionRecord,
    /// Half the sum of the differences of both histograms, 0 to 1.
    pub histogram_distance: f64,
    /// Shares of the area in fifty equal bins from the smallest to the largest value of both, ours and the
    /// other's.
    pub histograms: [Vec<f64>; 2],
    /// Area-weighted mean of ours less the other's.
    pub mean: f64,
    /// Root mean square difference, area-weighted.
    pub rms: f64,
    /// 95 % of the area differ by less.
    pub p95: f64,
    /// Largest difference without sign.
    pub max: f64,
    /// Id of the element with it.
    pub element: u64,
}

/// A comparison with another result.
#[derive(Debug, Clone, Serialize)]
pub struct ComparisonRecord {
    /// Files the other result was read from.
    pub files: Vec<String>,
    /// Elements with values in both.
    pub n_both: usize,
    /// Elements with values here alone.
    pub n_only_here: usize,
    /// Elements with values in the other alone.
    pub n_only_other: usize,
    /// Differences of the thickness.
    pub thickness: Option<DifferenceRecord>,
    /// Effective plastic strain.
    pub plastic_strain: Option<DifferenceRecord>,
    /// Von Mises stress, where stresses were mapped.
    pub von_mises: Option<DifferenceRecord>,
    /// Largest principal strain, where strains were mapped.
    pub major_strain: Option<DifferenceRecord>,
    /// Smallest principal strain, where strains were mapped.
    pub minor_strain: Option<DifferenceRecord>,
}

impl ComparisonRecord {
    /// The differences of a quantity, with `None` of the thickness; `None` where a side has nothing of it.
    pub fn of(&self, value: Option<FormingValue>) -> Option<&DifferenceRecord> {
        let found = match value {
            None => &self.thickness,
            Some(FormingValue::PlasticStrain) => &self.plastic_strain,
            Some(FormingValue::VonMises) => &self.von_mises,
            Some(FormingValue::MajorStrain) => &self.major_strain,
            Some(FormingValue::MinorStrain) => &self.minor_strain,
            Some(FormingValue::Thinning | FormingValue::MajorStress) => &None,
        };
        found.as_ref()
    }

    /// What was compared, by its name and as [`Self::of`] knows it.
    pub fn rows(&self) -> impl Iterator<Item = ComparedRow<'_>> {
        let names = [
            ("Thickness", None),
            (
                "Effective plastic strain",
                Some(FormingValue::PlasticStrain),
            ),
            (
                "Von Mises stress in the middle of the sheet",
                Some(FormingValue::VonMises),
            ),
            ("Largest major strain", Some(FormingValue::MajorStrain)),
            ("Smallest minor strain", Some(FormingValue::MinorStrain)),
        ];
        let row = |(name, value)| {
            Some(ComparedRow {
                name,
                value,
                difference: self.of(value)?,
            })
        };
        names.into_iter().filter_map(row)
    }
}

/// A quantity that both results have.
#[derive(Debug, Clone, Copy)]
pub struct ComparedRow<'a> {
    /// Its name.
    pub name: &'static str,
    /// Which it is; `None` for the thickness.
    pub value: Option<FormingValue>,
    /// The differences of the elements.
    pub difference: &'a DifferenceRecord,
}

/// Compares a mapping with another result. O(elements · log elements).
pub fn compare_with(
    run: &MapRun,
    crash: &LoadedPart,
    other: &OtherResult,
    monitor: &Monitor,
) -> Result<ComparisonRecord, Cancelled> {
    let (mut n_both, mut n_only_here, mut n_only_other) = (0, 0, 0);
    for (element, report) in run.mapped.elements.iter().enumerate() {
        match (report.status.has_values(), other.has_values(element)) {
            (true, true) => n_both += 1,
            (true, false) => n_only_here += 1,
            (false, true) => n_only_other += 1,
            (false, false) => {}
        }
    }
    let wanted = run.recipe.options.quantities;
    let difference = |value: Option<FormingValue>| {
        monitor.check()?;
        let shown = ShownValue::compared(value);
        let layer = value.map(LayerChoice::compared);
        let here = |element: usize| run.shown(element, &shown);
        let there = |element: usize| other.shown(element, &shown);
        Ok(difference(run, crash, layer, [&here, &there]))
    };
    let if_mapped = |is_mapped: bool, value| {
        if is_mapped {
            difference(Some(value))
        } else {
            Ok(None)
        }
    };
    Ok(ComparisonRecord {
        files: other
            .files
            .iter()
            .map(|file| file.display().to_string())
            .collect(),
        n_both,
        n_only_here,
        n_only_other,
        thickness: difference(None)?,
        plastic_strain: if_mapped(wanted.plastic_strain, FormingValue::PlasticStrain)?,
        von_mises: if_mapped(wanted.stress, FormingValue::VonMises)?,
        major_strain: if_mapped(wanted.strain, FormingValue::MajorStrain)?,
        minor_strain: if_mapped(wanted.strain, FormingValue::MinorStrain)?,
    })
}

fn difference(
    run: &MapRun,
    crash: &LoadedPart,
    layer: Option<LayerChoice>,
    [here, there]: [&dyn Fn(usize) -> f64; 2],
) -> Option<DifferenceRecord> {
    let areas = run.target.mesh.areas();
    let values = (0..areas.len()).map(|element| (element, here(element), there(element)));
    let both: Vec<(usize, f64, f64)> = values
        .filter(|(_, here, there)| here.is_finite() && there.is_finite())
        .collect();
    let weighted = |value: &dyn Fn(&(usize, f64, f64)) -> f64| -> Vec<(f64, f64)> {
        both.iter().map(|row| (value(row), areas[row.0])).collect()
    };
    let ours = weighted(&|row| row.1);
    let theirs = weighted(&|row| row.2);
    let signed = distribution(weighted(&|row| row.1 - row.2).into_iter())?;
    let absolute = distribution(weighted(&|row| (row.1 - row.2).abs()).into_iter())?;
    let squares = distribution(weighted(&|row| (row.1 - row.2).powi(2)).into_iter())?;
    let worst = both.iter().max_by(|a, b| {
        let off = |row: &&(usize, f64, f64)| (row.1 - row.2).abs();
        off(a).total_cmp(&off(b)).then(b.0.cmp(&a.0))
    })?;
    let pair: PairRecord = pair_of(layer, &[ours, theirs])?;
    Some(DifferenceRecord {
        layer,
        n_elements: both.len(),
        here: pair.stamped,
        other: pair.crash,
        histogram_distance: pair.histogram_distance,
        histograms: pair.histograms,
        mean: signed.mean,
        rms: squares.mean.sqrt(),
        p95: absolute.percentiles[2],
        max: absolute.max,
        element: crash.model.shells[run.shells[worst.0] as usize].id,
    })
}
