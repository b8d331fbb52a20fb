//! A model at another pose: nodes moved, tensors turned, corners renumbered under a mirror.

use super::model::{Forming, Model, Solid, StrainPoint, StressPoint};
use crate::geometry::tensor::{Tensor, rotated};
use crate::geometry::{Matrix3, Similarity};

/// Which old corner each corner of a mirrored quad is: the first edge stays, reversed.
const REVERSED: [usize; 4] = [1, 0, 3, 2];

/// The model under `motion`: nodes moved, stress and strain tensors turned with them (they are in
/// the global frame), thicknesses scaled. Ids stay. Nodes whose id is repeated are moved like all
/// others. History variables are kept as they are; the tensors among them that the file names as such
/// (`NTENSR`) are turned. O(model).
///
/// Under a mirror the corners of shells and solids change to the order 2 1 4 3, and with them
/// corner thicknesses, mid-side nodes and integration points in the plane. The mirrored sheet then
/// has the same material on the side of its normal as before, so places through the thickness keep
/// their sign, and the first edge is the same one, so material angles only change theirs. Corner
/// thicknesses of parts and sections are exchanged as those of quads.
pub fn moved(model: &Model, motion: &Similarity) -> Model {
    let mut result = model.clone();
    for position in result.nodes.positions_mut() {
        *position = motion.apply(position);
    }
    for extra in &mut result.shell_extras {
        extra.thickness = extra.thickness.map(|t| t * motion.scale);
    }
    for part in &mut result.parts {
        part.thickness = part.thickness.map(|own| own.map(|t| t * motion.scale));
    }
    for section in &mut result.sections {
        section.thickness = section.thickness.map(|t| t * motion.scale);
    }
    turn(&mut result.forming, &motion.rotation);
    if motion.is_mirrored() {
        reverse(&mut result);
    }
    result
}

fn turn(forming: &mut Forming, rotation: &Matrix3) {
    for index in 0..forming.n_stress() {
        for point in forming.stress_points_mut(index) {
            point.stress = rotated(&point.stress, rotation);
        }
        for tensor in forming.tensors_mut(index) {
            *tensor = rotated(tensor, rotation);
        }
    }
    for index in 0..forming.n_strain() {
        for point in forming.strain_points_mut(index) {
            point.strain = rotated(&point.strain, rotation);
        }
    }
}

/// Reverses the order of corners and all that goes with them.
fn reverse(model: &mut Model) {
    for shell in &mut model.shells {
        let [a, b, c, d] = shell.nodes;
        shell.nodes = if shell.is_triangle() {
            [b, a, c, c]
        } else {
            [b, a, d, c]
        };
    }
    for extra in &mut model.shell_extras {
        let is_triangle = model.shells[extra.shell as usize].is_triangle();
        let [a, b, c, d] = extra.thickness;
        extra.thickness = if is_triangle {
            [b, a, c, d]
        } else {
            [b, a, d, c]
        };
        extra.beta = 0.0 - extra.beta;
    }
    for (shell, nodes) in &mut model.mid_side {
        let [of_first, of_second, of_third, of_fourth] = *nodes;
        *nodes = if !model.shells[*shell as usize].is_triangle() {
            [of_first, of_fourth, of_third, of_second]
        } else if of_fourth == of_third {
            [of_first, of_third, of_second, of_second]
        } else {
            [of_first, of_third, of_second, of_fourth]
        };
    }
    for solid in &mut model.solids {
        solid.nodes = reversed_solid(solid);
    }
    let thicknesses = model.parts.iter_mut().filter_map(|p| p.thickness.as_mut());
    let of_sections = model.sections.iter_mut().map(|s| &mut s.thickness);
    for corners in thicknesses.chain(of_sections) {
        *corners = REVERSED.map(|i| corners[i]);
    }
    model.forming = reversed_points(&model.forming);
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

/// Results whose points in the plane follow the corners: three or four for each layer.
fn reversed_points(forming: &Forming) -> Forming {
    let mut result = Forming::default();
    result.others = forming.others;
    for shell in forming.stresses() {
        let order = layer_order(shell.n_plane, shell.points, |point| point.t);
        let points: Vec<StressPoint> = order.iter().map(|&i| shell.points[i]).collect();
        let history = order.iter().flat_map(|&i| shell.history_of(i));
        let history: Vec<f64> = history.copied().collect();
        let tensors = order.iter().flat_map(|&i| shell.tensors_of(i));
        let tensors: Vec<Tensor> = tensors.copied().collect();
        result
            .add_state(shell.element_id, shell.n_plane, &points, &history, &tensors)
            .expect("history and tensors have as many values as before");
    }
    for shell in forming.strains() {
        let order = layer_order(shell.n_plane, shell.points, |point| point.t);
        let points: Vec<StrainPoint> = order.iter().map(|&i| shell.points[i]).collect();
        result.add_strain(shell.element_id, shell.n_plane, &points);
    }
    result
}

/// The old index of each point. Points keep their order unless each run of `n_plane` is a layer.
fn layer_order<T>(n_plane: usize, points: &[T], t: impl Fn(&T) -> f64) -> Vec<usize> {
    let is_layer =
        |layer: &[T]| layer.len() == n_plane && layer.iter().all(|p| t(p) == t(&layer[0]));
    let has_layers = matches!(n_plane, 3 | 4) && points.chunks(n_plane).all(is_layer);
    let old = |i: usize| match (has_layers, i % n_plane.max(1)) {
        (true, in_plane @ 0..2) => i - in_plane + REVERSED[in_plane],
        (true, in_plane) if n_plane == 4 => i - in_plane + REVERSED[in_plane],
        _ => i,
    };
    (0..points.len()).map(old).collect()
}

#[cfg(test)]
mod tests {
    use super::super::model::SolidKind;
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
        model.forming.add_stress(1, 1, &[point], &[9.0]).unwrap();
        let quarter = Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2);
        let motion = Similarity {
            scale: 10.0,
            ..Pose::new(Vector3::new(0.0, 0.0, 7.0), quarter).into()
        };
        let result = moved(&model, &motion);
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
        let back = moved(&result, &motion.inverse());
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
