//! A project: everything about a piece of work but the geometry, as a text file.
//!
//! A project names its files by relative paths and by their content, and holds what was chosen and
//! found: parts, units, levels, pose, every setting of the match, its result. Numbers come back to
//! the last bit. How the window looked is kept for the window, which alone understands it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::error::ProjectError;
use super::text;
use crate::assess::{Coverage, Reason, Verdict};
use crate::formats::{Disk, FileHash, FileSource as _, ReadOptions, Selection};
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::{LoadSettings, LoadedPart};
use crate::pipeline::map::{FurtherPose, MapRecipe};
use crate::pipeline::match_parts::{MatchRecipe, MatchRun};
use crate::pipeline::sweep::Sweep;
use crate::pipeline::write_file::{write_file, write_file_in_new_folder};
use crate::report::build_id;
use crate::role::{PerRole, Role};
use crate::text::grouped;
use crate::units::Units;

/// The file extension of projects.
pub const EXTENSION: &str = "shapematch";
/// What the field `schema` begins with.
const SCHEMA: &str = "shapematch.project/";
/// The version of the format that this program writes, and the newest it reads.
pub(super) const VERSION: u32 = 1;

/// A larger file is no project.
const MAX_BYTES: u64 = 1 << 28;

/// One side of a project.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PartEntry {
    /// The file; `None` for the example that comes with the program. Absolute in memory, relative
    /// to the project in the file.
    pub file: Option<PathBuf>,
    /// Its content when the project was saved.
    pub hash: Option<FileHash>,
    /// Triangles of the full mesh, for the reader of the file.
    pub triangles: usize,
    /// Which elements are matched.
    pub selection: Selection,
    /// Ids of other parts that fit the stamped part about as well, where the program chose among them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub alike_parts: Vec<u64>,
    /// True if the user said that all parts of a crash model are meant, so that none is looked for.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub are_all_meant: bool,
    /// Factor on its coordinates.
    pub length_factor: f64,
    /// Its units, if the user set them.
    pub units: Option<Units>,
    /// Further folders for included files.
    pub include_folders: Vec<PathBuf>,
    /// Limit on what is read, in GiB.
    pub read_limit: f64,
    /// Which example it is a side of, where it has no file.
    pub is_realistic_example: bool,
    /// The ceiling it was reduced to; `None` for the full mesh.
    pub max_triangles: Option<usize>,
    /// A stamped file that is not drawn, where several are.
    pub is_hidden: bool,
    /// Ids of hidden parts of the deck.
    pub hidden: BTreeSet<u64>,
    /// Colours that were given to parts of the deck, sRGB.
    pub colors: BTreeMap<u64, [u8; 3]>,
}

impl Default for PartEntry {
    fn default() -> Self {
        Self {
            file: None,
            hash: None,
            triangles: 0,
            selection: Selection::All,
            alike_parts: Vec::new(),
            are_all_meant: false,
            length_factor: 1.0,
            units: None,
            include_folders: Vec::new(),
            read_limit: ReadOptions::USUAL_LIMIT,
            is_realistic_example: false,
            max_triangles: None,
            is_hidden: false,
            hidden: BTreeSet::new(),
            colors: BTreeMap::new(),
        }
    }
}

impl PartEntry {
    /// The entry of a part that was read from `file`, or is a side of the example.
    pub fn of(part: &LoadedPart, file: Option<PathBuf>) -> Self {
        let settings = &part.settings;
        Self {
            file,
            hash: part.hash(),
            triangles: part.mesh.n_triangles(),
            selection: settings.selection.clone(),
            alike_parts: settings.alike_parts.clone(),
            length_factor: settings.length_factor,
            units: settings.units,
            include_folders: settings.read.include_folders.clone(),
            read_limit: settings.read.limit(),
            ..Self::default()
        }
    }

