//! Which parts of a file may be the formed sheet, and which are the tools that formed it.

use std::collections::HashSet;

use super::Model;

/// Law of materials that do not deform (`*MAT_RIGID`).
const RIGID_LAW: &str = "20";
/// Fraction by which thicknesses of a sheet differ that was not formed.
const EVEN: f64 = 1e-3;

impl Model {
    /// For each part whether it may be the formed sheet. A forming deck also holds die, punch and
    /// binder, whose surfaces lie half a thickness from the sheet's.
    ///
    /// Parts that do not deform are tools where others deform; of the rest only those with stresses or
    /// strains count where some have them, and where none has any, those whose shells differ in thickness. Of a file
    /// that tells nothing every part counts. O(elements), of which nothing is asked in a file of one part.
    pub fn sheet_parts(&self) -> Vec<bool> {
        let mut may_be = self.parts_with_elements();
        let is_rigid = |part: usize| {
            let material = self.material(part as u32);
            material.is_some_and(|material| material.law == RIGID_LAW)
        };
        let deforms: Vec<bool> = (may_be.iter().enumerate())
            .map(|(part, has_elements)| *has_elements && !is_rigid(part))
            .collect();
        narrow(&mut may_be, &deforms);
        if may_be.iter().filter(|is_left| **is_left).count() > 1 {
            let has_results = self.parts_with_results();
            narrow(&mut may_be, &has_results);
            if !has_results.contains(&true) {
                narrow(&mut may_be, &self.parts_of_uneven_thickness());
            }
        }
        may_be
    }

    /// Ids of the parts that have elements and are not the formed sheet: its tools. O(elements).
    pub fn tools(&self) -> Vec<u64> {
        let may_be = self.sheet_parts();
        let has_elements = self.parts_with_elements();
        let parts = self.parts.iter().zip(has_elements.iter().zip(&may_be));
        let tools = parts.filter(|(_, (has_elements, may_be))| **has_elements && !**may_be);
        tools.map(|(part, _)| part.id).collect()
    }

    fn parts_with_elements(&self) -> Vec<bool> {
        let mut has = vec![false; self.parts.len()];
        let of_shells = self.shells.iter().map(|shell| shell.part);
        for part in of_shells.chain(self.solids.iter().map(|solid| solid.part)) {
            has[part as usize] = true;
        }
        has
    }

    /// For each part whether the thicknesses that its shells have of their own differ, as forming leaves them.
    /// O(elements).
    fn parts_of_uneven_thickness(&self) -> Vec<bool> {
        let mut ranges = vec![[f64::INFINITY, 0.0]; self.parts.len()];
        for extra in &self.shell_extras {
            let [least, most] = &mut ranges[self.shells[extra.shell as usize].part as usize];
            for &thickness in extra.thickness.iter().filter(|thickness| **thickness > 0.0) {
                *least = thickness.min(*least);
                *most = thickness.max(*most);
            }
        }
        let is_uneven = |[least, most]: [f64; 2]| most > least * (1.0 + EVEN);
        ranges.into_iter().map(is_uneven).collect()
    }

    /// For each part whether a shell of it has stresses or strains. O(elements).
    pub fn parts_with_results(&self) -> Vec<bool> {
        let mut has = vec![false; self.parts.len()];
        let stresses = self.forming.stresses().map(|stress| stress.element_id);
        let strains = self.forming.strains().map(|strain| strain.element_id);
        let ids: HashSet<u64> = stresses.chain(strains).collect();
        if !ids.is_empty() {
            for shell in self.shells.iter().filter(|shell| ids.contains(&shell.id)) {
                has[shell.part as usize] = true;
            }
        }
        has
    }
}

/// Keeps of `may_be` what `speaks` names, unless that is nothing.
fn narrow(may_be: &mut [bool], speaks: &[bool]) {
    let both = |(may_be, speaks): (&bool, &bool)| *may_be && *speaks;
    if may_be.iter().zip(speaks).any(both) {
        for (may_be, speaks) in may_be.iter_mut().zip(speaks) {
            *may_be &= speaks;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::formats::{Memory, ReadOptions, Selection, read_from};
    use crate::monitor::Monitor;
    use std::path::Path;

    /// Three sheets one above the other, parts 1, 2 and 3, with these cards behind them.
    fn chosen(cards: &str) -> Vec<u32> {
        let mut deck = "*KEYWORD\n*NODE\n".to_owned();
        for z in 1..=3 {
            for (id, [x, y]) in [(1, [0, 0]), (2, [1, 0]), (3, [0, 1])] {
                deck += &format!("{},{x}.,{y}.,{z}.\n", 10 * z + id);
            }
        }
        deck += "*ELEMENT_SHELL\n";
        for part in 1..=3 {
            let n = 10 * part;
            deck += &format!("{part},{part},{},{},{},{}\n", n + 1, n + 2, n + 3, n + 3);
        }
        deck += cards;
        let source = Memory::new().with("deck.k", deck.into_bytes());
        let options = ReadOptions::default();
        let model = read_from(&source, Path::new("deck.k"), &options, &Monitor::silent()).unwrap();
        let surface = model.surface(&Selection::Sheet).unwrap();
        let ids = surface.triangle_part.iter();
        ids.map(|&part| model.parts[part as usize].id as u32)
            .collect()
    }

    const RIGID: &str = "*PART\ndie\n1,0,7\n*PART\npunch\n3,0,7\n*MAT_RIGID\n7,7.8e-9,2.1e5,.3\n";
    const RESULTS: &str = "*INITIAL_STRAIN_SHELL\n2,1,1\n.1,.0,-.1,0.,0.,0.,0.\n";

    #[test]
    fn of_a_file_that_tells_nothing_every_part_is_the_sheet() {
        assert_eq!(chosen(""), [1, 2, 3]);
    }

    #[test]
    fn rigid_parts_are_tools() {
        assert_eq!(chosen(RIGID), [2]);
    }

    #[test]
    fn parts_without_results_are_no_sheet_where_another_has_them() {
        assert_eq!(chosen(RESULTS), [2]);
    }

    #[test]
    fn parts_of_one_thickness_are_no_sheet_where_that_of_another_differs() {
        let shells = |second: &str| {
            let card = |id: u32, t: &str| format!("{id},{id},11,12,13,13\n{t}\n");
            let [die, punch] = [card(41, "1.,1.,1."), card(43, "1.,1.,1.")];
            let both = card(42, "1.,1.,1.") + &card(44, second).replace("44,44", "44,42");
            format!("*ELEMENT_SHELL_THICKNESS\n{die}{punch}{both}")
        };
        assert_eq!(chosen(&shells("1.,.97,1.")), [42, 42]);
        assert_eq!(chosen(&shells("1.,1.,1.")), [1, 2, 3, 41, 43, 42, 42]);
    }

    #[test]
    fn where_all_parts_are_rigid_none_is_a_tool() {
        let sheet = "*PART\nsheet\n2,0,7\n";
        assert_eq!(chosen(&format!("{RIGID}{sheet}")), [1, 2, 3]);
    }

    #[test]
    fn results_of_a_tool_do_not_make_it_the_sheet() {
        let of_die = RESULTS.replace("\n2,", "\n1,");
        assert_eq!(chosen(&format!("{RIGID}{of_die}")), [2]);
    }
}
