//! A model with the chosen elements alone.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};

use super::{Forming, Model, Nodes, Part, Selection, SelectionError, Set, Sets, Shell, ShellExtra};

/// Which of a list stay, and the number that each of them has then.
struct Kept {
    stays: Vec<bool>,
    number: Vec<u32>,
}

impl Kept {
    fn new(stays: Vec<bool>) -> Self {
        let mut next = 0;
        let number = |&stays: &bool| {
            let number = next;
            next += u32::from(stays);
            number
        };
        let number = stays.iter().map(number).collect();
        Self { stays, number }
    }

    fn has(&self, index: u32) -> bool {
        self.stays.get(index as usize) == Some(&true)
    }

    /// The new number of one that stays; others, such as the mark of no node, are left as they are.
    fn of(&self, index: u32) -> u32 {
        if self.has(index) {
            self.number[index as usize]
        } else {
            index
        }
    }

    fn filter<'a, T>(&'a self, all: &'a [T]) -> impl Iterator<Item = &'a T> {
        let both = all.iter().zip(&self.stays);
        both.filter_map(|(one, stays)| stays.then_some(one))
    }
}

impl Model {
    /// The model without the elements that are not chosen and what only they need: nodes, parts, sections,
    /// materials, members of sets, results. As it is where all are chosen. O(model).
    pub fn of_chosen(&self, selection: &Selection) -> Result<Cow<'_, Self>, SelectionError> {
        let chosen = self.chosen(selection)?;
        let shells = self.shells.iter().enumerate();
        let shells: Vec<bool> = shells
            .map(|(index, shell)| chosen.shell(index, shell.part))
            .collect();
        let solids = self.solids.iter();
        let solids: Vec<bool> = solids.map(|solid| chosen.solid(solid.part)).collect();
        Ok(if shells.contains(&false) || solids.contains(&false) {
            Cow::Owned(self.with_only(&Kept::new(shells), &Kept::new(solids)))
        } else {
            Cow::Borrowed(self)
        })
    }

    fn with_only(&self, shells: &Kept, solids: &Kept) -> Self {
        let nodes = Kept::new(self.nodes_of(shells, solids));
        let mut has_elements = vec![false; self.parts.len()];
        let of_shells = shells.filter(&self.shells).map(|shell| shell.part);
        let of_solids = solids.filter(&self.solids).map(|solid| solid.part);
        for part in of_shells.chain(of_solids) {
            has_elements[part as usize] = true;
        }
        let parts = Kept::new(has_elements);
        let mut model = Self {
            format: self.format,
            layout: self.layout,
            title: self.title.clone(),
            raw_titles: self.raw_titles.clone(),
            stated_units: self.stated_units,
            ply_stacks: self.ply_stacks.clone(),
            shell_control: self.shell_control,
            parts: parts.filter(&self.parts).cloned().collect(),
            ..Self::default()
        };
        let ids = nodes.filter(self.nodes.ids()).copied().collect();
        let positions = nodes.filter(self.nodes.positions()).copied().collect();
        model.nodes = Nodes::new(ids, positions).0;
        model.shells = shells.filter(&self.shells).copied().collect();
        for shell in &mut model.shells {
            shell.part = parts.of(shell.part);
            shell.nodes = shell.nodes.map(|node| nodes.of(node));
        }
        model.solids = solids.filter(&self.solids).copied().collect();
        for solid in &mut model.solids {
            solid.part = parts.of(solid.part);
            solid.nodes = solid.nodes.map(|node| nodes.of(node));
        }
        let mid_side = self.mid_side.iter().filter(|(shell, _)| shells.has(*shell));
        model.mid_side = mid_side
            .map(|(shell, of_edges)| (shells.of(*shell), of_edges.map(|node| nodes.of(node))))
            .collect();
        let offset = self.offset_shells.iter().filter(|&&s| shells.has(s));
        model.offset_shells = offset.map(|&shell| shells.of(shell)).collect();
        let extras = self.shell_extras.iter().filter(|e| shells.has(e.shell));
        model.shell_extras = extras
            .map(|extra| ShellExtra {
                shell: shells.of(extra.shell),
                ..*extra
            })
            .collect();
        self.add_what_parts_name(&mut model);
        model.sets = sets_within(&self.sets, &model);
        model.forming = forming_of(&self.forming, &model.shells);
        model
    }

    /// For each node whether a kept element has it.
    fn nodes_of(&self, shells: &Kept, solids: &Kept) -> Vec<bool> {
        let mut is_used = vec![false; self.nodes.len()];
        let of_shells = shells.filter(&self.shells).flat_map(|shell| shell.nodes);
        let of_solids = solids.filter(&self.solids).flat_map(|solid| solid.nodes);
        let mid_side = self.mid_side.iter().filter(|(shell, _)| shells.has(*shell));
        let of_edges = mid_side.flat_map(|(_, nodes)| *nodes);
        for node in of_shells.chain(of_solids).chain(of_edges) {
            if let Some(is_used) = is_used.get_mut(node as usize) {
                *is_used = true;
            }
        }
        is_used
    }

    /// Sections and materials of the parts of `model`.
    fn add_what_parts_name(&self, model: &mut Self) {
        let named = |id: fn(&Part) -> u64| -> HashSet<u64> { model.parts.iter().map(id).collect() };
        let (sections, materials) = (
            named(|part| part.section_id),
            named(|part| part.material_id),
        );
        let of_sections = self.sections.iter().filter(|s| sections.contains(&s.id));
        model.sections = of_sections.copied().collect();
        let of_materials = self.materials.iter().filter(|m| materials.contains(&m.id));
        model.materials = of_materials.cloned().collect();
    }
}

