//! Cancel ends the work at whatever it has come to: every job is cancelled at its points of progress.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use shapematch::app::{
    Action, ColorBy, Effect, ExportCommand, FileCommand, InspectCommand, MapCommand, MatchCommand,
    ProjectCommand, ReduceCommand, ViewCommand,
};
use shapematch::jobs::{
    Destination, ExportRequest, JobError, JobKey, JobKind, JobOutput, PipelineRunner, Runner as _,
};
use shapematch::monitor::{Monitor, Observer, Progress};
use shapematch::pipeline::map::WriteKind;
use shapematch::pipeline::outputs::Output;
use shapematch::pipeline::project::ProjectRequest;
use shapematch::pipeline::sweep::SweepSettings;
use shapematch::role::{PerRole, Role};
use shapematch::samples::SampleVariant;

use super::app::Window;
use super::bracket::write_bracket;

thread_local! {
    /// Every job that the window asked for.
    static ASKED: RefCell<Vec<JobKind>> = const { RefCell::new(Vec::new()) };
}

fn remembered(kind: JobKind) -> Result<JobOutput, String> {
    ASKED.with_borrow_mut(|asked| asked.push(kind.clone()));
    let done = PipelineRunner.run(kind, &Monitor::silent());
    done.map_err(|error| error.to_string())
}

/// Where a job can be cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Point {
    /// A report of progress.
    Report,
    /// A look whether it is to end.
    Question,
}

/// Counts points of one kind and cancels at one of them.
struct CancelAt {
    point: Point,
    at: usize,
    n_seen: AtomicUsize,
    monitor: OnceLock<Monitor>,
}

impl CancelAt {
    fn reach(&self, point: Point) {
        if point != self.point {
            return;
        }
        let number = self.n_seen.fetch_add(1, Ordering::SeqCst);
        if let Some(monitor) = self.monitor.get().filter(|_| number == self.at) {
            monitor.request_cancel();
        }
    }
}

impl Observer for CancelAt {
    fn progress(&self, _: Progress) {
        self.reach(Point::Report);
    }

    fn asked(&self) {
        self.reach(Point::Question);
    }
}

/// Runs a job that is cancelled at a point; how it ended and how many such points came.
fn run(kind: &JobKind, point: Point, at: usize) -> (Result<(), JobError>, usize) {
    let observer = Arc::new(CancelAt {
        point,
        at,
        n_seen: AtomicUsize::new(0),
        monitor: OnceLock::new(),
    });
    let monitor = Monitor::with_observer(Arc::clone(&observer) as Arc<dyn Observer>);
    observer.monitor.set(monitor.clone()).unwrap();
    let done = PipelineRunner.run(kind.clone(), &monitor).map(|_| ());
    (done, observer.n_seen.load(Ordering::SeqCst))
}

/// A window with the bracket of both sides, whose jobs are remembered.
fn with_brackets(folder: &Path, variant: SampleVariant) -> Window {
    write_bracket(folder, variant);
    Window::with_files_of(folder, remembered)
}

/// Jobs of a whole piece of work: read, reduce, match, measure, map.
fn jobs(folder: &Path) -> Vec<JobKind> {
    let mut window = with_brackets(folder, SampleVariant::Plain);
    window.apply(ReduceCommand::To {
        roles: PerRole::both(true),
        max_triangles: 500,
    });
    window.apply(MatchCommand::Align);
    window.act(Action::MatchOrStop);
    // The same bracket once more, from another file.
    let more = folder.join("more.dynain");
    std::fs::copy(folder.join("stamped.dynain"), &more).unwrap();
    window.apply(MapCommand::AddFurther(more));
    let command = Action::MapOrCancel.command(&window.state).unwrap();
    window.apply(command);
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
    let mut others = written(&mut window, folder);
    let (role, factor) = (Role::Stamped, 1.001);
    window.apply(FileCommand::SetLengthFactor { role, factor });
    let mut asked = ASKED.take();
    let measured = asked.iter().find_map(|kind| match kind {
        JobKind::Measure(input) => Some(JobKind::Overlap(input.clone())),
        _ => None,
    });
    others.extend(measured);
    asked.extend(others);
    asked
}

/// Saves the work and compares its mapping with what it wrote; asks for every output there is.
fn written(window: &mut Window, folder: &Path) -> Vec<JobKind> {
    let other = folder.join("other.k");
    // The window makes its picture and its log by itself.
    let is_job = |kind: &&Output| !matches!(kind, Output::Picture | Output::Log);
    for (index, kind) in Output::ALL.iter().filter(is_job).enumerate() {
        let name = format!("out{index}.{}", kind.extensions()[0].1);
        let path = match kind {
            Output::Mapped(WriteKind::Deck) => other.clone(),
            _ => folder.join(name),
        };
        window.apply(ExportCommand::Write { kind: *kind, path });
    }
    window.apply(MapCommand::CompareWith(other));
    let path = folder.join("work.shapematch");
    window.apply(ProjectCommand::Write(path.clone()));
    for effect in std::mem::take(&mut window.effects) {
        if let Effect::WriteProject { path, project, .. } = effect {
            project.write(&path).unwrap();
        }
    }
    vec![JobKind::OpenProject(ProjectRequest {
        path,
        located: BTreeMap::new(),
        is_autosave: false,
    })]
}

