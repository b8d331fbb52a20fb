use crate::app::{AppState, Effect, ExportCommand, NoticeLevel};

impl AppState {
    pub(super) fn apply_export(&mut self, command: ExportCommand) -> Vec<Effect> {
        match command {
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
}
