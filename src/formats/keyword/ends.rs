//! What is said of the end of a deck: where it is missing, what stands behind it, what encrypted text takes with it.

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::block::{Block, Blocks};
use super::source_file::SourceFile;

/// Says that a deck ends in the middle of its data, which is what a copy that was broken off looks like. Behind a
/// whole line it may be complete too.
pub(super) fn report_cut(file: &SourceFile, last: &Block<'_>, found: &mut Diagnostics) {
    let name = &last.name;
    let is_data = ["NODE", "ELEMENT", "INITIAL"].contains(&name.split('_').next().unwrap_or(""));
    if is_data {
        let rest = if file.bytes()[last.body.clone()].ends_with(b"\n") {
            "complete, as *END is optional, or cut off behind a whole line"
        } else {
            "the rest of it is probably missing"
        };
        let message = format!("the file ends inside *{name} without *END; {rest}");
        let at = file.position(last.body.end.saturating_sub(1));
        found.push(Diagnostic::new(DiagnosticKind::NoEnd, message).at(at));
    }
}

/// Says that keywords stand behind `*END`, where no reader of decks looks for them.
pub(super) fn report_behind(end: &Block<'_>, behind: Blocks<'_>, found: &mut Diagnostics) {
    let mut behind = behind.filter(|block| block.name != "END");
    if let Some(first) = behind.next() {
        let what = match behind.count() {
            0 => "the keyword behind it is passed over".to_owned(),
            n => format!("the {} keywords behind it are passed over", n + 1),
        };
        let (name, line) = (&first.name, first.position().line);
        let message = format!("the deck ends here with *END; {what}, first *{name} in line {line}");
        found.push(end.diagnose(DiagnosticKind::BehindEnd, message));
    }
}

/// Says how many encrypted parts there are, and whether one of them has no end.
pub(super) fn report_encrypted(file: &SourceFile, blocks: &Blocks<'_>, found: &mut Diagnostics) {
    if let Some(first) = blocks.first_encrypted() {
        let n = blocks.n_encrypted();
        let s = if n == 1 { "" } else { "s" };
        let message = format!("{n} encrypted block{s} skipped");
        let diagnostic = Diagnostic::new(DiagnosticKind::Encrypted, message);
        found.push(diagnostic.at(file.position(first)));
    }
    if let Some(start) = blocks.unended_encrypted() {
        let message = "the encrypted block has no END line, so all that follows in the file is passed over with it";
        let diagnostic = Diagnostic::new(DiagnosticKind::EncryptedNoEnd, message);
        found.push(diagnostic.at(file.position(start)));
    }
}