/// A match of a whole model, which begins with the part it belongs to.
fn find_parts(folder: &Path) -> JobKind {
    let mut window = with_brackets(folder, SampleVariant::WholeModel);
    window.holds = true;
    window.act(Action::MatchOrStop);
    let job = window.held.pop().expect("a job").1;
    assert!(matches!(job, JobKind::FindParts(_)), "{:?}", job.key());
    ASKED.take();
    job
}

/// Points of a job that are tried at most.
const MOST: usize = 12;
/// Points that threads may still reach after a cancel.
const LATE: usize = 16;

/// What a job is, so that each kind is tried once.
fn name(kind: &JobKind) -> String {
    match kind {
        JobKind::FindParts(_) => "FindParts".to_owned(),
        JobKind::Export(request) => format!("Export {:?}", request.output),
        // Their numbers tell files apart.
        JobKind::LoadFurther(_) => "LoadFurther".to_owned(),
        other => format!("{:?}", other.key()),
    }
}

/// The file a job is to write.
fn file(kind: &JobKind) -> Option<&Path> {
    match kind {
        JobKind::Export(ExportRequest {
            to: Destination::File(path),
            ..
        }) => Some(path),
        _ => None,
    }
}

/// Runs a job that is cancelled at a point. What is cancelled leaves no file.
fn cancelled_at(kind: &JobKind, point: Point, at: usize) -> (Result<(), JobError>, usize) {
    // That another job reads: it stays as the whole run left it.
    let kept = file(kind).map(|path| (path, std::fs::read(path).unwrap()));
    if let Some((path, _)) = &kept {
        std::fs::remove_file(path).unwrap();
    }
    let done = run(kind, point, at);
    if let Some((path, bytes)) = kept {
        let is_written = path.exists();
        assert_eq!(is_written, done.0.is_ok(), "{}", name(kind));
        std::fs::write(path, bytes).unwrap();
    }
    done
}

fn try_everywhere(kind: &JobKind, most: usize) {
    let what = name(kind);
    for (point, most) in [(Point::Report, most), (Point::Question, most.div_ceil(2))] {
        let (done, n) = run(kind, point, usize::MAX);
        assert_eq!(done, Ok(()), "{what}");
        for at in (0..n).step_by(n.div_ceil(most).max(1)) {
            let (done, n_seen) = cancelled_at(kind, point, at);
            let place = format!("{what} at {point:?} {at} of {n}");
            assert!(n_seen <= at + 1 + LATE, "{place}: went on to {n_seen}");
            // The last report comes when all is done; a question is always heard.
            let was_last = point == Point::Report && at + 1 == n;
            let is_cancelled = matches!(done, Err(JobError::Cancelled(_)));
            assert!(is_cancelled || was_last, "{place}: {done:?}");
        }
    }
    // Before the first word of it.
    let monitor = Monitor::silent();
    monitor.request_cancel();
    let done = PipelineRunner.run(kind.clone(), &monitor).map(|_| ());
    let is_cancelled = matches!(done, Err(JobError::Cancelled(_)));
    assert!(is_cancelled, "{what} before it began: {done:?}");
}

#[test]
fn a_cancel_at_any_point_ends_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let jobs = jobs(folder.path());
    let mut tried = Vec::new();
    for kind in &jobs {
        let what = name(kind);
        if !tried.contains(&what) {
            let is_output = matches!(kind, JobKind::Export(_));
            try_everywhere(kind, if is_output { 3 } else { MOST });
            tried.push(what);
        }
    }
    let n_outputs = tried
        .iter()
        .filter(|what| what.starts_with("Export"))
        .count();
    assert!(n_outputs > 15, "{tried:?}");
    assert!(tried.contains(&"LoadFurther".to_owned()), "{tried:?}");
    for key in [
        JobKey::Load(Role::Crash),
        JobKey::Load(Role::Stamped),
        JobKey::Reduce(Role::Crash),
        JobKey::MeasureLevel(Role::Crash),
        JobKey::Align,
        JobKey::Match,
        JobKey::PlaceFurther,
        JobKey::Map,
        JobKey::Compare,
        JobKey::Measure,
        JobKey::Verdict,
        JobKey::Sweep,
        JobKey::Reselect(Role::Stamped),
        JobKey::Overlap,
        JobKey::CompareMapping,
        JobKey::OpenProject,
    ] {
        assert!(tried.contains(&format!("{key:?}")), "{key:?}: {tried:?}");
    }
}

#[test]
fn a_cancel_ends_the_search_for_the_crash_part() {
    let folder = tempfile::tempdir().unwrap();
    try_everywhere(&find_parts(folder.path()), 6);
}
