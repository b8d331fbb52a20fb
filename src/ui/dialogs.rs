//! Questions for files: the desktop's dialog on a thread of its own, and a field to type a path
//! into where the desktop has no dialog.

mod desktop;
mod question;

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use self::desktop::file_dialog;
use self::question::{Question, titles};
use super::background::run_once;
use super::overlays::modal;
use super::path_prompt::{self, Caret, Completion, plain_words};
use super::theme::{Palette, UNIT};
use super::widgets::{caption, large_button, paragraph};
use crate::app::{Command, ExportCommand, FileCommand, MapCommand, PictureChoice, ProjectCommand};
use crate::formats::Format;
use crate::jobs::{Located, ProjectFile, ProjectRequest};
use crate::pipeline::names::file_name;
use crate::pipeline::outputs::Output;
use crate::role::Role;

/// A dialog that ends sooner was not shown: no one closes a window so fast.
const NOT_SHOWN: Duration = Duration::from_millis(400);

/// What a thread found out.
enum Answer {
    /// The dialog of the desktop was closed.
    Dialog {
        question: Question,
        path: Option<PathBuf>,
        took: Duration,
    },
    /// What a typed path leads to.
    Checked {
        question: Question,
        path: PathBuf,
        found: Found,
    },
    /// How a typed path may go on.
    Completed {
        typed: String,
        completion: Completion,
    },
}

/// What is there at a path.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Found {
    /// Nothing, in a folder that exists; or the file that is to be read.
    Free,
    /// A file that would be replaced: this one, or the one that is written beside it.
    Taken(PathBuf),
    /// One of the files that are read.
    InUse(PathBuf),
    /// Nothing that could be read.
    NoFile,
    /// The folder is missing.
    NoFolder(PathBuf),
    /// A folder stands there instead of a file to read.
    IsFolder,
    /// A folder that is missing could not be made, and why.
    NotMade(String),
}

impl Found {
    /// Looks at a path, and makes its folder first if that is wanted.
    fn at(path: &Path, question: &Question, makes_folder: bool) -> Self {
        if question.is_open() {
            return if path.is_dir() {
                Self::IsFolder
            } else if path.exists() {
                Self::Free
            } else {
                Self::NoFile
            };
        }
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            if !makes_folder {
                return Self::NoFolder(folder.to_owned());
            }
            if let Err(error) = std::fs::create_dir_all(folder) {
                return Self::NotMade(plain_words(&error));
            }
        }
        let mut files = [Some(path.to_owned()), question.file_beside(path)];
        let in_use = files.iter().flatten();
        if let Some(file) = in_use.into_iter().find(|file| question.reads(file)) {
            return Self::InUse(file.clone());
        }
        let taken = files.iter_mut().flatten().find(|file| file.exists());
        taken.map_or(Self::Free, |file| Self::Taken(std::mem::take(file)))
    }
}

/// The field for those desktops that have no dialog.
#[derive(Debug, Clone)]
struct Prompt {
    question: Question,
    text: String,
    caret: Caret,
    /// What is wrong with the path.
    note: Option<String>,
    /// The folder that would have to be made.
    missing: Option<PathBuf>,
    /// Names that begin as the typed one.
    names: Vec<String>,
}

impl Prompt {
    fn new(question: Question, text: String) -> Self {
        Self {
            question,
            text,
            caret: Caret::OverAll,
            note: None,
            missing: None,
            names: Vec::new(),
        }
    }

    fn with_note(question: Question, path: &Path, note: String) -> Self {
        Self {
            caret: Caret::Kept,
            note: Some(note),
            ..Self::new(question, path.display().to_string())
        }
    }
}

/// Questions that wait for an answer.
pub struct Dialogs {
    sender: Sender<Answer>,
    receiver: Receiver<Answer>,
    /// A dialog of the desktop is open.
    is_asking: bool,
    /// The field for those desktops that have none.
    prompt: Option<Prompt>,
    /// What was typed into it last for a file to read; the next one begins with it.
    typed: Option<String>,
    /// Where a file would be overwritten, and which.
    overwrite: Option<(Question, PathBuf, PathBuf)>,
    /// What follows from questions that were not asked, because another one is open.
    refused: Vec<Command>,
}