    /// How to load it again.
    pub fn load_settings(&self) -> LoadSettings {
        LoadSettings {
            selection: self.selection.clone(),
            alike_parts: self.alike_parts.clone(),
            length_factor: self.length_factor,
            units: self.units,
            read: ReadOptions {
                include_folders: self.include_folders.clone(),
                ..ReadOptions::default().with_limit(self.read_limit)
            },
        }
    }

    /// Where the file is: at its path, else beside the project under its name. `None` if it is at
    /// neither place or the entry is the example.
    pub fn locate(&self, project: &Path) -> Option<PathBuf> {
        let file = self.file.as_ref()?;
        let beside = file.file_name().map(|name| folder_of(project).join(name));
        Disk.find(file).or_else(|| Disk.find(&beside?))
    }

    /// True if a loaded file is not the one the project was saved with.
    pub fn has_changed(&self, part: &LoadedPart) -> bool {
        self.hash.is_some() && self.hash != part.hash()
    }
}

/// A further stamped file that is mapped from.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct FurtherEntry {
    /// Its file and what is taken from it.
    pub part: PartEntry,
    /// Where its pose comes from.
    pub pose: FurtherPose,
    /// Its last match.
    pub placing: Option<PlacingEntry>,
}

/// The match of a further stamped file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlacingEntry {
    /// True if the crash part was not changed after the match.
    pub is_current: bool,
    /// `crash = c · R · stamped + t`.
    pub crash_from_stamped: Similarity,
    /// Whether the pose can be used.
    pub verdict: Verdict,
    /// Distances and overlap; older projects have a line of text instead.
    #[serde(default)]
    pub coverage: Option<Coverage>,
    /// The first reason for the verdict.
    #[serde(default)]
    pub reason: Option<Reason>,
}

/// A file of a project.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectFile {
    /// One of the two parts.
    Part(Role),
    /// A further stamped file, by its place in the list.
    Further(usize),
}

impl ProjectFile {
    /// The part it is read as.
    pub fn role(self) -> Role {
        match self {
            Self::Part(role) => role,
            Self::Further(_) => Role::Stamped,
        }
    }

    /// "the crash part", "stamped file 2".
    pub fn words(self) -> String {
        match self {
            Self::Part(role) => format!("the {} part", role.word()),
            Self::Further(n) => format!("stamped file {}", n + 2),
        }
    }
}

/// A match and whether it still stood for parts and pose when the project was saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ResultEntry {
    /// True if nothing was changed after the match.
    pub is_current: bool,
    /// The parts that were exchanged after the match, or of which other pieces were chosen.
    #[serde(default)]
    pub exchanged: PerRole<bool>,
    /// The alternative that was shown instead of the best pose.
    #[serde(default)]
    pub alternative: Option<usize>,
    /// Result of the match.
    pub run: MatchRun,
}

/// A project in memory.
#[derive(Debug, Clone, Default)]
pub struct Project {
    /// The program that wrote it.
    pub program: String,
    /// When, in seconds since 1970 (UTC); 0 if unknown.
    pub saved_at: u64,
    /// The two parts.
    pub parts: PerRole<Option<PartEntry>>,
    /// `crash = c · R · stamped + t`.
    pub pose: Similarity,
    /// Every setting of the match.
    pub recipe: MatchRecipe,
    /// What they are for other parts, if a remedy has changed some for these.
    pub recipe_before_remedy: Option<Box<MatchRecipe>>,
    /// Every choice of the mapping.
    pub mapping: MapRecipe,
    /// Further stamped files that are mapped from, in the order of the list.
    pub further_stamped: Vec<FurtherEntry>,
    /// The other mapper's file that mappings are compared with.
    pub mapping_compared_with: Option<PathBuf>,
    /// Ids of the crash elements that the report of a mapping tells of one by one.
    pub mapping_pins: Vec<u64>,
    /// True if the forming results were mapped with parts and pose as they are: the window maps them again.
    pub is_mapped: bool,
    /// The last match.
    pub result: Option<ResultEntry>,
    /// The tables of the last sweep.
    pub sweep: Option<Sweep>,
    /// How the window looked; only the window understands it.
    pub window: Option<Value>,
    /// What a later program added at the top level; written again as it was.
    pub others: Map<String, Value>,
}

