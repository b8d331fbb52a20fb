//! One number for each shell of a loaded part from its forming results, to be shown as colours.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::load::LoadedPart;
use crate::geometry::tensor::{Tensor, principal, von_mises};
use crate::mapping::{LayerRule, PLASTIC_STRAIN, into_layers};

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

    /// True for strains, which stand in a card of their own.
    pub fn is_strain(self) -> bool {
        matches!(self, Self::MajorStrain | Self::MinorStrain)
    }

    /// What it is multiplied by where people read it: thinning is stated in per cent.
    pub fn shown_factor(self) -> f64 {
        if self == Self::Thinning { 100.0 } else { 1.0 }
    }

    /// True if it differs from layer to layer.
    pub fn has_layers(self) -> bool {
        self != Self::Thinning
    }

    /// The number of a stress point (stress, plastic strain).
    pub fn of_state(self, state: &[f64; 7]) -> f64 {
        let stress: Tensor = std::array::from_fn(|i| state[i]);
        match self {
            Self::VonMises => von_mises(&stress),
            Self::MajorStress => principal(&stress)[0],
            _ => state[PLASTIC_STRAIN],
        }
    }

    /// The number of a strain tensor.
    pub fn of_strain(self, strain: &Tensor) -> f64 {
        let [major, .., minor] = principal(strain);
        if self == Self::MinorStrain {
            minor
        } else {
            major
        }
    }
}

/// Which of the layers a number is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerChoice {
    /// Mean over the thickness.
    Mean,
    /// The layer that has most of it: the largest number, of minor strains the smallest.
    Extreme,
    /// The lowest layer, against the normal.
    Bottom,
    /// The middle of the sheet.
    Middle,
    /// The uppermost layer.
    Top,
}

impl LayerChoice {
    /// All, in the order of the choice.
    pub const ALL: [Self; 5] = [
        Self::Mean,
        Self::Extreme,
        Self::Bottom,
        Self::Middle,
        Self::Top,
    ];

    /// Name of the layers in the window.
    pub fn label(self) -> &'static str {
        match self {
            Self::Mean => "Mean",
            Self::Extreme => "Extreme",
            Self::Bottom => "Bottom",
            Self::Middle => "Middle",
            Self::Top => "Top",
        }
    }

    /// What is shown of a quantity as long as nothing else is chosen.
    pub fn usual(value: FormingValue) -> Self {
        match value {
            FormingValue::PlasticStrain => Self::Mean,
            _ => Self::Extreme,
        }
    }

    /// What both sides of a mapping are compared in as long as nothing else is chosen. The outermost points
    /// of two rules lie at different T, and stresses of bending grow outwards: these are compared in
    /// the middle of the sheet, which is one place on both sides.
    pub fn compared(value: FormingValue) -> Self {
        if value.is_stress() {
            Self::Middle
        } else {
            Self::usual(value)
        }
    }

    /// The same layer of a sheet whose normal points to the other side.
    pub fn turned_over(self) -> Self {
        match self {
            Self::Bottom => Self::Top,
            Self::Top => Self::Bottom,
            other => other,
        }
    }

    /// The number that stands for layers given by T, weight and number, rising in T; NaN without any.
    pub fn pick(self, layers: &[[f64; 3]], value: FormingValue) -> f64 {
        let numbers = layers.iter().map(|layer| layer[2]);
        let end = |layer: Option<&[f64; 3]>| layer.map_or(f64::NAN, |layer| layer[2]);
        match self {
            Self::Mean => {
                let weighted = layers.iter().map(|[_, weight, number]| weight * number);
                weighted.sum::<f64>() / layers.iter().map(|layer| layer[1]).sum::<f64>()
            }
            Self::Extreme if value == FormingValue::MinorStrain => numbers.fold(f64::NAN, f64::min),
            Self::Extreme => numbers.fold(f64::NAN, f64::max),
            Self::Bottom => end(layers.first()),
            Self::Top => end(layers.last()),
            Self::Middle => {
                let numbers = layers.iter().map(|&[t, _, number]| (t, [number]));
                at_middle(numbers).map_or(f64::NAN, |[number]| number)
            }
        }
    }
}

/// What a sheet has in its middle, from what its layers have, given with their T and rising in it. Tensors are
/// interpolated and not numbers made of them: a bent sheet with stresses of either sign has none there,
/// but the same von Mises stress on both sides of it. `None` without layers.
pub(super) fn at_middle<const N: usize>(
    mut layers: impl Iterator<Item = (f64, [f64; N])>,
) -> Option<[f64; N]> {
    let mut below: Option<(f64, [f64; N])> = None;
    loop {
        let Some((t, above)) = layers.next() else {
            return below.map(|(_, values)| values);
        };
        if t < 0.0 {
            below = Some((t, above));
            continue;
        }
        return Some(match below {
            None => above,
            Some((s, below)) => {
                let share = -s / (t - s);
                std::array::from_fn(|i| below[i] + (above[i] - below[i]) * share)
            }
        });
    }
}

/// Weighs the layers of elements.
#[derive(Default)]
struct LayerWeights {
    /// By the bits of their places.
    rules: HashMap<Vec<u64>, LayerRule>,
}

impl LayerWeights {
    /// T, weight and number of each layer.
    fn of(&mut self, layers: &[(f64, f64)]) -> Vec<[f64; 3]> {
        if layers.is_empty() {
            return Vec::new();
        }
        let places = layers.iter().map(|(t, _)| *t);
        let known = self.rules.entry(places.clone().map(f64::to_bits).collect());
        let rule = known.or_insert_with(|| LayerRule::from_places(places.collect()));
        let weighted = layers.iter().zip(rule.weights());
        weighted.map(|((t, number), w)| [*t, *w, *number]).collect()
    }

