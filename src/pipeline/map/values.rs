//! One number for each element of a mapping: a mapped quantity, what the stamped element has of it, and
//! their difference.

use std::borrow::Cow;

use super::{MapRun, OtherResult};
use crate::mapping::{LayerRule, Layered, Partner};
use crate::pipeline::forming_values::{FormingValue, LayerChoice, at_middle};

/// What is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownValue {
    /// The forming result; `None` for the thickness.
    pub value: Option<FormingValue>,
    /// Which layers; `None` for those that both sides are compared in.
    pub layer: Option<LayerChoice>,
    /// Thickness of the flat sheet, which thinning is against.
    pub flat: Option<f64>,
}

impl ShownValue {
    /// A quantity in the layers that both sides are compared in; `None` is the thickness.
    pub(super) fn compared(value: Option<FormingValue>) -> Self {
        Self {
            value,
            layer: None,
            flat: None,
        }
    }

    fn layer_of(&self, value: FormingValue) -> LayerChoice {
        self.layer.unwrap_or(LayerChoice::compared(value))
    }
}

/// Numbers through the thickness of an element, (T, number) rising in T of the crash element.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// Of the stamped element it took its values from, turned over where the normals are opposite.
    pub stamped: Vec<[f64; 2]>,
    /// The same of the crash element, as mapped.
    pub crash: Vec<[f64; 2]>,
}

impl MapRun {
    /// What an element carries; NaN where it has nothing.
    pub fn shown(&self, element: usize, shown: &ShownValue) -> f64 {
        let flat = shown.flat.unwrap_or(f64::NAN);
        match shown.value {
            None => self.thickness(element),
            Some(FormingValue::Thinning) => 1.0 - self.thickness(element) / flat,
            Some(value) => match shown.layer_of(value) {
                LayerChoice::Middle => self.middle(element, value),
                layer => layer.pick(&self.layers(element, value), value),
            },
        }
    }

    /// What the stamped element has that an element took its values from; NaN without one.
    pub fn shown_at_partner(&self, element: usize, shown: &ShownValue) -> f64 {
        let Some(partner) = self.mapped.elements[element].partner else {
            return f64::NAN;
        };
        let part = &self.sources[partner.source as usize];
        let scale = self.recipe.options.thickness_scale;
        let thickness = || scale * part.mean_thickness(partner.element as usize);
        match shown.value {
            None => thickness(),
            Some(FormingValue::Thinning) => 1.0 - thickness() / shown.flat.unwrap_or(f64::NAN),
            Some(value) => {
                let element = partner.element as usize;
                match shown.layer_of(value) {
                    // The middle is where it is, whichever side is up.
                    LayerChoice::Middle => middle_of(&part.strains, &part.states, element, value),
                    layer => layer.pick(&self.partner_layers(&partner, value), value),
                }
            }
        }
    }

    /// What an element carries less what the stamped element has; NaN where either has nothing.
    pub fn difference(&self, element: usize, shown: &ShownValue) -> f64 {
        self.shown(element, shown) - self.shown_at_partner(element, shown)
    }

    /// What an element carries less what another result has; NaN where either has nothing.
    pub fn difference_to(&self, other: &OtherResult, element: usize, shown: &ShownValue) -> f64 {
        self.shown(element, shown) - other.shown(element, shown)
    }

    /// A quantity through the thickness of an element and of its partner.
    pub fn profile(&self, element: usize, value: FormingValue) -> Profile {
        let partner = self.mapped.elements[element].partner;
        let line = |layers: Vec<[f64; 3]>| layers.into_iter().map(|[t, _, v]| [t, v]).collect();
        Profile {
            stamped: partner.map_or_else(Vec::new, |partner| {
                line(self.partner_layers(&partner, value))
            }),
            crash: line(self.layers(element, value)),
        }
    }

    /// How far out the outermost layers lie at most, as |T|, of the stamped parts and of the crash part;
    /// `None` if one side has none.
    pub fn outermost_layers(&self, value: FormingValue) -> Option<[f64; 2]> {
        let reach = |rule: &LayerRule| {
            rule.places()
                .iter()
                .fold(0.0_f64, |most, t| most.max(t.abs()))
        };
        let most = |rules: &[LayerRule]| rules.iter().map(reach).reduce(f64::max);
        let sources = self.sources.iter().filter_map(|part| {
            most(if value.is_strain() {
                part.strains.rules()
            } else {
                part.states.rules()
            })
        });
        let own = if value.is_strain() && self.mapped.strains_are_at_surfaces {
            Some(1.0)
        } else {
            most(&self.target.rules)
        };
        Some([sources.reduce(f64::max)?, own?])
    }

