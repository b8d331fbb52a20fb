//! Forming results when the whole deck is read: what was given to sets goes to their shells, and
//! tensors are turned with the motions that includes and `*NODE_TRANSFORM` bring.

use std::collections::HashSet;
use std::ops::Range;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{Forming, IdIndex, Model};
use super::super::moved::{along_other_way, reverse_points};
use super::forming::RawForming;
use super::resolve::with_position;
use super::source_file::Place;
use crate::geometry::tensor::rotated;
use crate::geometry::{Matrix3, Matrix4};

/// Two lengths that differ by more than this share of themselves are stretched differently. Cards
/// of ten columns round directions to about 1e-7.
const UNEQUAL: f64 = 1e-4;

/// How many results of each kind there were at some moment of the reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct FormingCount {
    stress: usize,
    strain: usize,
    set_stress: usize,
    set_strain: usize,
}

impl FormingCount {
    pub(crate) fn of(forming: &RawForming) -> Self {
        Self {
            stress: forming.of_shells.n_stress(),
            strain: forming.of_shells.n_strain(),
            set_stress: forming.of_sets.n_stress(),
            set_strain: forming.of_sets.n_strain(),
        }
    }
}

/// What became of the tensors under one motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Turned {
    /// Tensors' elements that were turned by a motion that stretches unequally.
    n_stretched: usize,
    /// Elements of which some nodes were moved and some not.
    n_partly: usize,
    /// Elements flattened by a motion that has no rotation.
    n_flattened: usize,
}

impl Turned {
    /// What cannot be right, in words.
    pub(super) fn complaints(self, transformation: u64) -> Vec<String> {
        let results = |n: usize| match n {
            1 => "1 forming result".to_owned(),
            n => format!("{n} forming results"),
        };
        let mut all = Vec::new();
        if self.n_stretched > 0 {
            let n = results(self.n_stretched);
            all.push(format!(
                "transformation {transformation} stretches unequally; {n} turned by its rotation only"
            ));
        }
        if self.n_flattened > 0 {
            let n = results(self.n_flattened);
            all.push(format!(
                "transformation {transformation} flattens space; {n} left as in the file"
            ));
        }
        if self.n_partly > 0 {
            let n = results(self.n_partly);
            all.push(format!(
                "transformation {transformation} moves some corners of a shell and not all; {n} left as in the file"
            ));
        }
        all
    }
}

fn ids_of_shells(model: &Model) -> HashSet<u64> {
    model.shells.iter().map(|shell| shell.id).collect()
}

/// The results of all shells, each with its place in the reading.
pub(super) struct Results {
    forming: Forming,
    n_own_stress: usize,
    n_own_strain: usize,
    /// Where the results of single shells begin.
    stress_places: Vec<Place>,
    strain_places: Vec<Place>,
    /// For what came from a set: its index among the results of sets.
    stress_source: Vec<usize>,
    strain_source: Vec<usize>,
    /// From element id to shell, made when it is needed.
    shell_of: Option<IdIndex>,
    /// The shells whose stresses are in element axes and turn with them.
    in_element_axes: HashSet<u64>,
}

impl Results {
    /// Gives the results of sets to those of their shells that have none of their own. Of several
    /// sets with the same shell the first counts.
    pub(super) fn new(raw: RawForming, model: &Model, found: &mut Diagnostics) -> Self {
        let mut forming = raw.of_shells;
        let (n_own_stress, n_own_strain) = (forming.n_stress(), forming.n_strain());
        let (mut stress_source, mut strain_source) = (Vec::new(), Vec::new());
        let mut members = |set: u64, place: &Place| {
            let ids = model.sets.shells.get(&set).map(|set| set.ids.as_slice());
            if ids.is_none() {
                let kind = DiagnosticKind::BadSet;
                let message = format!("forming results name shell set {set}, which is not defined");
                found.push_with(kind, || Diagnostic::new(kind, message).at(place.position()));
            }
            ids.unwrap_or_default()
        };
        let of_sets = &raw.of_sets;
        let shells = (!of_sets.is_empty()).then(|| ids_of_shells(model));
        // A range of ids usually has gaps. A deck without shells has results for those of another.
        let is_there = |id: u64| {
            let shells = shells.as_ref().filter(|shells| !shells.is_empty());
            shells.is_none_or(|shells| shells.contains(&id))
        };
        if of_sets.n_stress() > 0 {
            let mut known: HashSet<u64> = forming.stresses().map(|s| s.element_id).collect();
            for (index, of_set) in of_sets.stresses().enumerate() {
                let ids = members(of_set.element_id, &raw.stress_places[index]).iter();
                for &id in ids.filter(|&&id| is_there(id) && known.insert(id)) {
                    forming
                        .add_state(
                            id,
                            of_set.n_plane,
                            of_set.points,
                            of_set.history,
                            of_set.tensors,
                        )
                        .expect("history has as many values for each point as in the set's");
                    stress_source.push(index);
                }
            }
        }
        if of_sets.n_strain() > 0 {
            let mut known: HashSet<u64> = forming.strains().map(|s| s.element_id).collect();
            for (index, of_set) in of_sets.strains().enumerate() {
                let ids = members(of_set.element_id, &raw.strain_places[index]).iter();
                for &id in ids.filter(|&&id| is_there(id) && known.insert(id)) {
                    forming.add_strain(id, of_set.n_plane, of_set.points);
                    strain_source.push(index);
                }
            }
        }
        Self {
            forming,
            n_own_stress,
            n_own_strain,
            stress_places: raw.shell_stress_places,
            strain_places: raw.shell_strain_places,
            stress_source,
            strain_source,
            shell_of: None,
            in_element_axes: model.shells_in_element_axes(),
        }
    }

