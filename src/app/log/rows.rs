//! The lines of the log with their durations.

use std::path::PathBuf;
use std::time::Duration;

use super::LogStep;
use crate::app::NoticeLevel;
use crate::role::Role;
use crate::text::counted;

/// One line of the log pane, made from the result of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct LogRow {
    /// Local time of day; past midnight it goes on counting.
    pub at: Duration,
    /// What was done.
    pub step: LogStep,
    /// The part it was done to, if it is about one.
    pub role: Option<Role>,
    /// What came out.
    pub text: String,
    /// The file that was written, of an export.
    pub file: Option<PathBuf>,
    /// How long it took.
    pub took: Option<Duration>,
    /// How loud it is.
    pub level: NoticeLevel,
    /// How often it came in a row.
    pub count: usize,
}

impl LogRow {
    /// The text, and how often it came if that is more than once.
    pub fn counted_text(&self) -> String {
        match self.count {
            0 | 1 => self.text.clone(),
            n => format!("{} (×{n})", self.text),
        }
    }

    /// What was done; of several exports also which file was written.
    pub fn title(&self) -> String {
        let step = self.step.label();
        match self.file.as_ref().and_then(|path| path.file_name()) {
            Some(name) => format!("{step} {}", name.display()),
            None => step.to_owned(),
        }
    }

    fn says_the_same(&self, other: &Self) -> bool {
        let key = |row: &Self| (row.step, row.role, row.level);
        key(self) == key(other) && self.text == other.text
    }
}

/// The log pane's rows, oldest first; the last ones of a long session.
#[derive(Debug, Clone, Default)]
pub struct Log {
    rows: Vec<LogRow>,
    /// How many older ones were left out, and how long their steps took.
    n_dropped: usize,
    took_dropped: Duration,
}

/// Most rows that are kept.
const MOST: usize = 5_000;
/// So many of the oldest are left out at once.
const DROPPED: usize = MOST / 10;

impl Log {
    /// Adds a row; a message that repeats the one before only counts it up.
    pub fn push(&mut self, row: LogRow) {
        let is_message = row.level >= NoticeLevel::Note;
        match self.rows.last_mut() {
            Some(last) if is_message && last.says_the_same(&row) => {
                last.count += 1;
                last.at = row.at;
            }
            _ => self.rows.push(row),
        }
        if self.rows.len() > MOST {
            let dropped = self.rows.drain(..DROPPED);
            self.took_dropped += dropped.filter_map(|row| row.took).sum::<Duration>();
            self.n_dropped += DROPPED;
        }
    }

    /// How many rows were left out before the first that is kept.
    pub fn n_dropped(&self) -> usize {
        self.n_dropped
    }

    /// The rows, the oldest first.
    pub fn rows(&self) -> &[LogRow] {
        &self.rows
    }

    /// The time of all steps together.
    pub fn total(&self) -> Duration {
        let kept = self.rows.iter().filter_map(|row| row.took);
        self.took_dropped + kept.sum::<Duration>()
    }

    /// The latest row about a step.
    pub fn latest(&self, step: LogStep) -> Option<&LogRow> {
        self.rows.iter().rev().find(|row| row.step == step)
    }

    /// The rows as text with tabs between the columns, for the clipboard.
    pub fn to_text(&self) -> String {
        let line = |row: &LogRow| {
            let role = row.role.map_or("", Role::word);
            let took = row.took.map_or_else(String::new, duration_text);
            let (at, text) = (clock_text(row.at), row.counted_text());
            format!("{at}\t{}\t{role}\t{text}\t{took}\n", row.step.label())
        };
        let dropped = match self.n_dropped {
            0 => String::new(),
            n => format!("({} left out before)\n", counted(n, "row")),
        };
        dropped + &self.rows.iter().map(line).collect::<String>()
    }
}

