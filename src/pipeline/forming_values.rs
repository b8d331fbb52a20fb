//! One number for each shell of a loaded part from its forming results, to be shown as colours.

use std::collections::HashMap;

use super::load::LoadedPart;
use super::map::MapRun;
use crate::geometry::tensor::{principal, von_mises};

/// What can be shown of forming results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormingValue {
    /// 1 − thickness over nominal thickness.
    Thinning,
    /// Effective plastic strain, mean over the layers.
    PlasticStrain,
    /// Largest principal strain of both surfaces.
    MajorStrain,
    /// Smallest principal strain of both surfaces.
    MinorStrain,
    /// Largest von Mises stress of the layers.
    VonMises,
    /// Largest principal stress of the layers.
    MajorStress,
}

impl FormingValue {
    /// All, in the order of menus.
    pub const ALL: [Self; 6] = [
        Self::Thinning,
        Self::PlasticStrain,
        Self::MajorStrain,
        Self::MinorStrain,
        Self::VonMises,
        Self::MajorStress,
    ];

    /// Its name in menus and legends.
    pub fn label(self) -> &'static str {
        match self {
            Self::Thinning => "Thinning",
            Self::PlasticStrain => "Plastic strain",
            Self::MajorStrain => "Major strain",
            Self::MinorStrain => "Minor strain",
            Self::VonMises => "Von Mises stress",
            Self::MajorStress => "Major stress",
        }
    }

    /// True for stresses, which have a unit.
    pub fn is_stress(self) -> bool {
        matches!(self, Self::VonMises | Self::MajorStress)
    }
}

/// The values of all shells of a part's model, NaN where there is none; why there are none at all
/// otherwise. Thinning is against `nominal`, in the crash part's unit; stresses are in the
/// file's. O(shells + points).
pub fn forming_values(
    part: &LoadedPart,
    value: FormingValue,
    nominal: Option<f64>,
) -> Result<Vec<f64>, &'static str> {
    let model = &part.model;
    let mut values = vec![f64::NAN; model.shells.len()];
    if value == FormingValue::Thinning {
        let nominal = nominal.filter(|t| *t > 0.0);
        let nominal = nominal.ok_or("no section gives the thickness of the flat sheet")?;
        if model.shell_extras.is_empty() {
            return Err("the elements of this file have no thickness of their own");
        }
        for extra in &model.shell_extras {
            let n = model.shells[extra.shell as usize].corners().len();
            let own = &extra.thickness[..n];
            if own.iter().all(|t| *t > 0.0) {
                let mean = own.iter().sum::<f64>() / n as f64 * part.settings.length_factor;
                values[extra.shell as usize] = 1.0 - mean / nominal;
            }
        }
        return Ok(values);
    }
    let ids = model.shells.iter().map(|shell| shell.id);
    let shell_of: HashMap<u64, usize> = ids.zip(0..).collect();
    let mut n_found = 0_usize;
    let mut put = |id: u64, number: f64| {
        if let Some(&shell) = shell_of.get(&id) {
            values[shell] = number;
            n_found += 1;
        }
    };
    match value {
        FormingValue::MajorStrain | FormingValue::MinorStrain => {
            for strain in model.forming.strains() {
                let all = strain.points.iter().map(|point| principal(&point.strain));
                let number = if value == FormingValue::MajorStrain {
                    all.map(|[major, ..]| major).fold(f64::NAN, f64::max)
                } else {
                    all.map(|[.., minor]| minor).fold(f64::NAN, f64::min)
                };
                put(strain.element_id, number);
            }
        }
        _ => {
            for stress in model.forming.stresses() {
                let points = stress.points.iter();
                let number = match value {
                    FormingValue::VonMises => points
                        .map(|p| von_mises(&p.stress))
                        .fold(f64::NAN, f64::max),
                    FormingValue::MajorStress => points
                        .map(|p| principal(&p.stress)[0])
                        .fold(f64::NAN, f64::max),
                    _ => {
                        let sum: f64 = points.map(|p| p.plastic_strain).sum();
                        sum / stress.points.len() as f64
                    }
                };
                put(stress.element_id, number);
            }
        }
    }
    match n_found {
        0 => Err(lacking(value)),
        _ => Ok(values),
    }
}

