//! Which picture of a mapping is shown: values, difference, distance, angle, confidence, status; of which
//! quantity and which layer.

use serde::{Deserialize, Serialize};

use super::MapResult;
use crate::app::{AppState, ColorBy, Display};
use crate::mapping::{Facing, Status};
use crate::pipeline::forming_values::{FormingValue, LayerChoice};
use crate::pipeline::map::{CheckPicture, ShownValue};
use crate::role::Role;
use crate::text::fixed;

/// Pictures of a mapping on the crash part beside the mapped values themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapPicture {
    /// Mapped less the stamped element.
    Difference,
    /// Signed distance of the stamped sheet along the crash element's normal.
    Distance,
    /// Angle between the normals of an element and of the stamped sheet there.
    Angle,
    /// How far an element can be trusted, 0 to 1.
    Confidence,
    /// What became of the elements.
    Status,
    /// Which stamped file gave them their values.
    File,
    /// Mapped less what another mapper's result has.
    Other,
}

impl MapPicture {
    /// All, in the order of the choice.
    pub const ALL: [Self; 7] = [
        Self::Difference,
        Self::Distance,
        Self::Angle,
        Self::Confidence,
        Self::Status,
        Self::File,
        Self::Other,
    ];

    /// Name of the picture in section 4.
    pub fn label(self) -> &'static str {
        match self {
            Self::Difference => "Difference",
            Self::Distance => "Distance",
            Self::Angle => "Angle",
            Self::Confidence => "Confidence",
            Self::Status => "Status",
            Self::File => "From file",
            Self::Other => "Other result",
        }
    }

    /// The choice of colours it is.
    pub fn color_by(self) -> ColorBy {
        match self {
            Self::Difference => ColorBy::MapDifference,
            Self::Distance => ColorBy::MapDistance,
            Self::Angle => ColorBy::MapAngle,
            Self::Confidence => ColorBy::MapConfidence,
            Self::Status => ColorBy::MapStatus,
            Self::File => ColorBy::MapFile,
            Self::Other => ColorBy::MapOther,
        }
    }
}

/// Of what the pictures of a mapping speak.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MapDisplay {
    /// Quantity whose values and differences are shown.
    pub quantity: ColorBy,
    /// The layers; `None` for what is usual of the quantity.
    pub layer: Option<LayerChoice>,
}

impl Default for MapDisplay {
    fn default() -> Self {
        Self {
            quantity: ColorBy::Thickness,
            layer: None,
        }
    }
}

/// Outermost layers nearer to each other than this lie alike.
const ALIKE: f64 = 0.01;

/// Quantities that a mapping can be looked at in.
const QUANTITIES: [ColorBy; 7] = [
    ColorBy::Thickness,
    ColorBy::Thinning,
    ColorBy::PlasticStrain,
    ColorBy::MajorStrain,
    ColorBy::MinorStrain,
    ColorBy::VonMises,
    ColorBy::MajorStress,
];

impl AppState {
    /// The quantities the current mapping holds.
    pub fn mapped_quantities(&self) -> Vec<ColorBy> {
        let has = |by: &ColorBy| self.mapped_for(*by).is_some();
        QUANTITIES.into_iter().filter(has).collect()
    }

    /// The quantities that both the current mapping and the result beside it have.
    pub fn compared_quantities(&self) -> Vec<ColorBy> {
        let result = self.document.current_mapping();
        let record = result.and_then(|result| result.record.comparison.as_ref());
        let is_in_both = |by: &ColorBy| {
            let is_told = *by == ColorBy::Thickness || by.forming().is_some();
            is_told && record.is_some_and(|record| record.of(by.forming()).is_some())
        };
        let all = self.mapped_quantities().into_iter();
        all.filter(is_in_both).collect()
    }

    /// The difference to the other result, of a quantity that both have.
    pub(in crate::app) fn with_other_result(&self) -> Display {
        let mut display = self.with_map_picture(Some(MapPicture::Other));
        let in_both = self.compared_quantities();
        if !in_both.contains(&display.mapped.quantity) {
            let first = in_both.first().copied();
            display.mapped.quantity = first.unwrap_or(display.mapped.quantity);
        }
        display
    }

