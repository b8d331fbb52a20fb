//! Single elements of a mapping, with what they carry and where it comes from.

use serde::Serialize;

use super::{MapRun, PlacedPart, ShownValue};
use crate::mapping::Status;
use crate::pipeline::forming_values::FormingValue;
use crate::pipeline::load::LoadedPart;

/// Quantities of a probe; `None` is the thickness.
const VALUES: [Option<FormingValue>; 6] = [
    None,
    Some(FormingValue::PlasticStrain),
    Some(FormingValue::MajorStrain),
    Some(FormingValue::MinorStrain),
    Some(FormingValue::VonMises),
    Some(FormingValue::MajorStress),
];

/// One element of the crash part beside the stamped element it took its values from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProbeRecord {
    /// Id of the element in the crash deck.
    pub element: u64,
    /// Id of the stamped element that gave it values.
    pub stamped_element: Option<u64>,
    /// The file of that element, where several were mapped from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stamped_file: Option<String>,
    /// What became of it.
    pub status: Status,
    /// Signed distance of the stamped sheet along the element's normal, in the crash deck's unit; NaN
    /// without a partner.
    pub normal_distance: f64,
    /// Angle between the normals in degrees; NaN without a partner.
    pub angle_deg: f64,
    /// How far it can be trusted, 0 to 1.
    pub confidence: f64,
    /// Each quantity that either side has.
    pub values: Vec<ProbedValue>,
}

/// A quantity on both sides of an element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProbedValue {
    /// What it is called.
    pub name: &'static str,
    /// The stamped element's; NaN where it has none.
    pub stamped: f64,
    /// The crash element's, as mapped; NaN where it has none.
    pub crash: f64,
}

/// The elements of a run that have these ids in the crash deck, in this order; others are left out.
pub fn probe_records(
    run: &MapRun,
    crash: &LoadedPart,
    stamped: &[PlacedPart<'_>],
    ids: &[u64],
) -> Vec<ProbeRecord> {
    let id_of = |shell: u32| crash.model.shells[shell as usize].id;
    let place = |id: &u64| run.shells.iter().position(|&shell| id_of(shell) == *id);
    let elements = ids.iter().filter_map(place);
    let record = |element: usize| {
        let report = &run.mapped.elements[element];
        let giver = run.giver(element).and_then(|(number, shell)| {
            let part = stamped.get(number)?.part;
            Some((part.model.shells.get(shell)?.id, part.file_name()))
        });
        let (stamped_element, stamped_file) = giver.unzip();
        let value = |value: Option<FormingValue>| {
            let shown = ShownValue::compared(value);
            let found = ProbedValue {
                name: value.map_or("Thickness", FormingValue::label),
                stamped: run.shown_at_partner(element, &shown),
                crash: run.shown(element, &shown),
            };
            (found.stamped.is_finite() || found.crash.is_finite()).then_some(found)
        };
        ProbeRecord {
            element: id_of(run.shells[element]),
            stamped_element,
            stamped_file: stamped_file.filter(|_| stamped.len() > 1),
            status: report.status,
            normal_distance: report.normal_distance,
            angle_deg: report.angle_deg,
            confidence: report.confidence,
            values: VALUES.into_iter().filter_map(value).collect(),
        }
    };
    elements.map(record).collect()
}
