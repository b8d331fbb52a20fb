//! Questions for files: the desktop's dialog on a thread of its own, and a field to type a path
//! into where the desktop has no dialog.

use super::theme::{Palette, ROW, UNIT};
use super::widgets::{caption, paragraph};
use crate::app::{Command, ExportCommand, ExportKind, FileCommand, ProjectCommand};
use crate::formats::Format;
use crate::jobs::{Located, ProjectRequest, Role};
use crate::pipeline::project::EXTENSION;
use std::future::Future;
use std::path::PathBuf;
use std::pin::pin;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::task::{Context, Poll, Wake, Waker};
use std::time::{Duration, Instant};

/// A dialog that ends sooner was not shown: no one closes a window so fast.
const NOT_SHOWN: Duration = Duration::from_millis(400);

/// What is asked.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Question {
    Open(Role),
    OpenProject,
    /// A file of a project.
    Locate(Role),
    /// Where to write the project, beginning there.
    SaveProject(PathBuf),
    Save(ExportKind),
    Picture {
        is_transparent: bool,
    },
}

struct Answer {
    question: Question,
    path: Option<PathBuf>,
    took: Duration,
}

/// A picture to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PictureRequest {
    /// Where.
    pub path: PathBuf,
    /// Without background.
    pub is_transparent: bool,
}

/// Open questions.
pub struct Dialogs {
    sender: Sender<Answer>,
    receiver: Receiver<Answer>,
    /// A dialog of the desktop is open.
    is_asking: bool,
    /// The field for those desktops that have none.
    prompt: Option<(Question, String)>,
    pictures: Vec<PictureRequest>,
}

impl Default for Dialogs {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Self {
            sender,
            receiver,
            is_asking: false,
            prompt: None,
            pictures: Vec::new(),
        }
    }
}

impl Dialogs {
    /// Asks for a file to read.
    pub fn ask_open(&mut self, role: Role, ctx: &egui::Context) {
        self.ask(Question::Open(role), ctx);
    }

    /// Asks for a project.
    pub fn ask_open_project(&mut self, ctx: &egui::Context) {
        self.ask(Question::OpenProject, ctx);
    }

    /// Asks for a file of a project.
    pub fn ask_locate(&mut self, role: Role, ctx: &egui::Context) {
        self.ask(Question::Locate(role), ctx);
    }

    /// Asks where to write the project.
    pub fn ask_save_project(&mut self, suggested: PathBuf, ctx: &egui::Context) {
        self.ask(Question::SaveProject(suggested), ctx);
    }

    /// Asks where to write.
    pub fn ask_save(&mut self, kind: ExportKind, ctx: &egui::Context) {
        self.ask(Question::Save(kind), ctx);
    }

    /// Asks where to write a picture.
    pub fn ask_picture(&mut self, is_transparent: bool, ctx: &egui::Context) {
        self.ask(Question::Picture { is_transparent }, ctx);
    }

    /// Pictures whose place is known now.
    pub fn take_pictures(&mut self) -> Vec<PictureRequest> {
        std::mem::take(&mut self.pictures)
    }

    fn ask(&mut self, question: Question, ctx: &egui::Context) {
        if self.is_asking {
            return;
        }
        let dialog = file_dialog(&question);
        let asked = question.clone();
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        let thread = std::thread::Builder::new().name("file dialog".to_owned());
        let spawned = thread.spawn(move || {
            let begin = Instant::now();
            let path = wait_for(dialog);
            let took = begin.elapsed();
            let answer = Answer {
                question: asked,
                path,
                took,
            };
            // The window may have closed meanwhile.
            let _ = sender.send(answer);
            ctx.request_repaint();
        });
        match spawned {
            Ok(_) => self.is_asking = true,
            Err(_) => self.prompt = Some((question, String::new())),
        }
    }

    /// The answers that came since the last frame.
    pub fn answers(&mut self) -> Vec<Command> {
        let answers: Vec<Answer> = self.receiver.try_iter().collect();
        let mut commands = Vec::new();
        for answer in answers {
            self.is_asking = false;
            match answer.path {
                Some(path) => commands.extend(self.answered(answer.question, path)),
                None if answer.took < NOT_SHOWN => {
                    let suggestion = match &answer.question {
                        Question::Open(_) | Question::OpenProject | Question::Locate(_) => {
                            String::new()
                        }
                        Question::SaveProject(path) => path.display().to_string(),
                        Question::Save(kind) => kind.suggested_name().to_owned(),
                        Question::Picture { .. } => "shapematch.png".to_owned(),
                    };
                    self.prompt = Some((answer.question, suggestion));
                }
                None => commands.extend(closed(&answer.question)),
            }
        }
        commands
    }

    fn answered(&mut self, question: Question, path: PathBuf) -> Option<Command> {
        match question {
            Question::Open(role) => Some(
                FileCommand::Open {
                    paths: vec![path],
                    role: Some(role),
                }
                .into(),
            ),
            Question::OpenProject => {
                let request = ProjectRequest {
                    path,
                    ..ProjectRequest::default()
                };
                Some(ProjectCommand::Open(request).into())
            }
            Question::Locate(role) => Some(ProjectCommand::Locate(role, Located::At(path)).into()),
            Question::SaveProject(_) => Some(ProjectCommand::Write(path).into()),
            Question::Save(kind) => Some(ExportCommand::Write { kind, path }.into()),
            Question::Picture { is_transparent } => {
                self.pictures.push(PictureRequest {
                    path,
                    is_transparent,
                });
                None
            }
        }
    }

