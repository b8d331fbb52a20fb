//! The error of the mapping itself, over pairs of meshes of parts whose fields are known everywhere, and
//! how long the mapping and its files take.

use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use crate::formats::Memory;
use crate::formats::keyword::card::Layout;
use crate::formats::keyword::state_cards::{Pieces, ShellState, StateFormat, write_states};
use crate::geometry::tensor::Tensor;
use crate::mapping::{
    LayerRule, Layered, MapMethod, MapOptions, Mapped, MappedLayers, PlacedSource, Quantities,
    RuleKind, ShellMesh, SourceHistory, SourcePart, TargetPart, map, map_back,
};
use crate::monitor::Monitor;
use crate::pipeline::load::{LoadSettings, LoadedPart, load_from};
use crate::pipeline::map::{MapRecipe, MapRun, PlacedPart, PoseOrigin, map_parts};
use crate::pipeline::process::{self, resident_bytes, with_peak};
use crate::pipeline::{PipelineError, millis_since};
use crate::samples::{
    self, SampleMesh, SamplePart, SampleSettings, ShellForming, crash_means, stamped_means,
};

/// Part, edge of the stamped mesh, edge of the crash mesh, millimetres.
const PAIRS: [(SamplePart, f64, f64); 7] = [
    (SamplePart::Floor, 10.0, 10.0),
    (SamplePart::Floor, 10.0, 5.0),
    (SamplePart::Floor, 5.0, 10.0),
    (SamplePart::Floor, 5.0, 20.0),
    (SamplePart::Bracket, 2.5, 5.0),
    (SamplePart::Pillar, 4.0, 8.0),
    (SamplePart::Fender, 5.0, 10.0),
];
/// Layers of the timed mapping.
const N_LAYERS: usize = 5;
/// Edges of the floor's meshes for the timed mapping: about 100,000 onto 50,000 elements.
const TIMED_SIZES: [f64; 2] = [4.42, 5.287];
/// The smallest of so many runs counts.
const N_RUNS: usize = 5;

/// Errors of one method on one pair, by area over the crash elements with values. The stamped elements
/// hold the means of the exact fields over their area; the truth is the same over the crash elements.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorRow {
    /// Name of the sample part.
    pub part: String,
    /// Edges of the stamped and of the crash mesh.
    pub sizes: [f64; 2],
    /// Elements of both.
    pub n_elements: [usize; 2],
    /// "area", "nearest", or "exact": the truth itself, to show what the crash mesh can hold at best.
    pub method: String,
    /// Share of the area with values.
    pub mapped_area: f64,
    /// Root mean square error of the thickness over the range of the truth.
    pub thickness_rms: f64,
    /// The same for the plastic strain, mean over the layers.
    pub plastic_rms: f64,
    /// The same for the stress tensor, mean over the layers, over its largest norm.
    pub stress_rms: f64,
    /// Mean thickness over the true mean, less 1.
    pub thickness_mean: f64,
    /// Mean plastic strain over the true mean, less 1.
    pub plastic_mean: f64,
    /// Largest plastic strain over the largest true one.
    pub plastic_peak: f64,
    /// Largest plastic strain over the largest of the stamped elements.
    pub peak_of_stamped: f64,
    /// 95 % of the plastic strain there and back, over its range.
    pub back_p95: f64,
    /// Time of the mapping in milliseconds.
    pub map_ms: f64,
}

/// How long the mapping of a large part takes.
#[derive(Debug, Clone, Serialize)]
pub struct SpeedRow {
    /// Elements of both sides.
    pub n_elements: [usize; 2],
    /// Layers of both sides.
    pub n_layers: usize,
    /// Number of threads used.
    pub n_threads: usize,
    /// Smallest time of the mapping, milliseconds.
    pub map_ms: f64,
    /// Smallest processor time of it, all threads together, milliseconds; `None` where it is not known.
    pub cpu_ms: Option<f64>,
    /// Smallest time of making the text of the states, milliseconds.
    pub write_ms: f64,
    /// Its size in bytes.
    pub n_bytes: usize,
    /// Bytes of the results of both sides.
    pub result_bytes: usize,
    /// Memory that the mapping took at its peak, with its result, beside meshes and results of the
    /// stamped part, bytes; `None` where it is not known.
    pub peak_bytes: Option<usize>,
}

