//! What must hold before stresses are carried over: global axes on both sides, and one unit.

use super::PipelineError;
use crate::geometry::tensor::{Tensor, von_mises};
use crate::mapping::SourcePart;
use crate::pipeline::load::LoadedPart;
use crate::units::UnitSystem;

/// Largest stresses of formed sheets over Young's modulus: residual stresses of soft and of very
/// strong sheet lie between.
const USUAL_STRESS: (f64, f64) = (2e-4, 2e-2);
/// Shares of Young's modulus that no residual stress of a whole part has.
const STRANGE_STRESS: (f64, f64) = (2e-5, 5e-2);
/// Between the units that decks are written in: Pa, MPa, GPa, psi.
const FACTORS: [f64; 6] = [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9];
/// Elements that may hold peaks of no meaning.
const PEAKS: f64 = 0.01;

/// An error if initial stresses of one of the parts are read in element axes (`LISPSID` on
/// `*CONTROL_SHELL`): stresses are mapped and written in global axes. `parts` are those in use.
pub(super) fn check_axes(part: &LoadedPart, parts: &[u32]) -> Result<(), PipelineError> {
    let model = &part.model;
    let set = model.shell_control.element_axes_set;
    if set == 0 {
        return Ok(());
    }
    let is_named = |id: u64| match model.sets.parts.get(&set) {
        Some(named) => named.ids.contains(&id),
        // What is not defined may hold any part.
        None => true,
    };
    let mut ids = parts.iter().map(|&index| model.parts[index as usize].id);
    match ids.find(|&id| is_named(id)) {
        Some(id) => Err(PipelineError::ElementAxes {
            part: id,
            name: part.file_name(),
            set,
        }),
        None => Ok(()),
    }
}

/// An error if the stresses of a stamped part are clearly in another unit than the crash deck: from the units
/// that both decks name, else from the size of the stresses beside Young's modulus of the crash part.
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
        (Some(from), Some(to)) => of_systems(from, to),
        _ => of_sizes(crash, crash_parts, source),
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

fn of_systems(from: UnitSystem, to: UnitSystem) -> Option<(f64, String)> {
    let factor = from.stress_in_pa() / to.stress_in_pa();
    // Nine digits, so that a thousand is one.
    let factor = format!("{factor:.9e}").parse().unwrap_or(factor);
    let why = format!("it names {}, the crash deck {}", from.stress(), to.stress());
    (from.stress() != to.stress()).then_some((factor, why))
}

fn of_sizes(crash: &LoadedPart, crash_parts: &[u32], source: &SourcePart) -> Option<(f64, String)> {
    let materials = crash_parts.iter().filter_map(|&p| crash.model.material(p));
    let modulus = materials
        .map(|material| material.modulus)
        .find(|e| *e > 0.0)?;
    let peak = usual_peak(source)?;
    let ratio = peak / modulus;
    let is_usual = |ratio: f64| (USUAL_STRESS.0..=USUAL_STRESS.1).contains(&ratio);
    if (STRANGE_STRESS.0..=STRANGE_STRESS.1).contains(&ratio) {
        return None;
    }
    let factor = FACTORS.into_iter().find(|f| is_usual(ratio * f))?;
    let why = format!(
        "its von Mises stresses reach {peak:.3e}, Young's modulus of the crash part is {modulus:.3e}"
    );
    Some((factor, why))
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