    /// Names results of shells that are not there, and further results of a shell. A deck without shells has
    /// results for those of another.
    pub(super) fn tell_doubtful(&self, model: &Model, found: &mut Diagnostics) {
        if self.forming.is_empty() || model.shells.is_empty() {
            return;
        }
        let ids: Vec<u64> = model.shells.iter().map(|shell| shell.id).collect();
        let (shell_of, _) = IdIndex::new(&ids);
        let stresses = self.forming.stresses().map(|stress| stress.element_id);
        let strains = self.forming.strains().map(|strain| strain.element_id);
        let (of_stresses, of_strains) = (&self.stress_places, &self.strain_places);
        tell_doubtful(stresses, ("stresses", of_stresses), &shell_of, found);
        tell_doubtful(strains, ("strains", of_strains), &shell_of, found);
    }

    pub(super) fn finish(self) -> Forming {
        self.forming
    }

    /// Turns what was read between two moments, for shells whose corners a mirror reverses.
    pub(super) fn turn_span(&mut self, span: &Range<FormingCount>, motion: &Matrix4) -> Turned {
        let (from, to) = (span.start, span.end);
        let of_sets = |source: &[usize], n_own: usize, range: Range<usize>| {
            let chosen = source.iter().enumerate();
            let chosen = chosen.filter(move |(_, index)| range.contains(index));
            chosen.map(|(i, _)| n_own + i).collect::<Vec<usize>>()
        };
        let set_stress = from.set_stress..to.set_stress;
        let set_strain = from.set_strain..to.set_strain;
        let mut stress: Vec<usize> = (from.stress..to.stress).collect();
        stress.extend(of_sets(&self.stress_source, self.n_own_stress, set_stress));
        let mut strain: Vec<usize> = (from.strain..to.strain).collect();
        strain.extend(of_sets(&self.strain_source, self.n_own_strain, set_strain));
        let is_mirror = mirrors(motion);
        let turned = self.turn(&stress, &strain, (motion, is_mirror));
        if is_mirror {
            reverse_points(&mut self.forming, stress, strain);
        }
        turned
    }

    /// Turns the results of shells whose corners are all among the moved nodes.
    pub(super) fn turn_moved(
        &mut self,
        model: &Model,
        nodes: &[usize],
        motion: &Matrix4,
    ) -> Turned {
        if self.forming.is_empty() {
            return Turned::default();
        }
        let shell_of = self.shell_of.take().unwrap_or_else(|| {
            let ids: Vec<u64> = model.shells.iter().map(|shell| shell.id).collect();
            IdIndex::new(&ids).0
        });
        let mut is_moved = vec![false; model.nodes.len()];
        nodes.iter().for_each(|&node| is_moved[node] = true);
        let mut n_partly = 0;
        let mut is_turned = |id: u64| {
            let Some(shell) = shell_of.get(id) else {
                return false;
            };
            let corners = model.shells[shell as usize].corners();
            let n = corners.iter().filter(|&&c| is_moved[c as usize]).count();
            n_partly += usize::from(n > 0 && n < corners.len());
            n == corners.len()
        };
        let chosen = |all: Vec<u64>, is_turned: &mut dyn FnMut(u64) -> bool| -> Vec<usize> {
            let ids = all.into_iter().enumerate();
            ids.filter(|&(_, id)| is_turned(id))
                .map(|(i, _)| i)
                .collect()
        };
        let stress_ids = self.forming.stresses().map(|s| s.element_id).collect();
        let stress = chosen(stress_ids, &mut is_turned);
        let strain_ids = self.forming.strains().map(|s| s.element_id).collect();
        let strain = chosen(strain_ids, &mut is_turned);
        self.shell_of = Some(shell_of);
        Turned {
            n_partly,
            ..self.turn(&stress, &strain, (motion, false))
        }
    }