/// Tables of `bench --mapping`.
#[derive(Debug, Clone, Serialize)]
pub struct MapBench {
    /// What the record is.
    pub schema: &'static str,
    /// Errors, three rows for each pair.
    pub errors: Vec<ErrorRow>,
    /// Time, rate and memory at full size, if they were asked for.
    pub speed: Option<SpeedRow>,
}

/// Name of the times among the tables.
const SPEED: &str = "speed";

/// Names of the tables: pairs have the name of their part, the times are called "speed".
pub fn table_names() -> Vec<&'static str> {
    let mut names: Vec<_> = PAIRS.iter().map(|(part, ..)| part.name()).collect();
    names.dedup();
    names.push(SPEED);
    names
}

/// Makes the tables of `bench --mapping`, or those that have `only` in their name ([`table_names`]).
pub fn map_bench(only: Option<&str>, monitor: &Monitor) -> Result<MapBench, PipelineError> {
    let mut errors = Vec::new();
    let is_wanted = |name: &str| only.is_none_or(|only| name.contains(only));
    let n_rows = PAIRS.len() as u64 + 1;
    for (row, (part, stamped, crash)) in PAIRS.into_iter().enumerate() {
        if !is_wanted(part.name()) {
            continue;
        }
        monitor.progress("map pairs", row as u64, Some(n_rows));
        let settings = SampleSettings {
            part,
            crash_size: Some(crash),
            stamped_size: Some(stamped),
            seed: 1,
            ..SampleSettings::default()
        };
        errors.extend(error_rows(&settings, [stamped, crash], monitor)?);
    }
    monitor.progress("map pairs", n_rows - 1, Some(n_rows));
    Ok(MapBench {
        schema: "shapematch.map-bench/1",
        errors,
        speed: is_wanted(SPEED).then(|| speed(monitor)).transpose()?,
    })
}

/// Both methods on one pair at its known pose, and the truth.
pub fn error_rows(
    settings: &SampleSettings,
    sizes: [f64; 2],
    monitor: &Monitor,
) -> Result<Vec<ErrorRow>, PipelineError> {
    let mut pair = samples::generate(settings);
    pair.stamped.forming = stamped_means(settings);
    let truth = crash_means(settings);
    let mut source = Memory::new();
    for file in samples::files(&pair) {
        source = source.with(file.name, file.bytes);
    }
    let load = |name: &str| load_from(&source, Path::new(name), &LoadSettings::default(), monitor);
    let (crash, stamped) = (load("crash.k")?, load("stamped.dynain")?);
    let mut rows = Vec::new();
    for (method, name) in [
        (MapMethod::Area, "area"),
        (MapMethod::Nearest, "nearest"),
        (MapMethod::Shape, "shape"),
    ] {
        let recipe = MapRecipe {
            options: MapOptions {
                quantities: Quantities::FULL,
                method,
                ..MapOptions::default()
            },
            stress_factors: vec![1.0],
            ..MapRecipe::default()
        };
        let placed = PlacedPart {
            part: &stamped,
            crash_from_stamped: pair.crash_from_stamped,
            origin: PoseOrigin::Given,
        };
        let run = map_parts(&crash, &[placed], &recipe, monitor)?;
        let truth = by_shell(&crash, &run, &truth);
        rows.push(error_row(settings.part, sizes, name, &run, &truth));
        if method == MapMethod::Area {
            let exact = with_truth(run, &truth, monitor)?;
            rows.push(error_row(settings.part, sizes, "exact", &exact, &truth));
        }
    }
    Ok(rows)
}