    /// The field to type a path into.
    pub fn show(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) {
        let Some((question, mut text)) = self.prompt.take() else {
            return;
        };
        let (title, verb) = titles(&question);
        let mut is_taken = false;
        let mut is_closed = false;
        let modal = egui::Modal::new(egui::Id::unique("path prompt")).show(ctx, |ui| {
            ui.set_width(480.0);
            ui.spacing_mut().item_spacing.y = UNIT;
            ui.heading(title);
            paragraph(
                ui,
                "This desktop offers no file dialog. Type or paste the path, \
                 or drop the file on the window.",
            );
            let field = egui::TextEdit::singleline(&mut text)
                .hint_text("/folder/file.k")
                .desired_width(f32::INFINITY)
                .margin(egui::Margin::symmetric(8, 4));
            let field = ui.add(field).accessible_name("Path of the file");
            if !field.has_focus() && !field.lost_focus() {
                field.request_focus();
            }
            is_taken |= field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
            ui.horizontal(|ui| {
                let palette = Palette::of(ui);
                let label = egui::RichText::new(verb).color(palette.on_accent);
                let button = egui::Button::new(label)
                    .fill(palette.accent)
                    .min_size(egui::vec2(88.0, ROW + 4.0));
                is_taken |= ui.add_enabled(!text.trim().is_empty(), button).clicked();
                let cancel = egui::Button::new("Cancel").min_size(egui::vec2(88.0, ROW + 4.0));
                is_closed |= ui.add(cancel).clicked();
                if matches!(question, Question::Open(_) | Question::Locate(_)) {
                    caption(ui, formats());
                }
            });
        });
        let path = text.trim().trim_matches('"').to_owned();
        if is_taken && !path.is_empty() {
            commands.extend(self.answered(question, PathBuf::from(path)));
        } else if !is_closed && !modal.should_close() {
            self.prompt = Some((question, text));
        } else {
            commands.extend(closed(&question));
        }
    }
}

/// What follows from a dialog that was closed without an answer.
fn closed(question: &Question) -> Option<Command> {
    let is_save = matches!(question, Question::SaveProject(_));
    is_save.then(|| ProjectCommand::NotWritten.into())
}

fn titles(question: &Question) -> (&'static str, &'static str) {
    match question {
        Question::OpenProject => ("Open a project", "Open"),
        Question::Locate(Role::Crash) => ("Find the crash model of the project", "Use"),
        Question::Locate(Role::Stamped) => ("Find the stamped part of the project", "Use"),
        Question::SaveProject(_) => ("Save the project", "Save"),
        Question::Open(Role::Crash) => ("Open the crash model", "Open"),
        Question::Open(Role::Stamped) => ("Open the stamped part", "Open"),
        Question::Save(_) => ("Write to a file", "Write"),
        Question::Picture { .. } => ("Write a picture", "Write"),
    }
}

fn formats() -> String {
    let labels: Vec<&str> = Format::ALL.iter().map(|f| f.label()).collect();
    labels.join(", ")
}

fn file_dialog(
    question: &Question,
) -> impl Future<Output = Option<rfd::FileHandle>> + Send + use<> {
    let (title, _) = titles(question);
    let mut dialog = rfd::AsyncFileDialog::new().set_title(title);
    match question {
        Question::OpenProject => dialog = dialog.add_filter("Project", &[EXTENSION]),
        Question::SaveProject(path) => {
            dialog = dialog.add_filter("Project", &[EXTENSION]);
            if let Some(name) = path.file_name() {
                dialog = dialog.set_file_name(name.to_string_lossy());
            }
            if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
                dialog = dialog.set_directory(folder);
            }
        }
        Question::Open(_) | Question::Locate(_) => {
            let all: Vec<&str> = Format::ALL
                .iter()
                .flat_map(|f| f.extensions())
                .copied()
                .collect();
            dialog = dialog.add_filter("All formats", &all);
            for format in Format::ALL {
                dialog = dialog.add_filter(format.label(), format.extensions());
            }
            dialog = dialog.add_filter("All files", &["*"]);
        }
        Question::Save(kind) => dialog = dialog.set_file_name(kind.suggested_name()),
        Question::Picture { .. } => dialog = dialog.set_file_name("shapematch.png"),
    }
    let is_open = matches!(
        question,
        Question::Open(_) | Question::OpenProject | Question::Locate(_)
    );
    async move {
        if is_open {
            dialog.pick_file().await
        } else {
            dialog.save_file().await
        }
    }
}

struct Unpark(std::thread::Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Waits on this thread, which has nothing else to do.
fn wait_for(future: impl Future<Output = Option<rfd::FileHandle>>) -> Option<PathBuf> {
    let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
    let mut context = Context::from_waker(&waker);
    let mut future = pin!(future);
    loop {
        match future.as_mut().poll(&mut context) {
            Poll::Ready(handle) => return handle.map(|handle| handle.path().to_owned()),
            Poll::Pending => std::thread::park(),
        }
    }
}
