//! The window without the window: commands in, state and effects out.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use shapematch::app::*;
use shapematch::assess::PoseKind;
use shapematch::formats::model::FormingEvidence;
use shapematch::formats::{Diagnostic, DiagnosticKind, Model};
use shapematch::geometry::camera::{Covered, StandardView};
use shapematch::geometry::{Point3, Similarity, TriMesh, Vector3};
use shapematch::jobs::*;
use shapematch::monitor::Monitor;
use shapematch::pipeline::forming_values::FormingValue;
use shapematch::pipeline::load::{LoadSettings, prepare};
use shapematch::pipeline::match_parts::MatchRun;
use shapematch::registration::starts::{Start, StartKind};
use shapematch::registration::{Alternative, MatchOutcome};
use shapematch::report::MatrixForm;
use shapematch::role::{PerRole, Role};
use shapematch::samples::SampleVariant;

use super::bracket::write_bracket;
use super::find_parts::really;
use super::match_starts::{live_iteration, running_start};

/// A bent strip of n × 4 cells, so that its three sizes differ.
fn strip(n: u32, size: f64) -> TriMesh {
    let mut positions = Vec::new();
    for i in 0..=n {
        for j in 0..=4 {
            let (x, y) = (f64::from(i), f64::from(j));
            let z = 0.02 * x * x;
            positions.push(Point3::new(x, y, z) * size);
        }
    }
    let cell = |k: u32| {
        let a = k / 4 * 5 + k % 4;
        [[a, a + 5, a + 6], [a, a + 6, a + 1]]
    };
    TriMesh::new(positions, (0..4 * n).flat_map(cell).collect()).unwrap()
}

/// A model of two parts, 11 and 12; `formed` gives its shells a thickness of their own.
fn model(n: u32, size: f64, formed: bool) -> Model {
    let mut model = Model::from_mesh(&strip(n, size), "strip");
    model.parts[0].id = 11;
    if formed {
        model
            .shell_extras
            .push(shapematch::formats::model::ShellExtra {
                shell: 0,
                thickness: [1.0; 4],
                beta: 0.0,
                plies: None,
            });
    } else {
        let mut second = model.parts[0].clone();
        second.id = 12;
        second.title = "rest".to_owned();
        model.parts.push(second);
        let half = model.shells.len() / 2;
        for shell in &mut model.shells[half..] {
            shell.part = 1;
        }
    }
    model
}

/// A model of three parts, of which 22 is the strip that is stamped.
fn car() -> Model {
    let (mut positions, mut triangles, mut n_of_part) = (Vec::new(), Vec::new(), Vec::new());
    for (n, size, x) in [(24, 9.0, 0.0), (20, 1.0, 300.0), (8, 4.0, 400.0)] {
        let mesh = strip(n, size);
        let first = positions.len() as u32;
        let moved = mesh.positions().iter().map(|p| p + Vector3::x() * x);
        positions.extend(moved);
        let corners = mesh.triangles().iter();
        triangles.extend(corners.map(|triangle| triangle.map(|corner| corner + first)));
        n_of_part.push(mesh.n_triangles());
    }
    let mut model = Model::from_mesh(&TriMesh::new(positions, triangles).unwrap(), "car");
    let one = model.parts[0].clone();
    model.parts = [21, 22, 23]
        .map(|id| shapematch::formats::model::Part { id, ..one.clone() })
        .to_vec();
    // Shells follow the triangles.
    let parts = (0..).zip(n_of_part);
    let of_shell = parts.flat_map(|(part, n)| std::iter::repeat_n(part, n));
    for (shell, part) in model.shells.iter_mut().zip(of_shell) {
        shell.part = part;
    }
    model
}

/// What the files of these tests hold, by name.
fn read(source: &PartSource, settings: &LoadSettings) -> Result<LoadedPartAndFacts, String> {
    let PartSource::File(path) = source else {
        return Err("no example here".to_owned());
    };
    let model = match path.to_str().unwrap() {
        "crash.k" => model(24, 1.0, false),
        "stamped.k" => model(20, 1.0, true),
        "car.k" => car(),
        "faulty.k" => {
            let mut model = model(24, 1.0, false);
            let what = Diagnostic::new(DiagnosticKind::BadField, "no number");
            model.diagnostics.push(what);
            model
        }
        "panel_stamped.k" | "panel_crash.k" => model(20, 1.0, false),
        "metres.k" => model(20, 0.001, true),
        "inches.k" => model(24, 1.0 / 25.4, false),
        "says_mm.k" => stated(model(24, 1.0, false), "units: mm", b"1"),
        "says_gpa.k" => stated(model(20, 1.0, true), "units: kg-mm-ms", b"3"),
        "says_mpa.k" => stated(model(24, 1.0, false), "units: ton-mm-s", b"4"),
        "says_m.k" => stated(model(20, 0.001, true), "units: m", b"2"),
        other => return Err(format!("cannot read the file: {other:?}")),
    };
    prepared(path, Arc::new(model), settings)
}

/// A model of a file that names its units.
fn stated(mut model: Model, comment: &str, content: &[u8]) -> Model {
    model.stated_units = shapematch::units::of_text(comment);
    model.files.push(shapematch::formats::model::ReadFile {
        hash: Some(shapematch::formats::FileHash::of(content)),
        ..Default::default()
    });
    model
}

type LoadedPartAndFacts = (Arc<shapematch::pipeline::load::LoadedPart>, Arc<PartFacts>);

fn prepared(
    path: &Path,
    model: Arc<Model>,
    settings: &LoadSettings,
) -> Result<LoadedPartAndFacts, String> {
    let part = prepare(path, model, settings, &Monitor::silent()).map_err(|e| e.to_string())?;
    let facts = PartFacts::of(&part, &Monitor::silent()).unwrap();
    Ok((Arc::new(part), Arc::new(facts)))
}

pub fn shifted(x: f64) -> Similarity {
    Similarity {
        translation: Vector3::new(x, 0.0, 0.0),
        ..Similarity::identity()
    }
}

/// A window whose worker answers at once.
#[derive(Default)]
pub struct Window {
    pub state: AppState,
    /// Jobs that are not answered at once: the first runs, the others wait.
    pub held: Vec<(JobId, JobKind, Stamp)>,
    /// Jobs wait until [`Window::finish_held`], so that commands can come before their end.
    pub holds: bool,
    n_jobs: u64,
    /// Does the jobs in place of the made-up files and matches.
    pub runner: Option<fn(JobKind) -> Result<JobOutput, String>>,
    pub effects: Vec<Effect>,
}

impl Window {
    pub fn new() -> Self {
        Self {
            state: AppState::new(Settings::default()),
            ..Self::default()
        }
    }

    pub fn with_both() -> Self {
        let mut window = Self::new();
        window.open("crash.k", Role::Crash);
        window.open("stamped.k", Role::Stamped);
        window
    }

    /// With the crash model and the stamped part that lie in a folder, whose jobs are done by `runner`.
    pub fn with_files_of(folder: &Path, runner: fn(JobKind) -> Result<JobOutput, String>) -> Self {
        let mut window = Self::new();
        window.runner = Some(runner);
        for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
            window.open(folder.join(name).to_str().unwrap(), role);
        }
        window
    }

    /// Both parts, and a match that compares its pose with no others: a bent strip, which its ends alone
    /// keep from sliding, then has a weak result.
    pub fn with_both_and_no_rivals() -> Self {
        let mut window = Self::with_both();
        let mut recipe = window.state.document.recipe.clone();
        recipe.settings.starts.wide_search = false;
        window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
        window
    }

    pub fn open(&mut self, name: &str, role: Role) {
        self.apply(FileCommand::Open {
            paths: vec![PathBuf::from(name)],
            role: Some(role),
        });
    }

    pub fn apply(&mut self, command: impl Into<Command>) {
        let effects = self.state.apply(command);
        for effect in effects {
            match effect {
                Effect::StartJob(kind, stamp) => self.submit(*kind, stamp),
                Effect::CancelJob(key) => self.cancel(key),
                other => self.effects.push(other),
            }
        }
    }

    pub fn act(&mut self, action: Action) {
        if let Some(command) = action.command(&self.state) {
            self.apply(command);
        }
    }

    /// Closes every toast, so that Escape finds none.
    pub fn close_toasts(&mut self) {
        loop {
            let next = self.state.log.notices.toasts().next();
            let Some(id) = next.map(|notice| notice.id) else {
                return;
            };
            self.apply(NoticeCommand::Dismiss(id));
        }
    }

    pub fn submit(&mut self, kind: JobKind, stamp: Stamp) {
        self.n_jobs += 1;
        let id = JobId(self.n_jobs);
        if !self.holds {
            self.tell(id, kind.key(), stamp, JobStage::Started);
            return self.finish(id, kind, stamp);
        }
        let waits = |at: &usize| self.held[*at].1.key() == kind.key();
        let replaced = (1..self.held.len()).find(waits);
        let replaced = replaced.map(|at| self.held.remove(at));
        self.held.push((id, kind, stamp));
        if let Some((id, kind, stamp)) = replaced {
            self.tell(id, kind.key(), stamp, JobStage::Cancelled);
        }
        self.begin_held();
    }

    /// As the worker does, takes up the first job as soon as none runs.
    fn begin_held(&mut self) {
        let first = self.held.first();
        let first = first.map(|(id, kind, stamp)| (*id, kind.key(), *stamp));
        if let Some((id, key, stamp)) = first.filter(|_| self.state.jobs.running().is_none()) {
            self.tell(id, key, stamp, JobStage::Started);
        }
    }

    pub fn cancel(&mut self, key: JobKey) {
        let (gone, kept) = std::mem::take(&mut self.held)
            .into_iter()
            .partition(|(_, kind, _)| kind.key() == key);
        self.held = kept;
        for (id, kind, stamp) in gone {
            self.tell(id, kind.key(), stamp, JobStage::Cancelled);
        }
        self.begin_held();
    }

    pub fn finish_held(&mut self) {
        self.holds = false;
        while !self.held.is_empty() {
            self.begin_held();
            let (id, kind, stamp) = self.held.remove(0);
            self.finish(id, kind, stamp);
        }
    }

    pub fn finish(&mut self, id: JobId, kind: JobKind, stamp: Stamp) {
        let key = kind.key();
        let stage = match self.runner.unwrap_or(run)(kind) {
            Ok(output) => JobStage::Finished(output),
            Err(message) => JobStage::Failed(message),
        };
        self.tell(id, key, stamp, stage);
        if self.holds {
            self.begin_held();
        }
    }

    pub fn tell(&mut self, id: JobId, key: JobKey, stamp: Stamp, stage: JobStage) {
        let elapsed = Duration::from_millis(5);
        self.apply(JobEvent {
            id,
            key,
            stamp,
            elapsed,
            stage,
        });
    }

    pub fn pose(&self) -> Similarity {
        *self.state.document.crash_from_stamped()
    }

    pub fn mesh(&self, role: Role) -> Arc<TriMesh> {
        Arc::clone(&self.state.document.part(role).unwrap().loaded.mesh)
    }

    pub fn part(&self, role: Role) -> &Part {
        self.state.document.part(role).unwrap()
    }
}

/// Reductions are real, files and matches are made up.
fn run(kind: JobKind) -> Result<JobOutput, String> {
    match kind {
        JobKind::Load {
            role,
            source,
            settings,
        } => {
            let (part, facts) = read(&source, &settings)?;
            Ok(JobOutput::Loaded {
                role,
                source,
                part,
                facts,
            })
        }
        JobKind::Match(_) => Ok(JobOutput::Matched(made_up_match(kind)?)),
        JobKind::Align(_) => Ok(JobOutput::Aligned(Arc::new(vec![
            given_start(10.0),
            given_start(20.0),
        ]))),
        other => PipelineRunner
            .run(other, &Monitor::silent())
            .map_err(|error| error.to_string()),
    }
}

fn given_start(x: f64) -> Start {
    Start {
        kind: StartKind::Given { index: 0 },
        flipped: false,
        target_from_source: shifted(x),
    }
}

/// A real match whose poses are replaced by ones that a test can tell apart.
fn made_up_match(kind: JobKind) -> Result<Arc<MatchRun>, String> {
    let output = PipelineRunner
        .run(kind, &Monitor::silent())
        .map_err(|error| error.to_string())?;
    let JobOutput::Matched(run) = output else {
        return Err("no match".to_owned());
    };
    let alternative = |x: f64| Alternative {
        target_from_source: shifted(x),
        score_ratio: 1.0 + 0.01 * x,
        by_shape: false,
        start: 0,
    };
    let outcome = MatchOutcome {
        alternatives: vec![alternative(2.0), alternative(3.0), alternative(90.0)],
        ..MatchOutcome::clone(&run.outcome)
    };
    Ok(Arc::new(MatchRun {
        crash_from_stamped: shifted(1.0),
        outcome: Arc::new(outcome),
        ..MatchRun::clone(&run)
    }))
}