    /// Where an element's mapped strains stand.
    fn strain_rule(&self, element: usize) -> Cow<'_, LayerRule> {
        if self.mapped.strains_are_at_surfaces {
            Cow::Owned(LayerRule::surfaces())
        } else {
            Cow::Borrowed(&self.target.rules[self.target.rule_of[element] as usize])
        }
    }

    /// The number in the middle of an element's sheet; NaN without layers.
    fn middle(&self, element: usize, value: FormingValue) -> f64 {
        let mapped = &self.mapped;
        let own = &self.target.rules[self.target.rule_of[element] as usize];
        if value.is_strain() {
            let rule = self.strain_rule(element);
            let strains = mapped.strains.as_ref();
            let middle = strains.and_then(|strains| in_middle(&rule, strains.of(element)));
            return middle.map_or(f64::NAN, |strain| value.of_strain(&strain));
        }
        let states = mapped.states.as_ref();
        let middle = states.and_then(|states| in_middle(own, states.of(element)));
        middle.map_or(f64::NAN, |state| value.of_state(&state))
    }

    /// T, weight and number of each layer of an element.
    fn layers(&self, element: usize, value: FormingValue) -> Vec<[f64; 3]> {
        let mapped = &self.mapped;
        let own = &self.target.rules[self.target.rule_of[element] as usize];
        if value.is_strain() {
            let Some(strains) = &mapped.strains else {
                return Vec::new();
            };
            let rule = self.strain_rule(element);
            return by_layer(&rule, strains.of(element), |strain| value.of_strain(strain));
        }
        let states = mapped.states.as_ref();
        states.map_or_else(Vec::new, |states| {
            by_layer(own, states.of(element), |state| value.of_state(state))
        })
    }

    /// The same of a stamped element, turned over where its normal points to the other side.
    fn partner_layers(&self, partner: &Partner, value: FormingValue) -> Vec<[f64; 3]> {
        let part = &self.sources[partner.source as usize];
        let element = partner.element as usize;
        let mut layers = if value.is_strain() {
            of_source(&part.strains, element, |strain| value.of_strain(strain))
        } else {
            of_source(&part.states, element, |state| value.of_state(state))
        };
        if partner.is_flipped {
            layers.reverse();
            layers.iter_mut().for_each(|layer| layer[0] = -layer[0]);
        }
        layers
    }
}

impl OtherResult {
    /// What an element has there; NaN where it has nothing.
    pub fn shown(&self, element: usize, shown: &ShownValue) -> f64 {
        let thickness = self.thickness[element];
        match shown.value {
            None => thickness,
            Some(FormingValue::Thinning) => 1.0 - thickness / shown.flat.unwrap_or(f64::NAN),
            Some(value) => {
                let layer = shown.layer_of(value);
                if layer == LayerChoice::Middle {
                    return middle_of(&self.strains, &self.states, element, value);
                }
                let layers = if value.is_strain() {
                    of_source(&self.strains, element, |strain| value.of_strain(strain))
                } else {
                    of_source(&self.states, element, |state| value.of_state(state))
                };
                layer.pick(&layers, value)
            }
        }
    }
}

/// The number in the middle of a sheet; NaN without layers.
pub(super) fn middle_of(
    strains: &Layered<6>,
    states: &Layered<7>,
    element: usize,
    value: FormingValue,
) -> f64 {
    if value.is_strain() {
        let layers = strains.of(element);
        let middle = layers.and_then(|(rule, strains)| in_middle(rule, strains));
        return middle.map_or(f64::NAN, |strain| value.of_strain(&strain));
    }
    let layers = states.of(element);
    let middle = layers.and_then(|(rule, states)| in_middle(rule, states));
    middle.map_or(f64::NAN, |state| value.of_state(&state))
}

/// What layers of a rule have in the middle, points of a layer averaged.
fn in_middle<const N: usize>(rule: &LayerRule, points: &[[f64; N]]) -> Option<[f64; N]> {
    let n_plane = (points.len() / rule.len().max(1)).max(1);
    let means = points.chunks(n_plane).map(|layer| {
        let sum = |i: usize| layer.iter().map(|point| point[i]).sum::<f64>();
        std::array::from_fn(|i| sum(i) / n_plane as f64)
    });
    at_middle(rule.places().iter().copied().zip(means))
}

fn of_source<const N: usize>(
    layered: &Layered<N>,
    element: usize,
    number: impl Fn(&[f64; N]) -> f64,
) -> Vec<[f64; 3]> {
    layered
        .of(element)
        .map_or_else(Vec::new, |(rule, values)| by_layer(rule, values, number))
}

/// Points of a layer are averaged before the number is taken, as the mapping does.
fn by_layer<const N: usize>(
    rule: &LayerRule,
    points: &[[f64; N]],
    number: impl Fn(&[f64; N]) -> f64,
) -> Vec<[f64; 3]> {
    let n_plane = (points.len() / rule.len().max(1)).max(1);
    let layers = points
        .chunks(n_plane)
        .zip(rule.places().iter().zip(rule.weights()));
    let one = |(layer, (t, weight)): (&[[f64; N]], (&f64, &f64))| {
        let mean = |i: usize| layer.iter().map(|point| point[i]).sum::<f64>() / n_plane as f64;
        [*t, *weight, number(&std::array::from_fn(mean))]
    };
    layers.map(one).collect()
}
