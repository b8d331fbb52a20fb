//! What a change in one topic asks of the others.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::{
    AppState, BottomTab, Document, Effect, FreeWindow, LogStep, NoticeLevel, Part, Section,
    Showing, ShownGeometry,
};
use crate::geometry::{Aabb, Point3};
use crate::jobs::ProjectRequest;
use crate::role::{PerRole, Role};

/// Moves of the centre up to this share of the part's size leave the cameras alone.
const NUDGE: f64 = 0.25;

/// Where the parts lie.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// Of each part, in its own frame.
    bounds: PerRole<Option<Aabb>>,
    /// The centre of the stamped part at its pose.
    stamped_center: Option<Point3>,
}

impl Places {
    pub(super) fn of(document: &Document) -> Self {
        Self {
            bounds: PerRole::from_fn(|role| document.part(role).map(|part| part.bounds())),
            stamped_center: document.stamped_center(),
        }
    }
}

/// What happened in one topic that others follow.
#[derive(Debug, Clone)]
pub(super) enum FollowUp {
    /// A file that was opened is a project.
    OpenProject(ProjectRequest),
    /// Crash and stamped part changed places.
    PartsSwapped,
    /// A part was read.
    PartLoaded {
        role: Role,
        /// It lies where the same file had it before.
        is_in_place: bool,
    },
    /// A part was closed.
    PartClosed,
    /// A part took another selection or unit.
    PartReselected(Role),
    /// The part that was chosen to be matched at once is made.
    PartChosen,
    /// Further stamped files are to be read again: all, or those of these files.
    ReadFurtherAgain(Option<BTreeSet<PathBuf>>),
    /// The further stamped files went with the crash part that they stood for.
    FurtherDropped,
    /// A level was made.
    LevelMade,
    /// A match was taken over.
    Matched {
        /// Where the centre of the stamped part was before.
        before: Option<Point3>,
        level: NoticeLevel,
        /// What came out, in a line.
        line: String,
    },
    /// The stamped part was moved by hand.
    MovedByHand,
    /// A further stamped file lies at a pose, and is seen there.
    FurtherPlaced,
    /// A mapping was taken over.
    Mapped,
    /// Another mapper's result stands beside the mapping.
    MappingCompared,
    /// A sweep began.
    SweepBegun,
    /// A sweep ended with its tables.
    SweepEnded,
    /// A comparison was cancelled.
    ComparisonEnded,
    /// A place is to be seen close up.
    LookAt(Role, Point3),
    /// The section was turned on or off.
    SectionToggled,
    /// A distance is to be measured: a click has this one meaning.
    DistanceBegun,
    /// Pairs of points are to be picked: a click has this one meaning.
    PairsBegun,
    /// The document is that of another step; the parts lay there before.
    SteppedInHistory(Places),
    /// The project is to be written there, over the one that was saved at that time.
    WriteProject(PathBuf, Option<u64>),
    /// The session is to be kept in case of a crash, if there is something new.
    Autosave,
    /// The program is to be left.
    Quit,
}

/// What is said of parts as they are, and of where they lie.
const OF_PARTS: [LogStep; 4] = [
    LogStep::Match,
    LogStep::Result,
    LogStep::Verdict,
    LogStep::Map,
];

