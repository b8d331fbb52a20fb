//! The program behind the panels: worker, dialogs, clipboard, preferences, and the frame.

use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::background::Behind;
use super::dialogs::Dialogs;
use super::keyboard::Keyboard;
use super::no_window::explained;
use super::panels::drop::DropTarget;
use super::pictures::{Pictures, Wanted};
use super::preferences::{Preferences, UserFiles, WindowPlace};
use super::viewport::Viewports;
use super::{focus, overlays, panels, system_fonts, theme, toasts};
use crate::app::{
    AppState, Clock, Command, Effect, FileCommand, Kept, NoticeCommand, NoticeLevel, PictureChoice,
    PictureSize, ProjectCommand, Settings, StartupOptions, Theme,
};
use crate::jobs::{JobEvent, JobStage, Live, PipelineRunner, Worker};
use crate::pipeline::autosave::{Autosave, AutosaveEvent};
use crate::pipeline::file_watch::{FileWatch, PAUSE};
use crate::pipeline::preferences::PreferencesFile;
use crate::report::picture::Picture;
use crate::role::Role;

/// Least size of the window, in points.
const MIN_SIZE: [f32; 2] = [800.0, 540.0];
/// Size at the first start.
const FIRST_SIZE: [f32; 2] = [1400.0, 900.0];

/// Opens the window and returns when it is closed.
///
/// Fails, before anything is drawn, if there is no display or no graphics adapter.
pub fn run(options: StartupOptions) -> anyhow::Result<ExitCode> {
    let mut files = if options.forget_settings {
        UserFiles::none()
    } else {
        UserFiles::of_user()
    };
    let preferences: Preferences = files.preferences.read();
    let native = eframe::NativeOptions {
        viewport: window(&preferences),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: graphics(),
        ..eframe::NativeOptions::default()
    };
    let make: eframe::AppCreator<'_> = Box::new(move |cc| {
        let shell = Shell::new(cc, options, files, preferences)?;
        Ok(Box::new(shell))
    });
    eframe::run_native("shapematch", native, make).map_err(|error| explained(&error))?;
    Ok(ExitCode::SUCCESS)
}

/// Buffers as large as the adapter has them: 4.5 million triangles do not fit into the usual 256 MiB.
fn graphics() -> eframe::egui_wgpu::WgpuConfiguration {
    let mut options = eframe::egui_wgpu::WgpuConfiguration::default();
    if let eframe::egui_wgpu::WgpuSetup::CreateNew(setup) = &mut options.wgpu_setup {
        let usual = Arc::clone(&setup.device_descriptor);
        setup.device_descriptor = Arc::new(move |adapter| {
            let mut device = usual(adapter);
            device.required_limits.max_buffer_size = adapter.limits().max_buffer_size;
            device
        });
    }
    options
}

fn window(preferences: &Preferences) -> egui::ViewportBuilder {
    let window = egui::ViewportBuilder::default()
        .with_title("shapematch")
        .with_app_id("shapematch")
        .with_min_inner_size(MIN_SIZE);
    let Some(place) = preferences.window else {
        return window.with_inner_size(FIRST_SIZE);
    };
    let size = place.size.map(|s| {
        if s.is_finite() {
            s.clamp(400.0, 16_384.0)
        } else {
            900.0
        }
    });
    let window = window
        .with_inner_size(size)
        .with_maximized(place.is_maximized);
    match place.corner {
        Some(corner) if corner.iter().all(|c| c.is_finite()) => window.with_position(corner),
        _ => window,
    }
}

/// How long a drop waits for the pointer to come back.
const POINTER_BACK: Duration = Duration::from_millis(400);

/// Files that were dropped, and when.
struct PendingDrop {
    paths: Vec<std::path::PathBuf>,
    since: Instant,
}