    /// Turns tensors. Those in element axes turn with their elements, and change only where the motion
    /// reverses the corners of these.
    fn turn(
        &mut self,
        stress: &[usize],
        strain: &[usize],
        (motion, reverses): (&Matrix4, bool),
    ) -> Turned {
        let n = stress.len() + strain.len();
        let (rotation, n_stretched) = match rotation_of(motion) {
            Rotation::None => return Turned::default(),
            Rotation::Flat => {
                return Turned {
                    n_flattened: n,
                    ..Turned::default()
                };
            }
            Rotation::Rigid(rotation) => (rotation, 0),
            Rotation::Stretched(rotation) => (rotation, n),
        };
        for &index in stress {
            let id = self.forming.stress(index).element_id;
            let is_global = !self.in_element_axes.contains(&id);
            let turned = |tensor: &[f64; 6]| match (is_global, reverses) {
                (true, _) => rotated(tensor, &rotation),
                (false, true) => along_other_way(tensor),
                (false, false) => *tensor,
            };
            for point in self.forming.stress_points_mut(index) {
                point.stress = turned(&point.stress);
            }
            for tensor in self.forming.tensors_mut(index) {
                *tensor = turned(tensor);
            }
        }
        for &index in strain {
            for point in self.forming.strain_points_mut(index) {
                point.strain = rotated(&point.strain, &rotation);
            }
        }
        Turned {
            n_stretched,
            ..Turned::default()
        }
    }
}

fn tell_doubtful(
    ids: impl Iterator<Item = u64>,
    (what, places): (&str, &[Place]),
    shell_of: &IdIndex,
    found: &mut Diagnostics,
) {
    let mut known = HashSet::new();
    for (index, id) in ids.enumerate() {
        let why = if shell_of.get(id).is_none() {
            "and is not defined"
        } else if !known.insert(id) {
            "more than once, the last count when they are mapped"
        } else {
            continue;
        };
        let kind = DiagnosticKind::DoubtfulForming;
        found.push_with(kind, || {
            let finding = Diagnostic::new(kind, format!("shell {id} has {what} {why}"));
            let position = places.get(index).map(Place::position);
            with_position(finding, position)
        });
    }
}

/// True if a motion turns right hands into left ones.
pub(super) fn mirrors(motion: &Matrix4) -> bool {
    motion.fixed_view::<3, 3>(0, 0).determinant() < 0.0
}

/// The rotation by which a motion turns tensors.
pub(super) fn turn_of(motion: &Matrix4) -> Matrix3 {
    match rotation_of(motion) {
        Rotation::Rigid(rotation) | Rotation::Stretched(rotation) => rotation,
        Rotation::None | Rotation::Flat => Matrix3::identity(),
    }
}

/// What a motion does to directions.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rotation {
    /// Only moves and scales, without a mirror.
    None,
    /// Turns or mirrors, with the same scale everywhere.
    Rigid(Matrix3),
    /// Scales differently in different directions; this is the rotation nearest to it.
    Stretched(Matrix3),
    /// Maps space onto a plane, a line or a point.
    Flat,
}

/// The orthogonal factor of the motion's linear part (polar decomposition), proper or mirrored.
fn rotation_of(motion: &Matrix4) -> Rotation {
    let linear: Matrix3 = motion.fixed_view::<3, 3>(0, 0).into_owned();
    if linear == Matrix3::identity() * linear[(0, 0)] && linear[(0, 0)] > 0.0 {
        return Rotation::None;
    }
    let svd = linear.svd(true, true);
    let (largest, smallest) = (svd.singular_values.max(), svd.singular_values.min());
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Rotation::Flat;
    };
    if smallest <= 1e-12 * largest {
        return Rotation::Flat;
    }
    let rotation = u * v_t;
    if largest > smallest * (1.0 + UNEQUAL) {
        Rotation::Stretched(rotation)
    } else {
        Rotation::Rigid(rotation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;

    #[test]
    fn the_rotation_of_a_motion_is_proper_or_mirrored() {
        let turn = nalgebra::Rotation3::new(Vector3::new(0.3, -1.2, 0.7));
        let with = |linear: Matrix3| {
            let mut motion = Matrix4::new_translation(&Vector3::new(1.0, 2.0, 3.0));
            motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&linear);
            rotation_of(&motion)
        };
        let near = |found: Rotation, expected: Matrix3| match found {
            Rotation::Rigid(found) => assert!((found - expected).norm() < 1e-12),
            other => panic!("{other:?}"),
        };
        near(with(turn.matrix() * 25.4), *turn.matrix());
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        near(with(turn.matrix() * mirror), turn.matrix() * mirror);
        assert_eq!(with(Matrix3::identity() * 3.0), Rotation::None);
        let stretch = Matrix3::from_diagonal(&Vector3::new(1.0, 1.5, 1.0));
        match with(turn.matrix() * stretch) {
            Rotation::Stretched(found) => assert!((found - turn.matrix()).norm() < 1e-12),
            other => panic!("{other:?}"),
        }
        let flat = Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 1.0));
        assert_eq!(with(flat), Rotation::Flat);
        assert_eq!(with(Matrix3::zeros()), Rotation::Flat);
    }
}
