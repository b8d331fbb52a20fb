//! What must hold before results are carried over: shells on both sides, and for stresses global axes and one unit.

use std::collections::BTreeSet;

use super::PipelineError;
use crate::formats::Model;
use crate::geometry::tensor::{Tensor, von_mises};
use crate::mapping::{MappingError, SourcePart};
use crate::pipeline::load::LoadedPart;
use crate::units::{LengthUnit, UnitSystem};

/// Largest stresses of formed sheets over Young's modulus: residual stresses of soft and of very
/// strong sheet lie between.
const USUAL_STRESS: (f64, f64) = (2e-4, 2e-2);
/// Shares of Young's modulus that no residual stress of a whole part has.
const STRANGE_STRESS: (f64, f64) = (2e-5, 5e-2);
/// Between the units that decks are written in: Pa, MPa, GPa, psi.
const FACTORS: [f64; 6] = [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9];
/// No sheet bears more, in MPa or GPa: decks in millimetres have stresses in one of these.
const TOO_MUCH_IN_MPA: f64 = 1e5;
/// Largest stresses of formed sheets in GPa; nearly relaxed ones in MPa may look like these.
const USUAL_IN_GPA: (f64, f64) = (0.02, 2.0);
/// Elements that may hold peaks of no meaning.
const PEAKS: f64 = 0.01;

/// An error if a part has no shells, which a match would not show.
pub fn check_shells<'a>(
    crash: &LoadedPart,
    stamped: impl Iterator<Item = &'a LoadedPart>,
) -> Result<(), PipelineError> {
    let mut all = std::iter::once((crash, MappingError::EmptyTarget))
        .chain(stamped.map(|part| (part, MappingError::EmptySource)));
    match all.find(|(part, _)| !part.has_shells()) {
        Some((part, error)) => Err(PipelineError::NoShells {
            error,
            path: part.path.clone(),
        }),
        None => Ok(()),
    }
}

/// An error if initial stresses of one of the parts are read in element axes (`LISPSID` on
/// `*CONTROL_SHELL`): stresses are mapped and written in global axes. `parts` are those in use.
pub(super) fn check_axes(part: &LoadedPart, parts: &[u32]) -> Result<(), PipelineError> {
    let model = &part.model;
    let mut ids = parts.iter().map(|&index| model.parts[index as usize].id);
    match ids.find(|&id| model.is_in_element_axes(id)) {
        Some(id) => Err(PipelineError::ElementAxes {
            part: id,
            name: part.file_name(),
            set: model.shell_control.element_axes_set,
        }),
        None => Ok(()),
    }
}

/// An error if the stresses of a stamped part are clearly in another unit than the crash deck: from the units
/// that both decks name, else from the size of the stresses beside Young's modulus. A file whose material is in the
/// crash deck's unit may have stresses in another one, so that units that agree are no proof.
pub(super) fn check_stress_unit(
    crash: &LoadedPart,
    crash_parts: &[u32],
    stamped: &LoadedPart,
    source: &SourcePart,
) -> Result<(), PipelineError> {
    let system = |part: &LoadedPart| {
        let known = part.model.stated_units?;
        known.units.system
    };
    let found = match (system(stamped), system(crash)) {
        (Some(from), Some(to)) if from.stress() != to.stress() => Some(of_systems(from, to)),
        _ => of_sizes(crash, crash_parts, stamped, source),
    };
    match found {
        Some((factor, why)) => Err(PipelineError::StressUnits {
            name: stamped.file_name(),
            why,
            factor,
        }),
        None => Ok(()),
    }
}

fn of_systems(from: UnitSystem, to: UnitSystem) -> (f64, String) {
    let factor = from.stress_in_pa() / to.stress_in_pa();
    // Nine digits, so that a thousand is one.
    let factor = format!("{factor:.9e}").parse().unwrap_or(factor);
    let why = format!("it names {}, the crash deck {}", from.stress(), to.stress());
    (factor, why)
}

