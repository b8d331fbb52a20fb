//! From a file to a mesh that can be shown, reduced and matched.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use rayon::prelude::*;

use super::{PipelineError, millis_since};
use crate::formats::{
    self, Diagnostics, Disk, FileHash, FileSource, Memory, Model, ReadOptions, Selection, Severity,
    Surface,
};
use crate::geometry::{Point3, TriMesh, orient_consistently, weld};
use crate::monitor::Monitor;
use crate::registration::{self, RegistrationError};
use crate::report::command_line::CommandSide;
use crate::samples;
use crate::units::{self, KnownUnits, UnitOrigin, Units};

/// Choices for loading one side.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSettings {
    /// Which elements make the part.
    pub selection: Selection,
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
            length_factor: 1.0,
            units: None,
            read: ReadOptions::default(),
        }
    }
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
    /// Nodes that were joined because they lie at the same place.
    pub n_joined: usize,
    /// Triangles that were turned to agree with their neighbours.
    pub n_turned: usize,
    /// Warnings and errors of the reader; notes are not counted.
    pub n_findings: u64,
    /// Time to read, in milliseconds; 0 if the model was at hand.
    pub read_ms: f64,
    /// Time to choose, join and orient, in milliseconds.
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
    /// The chosen elements as triangles, in the file's own unit, with the way back to the elements.
    pub surface: Arc<Surface>,
    /// The surface in the crash model's unit, joined at equal positions, its triangles turned to
    /// agree with their neighbours. This is what is reduced and matched.
    pub mesh: Arc<TriMesh>,
    /// For each triangle of `mesh`, the triangle of `surface` it came from.
    pub triangle_of: Arc<Vec<u32>>,
    /// For each vertex of `surface`, the vertex of `mesh` it became.
    pub vertex_of: Arc<Vec<u32>>,
    /// The units the file states, or those its sizes speak for.
    pub guessed_units: Option<KnownUnits>,
    /// What loading did.
    pub report: LoadReport,
    /// The mesh prepared for matching, made when first asked for and shared by all clones.
    for_match: ForMatch,
}

/// A registration surface that is made when first asked for.
#[derive(Clone, Default)]
struct ForMatch(Arc<OnceLock<Result<Arc<registration::Surface>, RegistrationError>>>);

impl std::fmt::Debug for ForMatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.get().is_some() {
            "made"
        } else {
            "not made"
        })
    }
}

impl LoadedPart {
    /// The mesh with its tree and normals, as matching needs it. Made once; later calls are free.
    pub fn surface_for_match(&self) -> Result<Arc<registration::Surface>, RegistrationError> {
        let make = || registration::Surface::new(&self.mesh, "chosen").map(Arc::new);
        self.for_match.0.get_or_init(make).clone()
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

    /// File, parts and unit as the command line has to be told.
    pub fn command_side(&self) -> CommandSide<'_> {
        CommandSide {
            path: &self.path,
            selection: &self.settings.selection,
            length_factor: self.settings.length_factor,
            units: self.settings.units,
        }
    }