    /// What is shown of an element, of whose layers `number_of` makes numbers: points of a layer are averaged before,
    /// as the mapping does.
    fn shown<const N: usize>(
        &mut self,
        points: Vec<(f64, [f64; N])>,
        (layer, value): (LayerChoice, FormingValue),
        number_of: impl Fn(&[f64; N]) -> f64,
    ) -> f64 {
        let layers = into_layers(points);
        if layer == LayerChoice::Middle {
            let middle = at_middle(layers.into_iter());
            return middle.map_or(f64::NAN, |values| number_of(&values));
        }
        let numbers = layers.iter().map(|(t, values)| (*t, number_of(values)));
        layer.pick(&self.of(&numbers.collect::<Vec<_>>()), value)
    }
}

/// The values of all shells of a part's model, NaN where there is none; why there are none at all
/// otherwise. Thinning is against `nominal`, in the crash part's unit; stresses are in the
/// file's. `layer` is the usual one if `None`. O(shells + points).
pub fn forming_values(
    part: &LoadedPart,
    value: FormingValue,
    nominal: Option<f64>,
    layer: Option<LayerChoice>,
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
    let layer = layer.unwrap_or(LayerChoice::usual(value));
    let mut weights = LayerWeights::default();
    if value.is_strain() {
        for strain in model.forming.strains() {
            let points = strain.points.iter().map(|point| (point.t, point.strain));
            let number = |strain: &_| value.of_strain(strain);
            let shown = weights.shown(points.collect(), (layer, value), number);
            put(strain.element_id, shown);
        }
    } else {
        for stress in model.forming.stresses() {
            let points = stress
                .points
                .iter()
                .map(|point| (point.t, point.state(1.0)));
            let number = |state: &_| value.of_state(state);
            let shown = weights.shown(points.collect(), (layer, value), number);
            put(stress.element_id, shown);
        }
    }
    match n_found {
        0 => Err(lacking(value)),
        _ => Ok(values),
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
        model.forming.add_state(7, 1, &points, &[], &[]).unwrap();
        let strain = StrainPoint {
            t: 0.0,
            strain: [0.2, -0.1, -0.1, 0.0, 0.0, 0.0],
        };
        model.forming.add_strain(9, 1, &[strain]);
        model.shell_extras.push(ShellExtra {
            shell: 1,
            thickness: [0.75, 0.75, 0.75, 0.0],
            beta: 0.0,
            plies: None,
        });
        prepare(path, model.into(), &LoadSettings::default(), &monitor).unwrap()
    }

    #[test]
    fn each_value_is_on_the_elements_that_have_it() {
        let part = sheet();
        let of = |value| forming_values(&part, value, Some(1.0), None).unwrap();
        let only = |values: Vec<f64>, shell: usize, expected: f64| {
            assert!((values[shell] - expected).abs() < 1e-12, "{values:?}");
            assert!(values[1 - shell].is_nan(), "{values:?}");
        };
        only(of(FormingValue::PlasticStrain), 0, 0.2);
        only(of(FormingValue::VonMises), 0, 30.0);
        only(of(FormingValue::MajorStress), 0, 20.0);
        only(of(FormingValue::MajorStrain), 1, 0.2);
        only(of(FormingValue::MinorStrain), 1, -0.1);
        let at = |layer| {
            let all = forming_values(&part, FormingValue::PlasticStrain, None, Some(layer));
            all.unwrap()[0]
        };
        let layers = LayerChoice::ALL.map(at);
        let expected = [0.2, 0.3, 0.1, 0.2, 0.3];
        for (found, expected) in layers.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{layers:?}");
        }
        // Half way from −30 to 20 there are −5, and the von Mises stress of that, not the mean of both.
        let middle = Some(LayerChoice::Middle);
        let of_middle = forming_values(&part, FormingValue::VonMises, None, middle);
        only(of_middle.unwrap(), 0, 5.0);
        // A triangle has three corners; its fourth is blank.
        only(of(FormingValue::Thinning), 1, 0.25);
        let none = forming_values(&part, FormingValue::Thinning, None, None).unwrap_err();
        assert!(none.contains("flat sheet"));
        assert_eq!(
            has_forming_value(&part, FormingValue::VonMises, None),
            Ok(())
        );
    }

    #[test]
    fn tensors_of_the_points_of_a_layer_are_averaged_and_not_their_numbers() {
        let point = |t: f64, xx: f64| {
            let mut state = [0.0; 7];
            state[0] = xx;
            (t, state)
        };
        let layer = |t: f64, base: f64| {
            let points = [100.0, 100.0, -100.0, -100.0];
            points.map(|xx| point(t, base + xx))
        };
        let points = [layer(-0.5, 10.0), layer(0.5, 30.0)].concat();
        let mut weights = LayerWeights::default();
        for (choice, expected) in LayerChoice::ALL
            .into_iter()
            .zip([20.0, 30.0, 10.0, 20.0, 30.0])
        {
            let value = FormingValue::VonMises;
            let number = |state: &_| value.of_state(state);
            let shown = weights.shown(points.clone(), (choice, value), number);
            assert!((shown - expected).abs() < 1e-9, "{choice:?}: {shown}");
        }
    }
}
