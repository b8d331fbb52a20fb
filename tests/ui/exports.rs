//! The export menu and the dialog of a picture, by name.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{Dialog, PictureSize, PictureWindows};
use shapematch::ui::Shell;

use super::story::{click, finish, window};
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