#[test]
fn two_files_without_roles_are_sorted_by_content() {
    let mut window = Window::new();
    let paths = ["stamped.k", "crash.k"].map(PathBuf::from).to_vec();
    window.apply(FileCommand::Open { paths, role: None });
    assert_eq!(window.part(Role::Crash).facts.parts.len(), 2);
    assert_eq!(
        window.part(Role::Stamped).facts.formed,
        FormingEvidence::ThicknessPerElement
    );
    let offers_swap = |n: &Notice| n.offers == [Action::Swap];
    assert!(window.state.log.notices.toasts().any(offers_swap));
    let before = window.mesh(Role::Crash);
    window.apply(FileCommand::Swap);
    assert!(
        Arc::ptr_eq(&before, &window.mesh(Role::Stamped)),
        "nothing reloads"
    );
}

/// Files that were opened as the one and the other part stay there; where they speak against it, a swap is offered.
#[test]
fn a_swap_is_offered_for_files_that_were_opened_the_other_way_round() {
    let offers = |crash: &str, stamped: &str| {
        let mut window = Window::new();
        window.open(crash, Role::Crash);
        window.open(stamped, Role::Stamped);
        assert_eq!(window.part(Role::Crash).loaded.file_name(), crash);
        let is_offer = |n: &Notice| n.offers == [Action::Swap] && n.count == 1;
        let is_offered = window.state.log.notices.toasts().any(is_offer);
        window.act(Action::Swap);
        let mut left = window.state.log.notices.toasts();
        assert!(!left.any(is_offer), "it is swapped");
        is_offered
    };
    assert!(offers("panel_stamped.k", "panel_crash.k"));
    assert!(!offers("panel_crash.k", "panel_stamped.k"));
    // The content counts: the file called crash is the one that was formed.
    assert!(!offers("crash.k", "stamped.k"));
}

#[test]
fn names_decide_where_the_content_of_two_files_says_nothing() {
    let of = |names: [&str; 2]| {
        let mut window = Window::new();
        let paths = names.map(PathBuf::from).to_vec();
        window.apply(FileCommand::Open { paths, role: None });
        window.part(Role::Stamped).loaded.file_name()
    };
    assert_eq!(of(["panel_stamped.k", "panel_crash.k"]), "panel_stamped.k");
    assert_eq!(of(["panel_crash.k", "panel_stamped.k"]), "panel_stamped.k");
}

#[test]
fn a_deck_of_several_parts_asks_which_of_them_is_matched() {
    let mut window = Window::new();
    window.open("car.k", Role::Crash);
    assert!(window.state.part_question().is_none(), "like what?");
    window.open("stamped.k", Role::Stamped);
    let asked = window.state.part_question().unwrap();
    assert_eq!((asked.only(), asked.n_used), (Some(&[22][..]), 3));
    window.apply(PartCommand::UseAll(Role::Crash));
    assert!(window.state.part_question().is_none(), "it was answered");

    // A weak match of all of them names this cause and no other.
    let mut matched = Window::with_both();
    matched.act(Action::MatchOrStop);
    let mut result = matched.state.document.result.clone().unwrap();
    result.stamp = window.state.document.stamp();
    let mut run = (*result.run).clone();
    let mut assessment = (*run.assessment).clone();
    assessment.verdict = shapematch::assess::Verdict::Poor;
    run.assessment = assessment.into();
    result.run = Arc::new(run).into();
    window.state.document.result = Some(result);
    let causes = window.state.causes();
    let titles: Vec<&str> = causes.iter().map(|cause| &*cause.title).collect();
    assert_eq!(titles, ["3 crash parts are matched as one"]);
    let (label, remedy) = causes[0].remedy.clone().unwrap();
    assert_eq!(label, "Match only 22");
    for command in remedy {
        window.apply(command);
    }
    assert!(window.part(Role::Crash).facts.used.iter().eq(&[22]));
    assert!(window.state.more_alike().is_none());

    // The two halves of a strip are the stamped part only together.
    assert!(Window::with_both().state.part_question().is_none());
}

#[test]
fn diagnostics_of_every_file_are_listed() {
    use shapematch::formats::{Diagnostic, DiagnosticKind};
    let mut window = Window::with_both();
    let has_tab = |window: &Window| window.state.has_content(BottomTab::Diagnostics);
    let names = |window: &Window| -> Vec<String> {
        let files = window.state.document.files_with_diagnostics();
        files.map(|(_, part)| part.file_name()).collect()
    };
    assert!(!has_tab(&window) && names(&window).is_empty());
    // What is left out of the mesh, in a further stamped file alone.
    let mut loaded = window.part(Role::Stamped).loaded.clone_inner();
    loaded.path = PathBuf::from("further.k");
    let mut found = shapematch::formats::Diagnostics::default();
    found.push(Diagnostic::new(DiagnosticKind::ZeroArea, "shell 7"));
    loaded.surface_diagnostics = Arc::new(found);
    let further = &mut window.state.document.mapping.further;
    further.push(Further {
        loaded: Arc::new(loaded).into(),
        revision: 99,
        pose: FurtherPose::default(),
        placing: None,
    });
    assert!(has_tab(&window));
    assert_eq!(names(&window), ["further.k"]);
}

#[test]
fn a_result_is_a_toast_only_where_its_card_is_not_seen() {
    let mut window = Window::with_both_and_no_rivals();
    window.act(Action::MatchOrStop);
    assert!(window.state.log.latest(LogStep::Result).is_some());
    assert_eq!(window.state.log.notices.toasts().count(), 0);
    let line = &window.state.log.latest(LogStep::Result).unwrap().text;
    let has_it = |notice: &Notice| notice.text == *line;
    assert!(window.state.log.notices.kept().any(has_it), "in the bell");
    window.apply(ViewCommand::OpenSection(Section::Match, false));
    window.act(Action::MatchOrStop);
    assert_eq!(window.state.log.notices.toasts().count(), 1);
}

#[test]
fn the_right_window_keeps_the_deviation_while_the_part_is_moved() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    window.apply(ViewCommand::ToggleMoveOver);
    assert_eq!(window.state.free_window(), Some(FreeWindow::Deviation));
    window.apply(MoveCommand::Flip(Axis::X));
    assert!(window.state.document.current_result().is_none());
    assert_eq!(window.state.free_window(), Some(FreeWindow::Deviation));
}

#[test]
fn one_formed_file_without_a_role_is_the_stamped_part() {
    let mut window = Window::new();
    let paths = vec![PathBuf::from("stamped.k")];
    window.apply(FileCommand::Open { paths, role: None });
    assert!(window.state.document.part(Role::Stamped).is_some());
    assert!(window.state.document.part(Role::Crash).is_none());
}

#[test]
fn a_file_that_cannot_be_read_is_a_message_and_the_old_part_stays() {
    let mut window = Window::with_both();
    let before = window.state.document.clone();
    window.open("missing.k", Role::Crash);
    assert_eq!(window.state.document, before);
    let toast = window.state.log.notices.toasts().next().unwrap();
    assert_eq!(toast.level, NoticeLevel::Error);
    assert!(toast.text.contains("missing.k"));
}

#[test]
fn units_are_hinted_once_and_the_factor_is_one_undo_step() {
    let mut window = Window::new();
    window.open("crash.k", Role::Crash);
    window.open("metres.k", Role::Stamped);
    assert_eq!(window.state.hinted_length_factor(), Some(1000.0));
    let (label, _) = window.state.unit_remedy().unwrap();
    assert_eq!(label, "Multiply stamped lengths by 1000");
    let before = window.state.document.clone();
    window.apply(FileCommand::SetLengthFactor {
        role: Role::Stamped,
        factor: 1000.0,
    });
    assert_eq!(window.part(Role::Stamped).length_factor(), 1000.0);
    assert_eq!(window.state.unit_hint(), None);
    window.act(Action::Undo);
    assert_eq!(window.state.document, before);
    window.apply(FileCommand::DismissUnitHint);
    assert_eq!(window.state.unit_hint(), None);
}

#[test]
fn while_the_unit_is_asked_a_match_says_nothing_else() {
    let mut window = Window::new();
    window.open("crash.k", Role::Crash);
    window.open("metres.k", Role::Stamped);
    window.act(Action::MatchOrStop);
    assert!(window.state.document.current_result().is_some());
    assert!(window.state.is_unit_in_doubt());
    assert_eq!(window.state.n_equal_poses(), 1);
    let causes = window.state.causes();
    assert_eq!(causes.len(), 1, "{causes:?}");
    assert!(Action::NextAlternative.enabled(&window.state).is_err());
    window.apply(FileCommand::DismissUnitHint);
    assert!(!window.state.is_unit_in_doubt());
}

#[test]
fn levels_that_reduce_nothing_are_not_offered() {
    let mut window = Window::with_both();
    let n_full = Role::ALL
        .map(|role| window.part(role).loaded.report.n_triangles)
        .into_iter()
        .max()
        .unwrap();
    let settings = Settings {
        marked_levels: vec![50_000, n_full, n_full - 1, 60],
        ..window.state.settings.clone()
    };
    window.apply(Command::Settings(Box::new(settings)));
    assert_eq!(window.state.reachable_levels(), [n_full - 1, 60]);
    assert_eq!(window.state.next_level(1), Some(Some(n_full - 1)));
    window.act(Action::NextLevel);
    assert_eq!(window.part(Role::Crash).wanted_level, Some(n_full - 1));
    assert_eq!(window.state.next_level(-1), Some(None), "the full mesh");
}

#[test]
fn reducing_is_one_step_and_levels_follow_the_keys() {
    let mut window = Window::with_both();
    let settings = Settings {
        marked_levels: vec![100, 60, 30],
        ..window.state.settings.clone()
    };
    window.apply(Command::Settings(Box::new(settings)));
    let n_done = window.state.history.n_done();
    window.act(Action::NextLevel);
    for role in Role::ALL {
        assert!(window.part(role).reduced_mesh().n_triangles() <= 100);
        let level = window.part(role).level.as_ref().unwrap();
        assert!(level.deviation.get().is_some(), "measured");
    }
    assert_eq!(window.state.history.n_done(), n_done + 1);
    let name = window.state.history.undo_name();
    assert_eq!(name, Some("Reduce both parts to at most 100"));
    window.act(Action::NextLevel);
    for role in Role::ALL {
        assert_eq!(window.part(role).wanted_level, Some(60));
    }
    window.act(Action::Undo);
    for role in Role::ALL {
        assert_eq!(window.part(role).wanted_level, Some(100));
    }
    window.act(Action::Undo);
    for role in Role::ALL {
        assert!(window.part(role).level.is_none(), "both are full again");
    }
    window.act(Action::Redo);
    window.act(Action::Redo);
    assert_eq!(window.part(Role::Crash).wanted_level, Some(60));
    window.act(Action::PreviousLevel);
    window.act(Action::PreviousLevel);
    assert!(window.part(Role::Crash).level.is_none());
    assert_eq!(
        Action::PreviousLevel.enabled(&window.state),
        Err(Reason("This is the full mesh."))
    );
}

#[test]
fn a_part_left_out_makes_the_surface_anew_and_reduces_it_again() {
    let mut window = Window::with_both();
    window.apply(ReduceCommand::To {
        roles: PerRole {
            crash: true,
            stamped: false,
        },
        max_triangles: 50,
    });
    let (crash, id) = (Role::Crash, 12);
    let n_before = window.mesh(crash).n_triangles();
    window.apply(PartCommand::SetUsed(PartRef { role: crash, id }, false));
    assert!(window.mesh(crash).n_triangles() < n_before);
    assert!(!window.part(crash).is_used(12));
    assert!(window.part(crash).level.is_some());
    let last = PartRef {
        role: crash,
        id: 11,
    };
    let before = window.state.document.clone();
    window.apply(PartCommand::SetUsed(last, false));
    assert_eq!(window.state.document, before, "the last part stays");
}

#[test]
fn the_choice_of_one_part_is_named_by_it() {
    let mut window = Window::with_both();
    let role = Role::Crash;
    window.apply(PartCommand::UseOnly(PartRef { role, id: 12 }));
    assert_eq!(window.state.history.undo_name(), Some("Use only 12"));
    window.apply(PartCommand::UseAll(role));
    assert_eq!(window.state.history.undo_name(), Some("Use 2 parts"));
}

