//! A model at another pose: nodes moved, tensors turned, corners renumbered under a mirror.

use std::ops::Range;

use super::model::{Forming, Model, Part, ShellExtra, Solid};
use crate::geometry::Similarity;
use crate::geometry::tensor::rotated;

/// The model under `motion`: nodes moved, stress and strain tensors turned with them (they are in
/// the global frame, but for stresses in element axes, which turn with the elements). Of its scale `length_factor` is
/// that between units, by which thicknesses are multiplied too; the scale of a pose moves places and no thickness.
/// Ids stay. Nodes whose id is repeated are moved like all others. History variables are kept as they are;
/// the tensors among them that the file names as such (`NTENSR`) are turned. Density and modulus of
/// materials are not known in another unit. O(model).
///
/// Under a mirror the corners of shells and solids change to the order 2 1 4 3, and with them
/// corner thicknesses, mid-side nodes and integration points in the plane. The mirrored sheet then
/// has the same material on the side of its normal as before, so places through the thickness keep
/// their sign, and the first edge is the same one, so material angles only change theirs. Different corner
/// thicknesses of a section become those of its shells.
pub fn moved(model: &Model, motion: &Similarity, length_factor: f64) -> Model {
    let mut result = model.clone();
    for position in result.nodes.positions_mut() {
        *position = motion.apply(position);
    }
    for extra in &mut result.shell_extras {
        extra.thickness = extra.thickness.map(|t| t * length_factor);
    }
    for ply in result.ply_stacks.iter_mut().flatten() {
        *ply *= length_factor;
    }
    for part in &mut result.parts {
        part.thickness = part.thickness.map(|own| own.map(|t| t * length_factor));
        if let Some(plies) = &mut part.plies {
            plies.thickness.iter_mut().for_each(|t| *t *= length_factor);
        }
    }
    for section in &mut result.sections {
        section.thickness = section.thickness.map(|t| t * length_factor);
    }
    // In the new unit of lengths they are other numbers, which masses and times decide.
    if length_factor != 1.0 {
        for material in &mut result.materials {
            (material.density, material.modulus) = (0.0, 0.0);
        }
    }
    turn(&mut result, motion);
    if motion.is_mirrored() {
        reverse(&mut result);
    }
    result
}

fn turn(model: &mut Model, motion: &Similarity) {
    let in_element_axes = model.shells_in_element_axes();
    let (forming, rotation) = (&mut model.forming, &motion.rotation);
    for index in 0..forming.n_stress() {
        let is_turned = !in_element_axes.contains(&forming.stress(index).element_id);
        let turned = |tensor: &[f64; 6]| {
            if is_turned {
                rotated(tensor, rotation)
            } else if motion.is_mirrored() {
                along_other_way(tensor)
            } else {
                *tensor
            }
        };
        for point in forming.stress_points_mut(index) {
            point.stress = turned(&point.stress);
        }
        for tensor in forming.tensors_mut(index) {
            *tensor = turned(tensor);
        }
    }
    for index in 0..forming.n_strain() {
        for point in forming.strain_points_mut(index) {
            point.strain = rotated(&point.strain, rotation);
        }
    }
}

/// A tensor in element axes once the mirrored element has the order 2 1 4 3: its first axis, along the first edge,
/// points the other way, the normal and the axis between both do not.
pub(super) fn along_other_way([xx, yy, zz, xy, yz, zx]: &[f64; 6]) -> [f64; 6] {
    [*xx, *yy, *zz, -xy, *yz, -zx]
}

/// Reverses the order of corners and all that goes with them.
fn reverse(model: &mut Model) {
    reverse_elements(model, 0..model.shells.len(), 0..model.solids.len());
    let forming = &mut model.forming;
    reverse_points(forming, 0..forming.n_stress(), 0..forming.n_strain());
}

