//! The starts of a match in words, and as entries of its record.

use serde::{Serialize, Serializer};

use super::pose::rows;
use super::record::role_of;
use crate::registration::{StartKind, StartOutcome, StartRecord, Termination};
use crate::text::counted;

/// How a start came to be: "surface normal 40°, stamped nodes, normals flipped".
pub fn start_name(start: &StartRecord) -> String {
    format!(
        "{}, {}",
        start_kind_words(start.kind),
        start_data_words(start)
    )
}

/// Which nodes a start pairs, and how: "stamped nodes, normals flipped".
pub fn start_data_words(start: &StartRecord) -> String {
    let mut name = format!("{} nodes", role_of(start.data_side).word());
    if start.flipped {
        name += ", normals flipped";
    }
    if start.mirrored {
        name += ", mirrored";
    }
    name
}

/// The kind of a start in words: "surface normal 40°".
pub fn start_kind_words(kind: StartKind) -> String {
    match kind {
        StartKind::SurfaceNormal { angle_deg } => format!("surface normal {angle_deg:.0}°"),
        StartKind::Patch { patch, angle_deg } => {
            let patch = patch + 1;
            format!("surface normal of patch {patch}, {angle_deg:.0}°")
        }
        StartKind::PrincipalFrame { signs } => format!("principal axes {}", signs + 1),
        StartKind::Covering { index } => format!("rotation {}", index + 1),
        StartKind::Wide { rotation, place } => {
            let (rotation, place) = (rotation + 1, place + 1);
            format!("wide search, rotation {rotation} at place {place}")
        }
        StartKind::CurrentPose => "current pose".to_owned(),
        StartKind::Given { index } => format!("given pose {}", index + 1),
        StartKind::Alike { index } => format!("place shaped alike, {}", index + 1),
        StartKind::Twin { axis } => format!("rotated 180° about axis {}", axis + 1),
        StartKind::Turned { index } => format!("turned by a share of a turn, {}", index + 1),
    }
}

/// What a kind of start does, as a sentence.
pub fn start_kind_help(kind: StartKind) -> &'static str {
    match kind {
        StartKind::SurfaceNormal { .. } => {
            "Align surface normals: centroids and mean normals on each other, rotated about the normal."
        }
        StartKind::Patch { .. } => {
            "Align surface normals in its local form: the mean normal around the middle of the smaller \
             part is aligned to that of a patch as large of the larger part, the middles on each other, \
             rotated about the normal. So a piece finds its place without the mean of the whole part."
        }
        StartKind::PrincipalFrame { .. } => {
            "Principal axes on each other, with one choice of signs."
        }
        StartKind::Covering { .. } => "One of rotations spread evenly, centroids on each other.",
        StartKind::Wide { .. } => {
            "A survivor of the wide search, which tries all rotations, both normal directions and, where \
             sizes differ, all places."
        }
        StartKind::CurrentPose => "Where the part lay before the match.",
        StartKind::Given { .. } => "A pose that was given.",
        StartKind::Alike { .. } => {
            "A rival: a place of the larger part that is shaped like the one of the best pose."
        }
        StartKind::Twin { .. } => {
            "A rival: the best pose after half a turn about an axis of the part."
        }
        StartKind::Turned { .. } => {
            "A rival: the best pose turned about the axis of a part with like sectors, to where it fits too."
        }
    }
}

/// Of which kinds the starts were: "18 by surface normals, 4 by the wide search"; of a single one its kind alone.
pub fn start_kinds(starts: &[StartRecord]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for start in starts {
        let kind = match start.kind {
            StartKind::SurfaceNormal { .. } | StartKind::Patch { .. } => "by surface normals",
            StartKind::PrincipalFrame { .. } => "by principal axes",
            StartKind::Covering { .. } => "by rotations",
            StartKind::Wide { .. } => "by the wide search",
            StartKind::CurrentPose => "from the present pose",
            StartKind::Given { .. } => "given",
            StartKind::Alike { .. } | StartKind::Twin { .. } | StartKind::Turned { .. } => {
                "rivals of the best"
            }
        };
        match counts.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, n)) => *n += 1,
            None => counts.push((kind, 1)),
        }
    }
    if starts.len() == 1 {
        return counts.iter().map(|(kind, _)| *kind).collect();
    }
    let parts: Vec<String> = counts
        .iter()
        .map(|(kind, n)| format!("{n} {kind}"))
        .collect();
    parts.join(", ")
}

