//! From a file to a mesh that can be shown, reduced and matched.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::id_map::{IdMap, Origins};
use super::names::file_name;
use super::tools::{stacked_parts, tools_line};
use super::{PipelineError, millis_since};
use crate::formats::{
    self, CheckedSource, Diagnostic, DiagnosticKind, Diagnostics, Disk, FileHash, FileSource,
    FormatError, Memory, Model, ReadOptions, Selection, SelectionError, Severity,
};
use crate::geometry::chunks::for_chunks;
use crate::geometry::{CleanMesh, MeshError, Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;
use crate::report::command_line::CommandSide;
use crate::role::{PerRole, Role};
use crate::samples::{self, SampleFile};
use crate::text::length;
use crate::units::{self, KnownUnits, UnitOrigin, Units};

/// What lengths may be multiplied by: wider than any two units of length lie apart.
const UNIT_FACTORS: RangeInclusive<f64> = 1e-9..=1e9;
/// Places shown of a part before its picture is there.
const N_SHAPE: usize = 3000;
/// Parts that are named where one was asked for that does not exist.
const N_NEAR_PARTS: usize = 5;

/// Choices for loading one side.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSettings {
    /// Which elements make the part.
    pub selection: Selection,
    /// Where the program found these parts of a crash model for the stamped part: the ids of others that it fits about
    /// as well. Empty as soon as the user has chosen.
    pub alike_parts: Vec<u64>,
    /// Coordinates are multiplied by this once, here; 1 for a file in the crash model's unit.
    pub length_factor: f64,
    /// The units of the file as the user set them; `None` leaves them to the file and its sizes.
    pub units: Option<Units>,
    /// Further folders for included files.
    pub read: ReadOptions,
}

impl Default for LoadSettings {
    fn default() -> Self {
        Self {
            selection: Selection::All,
            alike_parts: Vec::new(),
            length_factor: 1.0,
            units: None,
            read: ReadOptions::default(),
        }
    }
}

impl LoadSettings {
    /// Takes the parts that the user chose.
    pub fn choose(&mut self, selection: Selection) {
        self.selection = selection;
        self.alike_parts.clear();
    }
}

/// The parts that are taken where none are named: those that may be the formed sheet of a stamped file, all
/// of a crash model.
pub fn usual_selection(role: Role) -> Selection {
    match role {
        Role::Crash => Selection::All,
        Role::Stamped => Selection::Sheet,
    }
}

/// Forming changes the mean thickness by less: of one sheet the stamped part is so many times as thick as the crash
/// part.
pub(super) const SAME_GAUGE: RangeInclusive<f64> = 0.75..=1.25;

/// Says that the stamped part is thicker or thinner than forming explains; `None` where it is not, or where a thickness
/// is not known.
pub fn gauge_line(parts: PerRole<&LoadedPart>) -> Option<String> {
    let PerRole { crash, stamped } = parts.map(LoadedPart::mean_thickness);
    let ratio = stamped? / crash?;
    (ratio.is_finite() && ratio > 0.0 && !SAME_GAUGE.contains(&ratio)).then(|| {
        format!(
            "{} is {} times as thick as the crash part in the mean; another gauge or another unit?",
            parts.stamped.file_name(),
            length(ratio)
        )
    })
}

/// Says that a part of one file was loaded as both, as a test may do; `None` if none was.
pub fn same_parts_line(parts: PerRole<&LoadedPart>) -> Option<String> {
    let PerRole { crash, stamped } = parts;
    let is_one_file = crash.hash().is_some() && crash.hash() == stamped.hash();
    let is_same = || {
        let of_crash = crash.chosen_part_ids();
        let mut of_stamped = stamped.chosen_part_ids().into_iter();
        of_stamped.any(|id| of_crash.contains(&id))
    };
    (is_one_file && is_same()).then(|| {
        format!(
            "{} is the crash part and the stamped part: both files have the same content",
            stamped.file_name()
        )
    })
}

/// What loading did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LoadReport {
    /// Nodes in the file and its includes.
    pub n_nodes: usize,
    /// Shells in the file and its includes.
    pub n_shells: usize,
    /// Parts in the file and its includes.
    pub n_parts: usize,
    /// Triangles of the chosen part.
    pub n_triangles: usize,
    /// Triangles that were turned to agree with their neighbours.
    pub n_turned: usize,
    /// Warnings and errors of the reader; notes are not counted.
    pub n_diagnostics: u64,
    /// Time to read, in milliseconds; 0 if the model was at hand.
    pub read_ms: f64,
    /// Time to choose, join, orient and build tree and normals, in milliseconds.
    pub prepare_ms: f64,
}

