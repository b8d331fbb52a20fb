//! What a deck says of its shell elements: formulation, layers, integration rule.

use std::collections::HashSet;

use super::Model;

/// Layers of a section whose card names none.
const LAYERS_BY_DEFAULT: u32 = 2;

/// The first card of `*SECTION_SHELL` beyond the id.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShellFormulation {
    /// Element formulation `ELFORM`; 0 where the card leaves it to `*CONTROL_SHELL`.
    pub elform: i64,
    /// Layers through the thickness, `NIP`; 2 where the card names none.
    pub n_layers: u32,
    /// Number of a rule of the user's (`QR/IRID` below 0), whose places the deck holds elsewhere.
    pub own_rule: Option<u64>,
    /// Equally spaced layers (`QR/IRID` 1) instead of those of `*CONTROL_SHELL`.
    pub is_trapezoidal: bool,
}

impl Default for ShellFormulation {
    fn default() -> Self {
        Self {
            elform: 0,
            n_layers: LAYERS_BY_DEFAULT,
            own_rule: None,
            is_trapezoidal: false,
        }
    }
}

impl ShellFormulation {
    /// From the fields `ELFORM`, `NIP` and `QR/IRID`.
    pub(crate) fn new(elform: i64, nip: f64, quadrature: f64) -> Self {
        let is_count = nip >= 1.0 && nip <= f64::from(u16::MAX);
        Self {
            elform,
            n_layers: if is_count {
                nip as u32
            } else {
                LAYERS_BY_DEFAULT
            },
            own_rule: (quadrature < 0.0).then_some(-quadrature as u64),
            is_trapezoidal: quadrature == 1.0,
        }
    }

    /// Integration points in the plane of a quad: four for the fully integrated formulations, else one.
    pub fn n_plane(self) -> u8 {
        match self.elform {
            6 | 7 | 16 | -16 | 18 | 20 | 21 | 26 => 4,
            _ => 1,
        }
    }
}

/// What `*CONTROL_SHELL` says of initial states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShellControl {
    /// Formulation of sections that name none (`THEORY`); 0 for the solver's default.
    pub elform: i64,
    /// Gauss–Lobatto layers (`INTGRD` 1) instead of Gauss layers.
    pub is_lobatto: bool,
    /// Part set whose initial stresses are read in element axes (`LISPSID`); 0 for none.
    pub element_axes_set: u64,
}

impl Model {
    /// Whether stresses of a part are read in element axes (`LISPSID`). A set that the deck does not define may hold
    /// any part.
    pub fn is_in_element_axes(&self, part: u64) -> bool {
        let set = self.shell_control.element_axes_set;
        let named = self.sets.parts.get(&set);
        set != 0 && named.is_none_or(|named| named.ids.contains(&part))
    }

    /// Ids of the shells whose stresses are read in element axes. O(shells).
    pub fn shells_in_element_axes(&self) -> HashSet<u64> {
        if self.shell_control.element_axes_set == 0 {
            return HashSet::new();
        }
        let parts = self.parts.iter();
        let is_meant: Vec<bool> = parts.map(|p| self.is_in_element_axes(p.id)).collect();
        let shells = self.shells.iter();
        let meant = shells.filter(|shell| is_meant[shell.part as usize]);
        meant.map(|shell| shell.id).collect()
    }

    /// The formulation of a part's shells, whose layers are its plies where it has some; `None` if its section
    /// is not in the deck. O(sections).
    pub fn shell_formulation(&self, part: u32) -> Option<ShellFormulation> {
        let part = self.parts.get(part as usize)?;
        let mut formulation = match &part.plies {
            Some(plies) => ShellFormulation::new(plies.elform, plies.thickness.len() as f64, 0.0),
            None => {
                let mut sections = self.sections.iter();
                sections
                    .find(|section| section.id == part.section_id)?
                    .formulation
            }
        };
        if formulation.elform == 0 {
            formulation.elform = self.shell_control.elform;
        }
        Some(formulation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blank_and_absurd_counts_are_the_default() {
        assert_eq!(ShellFormulation::new(16, 5.0, 0.0).n_layers, 5);
        assert_eq!(ShellFormulation::new(16, 0.0, 0.0).n_layers, 2);
        assert_eq!(ShellFormulation::new(2, -3.0, 0.0).n_layers, 2);
        assert_eq!(ShellFormulation::new(2, 1e9, -7.0).n_layers, 2);
        assert_eq!(ShellFormulation::new(2, 3.0, -7.0).own_rule, Some(7));
        assert!(ShellFormulation::new(2, 3.0, 1.0).is_trapezoidal);
        assert!(!ShellFormulation::new(2, 3.0, 0.0).is_trapezoidal);
        assert_eq!(ShellFormulation::new(16, 5.0, 0.0).n_plane(), 4);
        assert_eq!(ShellFormulation::new(26, 5.0, 0.0).n_plane(), 4);
        assert_eq!(ShellFormulation::new(2, 5.0, 0.0).n_plane(), 1);
    }
}
