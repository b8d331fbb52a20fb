//! What picking, changing and fitting of point pairs change.

use crate::app::{AppState, Effect, PairCommand, PairTool, PickedPoint, PointPair};
use crate::role::Role;

impl AppState {
    pub(super) fn apply_pairs(&mut self, command: PairCommand) -> Vec<Effect> {
        if command == PairCommand::ToggleTool {
            self.toggle_pair_tool();
            return Vec::new();
        }
        if self.is_unlocked().is_err() {
            return Vec::new();
        }
        match command {
            PairCommand::ToggleTool => {}
            PairCommand::Pick { role, point } => self.pick(role, point),
            PairCommand::Repick { pair, role } => self.repick(pair, role),
            PairCommand::Delete(pair) => {
                self.change_pairs(format!("Delete pair {}", pair + 1), |pairs| {
                    if pair < pairs.len() {
                        pairs.remove(pair);
                    }
                });
                self.forget_repick();
            }
            PairCommand::DeleteAll => {
                self.change_pairs("Delete all pairs".to_owned(), Vec::clear);
                self.forget_repick();
            }
            PairCommand::Fit => self.fit_pairs(),
        }
        Vec::new()
    }

    fn toggle_pair_tool(&mut self) {
        let is_on = self.view.pair_tool.is_some();
        let can = self.has_both_parts().is_ok() && self.is_unlocked().is_ok();
        self.view.pair_tool = (!is_on && can).then(PairTool::default);
        self.drop_previews();
    }

    fn forget_repick(&mut self) {
        if let Some(tool) = &mut self.view.pair_tool {
            tool.repick = None;
        }
    }

    fn pick(&mut self, role: Role, point: PickedPoint) {
        let Some(place) = self.place_of_pick(role) else {
            return;
        };
        let name = format!("Pair {}, {} point", place + 1, role.word());
        self.change_pairs(name, |pairs| {
            if pairs.len() <= place {
                pairs.push(PointPair::default());
            }
            if let Some(pair) = pairs.get_mut(place) {
                *pair.get_mut(role) = Some(point);
            }
        });
        self.forget_repick();
    }

    fn repick(&mut self, pair: usize, role: Role) {
        if pair < self.pairs().len() {
            self.view.pair_tool = Some(PairTool {
                repick: Some((pair, role)),
            });
        }
    }

    /// Pairs of parts that are gone are forgotten with the first change.
    fn change_pairs(&mut self, name: String, change: impl FnOnce(&mut Vec<PointPair>)) {
        let mut pairs = self.pairs().to_vec();
        change(&mut pairs);
        let parts = self.document.stamp().parts;
        self.commit(name, |document| {
            document.pairs.parts = parts;
            document.pairs.pairs = pairs;
        });
    }

    fn fit_pairs(&mut self) {
        if self.can_fit_pairs().is_err() {
            return;
        }
        if let Ok(found) = self.pair_fit() {
            let n_pairs = found.residuals.len();
            let text = format!("{n_pairs} pairs, RMS {}", self.length_text(found.fit.rmse));
            self.commit_pose(
                format!("Fit {n_pairs} pairs"),
                None,
                found.fit.target_from_source,
            );
            self.log_step("pairs", None, text, None);
        }
    }
}