/// The sets with those of their members that a model has; sets without any are left out.
fn sets_within(sets: &Sets, model: &Model) -> Sets {
    let parts: HashSet<u64> = model.parts.iter().map(|part| part.id).collect();
    let shells: HashSet<u64> = model.shells.iter().map(|shell| shell.id).collect();
    let within = |sets: &BTreeMap<u64, Set>, is_there: &dyn Fn(u64) -> bool| {
        let with_members = sets.iter().filter_map(|(&id, set)| {
            let ids: Vec<u64> = set.ids.iter().copied().filter(|&id| is_there(id)).collect();
            let title = set.title.clone();
            (!ids.is_empty()).then_some((id, Set { title, ids }))
        });
        with_members.collect()
    };
    Sets {
        parts: within(&sets.parts, &|id| parts.contains(&id)),
        shells: within(&sets.shells, &|id| shells.contains(&id)),
        nodes: within(&sets.nodes, &|id| model.nodes.index_of(id).is_some()),
    }
}

/// The results of some shells.
fn forming_of(forming: &Forming, shells: &[Shell]) -> Forming {
    let ids: HashSet<u64> = shells.iter().map(|shell| shell.id).collect();
    let mut kept = Forming::default();
    for s in forming.stresses().filter(|s| ids.contains(&s.element_id)) {
        // The counts are those of results that were added before.
        let _ = kept.add_state(s.element_id, s.n_plane, s.points, s.history, s.tensors);
    }
    for s in forming.strains().filter(|s| ids.contains(&s.element_id)) {
        kept.add_strain(s.element_id, s.n_plane, s.points);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::{StrainPoint, StressPoint};
    use super::*;
    use crate::geometry::Point3;

    /// Two parts of one shell each, which share an edge.
    fn two_parts() -> Model {
        let at = |i: u32| Point3::new(f64::from(i / 2), f64::from(i % 2), 0.0);
        let part = |id| Part {
            id,
            section_id: 10 * id,
            is_defined: true,
            ..Part::default()
        };
        let set = |ids: &[u64]| Set {
            ids: ids.to_vec(),
            ..Set::default()
        };
        let mut model = Model {
            nodes: Nodes::new((11..17).collect(), (0..6).map(at).collect()).0,
            parts: vec![part(1), part(2)],
            ..Model::default()
        };
        let shell = |id, nodes, part| Shell { id, nodes, part };
        model.shells = vec![shell(5, [0, 2, 3, 1], 0), shell(6, [2, 4, 5, 3], 1)];
        let extra = |shell| ShellExtra {
            shell,
            thickness: [1.0; 4],
            beta: 0.0,
            plies: None,
        };
        model.shell_extras = vec![extra(0), extra(1)];
        model.sets.parts = [(1, set(&[1, 2])), (2, set(&[1]))].into();
        model.sets.nodes = [(3, set(&[11, 13, 16]))].into();
        for id in [5, 6] {
            let points = [StressPoint::default()];
            model.forming.add_state(id, 1, &points, &[], &[]).unwrap();
            model.forming.add_strain(id, 1, &[StrainPoint::default()]);
        }
        model
    }

    #[test]
    fn what_is_not_chosen_and_all_that_only_it_needs_is_left_out() {
        let whole = two_parts();
        let model = whole.of_chosen(&Selection::Parts(vec![2])).unwrap();
        assert_eq!(model.nodes.ids(), [13, 14, 15, 16]);
        let shell = Shell {
            id: 6,
            nodes: [0, 2, 3, 1],
            part: 0,
        };
        assert_eq!(model.shells, [shell]);
        assert_eq!(model.shell_extras[0].shell, 0);
        assert_eq!(model.shell_extras.len(), 1);
        let ids: Vec<u64> = model.parts.iter().map(|part| part.id).collect();
        assert_eq!(ids, [2]);
        assert_eq!(model.sets.parts[&1].ids, [2]);
        assert_eq!(model.sets.parts.len(), 1);
        assert_eq!(model.sets.nodes[&3].ids, [13, 16]);
        assert_eq!(model.forming.n_stress(), 1);
        assert_eq!(model.forming.stress(0).element_id, 6);
        assert_eq!(model.forming.n_strain(), 1);
        let surface = whole.surface(&Selection::Parts(vec![2])).unwrap();
        assert_eq!(model.surface(&Selection::All).unwrap().mesh, surface.mesh);
        let all = whole.of_chosen(&Selection::Parts(vec![1, 2])).unwrap();
        assert!(matches!(all, Cow::Borrowed(_)));
    }
}