/// What belongs to the corners of a shell in the order 2 1 4 3. Done twice it is as before.
pub(super) fn reversed_corners<T: Copy>([a, b, c, d]: [T; 4], is_triangle: bool) -> [T; 4] {
    if is_triangle {
        [b, a, c, d]
    } else {
        [b, a, d, c]
    }
}

/// Reverses the order of the corners of some shells and solids, and what each of them has at its corners.
pub(super) fn reverse_elements(model: &mut Model, shells: Range<usize>, solids: Range<usize>) {
    make_thickness_own(model, shells.clone());
    let is_own = |shell: u32| shells.contains(&(shell as usize));
    for shell in &mut model.shells[shells.clone()] {
        shell.nodes = reversed_corners(shell.nodes, shell.is_triangle());
    }
    for extra in model.shell_extras.iter_mut().filter(|e| is_own(e.shell)) {
        let is_triangle = model.shells[extra.shell as usize].is_triangle();
        extra.thickness = reversed_corners(extra.thickness, is_triangle);
        extra.beta = 0.0 - extra.beta;
    }
    for (shell, nodes) in model
        .mid_side
        .iter_mut()
        .filter(|(shell, _)| is_own(*shell))
    {
        let [of_first, of_second, of_third, of_fourth] = *nodes;
        *nodes = if !model.shells[*shell as usize].is_triangle() {
            [of_first, of_fourth, of_third, of_second]
        } else if of_fourth == of_third {
            [of_first, of_third, of_second, of_second]
        } else {
            [of_first, of_third, of_second, of_fourth]
        };
    }
    for solid in &mut model.solids[solids] {
        solid.nodes = reversed_solid(solid);
    }
}

/// Gives shells that take different corner thicknesses from their part these as their own: the part's are in the
/// order of corners that are not reversed.
fn make_thickness_own(model: &mut Model, shells: Range<usize>) {
    let is_uneven = |part: &Part| {
        let corners = part.thickness.unwrap_or_default();
        corners.iter().any(|t| *t != corners[0])
    };
    let is_uneven: Vec<bool> = model.parts.iter().map(is_uneven).collect();
    if !is_uneven.contains(&true) {
        return;
    }
    let mut made: Vec<ShellExtra> = Vec::new();
    for index in shells {
        let (shell, number) = (&model.shells[index], index as u32);
        let own = model.shell_extra(number).copied().unwrap_or(ShellExtra {
            shell: number,
            thickness: [0.0; 4],
            beta: 0.0,
            plies: None,
        });
        let takes_any = own.thickness[..shell.corners().len()].contains(&0.0);
        if takes_any && is_uneven[shell.part as usize] {
            let thickness = model.shell_thickness(number).unwrap_or(own.thickness);
            made.push(ShellExtra { thickness, ..own });
        }
    }
    let is_made = |shell: u32| made.binary_search_by_key(&shell, |e| e.shell).is_ok();
    model.shell_extras.retain(|extra| !is_made(extra.shell));
    model.shell_extras.extend(made);
    model.shell_extras.sort_unstable_by_key(|extra| extra.shell);
}

/// Both faces reversed; a tetrahedron whose top is one node stays written as one.
fn reversed_solid(solid: &Solid) -> [u32; 8] {
    let [a, b, c, d, e, f, g, h] = solid.nodes;
    if [e, f, g, h] == [d; 4] {
        [b, a, c, d, d, d, d, d]
    } else {
        [b, a, d, c, f, e, h, g]
    }
}

/// Brings the points in the plane of some results, three or four for each layer, into the order of the
/// reversed corners. Each is given by its number among the stresses or strains.
pub(super) fn reverse_points(
    forming: &mut Forming,
    stresses: impl IntoIterator<Item = usize>,
    strains: impl IntoIterator<Item = usize>,
) {
    for index in stresses {
        let shell = forming.stress(index);
        let (n_history, n_tensors) = (shell.n_history, shell.n_tensors);
        for [a, b] in exchanged(shell.n_plane, shell.points, |point| point.t) {
            forming.stress_points_mut(index).swap(a, b);
            swap_runs(forming.history_mut(index), n_history, a, b);
            swap_runs(forming.tensors_mut(index), n_tensors, a, b);
        }
    }
    for index in strains {
        let shell = forming.strain(index);
        for [a, b] in exchanged(shell.n_plane, shell.points, |point| point.t) {
            forming.strain_points_mut(index).swap(a, b);
        }
    }
}