/// The fields in the order of the file, what a person looks for first.
#[derive(Serialize)]
struct Written<'a> {
    schema: String,
    program: String,
    saved_at: u64,
    crash: Option<PartEntry>,
    stamped: Option<PartEntry>,
    pose: &'a Similarity,
    recipe: &'a MatchRecipe,
    #[serde(skip_serializing_if = "Option::is_none")]
    recipe_before_remedy: &'a Option<Box<MatchRecipe>>,
    mapping: &'a MapRecipe,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    further_stamped: Vec<FurtherEntry>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mapping_compared_with: Option<PathBuf>,
    #[serde(skip_serializing_if = "<[u64]>::is_empty")]
    mapping_pins: &'a [u64],
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_mapped: bool,
    window: &'a Option<Value>,
    #[serde(flatten)]
    others: &'a Map<String, Value>,
    result: &'a Option<ResultEntry>,
    sweep: &'a Option<Sweep>,
}

impl Project {
    /// Every file that is read with it.
    pub fn files(&self) -> Vec<ProjectFile> {
        let parts = Role::ALL.map(ProjectFile::Part);
        let further = (0..self.further_stamped.len()).map(ProjectFile::Further);
        parts.into_iter().chain(further).collect()
    }

    /// What is stored of a file.
    pub fn entry(&self, file: ProjectFile) -> Option<&PartEntry> {
        match file {
            ProjectFile::Part(role) => self.parts.get(role).as_ref(),
            ProjectFile::Further(n) => Some(&self.further_stamped.get(n)?.part),
        }
    }

    /// Reads a project; the second value tells, a sentence each, what was not understood and left
    /// out.
    pub fn read(path: &Path) -> Result<(Self, Vec<String>), ProjectError> {
        let bytes = Disk.open(path, MAX_BYTES, &Monitor::silent());
        let bytes = bytes.map_err(|error| ProjectError::Read {
            path: path.to_path_buf(),
            reason: error.to_string(),
        })?;
        Self::parse(&String::from_utf8_lossy(&bytes), path)
    }

    /// Understands the text of a project that lies at `path`.
    pub fn parse(text: &str, path: &Path) -> Result<(Self, Vec<String>), ProjectError> {
        let at = || path.to_path_buf();
        let root: Value = serde_json::from_str(text)
            .map_err(|error| ProjectError::no_text(path, text, &error))?;
        let Value::Object(mut fields) = root else {
            return Err(ProjectError::NoProject(at()));
        };
        let program = string(fields.remove("program"));
        let schema = string(fields.remove("schema"));
        let Some(version) = schema.strip_prefix(SCHEMA) else {
            return Err(ProjectError::NoProject(at()));
        };
        // A version that is no number is not one of this program's.
        if version
            .parse::<u32>()
            .map_or(true, |version| version > VERSION)
        {
            let version = version.to_owned();
            return Err(ProjectError::Newer {
                path: at(),
                version,
                program,
            });
        }
        let mut reader = Reader {
            fields,
            notes: Vec::new(),
        };
        let refuse = |field| {
            move |reason| ProjectError::Field {
                path: path.to_path_buf(),
                field,
                reason,
            }
        };
        let mut project = Self {
            program,
            parts: PerRole {
                crash: reader.take("crash").map_err(refuse("crash"))?,
                stamped: reader.take("stamped").map_err(refuse("stamped"))?,
            },
            pose: reader
                .take("pose")
                .map_err(refuse("pose"))?
                .unwrap_or_default(),
            saved_at: reader.take_or_tell("saved_at").unwrap_or_default(),
            recipe: reader.take_or_tell("recipe").unwrap_or_default(),
            recipe_before_remedy: reader.take_or_tell("recipe_before_remedy"),
            mapping: reader.take_or_tell("mapping").unwrap_or_default(),
            further_stamped: reader.take_or_tell("further_stamped").unwrap_or_default(),
            mapping_compared_with: reader.take_or_tell("mapping_compared_with"),
            mapping_pins: reader.take_or_tell("mapping_pins").unwrap_or_default(),
            is_mapped: reader.take_or_tell("is_mapped").unwrap_or_default(),
            result: reader.take_or_tell("result"),
            sweep: reader.take_or_tell("sweep"),
            window: reader
                .fields
                .remove("window")
                .filter(|value| !value.is_null()),
            others: Map::new(),
        };
        project.others = reader.fields;
        let mut notes = reader.notes;
        for name in project.others.keys() {
            notes.push(format!(
                "the field {name:?} is not known; it is kept as it is"
            ));
        }
        for role in Role::ALL {
            if let Some(entry) = project.parts.get_mut(role) {
                entry.make_absolute(folder_of(path));
            }
        }
        for further in &mut project.further_stamped {
            further.part.make_absolute(folder_of(path));
        }
        if let Some(other) = &mut project.mapping_compared_with {
            *other = absolute(other, folder_of(path));
        }
        Ok((project, notes))
    }

