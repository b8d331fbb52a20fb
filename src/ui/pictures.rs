//! Pictures for files: taken from the 3D windows or from the screen, packed and written by a thread of
//! their own.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::{ScreenshotCallback, ViewportCommand};

use super::background::run_once;
use super::panels::graphics;
use super::viewport::Viewports;
use crate::app::{AppState, NoticeLevel, PictureChoice, PicturePlace};
use crate::pipeline::outputs::{Output, Target, check_targets};
use crate::pipeline::write_file::{write_file, write_new_file};
use crate::report::picture::Picture;

/// Most names that are tried for a picture without one.
const MAX_NUMBER: u32 = 9999;

/// Something to say.
type News = (NoticeLevel, String);

/// A picture that is wanted.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// How it is taken.
    pub choice: PictureChoice,
    /// Where it goes.
    pub place: PicturePlace,
    /// What the file says about itself: keyword and text.
    pub texts: Vec<(&'static str, String)>,
    /// Files that it may not overwrite.
    pub inputs: Vec<PathBuf>,
}

/// Pictures on their way to files.
pub struct Pictures {
    wanted: Vec<Wanted>,
    told: (Sender<News>, Receiver<News>),
}

impl Default for Pictures {
    fn default() -> Self {
        Self {
            wanted: Vec::new(),
            told: channel(),
        }
    }
}

impl Pictures {
    /// Asks for a picture.
    pub fn want(&mut self, wanted: Wanted, ctx: &egui::Context) {
        let choice = wanted.choice;
        if choice.has_overlays {
            let (sender, waking) = (self.told.0.clone(), ctx.clone());
            let callback = ScreenshotCallback::new(move |screen| {
                if let Some(picture) = graphics::cut_out(&waking, &screen, choice.windows) {
                    write(picture, wanted, sender, waking);
                }
            });
            ctx.send_viewport_cmd(ViewportCommand::Screenshot(callback));
        } else {
            self.wanted.push(wanted);
        }
        ctx.request_repaint();
    }

    /// Draws what is wanted, which waits for the graphics card, and hands it to threads. Returns what
    /// became of earlier ones.
    pub fn take(
        &mut self,
        state: &AppState,
        viewports: &mut Viewports,
        ctx: &egui::Context,
    ) -> Vec<News> {
        let mut news: Vec<News> = self.told.1.try_iter().collect();
        for wanted in std::mem::take(&mut self.wanted) {
            match viewports.picture(state, &wanted.choice) {
                Some(picture) => {
                    write(picture, wanted, self.told.0.clone(), ctx.clone());
                }
                None => news.push((
                    NoticeLevel::Error,
                    "no image can be written: nothing is drawn yet".to_owned(),
                )),
            }
        }
        news
    }
}

/// Packs and writes on a thread of its own.
fn write(picture: Picture, wanted: Wanted, sender: Sender<News>, ctx: egui::Context) {
    run_once("picture", move || {
        let bytes = picture.to_png_with(&wanted.texts);
        let news = match save(&wanted.place, &wanted.inputs, &bytes) {
            Ok(path) => (NoticeLevel::Success, format!("saved: {}", path.display())),
            Err(error) => (
                NoticeLevel::Error,
                format!("the image could not be written: {error}"),
            ),
        };
        // The window may have closed meanwhile.
        let _ = sender.send(news);
        ctx.request_repaint();
    });
}

fn save(place: &PicturePlace, inputs: &[PathBuf], bytes: &[u8]) -> anyhow::Result<PathBuf> {
    match place {
        PicturePlace::File(path) => {
            let target = Target {
                name: "the image".to_owned(),
                path: path.clone(),
                content: Output::Picture.content(),
            };
            if let Some(refusal) = check_targets(&[target], inputs).into_iter().next() {
                return Err(refusal.into());
            }
            write_file(path, bytes)?;
            Ok(path.clone())
        }
        PicturePlace::Next { folder, stem } => save_next(folder, stem, bytes),
    }
}

/// Takes the first number whose file is not there yet; never replaces one.
fn save_next(folder: &Path, stem: &str, bytes: &[u8]) -> anyhow::Result<PathBuf> {
    for number in 1..=MAX_NUMBER {
        let path = folder.join(format!("{stem}_{number}.png"));
        if write_new_file(&path, bytes)? {
            return Ok(path);
        }
    }
    anyhow::bail!("all numbers up to {MAX_NUMBER} are taken")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_number_is_taken_and_nothing_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let place = PicturePlace::Next {
            folder: folder.path().to_path_buf(),
            stem: "bp".to_owned(),
        };
        let names = [b"a", b"b"].map(|bytes| save(&place, &[], bytes).unwrap());
        assert_eq!(names[0], folder.path().join("bp_1.png"));
        assert_eq!(std::fs::read(&names[0]).unwrap(), b"a");
        assert_eq!(std::fs::read(&names[1]).unwrap(), b"b");
    }
}