/// The application as eframe sees it.
pub struct Shell {
    state: AppState,
    worker: Worker,
    viewports: Viewports,
    dialogs: Dialogs,
    preferences: PreferencesFile,
    autosave: Autosave<Box<Kept>>,
    watch: FileWatch,
    /// The parts whose files are watched.
    watched: Vec<u64>,
    /// Files that were dropped before it was known where.
    drop: Option<PendingDrop>,
    place: Option<WindowPlace>,
    is_unsaved: bool,
    /// The user was told that they cannot be saved; once is enough.
    has_told_unsaved: bool,
    /// The question about unsaved work was answered.
    may_close: bool,
    begin: Instant,
    title: String,
    pictures: Pictures,
    keyboard: Keyboard,
    /// A dialog lay over the window in the frame before.
    was_covered: bool,
    /// Where the pointer rests that is away for a frame.
    resting: Option<egui::Pos2>,
    /// A picture of the frame before was not exact.
    is_unfinished: bool,
    /// What was told last, see [`Shell::update_rest`].
    is_at_rest: bool,
}

impl Shell {
    /// Starts the worker and opens what the command line named.
    pub fn new(
        cc: &eframe::CreationContext<'_>,
        options: StartupOptions,
        files: UserFiles,
        preferences: Preferences,
    ) -> std::io::Result<Self> {
        theme::install(&cc.egui_ctx);
        system_fonts::add(&cc.egui_ctx);
        let ctx = cc.egui_ctx.clone();
        let waking = ctx.clone();
        let autosave = Autosave::start(files.sessions, move || waking.request_repaint())?;
        let waking = cc.egui_ctx.clone();
        let watch = FileWatch::start(PAUSE, move || waking.request_repaint())?;
        let viewports = Viewports::new(cc.wgpu_render_state.as_ref());
        let pause = viewports.progress_pause();
        let worker = Worker::spawn(
            Behind::new(PipelineRunner),
            Arc::new(move || ctx.request_repaint_after(pause)),
        )?;
        let mut state = AppState::new(preferences.settings);
        state.log.clock = clock();
        let mut shell = Self {
            state,
            worker,
            viewports,
            dialogs: Dialogs::default(),
            preferences: files.preferences,
            autosave,
            watch,
            watched: Vec::new(),
            drop: None,
            place: preferences.window,
            is_unsaved: false,
            has_told_unsaved: false,
            may_close: false,
            begin: Instant::now(),
            title: String::new(),
            pictures: Pictures::default(),
            keyboard: Keyboard::default(),
            was_covered: false,
            resting: None,
            is_unfinished: false,
            is_at_rest: false,
        };
        shell.apply_settings(&cc.egui_ctx);
        shell.autosave.list();
        shell.open_at_start(options, &cc.egui_ctx);
        Ok(shell)
    }

    /// What the window knows.
    pub fn state(&self) -> &AppState {
        &self.state
    }

    /// True while the worker has nothing to do.
    pub fn is_idle(&self) -> bool {
        self.worker.is_idle()
    }

    /// At rest no work runs or waits and what the 3D windows show is exact. Changes are told in the program's log at
    /// the level `debug`, for scripts that take pictures.
    fn update_rest(&mut self) {
        let is_waiting = self.is_unfinished || self.viewports.is_waiting();
        let is_at_rest = !is_waiting && self.is_idle() && !self.state.jobs.is_busy();
        if std::mem::replace(&mut self.is_at_rest, is_at_rest) != is_at_rest {
            log::debug!("{}", if is_at_rest { "at rest" } else { "at work" });
        }
    }

    /// A picture of what the 3D windows show, in their size and without what lies over them. `None`
    /// without a graphics adapter and while anything in it is still being made.
    pub fn picture(&mut self) -> Option<Picture> {
        let choice = PictureChoice {
            size: PictureSize::Window(1),
            ..PictureChoice::default()
        };
        if self.viewports.is_waiting() {
            return None;
        }
        self.viewports.picture(&self.state, &choice)
    }

    /// Applies commands as if they came from a panel.
    pub fn run_commands(&mut self, commands: Vec<Command>, ctx: &egui::Context) {
        for command in commands {
            let effects = self.state.apply(command);
            for effect in effects {
                self.carry_out(effect, ctx);
            }
        }
    }

    /// Applies the keys of the frame, one after the other.
    fn press_keys(&mut self, ctx: &egui::Context) {
        while let Some(command) = self.keyboard.next(ctx, &self.state) {
            self.run_commands(vec![command], ctx);
            if self.dialogs.is_open() {
                self.keyboard.give_up();
            }
            ctx.request_repaint();
        }
    }

