//! Pictures for files: taken from the 3D windows or from the screen, packed and written by a thread of
//! their own.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Weak};

use egui::{ScreenshotCallback, Ui, ViewportCommand};

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
    /// How it is taken; without overlays unless they are chosen.
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
        if choice.overlays == Some(true) {
            let (sender, waking) = (self.told.0.clone(), ctx.clone());
            let taking = taking(ctx);
            let callback = ScreenshotCallback::new(move |screen| {
                drop(taking);
                waking.request_repaint();
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

fn taken_id() -> egui::Id {
    egui::Id::unique("pictures of the screen under way")
}

/// Held by a picture of the screen until it is taken or given up.
fn taking(ctx: &egui::Context) -> Arc<()> {
    ctx.data_mut(|data| {
        let others: &mut Weak<()> = data.get_temp_mut_or_default(taken_id());
        let taking = others.upgrade().unwrap_or_default();
        *others = Arc::downgrade(&taking);
        taking
    })
}

/// True while a picture of the screen is taken, which is that of the next frame or of a later one.
pub fn is_screen_taken(ctx: &egui::Context) -> bool {
    let taken: Option<Weak<()>> = ctx.data(|data| data.get_temp(taken_id()));
    taken.is_some_and(|taken| taken.strong_count() > 0)
}

/// Draws what is only there to be clicked: a picture of the screen has its place, so that nothing else moves, but not
/// what stands there.
pub fn clickable<R>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
    let opacity = ui.opacity();
    if is_screen_taken(ui.ctx()) {
        ui.set_opacity(0.0);
    }
    let shown = add(ui);
    ui.set_opacity(opacity);
    shown
}

/// Packs and writes on a thread of its own.
fn write(picture: Picture, wanted: Wanted, sender: Sender<News>, ctx: egui::Context) {
    let (failed, waking) = (sender.clone(), ctx.clone());
    let is_started = run_once("picture", move || {
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
    if !is_started {
        let text = "the image could not be written: the system has no thread left";
        let _ = failed.send((NoticeLevel::Error, text.to_owned()));
        waking.request_repaint();
    }
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
    fn the_screen_is_taken_until_its_picture_is_there_or_given_up() {
        let ctx = egui::Context::default();
        let take = || {
            let wanted = Wanted {
                choice: PictureChoice {
                    overlays: Some(true),
                    ..PictureChoice::default()
                },
                place: PicturePlace::File(PathBuf::new()),
                texts: Vec::new(),
                inputs: Vec::new(),
            };
            let mut output = ctx.run_ui(egui::RawInput::default(), |_| {
                Pictures::default().want(wanted.clone(), &ctx);
            });
            output.textures_delta.clear();
            let mut commands = output.viewport_output.into_values();
            let mut commands = commands.next().unwrap().commands.into_iter();
            commands.find_map(|command| match command {
                ViewportCommand::Screenshot(callback) => Some(callback),
                _ => None,
            })
        };
        assert!(!is_screen_taken(&ctx));
        let [first, second] = [take(), take()];
        assert!(is_screen_taken(&ctx));
        let screen = Arc::new(egui::ColorImage::filled([1, 1], egui::Color32::BLACK));
        first.unwrap().complete(screen);
        assert!(is_screen_taken(&ctx), "there is another one");
        drop(second);
        assert!(!is_screen_taken(&ctx));
    }

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
