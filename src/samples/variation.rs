//! Other dimensions of the same part, drawn at random.

use super::parts::{Design, unroll};
use super::path::{Corner, Flat, Path};
use super::random::Random;
use super::sheet::{Emboss, Ramp, Sheet};

/// Dimensions drawn at random around a part's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleShape {
    /// Chooses the dimensions.
    pub seed: u64,
    /// Largest change of a dimension, as a share of it; every one changes by at least half of it.
    /// Up to 0.1 every part keeps its character.
    pub spread: f64,
}

/// Millimetres that a hole moves for a spread of 1.
const HOLE_SHIFT: f64 = 40.0;
/// Share of the change that is spent on stretching one half against the other, at a spread of 1.
const WARP: f64 = 0.4;

/// A monotone map of one axis of the die plane: a factor, and a stretch that leaves symmetric parts
/// symmetric.
#[derive(Debug, Clone, Copy)]
struct Axis {
    factor: f64,
    warp: f64,
    half: f64,
}

impl Axis {
    fn at(&self, x: f64) -> f64 {
        let wave = (std::f64::consts::PI * x / self.half).sin() * self.half / std::f64::consts::PI;
        self.factor * (x + self.warp * wave)
    }
}

/// The changed curves, and how positions on the old sheet become positions on the new one.
struct Change<'a> {
    old: &'a Sheet,
    spine: Path,
    section: Path,
    over_die: bool,
    across: [Axis; 2],
}

impl Change<'_> {
    fn u(&self, u: f64) -> f64 {
        if self.old.is_turned {
            return u * self.section.length() / self.old.section.length();
        }
        let x = self.old.spine.at(u + self.old.spine.length() / 2.0).0.x;
        unroll(&self.spine, self.across[0].at(x))
    }

    fn v(&self, v: f64) -> f64 {
        if !self.over_die {
            return v * self.section.length() / self.old.section.length();
        }
        let y = self.old.section.at(v + self.old.section.length() / 2.0).0.x;
        unroll(&self.section, self.across[1].at(y))
    }

    /// A corner of a trim polygon.
    fn corner(&self, &(x, y, r): &Corner) -> Corner {
        if self.over_die {
            (self.across[0].at(x), self.across[1].at(y), r)
        } else {
            (self.u(x), self.v(y), r)
        }
    }
}

/// A factor that differs from 1 by between half of the spread and the whole.
fn factor(random: &mut Random, spread: f64) -> f64 {
    1.0 + random.sign() * spread * (0.5 + 0.5 * random.unit())
}

impl Design {
    /// The part with other dimensions: lengths, heights, radii, beads, holes, thickness.
    pub(super) fn varied(&self, shape: &SampleShape) -> Self {
        let random = &mut Random::new(shape.seed ^ 0x5_4a9e);
        let spread = shape.spread;
        let half = |corners: &[Corner], of: fn(&Corner) -> f64| {
            corners.iter().map(|c| of(c).abs()).fold(1.0, f64::max)
        };
        let halves = [half(&self.outline, |c| c.0), half(&self.outline, |c| c.1)];
        let across = halves.map(|half| Axis {
            factor: factor(random, spread),
            warp: if self.is_regular {
                0.0
            } else {
                WARP * spread * random.signed()
            },
            half,
        });
        let [rise, height, bend] = [(); 3].map(|()| factor(random, spread));
        let sheet = &self.sheet;
        let change = Change {
            old: sheet,
            spine: sheet
                .spine
                .remade(|&(x, z, r)| (across[0].at(x), z * rise, r)),
            section: sheet
                .section
                .remade(|&(y, z, r)| (across[1].at(y), z * height, r * bend)),
            over_die: self.over_die,
            across,
        };
        let trim = |corners: &[Corner]| corners.iter().map(|c| change.corner(c)).collect();
        let mut varied = Self {
            thickness: self.thickness * factor(random, spread),
            outline: trim(&self.outline),
            addendum: trim(&self.addendum),
            unflanged: trim(&self.unflanged),
            cut: (self.cut.0, self.cut.1 * across[0].factor),
            sheet: self.sheet_with(&change, random, spread),
            // The exact number of triangles belongs to the part's own dimensions.
            n_stamped_triangles: None,
            ..self.clone()
        };
        varied.holes = self.holes_with(&varied, &change, random, spread);
        varied
    }

