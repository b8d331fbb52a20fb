use crate::app::{AppState, Effect, ExportCommand, ExportKind, NoticeLevel, Settings, facts};
use crate::jobs::{ExportRequest, JobKind};
use crate::pipeline::match_parts::MatchRun;
use crate::report::MatrixForm;
use std::path::PathBuf;
use std::sync::Arc;

impl AppState {
    pub(super) fn apply_export(&mut self, command: ExportCommand) -> Vec<Effect> {
        match command {
            ExportCommand::CopyMatrix(form) => self.copy_matrix(form),
            ExportCommand::AskSave(kind) => vec![Effect::AskSave(kind)],
            ExportCommand::Write { kind, path } => self.write(kind, path),
            ExportCommand::CopyCommandLine => match self.command_line() {
                Some(line) => self.copy(line, "Command line"),
                None => Vec::new(),
            },
            ExportCommand::CopyLog => self.copy(self.log.to_text(), "Log"),
            ExportCommand::CopyText { text, what } => self.copy(text, &what),
            ExportCommand::TakePicture { is_transparent } => {
                vec![Effect::TakePicture { is_transparent }]
            }
        }
    }

    fn copy(&mut self, text: String, what: &str) -> Vec<Effect> {
        self.notify(NoticeLevel::Success, format!("{what} copied"));
        vec![Effect::CopyText(text)]
    }

    fn copy_matrix(&mut self, form: MatrixForm) -> Vec<Effect> {
        let text = form.write(self.document.crash_from_stamped());
        let direction = if form == MatrixForm::Inverse {
            "crash → stamped"
        } else {
            "stamped → crash"
        };
        let what = format!("Matrix ({direction}, {})", form.label());
        let mut effects = self.copy(text, &what);
        effects.extend(self.set_settings(Settings {
            matrix_form: Some(form.name().to_owned()),
            ..self.settings.clone()
        }));
        effects
    }

    fn write(&mut self, kind: ExportKind, path: PathBuf) -> Vec<Effect> {
        match self.export_request(kind, path) {
            Some(request) => vec![self.start(JobKind::Export(request))],
            None => Vec::new(),
        }
    }

    fn export_request(&self, kind: ExportKind, path: PathBuf) -> Option<ExportRequest> {
        let pose = *self.document.crash_from_stamped();
        let request = match kind {
            ExportKind::Matrix(form) => ExportRequest::Text {
                path,
                text: form.write(&pose),
            },
            ExportKind::Log => ExportRequest::Text {
                path,
                text: self.log.to_text(),
            },
            ExportKind::Moved => ExportRequest::Moved {
                path,
                stamped: self.document.parts.stamped.as_ref()?.loaded.to_arc(),
                crash_from_stamped: pose,
            },
            ExportKind::Record => {
                let (crash, stamped) = self.document.both()?;
                ExportRequest::Record {
                    path,
                    run: self.shown_run()?,
                    crash: crash.loaded.to_arc(),
                    stamped: stamped.loaded.to_arc(),
                }
            }
            ExportKind::Cards(form) => {
                let (crash, stamped) = self.document.both()?;
                ExportRequest::Cards {
                    path,
                    form,
                    run: self.shown_run()?,
                    crash: crash.loaded.to_arc(),
                    stamped: stamped.loaded.to_arc(),
                }
            }
        };
        Some(request)
    }

    /// The match as it is shown: with the pose of the chosen alternative.
    fn shown_run(&self) -> Option<Arc<MatchRun>> {
        let result = self.document.current_result()?;
        if result.alternative.is_none() {
            return Some(result.run.to_arc());
        }
        Some(Arc::new(MatchRun {
            crash_from_stamped: facts::match_pose(&result.run, result.alternative)?,
            ..MatchRun::clone(&result.run)
        }))
    }
}
