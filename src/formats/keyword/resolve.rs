//! The end of reading a deck: nodes are numbered, motions are carried out, thickness is handed out.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

use rayon::prelude::*;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position};
use super::super::model::{
    AppliedMotion, Model, Nodes, Set, Sets, Shell, ShellExtra, has_area, has_crossed_edges,
};
use super::super::moved::reverse_elements;
use super::super::{MAX_LENGTH, ReadOptions};
use super::assemble::{Assembly, Motion};
use super::link;
use super::results::{Results, Turned, mirrors, turn_of};
use super::set_members::{Intervals, Surroundings, resolve_sets};
use super::sets::SetKind;
use crate::geometry::Matrix4;
use crate::monitor::{Cancelled, Monitor};

/// Marks a node that does not exist.
pub(super) const MISSING: u32 = u32::MAX;
/// Elements per piece of parallel work. Fixed, so that results do not depend on threads.
pub(super) const PIECE: usize = 1 << 14;

/// Puts the model together.
pub(super) fn finish(
    mut assembly: Assembly,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, Cancelled> {
    let mut model = Model {
        layout: assembly.layout,
        title: std::mem::take(&mut assembly.title),
        files: std::mem::take(&mut assembly.files),
        stated_units: assembly.unit_clues.units(),
        ..Model::default()
    };
    let repeated = number_nodes(&mut assembly, &mut model);
    monitor.check()?;
    link::link_shells(&mut assembly, &mut model);
    monitor.check()?;
    link::link_solids(&mut assembly, &mut model);
    monitor.check()?;
    assembly.number_labelled_parts();
    give_thickness_to_parts(&mut assembly, &mut model);
    let around = Surroundings {
        model: &model,
        max_ids: options.max_set_ids,
        monitor,
    };
    model.sets = collect_sets(&mut assembly, &around)?;
    spread_node_thickness(&assembly, &mut model, monitor)?;
    let raw = std::mem::take(&mut assembly.forming);
    let mut results = Results::new(raw, &model, &mut assembly.found);
    results.tell_doubtful(&model, &mut assembly.found);
    carry_out_motions(&mut assembly, &mut model, &mut results, monitor)?;
    model.forming = results.finish();
    leave_out_nodes(&repeated, &mut model);
    monitor.check()?;
    tell_odd_shells(&assembly, &mut model);
    monitor.check()?;
    tell_offsets(&mut assembly, &model);
    tell_no_elements(&mut assembly, &model);
    tell_other_units(&mut assembly, &model);
    model.raw_titles = std::mem::take(&mut assembly.raw_titles);
    let mut found = assembly.found;
    found.append(std::mem::take(&mut model.diagnostics));
    model.diagnostics = found;
    Ok(model)
}

/// Gives back the indices of nodes whose id an earlier one has.
fn number_nodes(assembly: &mut Assembly, model: &mut Model) -> Vec<u32> {
    let ids = std::mem::take(&mut assembly.node_ids);
    let positions = std::mem::take(&mut assembly.positions);
    let (nodes, repeated) = Nodes::new(ids, positions);
    let mut found = Diagnostics::default();
    for &index in &repeated {
        let id = nodes.ids()[index as usize];
        let here = nodes.positions()[index as usize];
        let (kind, place) = if nodes.position_of(id) == Some(here) {
            (DiagnosticKind::RepeatedNode, "at the same place")
        } else {
            let place = "at another place, the first counts";
            (DiagnosticKind::DuplicateNode, place)
        };
        found.push_with(kind, || {
            let message = format!("node {id} is defined again {place}");
            with_position(
                Diagnostic::new(kind, message),
                assembly.node_position(index as usize, id),
            )
        });
    }
    assembly.found.append(found);
    model.nodes = nodes;
    repeated
}

/// Leaves out repeated nodes, which no element uses, so that each node is counted once.
fn leave_out_nodes(repeated: &[u32], model: &mut Model) {
    if repeated.is_empty() {
        return;
    }
    let mut repeated = repeated.iter().peekable();
    let (mut ids, mut positions) = (Vec::new(), Vec::new());
    let mut new_index = Vec::with_capacity(model.nodes.len());
    let all = model.nodes.ids().iter().zip(model.nodes.positions());
    for (index, (&id, &position)) in (0u32..).zip(all) {
        if repeated.next_if(|&&r| r == index).is_some() {
            new_index.push(MISSING);
            continue;
        }
        new_index.push(ids.len() as u32);
        ids.push(id);
        positions.push(position);
    }
    model.nodes = Nodes::new(ids, positions).0;
    let of_shells = model.shells.iter_mut().flat_map(|shell| &mut shell.nodes);
    let of_solids = model.solids.iter_mut().flat_map(|solid| &mut solid.nodes);
    let of_sides = model.mid_side.iter_mut().flat_map(|(_, nodes)| nodes);
    for node in of_shells.chain(of_solids).chain(of_sides) {
        // Some mid-side nodes are missing from the start.
        *node = new_index.get(*node as usize).copied().unwrap_or(MISSING);
    }
}

/// Says that nodes lie off the mid-surface by the cards of their shells.
fn tell_offsets(assembly: &mut Assembly, model: &Model) {
    let n = model.offset_shells.len();
    if n == 0 {
        return;
    }
    let s = if n == 1 { "" } else { "s" };
    // Without digits that come from rounding.
    let largest = assembly.offsets.largest as f32;
    let message = format!(
        "the nodes of {n} shell{s} lie up to {largest} off their mid-surface (*ELEMENT_SHELL_OFFSET) and are taken to \
         lie in it"
    );
    let diagnostic = Diagnostic::new(DiagnosticKind::OffMidSurface, message);
    assembly
        .found
        .push(with_position(diagnostic, whole_file(model)));
}

fn tell_no_elements(assembly: &mut Assembly, model: &Model) {
    if !model.shells.is_empty() || !model.solids.is_empty() {
        return;
    }
    let kind = DiagnosticKind::NoElements;
    let message = match model.nodes.len() {
        0 => "the deck has neither nodes nor shells nor solids".to_owned(),
        1 => "the deck has 1 node and neither shells nor solids".to_owned(),
        n => format!("the deck has {n} nodes and neither shells nor solids"),
    };
    let diagnostic = with_position(Diagnostic::new(kind, message), whole_file(model));
    assembly.found.push(diagnostic);
}

fn tell_other_units(assembly: &mut Assembly, model: &Model) {
    if let Some(message) = assembly.unit_clues.contradiction() {
        let diagnostic = Diagnostic::new(DiagnosticKind::OtherUnits, message);
        let diagnostic = with_position(diagnostic, whole_file(model));
        assembly.found.push(diagnostic);
    }
}

/// The file that was asked for.
fn whole_file(model: &Model) -> Option<Position> {
    let file = model.files.first()?;
    Some(Position::file(&Arc::from(file.path.as_path())))
}

pub(super) fn with_position(diagnostic: Diagnostic, position: Option<Position>) -> Diagnostic {
    match position {
        Some(position) => diagnostic.at(position),
        None => diagnostic,
    }
}

/// Parts take the thickness of their section, unless plies gave them one.
fn give_thickness_to_parts(assembly: &mut Assembly, model: &mut Model) {
    let sections = assembly.sections.iter().enumerate();
    let by_id: BTreeMap<u64, usize> = sections.map(|(i, section)| (section.id, i)).collect();
    tell_undefined_parts(assembly, model);
    for part in &mut assembly.parts {
        if !part.is_defined {
            continue;
        }
        if part.thickness.is_none() {
            let section = by_id.get(&part.section_id).map(|&i| assembly.sections[i]);
            let thickness = section.map(|section| section.thickness);
            part.thickness = thickness.filter(|corners| *corners != [0.0; 4]);
        }
    }
    model.parts = std::mem::take(&mut assembly.parts);
    model.sections = std::mem::take(&mut assembly.sections);
    model.materials = std::mem::take(&mut assembly.materials);
    model.shell_control = assembly.shell_control;
    model.stamped_includes = std::mem::take(&mut assembly.stamped_includes);
    model.transformations = assembly.transformations.keys().copied().collect();
}

/// With the line of the first element that names the part.
fn tell_undefined_parts(assembly: &mut Assembly, model: &Model) {
    let undefined = assembly
        .parts
        .iter()
        .filter(|part| !part.is_defined)
        .count();
    if undefined == 0 {
        return;
    }
    // Index of the first shell, or of the first solid behind all shells.
    let mut first_use = vec![usize::MAX; assembly.parts.len()];
    let mut n_left = undefined;
    let of_shells = model.shells.iter().map(|shell| shell.part);
    let of_solids = model.solids.iter().map(|solid| solid.part);
    for (index, part) in of_shells.chain(of_solids).enumerate() {
        let first = &mut first_use[part as usize];
        if *first == usize::MAX {
            *first = index;
            n_left -= usize::from(!assembly.parts[part as usize].is_defined);
            if n_left == 0 {
                break;
            }
        }
    }
    let mut found = Diagnostics::default();
    for (part, &first) in assembly.parts.iter().zip(&first_use) {
        if part.is_defined {
            continue;
        }
        let kind = DiagnosticKind::UndefinedPart;
        found.push_with(kind, || {
            let message = format!("elements name part {}, which is not defined", part.id);
            let position = match model.shells.get(first) {
                Some(shell) => assembly.shell_position(first, shell),
                None => first
                    .checked_sub(model.shells.len())
                    .and_then(|index| assembly.solid_position(index, model.solids.get(index)?)),
            };
            with_position(Diagnostic::new(kind, message), position)
        });
    }
    assembly.found.append(found);
}

fn collect_sets(assembly: &mut Assembly, around: &Surroundings<'_>) -> Result<Sets, Cancelled> {
    for (_, set) in &assembly.sets {
        assembly.raw_titles.add(&set.title);
    }
    let resolved = resolve_sets(&assembly.sets, around, &mut assembly.found)?;
    let mut sets = Sets::default();
    for ((kind, id), set) in resolved {
        let into: &mut BTreeMap<u64, Set> = match kind {
            SetKind::Part => &mut sets.parts,
            SetKind::Shell => &mut sets.shells,
            SetKind::Node => &mut sets.nodes,
        };
        into.insert(id, set);
    }
    Ok(sets)
}

/// Thickness at nodes goes to the corners of shells that have none of their own.
fn spread_node_thickness(
    assembly: &Assembly,
    model: &mut Model,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    if assembly.node_thickness.is_empty() {
        return Ok(());
    }
    let at_node = node_thickness(assembly, model, monitor)?;
    let mut own = std::mem::take(&mut model.shell_extras)
        .into_iter()
        .peekable();
    for (index, shell) in (0u32..).zip(&model.shells) {
        let extra = own.next_if(|extra| extra.shell == index);
        let of_nodes = shell.nodes.map(|node| at_node[node as usize]);
        let mut merged = extra.unwrap_or(ShellExtra {
            shell: index,
            thickness: [0.0; 4],
            beta: 0.0,
            plies: None,
        });
        for (own, of_node) in merged.thickness.iter_mut().zip(of_nodes) {
            if *own == 0.0 {
                *own = of_node;
            }
        }
        if extra.is_some() || merged.thickness != [0.0; 4] {
            model.shell_extras.push(merged);
        }
    }
    Ok(())
}

/// For each node its thickness, 0 for none. The last row that names a node counts, so rows are
/// taken from the last to the first, and what a set or a range has in common with later ones like it is passed over.
fn node_thickness(
    assembly: &Assembly,
    model: &Model,
    monitor: &Monitor,
) -> Result<Vec<f64>, Cancelled> {
    let mut at_node: Vec<Option<f64>> = vec![None; model.nodes.len()];
    let mut sorted: Vec<u64> = Vec::new();
    let mut given_sets = HashSet::new();
    // By step and by what the step leaves of an id.
    let mut covered: HashMap<[u64; 2], Intervals> = HashMap::new();
    for row in assembly.node_thickness.iter().rev() {
        monitor.check()?;
        let mut give = |id: u64| {
            if let Some(index) = model.nodes.index_of(id) {
                at_node[index as usize].get_or_insert(row.thickness);
            }
        };
        if row.is_set {
            let set = model.sets.nodes.get(&row.first);
            let set = set.filter(|_| given_sets.insert(row.first));
            let ids = set.into_iter().flat_map(|set| &set.ids);
            ids.for_each(|&id| give(id));
            continue;
        }
        if row.last == row.first {
            give(row.first);
            continue;
        }
        if sorted.is_empty() {
            sorted = model.nodes.ids().to_vec();
            sorted.sort_unstable();
        }
        let like = covered.entry([row.step, row.first % row.step]);
        for (first, last) in like.or_default().cover(row.first, row.last) {
            let from = sorted.partition_point(|&id| id < first);
            let n = sorted[from..].partition_point(|&id| id <= last);
            let off = (first - row.first) % row.step;
            let first = first.saturating_add((row.step - off) % row.step);
            if first > last {
                continue;
            }
            // Of the nodes there, or of the ids that are meant, the fewer.
            if (last - first) / row.step < n as u64 {
                let ids = (first..=last).step_by(usize::try_from(row.step).unwrap_or(usize::MAX));
                ids.for_each(&mut give);
            } else {
                let ids = sorted[from..from + n].iter();
                let ids = ids.filter(|&id| (id - row.first).is_multiple_of(row.step));
                ids.for_each(|&id| give(id));
            }
        }
    }
    Ok(at_node.into_iter().map(Option::unwrap_or_default).collect())
}

/// Carries out unit factors, then transformations, the innermost include first. `*NODE_TRANSFORM`
/// waits for all of them unless it asks to be carried out at once. The lengths of a transformation are in the unit
/// of the whole deck, wherever it is defined and used, so the coordinates must be so before.
fn carry_out_motions(
    assembly: &mut Assembly,
    model: &mut Model,
    results: &mut Results,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let mut motions = std::mem::take(&mut assembly.motions);
    motions.sort_by_key(|motion| match motion {
        Motion::Scale { .. } => 0,
        Motion::Include { .. }
        | Motion::NodeSet {
            at_once: Some(_), ..
        } => 1,
        Motion::NodeSet { at_once: None, .. } => 2,
    });
    for motion in motions {
        monitor.check()?;
        if let Err(diagnostic) = carry_out(assembly, model, results, &motion) {
            assembly.found.push(diagnostic);
        }
    }
    Ok(())
}

fn carry_out(
    assembly: &mut Assembly,
    model: &mut Model,
    results: &mut Results,
    motion: &Motion,
) -> Result<(), Diagnostic> {
    let (position, id, matrix) = match motion {
        Motion::Scale {
            factor, position, ..
        } => (position, 0, Ok(Matrix4::new_scaling(*factor))),
        Motion::Include {
            transformation: id,
            position,
            ..
        }
        | Motion::NodeSet {
            transformation: id,
            position,
            ..
        } => (position, *id, matrix(assembly, model, *id)),
    };
    let failed = |kind, message: String| Diagnostic::new(kind, message).at(position.clone());
    let matrix = matrix.map_err(|reason| {
        let message = format!("transformation {id} {reason}");
        failed(DiagnosticKind::BadTransformation, message)
    })?;
    let indices: Vec<usize> = match motion {
        Motion::Scale { nodes, .. } | Motion::Include { nodes, .. } => nodes.clone().collect(),
        Motion::NodeSet { set, at_once, .. } => {
            let members = model.sets.nodes.get(set).ok_or_else(|| {
                let message =
                    format!("transformation {id} moves node set {set}, which is not defined");
                failed(DiagnosticKind::BadTransformation, message)
            })?;
            let ids = members.ids.iter();
            let known = ids.filter_map(|&id| model.nodes.index_of(id));
            let n_read = at_once.unwrap_or(usize::MAX);
            known
                .map(|index| index as usize)
                .filter(|&index| index < n_read)
                .collect()
        }
    };
    let positions = model.nodes.positions_mut();
    let is_place = |index: &usize| {
        let moved = matrix.transform_point(&positions[*index]);
        moved.iter().all(|x| x.abs() <= MAX_LENGTH)
    };
    if !indices.iter().all(is_place) {
        let message = match id {
            0 => format!("the unit factor gives coordinates beyond {MAX_LENGTH:e}"),
            _ => format!("transformation {id} gives coordinates beyond {MAX_LENGTH:e}"),
        };
        let message = message + "; the nodes stay as in the file";
        return Err(failed(DiagnosticKind::BadTransformation, message));
    }
    for &index in &indices {
        positions[index] = matrix.transform_point(&positions[index]);
    }
    let turned = match motion {
        Motion::Scale { .. } => Turned::default(),
        Motion::Include { results: span, .. } => {
            move_files(model, motion, &matrix);
            results.turn_span(span, &matrix)
        }
        Motion::NodeSet { .. } => results.turn_moved(model, &indices, &matrix),
    };
    for what in turned.complaints(id) {
        assembly
            .found
            .push(failed(DiagnosticKind::Unsupported, what));
    }
    model.motions.push(AppliedMotion {
        position: position.clone(),
        transformation: id,
        matrix,
        n_nodes: indices.len(),
    });
    Ok(())
}

/// Keeps with the files of an include how the motion turns them, and reverses the corners of their elements where it
/// mirrors them.
fn move_files(model: &mut Model, motion: &Motion, matrix: &Matrix4) {
    let Motion::Include {
        shells,
        solids,
        files,
        ..
    } = motion
    else {
        return;
    };
    let (is_mirror, rotation) = (mirrors(matrix), turn_of(matrix));
    if is_mirror {
        reverse_elements(model, shells.clone(), solids.clone());
    }
    for file in &mut model.files[files.clone()] {
        file.included_as.is_mirrored ^= is_mirror;
        file.included_as.rotation = rotation * file.included_as.rotation;
    }
}

fn matrix(assembly: &Assembly, model: &Model, id: u64) -> Result<Matrix4, String> {
    let transformation = assembly.transformations.get(&id);
    let (transformation, _) = transformation.ok_or("is not defined")?;
    let matrix = transformation
        .matrix(&|node| model.nodes.position_of(node))
        .map_err(|error| format!("cannot be carried out: {error}"))?;
    if matrix.iter().all(|x| x.is_finite()) {
        Ok(matrix)
    } else {
        Err("cannot be carried out: it is not finite".to_owned())
    }
}

/// Shells without area stay in the model and are left out of surfaces; quads whose edges cross are taken as they are.
fn tell_odd_shells(assembly: &Assembly, model: &mut Model) {
    let positions = model.nodes.positions();
    let fault_of = |shell: &Shell| {
        let [a, b, c, d] = shell.nodes.map(|n| positions[n as usize]);
        if !has_area(a, b, c) && (shell.is_triangle() || !has_area(a, c, d)) {
            Some(DiagnosticKind::ZeroArea)
        } else if !shell.is_triangle() && has_crossed_edges([a, b, c, d]) {
            Some(DiagnosticKind::CrossedEdges)
        } else {
            None
        }
    };
    let odd: Vec<(usize, DiagnosticKind)> = model
        .shells
        .par_chunks(PIECE)
        .enumerate()
        .flat_map_iter(|(piece, shells)| {
            let fault_of = &fault_of;
            let shells = shells.iter().enumerate();
            shells.filter_map(move |(i, shell)| Some((piece * PIECE + i, fault_of(shell)?)))
        })
        .collect();
    for (index, kind) in odd {
        let shell = &model.shells[index];
        model.diagnostics.push_with(kind, || {
            let id = shell.id;
            let message = match kind {
                DiagnosticKind::ZeroArea => format!("shell {id} has no area"),
                _ => format!(
                    "the edges of shell {id} cross; two of its nodes are probably exchanged"
                ),
            };
            let diagnostic = Diagnostic::new(kind, message);
            with_position(diagnostic, assembly.shell_position(index, shell))
        });
    }
}
