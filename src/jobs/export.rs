//! Writing an output to a file or to the clipboard.

use std::path::PathBuf;

use super::JobError;
use crate::monitor::Monitor;
use crate::pipeline::outputs::{Output, OutputInput, Refusal, Target, check_targets};

/// What is to be made and where it goes.
#[derive(Debug, Clone)]
pub struct ExportRequest {
    /// A number of its own.
    pub number: u64,
    /// File or clipboard.
    pub to: Destination,
    /// What is written.
    pub output: Output,
    /// What it is made from.
    pub input: OutputInput,
}

/// Where an export goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Destination {
    /// A file, replaced if it exists.
    File(PathBuf),
    /// The clipboard; texts only. What it is, for the toast.
    Clipboard(String),
}

/// What became of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Where it went.
    pub to: Destination,
    /// The text for the clipboard.
    pub text: Option<String>,
    /// What was found out, for example the rounding error of a card.
    pub notes: Vec<String>,
}

/// Makes and writes. A file that was read is never overwritten.
pub(super) fn export(request: ExportRequest, monitor: &Monitor) -> Result<Exported, JobError> {
    let ExportRequest {
        to, output, input, ..
    } = request;
    monitor.progress("export", 0, None);
    monitor.check()?;
    match &to {
        Destination::File(path) => {
            check(output, path.clone(), &input)?;
            let notes = output.write(&input, path, monitor)?;
            let text = None;
            Ok(Exported { to, text, notes })
        }
        Destination::Clipboard(what) => {
            let made = output.make(&input, None, monitor)?;
            monitor.check()?;
            let text = String::from_utf8(made.bytes);
            let text = text.map_err(|_| JobError::Failed(format!("{what} is not text")))?;
            let (text, notes) = (Some(text), made.notes);
            Ok(Exported { to, text, notes })
        }
    }
}

fn check(output: Output, path: PathBuf, input: &OutputInput) -> Result<(), JobError> {
    let beside = output.file_beside(&path);
    let target = |name: &str, path| Target {
        name: name.to_owned(),
        path,
        content: output.content(),
    };
    let mut targets = vec![target("the new file", path)];
    targets.extend(beside.map(|path| target("the file of elements beside it", path)));
    let refusals = check_targets(&targets, &input.files());
    if refusals.is_empty() {
        return Ok(());
    }
    let reasons: Vec<String> = refusals.iter().map(Refusal::to_string).collect();
    Err(JobError::Failed(reasons.join("; ")))
}