#[test]
fn a_drag_is_one_undo_step_from_the_pose_at_the_grab() {
    let mut window = Window::with_both();
    let n_done = window.state.history.n_done();
    let gesture = GestureId(1);
    for x in [0.1, 0.5, 2.0] {
        window.apply(MoveCommand::Drag {
            gesture,
            delta: shifted(x),
            name: format!("Move {x} along X"),
        });
    }
    window.apply(MoveCommand::EndDrag);
    assert_eq!(window.pose(), shifted(2.0));
    assert_eq!(window.state.history.n_done(), n_done + 1);
    assert_eq!(window.state.history.undo_name(), Some("Move 2 along X"));
    window.act(Action::Undo);
    assert_eq!(window.pose(), Similarity::identity());
}

#[test]
fn a_drag_that_comes_back_leaves_no_step() {
    let mut window = Window::with_both();
    let before = window.state.document.clone();
    let n_done = window.state.history.n_done();
    for x in [1.0, 0.0] {
        window.apply(MoveCommand::Drag {
            gesture: GestureId(1),
            delta: shifted(x),
            name: "Move".to_owned(),
        });
    }
    window.apply(MoveCommand::EndDrag);
    assert_eq!(window.state.document, before);
    assert_eq!(window.state.history.n_done(), n_done);
}

/// Everything that is only looked at, in between.
fn look_around(window: &mut Window) {
    let before = (window.state.document.clone(), window.state.history.n_done());
    for command in [
        ViewCommand::ToggleMoveOver,
        ViewCommand::Standard(Role::Crash, StandardView::Top),
        ViewCommand::ToggleLink,
        ViewCommand::SetBlinking(true),
        ViewCommand::SetBlinking(false),
        ViewCommand::SetShown(ShownGeometry::Detailed),
        ViewCommand::SetShown(ShownGeometry::Reduced),
        ViewCommand::SetDisplay(Box::new(Display {
            is_see_through: true,
            separation: 5.0,
            wipe: Some(0.4),
            has_edges: true,
            ..Display::default()
        })),
        ViewCommand::SetDisplay(Box::default()),
        ViewCommand::SetTab(BottomTab::History),
        ViewCommand::OpenSection(Section::Match, false),
        ViewCommand::ToggleGraphicsOnly,
        ViewCommand::ToggleGraphicsOnly,
        ViewCommand::ToggleMoveOver,
    ] {
        window.apply(command);
    }
    let after = (window.state.document.clone(), window.state.history.n_done());
    assert!(before == after, "looking is no step");
}

#[test]
fn each_change_is_one_step_in_its_order_and_looking_is_none() {
    let mut window = Window::with_both();
    let crash = window.mesh(Role::Crash);
    let bits = |mesh: &TriMesh| -> Vec<[u64; 3]> {
        let positions = mesh.positions().iter();
        positions
            .map(|p| [p.x, p.y, p.z].map(f64::to_bits))
            .collect()
    };
    let as_loaded = bits(&crash);
    let id = *window.part(Role::Crash).facts.used.first().unwrap();
    let part = PartRef {
        role: Role::Crash,
        id,
    };
    let one = |role| PerRole::from_fn(|other| other == role);
    let paste = MatrixForm::Rows.write(&shifted(3.0));
    let steps: Vec<Vec<Command>> = vec![
        vec![
            MoveCommand::Drag {
                gesture: GestureId(7),
                delta: shifted(0.5),
                name: "Move 0.5 along X".to_owned(),
            }
            .into(),
            MoveCommand::EndDrag.into(),
        ],
        vec![
            MoveCommand::Translate {
                axis: Axis::Y,
                frame: AxisFrame::Global,
                distance: 2.0,
            }
            .into(),
        ],
        vec![MoveCommand::Paste(paste).into()],
        vec![
            ReduceCommand::To {
                roles: one(Role::Stamped),
                max_triangles: 60,
            }
            .into(),
        ],
        vec![MatchCommand::Run.into()],
        vec![PartCommand::SetVisible(part, false).into()],
        vec![
            FileCommand::SetLengthFactor {
                role: Role::Stamped,
                factor: 10.0,
            }
            .into(),
        ],
    ];
    let mut documents = vec![window.state.document.clone()];
    for (index, step) in steps.into_iter().enumerate() {
        let n_done = window.state.history.n_done();
        for command in step {
            window.apply(command);
        }
        assert_eq!(window.state.history.n_done(), n_done + 1, "step {index}");
        look_around(&mut window);
        documents.push(window.state.document.clone());
    }
    for before in documents.iter().rev().skip(1) {
        window.act(Action::Undo);
        assert!(window.state.document == *before, "undone out of order");
        look_around(&mut window);
    }
    for after in documents.iter().skip(1) {
        window.act(Action::Redo);
        assert!(window.state.document == *after, "redone out of order");
    }
    assert_eq!(bits(&window.mesh(Role::Crash)), as_loaded);
}

#[test]
fn another_step_during_a_drag_does_not_move_the_part_twice() {
    let mut window = Window::with_both();
    let drag = |x| MoveCommand::Drag {
        gesture: GestureId(1),
        delta: shifted(x),
        name: "Move".to_owned(),
    };
    window.apply(drag(1.0));
    let part = PartRef {
        role: Role::Crash,
        id: 12,
    };
    window.apply(PartCommand::SetVisible(part, false));
    window.apply(drag(2.0));
    assert_eq!(window.pose(), shifted(2.0));
    window.apply(MoveCommand::AbandonDrag(GestureId(1)));
    assert_eq!(window.pose(), Similarity::identity());
    window.act(Action::Undo);
    assert_eq!(window.pose(), shifted(1.0));
    assert!(!window.part(Role::Crash).is_visible(12));
}

#[test]
fn keys_move_along_an_axis_by_a_typed_value() {
    let mut window = Window::with_both();
    window.act(Action::MoveTool);
    let axis = ModalInput::Axis {
        axis: Axis::Z,
        is_plane: false,
    };
    window.apply(MoveCommand::Input(axis));
    for c in "12.5".chars() {
        window.apply(MoveCommand::Input(ModalInput::Character(c)));
    }
    let tool = window.state.moving.tool.as_ref().unwrap();
    assert_eq!(tool.modal.header(&tool.frame), "Move 12.5 along Z   [12.5]");
    window.apply(MoveCommand::Input(ModalInput::Accept));
    assert_eq!(window.pose().translation, Vector3::new(0.0, 0.0, 12.5));
    assert_eq!(window.state.history.undo_name(), Some("Move 12.5 along Z"));
}

#[test]
fn escape_takes_a_move_by_keys_back_without_a_trace() {
    let mut window = Window::with_both();
    let before = window.state.document.clone();
    let n_done = window.state.history.n_done();
    window.act(Action::RotateTool);
    for c in "-90".chars() {
        window.apply(MoveCommand::Input(ModalInput::Character(c)));
    }
    assert_ne!(window.state.document, before);
    window.apply(Command::Escape);
    assert_eq!(window.state.document, before);
    assert_eq!(window.state.history.n_done(), n_done);
    assert!(window.state.moving.tool.is_none());
}

#[test]
fn a_move_by_keys_ends_before_what_it_stands_on_changes() {
    let begun = || {
        let mut window = Window::with_both();
        let before = window.state.document.clone();
        window.act(Action::MoveTool);
        window.apply(MoveCommand::Input(ModalInput::Character('1')));
        assert_ne!(window.state.document, before);
        (window, before)
    };
    let (mut window, before) = begun();
    window.apply(FileCommand::Close(Role::Stamped));
    assert!(window.state.moving.tool.is_none());
    window.act(Action::Undo);
    assert_eq!(window.state.document, before);

    // Escape is for the match that runs, not for a tool below it.
    let (mut window, before) = begun();
    window.holds = true;
    window.act(Action::MatchOrStop);
    window.close_toasts();
    window.apply(Command::Escape);
    assert!(window.state.moving.tool.is_none());
    assert_eq!(window.state.document.pose, before.pose);
    assert!(!window.state.jobs.is_busy());
}

/// A part that comes under the pointer, and what the program does by itself, are not what the move stands on.
#[test]
fn a_move_by_keys_goes_on_over_parts_and_news() {
    for action in [Action::MoveTool, Action::RotateTool] {
        let mut window = Window::with_both();
        window.act(action);
        let axis = ModalInput::Axis {
            axis: Axis::X,
            is_plane: false,
        };
        window.apply(MoveCommand::Input(axis));
        window.apply(MoveCommand::Input(ModalInput::Character('5')));
        let moved = window.pose();
        assert_ne!(moved, Similarity::identity());
        let part = PartRef {
            role: Role::Crash,
            id: 12,
        };
        window.apply(PartCommand::Hover(Some(part)));
        window.apply(PartCommand::Hover(None));
        window.apply(ProjectCommand::Autosave);
        window.apply(ProjectCommand::NotWritten);
        window.apply(FileCommand::ChangedOnDisk(std::collections::BTreeSet::new()));
        assert!(window.state.moving.tool.is_some(), "{action:?}");
        window.apply(MoveCommand::Input(ModalInput::Accept));
        assert_eq!(window.pose(), moved, "{action:?}");
        assert!(window.state.moving.tool.is_none());
    }
}

#[test]
fn turning_over_twice_comes_back() {
    for action in [Action::FlipX, Action::FlipY, Action::FlipZ] {
        let mut window = Window::with_both();
        window.act(action);
        let center = window.part(Role::Stamped).bounds().center();
        assert!((window.pose().apply(&center) - center).norm() < 1e-12);
        assert!(
            (window.pose().angle_to(&Similarity::identity()) - std::f64::consts::PI).abs() < 1e-9
        );
        window.act(action);
        let back = window.pose().to_matrix4() - Similarity::identity().to_matrix4();
        assert!(back.amax() < 1e-12);
    }
}

/// Shares of two different parts have no difference.
#[test]
fn the_change_of_an_overlap_is_that_of_one_part() {
    let mut window = Window::with_both();
    let mut told = |of: Role, overlap: f64| {
        for (of, overlap) in [(Role::Stamped, 0.93), (of, overlap)] {
            let output = JobOutput::Overlapped {
                of,
                overlap,
                limit: 1.0,
            };
            let stamp = window.state.document.stamp();
            let stage = JobStage::Finished(output);
            window.tell(JobId(77), JobKey::Overlap, stamp, stage);
        }
        let known = window.state.current_overlap().unwrap();
        (known.of, known.change)
    };
    assert_eq!(told(Role::Crash, 0.5), (Role::Crash, None));
    assert_eq!(told(Role::Stamped, 0.5), (Role::Stamped, Some(0.5 - 0.93)));
    // Neither is covered: of the one that was, all is lost.
    assert_eq!(told(Role::Crash, 0.0), (Role::Stamped, Some(-0.93)));
}

#[test]
fn centers_meet() {
    let mut window = Window::with_both();
    window.act(Action::AlignCenters);
    let here = window.state.document.stamped_center().unwrap();
    let there = window.part(Role::Crash).bounds().center();
    assert!((here - there).norm() < 1e-12);
}

#[test]
fn a_match_is_one_step_and_its_alternatives_are_one_key_away() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    assert_eq!(window.pose(), shifted(1.0));
    assert!(window.state.document.current_result().is_some());
    for x in [2.0, 3.0, 1.0] {
        window.act(Action::NextAlternative);
        assert_eq!(window.pose(), shifted(x));
        assert!(window.state.document.current_result().is_some());
        let row = &window.state.stamped_rows()[0];
        let number = match row.state {
            StampedState::Alternative(_, number) => number,
            StampedState::Matched(..) => 1,
            _ => 0,
        };
        assert_eq!(number as f64, x, "section 4 names the pose");
    }
    // How far the pose of the result may be off says nothing of the pose in the window beside it.
    window.act(Action::ToggleUncertainty);
    window.apply(ViewCommand::ToggleMoveOver);
    window.apply(ViewCommand::SetFreeWindow(FreeWindow::Alternative));
    assert_eq!(window.state.free_window(), Some(FreeWindow::Alternative));
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::Uncertainty);
    assert_eq!(window.state.color_by(Role::Stamped), ColorBy::Role);
    window.apply(MoveCommand::Flip(Axis::X));
    assert!(window.state.stale(Section::Match).is_some());
    for _ in 0..5 {
        window.act(Action::Undo);
    }
    assert_eq!(window.pose(), Similarity::identity());
    assert!(window.state.document.result.is_none());
}