/// A part as it was read, and the mesh made of it.
#[derive(Debug, Clone)]
pub struct LoadedPart {
    /// The file it came from.
    pub path: PathBuf,
    /// Everything the file holds, in the file's own unit.
    pub model: Arc<Model>,
    /// The settings it was loaded with.
    pub settings: LoadSettings,
    /// The chosen elements as triangles in the crash model's unit, joined at equal positions and
    /// turned to agree with their neighbours. This is what is reduced and matched.
    pub mesh: Arc<TriMesh>,
    /// `mesh` with its edges, tree, normals and measures.
    pub surface: Arc<Surface>,
    /// The way from `mesh` back to the deck.
    pub ids: Arc<IdMap>,
    /// Elements that were left out of the mesh because they have no area.
    pub surface_diagnostics: Arc<Diagnostics>,
    /// The units the file states, or those its sizes speak for.
    pub guessed_units: Option<KnownUnits>,
    /// What loading did.
    pub report: LoadReport,
    mean_thickness: Option<f64>,
    has_shells: bool,
}

/// Where a part comes from.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PartSource {
    /// A file on disk.
    File(PathBuf),
    /// The example pair, generated.
    Example,
    /// The realistic example pair, generated.
    RealisticExample,
}

impl PartSource {
    /// Reads the part.
    pub fn load(
        &self,
        role: Role,
        settings: &LoadSettings,
        monitor: &Monitor,
    ) -> Result<LoadedPart, PipelineError> {
        match self {
            Self::File(path) => load(path, settings, monitor),
            Self::Example => load_bundled(samples::bundled(), role, settings, monitor),
            Self::RealisticExample => load_bundled(samples::realistic(), role, settings, monitor),
        }
    }
}

impl LoadedPart {
    /// The file and all its includes.
    pub fn files(&self) -> Vec<PathBuf> {
        let included = self.model.files.iter().map(|file| file.path.to_path_buf());
        std::iter::once(self.path.clone()).chain(included).collect()
    }

    /// The content of the file by name; `None` for a model that was not read from a file.
    pub fn hash(&self) -> Option<FileHash> {
        self.model.files.first()?.hash
    }

    /// The units of the file: as the user set them, else as they were guessed.
    pub fn units(&self) -> Option<KnownUnits> {
        let by_user = self.settings.units.map(|units| KnownUnits {
            units,
            origin: UnitOrigin::User,
        });
        by_user.or(self.guessed_units)
    }

    /// The same part with its units set or left to guessing; lengths stay as they are. Cheap.
    pub fn with_units(&self, units: Option<Units>) -> Self {
        let mut part = self.clone();
        part.settings.units = units;
        part
    }

    /// The same where no other of its parts is known to fit the stamped part as well.
    #[must_use]
    pub fn without_alike_parts(&self) -> Self {
        let mut part = self.clone();
        part.settings.alike_parts.clear();
        part
    }