/// A run whose values are the truth.
fn with_truth(
    mut run: MapRun,
    truth: &[&ShellForming],
    monitor: &Monitor,
) -> Result<MapRun, PipelineError> {
    let mut states = MappedLayers::default();
    for (element, truth) in truth.iter().enumerate() {
        let rule = &run.target.rules[run.target.rule_of[element] as usize];
        let n_planes = run
            .mapped
            .states
            .as_ref()
            .map_or(0, |s| s.of(element).len())
            / rule.len();
        let layer = |&t: &f64| std::iter::repeat_n(state_at(truth, t), n_planes);
        let values: Vec<[f64; 7]> = rule.places().iter().flat_map(layer).collect();
        states.push(&values);
        if let Some(thickness) = run.mapped.thickness.get_mut(element)
            && thickness.is_finite()
        {
            *thickness = truth.thickness[0];
        }
    }
    run.mapped.states = Some(states);
    let placed = PlacedSource {
        part: &run.sources[0],
        target_from_source: run.poses[0],
    };
    let back = map_back(
        &[placed],
        &run.target,
        &run.mapped,
        &run.recipe.options,
        monitor,
    );
    run.checks.map_back = Some(back.map_err(PipelineError::Mapping)?);
    run.map_ms = f64::NAN;
    Ok(run)
}

/// The state of an element at a place through its thickness, linear between its layers.
fn state_at(truth: &ShellForming, t: f64) -> [f64; 7] {
    let [inner, outer] = truth.layers;
    // The sample's layers are the Gauss points of two.
    let share = (1.0 + t * 3.0_f64.sqrt()) / 2.0;
    let mix = |a: f64, b: f64| a * (1.0 - share) + b * share;
    std::array::from_fn(|i| match i {
        6 => mix(inner.plastic_strain, outer.plastic_strain).max(0.0),
        _ => mix(inner.stress[i], outer.stress[i]),
    })
}

/// The truth of each element of a run; the deck's elements stand in the order of the sample's.
fn by_shell<'a>(
    crash: &LoadedPart,
    run: &MapRun,
    truth: &'a [ShellForming],
) -> Vec<&'a ShellForming> {
    let first = crash.model.shells.first().map_or(0, |shell| shell.id);
    let of_shell = |&shell: &u32| {
        let id = crash.model.shells[shell as usize].id;
        &truth[(id - first) as usize]
    };
    run.shells.iter().map(of_shell).collect()
}

/// Sums of one quantity over the elements.
#[derive(Default)]
struct Sums {
    area: f64,
    squares: f64,
    mapped: f64,
    truth: f64,
    range: Option<[f64; 2]>,
    largest: f64,
}

impl Sums {
    fn add(&mut self, mapped: f64, truth: f64, area: f64) {
        if !mapped.is_finite() {
            return;
        }
        self.area += area;
        self.squares += area * (mapped - truth).powi(2);
        self.mapped += area * mapped;
        self.truth += area * truth;
        let [low, high] = self.range.unwrap_or([truth; 2]);
        self.range = Some([low.min(truth), high.max(truth)]);
        self.largest = self.largest.max(mapped);
    }

    fn rms(&self) -> f64 {
        let [low, high] = self.range.unwrap_or([0.0, 1.0]);
        (self.squares / self.area).sqrt() / (high - low).max(f64::MIN_POSITIVE)
    }

    fn mean_error(&self) -> f64 {
        self.mapped / self.truth - 1.0
    }

    fn peak(&self) -> f64 {
        self.largest / self.range.unwrap_or([0.0, 1.0])[1]
    }
}