#[test]
fn why_something_is_not_possible_is_a_toast_and_no_news() {
    let mut window = Window::new();
    window.apply(NoticeCommand::Explain("Run a match first.".into()));
    assert_eq!(toasts(&window.state), ["Run a match first."]);
    assert_eq!(window.state.log.notices.n_unread(), 0);
    // It may be possible once there is a match.
    let mut window = Window::with_both();
    window.apply(NoticeCommand::Explain("There is no match yet.".into()));
    window.act(Action::MatchOrStop);
    let told = toasts(&window.state);
    assert!(
        !told.iter().any(|text| text.contains("no match yet")),
        "{told:?}"
    );
}

#[test]
fn back_to_the_result_is_in_the_log() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    window.apply(MoveCommand::Flip(Axis::X));
    window.apply(MatchCommand::ShowAlternative(None));
    assert_eq!(window.pose(), shifted(1.0));
    assert_eq!(
        window.state.log.latest(LogStep::Match).unwrap().text,
        "Best pose"
    );
}

#[test]
fn a_file_that_ends_a_result_says_so_and_offers_the_way_back() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    window.state.tick(Duration::from_secs(1));
    window.open("car.k", Role::Crash);
    assert!(window.state.document.result.is_none());
    let offers = |notice: &&Notice| notice.offers == [Action::Undo];
    let toasts = |window: &Window| window.state.log.notices.toasts().filter(offers).count();
    assert_eq!(toasts(&window), 1);
    let told = &window.state.log.latest(LogStep::Load).unwrap().text;
    assert!(told.contains("discarded the result of the match"), "{told}");
    // After another step, undo would take that one back.
    window.apply(MoveCommand::Flip(Axis::X));
    assert_eq!(toasts(&window), 0);
    for _ in 0..2 {
        window.act(Action::Undo);
    }
    assert!(window.state.document.current_result().is_some());
}

#[test]
fn what_is_said_of_a_step_goes_with_it() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    window.state.tick(Duration::from_secs(1));
    window.apply(NoticeCommand::Tell(
        NoticeLevel::Warning,
        "older".to_owned(),
    ));
    window.state.tick(Duration::from_secs(2));
    window.open("car.k", Role::Crash);
    assert!(window.state.log.notices.toasts().count() > 1);
    window.state.tick(Duration::from_secs(3));
    window.act(Action::Undo);
    assert_eq!(toasts(&window.state), ["older"]);
}

/// What the toasts say.
fn toasts(state: &AppState) -> Vec<&str> {
    let toasts = state.log.notices.toasts();
    toasts.map(|notice| &*notice.text).collect()
}

#[test]
fn recent_files_of_one_name_are_told_apart_by_folder_and_part() {
    let mut settings = Settings::default();
    for path in ["/a/run/sheet.k", "/b/run/sheet.k", "/b/car.k"] {
        settings.remember_path(Path::new(path), 0);
    }
    let name = |path: &str| settings.recent_name(Path::new(path));
    assert_eq!(name("/b/car.k"), "car.k");
    let told: PathBuf = ["a", "run", "sheet.k"].iter().collect();
    assert_eq!(name("/a/run/sheet.k"), told.display().to_string());

    let mut window = Window::with_both();
    let role = |window: &Window, name: &str| {
        let roles = &window.state.settings.opened_as;
        roles.get(&std::path::absolute(name).unwrap()).copied()
    };
    assert_eq!(role(&window, "crash.k"), Some(Role::Crash));
    assert_eq!(role(&window, "stamped.k"), Some(Role::Stamped));
    window.act(Action::Swap);
    assert_eq!(role(&window, "crash.k"), Some(Role::Stamped));
    // A file that was named from the folder that the program runs in is found from any other.
    let crash = std::path::absolute("crash.k").unwrap();
    assert!(window.state.settings.recent.contains(&crash));
    window.apply(FileCommand::ForgetRecent(crash));
    assert_eq!(role(&window, "crash.k"), None);
}

#[test]
fn the_numbers_of_the_result_are_those_of_the_shown_pose() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let of_match = {
        let result = window.state.document.current_result().unwrap();
        result.run.assessment.coverage
    };
    let shown = |window: &Window| *window.state.result_coverage().unwrap();
    assert_eq!(shown(&window), of_match);
    window.act(Action::NextAlternative);
    let pair = PerRole::new(window.part(Role::Crash), window.part(Role::Stamped));
    let input = MeasureInput {
        parts: pair.map(|part| part.loaded.to_arc()),
        crash_from_stamped: shifted(2.0),
        alternative_of: None,
    };
    let measured = PipelineRunner.run(JobKind::Measure(input), &Monitor::silent());
    let Ok(JobOutput::Measured(measured)) = measured else {
        panic!("not measured");
    };
    assert_eq!(shown(&window), measured.coverage);
    assert_ne!(shown(&window), of_match);
    // It has both statements, under its own pose and with the tolerance that is asked for.
    let said = window.state.alternative_statements().unwrap().clone();
    assert_eq!(said.pose.kind, PoseKind::Ambiguous);
    let sentences = said.sentences(window.state.lengths());
    assert!(sentences[0].starts_with("pose ") && sentences[1].starts_with("shape: "));
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.shape_tolerance = 2.0 * said.shape.tolerance.remainder;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    let with = |window: &Window| {
        let said = window.state.alternative_statements().unwrap();
        said.shape.tolerance.remainder
    };
    assert_eq!(with(&window), 2.0 * said.shape.tolerance.remainder);
    window.act(Action::Undo);
    assert_eq!(with(&window), said.shape.tolerance.remainder);
    // Moved from there, the alternative is still the earlier result.
    window.apply(MoveCommand::Flip(Axis::X));
    let earlier = window.state.document.result.clone().unwrap();
    assert_eq!(window.state.coverage_of(&earlier), Some(&measured.coverage));
    assert_ne!(earlier.verdict(), shapematch::assess::Verdict::Good);
    window.act(Action::Undo);
    window.act(Action::NextAlternative);
    window.act(Action::NextAlternative);
    assert_eq!(shown(&window), of_match, "the best pose again");
}

/// One goes from pose to pose with the camera at rest, so it sees all of them beside what lies over the window.
#[test]
fn a_fitted_view_shows_every_pose_that_fits_as_well() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    if !window.state.view.is_moved_over {
        window.act(Action::ToggleMoveOver);
    }
    let fitted = |window: &mut Window| {
        window.apply(ViewCommand::FitAll(Role::Crash));
        window.state.view.cameras.crash
    };
    let of_best = fitted(&mut window);
    for _ in 0..2 {
        window.act(Action::NextAlternative);
        assert!(
            window
                .state
                .document
                .result
                .as_ref()
                .unwrap()
                .alternative
                .is_some()
        );
        assert_eq!(fitted(&mut window), of_best);
    }
}

#[test]
fn the_command_line_gives_the_shown_pose_or_says_why_not() {
    let mut window = Window::with_both();
    window.act(Action::MatchOrStop);
    let line = |window: &Window| window.state.document.command_line().unwrap();
    assert!(!line(&window).contains("--pose-number"));
    for number in [2, 3] {
        window.act(Action::NextAlternative);
        let expected = format!("--pose-number {number}");
        assert!(line(&window).contains(&expected), "{}", line(&window));
    }
    window.act(Action::NextAlternative);
    assert!(!line(&window).contains("--pose-number"));
    assert_eq!(Action::CopyCommandLine.enabled(&window.state), Ok(()));
    window.apply(MoveCommand::Flip(Axis::X));
    assert!(Action::CopyCommandLine.enabled(&window.state).is_err());
    window.act(Action::Undo);
    assert_eq!(Action::CopyCommandLine.enabled(&window.state), Ok(()));
}

#[test]
fn moves_by_hand_are_in_the_log_with_their_unit() {
    let mut window = Window::new();
    window.open("says_mm.k", Role::Crash);
    window.open("stamped.k", Role::Stamped);
    assert_eq!(window.state.document.unit_suffix(), " mm");
    let last = |window: &Window| {
        let row = window.state.log.latest(LogStep::Move);
        row.map(|row| row.text.clone())
    };
    assert_eq!(last(&window), None);
    window.apply(MoveCommand::Translate {
        axis: Axis::Z,
        frame: AxisFrame::Global,
        distance: 69.175_83,
    });
    assert_eq!(last(&window).as_deref(), Some("Move 69.176 mm along Z"));
    window.apply(MoveCommand::Drag {
        gesture: GestureId(1),
        delta: shifted(2.0),
        name: "Move 2 mm along X".to_owned(),
    });
    assert_eq!(last(&window).as_deref(), Some("Move 69.176 mm along Z"));
    window.apply(MoveCommand::EndDrag);
    assert_eq!(last(&window).as_deref(), Some("Move 2 mm along X"));
    window.act(Action::MoveTool);
    let tool = window.state.moving.tool.clone().unwrap();
    assert_eq!(tool.frame.unit, " mm");
}

#[test]
fn while_a_match_runs_inputs_are_locked_and_cancel_restores() {
    let mut window = Window::with_both();
    window.holds = true;
    window.act(Action::MatchOrStop);
    let before = window.state.document.clone();
    assert_eq!(
        Action::OpenCrash.enabled(&window.state),
        Err(Reason("A match is running."))
    );
    assert_eq!(Action::MatchOrStop.enabled(&window.state), Ok(()));
    window.apply(MoveCommand::Flip(Axis::X));
    window.act(Action::Undo);
    assert_eq!(window.state.document, before);
    let iteration = live_iteration(0, 0, 5.0);
    let live = Live {
        job: window.state.jobs.running().map(|job| job.id),
        best: Some(iteration.record),
        starts: vec![(0, running_start())],
        iterations: vec![iteration],
        ..Live::default()
    };
    window.apply(Command::Live(Box::new(live)));
    assert_eq!(window.state.shown_pose(), shifted(5.0));
    assert_eq!(
        window.state.can_map(),
        Err(Reason("A match is running.")),
        "none need be begun"
    );
    // A message, and windows without panels, are closed before the run is given up.
    window.close_toasts();
    let running = "A match is running.";
    window.apply(NoticeCommand::Tell(NoticeLevel::Note, running.into()));
    assert_eq!(toasts(&window.state), [running]);
    window.act(Action::ToggleGraphicsOnly);
    for _ in 0..2 {
        window.apply(Command::Escape);
        assert!(window.state.jobs.is_active(JobKey::Match));
        assert_eq!(window.state.shown_pose(), shifted(5.0));
    }
    assert!(toasts(&window.state).is_empty());
    assert!(!window.state.view.is_graphics_only);
    window.apply(Command::Escape);
    assert_eq!(window.state.shown_pose(), Similarity::identity());
    assert_eq!(window.state.document, before);
    assert!(!window.state.jobs.is_busy());
    assert_eq!(window.state.match_starts().len(), 1);
    let mut kept = window.state.log.notices.kept();
    let told = kept.find(|notice| notice.text == running);
    assert!(told.is_some_and(|notice| !notice.is_unread), "it is over");
}

#[test]
fn a_result_for_parts_that_are_gone_is_dropped_with_a_line() {
    let mut window = Window::with_both();
    window.holds = true;
    window.act(Action::Reduce);
    let held = std::mem::take(&mut window.held);
    window.holds = false;
    window.open("stamped.k", Role::Crash);
    window.held = held;
    window.finish_held();
    assert!(window.part(Role::Crash).level.is_none());
    assert!(window.part(Role::Stamped).level.is_some());
    let dropped = window.state.log.rows().iter();
    assert!(
        dropped
            .into_iter()
            .any(|row| row.text.contains("discarded"))
    );
}

#[test]
fn starts_are_stepped_through_without_moving_the_part() {
    let mut window = Window::with_both();
    window.act(Action::Align);
    assert_eq!(window.state.shown_pose(), shifted(10.0));
    window.act(Action::NextStart);
    assert_eq!(window.state.shown_pose(), shifted(20.0));
    window.act(Action::NextStart);
    assert_eq!(window.state.shown_pose(), shifted(10.0));
    assert_eq!(window.pose(), Similarity::identity());
    window.act(Action::PreviousStart);
    window.act(Action::UseStart);
    assert_eq!(window.pose(), shifted(20.0));
    assert!(!window.state.is_preview());
}

#[test]
fn first_poses_are_those_of_the_settings() {
    let mut window = Window::with_both();
    window.act(Action::Align);
    assert!(window.state.shown_start().is_some());
    let mut recipe = window.state.document.recipe.clone();
    recipe.settings.starts.angle_segment_deg = 20.5;
    window.apply(MatchCommand::SetRecipe(Box::new(recipe)));
    assert!(window.state.current_starts().is_none(), "of another step");
    assert!(!window.state.is_preview());
    assert!(Action::NextStart.enabled(&window.state).is_err());
    window.apply(HistoryCommand::Undo);
    assert_eq!(window.state.current_starts().map(<[_]>::len), Some(2));
    assert!(!window.state.is_preview());
}

