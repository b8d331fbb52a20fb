//! Whatever keys, clicks, drags and sizes come: the window goes on. The same inputs at every run.
//!
//! A short run of them belongs to the tests; `SHAPEMATCH_MONKEY=1200` is a run of so many inputs.

use std::time::{Duration, Instant};

use egui::{
    Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, Vec2, accesskit, pos2, vec2,
};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{Dialog, FileCommand};
use shapematch::role::Role;

use super::layout::Window;
use super::story::{finish, window};

/// An input that is answered later than this stands still; generous, for slow machines.
const PATIENCE: Duration = Duration::from_secs(60);

/// Inputs of a run that nobody asked a number for.
const SHORT_RUN: usize = 200;

/// What is clicked by its name.
const CLICKED: [accesskit::Role; 5] = [
    accesskit::Role::Button,
    accesskit::Role::CheckBox,
    accesskit::Role::RadioButton,
    accesskit::Role::Tab,
    accesskit::Role::ComboBox,
];

/// Numbers that look random (SplitMix64).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.below(10_000) as f32 / 10_000.0)
    }
}

/// Keys that lead out of the window (files, images, quitting) are left out.
const KEYS: &[Key] = &[
    Key::A,
    Key::B,
    Key::C,
    Key::D,
    Key::E,
    Key::F,
    Key::G,
    Key::H,
    Key::I,
    Key::L,
    Key::M,
    Key::N,
    Key::P,
    Key::R,
    Key::T,
    Key::V,
    Key::W,
    Key::X,
    Key::Y,
    Key::Z,
    Key::Num0,
    Key::Num1,
    Key::Num3,
    Key::Num5,
    Key::Num7,
    Key::Num9,
    Key::Plus,
    Key::Minus,
    Key::PageUp,
    Key::PageDown,
    Key::Home,
    Key::ArrowLeft,
    Key::ArrowUp,
    Key::Tab,
    Key::Space,
    Key::Escape,
    Key::F1,
    Key::F5,
    Key::F11,
    Key::Enter,
    Key::Delete,
];
const MODIFIERS: &[Modifiers] = &[
    Modifiers::NONE,
    Modifiers::NONE,
    Modifiers::NONE,
    Modifiers::SHIFT,
    Modifiers::CTRL,
    Modifiers::ALT,
];
const TEXTS: &[&str] = &["12.5", "-3", "pillar", "t>1", "xyz ÄÖ", "1 0 0 0", "", "."];
const SIZES: &[Vec2] = &[
    vec2(1400.0, 900.0),
    vec2(800.0, 540.0),
    vec2(1024.0, 700.0),
    vec2(1280.0, 720.0),
    vec2(2600.0, 1400.0),
];

/// Words on buttons that lead out of the window.
fn leads_out(name: &str) -> bool {
    let words = [
        "Open", "Save", "Quit", "Write", "Recover", "recent", "Copy", "report",
    ];
    name.ends_with('…') || words.iter().any(|word| name.contains(word))
}

struct Monkey {
    window: Window,
    dice: Dice,
    /// What was done last, for the message of a failure.
    last: String,
}

impl Monkey {
    fn key(&mut self, key: Key, modifiers: Modifiers) {
        self.window.key_press_modifiers(modifiers, key);
    }

    fn place(&mut self) -> Pos2 {
        let size = self.window.ctx.content_rect().size();
        let x = self.dice.within(0.27 * size.x, size.x);
        pos2(x, self.dice.within(60.0, 0.7 * size.y))
    }

    fn press(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.window.event(Event::PointerButton {
            pos: at,
            button,
            pressed,
            modifiers,
        });
    }

    fn drag(&mut self, n_steps: usize) {
        let (from, to) = (self.place(), self.place());
        let button = self.dice.pick(&[
            PointerButton::Primary,
            PointerButton::Primary,
            PointerButton::Middle,
            PointerButton::Secondary,
        ]);
        let modifiers = self.dice.pick(MODIFIERS);
        self.last = format!("drag {button:?} {from} to {to}");
        self.window.event(Event::PointerMoved(from));
        self.press(from, button, true, modifiers);
        for step in 1..=n_steps {
            let at = from + (to - from) * (step as f32 / n_steps as f32);
            self.window.event(Event::PointerMoved(at));
            self.window.run_steps(1);
        }
        self.press(to, button, false, modifiers);
    }

