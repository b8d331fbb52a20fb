//! Plain choices about what is shown.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::app::{Coloring, MapDisplay, MapPicture};
use crate::colormap::ColorScale;
use crate::pipeline::forming_values::FormingValue;
use crate::role::PerRole;

/// Which geometry the windows show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShownGeometry {
    /// The chosen level.
    #[default]
    Reduced,
    /// The full mesh.
    Detailed,
}

/// What the colours say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorBy {
    /// Which of the two parts.
    #[default]
    Role,
    /// Which part of the deck.
    Part,
    /// Sheet thickness.
    Thickness,
    /// Distance of the reduced to the full mesh.
    ReductionError,
    /// Signed distance between the parts.
    Deviation,
    /// Where the other part is, is off, or is missing.
    Overlap,
    /// How far the pose may be off at each place of the stamped part.
    Uncertainty,
    /// 1 − thickness over that of the flat sheet.
    Thinning,
    /// Effective plastic strain, mean over the layers.
    PlasticStrain,
    /// Largest principal strain.
    MajorStrain,
    /// Smallest principal strain.
    MinorStrain,
    /// Largest von Mises stress of the layers.
    VonMises,
    /// Largest principal stress of the layers.
    MajorStress,
    /// Mapped less stamped.
    MapDifference,
    /// Distance of the stamped sheet from the mapped elements.
    MapDistance,
    /// Angle between the normals of mapped elements and of the stamped sheet.
    MapAngle,
    /// How far mapped elements can be trusted.
    MapConfidence,
    /// What became of the elements of the mapping.
    MapStatus,
    /// Which stamped file gave the mapped elements their values.
    MapFile,
    /// Mapped less what another mapper's result has.
    MapOther,
}

impl From<FormingValue> for ColorBy {
    fn from(value: FormingValue) -> Self {
        match value {
            FormingValue::Thinning => Self::Thinning,
            FormingValue::PlasticStrain => Self::PlasticStrain,
            FormingValue::MajorStrain => Self::MajorStrain,
            FormingValue::MinorStrain => Self::MinorStrain,
            FormingValue::VonMises => Self::VonMises,
            FormingValue::MajorStress => Self::MajorStress,
        }
    }
}

impl ColorBy {
    /// All, in the order of the menu.
    pub const ALL: [Self; 20] = [
        Self::Role,
        Self::Part,
        Self::Thickness,
        Self::ReductionError,
        Self::Deviation,
        Self::Overlap,
        Self::Uncertainty,
        Self::Thinning,
        Self::PlasticStrain,
        Self::MajorStrain,
        Self::MinorStrain,
        Self::VonMises,
        Self::MajorStress,
        Self::MapDifference,
        Self::MapDistance,
        Self::MapAngle,
        Self::MapConfidence,
        Self::MapStatus,
        Self::MapFile,
        Self::MapOther,
    ];

    /// Of what it speaks; the choices of a group stand beside each other in [`ColorBy::ALL`].
    pub fn group(self) -> &'static str {
        match self {
            Self::Role | Self::Part | Self::Thickness | Self::ReductionError => "Part",
            Self::Deviation | Self::Overlap | Self::Uncertainty => "Match",
            Self::Thinning
            | Self::PlasticStrain
            | Self::MajorStrain
            | Self::MinorStrain
            | Self::VonMises
            | Self::MajorStress => "Forming",
            Self::MapDifference
            | Self::MapDistance
            | Self::MapAngle
            | Self::MapConfidence
            | Self::MapStatus
            | Self::MapFile
            | Self::MapOther => "Mapping",
        }
    }

    /// True for colours that a legend explains.
    pub fn shows_values(self) -> bool {
        !matches!(self, Self::Role | Self::Part)
    }

    /// True for the maps that keys turn on and off: they speak of how the parts meet.
    pub fn is_match_map(self) -> bool {
        matches!(self, Self::Deviation | Self::Overlap | Self::Uncertainty)
    }

    /// The picture of a mapping, if it is one.
    pub fn map_picture(self) -> Option<MapPicture> {
        let is_it = |picture: &MapPicture| picture.color_by() == self;
        MapPicture::ALL.into_iter().find(is_it)
    }

    /// True for pictures of a mapping that are made of one of its quantities.
    pub fn speaks_of_quantity(self) -> bool {
        matches!(self, Self::MapDifference | Self::MapOther)
    }

    /// The forming result that is shown, if it is one.
    pub fn forming(self) -> Option<FormingValue> {
        Some(match self {
            Self::Thinning => FormingValue::Thinning,
            Self::PlasticStrain => FormingValue::PlasticStrain,
            Self::MajorStrain => FormingValue::MajorStrain,
            Self::MinorStrain => FormingValue::MinorStrain,
            Self::VonMises => FormingValue::VonMises,
            Self::MajorStress => FormingValue::MajorStress,
            _ => return None,
        })
    }

    /// Name in the menu.
    pub fn label(self) -> &'static str {
        match self {
            Self::Role => "Crash / stamped",
            Self::Part => "Part",
            Self::Thickness => "Thickness",
            Self::ReductionError => "Reduction error",
            Self::Deviation => "Deviation",
            Self::Overlap => "Overlap",
            Self::Uncertainty => "Uncertainty of the pose",
            Self::Thinning => FormingValue::Thinning.label(),
            Self::PlasticStrain => FormingValue::PlasticStrain.label(),
            Self::MajorStrain => FormingValue::MajorStrain.label(),
            Self::MinorStrain => FormingValue::MinorStrain.label(),
            Self::VonMises => FormingValue::VonMises.label(),
            Self::MajorStress => FormingValue::MajorStress.label(),
            Self::MapDifference => "Mapping: difference",
            Self::MapDistance => "Mapping: distance",
            Self::MapAngle => "Mapping: angle",
            Self::MapConfidence => "Mapping: confidence",
            Self::MapStatus => "Mapping: status",
            Self::MapFile => "Mapping: stamped file",
            Self::MapOther => "Mapping: other result",
        }
    }
}