#[test]
fn while_points_are_picked_the_key_of_the_gizmo_says_why_there_is_none() {
    let mut window = Window::with_both();
    window.act(Action::MeasureDistance);
    assert!(window.state.is_picking());
    assert!(Action::ToggleGizmo.enabled(&window.state).is_err());
    window.act(Action::MeasureDistance);
    window.act(Action::ToggleGizmo);
    assert!(window.state.moving.has_gizmo);
}

#[test]
fn the_own_window_is_fitted_to_the_part_where_it_is_while_starts_are_tried() {
    let mut window = Window::with_both();
    window.apply(ViewCommand::FitAll(Role::Stamped));
    let before = window.state.view.cameras.stamped;
    window.act(Action::Align);
    assert!(window.state.is_preview());
    window.apply(ViewCommand::FitAll(Role::Stamped));
    assert_eq!(window.state.view.cameras.stamped, before);
}

/// What is hidden is not brought into view.
#[test]
fn fitting_all_leaves_out_what_is_hidden() {
    let mut window = Window::new();
    window.open("car.k", Role::Crash);
    let height = |window: &mut Window| {
        window.apply(ViewCommand::FitBoth);
        window.state.view.cameras.crash.height
    };
    let whole = height(&mut window);
    window.apply(PartCommand::ShowOnly(PartRef {
        role: Role::Crash,
        id: 22,
    }));
    let shown = height(&mut window);
    assert!(shown < 0.8 * whole, "{shown} of {whole}");
}

#[test]
fn moving_over_fifty_times_changes_nothing_but_the_view() {
    let mut window = Window::with_both();
    let before = window.state.document.clone();
    for _ in 0..50 {
        window.act(Action::ToggleMoveOver);
        assert!(window.state.view.is_moved_over);
        window.act(Action::ToggleMoveOver);
    }
    assert!(!window.state.view.is_moved_over);
    assert_eq!(window.state.document, before);
}

#[test]
fn every_action_says_why_it_is_not_possible() {
    let window = Window::new();
    for &action in Action::ALL {
        if action.enabled(&window.state).is_err() {
            assert!(action.command(&window.state).is_none());
        }
    }
    let reason = |action: Action| action.enabled(&window.state).unwrap_err().0;
    assert_eq!(reason(Action::MatchOrStop), "Load both parts first.");
    assert_eq!(reason(Action::ToggleMoveOver), "Load both parts first.");
    assert_eq!(reason(Action::Undo), "Nothing to undo.");
    assert_eq!(reason(Action::MoveTool), "Load the stamped part first.");
}

#[test]
fn every_enabled_action_does_something() {
    let mut window = Window::with_both();
    window.act(Action::Reduce);
    window.act(Action::MatchOrStop);
    window.act(Action::Align);
    window.apply(PartCommand::Select(Some(PartRef {
        role: Role::Crash,
        id: 11,
    })));
    for &action in Action::ALL {
        let is_enabled = action.enabled(&window.state).is_ok();
        let does = action.command(&window.state).is_some();
        assert_eq!(is_enabled, does, "{action:?}");
    }
}

#[test]
fn what_can_be_on_or_off_says_which() {
    let mut window = Window::with_both();
    let mut switches = Action::ALL.to_vec();
    switches.retain(|action| {
        *action != Action::ToggleMoveOver && action.is_on(&window.state).is_some()
    });
    assert!(switches.contains(&Action::ToggleEdges) && switches.contains(&Action::ToggleLink));
    window.act(Action::ToggleMoveOver);
    assert_eq!(Action::ToggleMoveOver.is_on(&window.state), Some(true));
    for action in switches {
        if action.enabled(&window.state).is_err() {
            continue;
        }
        let before = action.is_on(&window.state);
        window.act(action);
        assert_ne!(action.is_on(&window.state), before, "{action:?}");
        window.act(action);
        assert_eq!(action.is_on(&window.state), before, "{action:?}");
    }
}

#[test]
fn labels_and_keys_are_unique() {
    let mut labels = std::collections::BTreeSet::new();
    let mut keys = std::collections::HashMap::new();
    for &action in Action::ALL {
        let info = action.row();
        assert!(labels.insert(info.label), "{:?}", info.label);
        assert!(!info.tooltip.is_empty() && !info.tooltip.ends_with('.'));
        for &shortcut in info.keys.shortcuts {
            let other = keys.insert(shortcut, action);
            assert_eq!(other, None, "{shortcut} is taken by {action:?}");
            assert_eq!(Action::of_shortcut(shortcut), Some(action));
        }
    }
}

#[test]
fn equal_messages_count_up_and_short_ones_end() {
    let mut window = Window::new();
    let tell = |level| NoticeCommand::Tell(level, "disk full".to_owned());
    for _ in 0..12 {
        window.apply(tell(NoticeLevel::Error));
    }
    window.apply(NoticeCommand::Tell(NoticeLevel::Success, "copied".into()));
    let counts: Vec<usize> = window.state.log.notices.toasts().map(|n| n.count).collect();
    assert_eq!(counts, [1, 12]);
    // A sentence begins with a capital, the name of a file as it is.
    let shown = window.state.log.notices.toasts().map(Notice::shown);
    assert_eq!(shown.collect::<Vec<_>>(), ["Copied", "Disk full (×12)"]);
    let tell = |text: &str| NoticeCommand::Tell(NoticeLevel::Success, text.to_owned());
    window.apply(tell("stamped.k: no forming results"));
    let shown: Vec<String> = window
        .state
        .log
        .notices
        .toasts()
        .map(Notice::shown)
        .collect();
    assert_eq!(shown, ["stamped.k: no forming results", "Copied"]);
    window.state.tick(Duration::from_secs(5));
    assert_eq!(toasts(&window.state), ["disk full"]);
    assert_eq!(window.state.log.notices.n_unread(), 1);
}

#[test]
fn what_was_said_of_the_content_of_a_file_goes_with_it() {
    let ends: [fn(&mut Window); 2] = [
        |window| window.open("crash.k", Role::Crash),
        |window| window.act(Action::CloseCrash),
    ];
    for end in ends {
        let mut window = Window::new();
        window.open("faulty.k", Role::Crash);
        let is_told = |window: &Window| {
            let told = toasts(&window.state);
            told.iter().any(|text| text.contains("in faulty.k"))
        };
        assert!(is_told(&window));
        end(&mut window);
        assert!(!is_told(&window));
        let mut kept = window.state.log.notices.kept();
        let told = kept.find(|notice| notice.text.contains("in faulty.k"));
        assert!(!told.unwrap().is_unread);
    }
}

#[test]
fn messages_of_what_is_solved_go_and_escape_closes_the_rest() {
    let mut window = Window::new();
    window.open("missing.k", Role::Crash);
    assert_eq!(toasts(&window.state).len(), 1);
    // Another job solves nothing of it.
    window.open("stamped.k", Role::Stamped);
    assert!(toasts(&window.state)[0].contains("missing.k"));
    window.open("crash.k", Role::Crash);
    assert!(
        !toasts(&window.state)
            .iter()
            .any(|text| text.contains("missing.k"))
    );
    let kept = window.state.log.notices.kept();
    assert_eq!(kept.filter(|n| n.text.contains("missing.k")).count(), 1);
    window.apply(NoticeCommand::Tell(NoticeLevel::Warning, "look".into()));
    window.apply(NoticeCommand::Tell(NoticeLevel::Error, "failed".into()));
    let later = window.state.log.now + Duration::from_secs(61);
    window.state.tick(later);
    assert_eq!(toasts(&window.state), ["failed"]);
    window.apply(Command::Escape);
    assert!(toasts(&window.state).is_empty());
    assert!(
        window.state.log.notices.n_unread() > 0,
        "the bell keeps them"
    );
}