    fn sheet_with(&self, change: &Change<'_>, random: &mut Random, spread: f64) -> Sheet {
        let sheet = &self.sheet;
        let [wide, across] = change.across.map(|axis| axis.factor);
        let embosses = sheet.embosses.iter().map(|emboss| Emboss {
            center: (change.u(emboss.center.0), change.v(emboss.center.1)),
            half: (emboss.half.0 * wide, emboss.half.1 * across),
            height: emboss.height * factor(random, spread),
            ..*emboss
        });
        let embosses = embosses.collect();
        let knots = |ramp: &Ramp, value: f64| {
            let knots = ramp.0.iter().map(|&(u, x)| (change.u(u), x * value));
            Ramp(knots.collect())
        };
        Sheet {
            spine: change.spine.clone(),
            section: change.section.clone(),
            is_turned: sheet.is_turned,
            height: knots(&sheet.height, 1.0),
            height_band: sheet.height_band * across,
            flare: knots(&sheet.flare, across),
            flare_band: sheet.flare_band * across,
            embosses,
        }
    }

    /// Holes where they belong, a little shifted and of another size, unless two would come too near.
    /// The holes of this design on `varied`, which has all else.
    fn holes_with(
        &self,
        varied: &Self,
        change: &Change<'_>,
        random: &mut Random,
        spread: f64,
    ) -> Vec<Path> {
        let shared = factor(random, spread);
        let mut made: Vec<Path> = Vec::with_capacity(self.holes.len());
        for hole in &self.holes {
            let (shift, size) = if self.is_regular {
                ([0.0; 2], shared)
            } else {
                let shift = [(); 2].map(|()| HOLE_SHIFT * spread * random.signed());
                (shift, factor(random, spread))
            };
            let middle = hole.middle();
            let is_central = change.old.is_turned && middle.coords.norm() < 1.0;
            let at = Flat::new(change.u(middle.x), change.v(middle.y));
            let place = |shift: [f64; 2], size: f64| {
                hole.remade(|&(x, y, r)| {
                    let (x, y) = ((x - middle.x) * size, (y - middle.y) * size);
                    (at.x + shift[0] + x, at.y + shift[1] + y, r * size)
                })
            };
            let is_free = |hole: &Path| {
                let nodes = hole.nodes(3.0, 0);
                made.iter()
                    .all(|other| nodes.iter().all(|p| other.distance(p) > 6.0))
            };
            let is_within = |hole: &Path| {
                let trim = varied.trim(&varied.outline, std::slice::from_ref(hole));
                !trim.holes.is_empty()
            };
            let still = [0.0; 2];
            let tried = [
                place(if is_central { still } else { shift }, size),
                place(still, size),
                place(still, 1.0),
            ];
            // A hole too near the outline would be left out, and with it what tells a round part's turn.
            let mut free = tried.iter().filter(|hole| is_free(hole));
            let found = free.clone().find(|hole| is_within(hole));
            if let Some(hole) = found.or_else(|| free.next()) {
                made.push(hole.clone());
            }
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use super::super::{SamplePart, SampleSettings, generate};
    use super::*;

    #[test]
    fn no_hole_is_lost_beside_the_outline() {
        for part in SamplePart::ALL {
            let own = Design::of(part);
            let n_pierced =
                |design: &Design| design.trim(&design.outline, &design.holes).holes.len();
            for seed in (0..40).chain([61_000]) {
                let varied = own.varied(&SampleShape { seed, spread: 0.1 });
                assert_eq!(n_pierced(&varied), n_pierced(&own), "{part:?} {seed}");
            }
        }
    }

    #[test]
    fn every_part_has_other_dimensions_and_the_same_holes() {
        for part in SamplePart::ALL {
            let own = Design::of(part);
            for seed in 0..6 {
                let varied = own.varied(&SampleShape { seed, spread: 0.1 });
                assert_eq!(varied.holes.len(), own.holes.len(), "{part:?} {seed}");
                let length = varied.sheet.spine.length() / own.sheet.spine.length();
                let is_other = own.sheet.is_turned || (length - 1.0).abs() > 0.03;
                assert!(is_other && (length - 1.0).abs() < 0.12, "{part:?} {length}");
            }
        }
    }

    #[test]
    fn a_version_changes_the_stamped_side_only() {
        let settings = SampleSettings {
            part: SamplePart::Bracket,
            shape: Some(SampleShape {
                seed: 3,
                spread: 0.1,
            }),
            ..SampleSettings::default()
        };
        let same = generate(&settings);
        let other = generate(&SampleSettings {
            version: Some(SampleShape {
                seed: 4,
                spread: 0.03,
            }),
            ..settings
        });
        assert_eq!(same.crash, other.crash);
        let size = |mesh: &super::super::SampleMesh| mesh.to_trimesh().aabb().diagonal();
        let ratio = size(&other.stamped) / size(&same.stamped);
        assert!(
            (ratio - 1.0).abs() > 0.003 && (ratio - 1.0).abs() < 0.04,
            "{ratio}"
        );
    }
}
