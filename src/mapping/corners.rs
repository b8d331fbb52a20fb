//! Thickness at the corners of the target elements from the thickness of the elements.

use super::field::Stencils;
use super::source::thickness_field;
use super::target::TargetPart;

/// The linear field around each element at its corners, limited so that no corner leaves the range of
/// the elements around; the mean of the corners is the element's value. NaN where it has none.
pub(super) fn corner_thickness(thickness: &[f64], target: &TargetPart) -> Vec<[f64; 4]> {
    let mesh = &target.mesh;
    let stencils = Stencils::new(mesh, &mesh.neighbours(), thickness);
    let field = thickness_field(thickness, mesh, &stencils);
    let of_element = |element: usize| {
        let centre = mesh.centroids()[element];
        mesh.corner_points(element).map(|corner| {
            let offset = stencils.in_plane(element, &(corner - centre));
            field.weighted(element, 0, 1.0, &offset)[0]
        })
    };
    (0..mesh.len()).map(of_element).collect()
}