#[test]
fn settings_of_an_older_program_still_load() {
    let settings: Settings = serde_json::from_str(r#"{"theme":"Dark","gone":1}"#).unwrap();
    assert_eq!(settings.theme, Theme::Dark);
    assert_eq!(settings.ui_scale, 1.0);
    let wild: Settings = serde_json::from_str(r#"{"ui_scale":99.0}"#).unwrap();
    assert_eq!(wild.sanitized().ui_scale, 2.5);
    let text = serde_json::to_string(&Settings::default()).unwrap();
    let back: Settings = serde_json::from_str(&text).unwrap();
    assert_eq!(back, Settings::default());
}

#[test]
fn a_copied_matrix_pastes_back_to_the_same_bits() {
    for &form in MatrixForm::ALL {
        let mut window = Window::with_both();
        window.apply(MoveCommand::Rotate {
            axis: Axis::Y,
            frame: AxisFrame::Global,
            degrees: 33.3,
        });
        window.apply(ExportCommand::Copy(CopyForm::Matrix(form)));
        let copied = window.effects.iter().find_map(|effect| match effect {
            Effect::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        let before = window.pose();
        window.act(Action::ResetPose);
        window.apply(MoveCommand::Paste(copied.unwrap()));
        let is_same_layout = matches!(form, MatrixForm::Rows | MatrixForm::Columns);
        if is_same_layout {
            assert_eq!(window.pose(), before, "{form:?}");
        } else {
            let expected = match form {
                MatrixForm::Inverse => before.inverse(),
                _ => before,
            };
            let off = window.pose().to_matrix4() - expected.to_matrix4();
            assert!(off.amax() < 1e-12, "{form:?}");
        }
        assert_eq!(
            window.state.settings.matrix_form.as_deref(),
            Some(form.name())
        );
    }
}

#[test]
fn nonsense_that_is_pasted_is_a_message() {
    let mut window = Window::with_both();
    let before = window.state.document.clone();
    window.apply(MoveCommand::Paste("1 2 3".to_owned()));
    assert_eq!(window.state.document, before);
    assert!(
        window
            .state
            .log
            .notices
            .toasts()
            .next()
            .unwrap()
            .text
            .contains("3 numbers")
    );
}

#[test]
fn the_example_loads_from_the_program_itself() {
    let mut window = Window::new();
    for role in Role::ALL {
        let kind = JobKind::Load {
            role,
            source: PartSource::Example,
            settings: LoadSettings::default(),
        };
        let output = PipelineRunner.run(kind, &Monitor::silent()).unwrap();
        let JobOutput::Loaded { part, facts, .. } = output else {
            panic!("not loaded");
        };
        assert!(part.mesh.n_triangles() > 1000);
        assert_eq!(facts.formed > FormingEvidence::None, role == Role::Stamped);
        window.apply(FileCommand::DismissUnitHint);
    }
}

mod random {
    //! Whatever is done: the crash part stays, and undo and redo are exact.

    use super::*;
    use proptest::prelude::*;
    use shapematch::pipeline::match_parts::MatchRecipe;
    use shapematch::units::LengthUnit;

    fn any_move() -> impl Strategy<Value = MoveCommand> {
        let axis = (0usize..3).prop_map(|i| Axis::ALL[i]);
        let frame = (0usize..3).prop_map(|i| AxisFrame::ALL[i]);
        let drag = (0u64..3, -5i32..5).prop_map(|(gesture, x)| MoveCommand::Drag {
            gesture: GestureId(gesture),
            delta: shifted(f64::from(x)),
            name: "Drag".to_owned(),
        });
        prop_oneof![
            drag,
            Just(MoveCommand::EndDrag),
            (0u64..3).prop_map(|g| MoveCommand::AbandonDrag(GestureId(g))),
            (axis.clone(), frame.clone(), -9i32..9).prop_map(|(axis, frame, d)| {
                MoveCommand::Translate {
                    axis,
                    frame,
                    distance: f64::from(d),
                }
            }),
            (axis.clone(), frame, -9i32..9).prop_map(|(axis, frame, d)| MoveCommand::Rotate {
                axis,
                frame,
                degrees: f64::from(10 * d),
            }),
            axis.clone().prop_map(MoveCommand::Flip),
            Just(MoveCommand::AlignCenters),
            Just(MoveCommand::Reset),
            axis.prop_map(|axis| MoveCommand::Input(ModalInput::Axis {
                axis,
                is_plane: false
            })),
            "[-0-9.]".prop_map(|c| {
                MoveCommand::Input(ModalInput::Character(c.chars().next().unwrap()))
            }),
            Just(MoveCommand::Input(ModalInput::Accept)),
            Just(MoveCommand::Input(ModalInput::Reject)),
        ]
    }

    fn any_command() -> impl Strategy<Value = Command> {
        let part = (any::<bool>(), 11u64..13).prop_map(|(is_crash, id)| PartRef {
            role: if is_crash { Role::Crash } else { Role::Stamped },
            id,
        });
        let roles =
            (any::<bool>(), any::<bool>()).prop_map(|(crash, stamped)| PerRole { crash, stamped });
        prop_oneof![
            6 => any_move().prop_map(Command::from),
            1 => (roles, 20usize..200).prop_map(|(roles, max_triangles)| {
                ReduceCommand::To { roles, max_triangles }.into()
            }),
            2 => (part.clone(), any::<bool>())
                .prop_map(|(part, on)| PartCommand::SetVisible(part, on).into()),
            1 => (part.clone(), any::<bool>())
                .prop_map(|(part, on)| PartCommand::SetUsed(part, on).into()),
            1 => part.clone().prop_map(|part| PartCommand::ShowOnly(part).into()),
            1 => part.clone().prop_map(|part| PartCommand::UseOnly(part).into()),
            1 => (part, prop::option::of(any::<[u8; 3]>()))
                .prop_map(|(part, color)| PartCommand::SetColor(part, color).into()),
            1 => any::<bool>().prop_map(|is| PartCommand::UseAll(role(is)).into()),
            1 => Just(PartCommand::ShowAll.into()),
            1 => (any::<bool>(), 0usize..4).prop_map(|(is, n)| {
                let units = [None, Some(LengthUnit::Inch), Some(LengthUnit::Meter)];
                let units = units.get(n).copied().flatten().map(Into::into);
                FileCommand::SetUnits { role: role(is), units }.into()
            }),
            1 => (0usize..3).prop_map(|n| FileCommand::SetLengthFactor {
                role: Role::Stamped,
                factor: [1.0, 25.4, 1000.0][n],
            }.into()),
            1 => Just(FileCommand::Swap.into()),
            1 => any::<bool>().prop_map(|is| FileCommand::Close(role(is)).into()),
            1 => any::<bool>().prop_map(|is| FileCommand::Reload(role(is)).into()),
            1 => any::<bool>().prop_map(|is| FileCommand::Open {
                paths: vec![PathBuf::from(if is { "crash.k" } else { "stamped.k" })],
                role: Some(role(is)),
            }.into()),
            1 => (0.0..2.0f64).prop_map(|allowance| {
                let mut recipe = MatchRecipe::default();
                recipe.settings.allowance = allowance;
                MatchCommand::SetRecipe(Box::new(recipe)).into()
            }),
            1 => Just(MatchCommand::Run.into()),
            1 => (0usize..3).prop_map(|n| {
                MatchCommand::ShowAlternative(n.checked_sub(1)).into()
            }),
            1 => (-50i32..50).prop_map(|x| MoveCommand::SetPose {
                crash_from_stamped: shifted(f64::from(x)),
                name: "Typed".to_owned(),
            }.into()),
            1 => Just(MoveCommand::Paste("1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1".to_owned()).into()),
            1 => (0usize..30).prop_map(|n| HistoryCommand::JumpTo(n.max(2)).into()),
            1 => any::<bool>().prop_map(|is| {
                InspectCommand::Pin(role(is), Point3::new(3.0, 1.0, 0.2)).into()
            }),
            1 => Just(InspectCommand::RemoveAll.into()),
            1 => Just(ViewCommand::ToggleMoveOver.into()),
            1 => Just(HistoryCommand::Undo.into()),
            1 => Just(HistoryCommand::Redo.into()),
            1 => Just(HistoryCommand::ResetAll.into()),
            1 => Just(Command::Escape),
        ]
    }

    fn role(is_crash: bool) -> Role {
        if is_crash { Role::Crash } else { Role::Stamped }
    }

    fn action() -> impl Strategy<Value = Action> {
        prop_oneof![
            Just(Action::MoveTool),
            Just(Action::RotateTool),
            Just(Action::Align),
            Just(Action::NextStart),
            Just(Action::UseStart),
            Just(Action::NextAlternative),
        ]
    }

    fn bits(mesh: &TriMesh) -> Vec<u64> {
        let coordinates = mesh.positions().iter().flat_map(|p| p.iter().copied());
        coordinates.map(f64::to_bits).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

        #[test]
        fn undo_and_redo_are_exact_and_the_crash_part_stays(
            steps in prop::collection::vec(
                prop_oneof![
                    4 => any_command().prop_map(Ok),
                    1 => action().prop_map(Err),
                ],
                1..40,
            )
        ) {
            let mut window = Window::with_both();
            let loaded = window.state.document.clone();
            let before = bits(&window.mesh(Role::Crash));
            for step in steps {
                match step {
                    // The two loads stay, so that there is something to compare.
                    Ok(Command::History(HistoryCommand::Undo))
                        if window.state.history.n_done() <= 2 => {}
                    Ok(command) => window.apply(command),
                    Err(action) => window.act(action),
                }
                // No command but those about the file itself changes a coordinate of the crash part.
                if let Some(part) = window.state.document.part(Role::Crash)
                    && part.loaded.path == Path::new("crash.k")
                    && part.facts.used.len() == 2
                    && part.length_factor() == 1.0
                {
                    prop_assert_eq!(&bits(&part.loaded.mesh), &before);
                }
            }
            window.apply(Command::Escape);
            window.apply(MoveCommand::EndDrag);
            let end = window.state.document.clone();
            let n_done = window.state.history.n_done();
            let mut states = vec![end.clone()];
            for _ in 2..n_done {
                window.act(Action::Undo);
                states.push(window.state.document.clone());
            }
            prop_assert_eq!(&window.state.document, &loaded);
            prop_assert_eq!(&bits(&window.mesh(Role::Crash)), &before);
            for expected in states.iter().rev().skip(1) {
                window.act(Action::Redo);
                prop_assert_eq!(&window.state.document, expected);
            }
            window.apply(HistoryCommand::JumpTo(n_done));
            // Steps that were undone before the end may follow; the end itself is exact.
            prop_assert_eq!(&window.state.document, &end);
        }
    }
}

/// Runs the real worker until nothing runs or waits.
fn settle(state: &mut AppState, worker: &Worker, effects: Vec<Effect>) {
    let carry_out = |effects: Vec<Effect>| {
        for effect in effects {
            match effect {
                Effect::StartJob(kind, stamp) => {
                    worker.submit(*kind, stamp);
                }
                Effect::CancelJob(key) => worker.cancel(key),
                Effect::StopJob(key) => worker.stop(key),
                _ => {}
            }
        }
    };
    carry_out(effects);
    while state.jobs.is_busy() {
        let event = worker.wait_event(Duration::from_secs(300)).unwrap();
        carry_out(state.apply(Command::Live(Box::new(worker.live()))));
        carry_out(state.apply(event));
    }
}

#[test]
fn the_papers_story_with_the_real_worker() {
    let worker = Worker::spawn(PipelineRunner, Arc::new(|| {})).unwrap();
    let mut state = AppState::new(Settings::default());
    let actions = [
        Action::OpenExample,
        Action::Reduce,
        Action::ToggleMoveOver,
        Action::Align,
        Action::MatchOrStop,
    ];
    for action in actions {
        assert_eq!(action.enabled(&state), Ok(()), "{action:?}");
        if let Some(command) = action.command(&state) {
            let effects = state.apply(command);
            settle(&mut state, &worker, effects);
        }
    }
    let rows: Vec<LogStep> = state.log.rows().iter().map(|row| row.step).collect();
    for step in [
        LogStep::Load,
        LogStep::Reduce,
        LogStep::Measure,
        LogStep::Align,
        LogStep::Match,
        LogStep::Settle,
        LogStep::Verify,
        LogStep::Result,
    ] {
        assert!(rows.contains(&step), "{step:?} is not in {rows:?}");
    }
    let truth = shapematch::samples::bundled();
    let truth = truth.iter().find(|file| file.name == "truth.json").unwrap();
    let truth: serde_json::Value = serde_json::from_slice(&truth.bytes).unwrap();
    let rows: [[f64; 4]; 4] = serde_json::from_value(truth["crash_from_stamped"].clone()).unwrap();
    let matrix = shapematch::geometry::Matrix4::from_fn(|row, column| rows[row][column]);
    let truth = Similarity::from_matrix4(&matrix, 1e-9).unwrap();
    let part = state.document.part(Role::Stamped).unwrap();
    let found = state.document.crash_from_stamped();
    let off = found.max_displacement(&truth, part.loaded.mesh.positions());
    assert!(off < 0.5, "the worst node is {off} off");
    assert!(state.document.current_result().is_some());
}

mod modal {
    //! Moves by keys, input by input.

    use super::*;
    use shapematch::geometry::Matrix3;

    fn frame() -> MoveFrame {
        let quarter = rotation_about(&Point3::origin(), &Vector3::z(), 90f64.to_radians());
        MoveFrame::new(Point3::new(1.0, 0.0, 0.0), &quarter, Matrix3::identity())
    }

    /// Types a line: `x`, `y`, `z` bind an axis, `X`, `Y`, `Z` the plane across it.
    fn typed(kind: MotionKind, keys: &str) -> (Similarity, String) {
        let mut tool = ModalMove::new(kind);
        let offset = Vector3::new(3.0, 4.0, 5.0);
        tool.input(ModalInput::Pointer { offset, angle: 0.5 }, &frame());
        for key in keys.chars() {
            let axis = "xyz".find(key.to_ascii_lowercase());
            let input = match axis {
                Some(index) => ModalInput::Axis {
                    axis: Axis::ALL[index],
                    is_plane: key.is_ascii_uppercase(),
                },
                None if key == '<' => ModalInput::Backspace,
                None => ModalInput::Character(key),
            };
            tool.input(input, &frame());
        }
        match tool.input(ModalInput::Accept, &frame()) {
            ModalOutcome::Accepted(motion, name) => (motion, name),
            other => panic!("{keys:?}: {other:?}"),
        }
    }

    fn moved(keys: &str) -> (Vector3, String) {
        let (motion, name) = typed(MotionKind::Move, keys);
        let rounded = motion.translation.map(|x| (x * 1e9).round() / 1e9);
        (rounded, name)
    }

    #[test]
    fn axes_planes_and_values() {
        let check = |keys: &str, at: [f64; 3], name: &str| {
            assert_eq!(
                moved(keys),
                (Vector3::from(at), name.to_owned()),
                "{keys:?}"
            );
        };
        check("", [3.0, 4.0, 5.0], "Move 7.071");
        check("x", [3.0, 0.0, 0.0], "Move 3 along X");
        check("xx", [0.0, 4.0, 0.0], "Move 4 along X (part)");
        check("xxx", [3.0, 4.0, 5.0], "Move 7.071");
        check("Z", [3.0, 4.0, 0.0], "Move 5 across Z");
        check("Z10", [6.0, 8.0, 0.0], "Move 10 across Z");
        check("y-2,5", [0.0, -2.5, 0.0], "Move −2.5 along Y");
        check("y25-<<3-", [0.0, 3.0, 0.0], "Move 3 along Y");
        check("12", [12.0, 0.0, 0.0], "Move 12");
        check("xx2", [0.0, 2.0, 0.0], "Move 2 along X (part)");
    }

    #[test]
    fn rotations_leave_the_pivot() {
        for (keys, name) in [
            ("z90", "Rotate 90° about Z"),
            ("Z90", "Rotate 90° about Z"),
            ("xx-30", "Rotate −30° about X (part)"),
            ("", "Rotate 28.648° about the view axis"),
        ] {
            let (motion, said) = typed(MotionKind::Rotate, keys);
            assert_eq!(said, name);
            let pivot = frame().pivot;
            assert!((motion.apply(&pivot) - pivot).norm() < 1e-12);
        }
        let (motion, _) = typed(MotionKind::Rotate, "z90");
        let end = motion.apply(&Point3::new(2.0, 0.0, 0.0));
        assert!((end - Point3::new(1.0, 1.0, 0.0)).norm() < 1e-12);
    }
}

#[test]
fn several_selected_parts_are_hidden_and_isolated_in_one_step() {
    let mut window = Window::with_both();
    let crash = |id| PartRef {
        role: Role::Crash,
        id,
    };
    let hidden = |window: &Window| -> Vec<u64> {
        let part = window.state.document.part(Role::Crash).unwrap();
        part.hidden.iter().copied().collect()
    };
    window.apply(PartCommand::Select(Some(crash(11))));
    window.apply(PartCommand::ToggleSelected(crash(99)));
    assert_eq!(window.state.parts.selected.len(), 1, "no such part");
    window.apply(PartCommand::ToggleSelected(crash(12)));
    window.act(Action::HideSelected);
    assert_eq!(hidden(&window), [11, 12]);
    assert_eq!(window.state.history.undo_name(), Some("Hide 2 parts"));
    window.apply(HistoryCommand::Undo);
    assert!(hidden(&window).is_empty());
    window.apply(PartCommand::ToggleSelected(crash(11)));
    window.act(Action::IsolateSelected);
    assert_eq!(hidden(&window), [11]);
    assert_eq!(window.state.history.undo_name(), Some("Show only 12 rest"));
    let stamped = window.state.document.part(Role::Stamped).unwrap();
    assert!(stamped.hidden.is_empty(), "nothing of it is selected");
    window.apply(PartCommand::Select(None));
    assert!(Action::HideSelected.enabled(&window.state).is_err());
}

#[test]
fn what_is_selected_goes_with_its_file() {
    let mut window = Window::with_both();
    let select = |window: &mut Window, id| {
        let role = Role::Crash;
        window.apply(PartCommand::Select(Some(PartRef { role, id })));
        assert_eq!(window.state.parts.selected.len(), 1);
    };
    let is_selected = |window: &Window| !window.state.parts.selected.is_empty();
    window.open("car.k", Role::Crash);
    select(&mut window, 22);
    window.apply(FileCommand::Reload(Role::Crash));
    assert!(is_selected(&window), "the same file read again");
    window.apply(FileCommand::Close(Role::Crash));
    assert!(!is_selected(&window));
    assert!(Action::HideSelected.enabled(&window.state).is_err());
    // Another deck has other parts, also where they have the same numbers.
    window.open("crash.k", Role::Crash);
    select(&mut window, 11);
    window.open("panel_crash.k", Role::Crash);
    assert!(!is_selected(&window));
    // A step back leads to a deck without the part.
    window.open("car.k", Role::Crash);
    select(&mut window, 22);
    window.act(Action::Undo);
    assert_eq!(window.part(Role::Crash).loaded.file_name(), "panel_crash.k");
    assert!(!is_selected(&window));
}

#[test]
fn files_that_are_read_again_are_one_step_and_leave_the_cameras() {
    let mut window = Window::with_both();
    for role in Role::ALL {
        window.state.view.cameras.get_mut(role).height *= 3.0;
    }
    let before = window.state.view.cameras;
    let parts = |window: &Window| window.state.document.stamp().parts;
    let (n_done, read_first) = (window.state.history.n_done(), parts(&window));
    window.apply(FileCommand::ReloadAll);
    let again = parts(&window);
    assert!(
        Role::ALL
            .iter()
            .all(|&role| again.get(role) != read_first.get(role))
    );
    assert_eq!(window.state.history.n_done(), n_done + 1);
    assert_eq!(
        window.state.history.undo_name(),
        Some("Load both files again")
    );
    assert_eq!(window.state.view.cameras, before, "where the parts were");
    window.act(Action::Undo);
    assert_eq!(parts(&window), read_first);
    // One alone is a step of its own, and another file is looked at.
    window.apply(FileCommand::Reload(Role::Crash));
    assert_eq!(window.state.history.undo_name(), Some("Load crash.k"));
    window.open("car.k", Role::Crash);
    assert_ne!(window.state.view.cameras.crash, before.crash);
}

#[test]
fn times_of_today_stay_times_of_today_after_midnight() {
    let mut state = AppState::default();
    let half_past_eleven = Duration::from_secs(23 * 3600 + 1800);
    state.log.clock = Clock {
        day_time: half_past_eleven,
        unix: 1_000_000,
    };
    state.tick(Duration::from_secs(3600));
    let now = 1_000_000 + 3600;
    assert_eq!(state.when_text(now - 600), "00:20");
    assert_eq!(state.when_text(now - 3600), "23:30, yesterday");
}

#[test]
fn the_camera_brings_all_selected_parts_into_view() {
    let mut window = Window::with_both();
    let height = |window: &mut Window, ids: &[u64]| {
        window.apply(PartCommand::Select(None));
        for &id in ids {
            let role = Role::Crash;
            window.apply(PartCommand::ToggleSelected(PartRef { role, id }));
        }
        window.apply(ViewCommand::Focus(Role::Crash));
        window.state.view.cameras.crash.height
    };
    let (one, other) = (height(&mut window, &[11]), height(&mut window, &[12]));
    let both = height(&mut window, &[11, 12]);
    assert!(
        both > 1.2 * one && both > 1.2 * other,
        "{one} {other} {both}"
    );
}

#[test]
fn a_view_of_the_whole_part_stays_one_from_every_side() {
    let mut window = Window::with_both();
    let role = Role::Crash;
    window.apply(ViewCommand::FitAll(role));
    let fitted = *window.state.view.cameras.get(role);
    let look = |window: &mut Window, camera| {
        window.apply(ViewCommand::SetCamera(role, camera));
        window.apply(ViewCommand::Standard(role, StandardView::Front));
        window.state.view.is_fitted(role)
    };
    let mut turned = fitted;
    turned.set_standard_view(StandardView::Top);
    assert!(look(&mut window, turned), "turned by hand before");
    let close = shapematch::geometry::Camera {
        height: 0.1 * window.state.view.cameras.get(role).height,
        ..fitted
    };
    assert!(
        !look(&mut window, close),
        "what was brought closer stays so"
    );
}

#[test]
fn the_picture_stays_where_it_is_when_another_map_has_another_legend() {
    let mut window = Window::with_both();
    let role = Role::Crash;
    let room = |aspect: f64, beside: f64, above: f64| {
        let covered = Covered {
            beside: [0.0, beside],
            above,
            ..Covered::default()
        };
        ViewCommand::SetRoom(role, ViewRoom { aspect, covered })
    };
    let seen = |window: &mut Window, room: ViewCommand| {
        window.apply(room);
        assert!(window.state.view.is_fitted(role));
        *window.state.view.cameras.get(role)
    };
    let (none, slim, wide) = ([0.0, 0.0], [0.16, 0.6], [0.4, 0.7]);
    let bare = seen(&mut window, room(1.0, none[0], none[1]));
    let first = seen(&mut window, room(1.0, wide[0], wide[1]));
    assert_ne!(first, bare, "the legend covers nothing of the part");
    for [beside, above] in [slim, wide, slim] {
        assert_eq!(seen(&mut window, room(1.0, beside, above)), first);
    }
    // Without any legend the part has all the room again, as often as one comes and goes.
    for _ in 0..2 {
        assert_eq!(seen(&mut window, room(1.0, none[0], none[1])), bare);
        assert_eq!(seen(&mut window, room(1.0, wide[0], wide[1])), first);
    }
    // From another side too.
    window.apply(ViewCommand::Standard(role, StandardView::Front));
    let front = *window.state.view.cameras.get(role);
    assert_eq!(seen(&mut window, room(1.0, wide[0], wide[1])), front);
    // What is fitted on request, and a window of another shape, fill the room that there is.
    window.apply(room(1.0, none[0], none[1]));
    window.apply(ViewCommand::FitAll(role));
    assert!(window.state.view.cameras.get(role).height < front.height);
    window.apply(room(1.0, wide[0], wide[1]));
    let other_shape = seen(&mut window, room(1.5, slim[0], slim[1]));
    window.apply(ViewCommand::FitAll(role));
    assert_eq!(*window.state.view.cameras.get(role), other_shape);
}

/// The room of a square window beside a legend that covers these shares of its width and height.
pub(crate) fn beside_legend([beside, above]: [f64; 2]) -> ViewRoom {
    let covered = Covered {
        beside: [0.0, beside],
        above,
        ..Covered::default()
    };
    ViewRoom {
        aspect: 1.0,
        covered,
    }
}

#[test]
fn an_earlier_legend_brings_the_earlier_picture() {
    let mut window = Window::with_both();
    let role = Role::Crash;
    let seen = |window: &mut Window, legend: [f64; 2]| {
        window.apply(ViewCommand::SetRoom(role, beside_legend(legend)));
        *window.state.view.cameras.get(role)
    };
    let (slim, wide) = ([0.16, 0.6], [0.4, 0.7]);
    let first = seen(&mut window, slim);
    for _ in 0..2 {
        assert_ne!(seen(&mut window, wide), first);
        assert_eq!(seen(&mut window, slim), first);
    }
}

#[test]
fn after_moving_back_and_without_a_link_each_window_shows_its_own_part() {
    let mut window = Window::with_both();
    window.apply(ViewCommand::FitBoth);
    let own = window.state.view.cameras;
    window.act(Action::ToggleMoveOver);
    // The window of the stamped part is free meanwhile, its camera elsewhere.
    let mut far = own.stamped;
    far.height *= 100.0;
    window.state.view.cameras.stamped = far;
    window.act(Action::ToggleMoveOver);
    assert_eq!(window.state.view.cameras, own);
    // A link that shared the zoom of one of them ends.
    let large = shapematch::geometry::Camera {
        world_from_view: own.crash.world_from_view,
        height: 100.0 * own.stamped.height,
        ..own.stamped
    };
    window.state.view.cameras.stamped = large;
    window.apply(ViewCommand::SetFocus(Role::Stamped));
    window.apply(ViewCommand::ToggleLink);
    assert_eq!(window.state.view.cameras.crash.height, large.height);
    window.apply(ViewCommand::ToggleLink);
    assert_eq!(window.state.view.cameras.crash, own.crash);
    assert_eq!(window.state.view.cameras.stamped, large);
}

#[test]
fn without_any_part_there_is_no_section() {
    let mut window = Window::new();
    window.open("crash.k", Role::Crash);
    window.act(Action::ToggleSection);
    assert_eq!(window.state.view.tab, BottomTab::Section);
    while window.state.history.undo_name().is_some() {
        window.act(Action::Undo);
    }
    assert!(window.state.document.has_any_part().is_err());
    assert!(!window.state.has_content(BottomTab::Section));
    assert_eq!(window.state.view.tab, BottomTab::Log);
}

#[test]
fn a_part_fills_the_room_that_is_free_again() {
    let mut window = Window::with_both();
    let role = Role::Crash;
    let seen = |window: &mut Window, covered: Covered| {
        let aspect = 1.0;
        window.apply(ViewCommand::SetRoom(role, ViewRoom { aspect, covered }));
        *window.state.view.cameras.get(role)
    };
    let none = Covered::default();
    let bare = seen(&mut window, none);
    // A line at the foot, a line more in the header, the cube, a legend at either side.
    let over = [
        Covered {
            bottom: 0.2,
            ..none
        },
        Covered { top: 0.2, ..none },
        Covered {
            corner: [0.4, 0.4],
            ..none
        },
        Covered {
            beside: [0.0, 0.4],
            above: 1.0,
            ..none
        },
        Covered {
            beside: [0.4, 0.0],
            above: 1.0,
            ..none
        },
    ];
    let views = over.map(|covered| {
        let view = seen(&mut window, covered);
        assert_eq!(seen(&mut window, none), bare, "{covered:?}");
        view
    });
    assert!(views[0] != bare && views[1] != bare);
    assert!(views[3].height > bare.height && views[4].height > bare.height);
    // A camera that the user moved stays where it is.
    seen(&mut window, over[3]);
    let mut by_hand = *window.state.view.cameras.get(role);
    by_hand.height *= 0.9;
    window.apply(ViewCommand::SetCamera(role, by_hand));
    assert_eq!(seen(&mut window, none), by_hand);
}

#[test]
fn a_legend_that_comes_up_covers_no_part_that_was_only_turned_by_hand() {
    let role = Role::Crash;
    let room = |beside: f64| {
        let covered = Covered {
            beside: [0.0, beside],
            above: if beside > 0.0 { 0.7 } else { 0.0 },
            ..Covered::default()
        };
        ViewCommand::SetRoom(
            role,
            ViewRoom {
                aspect: 1.0,
                covered,
            },
        )
    };
    let after_legend = |height: f64| {
        let mut window = Window::with_both();
        window.apply(room(0.0));
        let mut by_hand = *window.state.view.cameras.get(role);
        by_hand.set_standard_view(StandardView::Top);
        by_hand.height *= height;
        window.apply(ViewCommand::SetCamera(role, by_hand));
        window.apply(room(0.4));
        (by_hand, *window.state.view.cameras.get(role), window)
    };
    let (by_hand, shown, mut window) = after_legend(1.0);
    assert_eq!(shown.world_from_view, by_hand.world_from_view);
    window.apply(ViewCommand::FitAll(role));
    assert_eq!(shown, *window.state.view.cameras.get(role));
    assert_ne!(shown, by_hand);
    // What was brought closer stays as it is.
    let (close, shown, _) = after_legend(0.2);
    assert_eq!(shown, close);
}

#[test]
fn unused_parts_are_shown_on_request_and_change_nothing_but_the_picture() {
    let mut window = Window::new();
    window.open("car.k", Role::Crash);
    assert!(
        Action::ToggleUnused.enabled(&window.state).is_err(),
        "all are used"
    );
    let part = PartRef {
        role: Role::Crash,
        id: 22,
    };
    window.apply(PartCommand::UseOnly(part));
    let unused: Vec<u64> = window.part(Role::Crash).unused().collect();
    assert_eq!(unused, [21, 23]);
    assert_eq!(Action::ToggleUnused.is_on(&window.state), Some(false));
    let seen = |window: &Window| {
        let n_done = window.state.history.n_done();
        let bounds = window.state.visible_bounds(Role::Crash);
        (window.state.document.clone(), n_done, bounds)
    };
    let before = seen(&window);
    let camera = window.state.view.cameras.crash;
    window.act(Action::ToggleUnused);
    assert_eq!(Action::ToggleUnused.is_on(&window.state), Some(true));
    window.apply(ViewCommand::FitAll(Role::Crash));
    assert!(seen(&window) == before && window.state.view.cameras.crash == camera);
    window.act(Action::ToggleUnused);
    assert_eq!(Action::ToggleUnused.is_on(&window.state), Some(false));
}

#[test]
fn a_step_back_to_a_part_elsewhere_takes_the_camera_there() {
    let folder = tempfile::tempdir().unwrap();
    write_bracket(folder.path(), SampleVariant::Plain);
    let moved = "*KEYWORD\n*DEFINE_TRANSFORMATION\n       900\nTRANSL       30000.0       0.0       0.0\n\
                 *INCLUDE_TRANSFORM\ncrash.k\n\n\n\n       900\n*END\n";
    std::fs::write(folder.path().join("moved.k"), moved).unwrap();
    let mut window = Window::new();
    window.runner = Some(really);
    let is_seen = |window: &Window| {
        let bounds = window.part(Role::Crash).bounds();
        let middle = window.state.view.cameras.crash.target;
        (bounds.center() - middle).norm() < bounds.diagonal()
    };
    for name in ["crash.k", "moved.k"] {
        window.open(folder.path().join(name).to_str().unwrap(), Role::Crash);
        assert!(is_seen(&window), "{name}");
    }
    assert!(window.part(Role::Crash).bounds().center().x > 20_000.0);
    window.act(Action::Undo);
    assert!(window.part(Role::Crash).bounds().center().x < 20_000.0);
    assert!(is_seen(&window));
    window.act(Action::Redo);
    assert!(is_seen(&window));
}

#[test]
fn crash_parts_are_sorted_by_likeness_until_a_part_changes() {
    let mut window = Window::with_both();
    assert!(
        window.state.current_likeness().is_none(),
        "two parts need no order"
    );
    window.apply(PartCommand::OrderLike(Some(LikeWhat::Used(Role::Stamped))));
    let likeness = window.state.current_likeness().unwrap();
    let facts = &window.part(Role::Crash).facts;
    assert_eq!(likeness.order.len(), facts.parts.len());
    let of = |id: &u64| likeness.of_part[id];
    assert!(
        likeness
            .order
            .windows(2)
            .all(|pair| of(&pair[0]) >= of(&pair[1]))
    );
    // Both halves of the crash strip are like each other, more than either is like the whole.
    let half = PartRef {
        role: Role::Crash,
        id: 11,
    };
    window.apply(PartCommand::OrderLike(Some(LikeWhat::Part(half))));
    assert_eq!(
        window.state.current_likeness().unwrap().to.role(),
        Role::Crash
    );
    window.apply(FileCommand::Close(Role::Stamped));
    assert!(window.state.current_likeness().is_none());
}

#[test]
fn escape_ends_the_reduction_of_both_parts() {
    let mut window = Window::with_both();
    let started = window.state.apply(ReduceCommand::To {
        roles: PerRole::both(true),
        max_triangles: 10,
    });
    let jobs: Vec<(JobKey, Stamp)> = started
        .into_iter()
        .filter_map(|effect| match effect {
            Effect::StartJob(kind, stamp) => Some((kind.key(), stamp)),
            _ => None,
        })
        .collect();
    assert_eq!(jobs.len(), 2);
    // The worker has begun with the first.
    let (key, stamp) = jobs[0];
    window.tell(JobId(1), key, stamp, JobStage::Started);
    window.close_toasts();
    let ended: Vec<JobKey> = window
        .state
        .apply(Command::Escape)
        .into_iter()
        .filter_map(|effect| match effect {
            Effect::CancelJob(key) => Some(key),
            _ => None,
        })
        .collect();
    assert_eq!(ended, jobs.iter().map(|(key, _)| *key).collect::<Vec<_>>());
}

#[test]
fn the_stamped_part_is_shown_as_loaded_and_its_pose_stays() {
    let mut window = Window::with_both();
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: shifted(5.0),
        name: "Shift".to_owned(),
    });
    window.apply(PreviewCommand::AsLoaded(true));
    assert_eq!(window.state.shown_pose(), Similarity::identity());
    assert_eq!(window.pose(), shifted(5.0));
    window.apply(Command::Escape);
    assert_eq!(window.state.shown_pose(), shifted(5.0));
}

#[test]
fn the_free_window_has_a_use_of_its_own_and_the_left_camera() {
    let mut window = Window::with_both();
    assert_eq!(window.state.free_window(), None);
    assert_eq!(window.state.view.camera_of(Role::Stamped), Role::Stamped);
    window.apply(ViewCommand::ToggleMoveOver);
    assert_eq!(window.state.free_window(), Some(FreeWindow::FullMesh));
    assert_eq!(window.state.view.camera_of(Role::Stamped), Role::Crash);
    window.apply(ViewCommand::SetFreeWindow(FreeWindow::Alternative));
    assert_eq!(
        window.state.free_window(),
        Some(FreeWindow::FullMesh),
        "there is no other pose without a match"
    );
    window.apply(ViewCommand::SetFreeWindow(FreeWindow::Section));
    assert_eq!(window.state.free_window(), Some(FreeWindow::Section));
    assert!(window.state.inspect.section.shown().is_some());
    window.apply(ViewCommand::SetFreeWindow(FreeWindow::Deviation));
    assert_eq!(window.state.color_by(Role::Stamped), ColorBy::Deviation);
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::Role);
    assert!(window.state.wants_comparison());
    window.apply(ViewCommand::ToggleMoveOver);
    assert_eq!(window.state.color_by(Role::Stamped), ColorBy::Role);
    assert!(!window.state.wants_comparison());
}

#[test]
fn rows_of_a_sweep_are_shown_while_it_runs_and_cancel_brings_the_old_ones_back() {
    use shapematch::pipeline::sweep::{ReductionRow, SweepRow};
    let mut window = Window::with_both();
    window.holds = true;
    window.apply(MatchCommand::Sweep(Box::default()));
    assert_eq!(window.state.view.tab, BottomTab::Sweep);
    let (id, kind, _) = window.held.last().unwrap().clone();
    let JobKind::Sweep(input) = kind else {
        panic!("not a sweep")
    };
    input.rows.push(SweepRow::Reduction(ReductionRow {
        max_triangles: 100,
        triangles: 98,
        time_ms: 1.0,
        rms: 0.1,
        max: 0.2,
        border_max: 0.1,
        loops: 1,
        paper_ms: None,
    }));
    window.apply(Command::Live(Box::new(Live {
        job: Some(id),
        ..Live::default()
    })));
    let shown = window.state.shown_sweep().unwrap();
    assert_eq!(shown.reduction.len(), 1);
    assert_eq!(shown.n_triangles, window.mesh(Role::Stamped).n_triangles());
    window.apply(MatchCommand::Cancel);
    assert!(window.state.shown_sweep().is_none());
}

/// A sweep that was stopped has the rows so far and does not claim more.
#[test]
fn a_stopped_sweep_does_not_say_that_it_finished() {
    let swept = |stops: bool| {
        let mut window = Window::with_both();
        window.holds = true;
        window.apply(MatchCommand::Sweep(Box::default()));
        if stops {
            window.apply(MatchCommand::Stop);
        }
        let (id, kind, stamp) = window.held.remove(0);
        let done = JobOutput::Swept(Arc::default());
        window.tell(id, kind.key(), stamp, JobStage::Finished(done));
        window.state.log.rows().last().unwrap().text.clone()
    };
    assert_eq!(swept(false), "sweep finished");
    assert!(swept(true).starts_with("sweep stopped"), "{}", swept(true));
}

/// A file's stresses stay in its own unit, so each window says that of its own file.
#[test]
fn stresses_are_in_the_unit_of_their_file() {
    let mut window = Window::new();
    window.open("says_mpa.k", Role::Crash);
    window.open("stamped.k", Role::Stamped);
    let unit = |window: &Window, role| {
        let stress = Some(FormingValue::VonMises);
        window.state.document.unit_of(role, stress)
    };
    // What only one file says is taken for both.
    assert_eq!(unit(&window, Role::Stamped), Some("MPa"));
    window.open("says_gpa.k", Role::Stamped);
    assert_eq!(unit(&window, Role::Stamped), Some("GPa"));
    assert_eq!(unit(&window, Role::Crash), Some("MPa"));
}

#[test]
fn a_level_remembers_its_match_until_a_part_changes() {
    let mut window = Window::with_both();
    assert!(window.state.level_result(None).is_none());
    window.apply(MatchCommand::Run);
    let full = *window.state.level_result(None).unwrap();
    assert_eq!(full.crash_from_stamped, shifted(1.0));
    let roles = PerRole {
        crash: true,
        stamped: true,
    };
    window.apply(ReduceCommand::To {
        roles,
        max_triangles: 60,
    });
    assert!(window.state.level_result(Some(60)).is_none());
    window.apply(MatchCommand::Run);
    let reduced = *window.state.level_result(Some(60)).unwrap();
    // Both matches of this window give the same pose.
    assert!(window.state.distance_to_full(&reduced).unwrap() < 1e-12);
    // A file that is read again is full at first, whatever level is wanted of it.
    window.apply(FileCommand::Reload(Role::Stamped));
    let again = window.part(Role::Stamped);
    assert_eq!(
        (again.wanted_level, again.level.is_none()),
        (Some(60), true)
    );
    window.apply(MatchCommand::Run);
    assert!(window.state.level_result(Some(60)).is_none());
    window.open("metres.k", Role::Stamped);
    assert!(window.state.level_result(Some(60)).is_none());
}

#[test]
fn a_muted_level_goes_to_the_bell_without_a_toast() {
    let mut window = Window::new();
    let mut settings = window.state.settings.clone();
    settings.muted.insert(NoticeLevel::Warning);
    window.apply(Command::Settings(Box::new(settings)));
    for level in [NoticeLevel::Warning, NoticeLevel::Error] {
        window.apply(NoticeCommand::Tell(level, "look".to_owned()));
    }
    assert_eq!(window.state.log.notices.toasts().count(), 1);
    assert_eq!(window.state.log.notices.n_unread(), 2);
}

#[test]
fn the_work_is_kept_unless_the_user_does_not_want_it() {
    let mut window = Window::with_both();
    let part = PartRef {
        role: Role::Crash,
        id: 11,
    };
    window.apply(PartCommand::SetVisible(part, false));
    assert!(window.state.needs_autosave());
    let settings = Settings {
        keeps_work: false,
        ..window.state.settings.clone()
    };
    window.apply(Command::Settings(Box::new(settings)));
    assert!(!window.state.needs_autosave());
}

#[test]
fn that_all_parts_are_meant_is_a_step() {
    let mut window = Window::with_both();
    window.apply(PartCommand::UseAll(Role::Crash));
    assert_eq!(
        window.state.history.undo_name(),
        Some("Match all crash parts as one")
    );
    assert!(window.state.document.all_meant_for.is_some());
    window.act(Action::Undo);
    assert_eq!(window.state.document.all_meant_for, None);
    window.act(Action::Redo);
    assert!(window.state.document.all_meant_for.is_some());
}

#[test]
fn the_sections_follow_the_work_and_many_parts_are_chosen_from_first() {
    let mut window = Window::with_both();
    let in_use = |window: &Window| window.state.view.sections.in_use();
    // The crash deck of these tests has two parts: there is something to choose.
    assert_eq!(in_use(&window), Section::Load);
    window.apply(ReduceCommand::Step(1));
    assert_eq!(in_use(&window), Section::Reduce);
    window.apply(MoveCommand::Reset);
    assert_eq!(in_use(&window), Section::Match);
    window.apply(ViewCommand::OpenSection(Section::Load, true));
    assert_eq!(in_use(&window), Section::Load);
    // Of a file that is read again the result is out of date, and the match is what comes next.
    window.act(Action::MatchOrStop);
    window.apply(FileCommand::Reload(Role::Crash));
    assert!(window.state.stale(Section::Match).is_some());
    assert_eq!(in_use(&window), Section::Match);
}
