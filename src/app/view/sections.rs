//! Which of the four sections of the left column are unfolded.

use super::Section;

/// A section that was folded for want of room comes back only when so much more is free, so that a
/// line of text more or less does not fold it to and fro. In points.
const SLACK: f32 = 32.0;

/// What the user asked for, and what was used last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sections {
    is_open: [bool; 4],
    /// The sections in order of their last use, the latest first.
    order: [Section; 4],
    /// They may fold and unfold as their contents ask: after a main step, until something else is done.
    is_arranging: bool,
    /// The one that the user asked for last, since they are no longer arranged.
    asked: Option<Section>,
}

impl Default for Sections {
    fn default() -> Self {
        Self {
            // The mapping comes once there is a pose to map with.
            is_open: [true, true, true, false],
            order: Section::ALL,
            is_arranging: true,
            asked: None,
        }
    }
}

impl Sections {
    /// True unless the user folded it.
    pub fn is_open(&self, section: Section) -> bool {
        self.is_open[section.index()]
    }

    /// A part was loaded, matched or mapped: the sections are arranged for what comes next.
    pub fn arrange(&mut self) {
        self.is_arranging = true;
    }

    /// Something between the main steps is done, such as an undo or a move by hand: none folds or unfolds by it.
    pub fn hold(&mut self) {
        if std::mem::take(&mut self.is_arranging) {
            self.asked = None;
        }
    }

    /// Whether they are arranged by their contents.
    pub fn is_arranging(&self) -> bool {
        self.is_arranging
    }

    /// The section that is worked in.
    pub fn in_use(&self) -> Section {
        self.order[0]
    }

    /// The user works in this section now.
    pub fn touch(&mut self, section: Section) {
        let at = self.order.iter().position(|s| *s == section).unwrap_or(0);
        self.order[..=at].rotate_right(1);
    }

    /// The user turns to this section.
    pub fn ask_for(&mut self, section: Section) {
        self.touch(section);
        self.asked = Some(section);
    }

    /// The user folds or unfolds a section; this wins over everything that follows from room.
    pub fn set_open(&mut self, section: Section, is_open: bool) {
        self.is_open[section.index()] = is_open;
        if is_open {
            self.ask_for(section);
        }
    }

    /// Unfolds a section where there is room; those that were used keep the right of way.
    pub fn unfold(&mut self, section: Section) {
        self.is_open[section.index()] = true;
    }

    /// Which sections are drawn unfolded when their bodies are so high and so much room is left
    /// beside the headers.
    ///
    /// Where not all fit, those used last have the right of way, and the latest is always shown.
    /// `before` is the answer of the frame before.
    pub fn shown(&self, bodies: [f32; 4], room: f32, before: [bool; 4]) -> [bool; 4] {
        let mut shown = [false; 4];
        let mut left = room;
        let mut is_first = true;
        for index in self.order.map(Section::index) {
            if !self.is_open[index] {
                continue;
            }
            let slack = if before[index] { 0.0 } else { SLACK };
            if is_first || bodies[index] + slack <= left {
                shown[index] = true;
                left -= bodies[index];
            }
            is_first = false;
        }
        shown
    }

    /// Which sections stay unfolded between the main steps: those that were, less what the user folds, with what
    /// the user unfolds.
    pub fn held(&self, before: [bool; 4]) -> [bool; 4] {
        Section::ALL.map(|section| {
            let was_shown = before[section.index()] || self.asked == Some(section);
            was_shown && self.is_open(section)
        })
    }

