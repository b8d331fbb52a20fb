//! The survivors of the wide search as starts of the match.

use std::sync::{Arc, OnceLock};

use super::starts::{Start, StartKind};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::agreement::same_pose;
use crate::registration::input::MatchInput;
use crate::registration::result::Side;
use crate::registration::surface::Surface;
use crate::registration::wide::{WideFind, WideSearch, surface_grid};
use crate::search::FeatureGrid;

/// A survivor is worth an exact look if its loss is at most so many times the best one's …
const WORTH_LOSS: f64 = 3.0;
/// … plus this.
const WORTH_MORE: f64 = 0.1;

/// Motions of the larger part on itself with a larger loss align nothing with its like.
const ALIKE_LOSS: f64 = 0.7;

/// The wide search of a pair, made ready once for both hands. The smaller part is the data.
pub(crate) struct WideStarts<'a> {
    search: WideSearch<'a>,
    data_side: Side,
    surfaces: [&'a Surface; 2],
    /// Source and target as grids, made when first asked for.
    grids: [Option<Arc<FeatureGrid>>; 2],
    /// What the wide search of the larger part on itself finds, which is searched when first asked for.
    on_itself: OnceLock<Vec<WideFind>>,
}

/// Where the surface and the grid of a side stand.
fn place_of(side: Side) -> usize {
    match side {
        Side::Source => 0,
        Side::Target => 1,
    }
}

impl<'a> WideStarts<'a> {
    /// On the meshes of the coarse stage. `None` if a surface has no extent.
    pub(crate) fn of(input: &MatchInput<'a>) -> Option<Self> {
        let (source, target) = input.reduced.unwrap_or((input.source, input.target));
        let (data_side, data, model) = if target.measures().area < source.measures().area {
            (Side::Target, target, source)
        } else {
            (Side::Source, source, target)
        };
        let grid = Arc::new(surface_grid(model)?);
        let mut grids = [None, None];
        grids[place_of(data_side.other())] = Some(Arc::clone(&grid));
        Some(Self {
            search: WideSearch::on(data, model, grid),
            data_side,
            surfaces: [source, target],
            grids,
            on_itself: OnceLock::new(),
        })
    }

    /// One of the surfaces as a grid.
    pub(crate) fn grid(&mut self, side: Side) -> Option<Arc<FeatureGrid>> {
        let index = place_of(side);
        if self.grids[index].is_none() {
            self.grids[index] = surface_grid(self.surfaces[index]).map(Arc::new);
        }
        self.grids[index].clone()
    }

    /// The larger part as a grid.
    pub(crate) fn larger(&self) -> Option<Arc<FeatureGrid>> {
        self.grids[place_of(self.data_side.other())].clone()
    }

    /// Poses in which the smaller part lies on another place of the larger one that is shaped like the
    /// one it lies on under `start` (target from source, in the frames that were searched): what the
    /// wide search of the larger part on itself finds. Empty for parts of one size, whose own wide
    /// search has seen these places.
    pub(crate) fn alike(&self, start: &Start, monitor: &Monitor) -> Result<Vec<Start>, Cancelled> {
        let model = self.surfaces[place_of(self.data_side.other())];
        let Some(grid) = self.larger().filter(|_| !self.search.is_whole()) else {
            return Ok(Vec::new());
        };
        let found = match self.on_itself.get() {
            Some(found) => found,
            None => {
                let found = WideSearch::on(model, model, grid).run(monitor)?;
                self.on_itself.get_or_init(|| found)
            }
        };
        let extent = model.measures().into();
        let is_other =
            |find: &&WideFind| !same_pose(&find.model_from_data, &Similarity::identity(), &extent);
        let likely = found.iter().filter(|find| find.loss < ALIKE_LOSS);
        let starts = likely
            .filter(is_other)
            .enumerate()
            .map(|(index, find)| Start {
                kind: StartKind::Alike { index },
                flipped: start.flipped != find.flipped,
                target_from_source: match self.data_side {
                    Side::Source => find.model_from_data.after(&start.target_from_source),
                    Side::Target => start
                        .target_from_source
                        .after(&find.model_from_data.inverse()),
                },
            });
        Ok(starts.collect())
    }

    /// The distinct survivors that are worth an exact look, best first.
    pub(crate) fn find(&self, monitor: &Monitor) -> Result<Vec<Start>, Cancelled> {
        Ok(self.worth_a_look(&self.search.run(monitor)?))
    }

    /// Those of the opposite hand.
    pub(crate) fn find_opposite(&self, monitor: &Monitor) -> Result<Vec<Start>, Cancelled> {
        Ok(self.worth_a_look(&self.search.run_mirrored(monitor)?))
    }

    fn worth_a_look(&self, found: &[WideFind]) -> Vec<Start> {
        let best = found.first().map_or(0.0, |find| find.loss);
        let is_worth = |find: &&WideFind| find.loss <= WORTH_LOSS * best + WORTH_MORE;
        let starts = found.iter().take_while(is_worth).map(|find| Start {
            kind: find.kind,
            flipped: find.flipped,
            target_from_source: self.data_side.oriented(&find.model_from_data),
        });
        starts.collect()
    }
}