/// The same of an element of a mapping's target; NaN where it has none.
pub fn mapped_value(
    run: &MapRun,
    element: usize,
    value: FormingValue,
    nominal: Option<f64>,
) -> f64 {
    let stresses = run.mapped.states.as_ref().map(|states| states.of(element));
    let strains = run
        .mapped
        .strains
        .as_ref()
        .map(|strains| strains.of(element));
    let of_strains = |pick: fn(f64, f64) -> f64, at: usize| {
        let all = strains.unwrap_or_default().iter();
        all.map(|strain| principal(strain)[at]).fold(f64::NAN, pick)
    };
    match value {
        FormingValue::Thinning => nominal.map_or(f64::NAN, |t| 1.0 - run.thickness(element) / t),
        FormingValue::PlasticStrain => run.plastic_strain(element),
        FormingValue::VonMises => run.largest_von_mises(element),
        FormingValue::MajorStrain => of_strains(f64::max, 0),
        FormingValue::MinorStrain => of_strains(f64::min, 2),
        FormingValue::MajorStress => {
            let all = stresses.unwrap_or_default().iter();
            all.map(|state| principal(&std::array::from_fn(|i| state[i]))[0])
                .fold(f64::NAN, f64::max)
        }
    }
}

/// The section's thickness of the first part in use, in the crash part's unit: that of the flat sheet.
pub fn nominal_thickness(part: &LoadedPart) -> Option<f64> {
    let index = part.ids.part_of(0)?;
    let own = part.model.parts.get(index as usize)?.mean_thickness()?;
    Some(own * part.settings.length_factor).filter(|t| *t > 0.0)
}

/// Whether a part has any such value, without computing them; why not otherwise.
pub fn has_forming_value(
    part: &LoadedPart,
    value: FormingValue,
    nominal: Option<f64>,
) -> Result<(), &'static str> {
    let forming = &part.model.forming;
    let has = match value {
        FormingValue::Thinning if nominal.is_none_or(|t| t <= 0.0) => {
            return Err("no section gives the thickness of the flat sheet");
        }
        FormingValue::Thinning => !part.model.shell_extras.is_empty(),
        FormingValue::MajorStrain | FormingValue::MinorStrain => forming.n_strain() > 0,
        _ => forming.n_stress() > 0,
    };
    if has { Ok(()) } else { Err(lacking(value)) }
}

fn lacking(value: FormingValue) -> &'static str {
    match value {
        FormingValue::Thinning => "the elements of this file have no thickness of their own",
        FormingValue::MajorStrain | FormingValue::MinorStrain => {
            "the file holds no strains (*INITIAL_STRAIN_SHELL)"
        }
        _ => "the file holds no stresses and plastic strains (*INITIAL_STRESS_SHELL)",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::model::{ShellExtra, StrainPoint, StressPoint};
    use crate::formats::{Memory, ReadOptions, read_from};
    use crate::monitor::Monitor;
    use crate::pipeline::load::{LoadSettings, prepare};

    fn sheet() -> LoadedPart {
        let stl = "*KEYWORD\n*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n5,2.,0.,0.\n\
                   *ELEMENT_SHELL\n7,1,1,2,3,4\n9,1,2,5,3,3\n*END\n";
        let memory = Memory::new().with("sheet.k", stl.as_bytes().to_vec());
        let path = std::path::Path::new("sheet.k");
        let monitor = Monitor::silent();
        let mut model = read_from(&memory, path, &ReadOptions::default(), &monitor).unwrap();
        let stress = |t: f64, xx: f64, plastic_strain: f64| StressPoint {
            t,
            stress: [xx, 0.0, 0.0, 0.0, 0.0, 0.0],
            plastic_strain,
        };
        let points = [stress(-1.0, -30.0, 0.1), stress(1.0, 20.0, 0.3)];
        model.forming.add_stress(7, 1, &points, &[]).unwrap();
        let strain = StrainPoint {
            t: 0.0,
            strain: [0.2, -0.1, -0.1, 0.0, 0.0, 0.0],
        };
        model.forming.add_strain(9, 1, &[strain]);
        model.shell_extras.push(ShellExtra {
            shell: 1,
            thickness: [0.75, 0.75, 0.75, 0.0],
            beta: 0.0,
            n_plies: 0,
        });
        prepare(path, model.into(), &LoadSettings::default(), &monitor).unwrap()
    }

    #[test]
    fn each_value_is_on_the_elements_that_have_it() {
        let part = sheet();
        let of = |value| forming_values(&part, value, Some(1.0)).unwrap();
        let only = |values: Vec<f64>, shell: usize, expected: f64| {
            assert!((values[shell] - expected).abs() < 1e-12, "{values:?}");
            assert!(values[1 - shell].is_nan(), "{values:?}");
        };
        only(of(FormingValue::PlasticStrain), 0, 0.2);
        only(of(FormingValue::VonMises), 0, 30.0);
        only(of(FormingValue::MajorStress), 0, 20.0);
        only(of(FormingValue::MajorStrain), 1, 0.2);
        only(of(FormingValue::MinorStrain), 1, -0.1);
        // A triangle has three corners; its fourth is blank.
        only(of(FormingValue::Thinning), 1, 0.25);
        let none = forming_values(&part, FormingValue::Thinning, None).unwrap_err();
        assert!(none.contains("flat sheet"));
        assert_eq!(
            has_forming_value(&part, FormingValue::VonMises, None),
            Ok(())
        );
    }
}