impl Default for Dialogs {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Self {
            sender,
            receiver,
            is_asking: false,
            prompt: None,
            typed: None,
            overwrite: None,
            refused: Vec::new(),
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
    pub fn ask_locate(&mut self, file: ProjectFile, ctx: &egui::Context) {
        self.ask(Question::Locate(file), ctx);
    }

    /// Asks for one more stamped file.
    pub fn ask_further(&mut self, ctx: &egui::Context) {
        self.ask(Question::Further, ctx);
    }

    /// Asks for another mapper's result.
    pub fn ask_other_mapping(&mut self, ctx: &egui::Context) {
        self.ask(Question::OtherMapping, ctx);
    }

    /// Asks where to write the project.
    pub fn ask_save_project(&mut self, suggested: PathBuf, ctx: &egui::Context) {
        self.ask(Question::SaveProject(suggested), ctx);
    }

    /// Asks where to write.
    pub fn ask_save(
        &mut self,
        kind: Output,
        path: PathBuf,
        inputs: Vec<PathBuf>,
        ctx: &egui::Context,
    ) {
        let path = absolute(path);
        self.ask(Question::Save { kind, path, inputs }, ctx);
    }

    /// Asks where to write a picture.
    pub fn ask_picture(&mut self, choice: PictureChoice, path: PathBuf, ctx: &egui::Context) {
        let path = absolute(path);
        self.ask(Question::Picture { choice, path }, ctx);
    }

    fn ask(&mut self, question: Question, ctx: &egui::Context) {
        if self.is_asking {
            self.refused.extend(closed(&question));
            ctx.request_repaint();
            return;
        }
        let dialog = file_dialog(&question);
        let asked = question.clone();
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        let is_asked = run_once("file dialog", move || {
            let begin = Instant::now();
            let file = pollster::block_on(dialog);
            let path = file.map(|file| file.path().to_owned());
            let took = begin.elapsed();
            let answer = Answer::Dialog {
                question: asked,
                path,
                took,
            };
            // The window may have closed meanwhile.
            let _ = sender.send(answer);
            ctx.request_repaint();
        });
        if is_asked {
            self.is_asking = true;
        } else {
            self.prompt = Some(Prompt::new(question, String::new()));
        }
    }

    /// The answers that came since the last frame.
    pub fn answers(&mut self, ctx: &egui::Context) -> Vec<Command> {
        let answers: Vec<Answer> = self.receiver.try_iter().collect();
        let mut commands = std::mem::take(&mut self.refused);
        for answer in answers {
            match answer {
                Answer::Dialog {
                    question,
                    path,
                    took,
                } => {
                    self.is_asking = false;
                    match path {
                        // The dialog asked about the name as it was typed, not about this one, and of
                        // no file beside it.
                        Some(path)
                            if question.with_ending(path.clone()) != path
                                || question.file_beside(&path).is_some()
                                || matches!(question, Question::Save { .. }) =>
                        {
                            self.check(question, path, false, ctx);
                        }
                        Some(path) => commands.push(answered(&question, path)),
                        None if took < NOT_SHOWN => {
                            let suggestion = question.suggestion();
                            let suggestion = suggestion.map(|path| path.display().to_string());
                            // A file that could not be read after all is typed no second time.
                            let typed = self.typed.clone().filter(|_| question.is_open());
                            let text = suggestion.or(typed).unwrap_or_default();
                            self.prompt = Some(Prompt::new(question, text));
                        }
                        None => commands.extend(closed(&question)),
                    }
                }
                Answer::Checked {
                    question,
                    path,
                    found,
                } => commands.extend(self.checked(question, path, found)),
                Answer::Completed { typed, completion } => {
                    // Only if nothing was typed meanwhile.
                    let prompt = self.prompt.as_mut().filter(|prompt| prompt.text == typed);
                    if let Some(prompt) = prompt {
                        prompt.text = completion.text;
                        prompt.caret = Caret::AtEnd;
                        prompt.names = completion.names;
                    }
                }
            }
        }
        commands
    }

