//! Messages to the user: level, text, repeats.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::app::{Action, LogStep};
use crate::jobs::JobKey;
use crate::text::capital;

/// How loud a message is, quiet first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum NoticeLevel {
    /// Shown in the log only.
    Info,
    /// A short toast.
    Success,
    /// A toast, and a line in the bell's list.
    Note,
    /// Stays a minute; the bell keeps it.
    Warning,
    /// Stays until it is closed, or what failed has worked.
    Error,
}

impl NoticeLevel {
    /// Those that have toasts, quiet first.
    pub const TOLD: [Self; 4] = [Self::Success, Self::Note, Self::Warning, Self::Error];

    /// Name of the level in the log.
    pub fn label(self) -> &'static str {
        match self {
            Self::Info => "Steps",
            Self::Success => "Successes",
            Self::Note => "Notes",
            Self::Warning => "Warnings",
            Self::Error => "Errors",
        }
    }

    /// How long the toast stays; `None` until it is dismissed, zero for no toast.
    pub fn lifetime(self) -> Option<Duration> {
        match self {
            Self::Info => Some(Duration::ZERO),
            Self::Success => Some(Duration::from_secs(4)),
            Self::Note => Some(Duration::from_secs(8)),
            Self::Warning => Some(Duration::from_secs(60)),
            Self::Error => None,
        }
    }

    /// True if the bell's list keeps it.
    pub fn is_kept(self) -> bool {
        self >= Self::Note
    }

    /// The sign that goes with the colour.
    pub fn mark(self) -> &'static str {
        match self {
            Self::Info => "",
            Self::Success => "✔",
            Self::Note => "ℹ",
            Self::Warning => "⚠",
            Self::Error => "✖",
        }
    }
}

/// Name of one notice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NoticeId(pub u64);

/// One message to the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Notice {
    /// Number by which it is dismissed.
    pub id: NoticeId,
    /// How loud it is.
    pub level: NoticeLevel,
    /// What happened, where, and what can be done.
    pub text: String,
    /// How often it came (×12).
    pub count: usize,
    /// When it last came, since the program began.
    pub at: Duration,
    /// True until it was read or dismissed.
    pub is_unread: bool,
    /// What the user may want to do about it, beside closing it.
    pub offers: Vec<Action>,
    /// The job that failed, if it reports one.
    of_job: Option<JobKey>,
    about: Option<LogStep>,
    /// Says why what was just asked for is not possible.
    is_answer: bool,
    is_toast: bool,
}

impl Notice {
    /// As toast and bell write it: with a capital, and how often it came.
    pub fn shown(&self) -> String {
        let text = capital(&self.text);
        match self.count {
            0 | 1 => text,
            n => format!("{text} (×{n})"),
        }
    }
}

/// Most toasts on the screen at once.
pub const MAX_TOASTS: usize = 2;
/// Messages the bell's list keeps.
const MAX_KEPT: usize = 200;

/// When and how a message is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Showing {
    /// Time since the program began.
    pub now: Duration,
    /// True if it goes into the bell's list only.
    pub is_muted: bool,
    /// What it is about, if it is a step of the work.
    pub about: Option<LogStep>,
}

/// The toasts and the bell's list.
#[derive(Debug, Clone, Default)]
pub struct Notices {
    items: Vec<Notice>,
    n_given: u64,
}

impl Notices {
    /// Shows a message; the same message again only counts up and shows anew.
    pub fn push(&mut self, level: NoticeLevel, text: String, showing: Showing) {
        self.add(level, text, showing, &[]);
    }

    /// [`Notices::push`] with a button for each of these actions.
    pub fn offer(&mut self, level: NoticeLevel, text: String, showing: Showing, offers: &[Action]) {
        self.add(level, text, showing, offers);
    }

    fn add(&mut self, level: NoticeLevel, text: String, showing: Showing, offers: &[Action]) {
        if level == NoticeLevel::Info {
            return;
        }
        let same = |n: &Notice| n.level == level && n.text == text;
        let count = match self.items.iter().position(same) {
            Some(index) => self.items.remove(index).count + 1,
            None => 1,
        };
        self.n_given += 1;
        self.items.push(Notice {
            id: NoticeId(self.n_given),
            level,
            text,
            count,
            at: showing.now,
            is_unread: true,
            offers: offers.to_vec(),
            of_job: None,
            about: showing.about,
            is_answer: false,
            is_toast: !showing.is_muted,
        });
        if self.items.len() > MAX_KEPT {
            self.items.remove(0);
        }
    }

