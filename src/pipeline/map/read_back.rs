//! What was written is read as the solver would read it and compared with what was mapped.

use super::PipelineError;
use super::compare::read_beside_nodes;
use super::freed_aside::FreedAside;
use super::old_states::read_copies;
use super::output::{MapFiles, MapWriter, WriteKind};
use crate::formats::Model;
use crate::geometry::chunks::CHUNK;
use crate::mapping::PLASTIC_STRAIN;
use crate::monitor::Cancelled;

/// Digits of a small card differ from the values by up to this share of the largest.
const SMALL_ROUNDING: f64 = 5.1e-4;
/// Digits of a large card differ from the values by up to this share.
const LARGE_ROUNDING: f64 = 1e-8;

impl MapWriter<'_> {
    /// Reads the states back and compares counts and values. `parameters` are decks that define what cards
    /// of elements may use.
    pub(super) fn read_back(
        &self,
        files: &MapFiles,
        kind: WriteKind,
        parameters: &[Vec<u8>],
    ) -> Result<f64, PipelineError> {
        let failed = |what: String| {
            let hint = match kind {
                WriteKind::Deck => {
                    "; if the deck turns the elements (*NODE_TRANSFORM), write an include (--write include)"
                }
                WriteKind::Include | WriteKind::Part => {
                    "; if cards of the elements use parameters that hold for their file alone (*PARAMETER_LOCAL), write \
                    a copy of the deck (--write deck)"
                }
            };
            PipelineError::MapOutput(format!(
                "the written state reads back differently: {what}{hint}"
            ))
        };
        let mut largest = 0.0_f64;
        let mut n_stress = 0;
        let mut n_strain = 0;
        let mut n_thickness = 0;
        let copies = read_copies(self.crash, &files.files, self.monitor)?;
        let copies = FreedAside::new(copies);
        let copied = copies.value().iter().map(|read| (read, true));
        let beside = files.files.iter().filter(|file| file.replaces.is_none());
        let beside =
            beside.map(|file| read_beside_nodes(self.model, parameters, &file.bytes, self.monitor));
        let beside: Vec<Model> = beside.collect::<Result<_, _>>()?;
        let beside = FreedAside::new(beside);
        let written = beside.value().iter().map(|read| (read, false));
        for (read, is_copy) in copied.chain(written) {
            n_stress += read.forming.n_stress();
            n_strain += read.forming.n_strain();
            largest = largest.max(self.stress_error(read)?);
            largest = largest.max(self.strain_error(read)?);
            // A copy without old states has the old thickness.
            if kind == WriteKind::Deck || !is_copy {
                let (n, error) = self.thickness_error(read)?;
                n_thickness += n;
                largest = largest.max(error);
            }
        }
        // A copy keeps the cards of other elements.
        let [other_stresses, other_strains] = match copies.value() {
            Some(_) => files.new_states.n_other_cards(self.model),
            None => [0; 2],
        };
        for (what, found, wanted) in [
            ("stress cards", n_stress, files.n_stress + other_stresses),
            ("strain cards", n_strain, files.n_strain + other_strains),
            ("thicknesses", n_thickness, files.n_thickness),
        ] {
            if found != wanted {
                return Err(failed(format!("{found} {what} instead of {wanted}")));
            }
        }
        let limit = if self.is_large {
            LARGE_ROUNDING
        } else {
            SMALL_ROUNDING
        };
        if largest > limit {
            return Err(failed(format!(
                "a value is off by {largest:.1e} of the largest"
            )));
        }
        Ok(largest)
    }

    /// Largest difference of a stress or plastic strain, relative to the largest of its kind.
    fn stress_error(&self, read: &Model) -> Result<f64, Cancelled> {
        let Some(states) = &self.run.mapped.states else {
            return Ok(0.0);
        };
        let element_of = self.elements_by_id()?;
        let (mut stress, mut plastic) = ([0.0_f64; 2], [0.0_f64; 2]);
        let (mut values, mut tensors) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (n_before, card) in read.forming.stresses().enumerate() {
            if n_before % CHUNK == 0 {
                self.monitor.check()?;
            }
            let Some(&element) = element_of.get(&card.element_id) else {
                continue;
            };
            let kept = self.state_of(element);
            if kept.states.is_empty() {
                // One of the crash deck's own, in a copy.
                continue;
            }
            let n_plane = card.n_plane.max(1);
            compare(
                &mut values,
                kept.history,
                card.n_history,
                n_plane,
                card.history,
            );
            let n_tensor = 6 * card.n_tensors;
            let read = card.tensors.as_flattened();
            compare(
                &mut tensors,
                kept.tensors.as_flattened(),
                n_tensor,
                n_plane,
                read,
            );
            let own = states.of(element);
            if own.len() != card.points.len() {
                stress[0] = f64::INFINITY;
            }
            for (own, point) in own.iter().zip(card.points) {
                for (a, b) in own[..6].iter().zip(point.stress) {
                    stress = [stress[0].max((a - b).abs()), stress[1].max(a.abs())];
                }
                let difference = (own[PLASTIC_STRAIN] - point.plastic_strain).abs();
                plastic = [
                    plastic[0].max(difference),
                    plastic[1].max(own[PLASTIC_STRAIN].abs()),
                ];
            }
        }
        let kinds = [stress, plastic, values, tensors].map(relative);
        Ok(kinds.into_iter().fold(0.0, f64::max))
    }

    /// Largest difference of a strain, relative to the largest.
    fn strain_error(&self, read: &Model) -> Result<f64, Cancelled> {
        if self.run.mapped.strains.is_none() {
            return Ok(0.0);
        }
        let element_of = self.elements_by_id()?;
        let mut strain = [0.0_f64; 2];
        for (n_before, card) in read.forming.strains().enumerate() {
            if n_before % CHUNK == 0 {
                self.monitor.check()?;
            }
            let own = element_of.get(&card.element_id);
            let own = own.map_or(&[][..], |&element| self.state_of(element).strains);
            if !own.is_empty() && own.len() != card.points.len() {
                strain[0] = f64::INFINITY;
            }
            for (own, point) in own.iter().zip(card.points) {
                compare(&mut strain, own, 6, 1, &point.strain);
            }
        }
        Ok(relative(strain))
    }

    /// How many of the thicknesses are read, and their largest difference, relative to the largest.
    fn thickness_error(&self, read: &Model) -> Result<(usize, f64), Cancelled> {
        let mut found = 0;
        let mut thickness = [0.0_f64; 2];
        for (n_before, extra) in read.shell_extras.iter().enumerate() {
            if n_before % CHUNK == 0 {
                self.monitor.check()?;
            }
            let id = read.shells[extra.shell as usize].id;
            if let Some(own) = self.thickness.get(&id) {
                found += 1;
                // The fourth corner of a triangle has no thickness of its own.
                let n = read.shells[extra.shell as usize].corners().len();
                compare(&mut thickness, &own[..n], n, 1, &extra.thickness[..n]);
            }
        }
        Ok((found, relative(thickness)))
    }
}

/// A largest difference as a share of the largest value.
fn relative([difference, size]: [f64; 2]) -> f64 {
    if size > 0.0 { difference / size } else { 0.0 }
}

/// Largest difference and largest value of what each layer has `n` of, against what was read for each
/// of its `n_plane` points. A wrong number of values is a difference without bound.
fn compare(largest: &mut [f64; 2], own: &[f64], n: usize, n_plane: usize, read: &[f64]) {
    if own.len() * n_plane != read.len() {
        largest[0] = f64::INFINITY;
        return;
    }
    let layers = own.chunks(n.max(1)).zip(read.chunks((n * n_plane).max(1)));
    for (own, points) in layers {
        for (a, b) in points
            .chunks(n.max(1))
            .flat_map(|point| own.iter().zip(point))
        {
            *largest = [largest[0].max((a - b).abs()), largest[1].max(a.abs())];
        }
    }
}
