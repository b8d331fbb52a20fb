//! The comments at the head of a deck of mapped results.

use super::PlacedPart;
use super::output::MapWriter;
use crate::mapping::Status;
use crate::pipeline::load::LoadedPart;
use crate::report::build_id;

/// What decks say of where their values come from: the files, and the pose of each stamped part.
pub fn deck_comments(crash: &LoadedPart, placed: &[PlacedPart<'_>]) -> Vec<String> {
    let mut lines = vec![format!("forming results mapped onto {}", crash.file_name())];
    for placed in placed {
        lines.push(format!(
            "from {}, crash = c R stamped + t with rows:",
            placed.part.file_name()
        ));
        for row in placed.crash_from_stamped.to_rows() {
            lines.push(format!("  {} {} {} {}", row[0], row[1], row[2], row[3]));
        }
        let factor = placed.part.settings.length_factor;
        if factor != 1.0 {
            lines.push(format!("  its lengths multiplied by {factor}"));
        }
    }
    lines
}

impl MapWriter<'_> {
    /// Comments above everything that is written.
    pub(super) fn head(&self, comments: &[String], n_default: usize, n_old: usize) -> String {
        let mut head = String::new();
        for line in comments.iter().flat_map(|comment| comment.lines()) {
            head.push_str(&format!("$ {line}\n"));
        }
        let counts = self.run.mapped.counts();
        let words = Status::ALL
            .iter()
            .zip(counts)
            .filter(|(_, count)| *count > 0);
        let words: Vec<String> = words
            .map(|(status, n)| format!("{n} {}", status.label()))
            .collect();
        head.push_str(&format!("$ elements: {}\n", words.join(", ")));
        if n_default > 0 {
            head.push_str(&format!(
                "$ {n_default} of them carry no values and have the default thickness\n"
            ));
        }
        if n_old > 0 && self.replaces_states() {
            head.push_str(&format!(
                "$ {n_old} of them have initial states in the crash deck: copies of its files without these are\n\
                 $ written too and take the place of the files\n"
            ));
        } else if n_old > 0 {
            head.push_str(&format!(
                "$ {n_old} of them have initial states in the crash deck already: take those cards out of it;\n\
                 $ --replace-states yes writes copies of its files without them\n"
            ));
        }
        head.push_str(&format!("$ {}\n", build_id()));
        head
    }
}
