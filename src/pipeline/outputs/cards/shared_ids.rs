//! Ids that both files have, which would collide where one deck includes the other.

use std::collections::HashSet;

use crate::formats::Model;
use crate::pipeline::load::LoadedPart;
use crate::report::IdOffsets;
use crate::role::PerRole;

/// What may have ids of its own, in the order of [`SharedIds::is_shared`].
const KINDS: [&str; 6] = [
    "nodes",
    "elements",
    "parts",
    "materials",
    "sets",
    "sections",
];

/// Kinds of things of which both files have some with the same ids.
pub(super) struct SharedIds {
    is_shared: [bool; 6],
    /// A round number above all ids of the crash deck; `None` where no field of ten columns holds it.
    offset: Option<u64>,
}

impl SharedIds {
    /// `None` if no id stands for two things.
    pub(super) fn of(parts: PerRole<&LoadedPart>) -> Option<Self> {
        let PerRole { crash, stamped } = parts.map(|part| &part.model);
        let mut nodes = stamped.nodes.ids().iter();
        let elements = share(&crash.shells, &stamped.shells, |shell| shell.id)
            || share(&crash.solids, &stamped.solids, |solid| solid.id);
        let defined = |model: &'_ Model| {
            let parts = model.parts.iter().filter(|part| part.is_defined);
            parts.map(|part| part.id).collect::<Vec<u64>>()
        };
        let sets = [
            [&crash.sets.parts, &stamped.sets.parts],
            [&crash.sets.shells, &stamped.sets.shells],
            [&crash.sets.nodes, &stamped.sets.nodes],
        ];
        let is_shared = [
            nodes.any(|&id| crash.nodes.index_of(id).is_some()),
            elements,
            share(defined(crash), defined(stamped), |id| *id),
            share(&crash.materials, &stamped.materials, |material| material.id),
            sets.iter()
                .any(|[a, b]| share(a.keys(), b.keys(), |id| **id)),
            share(&crash.sections, &stamped.sections, |section| section.id),
        ];
        is_shared.contains(&true).then(|| Self {
            is_shared,
            offset: round_above(largest_id(crash)),
        })
    }

    /// What makes the ids of the stamped file others than those of the crash deck. Curves are not read; where
    /// materials are shared, so may they be.
    pub(super) fn offsets(&self) -> IdOffsets {
        let of = |is_shared: bool| self.offset.filter(|_| is_shared).unwrap_or(0);
        let [node, element, part, material, set, section] = self.is_shared.map(of);
        IdOffsets {
            node,
            element,
            part,
            material,
            set,
            curve: material,
            section,
        }
    }

    /// The same in words.
    pub(super) fn told(&self, stamped: &LoadedPart) -> String {
        let kinds = KINDS.into_iter().zip(self.is_shared);
        let kinds: Vec<&str> = kinds
            .filter_map(|(kind, is_shared)| is_shared.then_some(kind))
            .collect();
        let (kinds, name) = (kinds.join(", "), stamped.file_name());
        let what = format!("the crash deck and {name} share ids ({kinds})");
        match self.offset {
            Some(offset) => format!("{what}; the include adds {offset} to the ids of these kinds"),
            None => format!(
                "{what}, and no offset above those of the crash deck fits the card: renumber one of the files"
            ),
        }
    }
}

/// The smallest id that no transformation of either file has, so that the one on the cards is no second definition.
pub(super) fn free_transformation(parts: PerRole<&LoadedPart>) -> u64 {
    let PerRole { crash, stamped } = parts.map(|part| &part.model.transformations);
    let is_free = |id: &u64| !crash.contains(id) && !stamped.contains(id);
    (1..).find(is_free).expect("files have finitely many ids")
}

fn share<T>(
    of_crash: impl IntoIterator<Item = T>,
    of_stamped: impl IntoIterator<Item = T>,
    id: impl Fn(&T) -> u64,
) -> bool {
    let known: HashSet<u64> = of_stamped.into_iter().map(|thing| id(&thing)).collect();
    of_crash
        .into_iter()
        .any(|thing| known.contains(&id(&thing)))
}

fn largest_id(model: &Model) -> u64 {
    let nodes = model.nodes.ids().iter().copied();
    let sets = [&model.sets.parts, &model.sets.shells, &model.sets.nodes];
    nodes
        .chain(model.shells.iter().map(|shell| shell.id))
        .chain(model.solids.iter().map(|solid| solid.id))
        .chain(model.parts.iter().map(|part| part.id))
        .chain(model.materials.iter().map(|material| material.id))
        .chain(model.sections.iter().map(|section| section.id))
        .chain(sets.into_iter().flat_map(|sets| sets.keys().copied()))
        .max()
        .unwrap_or(0)
}

/// The next number of one digit and zeros; `None` beyond ten digits.
fn round_above(largest: u64) -> Option<u64> {
    let power = 10_u64.pow(largest.max(1).ilog10());
    let above = (largest / power + 1).checked_mul(power)?;
    (above <= 9_999_999_999).then_some(above)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_is_round_and_above_all_ids() {
        for (largest, above) in [
            (0, Some(1)),
            (9, Some(10)),
            (193, Some(200)),
            (20_000_451, Some(30_000_000)),
            (9_000_000_000, None),
            (u64::MAX, None),
        ] {
            assert_eq!(round_above(largest), above, "{largest}");
        }
    }
}
