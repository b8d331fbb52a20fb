//! Results of a forming simulation, as a dynain hands them over.

use crate::geometry::tensor::Tensor;

/// State of one integration point of a shell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StressPoint {
    /// Place through the thickness, −1 (inner) to +1 (outer).
    pub t: f64,
    /// Stress xx, yy, zz, xy, yz, zx in the global frame.
    pub stress: [f64; 6],
    /// Effective plastic strain.
    pub plastic_strain: f64,
}

impl StressPoint {
    /// Stress times `factor` and effective plastic strain, in one list.
    pub fn state(&self, factor: f64) -> [f64; 7] {
        let [xx, yy, zz, xy, yz, zx] = self.stress.map(|stress| stress * factor);
        [xx, yy, zz, xy, yz, zx, self.plastic_strain]
    }
}

/// Strain at one point of a shell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StrainPoint {
    /// Place through the thickness, −1 (inner) to +1 (outer).
    pub t: f64,
    /// Strain xx, yy, zz, xy, yz, zx in the global frame.
    pub strain: [f64; 6],
}

/// Where the stresses of one shell are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct StressRecord {
    element_id: u64,
    first_point: usize,
    n_points: u32,
    n_plane: u32,
    first_history: usize,
    n_history: u32,
    first_tensor: usize,
    n_tensors: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct StrainRecord {
    element_id: u64,
    first_point: usize,
    n_points: u32,
    n_plane: u32,
}

/// The stresses of one shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellStress<'a> {
    /// Id of the shell.
    pub element_id: u64,
    /// Integration points in the plane of each layer.
    pub n_plane: usize,
    /// All points, in the order of the file.
    pub points: &'a [StressPoint],
    /// History variables, `n_history` for each point in turn.
    pub history: &'a [f64],
    /// History variables per point.
    pub n_history: usize,
    /// Tensors that the material keeps among its history and the file names as such (`NTENSR`), in
    /// the global frame, `n_tensors` for each point in turn.
    pub tensors: &'a [Tensor],
    /// Tensors per point.
    pub n_tensors: usize,
}

impl<'a> ShellStress<'a> {
    /// History variables of a point.
    pub fn history_of(&self, point: usize) -> &'a [f64] {
        &self.history[point * self.n_history..][..self.n_history]
    }

    /// Tensors of a point.
    pub fn tensors_of(&self, point: usize) -> &'a [Tensor] {
        &self.tensors[point * self.n_tensors..][..self.n_tensors]
    }
}

/// The strains of one shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellStrain<'a> {
    /// Id of the shell.
    pub element_id: u64,
    /// Integration points in the plane of each layer.
    pub n_plane: usize,
    /// All points, in the order of the file.
    pub points: &'a [StrainPoint],
}

/// Elements other than shells that carry results. These are counted, their values are not kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OtherResults {
    /// Solids with stresses.
    pub solid_stress: usize,
    /// Solids with strains.
    pub solid_strain: usize,
    /// Thick shells with stresses.
    pub thick_shell_stress: usize,
    /// Thick shells with strains.
    pub thick_shell_strain: usize,
}

impl OtherResults {
    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Forming results of the shells, in the order of the file and stored without gaps.
///
/// The corner thickness of the elements is in [`Model::shell_extras`](super::Model::shell_extras).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Forming {
    /// What other elements have.
    pub others: OtherResults,
    stress: Vec<StressRecord>,
    stress_points: Vec<StressPoint>,
    history: Vec<f64>,
    tensors: Vec<Tensor>,
    strain: Vec<StrainRecord>,
    strain_points: Vec<StrainPoint>,
}

impl Forming {
    /// Adds the stresses of one shell. `history` holds the same number of values for each point, and `tensors` the
    /// same number of tensors; `None`, and nothing added, if they do not.
    pub fn add_state(
        &mut self,
        element_id: u64,
        n_plane: usize,
        points: &[StressPoint],
        history: &[f64],
        tensors: &[Tensor],
    ) -> Option<()> {
        let n_history = history.len().checked_div(points.len()).unwrap_or(0);
        let n_tensors = tensors.len().checked_div(points.len()).unwrap_or(0);
        if n_history * points.len() != history.len() || n_tensors * points.len() != tensors.len() {
            return None;
        }
        self.stress.push(StressRecord {
            element_id,
            first_point: self.stress_points.len(),
            n_points: u32::try_from(points.len()).ok()?,
            n_plane: u32::try_from(n_plane).ok()?,
            first_history: self.history.len(),
            n_history: u32::try_from(n_history).ok()?,
            first_tensor: self.tensors.len(),
            n_tensors: u32::try_from(n_tensors).ok()?,
        });
        self.stress_points.extend_from_slice(points);
        self.history.extend_from_slice(history);
        self.tensors.extend_from_slice(tensors);
        Some(())
    }