impl AppState {
    pub(super) fn follow(&mut self, follow_up: FollowUp) -> Vec<Effect> {
        match follow_up {
            FollowUp::OpenProject(request) => {
                let (mut work, topics) = self.split();
                let dialog = &mut topics.view.dialog;
                return topics.project.open(&mut work, request, dialog);
            }
            FollowUp::PartsSwapped => self.see_swapped(),
            FollowUp::PartLoaded { role, is_in_place } => {
                if !is_in_place {
                    self.with_scene(|view, scene| view.fit_after_load(role, scene));
                }
                self.inspect.section = self.section_of_parts();
                self.leave_empty_views();
                self.go_on_from_load();
            }
            FollowUp::PartClosed => self.leave_empty_views(),
            FollowUp::PartReselected(role) => {
                self.withdraw_about(&OF_PARTS);
                self.with_scene(|view, scene| view.fit_part(role, scene));
                let (mut work, topics) = self.split();
                return topics.reduce.reduce_again(&mut work, role);
            }
            FollowUp::PartChosen => return self.match_chosen(),
            FollowUp::ReadFurtherAgain(changed) => {
                return self.read_further_again(changed.as_ref());
            }
            FollowUp::FurtherDropped => {
                let (mut work, topics) = self.split();
                return topics.mapping.clear_list(&mut work);
            }
            FollowUp::LevelMade => self.view.shown = ShownGeometry::Reduced,
            FollowUp::Matched {
                before,
                level,
                line,
            } => self.see_matched(before, level, line),
            FollowUp::MovedByHand => {
                self.withdraw_about(&[LogStep::Map]);
                self.view.stay();
            }
            FollowUp::FurtherPlaced => {
                self.with_scene(|view, scene| view.keep_whole(Role::Stamped, scene));
            }
            FollowUp::SectionToggled => self.show_section(),
            FollowUp::DistanceBegun => self.pairs.tool = None,
            FollowUp::PairsBegun => self.inspect.distance = None,
            FollowUp::Mapped => self.see_mapped(),
            FollowUp::MappingCompared => {
                self.view.display = self.with_other_result();
                self.view.tab = BottomTab::Mapping;
            }
            FollowUp::SweepBegun => self.view.tab = BottomTab::Sweep,
            FollowUp::SweepEnded => self.keep_sweep_levels(),
            FollowUp::ComparisonEnded => {
                let stamp = self.document.stamp();
                self.inspect.give_up_comparing(stamp);
            }
            FollowUp::LookAt(role, point) => {
                self.with_scene(|view, scene| view.look_at(role, &point, scene));
            }
            FollowUp::SteppedInHistory(before) => {
                self.parts.forget_missing(&self.document);
                self.parts.refresh_likeness(&self.document);
                self.follow_step(&before);
                self.leave_what_needs_parts();
                // What was found at the marked place may be found there no more.
                self.inspect.forget_place();
            }
            FollowUp::WriteProject(path, replaces) => {
                return vec![self.write_project(path, replaces)];
            }
            FollowUp::Autosave => return self.autosave(),
            FollowUp::Quit => return self.leave(),
        }
        Vec::new()
    }

    fn keep_sweep_levels(&mut self) {
        if let Some(sweep) = self.matching.sweep(&self.document) {
            self.reduce.keep_sweep_levels(&self.document, sweep);
        }
    }

    fn match_chosen(&mut self) -> Vec<Effect> {
        let (mut work, topics) = self.split();
        topics.matching.run_match(&mut work)
    }

    fn read_further_again(&mut self, changed: Option<&BTreeSet<PathBuf>>) -> Vec<Effect> {
        let (mut work, topics) = self.split();
        topics.mapping.read_again(&mut work, |part| {
            let is_among =
                |files: &BTreeSet<PathBuf>| part.files().iter().any(|file| files.contains(file));
            changed.is_none_or(is_among)
        })
    }

    fn write_project(&self, path: PathBuf, replaces: Option<u64>) -> Effect {
        Effect::WriteProject {
            path,
            replaces,
            project: Box::new(self.to_project(0)),
            kept: Box::new(self.kept()),
        }
    }

    /// The cameras go with their parts, each of which lies where its own file has it now.
    fn see_swapped(&mut self) {
        // One window for both has one camera.
        if !self.view.is_moved_over {
            self.view.cameras.swap();
        }
        self.with_scene(|view, scene| view.fit_both(scene));
    }

    fn see_matched(&mut self, before: Option<Point3>, level: NoticeLevel, line: String) {
        self.withdraw_about(&OF_PARTS);
        // That the results of a project are out of date.
        self.withdraw_about(&[LogStep::Project]);
        self.log.notices.withdraw_answers();
        self.tell_result(level, line);
        if let Some(result) = &self.document.result {
            self.reduce.keep_match_level(&self.document, &result.run);
        }
        self.show_verdict();
        self.follow_far_move(before);
    }

    fn see_mapped(&mut self) {
        self.withdraw_about(&[LogStep::Map]);
        self.log.notices.withdraw_answers();
        self.view.sections.arrange();
        // Whoever looks at distances or at parts wants to see what came of the mapping.
        if !self.is_mapping_shown() {
            self.view.display = self.with_map_picture(None);
        }
        self.view.tab = BottomTab::Mapping;
    }

    /// What was said of these steps before this moment no longer holds.
    fn withdraw_about(&mut self, steps: &[LogStep]) {
        let now = self.log.now;
        self.log.notices.withdraw_about(steps, now);
    }

