//! What picking, changing and fitting of point pairs change.

use super::{PairCommand, PairTool, PairsState, PickedPoint, PointPair, place_of};
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{LogStep, NoticeLevel};
use crate::role::Role;
use crate::text::counted;

impl PairsState {
    pub(in crate::app) fn apply(&mut self, work: &mut Work<'_>, command: PairCommand) {
        if command == PairCommand::ToggleTool {
            self.toggle_tool(work);
            return;
        }
        if work.is_unlocked().is_err() {
            return;
        }
        match command {
            PairCommand::ToggleTool => {}
            PairCommand::Pick { role, point } => self.pick(work, role, point),
            PairCommand::Repick { pair, role } => self.repick(work, pair, role),
            PairCommand::Delete(pair) => {
                change_pairs(work, format!("Delete pair {}", pair + 1), |pairs| {
                    if pair < pairs.len() {
                        pairs.remove(pair);
                    }
                });
                self.forget_repick();
            }
            PairCommand::DeleteAll => {
                change_pairs(work, "Delete all pairs".to_owned(), Vec::clear);
                self.forget_repick();
            }
            PairCommand::Fit => fit_pairs(work),
        }
    }

    fn toggle_tool(&mut self, work: &mut Work<'_>) {
        let is_on = self.tool.is_some();
        let can = work.document.has_both_parts().is_ok() && work.is_unlocked().is_ok();
        self.tool = (!is_on && can).then(PairTool::default);
        work.previews.drop_all();
        if self.tool.is_some() {
            work.follow(FollowUp::PairsBegun);
        }
    }

    fn forget_repick(&mut self) {
        if let Some(tool) = &mut self.tool {
            tool.repick = None;
        }
    }

    fn pick(&mut self, work: &mut Work<'_>, role: Role, point: PickedPoint) {
        let Some(place) = self.place_of_pick(work.document, role) else {
            return;
        };
        let known = work.document.current_pairs().get(place);
        let is_replaced = known.is_some_and(|pair| pair.get(role).is_some());
        if is_replaced && self.tool.is_some_and(|tool| tool.repick.is_none()) {
            let text = format!(
                "The {} point of pair {} is picked anew; the next one is {}",
                role.word(),
                place + 1,
                place_of(role.other())
            );
            work.notify(NoticeLevel::Note, text);
        }
        let name = format!("Pair {}, {} point", place + 1, role.word());
        change_pairs(work, name, |pairs| {
            if pairs.len() <= place {
                pairs.push(PointPair::default());
            }
            if let Some(pair) = pairs.get_mut(place) {
                *pair.get_mut(role) = Some(point);
            }
        });
        self.forget_repick();
    }

    fn repick(&mut self, work: &mut Work<'_>, pair: usize, role: Role) {
        if pair < work.document.current_pairs().len() {
            self.tool = Some(PairTool {
                repick: Some((pair, role)),
            });
            work.follow(FollowUp::PairsBegun);
        }
    }
}

/// Pairs of parts that are gone are forgotten with the first change.
fn change_pairs(work: &mut Work<'_>, name: String, change: impl FnOnce(&mut Vec<PointPair>)) {
    let mut pairs = work.document.current_pairs().to_vec();
    change(&mut pairs);
    let parts = work.document.stamp().parts;
    work.commit(name, |document| {
        document.pairs.parts = parts;
        document.pairs.pairs = pairs;
    });
}

fn fit_pairs(work: &mut Work<'_>) {
    if work.document.can_fit_pairs(work.jobs).is_err() {
        return;
    }
    if let Ok(found) = work.document.pair_fit() {
        let pairs = counted(found.residuals.len(), "pair");
        let text = format!("{pairs}, RMS {}", work.lengths().of(found.fit.rmse));
        work.commit_pose(format!("Fit {pairs}"), None, found.fit.target_from_source);
        work.log_step(LogStep::Pairs, None, text, None);
    }
}
