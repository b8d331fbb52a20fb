//! Large pictures without a standstill: a coarse one while the view moves, the exact one in slices once
//! it rests. What the slices give is the picture that drawing at once gives.

use std::time::{Duration, Instant};

use super::context::Context;
use super::frame::{Frame, Seen};
use super::mesh_cache::MeshCache;
use super::pipeline::Gpu;
use super::prepare::{Detail, Prepared};
use super::scene::Sheet;
use super::slice::Slice;
use super::target::{ViewTarget, within_limit};

/// A view that has not moved for so long is drawn exactly.
const SETTLED: Duration = Duration::from_millis(120);
/// When an upload that is under way is looked for again.
const UPLOAD: Duration = Duration::from_millis(30);
/// A picture of looks that are older than this gives way to a coarse one.
const STALE: Duration = Duration::from_millis(400);
/// Things (triangles, lines, nodes) drawn in the first slice, and the fewest in one. With fewer, a processor would
/// spend most of the time on the rest of each frame.
const FEWEST: u64 = 20_000;
const MOST: u64 = 1 << 32;
/// Slices further apart than this become smaller, closer ones larger.
const SLOW: Duration = Duration::from_millis(50);
const QUICK: Duration = Duration::from_millis(25);

/// How far the picture of a frame is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drawn {
    /// It is exact.
    Exact,
    /// It is coarse or of before; the next step is due after this time.
    Partly(Duration),
}

/// What a viewport remembers between the steps.
#[derive(Debug, Default)]
pub(super) struct Steps {
    /// What was asked for last, and since when the view rests.
    asked: Option<Seen>,
    since: Option<Instant>,
    /// Since when the picture shows looks of before.
    stale_since: Option<Instant>,
    pending: Option<Pending>,
    pace: Pace,
}

/// An exact picture that is being drawn.
#[derive(Debug)]
struct Pending {
    prepared: Prepared,
    /// The frame without the sheets' depths, for drawing these.
    without_sheets: Option<wgpu::BindGroup>,
    stage: Stage,
    n_done: u64,
}

/// What is drawn one after another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Sheet(Sheet),
    Picture,
    Selection,
}

/// How much is drawn in one slice.
#[derive(Debug)]
struct Pace {
    n: u64,
    last: Option<Instant>,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            n: FEWEST,
            last: None,
        }
    }
}

impl Pace {
    /// The size of the slice that is drawn now.
    fn next(&mut self, now: Instant) -> u64 {
        if let Some(last) = self.last.replace(now) {
            let took = now.duration_since(last);
            if took > SLOW {
                self.n = (self.n / 2).max(FEWEST);
            } else if took < QUICK {
                self.n = (self.n * 2).min(MOST);
            }
        }
        self.n
    }
}

impl Steps {
    fn asks_for(&self, frame: &Frame<'_>) -> bool {
        self.asked.as_ref().is_some_and(|asked| asked.is_of(frame))
    }

    /// True if the frame shows something at another place than the one before.
    fn moves_to(&self, frame: &Frame<'_>) -> bool {
        self.asked
            .as_ref()
            .is_none_or(|asked| !asked.lies_as(frame))
    }
}