    /// True if the other part is this one: the units may have been named since.
    pub fn is_same_surface(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.surface, &other.surface)
    }

    /// File, parts and unit as the command line has to be told.
    pub fn command_side(&self) -> CommandSide<'_> {
        let selection = &self.settings.selection;
        let is_only_one = *selection == Selection::All && self.chosen_part_ids().len() < 2;
        CommandSide {
            path: &self.path,
            selection: Some(selection).filter(|_| !is_only_one),
            length_factor: self.settings.length_factor,
            units: self.settings.units,
        }
    }

    /// The file name without its folder.
    pub fn file_name(&self) -> String {
        file_name(&self.path)
    }

    /// What the reader found in the file, and what was left out of the mesh.
    pub fn diagnostics(&self) -> [&Diagnostics; 2] {
        [&self.model.diagnostics, &*self.surface_diagnostics]
    }

    /// What the reader could not understand or had to leave out, errors before warnings, of these what concerns whole
    /// parts first; notes are not among them. Of each kind only the first are kept.
    pub fn problems(&self) -> Vec<&Diagnostic> {
        let kept = self.diagnostics().into_iter().flat_map(Diagnostics::iter);
        let mut problems: Vec<_> = kept.filter(|one| one.severity() > Severity::Note).collect();
        let is_of_parts = |one: &Diagnostic| one.kind == DiagnosticKind::StackedParts;
        problems.sort_by_key(|one| std::cmp::Reverse((one.severity(), is_of_parts(one))));
        problems
    }

    /// Ids of the parts that have triangles in the mesh, in the order of the file.
    pub fn chosen_part_ids(&self) -> Vec<u64> {
        let mut used = vec![false; self.model.parts.len()];
        for &part in self.ids.parts() {
            used[part as usize] = true;
        }
        let parts = self.model.parts.iter().zip(used);
        parts
            .filter(|(_, used)| *used)
            .map(|(part, _)| part.id)
            .collect()
    }

    /// Ids of the parts that are left out as tools of the forming simulation.
    pub fn tools_left_out(&self) -> Vec<u64> {
        if self.settings.selection == Selection::Sheet {
            self.model.tools()
        } else {
            Vec::new()
        }
    }

    /// Says which parts are left out as tools; `None` if none are.
    pub fn tools_line(&self) -> Option<String> {
        tools_line(&self.file_name(), &self.tools_left_out())
    }

    /// The first node of the matched surface: its id, and its place in the crash model's unit.
    pub fn sample_node(&self) -> Option<(u64, Point3)> {
        let first = self.ids.nodes().first()?;
        let id = *self.model.nodes.ids().get(first.node as usize)?;
        Some((id, *self.mesh.positions().get(first.vertex as usize)?))
    }

    /// Id of the element that a triangle of the mesh belongs to.
    pub fn element_id(&self, triangle: u32) -> Option<u64> {
        let element = self.ids.element_of(triangle)? as usize;
        let n_shells = self.model.shells.len();
        match self.model.shells.get(element) {
            Some(shell) => Some(shell.id),
            None => self
                .model
                .solids
                .get(element - n_shells)
                .map(|solid| solid.id),
        }
    }

    /// Id of the first node that became a vertex of the mesh.
    pub fn node_id(&self, vertex: u32) -> Option<u64> {
        let node = self.ids.node_of(vertex)?;
        self.model.nodes.ids().get(node as usize).copied()
    }

    /// Whether shells are among the chosen elements: solids and thick shells neither give nor take forming results.
    pub fn has_shells(&self) -> bool {
        self.has_shells
    }

    /// Area-weighted mean thickness of the chosen elements in the crash model's unit, if known.
    pub fn mean_thickness(&self) -> Option<f64> {
        self.lengthened(self.mean_thickness)
    }

    /// A length of the file in the unit that its mesh is in.
    pub fn lengthened(&self, length: Option<f64>) -> Option<f64> {
        length.map(|length| length * self.settings.length_factor)
    }
}

/// Reads a file from disk and prepares the chosen part.
pub fn load(
    path: &Path,
    settings: &LoadSettings,
    monitor: &Monitor,
) -> Result<LoadedPart, PipelineError> {
    load_from(&Disk, path, settings, monitor)
}

/// [`load`] from any source of files, for example the bundled pair.
pub fn load_from(
    source: &dyn FileSource,
    path: &Path,
    settings: &LoadSettings,
    monitor: &Monitor,
) -> Result<LoadedPart, PipelineError> {
    let start = Instant::now();
    let checked = CheckedSource::new(source);
    let (model, hash) = rayon::join(
        || formats::read_from(&checked, path, &settings.read, monitor),
        || FileHash::of_file(source, path, monitor),
    );
    let mut model = model?;
    let hashed = model.files.par_iter_mut().try_for_each(|file| {
        let hash = match &hash {
            Ok(hash) if file.path == path => Ok(*hash),
            _ => FileHash::of_file(source, &file.path, monitor),
        };
        // Behind the hash, so that it is that of what was read.
        let hash = hash.and_then(|hash| checked.check(&file.path).map(|()| hash));
        file.hash = Some(hash.map_err(|error| FormatError::open(&file.path, &error))?);
        Ok::<(), FormatError>(())
    });
    hashed?;
    let read_ms = millis_since(start);
    monitor.shape(|| shape(&model, settings.length_factor));
    let mut part = prepare(path, Arc::new(model), settings, monitor)?;
    part.report.read_ms = read_ms;
    Ok(part)
}

