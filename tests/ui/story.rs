//! The paper's whole story through the real window: what is clicked is found by its name.

use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{LogStep, ShownGeometry, StartupOptions};
use shapematch::report::parse_matrix;
use shapematch::role::Role;
use shapematch::ui::Shell;
use shapematch::ui::preferences::{Preferences, UserFiles};

/// Longest time for one step; a slow machine is no failure, a stuck one is.
const PATIENCE: Duration = Duration::from_secs(240);

pub(crate) fn window() -> Harness<'static, Shell> {
    let options = StartupOptions {
        forget_settings: true,
        ..StartupOptions::default()
    };
    let mut window = Harness::builder()
        .with_size([1400.0, 900.0])
        .build_eframe(|cc| {
            Shell::new(cc, options, UserFiles::none(), Preferences::default()).expect("a thread")
        });
    window.run_steps(2);
    window
}

/// The window with the example pair matched.
pub(crate) fn matched() -> Harness<'static, Shell> {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Match the parts");
    finish(&mut window);
    window
}

/// Draws until the worker has nothing to do and its news are taken.
pub(crate) fn finish(window: &mut Harness<'static, Shell>) {
    let begin = Instant::now();
    loop {
        window.run_steps(1);
        if window.state().is_idle() && !window.state().state().jobs.is_busy() {
            break;
        }
        assert!(begin.elapsed() < PATIENCE, "the work does not end");
        std::thread::sleep(Duration::from_millis(5));
    }
    window.run_steps(2);
}

pub(crate) fn click(window: &mut Harness<'static, Shell>, name: &str) {
    window.get_by_label(name).click_accesskit();
    window.run_steps(2);
}

#[test]
fn load_reduce_move_over_align_match_detail_copy() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    assert!(window.state().state().document.both().is_some());

    click(&mut window, "Reduce");
    finish(&mut window);
    for role in Role::ALL {
        let part = window.state().state().document.part(role).expect("loaded");
        let level = part.level.as_ref().expect("reduced");
        assert!(level.level.mesh.n_triangles() <= 2000);
        assert!(level.deviation.get().is_some());
    }

    click(&mut window, "Move over");
    assert!(window.state().state().view.is_moved_over);
    click(&mut window, "Align surface normals");
    finish(&mut window);
    assert!(window.state().state().shown_start().is_some());
    let before = *window.state().state().document.crash_from_stamped();
    click(&mut window, "Next start");
    click(&mut window, "Use");
    assert_ne!(
        *window.state().state().document.crash_from_stamped(),
        before
    );

    click(&mut window, "Match the parts");
    finish(&mut window);
    click(&mut window, "Detailed");
    assert_eq!(window.state().state().view.shown, ShownGeometry::Detailed);
    window.get_by_label("Copy matrix").click_accesskit();
    let copied = copied_text(&mut window);
    let state = window.state().state();
    let pose = *state.document.crash_from_stamped();
    assert_eq!(parse_matrix(&copied).expect("a pose").motion, pose);

    let truth = shapematch::samples::bundled()
        .into_iter()
        .find(|file| file.name.ends_with("json"));
    if let Some(truth) = truth {
        let text = String::from_utf8_lossy(&truth.bytes).replace("crash_from_stamped", "matrix");
        let truth = parse_matrix(&text).expect("a pose").motion;
        let part = state.document.part(Role::Stamped).expect("loaded");
        let off = pose.max_displacement(&truth, &part.bounds().corners());
        assert!(off < 0.01 * part.bounds().diagonal(), "off by {off}");
    }
    for step in [
        LogStep::Load,
        LogStep::Reduce,
        LogStep::Measure,
        LogStep::Align,
        LogStep::Match,
        LogStep::Settle,
        LogStep::Verify,
        LogStep::Result,
    ] {
        assert!(
            state.log.latest(step).is_some(),
            "{step:?} is not in the log"
        );
    }
}

/// The text of the next frames' clipboard command.
fn copied_text(window: &mut Harness<'static, Shell>) -> String {
    for _ in 0..4 {
        window.step();
        for command in &window.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
    }
    panic!("nothing was copied");
}
