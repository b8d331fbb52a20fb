//! Decks and meshes as bytes: a part with its own ids, or a bare surface.

use std::path::Path;

use crate::formats::keyword::write::{WriteOptions, write};
use crate::formats::model::Sets;
use crate::formats::moved::moved;
use crate::formats::{Format, Model, obj, ply, stl};
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::units::PairUnits;
use crate::report::build_id;
use crate::text::counted;

/// How a surface with a title is written in a format without ids; `None` for a deck.
fn mesh_writer(format: Format) -> Option<fn(&TriMesh, &str) -> Vec<u8>> {
    match format {
        Format::Keyword => None,
        Format::Stl => Some(|mesh, _| stl::write_binary(mesh)),
        Format::Obj => Some(obj::write),
        Format::Ply => Some(ply::write),
    }
}

/// The chosen elements, moved, with their own ids. The unit factor is applied as well, so the bytes are in the
/// crash model's unit. Mesh formats without ids get the matched surface only.
pub fn part_bytes(
    format: Format,
    part: &LoadedPart,
    world_from_part: &Similarity,
    comments: &[String],
    monitor: &Monitor,
) -> Result<Vec<u8>, PipelineError> {
    if let Some(write) = mesh_writer(format) {
        let mesh = part.mesh.transformed(world_from_part);
        return Ok(write(&mesh, &comments.join(", ")));
    }
    let selection = &part.settings.selection;
    let chosen = part.model.of_chosen(selection).map_err(|error| {
        let path = part.path.clone();
        PipelineError::Selection {
            error,
            near: String::new(),
            path,
            diagnostic: None,
        }
    })?;
    let factor = part.settings.length_factor;
    let unit = Similarity::from_scale(factor);
    let model = moved(&chosen, &world_from_part.after(&unit), factor);
    let options = WriteOptions {
        comments: comments.to_vec(),
        ..WriteOptions::default()
    };
    Ok(write(&model, &options, monitor)?)
}

/// A reduced mesh of a part, moved. As a deck it has one part with the mean thickness of the chosen elements; id and
/// title are the part's where one was chosen.
pub fn reduced_bytes(
    format: Format,
    part: &LoadedPart,
    mesh: &TriMesh,
    world_from_part: &Similarity,
    monitor: &Monitor,
) -> Result<Vec<u8>, PipelineError> {
    let mesh = mesh.transformed(world_from_part);
    let title = format!("{}, reduced", part.file_name());
    if let Some(write) = mesh_writer(format) {
        return Ok(write(&mesh, &title));
    }
    let mut model = Model::from_mesh(&mesh, title);
    model.raw_titles = part.model.raw_titles.clone();
    let only = part.chosen_part_ids();
    for own in &mut model.parts {
        let thickness = part.mean_thickness();
        own.thickness = thickness.map(|thickness| [thickness; 4]);
        if let [id] = only[..]
            && let Some(index) = part.model.part_index(id)
        {
            own.id = id;
            own.title
                .clone_from(&part.model.parts[index as usize].title);
        }
    }
    let options = WriteOptions {
        comments: reduced_lacks(part).into_iter().collect(),
        ..WriteOptions::default()
    };
    Ok(write(&model, &options, monitor)?)
}

/// What a deck of a reduced part lacks that its file has, in words; `None` for nothing but ids.
pub fn reduced_lacks(part: &LoadedPart) -> Option<String> {
    let model = &part.model;
    let lacks = [
        (!model.forming.is_empty(), "forming results"),
        (
            !model.shell_extras.is_empty(),
            "thicknesses of the elements, whose mean the section has",
        ),
        (part.chosen_part_ids().len() > 1, "the division into parts"),
        (!model.materials.is_empty(), "materials"),
        (!model.sections.is_empty(), "formulations of the sections"),
        (model.sets != Sets::default(), "sets"),
    ];
    let lacks: Vec<&str> = lacks
        .into_iter()
        .filter_map(|(has, what)| has.then_some(what))
        .collect();
    (!lacks.is_empty()).then(|| format!("left out of the deck: {}", lacks.join(", ")))
}

/// What a deck of a part lacks that the deck it was read from has, in words; `None` for nothing.
pub fn left_out(part: &LoadedPart) -> Option<String> {
    let model = part.model.of_chosen(&part.settings.selection).ok()?;
    let of_shells = model.shell_extras.iter();
    let n_stacks = of_shells.filter(|extra| extra.plies.is_some()).count();
    let n_parts = model
        .parts
        .iter()
        .filter(|part| part.plies.is_some())
        .count();
    let mut lacks = Vec::new();
    if n_stacks > 0 {
        lacks.push(format!("the plies of {}", counted(n_stacks, "shell")));
    }
    if n_parts > 0 {
        lacks.push(format!("the plies of {}", counted(n_parts, "part")));
    }
    if !lacks.is_empty() {
        lacks.push("which have the sum of their thicknesses".to_owned());
    }
    let has_own_rule = |part: u32| {
        let formulation = model.shell_formulation(part);
        formulation.is_some_and(|formulation| formulation.own_rule.is_some())
    };
    let n_rules = (0..model.parts.len() as u32)
        .filter(|part| has_own_rule(*part))
        .count();
    if n_rules > 0 {
        lacks.push(format!(
            "the integration rules of {}",
            counted(n_rules, "part")
        ));
    }
    let n_offset = model.offset_shells.len();
    if n_offset > 0 {
        lacks.push(format!("the offset of {}", counted(n_offset, "shell")));
    }
    (!lacks.is_empty()).then(|| format!("left out of the deck: {}", lacks.join(", ")))
}

/// What the head of a written deck says: where it comes from, units, build.
pub fn head_lines(part: &LoadedPart, units: &PairUnits) -> Vec<String> {
    let factor = part.settings.length_factor;
    let mut lines = vec![format!("made from {}", part.file_name())];
    lines.push(match units.lengths {
        Some(unit) => format!("lengths in {unit}"),
        None => "unit of lengths unknown".to_owned(),
    });
    if factor != 1.0 {
        lines.push(format!(
            "lengths and thicknesses were multiplied by {factor}; stresses keep their unit"
        ));
    }
    lines.push(build_id());
    lines
}

/// The format that the extension names; unlike in reading, no extension is no format.
pub fn format_of(path: &Path) -> Result<Format, PipelineError> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    let is_named = |format: &&Format| {
        let packed = "gz";
        extension
            .as_deref()
            .is_some_and(|e| e != packed && format.extensions().contains(&e))
    };
    let found = Format::ALL.iter().find(is_named).copied();
    found.ok_or_else(|| PipelineError::UnknownExtension(path.to_path_buf()))
}
