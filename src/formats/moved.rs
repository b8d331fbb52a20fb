//! A model laid elsewhere.

use super::model::{Forming, Model, Nodes, StrainPoint, StressPoint};
use crate::geometry::{Matrix3, Similarity};

/// The model under `motion`: nodes moved, stress and strain tensors turned with them (they are in
/// the global frame), thicknesses scaled. Ids and the order of corners stay, so a mirrored sheet
/// has its normals on the other side. History variables are kept as they are, also those that
/// hold tensors. Nodes whose id is repeated are moved like all others. O(model).
pub fn moved(model: &Model, motion: &Similarity) -> Model {
    let mut result = model.clone();
    move_nodes(&mut result.nodes, motion);
    for extra in &mut result.shell_extras {
        extra.thickness = extra.thickness.map(|t| t * motion.scale);
    }
    for part in &mut result.parts {
        part.thickness = part.thickness.map(|own| own.map(|t| t * motion.scale));
    }
    for section in &mut result.sections {
        section.thickness = section.thickness.map(|t| t * motion.scale);
    }
    result.forming = turned(&model.forming, &motion.rotation);
    result
}

fn move_nodes(nodes: &mut Nodes, motion: &Similarity) {
    for position in nodes.positions_mut() {
        *position = motion.apply(position);
    }
}

fn turned(forming: &Forming, rotation: &Matrix3) -> Forming {
    let mut result = Forming::default();
    for shell in forming.stresses() {
        let turn = |point: &StressPoint| StressPoint {
            stress: turn_tensor(&point.stress, rotation),
            ..*point
        };
        let points: Vec<StressPoint> = shell.points.iter().map(turn).collect();
        result
            .add_stress(shell.element_id, shell.n_plane, &points, shell.history)
            .expect("history has as many values as before");
    }
    for shell in forming.strains() {
        let turn = |point: &StrainPoint| StrainPoint {
            strain: turn_tensor(&point.strain, rotation),
            ..*point
        };
        let points: Vec<StrainPoint> = shell.points.iter().map(turn).collect();
        result.add_strain(shell.element_id, shell.n_plane, &points);
    }
    result
}

/// R·S·Rᵀ of a symmetric tensor xx, yy, zz, xy, yz, zx; shear components are those of the tensor.
pub fn turn_tensor(tensor: &[f64; 6], rotation: &Matrix3) -> [f64; 6] {
    let [xx, yy, zz, xy, yz, zx] = *tensor;
    let full = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
    let turned = rotation * full * rotation.transpose();
    [
        turned[(0, 0)],
        turned[(1, 1)],
        turned[(2, 2)],
        turned[(0, 1)],
        turned[(1, 2)],
        turned[(2, 0)],
    ]
}

#[cfg(test)]
mod tests {
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
}
