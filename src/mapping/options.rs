//! Choices of a mapping and the status of an element.

use serde::{Deserialize, Serialize};

use super::layers::LayerBalance;

/// What is carried over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Quantities {
    /// Shell thickness.
    pub thickness: bool,
    /// Effective plastic strain of each layer.
    pub plastic_strain: bool,
    /// Strain tensors.
    pub strain: bool,
    /// Stress tensors of each layer.
    pub stress: bool,
    /// History variables: those of one source point each, never averaged.
    pub history: bool,
}

impl Quantities {
    /// Thickness and plastic strain, which many crash models carry alone.
    pub const USUAL: Self = Self {
        thickness: true,
        plastic_strain: true,
        strain: false,
        stress: false,
        history: false,
    };
    /// Nothing.
    pub const NONE: Self = Self {
        thickness: false,
        plastic_strain: false,
        strain: false,
        stress: false,
        history: false,
    };
    /// Everything the source has.
    pub const FULL: Self = Self {
        thickness: true,
        plastic_strain: true,
        strain: true,
        stress: true,
        history: true,
    };

    /// Each quantity with its name on the command line.
    pub fn named(&mut self) -> [(&'static str, &mut bool); 5] {
        [
            ("thickness", &mut self.thickness),
            ("plastic", &mut self.plastic_strain),
            ("strain", &mut self.strain),
            ("stress", &mut self.stress),
            ("history", &mut self.history),
        ]
    }

    /// True if stress points are needed.
    pub(super) fn needs_states(self) -> bool {
        self.plastic_strain || self.stress || self.history
    }

    /// Whether an include has a file of elements, which have thicknesses, beside one of states or strains.
    pub fn need_two_files(self) -> bool {
        self.thickness && (self.needs_states() || self.strain)
    }
}

impl Default for Quantities {
    fn default() -> Self {
        Self::USUAL
    }
}

/// How values pass from source elements to a target element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapMethod {
    /// Mean over points of the target element, each with the linear field around its source element.
    #[default]
    Area,
    /// Value of the element nearest to the centre, as the solver and most tools do.
    Nearest,
    /// Mean over points of the target element, each interpolated by the shape functions of its source
    /// element between the means at the nodes. Second order, but ridges become lower.
    Shape,
}

/// Whether target normals must point to the same side as the source's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalSense {
    /// Signed where at least 90 % of the target area agree on one side. Elements that have sheets facing either way
    /// within reach are asked only where there are hardly others.
    #[default]
    Auto,
    /// The same side only.
    Signed,
    /// Both sides of the sheet.
    Either,
}

/// Which of several stamped parts an element takes its values from where they overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Overlap {
    /// The nearer sheet.
    #[default]
    Nearest,
    /// The one named first.
    First,
    /// The thicker one.
    Thicker,
}

/// Ranges outside of which a mapping refuses a choice.
pub mod limits {
    use std::ops::RangeInclusive;

    /// Lengths and factors above 0: the units that decks are written in lie no farther apart, and no part is
    /// larger.
    pub const POSITIVE: RangeInclusive<f64> = f64::MIN_POSITIVE..=1e9;
    /// Factor on the thickness: a gauge, or another unit of length.
    pub const THICKNESS_SCALE: RangeInclusive<f64> = 1e-3..=1e3;
    /// Largest angle between the normals, in degrees. Above 90° a sheet would take the values of one that
    /// faces away.
    pub const ANGLE_DEG: RangeInclusive<f64> = 1.0..=90.0;
    /// Layers of a shell. Practice has 2 to 11; the work of a mapping grows with their number.
    pub const LAYERS: RangeInclusive<usize> = 1..=100;
    /// Rings of elements that are filled.
    pub const RINGS: RangeInclusive<usize> = 0..=usize::MAX;
}

/// Choices of a mapping. The defaults suit a fine stamped mesh on a coarser crash mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MapOptions {
    /// What is carried over.
    pub quantities: Quantities,
    /// How values are carried over.
    pub method: MapMethod,
    /// Largest distance of a partner in the target's length unit; `None` takes the larger of both
    /// element sizes.
    pub max_distance: Option<f64>,
    /// Largest angle between the normals, degrees.
    pub max_angle_deg: f64,
    /// Whether normals have a sign.
    pub normal_sense: NormalSense,
    /// Keep membrane force and moment of the stresses where the layers differ.
    pub keep_force_and_moment: bool,
    /// Where stamped parts overlap.
    pub overlap: Overlap,
    /// Rings of unmapped elements that are filled with the mean thickness and plastic strain of
    /// mapped neighbours; 0 for none.
    pub fill_rings: usize,
    /// Factor on the mapped thickness.
    pub thickness_scale: f64,
    /// Thickness at each corner instead of one for the element.
    pub corner_thickness: bool,
    /// What is written takes the place of stresses and strains that the target's deck has of the same
    /// elements. No value depends on it.
    pub replace_states: bool,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            quantities: Quantities::USUAL,
            method: MapMethod::Area,
            max_distance: None,
            max_angle_deg: 60.0,
            normal_sense: NormalSense::Auto,
            keep_force_and_moment: true,
            overlap: Overlap::Nearest,
            fill_rings: 0,
            thickness_scale: 1.0,
            corner_thickness: false,
            replace_states: false,
        }
    }
}

impl MapOptions {
    pub(super) fn stress_balance(&self) -> LayerBalance {
        if self.keep_force_and_moment {
            LayerBalance::ForceAndMoment
        } else {
            LayerBalance::Linear
        }
    }
}

/// What became of a target element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// All of it has partners.
    Mapped,
    /// At least half of its area has partners; the value is theirs.
    Partly,
    /// Thickness and plastic strain are means of mapped neighbours.
    Filled,
    /// A second sheet lies nearly as close and the normals do not tell them apart.
    TwoLayers,
    /// Two stamped parts lie on it.
    Conflict,
    /// The nearest compatible point lies beyond the largest distance.
    Far,
    /// A sheet is near, but its normal differs too much.
    Angle,
    /// Beyond the border of the stamped sheet.
    Outside,
    /// The partner lacks the quantities that were asked for.
    NoData,
}

impl Status {
    /// Every status, from best to worst.
    pub const ALL: [Self; 9] = [
        Self::Mapped,
        Self::Partly,
        Self::Filled,
        Self::TwoLayers,
        Self::Conflict,
        Self::Far,
        Self::Angle,
        Self::Outside,
        Self::NoData,
    ];

    /// The word for tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mapped => "mapped",
            Self::Partly => "partly",
            Self::Filled => "filled",
            Self::TwoLayers => "two-layers",
            Self::Conflict => "conflict",
            Self::Far => "far",
            Self::Angle => "angle",
            Self::Outside => "outside",
            Self::NoData => "no-data",
        }
    }

    /// What it means, for lists and legends.
    pub fn label(self) -> &'static str {
        match self {
            Self::Mapped => "mapped",
            Self::Partly => "partly covered",
            Self::Filled => "filled from neighbours",
            Self::TwoLayers => "near two sheets",
            Self::Conflict => "on two stamped parts",
            Self::Far => "too far",
            Self::Angle => "wrong normal",
            Self::Outside => "outside the sheet",
            Self::NoData => "without results",
        }
    }

    /// True if the element carries values.
    pub fn has_values(self) -> bool {
        self <= Self::Conflict
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_of_statuses_is_complete_and_in_order() {
        assert!(Status::ALL.is_sorted());
        assert_eq!(Status::ALL.iter().filter(|s| s.has_values()).count(), 5);
    }
}