    /// The quantity the pictures of the mapping speak of; the first there is if the chosen one was not
    /// mapped.
    pub fn map_quantity(&self) -> ColorBy {
        let chosen = self.view.display.mapped.quantity;
        let all = self.mapped_quantities();
        if all.contains(&chosen) {
            return chosen;
        }
        all.first().copied().unwrap_or(chosen)
    }

    /// What is looked at when a quantity is shown.
    pub fn shown_value(&self, by: ColorBy) -> ShownValue {
        ShownValue {
            value: by.forming(),
            layer: self.shown_layer(by),
            flat: self.flat_thickness(),
        }
    }

    /// True if the colours show the current mapping.
    pub fn is_mapping_shown(&self) -> bool {
        let by = self.view.display.color_by;
        self.document.current_mapping().is_some()
            && (by.map_picture().is_some() || self.mapped_for(by).is_some())
    }

    /// True if each window shows its own part, the left one with what was mapped from the right one.
    pub(in crate::app) fn are_windows_compared(&self) -> bool {
        !self.view.is_moved_over && self.is_mapping_shown()
    }

    /// True if a window shows values of a mapping that would be made otherwise now.
    pub fn is_old_mapping_shown(&self, window: Role) -> bool {
        let is_mapped = window == Role::Crash && self.is_mapping_shown();
        is_mapped && self.document.is_mapping_out_of_date()
    }

    /// True if the left window shows the mapped crash part alone, whatever the right one is used for: the stamped
    /// part would hide its colours.
    pub fn is_mapping_apart(&self) -> bool {
        self.view.is_moved_over && self.is_mapping_shown()
    }

    /// True if the stamped part is not in the left window, which shows the mapping, though it was moved there.
    pub fn is_mapped_alone(&self) -> bool {
        let is_compared = self.is_mapped_blinking() || self.mapped_wipe().is_some();
        self.is_mapping_apart() && !is_compared
    }

    /// True if both sides of the mapping show one quantity, so that they can be wiped and blinked between in
    /// the left window.
    pub fn can_compare_mapped(&self) -> bool {
        self.is_mapping_apart() && self.color_by(Role::Crash).map_picture().is_none()
    }

    /// True while the stamped part is blinked to in the place of the mapped one.
    pub fn is_mapped_blinking(&self) -> bool {
        self.view.is_blinking && self.can_compare_mapped()
    }

    /// Where the line lies between the mapped and the stamped part, if there is one.
    pub fn mapped_wipe(&self) -> Option<f32> {
        let can = self.can_compare_mapped() && !self.view.is_blinking;
        self.view.display.wipe.filter(|_| can)
    }

    /// The layers that are shown of a quantity; `None` where it has none.
    pub fn shown_layer(&self, by: ColorBy) -> Option<LayerChoice> {
        let chosen = self.view.display.mapped.layer;
        Some(chosen.unwrap_or(self.usual_layer(by)?))
    }

    /// What is shown of a quantity as long as nothing else is chosen.
    pub fn usual_layer(&self, by: ColorBy) -> Option<LayerChoice> {
        let value = layered(by)?;
        Some(match self.mapped_for(by) {
            Some(_) => LayerChoice::compared(value),
            None => LayerChoice::usual(value),
        })
    }

    /// What to know of layers that are farther out on one side of the mapping than on the other; `None`
    /// where a place is shown that both have, or where they lie alike.
    pub fn layers_differ(&self, by: ColorBy) -> Option<String> {
        let is_inside = matches!(
            self.shown_layer(by)?,
            LayerChoice::Mean | LayerChoice::Middle
        );
        let run = self.mapped_for(by).filter(|_| !is_inside)?;
        let [stamped, crash] = run.outermost_layers(layered(by)?)?;
        let differ = (stamped - crash).abs() > ALIKE;
        differ.then(|| {
            let (stamped, crash) = (fixed(stamped, 2), fixed(crash, 2));
            format!(
                "Outermost layers: ▲ at T ±{stamped}, ■ at T ±{crash}; values there differ for that"
            )
        })
    }

