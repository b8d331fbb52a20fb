//! Values of elements, and what is drawn of them.

use crate::pipeline::load::LoadedPart;
use crate::ui::viewport::meshes::ShownMesh;

/// Thickness of each shell in the crash model's unit; NaN where none is known. One of zero was not given.
pub(super) fn thickness(part: &LoadedPart) -> Vec<f64> {
    let factor = part.settings.length_factor;
    let of_shell = |shell: usize| {
        let mean = part.model.mean_shell_thickness(shell as u32);
        let mean = mean.map(|mean| mean * factor);
        mean.filter(|value| *value > 0.0).unwrap_or(f64::NAN)
    };
    (0..part.model.shells.len()).map(of_shell).collect()
}

/// The values of elements at the corners of a mesh, three for each triangle.
pub(super) fn at_corners(shown: &ShownMesh, values: &[f64]) -> Vec<f32> {
    let triangles = 0..shown.mesh().n_triangles();
    let numbers = triangles.map(|triangle| {
        let element = shown.source.element(triangle) as usize;
        values.get(element).copied().unwrap_or(f64::NAN) as f32
    });
    numbers.flat_map(|number| [number; 3]).collect()
}

/// Mean of the values of the elements around each vertex, by area; NaN where none has a value.
pub(super) fn vertex_means(shown: &ShownMesh, values: &[f64]) -> Vec<f32> {
    let mesh = shown.mesh();
    let mut sums = vec![[0.0_f64; 2]; mesh.n_vertices()];
    for (triangle, corners) in mesh.triangles().iter().enumerate() {
        let value = values.get(shown.source.element(triangle) as usize);
        let Some(value) = value.filter(|value| value.is_finite()) else {
            continue;
        };
        let area = mesh.triangle_area(triangle);
        for &vertex in corners {
            let [sum, weight] = &mut sums[vertex as usize];
            *sum += area * value;
            *weight += area;
        }
    }
    let means = sums.into_iter();
    means.map(|[sum, weight]| (sum / weight) as f32).collect()
}
