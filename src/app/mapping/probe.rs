//! One element of a mapping looked at closely: where its values come from, and both sides through the
//! thickness.

use super::picture::layered;
use crate::app::{AppState, ColorBy, Document};
use crate::geometry::Point3;
use crate::mapping::Status;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::Profile;
use crate::role::Role;

/// An element that was probed: it is known again in every mapping that has it at the same place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Probed {
    /// Number of the crash part.
    crash_revision: u64,
    /// Its place in the run.
    element: usize,
    /// Its place among the shells of the crash part.
    shell: u32,
}

impl Probed {
    /// An element of the current mapping.
    pub fn of(document: &Document, element: usize) -> Option<Self> {
        let result = document.current_mapping()?;
        Some(Self {
            crash_revision: result.stamp.parts.crash,
            element,
            shell: *result.run.shells.get(element)?,
        })
    }
}

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
    /// The element of the current mapping that a shell of the crash part is.
    pub fn mapped_element(&self, shell_id: u64) -> Option<usize> {
        let crash = &self.part(Role::Crash)?.loaded.model;
        let shells = &self.current_mapping()?.run.shells;
        let mut ids = shells.iter().map(|&shell| crash.shells[shell as usize].id);
        ids.position(|id| id == shell_id)
    }

    /// The first element of the current mapping that took its values from a shell of a stamped part.
    pub fn element_mapped_from(&self, part: &LoadedPart, shell_id: u64) -> Option<usize> {
        let result = self.current_mapping()?;
        let first = self.part(Role::Stamped).map(|part| &part.loaded);
        let mut parts = first.into_iter().chain(&result.further);
        let number = parts.position(|known| std::ptr::eq(&raw const **known, part))?;
        let run = &result.run;
        let shells = run.source_shells.get(number)?;
        let id_of = |shell: u32| part.model.shells[shell as usize].id;
        let own = shells.iter().position(|&shell| id_of(shell) == shell_id)?;
        let elements = run.mapped.elements.iter();
        elements.map(|report| report.partner).position(|partner| {
            partner.is_some_and(|p| p.source as usize == number && p.element as usize == own)
        })
    }
}

impl AppState {
    /// The probed element, by its place in the run of the current mapping.
    pub fn probed(&self) -> Option<usize> {
        let probed = self.mapping.probed?;
        (Probed::of(&self.document, probed.element) == Some(probed)).then_some(probed.element)
    }

    /// Where the probed element lies on the crash part, and the one it took its values from on its
    /// stamped part, each in its own model, with the part's number among the stamped files.
    pub fn probed_places(&self) -> Vec<(Role, usize, Point3)> {
        let probed = self.probed();
        let Some((element, result)) = probed.zip(self.document.current_mapping()) else {
            return Vec::new();
        };
        let run = &result.run;
        let own = run.target.mesh.centroids().get(element);
        let own = own.map(|place| (Role::Crash, 0, *place));
        let report = run.mapped.elements.get(element);
        let theirs = report.and_then(|report| {
            let partner = report.partner?;
            let number = partner.source as usize;
            let source = run.sources.get(number)?;
            let place = source.mesh.centroids().get(partner.element as usize)?;
            Some((Role::Stamped, number, *place))
        });
        own.into_iter().chain(theirs).collect()
    }

    /// The probed element, if the mapping is still the one it belongs to.
    pub fn probe(&self) -> Option<ProbeReport> {
        let element = self.probed()?;
        let both = self.document.both()?;
        let result = self.document.current_mapping()?;
        let run = &result.run;
        let report = run.mapped.elements.get(element)?;
        let giver = run.giver(element);
        let stamped_id = giver.and_then(|(number, shell)| {
            let part = self.document.mapped_file(number)?;
            Some(part.model.shells.get(shell)?.id)
        });
        let stamped_file = giver.and_then(|(number, _)| self.document.mapped_file_name(number));
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
            stamped_file: stamped_file.filter(|_| result.has_several_files()),
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