fn error_row(
    part: SamplePart,
    sizes: [f64; 2],
    method: &str,
    run: &MapRun,
    truth: &[&ShellForming],
) -> ErrorRow {
    let (mut thickness, mut plastic) = (Sums::default(), Sums::default());
    let (mut squares, mut area_sum, mut largest) = (0.0, 0.0, 0.0_f64);
    for (element, truth) in truth.iter().enumerate() {
        let area = run.target.mesh.areas()[element];
        thickness.add(run.thickness(element), truth.thickness[0], area);
        let [inner, outer] = truth.layers;
        let mean = (inner.plastic_strain + outer.plastic_strain) / 2.0;
        plastic.add(run.plastic_strain(element), mean, area);
        let true_stress: Tensor =
            std::array::from_fn(|i| (inner.stress[i] + outer.stress[i]) / 2.0);
        if let Some(stress) = mean_stress(run, element) {
            let off = norm_sq(&std::array::from_fn(|i| stress[i] - true_stress[i]));
            squares += area * off;
            area_sum += area;
            largest = largest.max(norm_sq(&true_stress));
        }
    }
    let back = run.checks.map_back.as_ref();
    let of_stamped = &run.sources[0];
    let stamped = (0..of_stamped.mesh.len()).map(|e| of_stamped.mean_plastic_strain(e));
    ErrorRow {
        part: part.name().to_owned(),
        sizes,
        n_elements: [run.sources[0].mesh.len(), run.target.mesh.len()],
        method: method.to_owned(),
        mapped_area: run.mapped.mapped_area(&run.target.mesh),
        thickness_rms: thickness.rms(),
        plastic_rms: plastic.rms(),
        stress_rms: (squares / area_sum / largest).sqrt(),
        thickness_mean: thickness.mean_error(),
        plastic_mean: plastic.mean_error(),
        plastic_peak: plastic.peak(),
        peak_of_stamped: plastic.largest / stamped.fold(f64::NAN, f64::max),
        back_p95: back
            .and_then(|back| back.plastic.share_of_range())
            .unwrap_or(f64::NAN),
        map_ms: run.map_ms,
    }
}

/// Mean of the stress over the layers, by the weights of the rule.
fn mean_stress(run: &MapRun, element: usize) -> Option<Tensor> {
    let states = run.mapped.states.as_ref()?.of(element);
    let rule = &run.target.rules[run.target.rule_of[element] as usize];
    let n_plane = states.len() / rule.len();
    let mut mean = [0.0; 6];
    if n_plane == 0 {
        return None;
    }
    for (weight, layer) in rule.weights().iter().zip(states.chunks(n_plane)) {
        for state in layer {
            for (sum, value) in mean.iter_mut().zip(state) {
                *sum += weight * value / (2.0 * n_plane as f64);
            }
        }
    }
    Some(mean)
}

fn norm_sq(tensor: &Tensor) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *tensor;
    xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx)
}

fn shell_mesh(mesh: &SampleMesh) -> ShellMesh {
    let parts = vec![0; mesh.elements.len()];
    let shells = ShellMesh::new(mesh.positions.clone(), mesh.elements.clone(), parts);
    shells.expect("the mesher's nodes are finite and its indices in range")
}