/// Corners of elements spread over a model, in the crash model's unit.
fn shape(model: &Model, factor: f64) -> Vec<[f64; 3]> {
    let n = model.shells.len() + model.solids.len();
    let shells = model.shells.iter().map(|shell| shell.nodes[0]);
    let solids = model.solids.iter().map(|solid| solid.nodes[0]);
    let nodes = shells.chain(solids).step_by(n.div_ceil(N_SHAPE).max(1));
    let positions = model.nodes.positions();
    let place = |node: u32| positions.get(node as usize).map(|p| (p * factor).into());
    nodes.filter_map(place).collect()
}

/// One part of a pair that comes with the program: the file whose name begins with its role.
fn load_bundled(
    files: Vec<SampleFile>,
    role: Role,
    settings: &LoadSettings,
    monitor: &Monitor,
) -> Result<LoadedPart, PipelineError> {
    let file = files
        .into_iter()
        .find(|file| file.name.starts_with(role.word()));
    let file = file.ok_or(PipelineError::NoExample)?;
    let path = Path::new(file.name);
    let memory = Memory::new().with(path, file.bytes);
    load_from(&memory, path, settings, monitor)
}

/// Prepares the chosen part of a model that was read before, for example after another choice of
/// parts.
pub fn prepare(
    path: &Path,
    model: Arc<Model>,
    settings: &LoadSettings,
    monitor: &Monitor,
) -> Result<LoadedPart, PipelineError> {
    let start = Instant::now();
    let factor = settings.length_factor;
    if !UNIT_FACTORS.contains(&factor) {
        return Err(PipelineError::BadUnitFactor(factor));
    }
    monitor.check()?;
    monitor.progress("prepare", 0, None);
    let chosen = model
        .build_surface(&settings.selection, monitor)
        .map_err(|error| PipelineError::Selection {
            near: near_parts(&model, &error),
            error,
            path: path.to_path_buf(),
            diagnostic: model.diagnostics.most_severe().cloned().map(Box::new),
        })?;
    let mean_thickness = mean_thickness(&model, &chosen, monitor)?;
    let guessed_units = model
        .stated_units
        .or_else(|| units::of_sizes(chosen.mesh.aabb().diagonal(), mean_thickness));
    let scaled = scaled(chosen.mesh, factor, monitor)?;
    let scaled = scaled.map_err(|error| PipelineError::Selection {
        near: String::new(),
        error: error.into(),
        path: path.to_path_buf(),
        diagnostic: None,
    })?;
    let clean = CleanMesh::of(scaled, monitor)?;
    let origins = Origins {
        node: chosen.vertex_node,
        element: chosen.triangle_element,
        part: chosen.triangle_part,
    };
    let ids = IdMap::new(&origins, &clean.vertex_of, &clean.triangle_of, monitor)?;
    drop(origins);
    let is_shell = |&element: &u32| (element as usize) < model.shells.len();
    let has_shells = ids.elements().iter().any(is_shell);
    let n_turned = clean.n_turned;
    let surface = Surface::prepare(clean, "chosen", monitor)?;
    let mesh = surface.mesh().clone();
    let mut surface_diagnostics = chosen.diagnostics;
    if settings.selection == Selection::Sheet {
        let thickness = mean_thickness.map(|thickness| thickness * factor);
        let told = stacked_parts((&model, &mesh), ids.parts(), thickness, monitor)?;
        told.into_iter()
            .for_each(|told| surface_diagnostics.push(told));
    }
    let report = LoadReport {
        n_nodes: model.nodes.len(),
        n_shells: model.shells.len(),
        n_parts: model.parts.len(),
        n_triangles: mesh.n_triangles(),
        n_turned,
        n_diagnostics: diagnostics(&model.diagnostics) + diagnostics(&surface_diagnostics),
        read_ms: 0.0,
        prepare_ms: millis_since(start),
    };
    Ok(LoadedPart {
        path: path.to_path_buf(),
        model,
        settings: settings.clone(),
        mesh,
        surface: Arc::new(surface),
        ids: Arc::new(ids),
        surface_diagnostics: Arc::new(surface_diagnostics),
        guessed_units,
        report,
        mean_thickness,
        has_shells,
    })
}