/// When the program began. Nothing below the shell reads a clock; it is told once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Clock {
    /// The local time of day.
    pub day_time: Duration,
    /// Seconds since 1970.
    pub unix: u64,
}

impl Clock {
    /// The local time of day so long after the beginning.
    pub fn day_time_at(&self, now: Duration) -> Duration {
        self.day_time + now
    }

    /// Seconds since 1970 so long after the beginning.
    pub fn unix_at(&self, now: Duration) -> u64 {
        self.unix + now.as_secs()
    }
}

/// How long ago something was, roughly: just now, 5 min ago, 3 h ago, 12 days ago.
pub fn age_text(seconds: u64) -> String {
    match seconds {
        0..60 => "just now".to_owned(),
        60..3_600 => format!("{} min ago", seconds / 60),
        3_600..86_400 => format!("{} h ago", seconds / 3_600),
        86_400..172_800 => "yesterday".to_owned(),
        _ => format!("{} days ago", seconds / 86_400),
    }
}

/// Hours, minutes and seconds of a time of day: 14:02:11.
pub fn clock_text(at: Duration) -> String {
    let seconds = at.as_secs() % 86_400;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!("{hours:02}:{minutes:02}:{:02}", seconds % 60)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn row(level: NoticeLevel, text: &str) -> LogRow {
        LogRow {
            at: Duration::ZERO,
            step: LogStep::Load,
            role: None,
            text: text.to_owned(),
            file: None,
            took: None,
            level,
            count: 1,
        }
    }

    #[test]
    fn an_export_is_called_by_its_file() {
        let mut written = row(NoticeLevel::Success, "saved: parts/report.html");
        assert_eq!(written.title(), "load");
        written.step = LogStep::Export;
        written.file = Some("parts/report.html".into());
        assert_eq!(written.title(), "export report.html");
    }

    #[test]
    fn the_time_of_day_starts_anew_at_midnight() {
        let at = |hours: u64, seconds| clock_text(Duration::from_secs(hours * 3600 + seconds));
        assert_eq!(at(14, 131), "14:02:11");
        assert_eq!(at(24, 61), "00:01:01");
    }

    #[test]
    fn ages_are_told_roughly() {
        let told = [3, 60, 7_199, 90_000, 1_000_000].map(age_text);
        let expected = [
            "just now",
            "1 min ago",
            "1 h ago",
            "yesterday",
            "11 days ago",
        ];
        assert_eq!(told, expected);
    }

    #[test]
    fn repeated_messages_are_one_row_and_repeated_steps_are_not() {
        let mut log = Log::default();
        for _ in 0..12 {
            log.push(row(NoticeLevel::Error, "no such file"));
        }
        assert_eq!(log.rows().len(), 1);
        assert!(log.to_text().contains("no such file (×12)"));
        log.push(row(NoticeLevel::Warning, "no such file"));
        for _ in 0..2 {
            log.push(row(NoticeLevel::Info, "loaded"));
        }
        assert_eq!(log.rows().len(), 4);
    }

    #[test]
    fn a_long_log_keeps_its_last_rows_and_all_durations() {
        let mut log = Log::default();
        let n = 2 * MOST;
        for number in 0..n {
            log.push(LogRow {
                took: Some(Duration::from_secs(1)),
                ..row(NoticeLevel::Info, &format!("step {number}"))
            });
            assert!(log.rows().len() <= MOST);
        }
        assert_eq!(log.n_dropped() + log.rows().len(), n);
        assert!(log.rows().len() > MOST - 2 * DROPPED);
        assert_eq!(log.rows().last().unwrap().text, format!("step {}", n - 1));
        assert_eq!(log.rows()[0].text, format!("step {}", log.n_dropped()));
        assert_eq!(log.total(), Duration::from_secs(n as u64));
        let dropped = counted(log.n_dropped(), "row");
        assert!(
            log.to_text()
                .starts_with(&format!("({dropped} left out before)\n"))
        );
    }
}
