//! The export menu and the dialog of a picture, by name.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{Dialog, ExportCommand, PictureChoice, PictureSize, PictureWindows};
use shapematch::ui::Shell;

use super::layout::{point_at_crash_part, texts, with_legend};
use super::story::{click, finish, matched, window};
use super::typed::type_into;

#[test]
fn the_export_menu_offers_every_form_and_says_what_waits_for_a_match() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Export");
    for name in [
        "Copy as command line",
        "Save report…",
        "Save node deviations…",
        "Save LS-DYNA cards…",
        "Save image…",
        "Copy as",
        "Save matrix as",
        "Save part as",
    ] {
        // A key may stand behind the name.
        let mut found = window.query_all_by_label_contains(name);
        assert!(found.next().is_some(), "no {name}");
    }
    click(&mut window, "Copy as command line");
    assert!(
        window
            .state()
            .state()
            .log
            .notices
            .toasts()
            .any(|notice| notice.text == "Command line copied"),
        "no toast"
    );
}

#[test]
fn the_choices_of_a_picture_are_kept() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    window.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, Some(Dialog::Picture));
    click(&mut window, "3840 × 2160");
    click(&mut window, "Left window");
    click(&mut window, "Without background");
    let choice = window.state().state().settings.picture;
    assert_eq!(choice.size, PictureSize::Pixels([3840, 2160]));
    assert_eq!(choice.windows, PictureWindows::Left);
    assert!(choice.is_transparent);
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert_eq!(window.state().state().view.dialog, None);
}

#[test]
fn enter_in_the_dialog_of_a_picture_saves_it() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    let dialog = |window: &Harness<'static, Shell>| window.state().state().view.dialog;
    window.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    window.run_steps(2);
    // The Enter that ends a number is the field's.
    type_into(&mut window, "Width in pixels", "800");
    assert_eq!(dialog(&window), Some(Dialog::Picture));
    let size = window.state().state().settings.picture.size;
    assert!(matches!(size, PictureSize::Pixels([800, _])), "{size:?}");
    window.key_press(Key::Enter);
    window.run_steps(2);
    assert_eq!(dialog(&window), None);
}

#[test]
fn a_picture_with_its_legend_has_no_buttons() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = with_legend();
    let n_drawn = |window: &Harness<'static, Shell>, names: &[&str]| {
        let texts = texts(window).into_iter();
        texts.filter(|text| names.contains(&&*text.text)).count()
    };
    let buttons = [
        "Iso",
        "Link",
        "Colours",
        "Full mesh",
        "Hide outside the limits",
    ];
    let told = ["CRASH", "Deviation", "within ±", "up to date"];
    for name in buttons.iter().chain(&told) {
        assert!(n_drawn(&window, &[name]) > 0, "{name}");
    }
    let before = n_drawn(&window, &told);
    draw_picture(&mut window, &folder);
    for name in buttons {
        assert_eq!(n_drawn(&window, &[name]), 0, "{name}");
    }
    // One of them is a choice.
    assert_eq!(n_drawn(&window, &told), before - 1);
    window.run_steps(2);
    for name in buttons {
        assert!(n_drawn(&window, &[name]) > 0, "{name}");
    }
}

/// Draws the frame that a picture with legend, names and scale is taken of, which the harness has then.
fn draw_picture(window: &mut Harness<'static, Shell>, folder: &tempfile::TempDir) {
    let write = ExportCommand::WritePicture {
        choice: PictureChoice {
            overlays: Some(true),
            ..PictureChoice::default()
        },
        path: folder.path().join("image.png"),
    };
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![write.into()], &ctx);
    window.step();
}

#[test]
fn a_picture_does_not_say_what_is_under_the_pointer() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = matched();
    let is_node = |row: &String| row.contains("node\u{a0}") || row.contains("node ");
    let found = point_at_crash_part(&mut window, |rows| {
        rows.iter().find(|row| is_node(row)).cloned()
    });
    let readout = found.expect("a node under the pointer");
    let is_there = |window: &Harness<'static, Shell>| {
        let mut texts = texts(window).into_iter();
        texts.any(|text| text.text == readout)
    };
    assert!(is_there(&window), "{readout}");
    draw_picture(&mut window, &folder);
    assert!(!is_there(&window), "{readout}");
    window.run_steps(2);
    assert!(is_there(&window), "{readout}");
}
