use crate::app::{
    AppState, CopyForm, Effect, ExportCommand, ExportKind, MeshExport, NoticeLevel, PictureChoice,
    PicturePlace, Settings,
};
use crate::geometry::Similarity;
use crate::jobs::{
    Destination, ExportContent, ExportRequest, Exported, JobKind, MatchedPair, Role,
};
use crate::pipeline::units::PairUnits;
use crate::report::MatrixForm;
use std::path::{Path, PathBuf};
use std::time::Duration;

impl AppState {
    pub(super) fn apply_export(&mut self, command: ExportCommand) -> Vec<Effect> {
        match command {
            ExportCommand::Copy(form) => self.copy_form_now(form),
            ExportCommand::AskSave(kind) => self.ask_place(kind),
            ExportCommand::Write { kind, path } => self.write(kind, path),
            ExportCommand::CopyCommandLine => match self.command_line() {
                Some(line) => self.copy(line, "Command line"),
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
        let name = format!("{}.png", self.picture_stem());
        Effect::AskPicture { choice, name }
    }

    /// As the last time, into the folder of the last time; the first time it asks.
    fn take_picture(&self, is_transparent: bool) -> Vec<Effect> {
        let mut choice = self.settings.picture;
        choice.is_transparent |= is_transparent;
        vec![match &self.settings.picture_folder {
            Some(folder) => {
                let (folder, stem) = (folder.clone(), self.picture_stem());
                self.picture_effect(choice, PicturePlace::Next { folder, stem })
            }
            None => self.ask_picture(choice),
        }]
    }

    fn picture_effect(&self, choice: PictureChoice, place: PicturePlace) -> Effect {
        Effect::TakePicture {
            choice,
            place,
            texts: self.picture_texts(),
        }
    }

    /// Copies the matrix at once; cards are made by the worker.
    fn copy_form_now(&mut self, form: CopyForm) -> Vec<Effect> {
        let mut effects = match form {
            CopyForm::Matrix(form) => {
                let text = form.write(self.document.crash_from_stamped());
                let direction = match form {
                    MatrixForm::Inverse => "crash → stamped",
                    _ => "stamped → crash",
                };
                let what = format!("Matrix ({direction}, {}, all digits)", form.label());
                self.copy(text, &what)
            }
            CopyForm::Cards(cards) => {
                let what = format!("{} (stamped → crash, ten columns)", form.label());
                let to = Destination::Clipboard(what);
                let kind = ExportKind::Cards(cards);
                self.request(kind, to)
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
    fn ask_place(&mut self, kind: ExportKind) -> Vec<Effect> {
        let stamped = self.document.part(Role::Stamped);
        let factor = stamped.map_or(1.0, |part| part.length_factor());
        let kind = if matches!(kind, ExportKind::Cards(_)) && factor != 1.0 {
            let text = format!(
                "The lengths of the stamped file are multiplied by {factor}, and the include card has \
                 no field for that. Write the stamped file in the crash part's unit, open it in place \
                 of the present one, match again, and then write the card."
            );
            self.notify(NoticeLevel::Warning, text);
            ExportKind::Mesh(MeshExport::Converted)
        } else {
            kind
        };
        let name = kind.suggested_name(self);
        vec![Effect::AskSave { kind, name }]
    }

    fn write(&mut self, kind: ExportKind, path: PathBuf) -> Vec<Effect> {
        let path = kind.with_ending(path);
        self.request(kind, Destination::File(path))
    }

    fn request(&mut self, kind: ExportKind, to: Destination) -> Vec<Effect> {
        match self.export_content(kind) {
            Some(content) => vec![self.start(JobKind::Export(ExportRequest { to, content }))],
            None => Vec::new(),
        }
    }

    fn export_content(&self, kind: ExportKind) -> Option<ExportContent> {
        let pose = *self.document.crash_from_stamped();
        let content = match kind {
            ExportKind::Matrix(form) => {
                let units = self
                    .document
                    .both()
                    .map(|(crash, stamped)| PairUnits::sentences(&crash.loaded, &stamped.loaded));
                ExportContent::Text(form.write_with(&pose, &units.unwrap_or_default()))
            }
            ExportKind::Log => ExportContent::Text(self.log.to_text()),
            ExportKind::Record => ExportContent::Record(self.matched_pair()?),
            ExportKind::Report => ExportContent::Report(self.matched_pair()?),
            ExportKind::Cards(form) => ExportContent::Cards(form, self.matched_pair()?),
            ExportKind::Deviations => {
                let (crash, stamped) = self.document.both()?;
                ExportContent::Deviations {
                    crash: crash.loaded.to_arc(),
                    stamped: stamped.loaded.to_arc(),
                    crash_from_stamped: pose,
                }
            }
            ExportKind::Mesh(mesh) => self.mesh_content(mesh)?,
        };
        Some(content)
    }

    fn mesh_content(&self, export: MeshExport) -> Option<ExportContent> {
        let role = export.role();
        let part = self.document.part(role)?;
        let other = self.document.part(role.other());
        let pose = match export {
            MeshExport::Moved | MeshExport::MovedReduced => *self.document.crash_from_stamped(),
            MeshExport::Converted | MeshExport::Crash | MeshExport::CrashReduced => {
                Similarity::identity()
            }
        };
        Some(if export.is_reduced() {
            let name = part.loaded.file_name();
            ExportContent::Mesh {
                mesh: part.reduced_mesh().clone(),
                world_from_mesh: pose,
                title: format!("{name}, reduced"),
            }
        } else {
            ExportContent::Part {
                part: part.loaded.to_arc(),
                world_from_part: pose,
                other: other.map(|other| other.loaded.to_arc()),
            }
        })
    }

    /// The match as it is shown, with the chosen alternative.
    fn matched_pair(&self) -> Option<MatchedPair> {
        let result = self.document.current_result()?;
        let (crash, stamped) = self.document.both()?;
        Some(MatchedPair {
            run: result.run.to_arc(),
            alternative: result.alternative,
            crash: crash.loaded.to_arc(),
            stamped: stamped.loaded.to_arc(),
        })
    }

    pub(super) fn take_exported(&mut self, exported: Exported, took: Duration) -> Vec<Effect> {
        for note in exported.notes {
            self.log_step("export", None, note, None);
        }
        match (exported.to, exported.text) {
            (Destination::Clipboard(what), Some(text)) => self.copy(text, &what),
            (Destination::Clipboard(_), None) => Vec::new(),
            (Destination::File(path), _) => {
                let text = format!("written: {}", path.display());
                self.log_at(NoticeLevel::Success, "export", None, text, Some(took));
                Vec::new()
            }
        }
    }
}
