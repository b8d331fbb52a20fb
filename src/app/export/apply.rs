//! What exports change: the questions before them and what was written.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{CopyForm, ExportCommand, PictureChoice, PicturePlace};
use crate::app::work::Work;
use crate::app::{Effect, LogStep, NoticeLevel, Settings, Shared};
use crate::jobs::{Destination, ExportRequest, Exported, JobKind};
use crate::pipeline::names::file_name;
use crate::pipeline::outputs::{MeshOutput, Output, OutputInput};
use crate::report::MatrixForm;
use crate::role::{PerRole, Role};
use crate::text::tidy_factor;

impl Work<'_> {
    pub(in crate::app) fn apply_export(&mut self, command: ExportCommand) -> Vec<Effect> {
        match command {
            ExportCommand::Copy(form) => self.copy_form_now(form),
            ExportCommand::AskSave(kind) => self.ask_place(kind),
            ExportCommand::Write { kind, path } => self.write(kind, path),
            ExportCommand::CopyCommandLine => match self.document.command_line() {
                Some(line) => self.copy(line, "Command line"),
                None => Vec::new(),
            },
            ExportCommand::CopyMapCommandLine => match self.document.map_command_line() {
                Some(line) => self.copy(line, "Command line of the mapping"),
                None => Vec::new(),
            },
            ExportCommand::CopyLog => self.copy(self.log.to_text(), "Log"),
            ExportCommand::CopyText { text, what } => self.copy(text, &what),
            ExportCommand::TakePicture { is_transparent } => self.take_picture(is_transparent),
            ExportCommand::AskPicture(choice) => {
                let settings = Settings {
                    picture: choice,
                    ..self.settings.clone()
                };
                let mut effects = self.set_settings(settings);
                effects.push(self.ask_picture(choice));
                effects
            }
            ExportCommand::WritePicture { choice, path } => {
                let settings = Settings {
                    picture_folder: path.parent().map(Path::to_path_buf),
                    ..self.settings.clone()
                };
                let mut effects = self.set_settings(settings);
                effects.push(self.picture_effect(choice, PicturePlace::File(path)));
                effects
            }
        }
    }

    fn copy(&mut self, text: String, what: &str) -> Vec<Effect> {
        self.notify(NoticeLevel::Success, format!("{what} copied"));
        vec![Effect::CopyText(text)]
    }

    fn ask_picture(&self, choice: PictureChoice) -> Effect {
        let name = format!("{}.png", self.document.picture_stem());
        let path = match &self.settings.picture_folder {
            Some(folder) => folder.join(name),
            None => self.document.beside_part(Role::Stamped, &name),
        };
        Effect::AskPicture { choice, path }
    }

    /// As the last time, into the folder of the last time; the first time it asks.
    fn take_picture(&self, is_transparent: bool) -> Vec<Effect> {
        let mut choice = self.settings.picture;
        if is_transparent {
            // The screen has its background.
            choice.is_transparent = true;
            choice.overlays = Some(false);
        }
        vec![match &self.settings.picture_folder {
            Some(folder) => {
                let (folder, stem) = (folder.clone(), self.document.picture_stem());
                self.picture_effect(choice, PicturePlace::Next { folder, stem })
            }
            None => self.ask_picture(choice),
        }]
    }

    fn picture_effect(&self, choice: PictureChoice, place: PicturePlace) -> Effect {
        Effect::TakePicture {
            choice,
            place,
            texts: self.document.picture_texts(),
        }
    }

    /// Copies the matrix at once; cards are made by the worker.
    fn copy_form_now(&mut self, form: CopyForm) -> Vec<Effect> {
        let pose = self.document.crash_from_stamped();
        let mirrored = if pose.is_mirrored() { ", mirrored" } else { "" };
        let mut effects = match form {
            CopyForm::Matrix(form) => {
                let text = form.write(pose);
                let direction = match form {
                    MatrixForm::Inverse => "crash → stamped",
                    _ => "stamped → crash",
                };
                let label = form.label();
                let what = format!("Matrix ({direction}{mirrored}, {label}, all digits)");
                self.copy(text, &what)
            }
            CopyForm::Cards(_) if self.tells_of_two_units() => Vec::new(),
            CopyForm::Cards(cards) => {
                let label = form.label();
                let what = format!("{label} (stamped → crash{mirrored}, ten columns)");
                let to = Destination::Clipboard(what);
                self.request(Output::Cards(cards), to)
            }
        };
        effects.extend(self.set_settings(Settings {
            matrix_form: Some(form.name().to_owned()),
            ..self.settings.clone()
        }));
        effects
    }

    /// Asks for a name. Cards cannot hold a unit factor, so the converted stamped file is offered
    /// in their place.
    fn ask_place(&mut self, kind: Output) -> Vec<Effect> {
        let kind = match kind {
            Output::Cards(_) if self.tells_of_two_units() => Output::Mesh(MeshOutput::Converted),
            kind => kind,
        };
        vec![Effect::AskSave {
            kind,
            path: self.document.suggested_path(kind),
            inputs: self.document.files(),
        }]
    }

    /// Where the stamped file was read in another unit, says why there are no cards, and the way to them.
    fn tells_of_two_units(&mut self) -> bool {
        let stamped = self.document.part(Role::Stamped);
        let factor = stamped.map_or(1.0, |part| part.length_factor());
        if factor == 1.0 {
            return false;
        }
        let text = format!(
            "The lengths of the stamped file are multiplied by {}, and the cards have no field for \
             that. Write “{}” (Save part as), open it in place of the present file, match again, and then \
             make the cards.",
            tidy_factor(factor),
            MeshOutput::Converted.label().trim_end_matches('…')
        );
        self.notify(NoticeLevel::Warning, text);
        true
    }

    fn write(&mut self, output: Output, path: PathBuf) -> Vec<Effect> {
        let path = output.with_extension(path);
        self.request(output, Destination::File(path))
    }

    fn request(&mut self, output: Output, to: Destination) -> Vec<Effect> {
        if !self.document.can_write(output) {
            // It was asked for while it could be made, and the dialog stayed open.
            let text = format!(
                "{} is not written: what it is made from is gone",
                output.label()
            );
            self.notify(NoticeLevel::Warning, text);
            return Vec::new();
        }
        let input = self.output_input(output);
        let request = ExportRequest {
            number: self.history.next_revision(),
            to,
            output,
            input,
        };
        vec![self.start(JobKind::Export(request))]
    }

    /// What an output is made from: the parts, the pose, and the match as it is shown, with the
    /// chosen alternative.
    fn output_input(&self, output: Output) -> OutputInput {
        let part = |role| self.document.part(role);
        let result = self.document.current_result();
        OutputInput {
            parts: PerRole::from_fn(|role| part(role).map(|part| part.loaded.to_arc())),
            crash_from_stamped: *self.document.crash_from_stamped(),
            run: result.map(|result| result.run.to_arc()),
            alternative: result.and_then(|result| result.alternative),
            reduced: PerRole::from_fn(|role| part(role).map(|part| part.reduced_mesh().clone())),
            mapping: self
                .document
                .current_mapping()
                .map(|result| result.run.to_arc()),
            further_stamped: self
                .document
                .current_mapping()
                .map(|result| result.further.iter().map(Shared::to_arc).collect())
                .unwrap_or_default(),
            pins: self.document.mapping.pins.clone(),
            other: self
                .document
                .current_mapping()
                .and_then(|result| Some(result.other.as_ref()?.to_arc())),
            log: match output {
                Output::Log => self.log.to_text(),
                _ => String::new(),
            },
        }
    }

    pub(in crate::app) fn take_exported(
        &mut self,
        exported: Exported,
        took: Duration,
    ) -> Vec<Effect> {
        for note in &exported.notes {
            self.log_step(LogStep::Export, None, note.clone(), None);
        }
        match (exported.to, exported.text) {
            (Destination::Clipboard(what), Some(text)) => self.copy(text, &what),
            (Destination::Clipboard(_), None) => Vec::new(),
            (Destination::File(path), _) => {
                // The message says at once what the log says in rows.
                let notes = exported.notes.iter().map(String::as_str);
                // A toast is cut at its end: there stands the folder, which may be long.
                let name = format!("saved: {}", file_name(&path));
                let folder = path
                    .parent()
                    .map(|folder| format!("in {}", folder.display()));
                let folder = folder.filter(|folder| folder.len() > "in ".len());
                let all = std::iter::once(name.as_str())
                    .chain(notes)
                    .chain(folder.as_deref());
                let all: Vec<&str> = all.collect();
                self.notify(NoticeLevel::Success, all.join("; "));
                self.log.push_written(path, took);
                Vec::new()
            }
        }
    }
}