    /// The text of a project that is to lie at `path`, with paths relative to its folder; an error where one of these
    /// is no Unicode text.
    pub fn to_text(&self, path: &Path) -> Result<String, PipelineError> {
        let PerRole { crash, stamped } = self.parts.as_ref().map(|entry| {
            let mut entry = entry.clone()?;
            entry.make_relative(folder_of(path));
            Some(entry)
        });
        let mut further_stamped = self.further_stamped.clone();
        for further in &mut further_stamped {
            further.part.make_relative(folder_of(path));
        }
        let text = text::pretty(&Written {
            schema: format!("{SCHEMA}{VERSION}"),
            program: build_id(),
            saved_at: self.saved_at,
            crash,
            stamped,
            pose: &self.pose,
            recipe: &self.recipe,
            recipe_before_remedy: &self.recipe_before_remedy,
            mapping: &self.mapping,
            further_stamped,
            mapping_compared_with: self
                .mapping_compared_with
                .as_deref()
                .map(|other| relative(other, folder_of(path))),
            mapping_pins: &self.mapping_pins,
            is_mapped: self.is_mapped,
            window: &self.window,
            others: &self.others,
            result: &self.result,
            sweep: &self.sweep,
        });
        text.map_err(|error| PipelineError::Write {
            path: path.to_path_buf(),
            reason: error.to_string(),
        })
    }

    /// Writes the project.
    pub fn write(&self, path: &Path) -> Result<(), PipelineError> {
        write_file(path, self.to_text(path)?.as_bytes())
    }

    /// [`Project::write`] into a folder that is made if need be.
    pub fn write_in_new_folder(&self, path: &Path) -> Result<(), PipelineError> {
        write_file_in_new_folder(path, self.to_text(path)?.as_bytes())
    }

    /// Where its stamped files lie, the first one first; `None` for one that has no pose.
    pub fn stamped_poses(&self) -> Vec<Option<Similarity>> {
        let further = self.further_stamped.iter();
        let further = further.map(|entry| match entry.pose {
            FurtherPose::AsFirst => Some(self.pose),
            FurtherPose::Matched => {
                let placing = entry.placing.as_ref().filter(|placing| placing.is_current);
                placing.map(|placing| placing.crash_from_stamped)
            }
        });
        std::iter::once(Some(self.pose)).chain(further).collect()
    }

    /// What the lengths of its stamped files are multiplied by, the first one first; its poses stand for that.
    pub fn stamped_length_factors(&self) -> Vec<f64> {
        let first = self.parts.stamped.as_ref();
        let first = first.map_or(1.0, |entry| entry.length_factor);
        let further = self.further_stamped.iter();
        let further = further.map(|entry| entry.part.length_factor);
        std::iter::once(first).chain(further).collect()
    }