    fn open_at_start(&mut self, options: StartupOptions, ctx: &egui::Context) {
        let mut commands: Vec<Command> = Vec::new();
        match (options.crash, options.stamped) {
            (Some(crash), Some(stamped)) => {
                for (path, role) in [(crash, Role::Crash), (stamped, Role::Stamped)] {
                    let (paths, role) = (vec![path], Some(role));
                    commands.push(FileCommand::Open { paths, role }.into());
                }
            }
            (Some(path), None) | (None, Some(path)) => {
                let (paths, role) = (vec![path], None);
                commands.push(FileCommand::Open { paths, role }.into());
            }
            (None, None) if options.example => commands.push(FileCommand::OpenExample.into()),
            (None, None) if options.realistic => {
                commands.push(FileCommand::OpenRealisticExample.into());
            }
            (None, None) => {}
        }
        self.run_commands(commands, ctx);
    }

    fn carry_out(&mut self, effect: Effect, ctx: &egui::Context) {
        match effect {
            Effect::StartJob(kind, stamp) => {
                self.worker.submit(*kind, stamp);
            }
            Effect::StopJob(key) => self.worker.stop(key),
            Effect::CancelJob(key) => self.worker.cancel(key),
            Effect::AskOpen(role) => self.dialogs.ask_open(role, ctx),
            Effect::AskSave { kind, path, inputs } => {
                self.dialogs.ask_save(kind, path, inputs, ctx);
            }
            Effect::AskOpenProject => self.dialogs.ask_open_project(ctx),
            Effect::AskLocate(file) => self.dialogs.ask_locate(file, ctx),
            Effect::AskFurther => self.dialogs.ask_further(ctx),
            Effect::AskOtherMapping => self.dialogs.ask_other_mapping(ctx),
            Effect::AskSaveProject(path) => self.dialogs.ask_save_project(path, ctx),
            Effect::WriteProject {
                path,
                replaces,
                project,
                kept,
            } => self.autosave.save(path, replaces, project, kept),
            Effect::Autosave(project) => self.autosave.autosave(project),
            Effect::DismissRecovery => self.autosave.dismiss_recovery(),
            Effect::AskPicture { choice, path } => self.dialogs.ask_picture(choice, path, ctx),
            Effect::TakePicture {
                choice,
                place,
                texts,
            } => {
                let inputs = self.state.document.files();
                let overlays = Some(choice.has_overlays(&self.state));
                let choice = PictureChoice { overlays, ..choice };
                self.pictures.want(
                    Wanted {
                        choice,
                        place,
                        texts,
                        inputs,
                    },
                    ctx,
                );
            }
            Effect::CopyText(text) => ctx.copy_text(text),
            Effect::SaveSettings => {
                self.is_unsaved = true;
                self.apply_settings(ctx);
            }
            Effect::NotifyDesktop => {
                let ask = egui::UserAttentionType::Informational;
                ctx.send_viewport_cmd(egui::ViewportCommand::RequestUserAttention(ask));
            }
            Effect::Quit => {
                self.may_close = true;
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
        }
    }

    fn apply_settings(&self, ctx: &egui::Context) {
        let Settings {
            theme,
            ui_scale,
            reduce_motion,
            ..
        } = self.state.settings;
        theme::set_motion(ctx, !reduce_motion);
        ctx.set_theme(match theme {
            Theme::System => egui::ThemePreference::System,
            Theme::Dark => egui::ThemePreference::Dark,
            Theme::Light => egui::ThemePreference::Light,
        });
        if (ctx.zoom_factor() - ui_scale).abs() > 1e-4 {
            ctx.set_zoom_factor(ui_scale);
        }
    }

    /// Writes the preferences where they changed; what is told if they cannot be.
    fn save(&mut self) -> Option<Command> {
        if !std::mem::take(&mut self.is_unsaved) {
            return None;
        }
        let preferences = Preferences {
            settings: self.state.settings.clone(),
            window: self.place,
        };
        let error = self.preferences.write(&preferences).err()?;
        if std::mem::replace(&mut self.has_told_unsaved, true) {
            return None;
        }
        let text = format!("Preferences cannot be saved: {error}");
        Some(NoticeCommand::Tell(NoticeLevel::Warning, text).into())
    }

    /// Draws the pictures that are wanted; what became of earlier ones.
    fn take_pictures(&mut self, ctx: &egui::Context) -> Vec<Command> {
        let news = self.pictures.take(&self.state, &mut self.viewports, ctx);
        let tell = |(level, text)| NoticeCommand::Tell(level, text).into();
        news.into_iter().map(tell).collect()
    }

    /// Files that were dropped. One over a 3D window is meant for it; where that was is told by the pointer,
    /// which some desktops give back only after the drop.
    fn dropped(&mut self, ctx: &egui::Context) -> Vec<Command> {
        let files = ctx.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<_> = files
            .iter()
            .map(|file| file.path().to_owned())
            .filter(|path| !path.as_os_str().is_empty())
            .collect();
        if let [path] = paths.as_slice()
            && self.dialogs.take_dropped(path, ctx)
        {
            return Vec::new();
        }
        if !paths.is_empty() {
            self.drop = Some(PendingDrop {
                paths,
                since: Instant::now(),
            });
        }
        let Some(drop) = self.drop.take() else {
            return Vec::new();
        };
        let is_placed = drop.paths.len() > 1 || ctx.pointer_latest_pos().is_some();
        if !is_placed && drop.since.elapsed() < POINTER_BACK {
            ctx.request_repaint_after(POINTER_BACK / 4);
            self.drop = Some(drop);
            return Vec::new();
        }
        let target = DropTarget::under_pointer(ctx, &self.state, &drop.paths);
        target.commands(drop.paths)
    }

    /// Keeps an eye on the files of the present parts; what was noticed about them.
    fn changed_files(&mut self) -> Option<Command> {
        let document = &self.state.document;
        let parts = document.revisions();
        if parts != self.watched {
            self.watched = parts;
            self.watch.watch(document.files_read());
        }
        let changed = self.watch.news()?;
        Some(FileCommand::ChangedOnDisk(changed).into())
    }

    fn remember_place(&mut self, ctx: &egui::Context) {
        let (inner, outer, is_maximized) = ctx.input(|input| {
            let window = input.viewport();
            (window.inner_rect, window.outer_rect, window.maximized)
        });
        let Some(inner) = inner else { return };
        let is_maximized = is_maximized.unwrap_or(false);
        let zoom = ctx.zoom_factor();
        let place = WindowPlace {
            size: [inner.width() * zoom, inner.height() * zoom],
            corner: outer.map(|rect| [rect.left() * zoom, rect.top() * zoom]),
            is_maximized,
        };
        // The size before it was maximized is worth more than the screen's.
        self.place = match self.place {
            Some(old) if is_maximized => Some(WindowPlace {
                is_maximized,
                ..old
            }),
            _ => Some(place),
        };
    }

    /// The desktop wants the window closed: asks first if work would be lost.
    fn asked_to_close(&self, ctx: &egui::Context) -> Option<Command> {
        let is_asked = ctx.input(|input| input.viewport().close_requested());
        if !is_asked || self.may_close || !self.state.would_lose_work() {
            return None;
        }
        ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
        Some(Command::Quit)
    }

    fn update_title(&mut self, ctx: &egui::Context) {
        let mark = if self.state.is_unsaved() { "● " } else { "" };
        let name = self.state.project_name();
        let title = match name.or_else(|| self.state.document.title()) {
            Some(name) => format!("{mark}{name} – shapematch"),
            None => "shapematch".to_owned(),
        };
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}

/// The events with what was told live right after the job's beginning, or before all of them if it began
/// earlier.
fn with_live(events: Vec<JobEvent>, live: Live) -> Vec<Command> {
    let begins =
        |event: &JobEvent| matches!(event.stage, JobStage::Started) && Some(event.id) == live.job;
    let place = events.iter().position(begins).map_or(0, |at| at + 1);
    let mut commands: Vec<Command> = events.into_iter().map(Command::from).collect();
    if live.job.is_some() {
        commands.insert(place, Command::Live(Box::new(live)));
    }
    commands
}

/// The local time of day and the date.
fn clock() -> Clock {
    let now = jiff::Zoned::now();
    let time = now.time();
    let seconds = |n: i8, factor: u64| u64::from(n.unsigned_abs()) * factor;
    let whole = seconds(time.hour(), 3600) + seconds(time.minute(), 60) + seconds(time.second(), 1);
    Clock {
        day_time: Duration::from_secs(whole),
        unix: now.timestamp().as_second().unsigned_abs(),
    }
}

impl eframe::App for Shell {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        focus::follow(ctx);
        self.is_unfinished = self.viewports.take_unfinished();
        self.state.tick(self.begin.elapsed());
        // Read in this order and applied in the other, no news of a job that ended is lost.
        let events: Vec<JobEvent> = self.worker.events().collect();
        let live = self.worker.live();
        let mut commands = with_live(events, live);
        commands.extend(self.dialogs.answers(ctx));
        commands.extend(self.autosave.events().flat_map(from_autosave));
        commands.extend(self.asked_to_close(ctx));
        commands.extend(self.dropped(ctx));
        commands.extend(self.changed_files());
        self.run_commands(commands, ctx);
        if self.state.needs_autosave() {
            self.run_commands(vec![ProjectCommand::Autosave.into()], ctx);
        }
        let mut told = self.take_pictures(ctx);
        self.update_title(ctx);
        self.remember_place(ctx);
        told.extend(self.save());
        self.run_commands(told, ctx);
    }

    /// A tooltip stays while the pointer rests on its widget, also over a dialog that a key opened: for one frame
    /// the pointer is away then.
    fn raw_input_hook(&mut self, ctx: &egui::Context, raw_input: &mut egui::RawInput) {
        if let Some(place) = self.resting.take() {
            raw_input.events.insert(0, egui::Event::PointerMoved(place));
        }
        let is_covered = self.state.view.dialog.is_some() || self.dialogs.is_open();
        let was_covered = std::mem::replace(&mut self.was_covered, is_covered);
        let is_new = is_covered && !was_covered;
        let pointer = ctx.input(|input| input.pointer.clone());
        if is_new && !pointer.any_down() {
            let moved = raw_input.events.iter().rev().find_map(|event| match event {
                egui::Event::PointerMoved(place) => Some(*place),
                _ => None,
            });
            self.resting = moved.or(pointer.hover_pos());
            raw_input.events.push(egui::Event::PointerGone);
            ctx.request_repaint();
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let has_question = self.dialogs.is_open();
        self.keyboard.begin(&ctx, &self.state, has_question);
        let mut commands = Vec::new();
        panels::window_ui(ui, &self.state, &mut self.viewports, &mut commands);
        toasts::toasts_ui(&ctx, &self.state, &mut commands);
        let is_on_processor = self.viewports.is_on_processor();
        overlays::overlays_ui(&ctx, &self.state, is_on_processor, &mut commands);
        self.dialogs.show(&ctx, is_on_processor, &mut commands);
        self.keyboard.collect(&ctx);
        if !commands.is_empty() {
            self.run_commands(commands, &ctx);
            ctx.request_repaint();
        }
        self.keyboard.uncover(&self.state, self.dialogs.is_open());
        self.press_keys(&ctx);
        self.update_rest();
        if let Some(expiry) = self.state.log.notices.next_expiry() {
            ctx.request_repaint_after(expiry.saturating_sub(self.state.log.now));
        }
    }

    fn on_exit(&mut self) {
        self.is_unsaved = true;
        // Nobody is left to be told.
        let _ = self.save();
        self.worker.cancel_all();
    }
}

/// What follows from what was saved.
fn from_autosave(event: AutosaveEvent<Box<Kept>>) -> Vec<Command> {
    match event {
        AutosaveEvent::Saved(path, saved_at, kept) => {
            vec![ProjectCommand::Written(path, saved_at, kept).into()]
        }
        AutosaveEvent::SaveFailed(reason) => {
            let is_elsewhere = false;
            vec![
                ProjectCommand::SaveFailed {
                    reason,
                    is_elsewhere,
                }
                .into(),
            ]
        }
        AutosaveEvent::SavedElsewhere(reason) => {
            let is_elsewhere = true;
            vec![
                ProjectCommand::SaveFailed {
                    reason,
                    is_elsewhere,
                }
                .into(),
            ]
        }
        AutosaveEvent::AutosaveFailed(reason) => {
            let text = format!("Autosave is off: {reason}");
            vec![NoticeCommand::Tell(NoticeLevel::Warning, text).into()]
        }
        AutosaveEvent::Sessions(sessions) => {
            vec![ProjectCommand::NotifyRecovered(sessions).into()]
        }
    }
}
