//! Cancel ends the work at whatever it has come to: every job is cancelled at its points of progress.

use std::cell::RefCell;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use shapematch::app::{
    Action, ColorBy, FileCommand, InspectCommand, MatchCommand, ReduceCommand, ViewCommand,
};
use shapematch::jobs::{JobError, JobKey, JobKind, JobOutput, PipelineRunner, Runner as _};
use shapematch::monitor::{Monitor, Observer, Progress};
use shapematch::pipeline::sweep::SweepSettings;
use shapematch::role::{PerRole, Role};
use shapematch::samples::{self, SamplePart, SampleSettings};

use super::app::Window;

thread_local! {
    /// Every job that the window asked for.
    static ASKED: RefCell<Vec<JobKind>> = const { RefCell::new(Vec::new()) };
}

fn remembered(kind: JobKind) -> Result<JobOutput, String> {
    ASKED.with_borrow_mut(|asked| asked.push(kind.clone()));
    let done = PipelineRunner.run(kind, &Monitor::silent());
    done.map_err(|error| error.to_string())
}

/// Counts reports and cancels at one of them.
struct CancelAt {
    at: usize,
    n_reports: AtomicUsize,
    monitor: OnceLock<Monitor>,
}

impl Observer for CancelAt {
    fn progress(&self, _: Progress) {
        let number = self.n_reports.fetch_add(1, Ordering::SeqCst);
        if let Some(monitor) = self.monitor.get().filter(|_| number == self.at) {
            monitor.request_cancel();
        }
    }
}

/// Runs a job that is cancelled at a report; how it ended and how many reports came.
fn run(kind: &JobKind, at: usize) -> (Result<(), JobError>, usize) {
    let observer = Arc::new(CancelAt {
        at,
        n_reports: AtomicUsize::new(0),
        monitor: OnceLock::new(),
    });
    let monitor = Monitor::with_observer(Arc::clone(&observer) as Arc<dyn Observer>);
    observer.monitor.set(monitor.clone()).unwrap();
    let done = PipelineRunner.run(kind.clone(), &monitor).map(|_| ());
    (done, observer.n_reports.load(Ordering::SeqCst))
}

/// Jobs of a whole piece of work: read, reduce, match, measure, map.
fn jobs(folder: &Path) -> Vec<JobKind> {
    let pair = samples::generate(&SampleSettings {
        part: SamplePart::Bracket,
        ..SampleSettings::default()
    });
    for file in samples::files(&pair) {
        std::fs::write(folder.join(file.name), file.bytes).unwrap();
    }
    let mut window = Window::new();
    window.runner = Some(remembered);
    for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        window.open(folder.join(name).to_str().unwrap(), role);
    }
    window.apply(ReduceCommand::To {
        roles: PerRole::both(true),
        max_triangles: 500,
    });
    window.apply(MatchCommand::Align);
    for action in [Action::MatchOrStop, Action::MapOrCancel] {
        let command = action.command(&window.state).unwrap();
        window.apply(command);
    }
    let mut display = window.state.view.display.clone();
    display.color_by = ColorBy::Deviation;
    window.apply(ViewCommand::SetDisplay(Box::new(display)));
    window.apply(InspectCommand::Update);
    window.apply(MatchCommand::Measure);
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.shape_tolerance = 3.0;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    window.apply(MatchCommand::Sweep(Box::new(SweepSettings {
        reduction: vec![500],
        matching: vec![500],
        n_repeats: 1,
        ..SweepSettings::default()
    })));
    let (role, factor) = (Role::Stamped, 1.001);
    window.apply(FileCommand::SetLengthFactor { role, factor });
    ASKED.take()
}

/// Points of a job that are tried at most.
const MOST: usize = 12;
/// Reports that threads may still send after a cancel.
const LATE: usize = 16;

#[test]
fn a_cancel_at_any_point_ends_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let jobs = jobs(folder.path());
    let mut keys = Vec::new();
    for kind in &jobs {
        let key = kind.key();
        if keys.contains(&key) {
            continue;
        }
        keys.push(key);
        let (done, n_reports) = run(kind, usize::MAX);
        assert_eq!(done, Ok(()), "{key:?}");
        for at in (0..n_reports).step_by(n_reports.div_ceil(MOST).max(1)) {
            let (done, n_seen) = run(kind, at);
            let place = format!("{key:?} at {at} of {n_reports}");
            assert!(n_seen <= at + 1 + LATE, "{place}: went on to {n_seen}");
            let was_last = at + 1 == n_reports;
            let is_cancelled = matches!(done, Err(JobError::Cancelled(_)));
            assert!(is_cancelled || was_last, "{place}: {done:?}");
        }
    }
    for key in [
        JobKey::Load(Role::Crash),
        JobKey::Load(Role::Stamped),
        JobKey::Reduce(Role::Crash),
        JobKey::MeasureLevel(Role::Crash),
        JobKey::Align,
        JobKey::Match,
        JobKey::Map,
        JobKey::Compare,
        JobKey::Measure,
        JobKey::Verdict,
        JobKey::Sweep,
        JobKey::Reselect(Role::Stamped),
    ] {
        assert!(keys.contains(&key), "{key:?} was not asked for: {keys:?}");
    }
}