    /// The files of the project and what was done with them, in one line.
    pub fn title(&self) -> String {
        let PerRole { crash, stamped } = self.parts.as_ref().map(Option::as_ref);
        let name = |entry: &PartEntry| match &entry.file {
            Some(file) => file
                .file_name()
                .map(|name| name.to_string_lossy().into_owned()),
            None if entry.is_realistic_example => Some("the realistic example".to_owned()),
            None => Some("the example".to_owned()),
        };
        let names: Vec<String> = [stamped, crash]
            .into_iter()
            .flatten()
            .filter_map(name)
            .collect();
        let mut title = match &names[..] {
            [a, b] if a == b => format!("{a} pair"),
            names => names.join(" on "),
        };
        if let Some(n) = crash.or(stamped).and_then(|entry| entry.max_triangles) {
            title += &format!(" · reduced to {}", grouped(n));
        }
        if let Some(result) = self.result.as_ref().filter(|result| result.is_current) {
            title += " · ";
            title += result.run.assessment.verdict.label();
        }
        title
    }
}

/// True if a path is that of a project.
pub fn is_project(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy());
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}

/// The path with the ending of projects, which a name with another ending gets too.
pub fn with_ending(mut path: PathBuf) -> PathBuf {
    if !is_project(&path) {
        let mut name = path.file_name().unwrap_or_default().to_os_string();
        name.push(".");
        name.push(EXTENSION);
        path.set_file_name(name);
    }
    path
}

impl PartEntry {
    fn paths(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        self.file.iter_mut().chain(&mut self.include_folders)
    }

    fn make_absolute(&mut self, folder: &Path) {
        for path in self.paths() {
            *path = absolute(path, folder);
        }
    }

    fn make_relative(&mut self, folder: &Path) {
        for path in self.paths() {
            *path = relative(path, folder);
        }
    }
}

/// The folder a project lies in, absolute where the system tells it.
fn folder_of(project: &Path) -> &Path {
    project.parent().unwrap_or(Path::new(""))
}

/// A path as the project has it, from the folder of the project.
fn absolute(path: &Path, folder: &Path) -> PathBuf {
    crate::formats::source::tidy(&folder.join(path))
}

/// The path of a file as seen from a folder, with `/` between its pieces; as it is where there is
/// no way from one to the other.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let seen = pathdiff::diff_paths(path, folder).filter(|seen| seen.is_relative());
    let Some(seen) = seen else {
        return path.to_path_buf();
    };
    let pieces: Option<Vec<&str>> = seen.iter().map(|piece| piece.to_str()).collect();
    match pieces {
        Some(pieces) => PathBuf::from(pieces.join("/")),
        // Writing it says that it is no text.
        None => seen,
    }
}

fn string(value: Option<Value>) -> String {
    match value {
        Some(Value::String(text)) => text,
        _ => String::new(),
    }
}

/// Takes the fields of a project one by one.
struct Reader {
    fields: Map<String, Value>,
    notes: Vec<String>,
}

impl Reader {
    /// A field; `None` if it is absent. What it holds beyond what is known is noted.
    fn take<T: DeserializeOwned + Serialize>(&mut self, name: &str) -> Result<Option<T>, String> {
        let Some(value) = self.fields.remove(name).filter(|value| !value.is_null()) else {
            return Ok(None);
        };
        let read: T = serde_json::from_value(value.clone()).map_err(|error| error.to_string())?;
        if let Ok(known) = serde_json::to_value(&read) {
            text::tell_unknown(&value, &known, name, &mut self.notes);
        }
        Ok(Some(read))
    }

    /// A field that the rest can do without.
    fn take_or_tell<T: DeserializeOwned + Serialize>(&mut self, name: &str) -> Option<T> {
        self.take(name).unwrap_or_else(|reason| {
            let note = format!("the field {name:?} is not understood and left out: {reason}");
            self.notes.push(note);
            None
        })
    }
}

#[cfg(test)]
mod tests;
