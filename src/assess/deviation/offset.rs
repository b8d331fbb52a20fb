use super::DeviationStats;

/// Which surfaces of the sheet two meshes stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffsetKind {
    /// Half a thickness apart: one mesh is the tool side, the other the mid-surface.
    ToolSideAgainstMidSurface,
    /// A whole thickness apart: the two meshes are opposite sides of the sheet.
    OppositeSides,
}

/// The parts are the same distance apart nearly everywhere, which is no bad fit but another
/// reference surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantOffset {
    /// Median signed distance, in target length units.
    pub value: f64,
    /// Half the width of the middle half of the values.
    pub spread: f64,
    /// The thickness it was compared with.
    pub thickness: f64,
    /// What it looks like.
    pub kind: OffsetKind,
}

/// The median must be this many spreads away from zero: then hardly any area lies on the other side.
const SIGNIFICANT: f64 = 3.0;
/// And this many times the faceting.
const ABOVE_NOISE: f64 = 2.0;
/// How far the median may be from half or all of the thickness, as a share of the thickness.
const TOLERANCE: f64 = 0.15;

impl ConstantOffset {
    /// Looks for an offset of about half or all of the thickness.
    pub(super) fn of(stats: &DeviationStats, thickness: f64, noise: f64) -> Option<Self> {
        if stats.is_empty() || thickness <= 0.0 {
            return None;
        }
        let value = stats.quantile(0.5);
        let spread = (stats.quantile(0.75) - stats.quantile(0.25)) / 2.0;
        if value.abs() < (SIGNIFICANT * spread).max(ABOVE_NOISE * noise) {
            return None;
        }
        let ratio = value.abs() / thickness;
        let kind = if (ratio - 0.5).abs() <= TOLERANCE {
            OffsetKind::ToolSideAgainstMidSurface
        } else if (ratio - 1.0).abs() <= TOLERANCE {
            OffsetKind::OppositeSides
        } else {
            return None;
        };
        Some(Self {
            value,
            spread,
            thickness,
            kind,
        })
    }

    /// What it looks like, with a length as the caller writes lengths:
    /// "looks like tool side against mid-surface, 0.6 mm".
    pub fn words(&self, length: impl Fn(f64) -> String) -> String {
        let distance = length(self.value.abs());
        match self.kind {
            OffsetKind::ToolSideAgainstMidSurface => {
                format!("looks like tool side against mid-surface, {distance}")
            }
            OffsetKind::OppositeSides => {
                format!("looks like one side of the sheet against the other, {distance}")
            }
        }
    }
}
