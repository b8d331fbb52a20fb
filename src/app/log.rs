use super::NoticeLevel;
use crate::jobs::Role;
use std::time::Duration;

/// One line of the log pane, made from the result of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct LogRow {
    /// Time since the program began; the shell adds the time of day.
    pub at: Duration,
    /// What was done, in one word: load, reduce, align, match …
    pub step: &'static str,
    /// The part it was done to, if it is about one.
    pub role: Option<Role>,
    /// What came out.
    pub text: String,
    /// How long it took.
    pub took: Option<Duration>,
    /// How loud it is.
    pub level: NoticeLevel,
}

/// The log pane's rows, oldest first.
#[derive(Debug, Clone, Default)]
pub struct Log {
    rows: Vec<LogRow>,
}

impl Log {
    /// Adds a row.
    pub fn push(&mut self, row: LogRow) {
        self.rows.push(row);
    }

    /// All rows.
    pub fn rows(&self) -> &[LogRow] {
        &self.rows
    }

    /// The time of all steps together.
    pub fn total(&self) -> Duration {
        self.rows.iter().filter_map(|row| row.took).sum()
    }

    /// The latest row about a step.
    pub fn latest(&self, step: &str) -> Option<&LogRow> {
        self.rows.iter().rev().find(|row| row.step == step)
    }

    /// The rows as text with tabs between the columns, for the clipboard.
    pub fn to_text(&self) -> String {
        let line = |row: &LogRow| {
            let role = row.role.map_or("", Role::word);
            let took = row.took.map_or_else(String::new, duration_text);
            let at = row.at.as_secs_f64();
            format!("{at:.3}\t{}\t{role}\t{}\t{took}\n", row.step, row.text)
        };
        self.rows.iter().map(line).collect()
    }
}

/// A duration as people read it: 83 ms, 1.24 s, 2 min 5 s.
pub fn duration_text(duration: Duration) -> String {
    let secs = duration.as_secs_f64();
    if secs < 0.0995 {
        format!("{:.1} ms", secs * 1e3)
    } else if secs < 0.9995 {
        format!("{:.0} ms", secs * 1e3)
    } else if secs < 60.0 {
        format!("{secs:.2} s")
    } else {
        let whole = secs.round();
        format!("{:.0} min {:.0} s", (whole / 60.0).floor(), whole % 60.0)
    }
}