    /// What follows from what is there at a path.
    fn checked(&mut self, question: Question, path: PathBuf, found: Found) -> Option<Command> {
        let note = match found {
            Found::Free => return Some(answered(&question, path)),
            Found::Taken(file) => {
                self.overwrite = Some((question, path, file));
                return None;
            }
            Found::NoFile => format!("{} does not exist.", path.display()),
            Found::IsFolder => format!("{} is a folder.", path.display()),
            Found::InUse(file) => {
                let name = file_name(&file);
                format!("{name} is one of the files that are read here: choose another name.")
            }
            Found::NotMade(reason) => format!("The folder cannot be created: {reason}."),
            Found::NoFolder(folder) => {
                let note = format!("Folder {} does not exist.", folder.display());
                self.prompt = Some(Prompt {
                    missing: Some(folder),
                    ..Prompt::with_note(question, &path, note)
                });
                return None;
            }
        };
        self.prompt = Some(Prompt::with_note(question, &path, note));
        None
    }

    /// Looks on a thread of its own what is there at a path.
    fn check(&self, question: Question, path: PathBuf, makes_folder: bool, ctx: &egui::Context) {
        let path = absolute(question.with_ending(path));
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        let answer = move || {
            let found = Found::at(&path, &question, makes_folder);
            // The window may have closed meanwhile.
            let _ = sender.send(Answer::Checked {
                question,
                path,
                found,
            });
            ctx.request_repaint();
        };
        run_once("file check", answer);
    }

    /// Looks on a thread of its own how a typed path may go on.
    fn complete(&self, typed: String, ctx: &egui::Context) {
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        run_once("path completion", move || {
            let completion = Completion::of(&typed);
            // The window may have closed meanwhile.
            let _ = sender.send(Answer::Completed { typed, completion });
            ctx.request_repaint();
        });
    }

    /// A file that was dropped while the path of a file to read is asked for is the answer; false if none
    /// is asked for.
    pub fn take_dropped(&mut self, path: &Path, ctx: &egui::Context) -> bool {
        let asks = |prompt: &mut Prompt| prompt.question.is_open();
        let Some(prompt) = self.prompt.take_if(asks) else {
            return false;
        };
        self.check(prompt.question, path.to_owned(), false, ctx);
        true
    }

    /// True while a question of ours lies over the window.
    pub fn is_open(&self) -> bool {
        self.prompt.is_some() || self.overwrite.is_some()
    }

    /// The fields and questions for desktops without dialogs. `is_on_processor`: every pixel costs the processor
    /// time.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        is_on_processor: bool,
        commands: &mut Vec<Command>,
    ) {
        self.overwrite_ui(ctx, is_on_processor, commands);
        self.prompt_ui(ctx, is_on_processor, commands);
    }

    /// Asks before a file is replaced.
    fn overwrite_ui(
        &mut self,
        ctx: &egui::Context,
        is_on_processor: bool,
        commands: &mut Vec<Command>,
    ) {
        let Some((question, path, file)) = self.overwrite.take() else {
            return;
        };
        let (mut is_taken, mut is_renamed, mut is_closed) = (false, false, false);
        let shown =
            modal(ctx, egui::Id::unique("overwrite question"), is_on_processor).show(ctx, |ui| {
                ui.set_width(480.0);
                ui.spacing_mut().item_spacing.y = UNIT;
                ui.heading("Replace the existing file?");
                paragraph(ui, format!("{} already exists.", file.display()));
                ui.horizontal(|ui| {
                    is_taken = large_button(ui, "Replace", false).clicked();
                    is_renamed = large_button(ui, "Choose another name", true).clicked();
                    is_closed = large_button(ui, "Cancel", false).clicked();
                });
            });
        if is_taken {
            commands.push(answered(&question, path));
        } else if is_renamed {
            self.prompt = Some(Prompt::new(question, path.display().to_string()));
        } else if !is_closed && !shown.should_close() {
            self.overwrite = Some((question, path, file));
        } else {
            commands.extend(closed(&question));
        }
    }

    /// The field to type a path into.
    fn prompt_ui(
        &mut self,
        ctx: &egui::Context,
        is_on_processor: bool,
        commands: &mut Vec<Command>,
    ) {
        let Some(mut prompt) = self.prompt.take() else {
            return;
        };
        let mut answer = None;
        let shown = modal(ctx, egui::Id::unique("path prompt"), is_on_processor).show(ctx, |ui| {
            ui.set_width(480.0_f32.min(ctx.content_rect().width() - 80.0));
            ui.spacing_mut().item_spacing.y = UNIT;
            answer = prompt_content(ui, &mut prompt);
        });
        let path = path_prompt::expanded(prompt.text.trim().trim_matches('"'));
        match answer {
            Some(PromptAnswer::Complete) => self.complete(prompt.text.clone(), ctx),
            Some(PromptAnswer::Take) if !path.as_os_str().is_empty() => {
                if prompt.question.is_open() {
                    self.typed = Some(prompt.text);
                }
                return self.check(prompt.question, path, false, ctx);
            }
            Some(PromptAnswer::Create) => {
                return self.check(prompt.question, path, true, ctx);
            }
            Some(PromptAnswer::Close) => return commands.extend(closed(&prompt.question)),
            _ if shown.should_close() => return commands.extend(closed(&prompt.question)),
            _ => {}
        }
        self.prompt = Some(prompt);
    }
}

