//! Progress on a terminal; silence elsewhere.

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::monitor::{IterationReport, Monitor, Observer, Progress};

/// A line on standard error that says what is going on, gone when the work is done.
struct Line {
    bar: ProgressBar,
}

/// A monitor that shows its progress if standard error is a terminal and `quiet` is off.
pub fn monitor(quiet: bool) -> Monitor {
    if quiet || !std::io::stderr().is_terminal() {
        return Monitor::silent();
    }
    let bar = ProgressBar::new_spinner();
    bar.set_style(spinner());
    bar.enable_steady_tick(Duration::from_millis(100));
    Monitor::with_observer(Arc::new(Line { bar }))
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

    fn iteration(&self, report: &IterationReport) {
        self.bar.set_message(format!(
            "start {} · iteration {} · RMS {:.3} · overlap {:.0} %",
            report.start_idx + 1,
            report.iteration + 1,
            report.rmse,
            report.fraction * 100.0
        ));
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
