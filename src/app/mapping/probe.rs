//! One element of a mapping looked at closely: where its values come from, and both sides through the
//! thickness.

use super::picture::layered;
use crate::app::{AppState, ColorBy, Document};
use crate::geometry::Point3;
use crate::mapping::Status;
use crate::pipeline::map::Profile;
use crate::role::Role;

/// Everything about one element.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeReport {
    /// Its place in the run.
    pub element: usize,
    /// Its number in the crash deck.
    pub id: u64,
    /// Centre of the element, in the crash model.
    pub center: Point3,
    /// What became of it.
    pub status: Status,
    /// Number of the stamped element it took its values from.
    pub stamped_id: Option<u64>,
    /// The file of that element, where several were mapped from.
    pub stamped_file: Option<String>,
    /// Distance of the sheets along the normal, angle in degrees, coverage, confidence; NaN without a
    /// partner.
    pub facts: [f64; 4],
    /// Each mapped quantity on the stamped and on the crash element.
    pub values: Vec<(ColorBy, [f64; 2])>,
    /// The quantity of the profile.
    pub profile_of: Option<ColorBy>,
    /// Both sides through the thickness.
    pub profile: Profile,
}

impl Document {
    /// The element of the current mapping that a shell of a part is, or that took its values from it. The
    /// stamped part is the first one, which is shown.
    pub fn mapped_element(&self, role: Role, shell_id: u64) -> Option<usize> {
        let both = self.both()?;
        let run = &self.current_mapping()?.run;
        let id_of = |role: Role, shell: u32| both.get(role).loaded.model.shells[shell as usize].id;
        match role {
            Role::Crash => run.shells.iter().position(|&s| id_of(role, s) == shell_id),
            Role::Stamped => {
                let shells = run.source_shells.first()?;
                let own = shells.iter().position(|&s| id_of(role, s) == shell_id)?;
                let elements = run.mapped.elements.iter();
                elements.map(|report| report.partner).position(|partner| {
                    partner.is_some_and(|p| p.source == 0 && p.element as usize == own)
                })
            }
        }
    }
}

impl AppState {
    /// Where the probed element lies on the crash part, and the one it took its values from on the
    /// stamped part, each in its own model. An element of a further stamped file is not shown.
    pub fn probed_places(&self) -> Vec<(Role, Point3)> {
        let probed = self.document.mapping.probe;
        let Some((element, result)) = probed.zip(self.document.current_mapping()) else {
            return Vec::new();
        };
        let run = &result.run;
        let own = run.target.mesh.centroids().get(element);
        let report = run.mapped.elements.get(element);
        let theirs = report.and_then(|report| {
            let partner = report.partner.filter(|partner| partner.source == 0)?;
            let source = run.sources.get(partner.source as usize)?;
            source.mesh.centroids().get(partner.element as usize)
        });
        let places = [(Role::Crash, own), (Role::Stamped, theirs)];
        let there = |(role, place): (Role, Option<&Point3>)| Some((role, *place?));
        places.into_iter().filter_map(there).collect()
    }

    /// The probed element, if the mapping is still the one it belongs to.
    pub fn probe(&self) -> Option<ProbeReport> {
        let element = self.document.mapping.probe?;
        let both = self.document.both()?;
        let result = self.document.current_mapping()?;
        let run = &result.run;
        let report = run.mapped.elements.get(element)?;
        let giver = run.giver(element).and_then(|(number, shell)| {
            let part = match number.checked_sub(1) {
                None => &both.stamped.loaded,
                Some(further) => result.further.get(further)?,
            };
            Some((part.model.shells.get(shell)?.id, part.file_name()))
        });
        let (stamped_id, stamped_file) = giver.unzip();
        let quantities = self.mapped_quantities();
        let values = quantities.iter().map(|&by| {
            let shown = self.shown_value(by);
            let stamped = run.shown_at_partner(element, &shown);
            (by, [stamped, run.shown(element, &shown)])
        });
        let chosen = Some(self.map_quantity()).filter(|by| layered(*by).is_some());
        let profile_of = chosen.or_else(|| {
            let mut layered_ones = quantities.iter().copied();
            layered_ones.find(|by| layered(*by).is_some())
        });
        Some(ProbeReport {
            element,
            id: result.element_id(&both.crash.loaded, element),
            center: run.target.mesh.centroids()[element],
            status: report.status,
            stamped_id,
            stamped_file: stamped_file.filter(|_| !result.further.is_empty()),
            facts: [
                report.normal_distance,
                report.angle_deg,
                report.coverage,
                report.confidence,
            ],
            values: values.collect(),
            profile_of,
            profile: profile_of
                .and_then(layered)
                .map_or_else(Profile::default, |value| run.profile(element, value)),
        })
    }
}
