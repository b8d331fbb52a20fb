//! How long a cancel takes to end the work, in every kind of job on sheets of 1,000,000 and 801,000
//! shells: `cargo bench --no-default-features --bench cancel`.
//!
//! Every job runs once to its end and is then cancelled at moments spread evenly over that time;
//! `SHAPEMATCH_CANCELS` sets how many, 24 by default. The time runs from the request to the return
//! of the job, what it had made dropped. Names of jobs as arguments choose some of them.

#![expect(clippy::print_stdout, reason = "the table goes to the terminal")]

use std::io::Write as _;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use shapematch::geometry::Similarity;
use shapematch::jobs::{
    CompareInput, Destination, ExportRequest, JobError, JobKind, JobOutput, MapInput, MatchInput,
    MeasureInput, MeasureLevelInput, PipelineRunner, ReduceInput, Runner as _, VerdictInput,
};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, LoadedPart, PartSource};
use shapematch::pipeline::map::{MapRecipe, PoseOrigin, WriteKind};
use shapematch::pipeline::match_parts::{MatchRecipe, ReducedPair};
use shapematch::pipeline::outputs::{MeshOutput, Output, OutputInput};
use shapematch::role::{PerRole, Role};

/// Ceiling of the levels.
const MAX_TRIANGLES: usize = 2000;

/// A wavy sheet of `columns` × `rows` quads as a deck, turned by a quarter where it is the stamped one.
fn write_sheet(path: &Path, [columns, rows]: [usize; 2], pitch: f64, is_stamped: bool) {
    let mut deck = Vec::with_capacity(columns * rows * 160);
    let out = &mut deck;
    let written = "writing to memory does not fail";
    out.extend(b"*KEYWORD\n*PART\nwavy sheet\n         1         1         1\n*SECTION_SHELL\n");
    out.extend(b"         1         2\n       1.0       1.0       1.0       1.0\n*NODE\n");
    for node in 0..(columns + 1) * (rows + 1) {
        let (i, j) = (node % (columns + 1), node / (columns + 1));
        let (x, y) = (i as f64 * pitch, j as f64 * pitch);
        let z = 40.0 * (x / 170.0).sin() * (y / 130.0).cos()
            + x * x / 9000.0
            + 12.0 * (x / 41.0 + y / 67.0).sin();
        let [x, y, z] = if is_stamped {
            [y + 300.0, 100.0 - x, z]
        } else {
            [x, y, z]
        };
        writeln!(out, "{:8}{x:16.6}{y:16.6}{z:16.6}", node + 1).expect(written);
    }
    let keyword: &[u8] = if is_stamped {
        b"*ELEMENT_SHELL_THICKNESS\n"
    } else {
        b"*ELEMENT_SHELL\n"
    };
    out.extend(keyword);
    for shell in 0..columns * rows {
        let a = shell / columns * (columns + 1) + shell % columns + 1;
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        writeln!(out, "{:8}{:8}{a:8}{b:8}{c:8}{d:8}", shell + 1, 1).expect(written);
        if is_stamped {
            let t = 0.9 + 0.1 * (shell as f64 / 9e4).sin();
            writeln!(out, "{t:16.6}{t:16.6}{t:16.6}{t:16.6}").expect(written);
        }
    }
    out.extend(b"*END\n");
    std::fs::write(path, deck).expect("room for the deck");
}

/// Runs a job to its end.
fn whole(kind: &JobKind) -> (JobOutput, Duration) {
    let start = Instant::now();
    let done = PipelineRunner.run(kind.clone(), &Monitor::silent());
    (done.expect("the job is done"), start.elapsed())
}

/// Cancels a job after `delay`; the time to its return, `None` if it had ended by itself.
fn cancelled(kind: &JobKind, delay: Duration) -> Option<Duration> {
    let monitor = Monitor::silent();
    let asked = OnceLock::new();
    let (done, returned) = std::thread::scope(|scope| {
        let (theirs, asked) = (monitor.clone(), &asked);
        let job = scope.spawn(move || {
            let done = PipelineRunner.run(kind.clone(), &theirs).map(|_| ());
            (done, Instant::now())
        });
        std::thread::sleep(delay);
        asked.get_or_init(Instant::now);
        monitor.request_cancel();
        job.join().expect("the job does not panic")
    });
    let asked = asked.into_inner()?;
    matches!(done, Err(JobError::Cancelled(_))).then(|| returned.saturating_duration_since(asked))
}

/// A row of the table: the job's own time, and median and longest time to the end of a cancelled one.
fn measure(name: &str, kind: &JobKind, n_cancels: usize) {
    let (output, whole) = whole(kind);
    drop(output);
    let moments = (0..n_cancels).map(|i| whole.mul_f64((i as f64 + 0.5) / n_cancels as f64));
    let mut times: Vec<(Duration, Duration)> = moments
        .filter_map(|delay| Some((cancelled(kind, delay)?, delay)))
        .collect();
    times.sort();
    let median = times.get(times.len() / 2).copied().unwrap_or_default().0;
    let longest = times.last().copied().unwrap_or_default();
    let n_late = times
        .iter()
        .filter(|(time, _)| time.as_millis() > 100)
        .count();
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    println!(
        "| {name} | {:.0} | {} | {:.0} | {:.0} | {:.0} | {n_late} |",
        ms(whole),
        times.len(),
        ms(median),
        ms(longest.0),
        ms(longest.1),
    );
}