/// Exchanges what points `a` < `b` have, `n` values each.
fn swap_runs<T>(values: &mut [T], n: usize, a: usize, b: usize) {
    let (before, after) = values.split_at_mut(n * b);
    before[n * a..][..n].swap_with_slice(&mut after[..n]);
}

/// The pairs of points that change places. None do unless each run of `n_plane` is a layer.
fn exchanged<T>(n_plane: usize, points: &[T], t: impl Fn(&T) -> f64) -> Vec<[usize; 2]> {
    let is_layer =
        |layer: &[T]| layer.len() == n_plane && layer.iter().all(|p| t(p) == t(&layer[0]));
    if !matches!(n_plane, 3 | 4) || !points.chunks(n_plane).all(is_layer) {
        return Vec::new();
    }
    let of_layer = |first| [[first, first + 1], [first + 2, first + 3]];
    let firsts = (0..points.len()).step_by(n_plane);
    firsts
        .flat_map(|first| of_layer(first).into_iter().take(n_plane - 2))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::model::{SolidKind, StressPoint};
    use super::*;
    use crate::geometry::{Point3, Pose, TriMesh, Vector3};

    #[test]
    fn nodes_move_and_tensors_turn() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = TriMesh::new(corners.map(Point3::from).to_vec(), vec![[0, 1, 2]]).unwrap();
        let mut model = Model::from_mesh(&mesh, "sheet");
        model.parts[0].thickness = Some([2.0; 4]);
        let point = StressPoint {
            t: 0.0,
            stress: [5.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            plastic_strain: 0.5,
        };
        model
            .forming
            .add_state(1, 1, &[point], &[9.0], &[])
            .unwrap();
        let quarter = Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2);
        let motion = Similarity {
            scale: 10.0,
            ..Pose::new(Vector3::new(0.0, 0.0, 7.0), quarter).into()
        };
        let result = moved(&model, &motion, 10.0);
        assert_eq!(result.nodes.ids(), model.nodes.ids());
        let second = result.nodes.position_of(2).unwrap();
        assert!((second - Point3::new(0.0, 10.0, 7.0)).norm() < 1e-12);
        assert_eq!(result.parts[0].thickness, Some([20.0; 4]));
        // Tension along x becomes tension along y; shear xy changes its sign.
        let shell = result.forming.stress(0);
        let expected = [0.0, 5.0, 0.0, -1.0, 0.0, 0.0];
        for (found, expected) in shell.points[0].stress.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12);
        }
        assert_eq!(shell.history, [9.0]);
        let back = moved(&result, &motion.inverse(), 0.1);
        let third = back.nodes.position_of(3).unwrap();
        assert!((third - mesh.positions()[2]).norm() < 1e-12);
    }

    #[test]
    fn tetrahedra_and_wedges_stay_what_they_are() {
        let reversed = |nodes| {
            let solid = Solid {
                id: 1,
                nodes,
                part: 0,
                kind: SolidKind::Solid,
            };
            reversed_solid(&solid)
        };
        assert_eq!(reversed([0, 1, 2, 3, 3, 3, 3, 3]), [1, 0, 2, 3, 3, 3, 3, 3]);
        assert_eq!(reversed([0, 1, 2, 3, 4, 4, 5, 5]), [1, 0, 3, 2, 4, 4, 5, 5]);
        assert_eq!(reversed([0, 1, 2, 2, 3, 4, 5, 5]), [1, 0, 2, 2, 4, 3, 5, 5]);
    }
}