/// The tabs of the bottom pane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BottomTab {
    /// What was done and how long it took.
    #[default]
    Log,
    /// Times of the steps as bars.
    Timings,
    /// The starts of the last match.
    Starts,
    /// Residual and overlap over the iterations.
    Convergence,
    /// The paper's tables.
    Sweep,
    /// Distances between the parts.
    Deviation,
    /// Both outlines in the section plane.
    Section,
    /// Checks, statistics and the probe of the mapping.
    Mapping,
    /// Undo steps.
    History,
    /// What the reader found in the files.
    Diagnostics,
}

impl BottomTab {
    /// All, from left to right.
    pub const ALL: [Self; 10] = [
        Self::Log,
        Self::Timings,
        Self::Starts,
        Self::Convergence,
        Self::Sweep,
        Self::Deviation,
        Self::Section,
        Self::Mapping,
        Self::History,
        Self::Diagnostics,
    ];

    /// Title of the tab.
    pub fn label(self) -> &'static str {
        match self {
            Self::Log => "Log",
            Self::Timings => "Timings",
            Self::Starts => "Starts",
            Self::Convergence => "Convergence",
            Self::Sweep => "Sweep",
            Self::Deviation => "Deviation",
            Self::Section => "Section",
            Self::Mapping => "Mapping",
            Self::History => "History",
            Self::Diagnostics => "Diagnostics",
        }
    }

    /// What it shows.
    pub fn help(self) -> &'static str {
        match self {
            Self::Log => "What was done and what came of it",
            Self::Timings => "How long each step took",
            Self::Starts => "The starts of the last match",
            Self::Convergence => "Residual and overlap over the iterations",
            Self::Sweep => "The paper's tables over methods and levels",
            Self::Deviation => "Distances between the parts as numbers",
            Self::Section => "Both outlines in the section plane",
            Self::Mapping => "Checks, statistics and probe of the mapping",
            Self::History => "Everything done so far; go back to any of it",
            Self::Diagnostics => "What the reader found in the files",
        }
    }
}

/// What lies over the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialog {
    /// All keys.
    Help,
    /// Search commands.
    Palette,
    /// Preferences.
    Preferences,
    /// The list of messages.
    Messages,
    /// The choices of a picture.
    Picture,
    /// Name, version, licences.
    About,
    /// Unsaved work, asked about before the program ends.
    Unsaved,
    /// Files of a project that were not found.
    MissingFiles,
}

/// What room a window has for the left column beside its 3D windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnRoom {
    /// For both.
    Enough,
    /// Little is left beside it: the column is a rail until it is asked for.
    Narrow,
    /// Still less. A column that was unfolded with more room is a rail again.
    Tiny,
}

/// Plain choices about the picture, changed as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Display {
    /// Opacity of each part, 0 to 1.
    pub opacity: PerRole<f32>,
    /// The crash part is drawn so that one sees through it.
    pub is_see_through: bool,
    /// The stamped part is drawn so far from where it is, along the mean normal; display only.
    pub separation: f64,
    /// Where the wipe line lies, 0 left to 1 right; `None` without a wipe.
    pub wipe: Option<f32>,
    /// A line splits each window: reduced left, full right. Where it lies, 0 to 1.
    pub split: Option<f32>,
    /// Edges of the mesh.
    pub has_edges: bool,
    /// Sharp edges and borders.
    pub has_feature_edges: bool,
    /// Nodes.
    pub has_points: bool,
    /// Parts of the decks that are not used for the match, grey and faint.
    pub has_unused: bool,
    /// What the colours say.
    pub color_by: ColorBy,
    /// Maps, limits of the deviation, tolerance.
    pub coloring: Coloring,
    /// Values at the ends of the colours of other maps; one without an entry follows its values.
    pub limits: BTreeMap<ColorBy, [f64; 2]>,
    /// Of what the pictures of a mapping speak.
    pub mapped: MapDisplay,
    /// The small axes in the corner.
    pub has_axes: bool,
    /// The scale bar.
    pub has_scale_bar: bool,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            opacity: PerRole {
                crash: 1.0,
                stamped: 1.0,
            },
            is_see_through: false,
            separation: 0.0,
            wipe: None,
            split: None,
            has_edges: false,
            has_feature_edges: true,
            has_points: false,
            has_unused: false,
            color_by: ColorBy::default(),
            coloring: Coloring::default(),
            limits: BTreeMap::new(),
            mapped: MapDisplay::default(),
            has_axes: true,
            has_scale_bar: true,
        }
    }
}

impl Display {
    /// The colours of a map that is not that of the deviation, with its limits where they were set.
    pub fn limited(&self, by: ColorBy, scale: ColorScale) -> ColorScale {
        let limits = self.limits.get(&by);
        let [min, max] = limits.copied().unwrap_or([scale.min, scale.max]);
        ColorScale {
            min,
            max,
            hides_beyond: self.coloring.hides_beyond && limits.is_some(),
            ..scale
        }
    }
}
