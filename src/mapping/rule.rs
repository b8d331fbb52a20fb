//! Integration rules through the thickness of a shell: where the layers lie and what they weigh.
//!
//! Places are the natural coordinate T from −1 (the side the normal points away from) to +1.
//! Gauss and Lobatto tables: Abramowitz and Stegun 1964, tables 25.4 and 25.6.

use serde::{Deserialize, Serialize};

/// Points closer than this belong to one layer: decks round T to about eight digits, some writers to five.
pub const SAME_PLACE: f64 = 1e-4;

/// Layers this close to those of a rule are that rule, if its layers lie farther apart than ten times as
/// much: some writers give T three digits. Rules of as many layers differ by thirteen times as much or more.
pub(super) const SAME_RULE: f64 = 2e-3;

/// Half tables, outermost place last; odd rules have 0 first.
const GAUSS: [&[(f64, f64)]; 10] = [
    &[(0.0, 2.0)],
    &[(0.577_350_269_189_625_8, 1.0)],
    &[
        (0.0, 0.888_888_888_888_888_8),
        (0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
    ],
    &[
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_2),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ],
    &[
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ],
    &[
        (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
        (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
        (0.932_469_514_203_152, 0.171_324_492_379_170_36),
    ],
    &[
        (0.0, 0.417_959_183_673_469_37),
        (0.405_845_151_377_397_2, 0.381_830_050_505_118_9),
        (0.741_531_185_599_394_5, 0.279_705_391_489_276_64),
        (0.949_107_912_342_758_5, 0.129_484_966_168_869_7),
    ],
    &[
        (0.183_434_642_495_649_8, 0.362_683_783_378_361_96),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ],
    &[
        (0.0, 0.330_239_355_001_259_8),
        (0.324_253_423_403_808_9, 0.312_347_077_040_002_86),
        (0.613_371_432_700_590_4, 0.260_610_696_402_935_44),
        (0.836_031_107_326_635_8, 0.180_648_160_694_857_4),
        (0.968_160_239_507_626_1, 0.081_274_388_361_574_41),
    ],
    &[
        (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
        (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
        (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
        (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
        (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
    ],
];

/// Lobatto rules of 3 to 10 layers.
const LOBATTO: [&[(f64, f64)]; 8] = [
    &[
        (0.0, 1.333_333_333_333_333_3),
        (1.0, 0.333_333_333_333_333_3),
    ],
    &[
        (0.447_213_595_499_957_9, 0.833_333_333_333_333_4),
        (1.0, 0.166_666_666_666_666_66),
    ],
    &[
        (0.0, 0.711_111_111_111_111_1),
        (0.654_653_670_707_977_1, 0.544_444_444_444_444_4),
        (1.0, 0.1),
    ],
    &[
        (0.285_231_516_480_645_1, 0.554_858_377_035_486_4),
        (0.765_055_323_929_464_7, 0.378_474_956_297_846_96),
        (1.0, 0.066_666_666_666_666_67),
    ],
    &[
        (0.0, 0.487_619_047_619_047_6),
        (0.468_848_793_470_714_2, 0.431_745_381_209_862_6),
        (0.830_223_896_278_567, 0.276_826_047_361_565_96),
        (1.0, 0.047_619_047_619_047_62),
    ],
    &[
        (0.209_299_217_902_478_87, 0.412_458_794_658_703_7),
        (0.591_700_181_433_142_3, 0.341_122_692_483_504_4),
        (0.871_740_148_509_606_6, 0.210_704_227_143_506_04),
        (1.0, 0.035_714_285_714_285_71),
    ],
    &[
        (0.0, 0.371_519_274_376_417_24),
        (0.363_117_463_826_178_16, 0.346_428_510_973_046_35),
        (0.677_186_279_510_737_7, 0.274_538_712_500_161_74),
        (0.899_757_995_411_460_2, 0.165_495_361_560_805_52),
        (1.0, 0.027_777_777_777_777_776),
    ],
    &[
        (0.165_278_957_666_387_02, 0.327_539_761_183_897_46),
        (0.477_924_949_810_444_5, 0.292_042_683_679_683_8),
        (0.738_773_865_105_505, 0.224_889_342_063_126_45),
        (0.919_533_908_166_458_9, 0.133_305_990_851_070_11),
        (1.0, 0.022_222_222_222_222_223),
    ],
];

/// The kinds of rule a shell section can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RuleKind {
    /// Gauss points, the default of the solver; the trapezoidal rule above ten layers.
    Gauss,
    /// Gauss–Lobatto points, which include both surfaces (`INTGRD` 1); three layers and more.
    Lobatto,
    /// Equally spaced layers including both surfaces, weighted by the trapezoidal rule.
    Equal,
}

impl RuleKind {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gauss => "gauss",
            Self::Lobatto => "lobatto",
            Self::Equal => "equal",
        }
    }
}

/// Layers of a shell: places in rising order and weights that sum to 2.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerRule {
    places: Vec<f64>,
    weights: Vec<f64>,
    /// Gauss or Lobatto: the weights integrate smooth profiles better than straight lines between
    /// the layers do.
    is_quadrature: bool,
}

impl LayerRule {
    /// The rule of a section with `n_layers` layers; 0 counts as 1. One layer is always in the middle, and
    /// two Lobatto layers are Gauss points. Above ten layers the solver integrates by the trapezoidal
    /// rule, whatever the kind.
    pub fn new(kind: RuleKind, n_layers: usize) -> Self {
        let n = n_layers.max(1);
        match kind {
            RuleKind::Lobatto if (3..=10).contains(&n) => Self::mirrored(n, LOBATTO[n - 3]),
            RuleKind::Gauss | RuleKind::Lobatto if n <= 10 => Self::mirrored(n, GAUSS[n - 1]),
            _ if n == 1 => Self::mirrored(1, GAUSS[0]),
            _ => {
                let place = |i: usize| -1.0 + 2.0 * i as f64 / (n - 1) as f64;
                Self::trapezoidal((0..n).map(place).collect())
            }
        }
    }

    /// One layer in the middle of each ply, which weighs what the ply is thick; from the bottom side up.
    pub fn of_plies(thickness: &[f64]) -> Self {
        let half: f64 = thickness.iter().sum::<f64>() / 2.0;
        let mut below = 0.0;
        let places = thickness.iter().map(|ply| {
            below += ply;
            (below - ply / 2.0) / half - 1.0
        });
        Self {
            places: places.collect(),
            weights: thickness.iter().map(|ply| ply / half).collect(),
            is_quadrature: false,
        }
    }

    /// Where strains of both surfaces stand.
    pub const SURFACES: [f64; 2] = [-1.0, 1.0];

    /// Both surfaces, as strains are often written.
    pub fn surfaces() -> Self {
        Self::from_places(Self::SURFACES.to_vec())
    }

    /// The Gauss or Lobatto rule whose places these are (in rising order), as far as decks give digits;
    /// else these places with trapezoidal weights.
    pub fn from_places(places: Vec<f64>) -> Self {
        let n = places.len();
        if (1..=10).contains(&n) {
            let kinds = [RuleKind::Gauss, RuleKind::Lobatto];
            let mut known = kinds.into_iter().map(|kind| Self::new(kind, n));
            if let Some(rule) = known.find(|rule| rule.has_places(&places)) {
                return rule;
            }
        }
        Self::trapezoidal(places)
    }

    /// Weights that integrate straight lines between the layers, constant beyond the outermost.
    fn trapezoidal(places: Vec<f64>) -> Self {
        let n = places.len();
        let weights = match n {
            0 => Vec::new(),
            1 => vec![2.0],
            _ => (0..n)
                .map(|i| {
                    let below = if i == 0 {
                        places[0] + 1.0
                    } else {
                        (places[i] - places[i - 1]) / 2.0
                    };
                    let above = if i + 1 == n {
                        1.0 - places[i]
                    } else {
                        (places[i + 1] - places[i]) / 2.0
                    };
                    below + above
                })
                .collect(),
        };
        Self {
            places,
            weights,
            is_quadrature: false,
        }
    }

    fn mirrored(n: usize, half: &[(f64, f64)]) -> Self {
        let below = half.iter().rev().map(|&(place, weight)| (-place, weight));
        let above = half.iter().skip(n % 2).copied();
        let (places, weights) = below.chain(above).unzip();
        let mut rule = Self {
            places,
            weights,
            is_quadrature: true,
        };
        if n % 2 == 1 {
            // The half tables hold +0, the reflection makes −0 of it.
            rule.places[n / 2] = 0.0;
        }
        rule
    }

    /// The layers as they are seen from the other side of the sheet.
    #[must_use]
    pub fn turned_over(&self) -> Self {
        Self {
            places: self.places.iter().rev().map(|place| 0.0 - place).collect(),
            weights: self.weights.iter().rev().copied().collect(),
            is_quadrature: self.is_quadrature,
        }
    }

    /// True if both sides see the same layers, to rounding.
    pub fn is_symmetric(&self) -> bool {
        let mut pairs = self.places.iter().zip(self.places.iter().rev());
        pairs.all(|(a, b)| (a + b).abs() < 1e-14)
    }

    /// Number of layers.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// True if there is no layer.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Places T of the layers, in rising order.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// Weights of the layers; they sum to 2.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// True for Gauss and Lobatto, whose weights are exact.
    pub fn is_quadrature(&self) -> bool {
        self.is_quadrature
    }

    /// True if the layers lie at these places, as far as decks give digits.
    pub fn has_places(&self, places: &[f64]) -> bool {
        let mut gaps = self.places.windows(2).map(|pair| pair[1] - pair[0]);
        let tolerance = if gaps.all(|gap| gap > 10.0 * SAME_RULE) {
            SAME_RULE
        } else {
            SAME_PLACE
        };
        let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < tolerance;
        self.places.len() == places.len() && self.places.iter().zip(places).all(is_close)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact integral of T^power over −1 … 1.
    fn integral(power: u32) -> f64 {
        if power % 2 == 1 {
            0.0
        } else {
            2.0 / f64::from(power + 1)
        }
    }

    fn quadrature(rule: &LayerRule, power: u32) -> f64 {
        let terms = rule.places().iter().zip(rule.weights());
        terms.map(|(t, w)| w * t.powi(power as i32)).sum()
    }

    #[test]
    fn gauss_is_exact_to_degree_2n_minus_1_and_lobatto_to_2n_minus_3() {
        for n in 1..=10 {
            let rule = LayerRule::new(RuleKind::Gauss, n);
            assert_eq!(rule.len(), n);
            for power in 0..2 * n as u32 {
                let error = quadrature(&rule, power) - integral(power);
                assert!(error.abs() < 1e-14, "Gauss {n}, T^{power}: {error:e}");
            }
        }
        for n in 3..=10 {
            let rule = LayerRule::new(RuleKind::Lobatto, n);
            assert_eq!(rule.places()[n - 1], 1.0);
            for power in 0..2 * n as u32 - 2 {
                let error = quadrature(&rule, power) - integral(power);
                assert!(error.abs() < 1e-14, "Lobatto {n}, T^{power}: {error:e}");
            }
        }
    }

    #[test]
    fn rules_are_recognised_by_their_places() {
        for digits in [3, 5, 8] {
            for (kind, n) in (3..=10).flat_map(|n| [(RuleKind::Gauss, n), (RuleKind::Lobatto, n)]) {
                let rule = LayerRule::new(kind, n);
                let scale = 10_f64.powi(digits);
                let rounded = rule.places().iter().map(|t| (t * scale).round() / scale);
                assert_eq!(LayerRule::from_places(rounded.collect()), rule);
            }
        }
        let near = vec![-0.770, 0.0, 0.770];
        assert_eq!(LayerRule::from_places(near.clone()).places(), near);
        let equal = LayerRule::from_places(vec![-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(equal.weights(), [0.25, 0.5, 0.5, 0.5, 0.25]);
        assert_eq!(LayerRule::surfaces().weights(), [1.0, 1.0]);
        assert_eq!(LayerRule::new(RuleKind::Gauss, 11).places()[1], -0.8);
    }

    #[test]
    fn plies_are_layers_in_their_middle() {
        let rule = LayerRule::of_plies(&[0.25, 0.5, 0.25]);
        assert_eq!(rule.places(), [-0.75, 0.0, 0.75]);
        assert_eq!(rule.weights(), [0.5, 1.0, 0.5]);
        let uneven = LayerRule::of_plies(&[0.25, 0.75]);
        assert_eq!(uneven.places(), [-0.75, 0.25]);
        assert_eq!(uneven.weights(), [0.5, 1.5]);
        assert!(rule.is_symmetric() && !uneven.is_symmetric());
        let over = uneven.turned_over();
        assert_eq!(
            (over.places(), over.weights()),
            (&[-0.25, 0.75][..], &[1.5, 0.5][..])
        );
    }

    #[test]
    fn weights_sum_to_two() {
        for kind in [RuleKind::Gauss, RuleKind::Lobatto, RuleKind::Equal] {
            for n in 0..15 {
                let sum: f64 = LayerRule::new(kind, n).weights().iter().sum();
                assert!((sum - 2.0).abs() < 1e-14, "{kind:?} {n}");
            }
        }
    }
}