/// A floor of about 100,000 onto one of about 50,000 elements, five layers each.
fn speed(monitor: &Monitor) -> Result<SpeedRow, PipelineError> {
    let pair = samples::generate(&SampleSettings {
        stamped_size: Some(TIMED_SIZES[0]),
        crash_size: Some(TIMED_SIZES[1]),
        seed: 1,
        ..SampleSettings::default()
    });
    let source = layered_source(&pair.stamped);
    let rule = LayerRule::new(RuleKind::Gauss, N_LAYERS);
    let target = TargetPart::uniform(shell_mesh(&pair.crash), rule.clone(), 1.0);
    let placed = PlacedSource {
        part: &source,
        target_from_source: pair.crash_from_stamped,
    };
    let options = MapOptions {
        quantities: Quantities::FULL,
        ..MapOptions::default()
    };
    let (mut map_ms, mut write_ms, mut n_bytes) = (f64::INFINITY, f64::INFINITY, 0);
    let (mut cpu_ms, mut peak_bytes) = (None, None);
    let mut result_bytes = 0;
    let before = resident_bytes();
    for _ in 0..N_RUNS {
        let (start, cpu) = (Instant::now(), process::cpu_ms());
        let (mapped, peak) = with_peak(|| map(&[placed], &target, &options, monitor));
        let mapped = mapped?;
        map_ms = map_ms.min(millis_since(start));
        let used = process::cpu_ms().zip(cpu).map(|(now, then)| now - then);
        cpu_ms = [cpu_ms, used].into_iter().flatten().reduce(f64::min);
        let more = peak
            .zip(before)
            .map(|(peak, before)| peak.saturating_sub(before));
        peak_bytes = peak_bytes.max(more);
        let start = Instant::now();
        let pieces = states_text(&mapped, &rule, monitor)?;
        n_bytes = pieces.iter().map(Vec::len).sum();
        write_ms = write_ms.min(millis_since(start));
        result_bytes = bytes_of(&source, &target, &mapped);
    }
    Ok(SpeedRow {
        n_elements: [source.mesh.len(), target.mesh.len()],
        n_layers: N_LAYERS,
        n_threads: rayon::current_num_threads(),
        map_ms,
        cpu_ms,
        write_ms,
        n_bytes,
        result_bytes,
        peak_bytes,
    })
}

/// The sample's two layers as five, linear through the thickness.
fn layered_source(mesh: &SampleMesh) -> SourcePart {
    let rule = LayerRule::new(RuleKind::Gauss, N_LAYERS);
    let n = mesh.elements.len();
    let (mut states, mut strains) = (Layered::new(n), Layered::new(n));
    for (element, forming) in mesh.forming.iter().enumerate() {
        let [inner, outer] = forming.layers;
        let points = rule.places().iter().map(|&t| {
            let share = (1.0 + t) / 2.0;
            let mix = |a: f64, b: f64| a * (1.0 - share) + b * share;
            let state: [f64; 7] = std::array::from_fn(|i| match i {
                6 => mix(inner.plastic_strain, outer.plastic_strain),
                _ => mix(inner.stress[i], outer.stress[i]),
            });
            (t, state)
        });
        states.set(element, points);
        let surfaces = [(-1.0, inner.strain), (1.0, outer.strain)];
        strains.set(element, surfaces.into_iter());
    }
    SourcePart {
        mesh: shell_mesh(mesh),
        thickness: mesh.forming.iter().map(|shell| shell.thickness).collect(),
        states,
        strains,
        history: SourceHistory::default(),
        laws: std::collections::BTreeMap::new(),
    }
}

fn states_text(
    mapped: &Mapped,
    rule: &LayerRule,
    monitor: &Monitor,
) -> Result<Pieces, PipelineError> {
    let state_of = |element: usize| ShellState {
        id: element as u64 + 1,
        places: rule.places(),
        states: mapped.states.as_ref().map_or(&[][..], |s| s.of(element)),
        history: &[],
        tensors: &[],
        strain_places: &[-1.0, 1.0],
        strains: mapped.strains.as_ref().map_or(&[][..], |s| s.of(element)),
    };
    let format = StateFormat {
        layout: Layout::Standard,
        is_large: true,
    };
    Ok(write_states(
        mapped.elements.len(),
        state_of,
        format,
        monitor,
    )?)
}

/// Bytes of the numbers that are mapped, on both sides.
fn bytes_of(source: &SourcePart, target: &TargetPart, mapped: &Mapped) -> usize {
    let per_source = 8 * (4 + 7 * N_LAYERS + 6 * 2);
    let n_states = mapped.states.as_ref().map_or(0, |states| {
        (0..target.mesh.len()).map(|e| states.of(e).len()).sum()
    });
    let n_strains: usize = mapped.strains.as_ref().map_or(0, |strains| {
        (0..target.mesh.len()).map(|e| strains.of(e).len()).sum()
    });
    source.mesh.len() * per_source + 8 * (target.mesh.len() + 7 * n_states + 6 * n_strains)
}