    /// Ends toasts whose time is over.
    pub fn expire(&mut self, now: Duration) {
        for notice in &mut self.items {
            let lifetime = notice.level.lifetime();
            if lifetime.is_some_and(|lifetime| now.saturating_sub(notice.at) >= lifetime) {
                notice.is_toast = false;
            }
        }
        self.items.retain(|n| n.is_toast || n.level.is_kept());
    }

    /// Closes a toast and marks it read.
    pub fn dismiss(&mut self, id: NoticeId) {
        for notice in self.items.iter_mut().filter(|n| n.id == id) {
            notice.is_toast = false;
            notice.is_unread = false;
        }
    }

    /// What a message says is no longer so.
    pub fn withdraw_text(&mut self, text: &str) {
        for notice in self.items.iter_mut().filter(|n| n.text == text) {
            notice.is_toast = false;
            notice.is_unread = false;
        }
    }

    /// What was done then was taken back: what was said of it no longer holds. Errors stay until they are closed.
    pub fn withdraw_from(&mut self, at: Duration) {
        let is_meant = |n: &&mut Notice| n.at == at && n.level != NoticeLevel::Error;
        for notice in self.items.iter_mut().filter(is_meant) {
            notice.is_toast = false;
            notice.is_unread = false;
        }
    }

    /// What was said before about these steps is about other parts or another pose. Errors stay until they are closed.
    pub(in crate::app) fn withdraw_about(&mut self, steps: &[LogStep], now: Duration) {
        let is_meant = |n: &&mut Notice| {
            n.about.is_some_and(|about| steps.contains(&about))
                && n.at < now
                && n.level != NoticeLevel::Error
        };
        for notice in self.items.iter_mut().filter(is_meant) {
            notice.is_toast = false;
            notice.is_unread = false;
        }
    }

    /// The newest message answers what was just asked for: no one has to be told of it later.
    pub(in crate::app) fn last_is_answer(&mut self) {
        if let Some(last) = self.items.last_mut() {
            last.is_unread = false;
            last.is_answer = true;
        }
    }

    /// What was not possible before may be possible now.
    pub(in crate::app) fn withdraw_answers(&mut self) {
        for notice in self.items.iter_mut().filter(|n| n.is_answer) {
            notice.is_toast = false;
        }
    }

    /// The newest message reports a failed job.
    pub(in crate::app) fn last_is_of(&mut self, job: JobKey) {
        if let Some(last) = self.items.last_mut() {
            last.of_job = Some(job);
        }
    }

    /// A job has worked: that it failed before is solved.
    pub(in crate::app) fn withdraw_job(&mut self, job: JobKey) {
        let is_again = |of: JobKey| of == job || of.is_export() && job.is_export();
        let is_meant = |n: &&mut Notice| n.of_job.is_some_and(is_again);
        for notice in self.items.iter_mut().filter(is_meant) {
            notice.is_toast = false;
            notice.is_unread = false;
        }
    }

    /// Closes all toasts; false if there is none. The bell keeps them.
    pub(in crate::app) fn close_toasts(&mut self) -> bool {
        let mut is_any = false;
        for notice in self.items.iter_mut().filter(|n| n.is_toast) {
            notice.is_toast = false;
            is_any = true;
        }
        is_any
    }

    /// What an action was offered for is over.
    pub fn withdraw(&mut self, action: Action) {
        for notice in &mut self.items {
            if notice.offers.contains(&action) {
                notice.is_toast = false;
                notice.is_unread = false;
                notice.offers.clear();
            }
        }
    }

    /// The bell was opened: all is read, and warnings no longer cover the view.
    pub fn mark_read(&mut self) {
        for notice in &mut self.items {
            notice.is_unread = false;
            if notice.level != NoticeLevel::Error {
                notice.is_toast = false;
            }
        }
    }

    /// The toasts to be drawn, newest first, at most two.
    pub fn toasts(&self) -> impl Iterator<Item = &Notice> {
        let shown = self.items.iter().rev().filter(|n| n.is_toast);
        shown.take(MAX_TOASTS)
    }

    /// The bell's list, newest first.
    pub fn kept(&self) -> impl Iterator<Item = &Notice> {
        self.items.iter().rev().filter(|n| n.level.is_kept())
    }

    /// Unread lines in the bell's list.
    pub fn n_unread(&self) -> usize {
        self.kept().filter(|n| n.is_unread).count()
    }

    /// When the next toast ends, so that an idle window knows when to draw again.
    pub fn next_expiry(&self) -> Option<Duration> {
        let toasts = self.items.iter().filter(|n| n.is_toast);
        toasts
            .filter_map(|n| Some(n.at + n.level.lifetime()?))
            .min()
    }
}
