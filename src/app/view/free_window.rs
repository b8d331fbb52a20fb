//! What the right window shows while its part is in the left one.

use serde::{Deserialize, Serialize};

use super::ColorBy;
use crate::app::facts::n_alternatives;
use crate::app::{AppState, MapPicture};
use crate::geometry::Similarity;
use crate::role::Role;

/// The uses of the right window while the stamped part is moved over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FreeWindow {
    /// A card with the way back.
    Nothing,
    /// The distances between the parts as colours.
    Deviation,
    /// The stamped part at its pose, while the left window shows the mapped crash part.
    Stamped,
    /// The outlines of both parts in the section plane, laid flat.
    Section,
    /// Both parts as they were read, without reduction.
    FullMesh,
    /// The stamped part at the best pose beside the shown one.
    Alternative,
}

impl FreeWindow {
    /// All, in the order of the choice.
    pub const ALL: [Self; 6] = [
        Self::Nothing,
        Self::FullMesh,
        Self::Deviation,
        Self::Stamped,
        Self::Section,
        Self::Alternative,
    ];

    /// True for what is seen with the camera of the left window.
    pub fn is_picture(self) -> bool {
        !matches!(self, Self::Nothing | Self::Section)
    }

    /// Name in the choice.
    pub fn label(self) -> &'static str {
        match self {
            Self::Nothing => "Nothing",
            Self::Deviation => "Deviation",
            Self::Stamped => "Stamped",
            Self::Section => "Section",
            Self::FullMesh => "Full mesh",
            Self::Alternative => "Alternative",
        }
    }
}

impl AppState {
    /// What the right window shows beside the shared one; `None` while it has its own part. Without a
    /// choice: the stamped part where the left one shows the mapping, the deviation where the parts were
    /// matched, else the full meshes.
    pub fn free_window(&self) -> Option<FreeWindow> {
        if !self.view.is_moved_over {
            return None;
        }
        // A result that is out of date keeps its map, which then follows the pose.
        let parts = self.document.stamp().parts;
        let result = self.document.result.as_ref();
        let by_itself = match result.filter(|result| result.stamp.parts == parts) {
            _ if self.is_mapping_shown() => FreeWindow::Stamped,
            Some(_) => FreeWindow::Deviation,
            None => FreeWindow::FullMesh,
        };
        let chosen = self.view.free_window;
        Some(
            chosen
                .filter(|free| self.is_free_use_shown(*free))
                .unwrap_or(by_itself),
        )
    }

    fn is_free_use_shown(&self, free: FreeWindow) -> bool {
        let has_plane = self.inspect.section.shown().is_some();
        self.can_use_free(free) && (free != FreeWindow::Section || has_plane)
    }

    /// True if the right window could be used so now.
    pub fn can_use_free(&self, free: FreeWindow) -> bool {
        match free {
            FreeWindow::Alternative => self.other_pose().is_some(),
            FreeWindow::Stamped => self.is_mapping_shown(),
            _ => true,
        }
    }

    /// The best pose of the last match beside the one that is shown.
    pub fn other_pose(&self) -> Option<Similarity> {
        let result = self.document.current_result()?;
        match result.alternative {
            Some(_) => Some(result.run.crash_from_stamped),
            None => {
                let first = result.run.outcome.alternatives.first()?;
                Some(first.target_from_source)
            }
        }
    }

    /// True if another pose fits nearly as well as that of the result.
    pub fn has_alike_pose(&self) -> bool {
        let result = self.document.current_result();
        result.is_some_and(|result| n_alternatives(&result.run) > 0)
    }

    /// What the colours of a window say.
    pub fn color_by(&self, window: Role) -> ColorBy {
        let chosen = self.shown_colors();
        match self.free_window().filter(|_| window == Role::Stamped) {
            Some(FreeWindow::Deviation) => ColorBy::Deviation,
            // Distances and uncertainty are those of the pose of the result.
            Some(FreeWindow::Alternative) if chosen.is_match_map() => ColorBy::Role,
            // Which file is which is told by the files themselves.
            _ if chosen == ColorBy::MapFile => chosen,
            // Beside a picture of the mapping the stamped part shows the quantity itself.
            _ if window == Role::Stamped && chosen.map_picture().is_some() => self.map_quantity(),
            _ => chosen,
        }
    }

    /// The chosen colours, or what is nearest to them where these are not there: without another result
    /// the difference to the stamped part, without a mapping at this pose the quantity itself.
    pub fn shown_colors(&self) -> ColorBy {
        let chosen = self.view.display.color_by;
        let result = self.document.current_mapping();
        match (chosen.map_picture(), result) {
            (None, _) => chosen,
            (Some(_), None) => self.view.display.mapped.quantity,
            (Some(MapPicture::Other), Some(result)) if result.other.is_none() => {
                ColorBy::MapDifference
            }
            (Some(MapPicture::File), Some(result)) if !result.has_several_files() => {
                self.view.display.mapped.quantity
            }
            (Some(_), Some(_)) => chosen,
        }
    }
}