fn main() {
    let n_cancels = std::env::var("SHAPEMATCH_CANCELS")
        .ok()
        .and_then(|text| text.parse().ok());
    let n_cancels = n_cancels.unwrap_or(24);
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with("--"))
        .collect();
    let try_one = |name: &str, kind: &JobKind| {
        if wanted.is_empty() || wanted.iter().any(|one| name.starts_with(one.as_str())) {
            measure(name, kind, n_cancels);
        }
    };
    let folder = tempfile::tempdir().expect("a folder for the decks");
    let path = |role| {
        folder.path().join(if role == Role::Crash {
            "crash.k"
        } else {
            "stamped.k"
        })
    };
    write_sheet(&path(Role::Crash), [1250, 800], 2.0, false);
    write_sheet(&path(Role::Stamped), [1119, 716], 2.2346, true);
    println!(
        "| job | whole, ms | cancelled | median, ms | longest, ms | asked after, ms | above 100 ms |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    let load = |role| JobKind::Load {
        role,
        source: PartSource::File(path(role)),
        settings: LoadSettings::default(),
    };
    let loaded = |role| match whole(&load(role)).0 {
        JobOutput::Loaded { part, .. } => part,
        other => panic!("{other:?}"),
    };
    try_one("read crash", &load(Role::Crash));
    try_one("read stamped", &load(Role::Stamped));
    let parts: PerRole<Arc<LoadedPart>> = PerRole::from_fn(loaded);
    let part = Arc::clone(&parts.crash);
    let settings = LoadSettings {
        length_factor: 1.001,
        ..LoadSettings::default()
    };
    try_one(
        "other unit",
        &JobKind::Reselect {
            role: Role::Crash,
            part,
            settings,
        },
    );
    reductions(&parts, &try_one);
    matches(&parts, &try_one);
}

fn reductions(parts: &PerRole<Arc<LoadedPart>>, try_one: &impl Fn(&str, &JobKind)) {
    let reduce = JobKind::Reduce(ReduceInput {
        role: Role::Crash,
        part: Arc::clone(&parts.crash),
        recording: None,
        max_triangles: MAX_TRIANGLES,
    });
    try_one("reduce", &reduce);
    let JobOutput::Reduced {
        role,
        recording,
        level,
    } = whole(&reduce).0
    else {
        panic!("a reduction gives a level");
    };
    let again = JobKind::Reduce(ReduceInput {
        role,
        part: Arc::clone(&parts.crash),
        recording: Some(Arc::clone(&recording)),
        max_triangles: 1_000_000,
    });
    try_one("another level", &again);
    let measured = JobKind::MeasureLevel(MeasureLevelInput {
        role,
        recording,
        level,
    });
    try_one("measure level", &measured);
}

fn matches(parts: &PerRole<Arc<LoadedPart>>, try_one: &impl Fn(&str, &JobKind)) {
    let mut input = MatchInput {
        parts: parts.clone(),
        reduced: None,
        recipe: MatchRecipe::default(),
        current: Similarity::default(),
    };
    try_one("align", &JobKind::Align(input.clone()));
    try_one("match", &JobKind::Match(input.clone()));
    let JobOutput::Matched(run) = whole(&JobKind::Match(input.clone())).0 else {
        panic!("a match gives a run");
    };
    let (parts, crash_from_stamped) = (parts.clone(), run.crash_from_stamped);
    let max_triangles = PerRole::both(Some(MAX_TRIANGLES));
    let pair = ReducedPair::new(parts.as_deref(), max_triangles, &Monitor::silent());
    input.reduced = pair.ok();
    try_one("match reduced", &JobKind::Match(input));
    let shape_tolerance = 3.0;
    let anew = VerdictInput {
        parts: parts.clone(),
        run: Arc::clone(&run),
        shape_tolerance,
    };
    try_one("verdict", &JobKind::Verdict(anew));
    let measure = MeasureInput {
        parts: parts.clone(),
        crash_from_stamped,
        alternative_of: Some(Box::new(run.recipe.settings.clone())),
    };
    try_one("measure", &JobKind::Measure(measure.clone()));
    try_one("overlap", &JobKind::Overlap(measure));
    let levels = PerRole::both(None);
    let compare = CompareInput {
        parts: parts.clone(),
        levels,
        crash_from_stamped,
    };
    try_one("deviation", &JobKind::Compare(compare));
    let recipe = MapRecipe::default();
    let map = JobKind::Map(MapInput {
        parts: parts.clone(),
        recipe,
        pose: (crash_from_stamped, PoseOrigin::Given),
        further: Vec::new(),
    });
    try_one("map", &map);
    let JobOutput::Mapped { run: mapping, .. } = whole(&map).0 else {
        panic!("a mapping gives a run");
    };
    let input = OutputInput {
        parts: parts.map(Some),
        crash_from_stamped,
        run: Some(run),
        mapping: Some(mapping),
        ..OutputInput::default()
    };
    let folder = tempfile::tempdir().expect("a folder for the outputs");
    for (name, output) in [
        ("write report", Output::Report),
        ("write deviations", Output::Deviations),
        ("write moved deck", Output::Mesh(MeshOutput::Moved)),
        ("write mapped deck", Output::Mapped(WriteKind::Deck)),
        ("write mapped table", Output::MapTable),
        ("write map report", Output::MapReport),
    ] {
        let path = folder
            .path()
            .join(format!("out.{}", output.extensions()[0].1));
        let request = ExportRequest {
            number: 1,
            to: Destination::File(path),
            output,
            input: input.clone(),
        };
        try_one(name, &JobKind::Export(request));
    }
}