/// Fewer agreeing starts than this are explained.
const FEW: usize = 3;

/// Why few agreeing starts say nothing against a result: most others were given up early, because
/// better ones were ahead. `None` where enough agree.
pub fn few_agree_words(starts: &[StartRecord], n_same: usize) -> Option<String> {
    if n_same >= FEW || starts.len() <= n_same {
        return None;
    }
    let was_dropped =
        |start: &&StartRecord| matches!(start.outcome, Some(StartOutcome::Dropped { .. }));
    let n_dropped = starts.iter().filter(was_dropped).count();
    let n_others = starts.len() - n_same;
    if n_dropped == 0 {
        return Some(format!(
            "the other {n_others} ended elsewhere, with larger errors"
        ));
    }
    let n_left = n_others.saturating_sub(n_dropped);
    let mut words = format!("{n_dropped} were stopped early because better ones were ahead");
    if n_left > 0 {
        words += &format!(", {n_left} ended elsewhere");
    }
    Some(words)
}

/// What became of a start, in words; `None` while it has not ended.
pub fn outcome_words(start: &StartRecord) -> Option<String> {
    Some(match start.outcome? {
        StartOutcome::Won => "best".into(),
        StartOutcome::RunnerUp => "close in the search".into(),
        StartOutcome::MergedInto { start } => format!("merged into start {}", start + 1),
        // What it made of those that it might have made: it may have come to rest before.
        StartOutcome::Dropped { .. } => {
            format!(
                "stopped after {}",
                counted(start.iterations.len(), "iteration")
            )
        }
        StartOutcome::Failed => "no fit".into(),
    })
}

/// A start in the record: its figures without its iterations.
#[derive(Serialize)]
struct StartEntry {
    /// How it came to be.
    kind: StartKind,
    /// True if the stamped normals counted reversed.
    flipped: bool,
    /// True if the stamped part was mirrored.
    mirrored: bool,
    /// The part whose nodes were paired with the other one.
    data_side: &'static str,
    /// Number of iterations made.
    iterations: usize,
    /// Objective in the end; comparable between starts that went equally far.
    score: f64,
    /// What became of it; starts are numbered from 0 as they stand in the list.
    outcome: Option<StartOutcome>,
    /// Why its last stage ended.
    termination: Option<Termination>,
    /// First pose, 4×4 as rows, crash from stamped.
    first: [[f64; 4]; 4],
    /// Last pose, 4×4 as rows, crash from stamped.
    last: [[f64; 4]; 4],
}

/// Writes starts as a record holds them.
pub(super) fn entries<S: Serializer>(
    starts: &[StartRecord],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(starts.iter().map(|start| StartEntry {
        kind: start.kind,
        flipped: start.flipped,
        mirrored: start.mirrored,
        data_side: role_of(start.data_side).word(),
        iterations: start.iterations.len(),
        score: start.score,
        outcome: start.outcome,
        termination: start.termination,
        first: rows(&start.first),
        last: rows(&start.last),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Similarity;
    use crate::registration::{IterationRecord, Side, Stage};

    /// A start that was given up in the round that ended after 30 iterations.
    fn dropped(n_iterations: usize) -> StartRecord {
        let pose = Similarity::identity();
        let iteration = IterationRecord {
            stage: Stage::Coarse,
            target_from_source: pose,
            objective: 1.0,
            rmse: 1.0,
            fraction: 0.5,
        };
        StartRecord {
            kind: StartKind::CurrentPose,
            flipped: false,
            mirrored: false,
            data_side: Side::Source,
            first: pose,
            last: pose,
            iterations: vec![iteration; n_iterations],
            score: 1.0,
            p95: 1.0,
            took: std::time::Duration::ZERO,
            termination: None,
            outcome: Some(StartOutcome::Dropped { after: 30 }),
        }
    }

    #[test]
    fn one_iteration_is_no_plural() {
        let words = |n_iterations| outcome_words(&dropped(n_iterations)).unwrap();
        assert_eq!(words(1), "stopped after 1 iteration");
        // As many as are counted beside it, although its round allowed for 30.
        assert_eq!(words(12), "stopped after 12 iterations");
    }
}
