//! The quantities of section 4, and why a file lacks one.

use crate::app::{Document, Shared};
use crate::mapping::Quantities;
use crate::pipeline::load::LoadedPart;
use crate::role::Role;

/// A quantity as it is chosen in the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Shell thickness.
    Thickness,
    /// Effective plastic strain.
    PlasticStrain,
    /// Strain tensors.
    Strain,
    /// Stress tensors.
    Stress,
    /// History variables.
    History,
}

impl Quantity {
    /// All, in the order of the form.
    pub const ALL: [Self; 5] = [
        Self::Thickness,
        Self::PlasticStrain,
        Self::Strain,
        Self::Stress,
        Self::History,
    ];

    /// Name of the quantity in section 4.
    pub fn label(self) -> &'static str {
        match self {
            Self::Thickness => "Thickness",
            Self::PlasticStrain => "Plastic strain",
            Self::Strain => "Strain",
            Self::Stress => "Stress",
            Self::History => "History",
        }
    }

    /// The switch of it.
    pub fn switch(self, of: &mut Quantities) -> &mut bool {
        match self {
            Self::Thickness => &mut of.thickness,
            Self::PlasticStrain => &mut of.plastic_strain,
            Self::Strain => &mut of.strain,
            Self::Stress => &mut of.stress,
            Self::History => &mut of.history,
        }
    }
}

impl Document {
    /// Why no stamped part has a quantity; `None` if one has it.
    pub fn lacks_quantity(&self, quantity: Quantity) -> Option<&'static str> {
        self.part(Role::Stamped)?;
        let has = |part: &Shared<LoadedPart>| {
            let forming = &part.model.forming;
            match quantity {
                Quantity::Thickness => part.mean_thickness().is_some(),
                Quantity::PlasticStrain | Quantity::Stress => forming.n_stress() > 0,
                Quantity::Strain => forming.n_strain() > 0,
                Quantity::History => {
                    let mut stresses = forming.stresses();
                    stresses.any(|stress| stress.n_history + stress.n_tensors > 0)
                }
            }
        };
        let [of_one, of_several] = match quantity {
            Quantity::Thickness => [
                "neither elements nor sections of the stamped file have a thickness",
                "neither elements nor sections of a stamped file have a thickness",
            ],
            Quantity::PlasticStrain | Quantity::Stress => [
                "the stamped file has no *INITIAL_STRESS_SHELL",
                "no stamped file has *INITIAL_STRESS_SHELL",
            ],
            Quantity::Strain => [
                "the stamped file has no *INITIAL_STRAIN_SHELL",
                "no stamped file has *INITIAL_STRAIN_SHELL",
            ],
            Quantity::History => [
                "the stamped file has no history variables",
                "no stamped file has history variables",
            ],
        };
        let is_one = self.mapping.further.is_empty();
        (!self.all_stamped().any(has)).then_some(if is_one { of_one } else { of_several })
    }
}