    /// Which sections stay unfolded once the user works in the column: none is folded for want of room
    /// any more, so that nothing moves away from under the pointer, and a new one is shown where it
    /// fits below or was asked for.
    pub fn kept(&self, bodies: [f32; 4], room: f32, before: [bool; 4]) -> [bool; 4] {
        let mut shown = before;
        for (index, shown) in shown.iter_mut().enumerate() {
            *shown &= self.is_open[index];
        }
        let in_use = self.in_use().index();
        shown[in_use] |= self.is_open[in_use];
        let mut left = room;
        for index in 0..shown.len() {
            if shown[index] {
                left -= bodies[index];
            }
        }
        for index in in_use + 1..shown.len() {
            let fits = bodies[index] + SLACK <= left;
            if self.is_open[index] && !shown[index] && fits {
                shown[index] = true;
                left -= bodies[index];
            }
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODIES: [f32; 4] = [200.0, 240.0, 500.0, 300.0];

    #[test]
    fn all_are_shown_where_there_is_room() {
        let sections = Sections::default();
        assert_eq!(
            sections.shown(BODIES, 1000.0, [true; 4]),
            [true, true, true, false]
        );
    }

    #[test]
    fn without_room_those_used_last_stay() {
        let mut sections = Sections::default();
        sections.touch(Section::Reduce);
        sections.touch(Section::Match);
        let shown = |room| sections.shown(BODIES, room, [true; 4]);
        assert_eq!(shown(800.0), [false, true, true, false]);
        assert_eq!(shown(600.0), [false, false, true, false]);
        // What is older may still fit where the one between does not.
        assert_eq!(shown(720.0), [true, false, true, false]);
        // The one in use stays even where it does not fit.
        assert_eq!(shown(100.0), [false, false, true, false]);
    }

    #[test]
    fn what_the_user_says_wins() {
        let mut sections = Sections::default();
        sections.set_open(Section::Match, false);
        assert_eq!(
            sections.shown(BODIES, 9e9, [true; 4]),
            [true, true, false, false]
        );
        sections.touch(Section::Match);
        assert!(!sections.shown(BODIES, 9e9, [true; 4])[2]);
        sections.set_open(Section::Match, true);
        assert_eq!(sections.in_use(), Section::Match);
        assert_eq!(
            sections.shown(BODIES, 500.0, [true; 4]),
            [false, false, true, false]
        );
    }

    #[test]
    fn a_folded_section_waits_for_more_than_just_enough() {
        let mut sections = Sections::default();
        sections.touch(Section::Match);
        let bodies = [200.0, 0.0, 500.0, 0.0];
        assert!(sections.shown(bodies, 710.0, [true; 4])[0]);
        assert!(!sections.shown(bodies, 710.0, [false, true, true, false])[0]);
        assert!(sections.shown(bodies, 740.0, [false, true, true, false])[0]);
    }

    #[test]
    fn between_the_main_steps_only_the_user_folds_and_unfolds() {
        let mut sections = Sections::default();
        sections.ask_for(Section::Load);
        sections.hold();
        let before = [false, false, true, false];
        // What another section has to do with it does not unfold it.
        sections.touch(Section::Reduce);
        assert_eq!(sections.held(before), before);
        sections.set_open(Section::Load, true);
        let both = [true, false, true, false];
        assert_eq!(sections.held(before), both);
        sections.set_open(Section::Match, false);
        assert_eq!(sections.held(both), [true, false, false, false]);
    }

    #[test]
    fn nothing_folds_by_itself_once_the_column_is_used() {
        let mut sections = Sections::default();
        sections.touch(Section::Match);
        let all = [true, true, true, false];
        // The match grows beyond the room: the column scrolls instead.
        assert_eq!(sections.kept([200.0, 240.0, 900.0, 0.0], 600.0, all), all);
        // What the user folds goes, and comes back on request alone.
        sections.set_open(Section::Reduce, false);
        let kept = sections.kept(BODIES, 9e9, all);
        assert_eq!(kept, [true, false, true, false]);
        sections.set_open(Section::Reduce, true);
        assert_eq!(sections.kept(BODIES, 100.0, kept), all);
        // One below that opens by itself needs room; one above would push the work away.
        sections.touch(Section::Match);
        sections.unfold(Section::Map);
        assert_eq!(sections.kept(BODIES, 500.0, all), all);
        assert_eq!(sections.kept(BODIES, 1300.0, all), [true; 4]);
        let below = [false, true, true, false];
        assert!(!sections.kept(BODIES, 9e9, below)[0]);
    }
}