impl ViewTarget {
    /// Draws what can be drawn now without making the window wait.
    pub(super) fn draw_step(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        cache: &mut MeshCache,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Drawn {
        let frame = within_limit(gpu.device, frame);
        let mut drawables = frame.scene.drawables.iter();
        if !drawables.any(|d| d.opacity > 0.0 && d.mesh.coarse().is_some()) {
            self.steps = Steps::default();
            self.draw(gpu, context, cache, encoder, &frame);
            return Drawn::Exact;
        }
        let is_new = self.resize(gpu, context, frame.size);
        if self.shows(&frame) {
            self.steps.pending = None;
            self.steps.stale_since = None;
            return Drawn::Exact;
        }
        let now = Instant::now();
        let steps = &mut self.steps;
        let is_moving = is_new || steps.moves_to(&frame);
        let is_other = !steps.asks_for(&frame);
        if is_other || is_new {
            steps.pending = None;
            steps.asked = Some(Seen::of(&frame));
        }
        let stale_since = *steps.stale_since.get_or_insert(now);
        if is_moving || (is_other && now.duration_since(stale_since) > STALE) {
            steps.since = Some(now);
            steps.stale_since = None;
            self.draw_coarse(gpu, context, cache, encoder, &frame);
            return Drawn::Partly(SETTLED);
        }
        let rest = steps
            .since
            .map_or(SETTLED, |since| now.duration_since(since));
        if rest < SETTLED {
            return Drawn::Partly(SETTLED - rest);
        }
        self.draw_slice(gpu, context, cache, encoder, (&frame, now))
    }

    fn draw_slice(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        cache: &mut MeshCache,
        encoder: &mut wgpu::CommandEncoder,
        (frame, now): (&Frame<'_>, Instant),
    ) -> Drawn {
        let Some(textures) = &mut self.textures else {
            return Drawn::Exact;
        };
        if self.steps.pending.is_none() {
            let shown = frame.scene.drawables.iter().filter(|d| d.opacity > 0.0);
            let is_ready =
                |d: &super::Drawable| cache.is_ready(gpu.device, &d.mesh, d.field.as_ref());
            // All of them are asked for, not only the first that is missing.
            if shown.map(is_ready).filter(|ready| !ready).count() > 0 {
                return Drawn::Partly(UPLOAD);
            }
            let sheets = textures.sheets(gpu.device, frame);
            let views = sheets.unwrap_or(&context.no_sheets).views();
            let prepared = Prepared::new(gpu, cache, (frame, Detail::Exact), views);
            let without = prepared.frame_group(gpu, context.no_sheets.views());
            let has_sheets = sheets.is_some();
            self.steps.pace.last = None;
            self.steps.pending = Some(Pending {
                prepared,
                without_sheets: has_sheets.then_some(without),
                stage: if has_sheets {
                    Stage::Sheet(Sheet::First)
                } else {
                    Stage::Picture
                },
                n_done: 0,
            });
        }
        let n = self.steps.pace.next(now);
        let Some(pending) = &mut self.steps.pending else {
            return Drawn::Exact;
        };
        if !pending.go_on(gpu, context, textures, encoder, n) {
            return Drawn::Partly(Duration::ZERO);
        }
        self.steps.pending = None;
        self.steps.stale_since = None;
        self.show_exact(frame);
        Drawn::Exact
    }
}

impl Pending {
    /// Draws `n` more things; true at the end.
    fn go_on(
        &mut self,
        gpu: Gpu<'_>,
        context: &Context,
        textures: &mut super::target::Textures,
        encoder: &mut wgpu::CommandEncoder,
        mut n: u64,
    ) -> bool {
        loop {
            let mut slice = Slice::new(self.n_done, n);
            let prepared = &self.prepared;
            match self.stage {
                Stage::Sheet(sheet) => {
                    let group = self.without_sheets.as_ref();
                    if let Some((sheets, group)) = textures.sheets.as_ref().zip(group) {
                        let what = (&context.passes.surface, sheet);
                        sheets.draw(what, group, encoder, prepared, &mut slice);
                    }
                }
                Stage::Picture => textures.draw(context, encoder, prepared, &mut slice),
                Stage::Selection => textures.draw_mask(gpu, context, encoder, prepared, &mut slice),
            }
            if slice.left() == 0 {
                self.n_done += n;
                return false;
            }
            n = slice.left();
            self.n_done = 0;
            self.stage = match self.stage {
                Stage::Sheet(Sheet::First) => Stage::Sheet(Sheet::Second),
                Stage::Sheet(Sheet::Second) => Stage::Picture,
                Stage::Picture if prepared.has_selection => Stage::Selection,
                Stage::Picture => {
                    textures.finish(encoder);
                    return true;
                }
                Stage::Selection => {
                    textures.finish(encoder);
                    textures.draw_outline(context, encoder, prepared);
                    return true;
                }
            };
        }
    }
}
