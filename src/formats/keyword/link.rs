//! Elements find their nodes: ids become indices, and elements that cannot be built are named and left out.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position};
use super::super::model::{IdIndex, Model, Nodes, Shell, ShellExtra, Solid};
use super::assemble::Assembly;
use super::resolve::{MISSING, PIECE, with_position};

/// Turns packed node ids into indices, in place, and leaves out shells with missing nodes and shells that later ones
/// take the place of.
pub(super) fn link_shells(assembly: &mut Assembly, model: &mut Model) {
    let replaced = replaced_shells(assembly);
    let packed = std::mem::take(&mut assembly.packed);
    let nodes = &model.nodes;
    let link = |shell: &Shell| {
        shell
            .nodes
            .map(|p| nodes.index_of(packed.unpack(p)).unwrap_or(MISSING))
    };
    let is_broken = |shell: &Shell| link(shell).contains(&MISSING);
    let any_broken = assembly
        .shells
        .par_chunks(PIECE)
        .any(|shells| shells.iter().any(is_broken));
    let leaves_out = any_broken || !replaced.is_empty();
    // For each shell, how many of those before it are kept, and last how many of all.
    let mut n_kept = vec![0];
    if leaves_out {
        let mut found = Diagnostics::default();
        for (index, shell) in assembly.shells.iter().enumerate() {
            let broken = is_broken(shell);
            let is_kept = !broken && !replaced.contains(&(index as u32));
            n_kept.push(n_kept[index] + usize::from(is_kept));
            if broken {
                found.push_with(DiagnosticKind::MissingNode, || {
                    let ids = shell.nodes.map(|p| packed.unpack(p));
                    let position = assembly.shell_position(index, shell);
                    missing_node("shell", shell.id, &ids, nodes, position)
                });
            }
        }
        assembly.found.append(found);
    }
    let mut shells = std::mem::take(&mut assembly.shells);
    if leaves_out {
        assembly.renumber_shells(&n_kept);
        let mut index = 0;
        shells.retain(|_| {
            index += 1;
            n_kept[index] > n_kept[index - 1]
        });
    }
    shells.par_chunks_mut(PIECE).for_each(|shells| {
        for shell in shells {
            shell.nodes = link(shell);
        }
    });
    model.shells = shells;
    let new_index = |old: u32| {
        let Some(&[before, after]) = n_kept.get(old as usize..old as usize + 2) else {
            return Some(old);
        };
        (after > before).then_some(before as u32)
    };
    let extras = std::mem::take(&mut assembly.extras).into_iter();
    model.shell_extras = extras
        .filter_map(|extra| new_index(extra.shell).map(|shell| ShellExtra { shell, ..extra }))
        .collect();
    let offset = assembly.offsets.shells.iter();
    model.offset_shells = offset.filter_map(|&shell| new_index(shell)).collect();
    model.ply_stacks = std::mem::take(&mut assembly.ply_stacks);
    let mid_side = std::mem::take(&mut assembly.mid_side).into_iter();
    model.mid_side = mid_side
        .filter_map(|(shell, ids)| {
            let indices = ids.map(|id| nodes.index_of(id).unwrap_or(MISSING));
            new_index(shell).map(|shell| (shell, indices))
        })
        .collect();
}

fn missing_node(
    what: &str,
    id: u64,
    node_ids: &[u64],
    nodes: &Nodes,
    position: Option<Position>,
) -> Diagnostic {
    let missing = node_ids.iter().find(|&&id| nodes.index_of(id).is_none());
    let missing = missing.copied().unwrap_or_default();
    let message = format!("{what} {id} names node {missing}, which is not defined");
    with_position(
        Diagnostic::new(DiagnosticKind::MissingNode, message),
        position,
    )
}

/// Tells shells whose id an earlier one has, and finds those that a later one with the same part and nodes takes
/// the place of: the same element with other cards, such as its thickness.
fn replaced_shells(assembly: &mut Assembly) -> HashSet<u32> {
    let mut replaced = HashSet::new();
    let is_rising = assembly
        .shells
        .windows(2)
        .all(|pair| pair[0].id < pair[1].id);
    if is_rising {
        return replaced;
    }
    let ids: Vec<u64> = assembly.shells.iter().map(|shell| shell.id).collect();
    let (first_of, repeated) = IdIndex::new(&ids);
    let element = |index: u32| {
        let shell = &assembly.shells[index as usize];
        let mut nodes = shell.nodes.map(|node| assembly.packed.unpack(node));
        nodes.sort_unstable();
        (shell.part, nodes)
    };
    let mut last_of: HashMap<u64, u32> = HashMap::new();
    let mut found = Diagnostics::default();
    for index in repeated {
        let id = ids[index as usize];
        let before = last_of.insert(id, index).or_else(|| first_of.get(id));
        let before = before.filter(|&before| element(before) == element(index));
        let (kind, what) = match before {
            Some(before) => {
                replaced.insert(before);
                let what = " with the same part and nodes, the last counts";
                (DiagnosticKind::RepeatedElement, what)
            }
            None => (DiagnosticKind::DuplicateElement, ", both count"),
        };
        found.push_with(kind, || {
            let message = format!("shell {id} is defined again{what}");
            with_position(
                Diagnostic::new(kind, message),
                assembly.shell_position(index as usize, &assembly.shells[index as usize]),
            )
        });
    }
    assembly.found.append(found);
    replaced
}

pub(super) fn link_solids(assembly: &mut Assembly, model: &mut Model) {
    let mut found = Diagnostics::default();
    let mut seen: HashSet<u64> = HashSet::with_capacity(assembly.solids.len());
    // For each solid, how many of those before it are kept.
    let mut n_kept = Vec::with_capacity(assembly.solids.len() + 1);
    for (index, raw) in assembly.solids.iter().enumerate() {
        n_kept.push(model.solids.len());
        if !seen.insert(raw.id) {
            found.push_with(DiagnosticKind::DuplicateElement, || {
                let message = format!("solid {} is defined again, both count", raw.id);
                with_position(
                    Diagnostic::new(DiagnosticKind::DuplicateElement, message),
                    assembly.raw_solid_position(index),
                )
            });
        }
        let nodes = raw
            .nodes
            .map(|id| model.nodes.index_of(id).unwrap_or(MISSING));
        if nodes.contains(&MISSING) {
            found.push_with(DiagnosticKind::MissingNode, || {
                let position = assembly.raw_solid_position(index);
                missing_node("solid", raw.id, &raw.nodes, &model.nodes, position)
            });
            continue;
        }
        model.solids.push(Solid {
            id: raw.id,
            nodes,
            part: raw.part,
            kind: raw.kind,
        });
    }
    n_kept.push(model.solids.len());
    assembly.renumber_solids(&n_kept);
    assembly.found.append(found);
    assembly.solids = Vec::new();
}
