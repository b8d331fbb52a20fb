//! Tables for other programs: plain text, one row a line, every digit.

use std::fmt::Write as _;

use super::matrix::number;
use crate::assess::deviation::OverlapClass;
use crate::geometry::Point3;
use crate::role::Role;

/// The head of a table of node deviations.
pub const DEVIATION_COLUMNS: &str =
    "part,node,x,y,z,distance,class,nearest_element,pose_uncertainty";

/// One node seen from the other part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeDeviation {
    /// Whose node it is.
    pub role: Role,
    /// Its id in its file.
    pub node: u64,
    /// Where it lies, in the frame and unit of the crash part.
    pub at: Point3,
    /// Signed distance, positive where the stamped part lies in front of the crash part; infinite
    /// where nothing is within reach.
    pub distance: f64,
    /// What the distance means.
    pub class: OverlapClass,
    /// Id of the element of the other part that is nearest.
    pub nearest_element: Option<u64>,
    /// How far the pose may be off at this node; of stamped nodes at the pose of a match.
    pub pose_uncertainty: Option<f64>,
}

/// A word for machines.
pub fn class_word(class: OverlapClass) -> &'static str {
    match class {
        OverlapClass::Matched => "matched",
        OverlapClass::OffByMore => "off",
        OverlapClass::OnlyHere => "only_here",
    }
}

/// The head of a table of so many rows: `comments`, each behind `#`, and the names of the columns.
pub fn deviation_head(comments: &[String], n_rows: usize) -> String {
    let mut text = String::with_capacity(96 * n_rows);
    for comment in comments.iter().flat_map(|comment| comment.lines()) {
        text += "# ";
        text += comment;
        text.push('\n');
    }
    text += DEVIATION_COLUMNS;
    text.push('\n');
    text
}

/// Writes rows of the table. Numbers read back to the same bits; where there is no value the cell is empty.
pub fn add_deviations(text: &mut String, rows: &[NodeDeviation]) {
    for row in rows {
        let [x, y, z] = [row.at.x, row.at.y, row.at.z].map(number);
        let distance = if row.distance.is_finite() {
            number(row.distance)
        } else {
            String::new()
        };
        let element = row
            .nearest_element
            .map_or_else(String::new, |id| id.to_string());
        let uncertainty = row.pose_uncertainty.map_or_else(String::new, number);
        let (part, node, class) = (row.role.word(), row.node, class_word(row.class));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{part},{node},{x},{y},{z},{distance},{class},{element},{uncertainty}"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_read_back_and_missing_values_are_empty() {
        let near = NodeDeviation {
            role: Role::Stamped,
            node: 12,
            at: Point3::new(0.1 + 0.2, -1e-7, 5000.0),
            distance: -1.0 / 3.0,
            class: OverlapClass::Matched,
            nearest_element: Some(7),
            pose_uncertainty: Some(0.1),
        };
        let far = NodeDeviation {
            distance: f64::INFINITY,
            class: OverlapClass::OnlyHere,
            nearest_element: None,
            pose_uncertainty: None,
            ..near
        };
        let mut text = deviation_head(&["a\nb".to_owned()], 2);
        add_deviations(&mut text, &[near, far]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[..3], ["# a", "# b", DEVIATION_COLUMNS]);
        let cells: Vec<&str> = lines[3].split(',').collect();
        let numbers = [2, 3, 4, 5].map(|i| cells[i].parse::<f64>().unwrap());
        assert_eq!(numbers, [near.at.x, near.at.y, near.at.z, near.distance]);
        assert_eq!(cells[8], "0.1");
        assert_eq!(&lines[4][lines[4].len() - 13..], ",,only_here,,");
    }
}