fn of_sizes(
    crash: &LoadedPart,
    crash_parts: &[u32],
    stamped: &LoadedPart,
    source: &SourcePart,
) -> Option<(f64, String)> {
    let peak = usual_peak(source)?;
    let reach = format!("its von Mises stresses reach {peak:.3e}");
    let Some((modulus, whose)) = modulus(crash, crash_parts, stamped, source) else {
        let is_too_much = is_in_millimetres(crash) && peak > TOO_MUCH_IN_MPA;
        let why = || format!("{reach}, more than any sheet bears in MPa or GPa");
        return is_too_much.then(|| (1e-6, why()));
    };
    let ratio = peak / modulus;
    let is_usual = |ratio: f64| (USUAL_STRESS.0..=USUAL_STRESS.1).contains(&ratio);
    if (STRANGE_STRESS.0..=STRANGE_STRESS.1).contains(&ratio) {
        return None;
    }
    let factor = FACTORS.into_iter().find(|f| is_usual(ratio * f))?;
    let why = format!("{reach}, Young's modulus of {whose} is {modulus:.3e}");
    Some((factor, why))
}

/// Asks about the unit of stresses that look like GPa where neither file has a material that would tell.
pub(super) fn stress_unit_question(
    crash: &LoadedPart,
    crash_parts: &[u32],
    stamped: &LoadedPart,
    source: &SourcePart,
) -> Option<String> {
    let peak = usual_peak(source)?;
    let is_open = is_in_millimetres(crash)
        && (USUAL_IN_GPA.0..=USUAL_IN_GPA.1).contains(&peak)
        && modulus(crash, crash_parts, stamped, source).is_none();
    is_open.then(|| {
        format!(
            "{}: its von Mises stresses reach {peak:.3e}, as in GPa, and neither file has a material that tells the \
             unit; if the crash deck is in MPa, --stress-factor 1e3 converts them",
            stamped.file_name()
        )
    })
}

fn is_in_millimetres(part: &LoadedPart) -> bool {
    let units = part.units();
    units.is_some_and(|known| known.units.length == LengthUnit::Millimeter)
}

/// Young's modulus of the crash parts, or of the stamped ones where the crash deck has none; and whose it is.
fn modulus(
    crash: &LoadedPart,
    crash_parts: &[u32],
    stamped: &LoadedPart,
    source: &SourcePart,
) -> Option<(f64, &'static str)> {
    let of = |model: &Model, parts: &[u32]| {
        let materials = parts.iter().filter_map(|&part| model.material(part));
        let mut moduli = materials.map(|material| material.modulus);
        moduli.find(|modulus| *modulus > 0.0)
    };
    let stamped_parts: BTreeSet<u32> = source.mesh.parts().iter().copied().collect();
    let stamped_parts: Vec<u32> = stamped_parts.into_iter().collect();
    let of_crash = of(&crash.model, crash_parts).map(|modulus| (modulus, "the crash part"));
    of_crash.or_else(|| Some((of(&stamped.model, &stamped_parts)?, "its own material")))
}

/// Von Mises stress that all but the highest elements stay below; `None` without stresses.
fn usual_peak(source: &SourcePart) -> Option<f64> {
    let of_element = |element: usize| {
        let (_, layers) = source.states.of(element)?;
        let of_layer = layers.iter().map(|state| {
            let stress: Tensor = std::array::from_fn(|i| state[i]);
            von_mises(&stress)
        });
        Some(of_layer.fold(0.0, f64::max))
    };
    let mut peaks: Vec<f64> = (0..source.mesh.len()).filter_map(of_element).collect();
    peaks.sort_by(f64::total_cmp);
    let at = ((1.0 - PEAKS) * peaks.len() as f64) as usize;
    peaks
        .get(at.min(peaks.len().saturating_sub(1)))
        .copied()
        .filter(|peak| *peak > 0.0)
}
