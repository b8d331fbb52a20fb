//! Progress on a terminal; silence elsewhere.

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::monitor::{Monitor, Observer, Progress};
use crate::registration::{self, IterationRecord, MatchMonitor};
use crate::text::{length, whole_percent};

/// A line on standard error that says what is going on, gone when the work is done.
struct Line {
    bar: ProgressBar,
}

/// A monitor with the line that shows its progress, if standard error is a terminal.
pub struct Shown {
    /// Given to the work; feeds the progress line.
    pub monitor: Monitor,
    line: Option<Arc<Line>>,
}

impl Shown {
    /// For a match, whose iterations the line shows too.
    pub fn of_match(&self) -> MatchMonitor<'_> {
        MatchMonitor {
            monitor: &self.monitor,
            observer: self.line.as_deref().map(|line| line as _),
        }
    }
}

/// Shows progress if standard error is a terminal and `quiet` is off.
pub fn shown(quiet: bool) -> Shown {
    if quiet || !std::io::stderr().is_terminal() {
        return Shown {
            monitor: Monitor::silent(),
            line: None,
        };
    }
    let bar = ProgressBar::new_spinner();
    bar.set_style(spinner());
    bar.enable_steady_tick(Duration::from_millis(100));
    let line = Arc::new(Line { bar });
    Shown {
        monitor: Monitor::with_observer(Arc::clone(&line) as Arc<dyn Observer>),
        line: Some(line),
    }
}

/// As [`shown`], for work without a match.
pub fn monitor(quiet: bool) -> Monitor {
    shown(quiet).monitor
}

fn spinner() -> ProgressStyle {
    ProgressStyle::with_template("{spinner} {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_spinner())
}

impl Observer for Line {
    fn progress(&self, progress: Progress) {
        let Progress { phase, done, total } = progress;
        let message = match total {
            Some(total) if total > 0 => format!("{phase} {} %", done * 100 / total),
            _ => phase.to_owned(),
        };
        self.bar.set_message(message);
    }
}

impl registration::Observer for Line {
    fn iteration(&self, start: usize, number: usize, record: &IterationRecord) {
        self.bar.set_message(format!(
            "start {} · iteration {} · residual {} · kept {}",
            start + 1,
            number + 1,
            length(record.rmse),
            whole_percent(record.fraction)
        ));
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