    /// Adds the strains of one shell.
    pub fn add_strain(&mut self, element_id: u64, n_plane: usize, points: &[StrainPoint]) {
        self.strain.push(StrainRecord {
            element_id,
            first_point: self.strain_points.len(),
            n_points: points.len() as u32,
            n_plane: n_plane as u32,
        });
        self.strain_points.extend_from_slice(points);
    }

    /// Number of shells with stresses.
    pub fn n_stress(&self) -> usize {
        self.stress.len()
    }

    /// Number of shells with strains.
    pub fn n_strain(&self) -> usize {
        self.strain.len()
    }

    /// The stresses of the `index`-th shell that has any.
    pub fn stress(&self, index: usize) -> ShellStress<'_> {
        let record = &self.stress[index];
        let n_points = record.n_points as usize;
        let n_history = record.n_history as usize;
        let n_tensors = record.n_tensors as usize;
        ShellStress {
            element_id: record.element_id,
            n_plane: record.n_plane as usize,
            points: &self.stress_points[record.first_point..][..n_points],
            history: &self.history[record.first_history..][..n_points * n_history],
            n_history,
            tensors: &self.tensors[record.first_tensor..][..n_points * n_tensors],
            n_tensors,
        }
    }

    /// The strains of the `index`-th shell that has any.
    pub fn strain(&self, index: usize) -> ShellStrain<'_> {
        let record = &self.strain[index];
        ShellStrain {
            element_id: record.element_id,
            n_plane: record.n_plane as usize,
            points: &self.strain_points[record.first_point..][..record.n_points as usize],
        }
    }

    /// The points of the `index`-th shell with stresses, to be turned or scaled.
    pub fn stress_points_mut(&mut self, index: usize) -> &mut [StressPoint] {
        let record = &self.stress[index];
        &mut self.stress_points[record.first_point..][..record.n_points as usize]
    }

    /// The history variables of the `index`-th shell with stresses.
    pub(crate) fn history_mut(&mut self, index: usize) -> &mut [f64] {
        let record = &self.stress[index];
        let n = record.n_points as usize * record.n_history as usize;
        &mut self.history[record.first_history..][..n]
    }

    /// The tensors of the `index`-th shell with stresses, to be turned.
    pub fn tensors_mut(&mut self, index: usize) -> &mut [Tensor] {
        let record = &self.stress[index];
        let n = record.n_points as usize * record.n_tensors as usize;
        &mut self.tensors[record.first_tensor..][..n]
    }

    /// The points of the `index`-th shell with strains, to be turned.
    pub fn strain_points_mut(&mut self, index: usize) -> &mut [StrainPoint] {
        let record = &self.strain[index];
        &mut self.strain_points[record.first_point..][..record.n_points as usize]
    }

    /// All stresses in the order of the file.
    pub fn stresses(&self) -> impl ExactSizeIterator<Item = ShellStress<'_>> {
        (0..self.n_stress()).map(|index| self.stress(index))
    }

    /// All strains in the order of the file.
    pub fn strains(&self) -> impl ExactSizeIterator<Item = ShellStrain<'_>> {
        (0..self.n_strain()).map(|index| self.strain(index))
    }

    /// True if no shell has stresses or strains; other elements may have.
    pub fn is_empty(&self) -> bool {
        self.stress.is_empty() && self.strain.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_back_as_they_went_in() {
        let mut forming = Forming::default();
        let points = [StressPoint {
            t: -0.5,
            stress: [1.0; 6],
            plastic_strain: 0.1,
        }; 3];
        forming
            .add_state(7, 1, &points, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &[])
            .unwrap();
        forming.add_state(8, 1, &points[..1], &[], &[]).unwrap();
        assert_eq!(forming.add_state(9, 1, &points, &[1.0, 2.0], &[]), None);
        forming.add_strain(8, 1, &[StrainPoint::default(); 2]);
        assert_eq!(forming.n_stress(), 2);
        assert_eq!(forming.stress(0).history, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(forming.stress(0).n_history, 2);
        assert_eq!(forming.stress(1).points.len(), 1);
        assert_eq!(forming.strains().next().unwrap().element_id, 8);
    }
}