    /// The layer of a stamped file that lies where a layer of the crash part does; by the file's number.
    pub fn stamped_layer(&self, by: ColorBy, file: usize) -> Option<LayerChoice> {
        let layer = self.shown_layer(by)?;
        let run = self.document.current_mapping().map(|result| &result.run);
        let is_flipped =
            run.is_some_and(|run| run.mapped.facings.get(file) == Some(&Facing::Opposite));
        Some(if is_flipped {
            layer.turned_over()
        } else {
            layer
        })
    }

    /// The colours with another picture of the mapping; `None` for the mapped values.
    pub fn with_map_picture(&self, picture: Option<MapPicture>) -> Display {
        let mut display = self.view.display.clone();
        display.mapped.quantity = self.map_quantity();
        display.color_by = picture.map_or(display.mapped.quantity, MapPicture::color_by);
        display
    }

    /// The colours with another quantity, in the same kind of picture.
    pub fn with_map_quantity(&self, quantity: ColorBy) -> Display {
        let mut display = self.view.display.clone();
        display.mapped.quantity = quantity;
        if !display.color_by.speaks_of_quantity() {
            display.color_by = quantity;
        }
        display
    }

    /// The colours with the next quantity of the mapping.
    pub fn with_next_map_quantity(&self) -> Display {
        let all = self.mapped_quantities();
        let now = self.map_quantity();
        let at = all.iter().position(|by| *by == now);
        let next = at.map_or(now, |at| all[(at + 1) % all.len()]);
        self.with_map_quantity(next)
    }

    /// The colours with the next layer; the usual ones come after the last.
    pub fn with_next_layer(&self) -> Display {
        let mut display = self.view.display.clone();
        let all = LayerChoice::ALL;
        let layer = &mut display.mapped.layer;
        *layer = match layer {
            None => Some(all[0]),
            Some(now) => {
                let at = all.iter().position(|layer| layer == now);
                at.and_then(|at| all.get(at + 1)).copied()
            }
        };
        display
    }

    /// The colours in which a check is seen.
    pub fn with_check(&self, picture: CheckPicture) -> Display {
        let mut display = self.view.display.clone();
        let mut difference = |quantity| {
            display.mapped.quantity = quantity;
            ColorBy::MapDifference
        };
        display.color_by = match picture {
            CheckPicture::Status => ColorBy::MapStatus,
            CheckPicture::Distance => ColorBy::MapDistance,
            CheckPicture::Confidence => ColorBy::MapConfidence,
            CheckPicture::Thickness => difference(ColorBy::Thickness),
            CheckPicture::PlasticStrain => difference(ColorBy::PlasticStrain),
            CheckPicture::Stress => difference(ColorBy::VonMises),
        };
        display
    }

    /// Elements and area of each status that occurs in the current mapping, with the first element of
    /// it.
    pub fn map_statuses(&self) -> Vec<(Status, usize, f64, usize)> {
        let Some(result) = self.document.current_mapping() else {
            return Vec::new();
        };
        let first_of = &result.lists.first_of;
        let row = |status: Status| Some(first_of.iter().find(|(of, _)| *of == status)?.1);
        let statuses = result.record.statuses.iter();
        statuses
            .filter_map(|of| Some((of.status, of.n_elements, of.area_share, row(of.status)?)))
            .collect()
    }
}

impl MapResult {
    /// Number of an element in the crash deck, by its place in the run.
    pub fn element_id(&self, crash: &crate::pipeline::load::LoadedPart, element: usize) -> u64 {
        crash.model.shells[self.run.shells[element] as usize].id
    }
}

/// True if a quantity has a value for each layer.
pub(super) fn layered(by: ColorBy) -> Option<FormingValue> {
    by.forming().filter(|value| value.has_layers())
}