    fn click_something(&mut self) {
        let root = self.window.root();
        let mut queue = vec![root];
        let mut names = Vec::new();
        while let Some(node) = queue.pop() {
            queue.extend(node.children());
            let inner = node.accesskit_node();
            let name = inner.label().unwrap_or_default();
            let is_one = CLICKED.contains(&inner.role());
            if is_one && !inner.is_disabled() && !name.is_empty() && !leads_out(&name) {
                names.push(name);
            }
        }
        if names.is_empty() {
            return;
        }
        let name = names.swap_remove(self.dice.below(names.len()));
        self.last = format!("click {name:?}");
        if let Some(node) = self.window.query_all_by_label(&name).next() {
            node.click_accesskit();
        }
    }

    fn one(&mut self) {
        match self.dice.below(20) {
            0..=6 => {
                let (key, modifiers) = (self.dice.pick(KEYS), self.dice.pick(MODIFIERS));
                self.last = format!("{modifiers:?} {key:?}");
                self.key(key, modifiers);
            }
            7..=12 => self.click_something(),
            13..=14 => self.drag(3),
            15 => {
                let text = self.dice.pick(TEXTS);
                self.last = format!("type {text:?}");
                self.window.event(Event::Text(text.to_owned()));
            }
            16 => {
                let at = self.place();
                self.last = format!("wheel at {at}");
                let delta = vec2(0.0, self.dice.within(-90.0, 90.0));
                self.window.event(Event::PointerMoved(at));
                self.window.event(Event::MouseWheel {
                    unit: MouseWheelUnit::Point,
                    delta,
                    modifiers: Modifiers::NONE,
                    phase: egui::TouchPhase::Move,
                    source: egui::MouseWheelSource::Wheel,
                });
            }
            17 => {
                let at = self.place();
                self.last = format!("click at {at}");
                self.window.event(Event::PointerMoved(at));
                for pressed in [true, false] {
                    self.press(at, PointerButton::Primary, pressed, Modifiers::NONE);
                }
            }
            18 => {
                let size = self.dice.pick(SIZES);
                self.last = format!("size {size}");
                self.window.set_size(size);
            }
            _ => {
                self.last = "Escape".to_owned();
                self.key(Key::Escape, Modifiers::NONE);
            }
        }
    }

    /// Nothing is written and no program ends: what asks for a file is closed, what may be confirmed
    /// by Enter is not left open.
    fn stay_inside(&mut self) {
        let asks = self.window.query_by_label("Path of the file").is_some();
        let dialog = self.window.state().state().view.dialog;
        let is_risky = matches!(
            dialog,
            Some(Dialog::Picture | Dialog::Unsaved | Dialog::Palette)
        );
        if asks || (is_risky && self.dice.below(3) == 0) {
            self.key(Key::Escape, Modifiers::NONE);
            self.window.run_steps(1);
        }
    }

    /// What must hold in every state.
    fn check(&self) {
        let state = self.window.state().state();
        let pose = state.document.crash_from_stamped();
        let is_sound = pose.to_rows().into_iter().flatten().all(f64::is_finite);
        assert!(is_sound, "no pose after {}", self.last);
        for (_, camera) in state.view.cameras.iter() {
            let is_sound = camera.height.is_finite() && camera.height > 0.0;
            assert!(is_sound, "no view after {}", self.last);
        }
    }
}

#[test]
fn random_inputs_leave_a_window_that_works() {
    let asked = std::env::var("SHAPEMATCH_MONKEY").ok();
    let n_inputs = asked.and_then(|n| n.parse().ok()).unwrap_or(SHORT_RUN);
    let mut monkey = Monkey {
        window: window(),
        dice: Dice(12),
        last: "the start".to_owned(),
    };
    for n in 0..n_inputs {
        // Every state comes up: from time to time the parts are there again.
        if n % 300 == 20 {
            let ctx = monkey.window.ctx.clone();
            monkey.key(Key::Escape, Modifiers::NONE);
            let open = vec![FileCommand::OpenExample.into()];
            monkey.window.state_mut().run_commands(open, &ctx);
            finish(&mut monkey.window);
        }
        let begin = Instant::now();
        monkey.one();
        monkey.window.run_steps(1);
        monkey.stay_inside();
        monkey.check();
        assert!(begin.elapsed() < PATIENCE, "no answer to {}", monkey.last);
    }
    // It still does its work.
    let ctx = monkey.window.ctx.clone();
    for _ in 0..6 {
        monkey.key(Key::Escape, Modifiers::NONE);
        monkey.window.run_steps(1);
    }
    finish(&mut monkey.window);
    let open = vec![FileCommand::OpenExample.into()];
    monkey.window.state_mut().run_commands(open, &ctx);
    finish(&mut monkey.window);
    let document = &monkey.window.state().state().document;
    assert!(Role::ALL.iter().all(|role| document.part(*role).is_some()));
}