/// What was done in the prompt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PromptAnswer {
    Take,
    Create,
    Complete,
    Close,
}

fn prompt_content(ui: &mut egui::Ui, prompt: &mut Prompt) -> Option<PromptAnswer> {
    let (title, verb) = titles(&prompt.question);
    let mut answer = None;
    ui.heading(title);
    paragraph(
        ui,
        if prompt.question.is_open() {
            "No file dialog available. Enter a path, or drop the file on the window."
        } else {
            "No file dialog available. Enter a path; the extension is added."
        },
    );
    let before = prompt.text.clone();
    let field = path_prompt::field_ui(ui, &mut prompt.text, &mut prompt.caret);
    if prompt.text != before {
        (prompt.note, prompt.missing) = (None, None);
        prompt.names.clear();
    }
    let lacks_folder = prompt.missing.is_some();
    if field.is_entered {
        // With the folder missing there is one way on.
        answer = Some(if lacks_folder {
            PromptAnswer::Create
        } else {
            PromptAnswer::Take
        });
    } else if field.wants_completion {
        answer = Some(PromptAnswer::Complete);
    }
    if let Some(name) = path_prompt::names_ui(ui, &prompt.names) {
        prompt.text = path_prompt::with_name(&prompt.text, &name);
        prompt.caret = Caret::AtEnd;
        prompt.names.clear();
    }
    if let Some(note) = &prompt.note {
        ui.horizontal_wrapped(|ui| {
            ui.label(egui::RichText::new(note).color(Palette::of(ui).check));
            if lacks_folder && ui.button("Create").clicked() {
                answer = Some(PromptAnswer::Create);
            }
        });
    }
    ui.horizontal(|ui| {
        let is_typed = !prompt.text.trim().is_empty();
        let can_take = is_typed && !lacks_folder;
        let take = ui.add_enabled_ui(can_take, |ui| large_button(ui, verb, true));
        if take.inner.clicked() {
            answer = Some(PromptAnswer::Take);
        }
        if large_button(ui, "Cancel", false).clicked() {
            answer = Some(PromptAnswer::Close);
        }
        if matches!(
            prompt.question,
            Question::Open(_) | Question::Locate(_) | Question::Further
        ) {
            caption(ui, formats());
        }
    });
    answer
}

/// What follows from a dialog that was closed without an answer.
fn closed(question: &Question) -> Option<Command> {
    let is_save = matches!(question, Question::SaveProject(_));
    is_save.then(|| ProjectCommand::NotWritten.into())
}

/// What an answer asks for.
fn answered(question: &Question, path: PathBuf) -> Command {
    match *question {
        Question::Open(role) => FileCommand::Open {
            paths: vec![path],
            role: Some(role),
        }
        .into(),
        Question::OpenProject => {
            let request = ProjectRequest {
                path,
                ..ProjectRequest::default()
            };
            ProjectCommand::Open(request).into()
        }
        Question::Locate(file) => ProjectCommand::Locate(file, Located::At(path)).into(),
        Question::Further => MapCommand::AddFurther(path).into(),
        Question::OtherMapping => MapCommand::CompareWith(path).into(),
        Question::SaveProject(_) => ProjectCommand::Write(path).into(),
        Question::Save { kind, .. } => ExportCommand::Write { kind, path }.into(),
        Question::Picture { choice, .. } => ExportCommand::WritePicture { choice, path }.into(),
    }
}

/// A path that messages can name whole.
fn absolute(path: PathBuf) -> PathBuf {
    std::path::absolute(&path).unwrap_or(path)
}

fn formats() -> String {
    let labels: Vec<&str> = Format::ALL.iter().map(|f| f.label()).collect();
    labels.join(", ")
}

#[cfg(test)]
mod tests;