    /// Other parts are there: ends what was said of those before, and leaves what shows nothing any more: both parts in
    /// one window, and the tab of a mapping.
    fn leave_empty_views(&mut self) {
        self.withdraw_about(&OF_PARTS);
        self.leave_what_needs_parts();
        if self.view.tab == BottomTab::Mapping && self.document.mapping.result.is_none() {
            self.view.tab = BottomTab::Log;
        }
    }

    /// Without both parts the one that is left has its own window again; without any there is nothing to cut.
    fn leave_what_needs_parts(&mut self) {
        let is_one = self.document.has_both_parts().is_err();
        if is_one && self.view.is_moved_over {
            self.with_scene(|view, scene| view.toggle_move_over(scene));
        }
        if self.view.tab == BottomTab::Section && self.document.has_any_part().is_err() {
            self.view.tab = BottomTab::Log;
        }
    }

    /// Two single parts need no choice, so the sections after loading come next; a deck of many
    /// parts is chosen from first.
    fn go_on_from_load(&mut self) {
        self.view.sections.arrange();
        let is_single = |part: &Part| part.facts.parts.len() <= 1;
        let is_plain = |both: PerRole<&Part>| is_single(both.crash) && is_single(both.stamped);
        if let Some(both) = self.document.both() {
            // The match comes next; parts may be reduced before where there is room, and are chosen where there are
            // many.
            let [second, first] = if is_plain(both) {
                [Section::Reduce, Section::Match]
            } else {
                [Section::Match, Section::Load]
            };
            self.view.sections.touch(second);
            self.view.sections.touch(first);
        }
        // The result of the file as it was before: what is to be done about it is there.
        if self.document.result.is_some() && self.document.current_result().is_none() {
            self.view.sections.touch(Section::Match);
        }
        // What is asked about the files is answered before anything else.
        if self.open_question(Section::Load).is_some() {
            self.view.sections.touch(Section::Load);
        }
    }

    /// The card of section 3 says the result; a toast over the part says it only where the card is not
    /// to be seen. The bell has it in any case.
    fn tell_result(&mut self, level: NoticeLevel, line: String) {
        let is_seen = self.view.sections.is_open(Section::Match) && !self.view.is_graphics_only;
        let is_muted = is_seen || self.settings.muted.contains(&level);
        let showing = Showing {
            now: self.log.now,
            is_muted,
            about: Some(LogStep::Result),
        };
        self.log.notices.push(level, line, showing);
    }

    /// The verdict is seen, whatever else has to fold for it; the next section comes where there is room.
    pub(super) fn show_verdict(&mut self) {
        self.view.sections.arrange();
        self.view.sections.unfold(Section::Map);
        self.view.sections.touch(Section::Match);
    }

    /// The outlines are drawn beside the parts: in the free window, or in a tab where there is none.
    fn show_section(&mut self) {
        let is_on = self.inspect.section.is_on;
        let (view, tab) = (&mut self.view, BottomTab::Section);
        match (is_on, view.is_moved_over) {
            (true, true) => view.free_window = Some(FreeWindow::Section),
            (true, false) => view.tab = tab,
            (false, _) if view.tab == tab => view.tab = BottomTab::Log,
            (false, _) => {}
        }
    }

    /// Where a step in the history brings another part or unit, the cameras go there.
    fn follow_step(&mut self, before: &Places) {
        let after = Places::of(&self.document);
        for role in Role::ALL {
            if before.bounds.get(role) != after.bounds.get(role) {
                self.with_scene(|view, scene| view.fit_after_load(role, scene));
            }
        }
        if before.bounds.stamped == after.bounds.stamped {
            self.follow_far_move(before.stamped_center);
        }
    }

    /// A part that went far is no longer where the cameras look; one that was nudged still is.
    fn follow_far_move(&mut self, before: Option<Point3>) {
        let (Some(before), Some(after)) = (before, self.document.stamped_center()) else {
            return;
        };
        let part = self.document.part(Role::Stamped);
        let size = part.map_or(0.0, |part| part.bounds().diagonal());
        if (after - before).norm() < NUDGE * size {
            return;
        }
        let is_over = self.view.is_moved_over;
        self.with_scene(|view, scene| {
            view.fit_all(Role::Stamped, scene);
            if is_over {
                view.fit_all(Role::Crash, scene);
            }
        });
    }
}