/// Area-weighted mean thickness of the chosen elements in the file's own unit, if known.
fn mean_thickness(
    model: &Model,
    chosen: &formats::ChosenMesh,
    monitor: &Monitor,
) -> Result<Option<f64>, Cancelled> {
    // As a difference from the first, so that equal thicknesses have themselves as mean.
    let (mut first, mut sum, mut area_sum) = (None, 0.0, 0.0);
    for_chunks(chosen.triangle_element.len(), monitor, |range| {
        for triangle in range {
            let element = chosen.triangle_element[triangle];
            if (element as usize) < model.shells.len()
                && let Some(corners) = model.shell_thickness(element)
            {
                let area = chosen.mesh.triangle_area(triangle);
                let first = *first.get_or_insert(corners[0]);
                let excess: f64 = corners.iter().map(|corner| corner - first).sum();
                sum += area * excess / 4.0;
                area_sum += area;
            }
        }
    })?;
    let excess = if area_sum > 0.0 { sum / area_sum } else { 0.0 };
    let mean = first.map(|first: f64| first + excess);
    Ok(mean.filter(|mean| *mean > 0.0))
}

/// How many diagnostics are more than notes.
fn diagnostics(diagnostics: &Diagnostics) -> u64 {
    let graver = diagnostics
        .counts()
        .filter(|(kind, _)| kind.severity() > Severity::Note);
    graver.map(|(_, count)| count).sum()
}

/// The mesh in another unit; an error if a product overflows.
fn scaled(
    mesh: TriMesh,
    factor: f64,
    monitor: &Monitor,
) -> Result<Result<TriMesh, MeshError>, Cancelled> {
    if factor == 1.0 {
        return Ok(Ok(mesh));
    }
    let (mut positions, triangles) = mesh.into_parts();
    for_chunks(positions.len(), monitor, |range| {
        for position in &mut positions[range] {
            *position *= factor;
        }
    })?;
    Ok(TriMesh::new(positions, triangles))
}

/// The parts that may have been meant, by id or by title: "; the nearest parts are 2001 \"floor\"".
/// Empty where neither was asked for.
fn near_parts(model: &Model, error: &SelectionError) -> String {
    let mut parts: Vec<(u64, &str)> = model
        .parts
        .iter()
        .map(|part| (part.id, part.title.as_str()))
        .collect();
    match error {
        SelectionError::NoSuchPart(id) => parts.sort_by_key(|(other, _)| id.abs_diff(*other)),
        SelectionError::NoSuchTitle(title) => {
            let title = title.to_lowercase();
            let likeness = |other: &str| strsim::jaro_winkler(&title, &other.to_lowercase());
            parts.sort_by(|(_, a), (_, b)| likeness(b).total_cmp(&likeness(a)));
        }
        _ => return String::new(),
    }
    let near: Vec<String> = parts
        .iter()
        .take(N_NEAR_PARTS)
        .map(|(id, title)| format!("{id} {title:?}"))
        .collect();
    match near.len() {
        0 => "; the file has no parts".to_owned(),
        1 => format!("; its only part is {}", near[0]),
        _ => format!("; the nearest parts are {}", near.join(", ")),
    }
}

/// Understands a choice of parts as typed: `all`, `sheet`, `2001`, `2001,2002`, a title, `title:2001`, `set:7`,
/// `shell-set:7`, `node-set:7`. Anything that is none of these forms is a title.
pub fn parse_selection(text: &str) -> Selection {
    let text = text.trim();
    match text {
        "all" => return Selection::All,
        "sheet" => return Selection::Sheet,
        _ => {}
    }
    if let Some(title) = text.strip_prefix("title:") {
        return Selection::PartTitle(title.to_owned());
    }
    let after = |prefix: &str| {
        text.strip_prefix(prefix)
            .and_then(|id| id.trim().parse().ok())
    };
    if let Some(id) = after("set:").or_else(|| after("part-set:")) {
        return Selection::PartSet(id);
    }
    if let Some(id) = after("shell-set:") {
        return Selection::ShellSet(id);
    }
    if let Some(id) = after("node-set:") {
        return Selection::NodeSet(id);
    }
    let ids: Result<Vec<u64>, _> = text.split(',').map(|id| id.trim().parse()).collect();
    match ids {
        Ok(ids) => Selection::Parts(ids),
        Err(_) => Selection::PartTitle(text.to_owned()),
    }
}

#[cfg(test)]
mod tests;
