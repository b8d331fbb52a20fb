//! Consistent systems of units.

use serde::{Deserialize, Serialize};

use super::LengthUnit;

/// The consistent unit systems that crash and forming decks are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum UnitSystem {
    /// kg, m, s: stresses in Pa.
    #[serde(rename = "kg-m-s")]
    KgMS,
    /// ton, mm, s: stresses in MPa.
    #[serde(rename = "ton-mm-s")]
    TonMmS,
    /// kg, mm, ms: stresses in GPa.
    #[serde(rename = "kg-mm-ms")]
    KgMmMs,
    /// g, mm, ms: stresses in MPa.
    #[serde(rename = "g-mm-ms")]
    GMmMs,
    /// lbf·s²/in, in, s: stresses in psi.
    #[serde(rename = "lb-in-s")]
    LbInS,
}

impl UnitSystem {
    /// All, in the order of menus.
    pub const ALL: [Self; 5] = [
        Self::TonMmS,
        Self::KgMmMs,
        Self::GMmMs,
        Self::KgMS,
        Self::LbInS,
    ];

    /// Name of the system, such as ton-mm-s.
    pub fn label(self) -> &'static str {
        match self {
            Self::KgMS => "kg-m-s",
            Self::TonMmS => "ton-mm-s",
            Self::KgMmMs => "kg-mm-ms",
            Self::GMmMs => "g-mm-ms",
            Self::LbInS => "lb-in-s",
        }
    }

    /// Unit of its lengths.
    pub fn length(self) -> LengthUnit {
        match self {
            Self::KgMS => LengthUnit::Meter,
            Self::TonMmS | Self::KgMmMs | Self::GMmMs => LengthUnit::Millimeter,
            Self::LbInS => LengthUnit::Inch,
        }
    }

    /// Unit of its stresses.
    pub fn stress(self) -> &'static str {
        match self {
            Self::KgMS => "Pa",
            Self::TonMmS | Self::GMmMs => "MPa",
            Self::KgMmMs => "GPa",
            Self::LbInS => "psi",
        }
    }

    /// One unit of its stress in Pa.
    pub fn stress_in_pa(self) -> f64 {
        let [length, mass, time] = self.in_si();
        mass / (length * time * time)
    }

    /// One unit of its length in m, of its mass in kg, of its time in s.
    pub(super) fn in_si(self) -> [f64; 3] {
        match self {
            Self::KgMS => [1.0, 1.0, 1.0],
            Self::TonMmS => [1e-3, 1e3, 1.0],
            Self::KgMmMs => [1e-3, 1.0, 1e-3],
            Self::GMmMs => [1e-3, 1e-3, 1e-3],
            // One lbf·s²/in is 4.448222 N · s² / 0.0254 m.
            Self::LbInS => [0.0254, 175.126_8, 1.0],
        }
    }
}