    /// The file name without its folder.
    pub fn file_name(&self) -> String {
        self.path
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    /// Ids of the parts that have triangles in the mesh, in the order of the file.
    pub fn chosen_part_ids(&self) -> Vec<u64> {
        let mut used = vec![false; self.model.parts.len()];
        for &part in &self.surface.triangle_part {
            used[part as usize] = true;
        }
        let parts = self.model.parts.iter().zip(used);
        parts
            .filter(|(_, used)| *used)
            .map(|(part, _)| part.id)
            .collect()
    }

    /// The first node of the matched surface: its id, and its place in the crash model's unit.
    pub fn sample_node(&self) -> Option<(u64, Point3)> {
        let node = *self.surface.vertex_node.first()? as usize;
        let position = self.surface.mesh.positions().first()?;
        let id = *self.model.nodes.ids().get(node)?;
        Some((id, position * self.settings.length_factor))
    }

    /// Id of the element that a triangle of the mesh belongs to.
    pub fn element_id(&self, triangle: u32) -> Option<u64> {
        let of_surface = *self.triangle_of.get(triangle as usize)?;
        let element = *self.surface.triangle_element.get(of_surface as usize)? as usize;
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

    /// Number in the deck of the first node that became a vertex of `mesh`. O(nodes).
    pub fn node_of(&self, vertex: u32) -> Option<u64> {
        let of_surface = self.vertex_of.iter().position(|&v| v == vertex)?;
        let node = *self.surface.vertex_node.get(of_surface)?;
        self.model.nodes.ids().get(node as usize).copied()
    }

    /// Area-weighted mean thickness of the chosen elements in the crash model's unit, if known.
    pub fn mean_thickness(&self) -> Option<f64> {
        let (mut sum, mut area_sum) = (0.0, 0.0);
        for (triangle, &element) in self.surface.triangle_element.iter().enumerate() {
            if (element as usize) < self.model.shells.len()
                && let Some(corners) = self.model.shell_thickness(element)
            {
                let area = self.surface.mesh.triangle_area(triangle);
                sum += area * corners.iter().sum::<f64>() / 4.0;
                area_sum += area;
            }
        }
        (sum > 0.0).then(|| sum / area_sum * self.settings.length_factor)
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
    let (model, hash) = rayon::join(
        || formats::read_from(source, path, &settings.read, monitor),
        || FileHash::of_file(source, path, monitor),
    );
    let mut model = model?;
    model.files.par_iter_mut().for_each(|file| {
        let of_include = || FileHash::of_file(source, &file.path, monitor);
        file.hash = if file.path == path {
            hash.as_ref().ok().copied()
        } else {
            of_include().ok()
        };
    });
    let read_ms = millis_since(start);
    let mut part = prepare(path, Arc::new(model), settings, monitor)?;
    part.report.read_ms = read_ms;
    Ok(part)
}

/// One side of the pair that comes with the program: the file whose name begins so.
pub fn load_bundled(
    begins: &str,
    settings: &LoadSettings,
    monitor: &Monitor,
) -> Result<LoadedPart, PipelineError> {
    let files = samples::bundled();
    let file = files.into_iter().find(|file| file.name.starts_with(begins));
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
    if !(factor.is_finite() && factor > 0.0) {
        return Err(PipelineError::BadUnitFactor(factor));
    }
    monitor.check()?;
    monitor.progress("prepare", 0, None);
    let surface = model
        .surface(&settings.selection)
        .map_err(|error| PipelineError::Selection {
            error,
            path: path.to_path_buf(),
            finding: model.diagnostics.gravest().cloned().map(Box::new),
        })?;
    monitor.check()?;
    let welded = weld(&scaled(&surface.mesh, factor), 0.0);
    monitor.check()?;
    let (mesh, n_turned) = orient_consistently(&welded.mesh);
    let report = LoadReport {
        n_nodes: model.nodes.len(),
        n_shells: model.shells.len(),
        n_parts: model.parts.len(),
        n_triangles: mesh.n_triangles(),
        n_joined: surface.mesh.n_vertices() - mesh.n_vertices(),
        n_turned,
        n_findings: findings(&model.diagnostics) + findings(&surface.diagnostics),
        read_ms: 0.0,
        prepare_ms: millis_since(start),
    };
    let mut part = LoadedPart {
        path: path.to_path_buf(),
        model,
        settings: settings.clone(),
        surface: Arc::new(surface),
        mesh: Arc::new(mesh),
        triangle_of: Arc::new(welded.triangle_of),
        vertex_of: Arc::new(welded.vertex_of),
        guessed_units: None,
        report,
        for_match: ForMatch::default(),
    };
    part.guessed_units = guess_units(&part);
    Ok(part)
}

/// What the deck states, else what size and thickness in the file's own unit speak for.
fn guess_units(part: &LoadedPart) -> Option<KnownUnits> {
    let thickness = || {
        part.mean_thickness()
            .map(|t| t / part.settings.length_factor)
    };
    let diagonal = part.surface.mesh.aabb().diagonal();
    let stated = part.model.stated_units;
    stated.or_else(|| units::of_sizes(diagonal, thickness()))
}

/// How many findings are more than notes.
fn findings(diagnostics: &Diagnostics) -> u64 {
    let graver = diagnostics
        .counts()
        .filter(|(kind, _)| kind.severity() > Severity::Note);
    graver.map(|(_, count)| count).sum()
}

fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
    if factor == 1.0 {
        return mesh.clone();
    }
    let positions: Vec<Point3> = mesh.positions().iter().map(|p| p * factor).collect();
    // A product that overflows leaves the mesh as it was, which the sizes then show.
    TriMesh::new(positions, mesh.triangles().to_vec()).unwrap_or_else(|_| mesh.clone())
}

/// Understands a choice of parts as typed: `2001`, `2001,2002`, a title, `title:2001`, `set:7`,
/// `shell-set:7`, `node-set:7`. Anything that is none of these forms is a title.
pub fn parse_selection(text: &str) -> Selection {
    let text = text.trim();
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
mod tests {
    use super::*;

    #[test]
    fn choices_are_understood_as_typed() {
        assert_eq!(parse_selection(" 12 "), Selection::Parts(vec![12]));
        assert_eq!(parse_selection("1, 2,3"), Selection::Parts(vec![1, 2, 3]));
        assert_eq!(parse_selection("set:7"), Selection::PartSet(7));
        assert_eq!(parse_selection("shell-set: 8"), Selection::ShellSet(8));
        assert_eq!(parse_selection("node-set:9"), Selection::NodeSet(9));
        assert_eq!(
            parse_selection("B pillar, inner"),
            Selection::PartTitle("B pillar, inner".into())
        );
        assert_eq!(
            parse_selection("title:12"),
            Selection::PartTitle("12".into())
        );
    }

    #[test]
    fn choices_are_typed_as_they_are_understood() {
        let choices = [
            Selection::Parts(vec![1, 22]),
            Selection::PartTitle("set:7".into()),
            Selection::PartSet(7),
            Selection::ShellSet(8),
            Selection::NodeSet(9),
        ];
        for choice in choices {
            assert_eq!(parse_selection(&choice.typed().unwrap()), choice);
        }
        assert_eq!(Selection::All.typed(), None);
    }

    #[test]
    fn the_file_and_its_includes_are_hashed() {
        let bytes: [&[u8]; 2] = [
            b"*KEYWORD\n*INCLUDE\nmesh.k\n*PART\nsheet\n1,1,1\n*END\n",
            b"*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n*ELEMENT_SHELL\n1,1,1,2,3,3\n*END\n",
        ];
        let source = formats::Memory::new()
            .with("deck.k", bytes[0])
            .with("mesh.k", bytes[1]);
        let (path, settings) = (Path::new("deck.k"), LoadSettings::default());
        let part = load_from(&source, path, &settings, &Monitor::silent()).unwrap();
        let hashes: Vec<_> = part.model.files.iter().map(|file| file.hash).collect();
        assert_eq!(hashes, bytes.map(|bytes| Some(FileHash::of(bytes))));
        assert_eq!(part.hash(), Some(FileHash::of(bytes[0])));
    }
}
