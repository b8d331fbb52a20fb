//! Section 4 through the real window: map, look at each picture, follow a check, probe an element.

use std::path::Path;
use std::process::Command as Process;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{
    Action, Axis, BottomTab, ColorBy, ExportCommand, FileCommand, FreeWindow, FurtherPose,
    HistoryCommand, MapCommand, MoveCommand, ViewCommand,
};
use shapematch::pipeline::map::WriteKind;
use shapematch::pipeline::outputs::Output;
use shapematch::role::Role;
use shapematch::samples::SampleVariant;
use shapematch::ui::Shell;
use shapematch::ui::theme::Palette;

use super::bracket::write_bracket;
use super::layout::{dismiss_toasts, faults, point_at_crash_part, texts};
use super::project::{drawn, picture};
use super::story::{click, finish, matched, window};

fn color_by(window: &Harness<'static, Shell>) -> ColorBy {
    window.state().state().color_by(Role::Crash)
}

/// The colours are means at the nodes; what is said of an element is its own value, as the probe says it.
#[test]
fn under_the_pointer_an_element_has_its_own_value() {
    let mut window = matched();
    click(&mut window, "Map");
    finish(&mut window);
    let readout = point_at_crash_part(&mut window, |rows| {
        let first = rows.iter().position(|row| row.contains("(element)"))?;
        Some(rows[first..].join(" "))
    });
    let text = readout.expect("an element under the pointer");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, id) = text.split_once("element ").unwrap();
    let id: String = id.chars().take_while(char::is_ascii_digit).collect();
    let state = window.state().state();
    let element = state.document.mapped_element(id.parse().unwrap()).unwrap();
    let run = &state.document.current_mapping().unwrap().run;
    let own = run.shown(element, &state.shown_value(ColorBy::Thickness));
    let own = state.lengths_of(Role::Crash).of(own);
    assert!(text.starts_with(&format!("{own} (element)")), "{text}");
}

#[test]
fn a_mapping_is_made_looked_at_and_followed_to_its_worst_place() {
    let mut window = matched();
    click(&mut window, "Map");
    finish(&mut window);
    let state = window.state().state();
    assert!(state.document.current_mapping().is_some());
    assert_eq!(state.view.tab, BottomTab::Mapping);
    assert_eq!(color_by(&window), ColorBy::Thickness);
    for (name, by) in [
        ("Difference", ColorBy::MapDifference),
        ("Distance", ColorBy::MapDistance),
        ("Confidence", ColorBy::MapConfidence),
        ("Status", ColorBy::MapStatus),
        ("Values", ColorBy::Thickness),
    ] {
        click(&mut window, name);
        finish(&mut window);
        assert_eq!(color_by(&window), by, "{name}");
    }
    // The legend of the statuses counts all elements.
    click(&mut window, "Status");
    finish(&mut window);
    let n = window
        .state()
        .state()
        .document
        .current_mapping()
        .map(|r| r.run.shells.len());
    let counted = shapematch::text::grouped(n.unwrap_or(0));
    let row = format!("mapped: {counted} elements, 100.0 %");
    assert!(window.query_by_label(&row).is_some(), "{row}");
    in_a_narrow_window(&mut window, |window| {
        click(window, "Legend (crash)");
        window.run_steps(4);
        assert!(
            window.query_by_label(&row).is_some(),
            "{row} behind a button"
        );
        window.key_press(egui::Key::Escape);
    });
    // Values of both sides lie on either side of a line.
    run(&mut window, ViewCommand::ToggleMoveOver);
    click(&mut window, "Values");
    finish(&mut window);
    wipe(&mut window);
    let line = "Line between mapped and stamped";
    assert!(window.query_by_label(line).is_some(), "{line}");
    click(&mut window, "Difference");
    finish(&mut window);
    assert!(window.query_by_label(line).is_none(), "{line}");
    // What stands below its buttons does not move up.
    let row = "Mapped and stamped in one window";
    assert!(window.query_by_label(row).is_some(), "{row}");
    click(&mut window, "Values");
    finish(&mut window);
    wipe(&mut window);
    run(&mut window, ViewCommand::ToggleMoveOver);
    // A check leads to its picture, with its worst place marked.
    let check = window.get_by(|node| {
        let label = node.label();
        label.is_some_and(|label| label.starts_with("Mean plastic strain: "))
    });
    check.click_accesskit();
    window.run_steps(2);
    finish(&mut window);
    let state = window.state().state();
    assert_eq!(color_by(&window), ColorBy::MapDifference);
    assert_eq!(state.map_quantity(), ColorBy::PlasticStrain);
    assert!(state.looked_at().is_some());
    // A probe has its numbers and its way out.
    let ctx = window.ctx.clone();
    let probe = vec![MapCommand::Probe(Some(7)).into()];
    window.state_mut().run_commands(probe, &ctx);
    window.run_steps(2);
    let id = window.state().state().probe().map(|probe| probe.id);
    let title = format!("Element {}", id.unwrap_or(0));
    assert!(window.query_by_label(&title).is_some(), "{title}");
    for [width, height] in [[1400.0, 900.0], [1280.0, 720.0]] {
        window.set_size(egui::vec2(width, height));
        window.run_steps(3);
        let found = faults(&window);
        assert!(found.is_empty(), "{width}: {}", found.join("\n"));
    }
    click(&mut window, "End the probe");
    assert!(window.state().state().probe().is_none());
}

/// The button of section 4; section 3 has one of that name too where it is open.
fn wipe(window: &mut Harness<'static, Shell>) {
    let buttons = window.get_all_by_label("Wipe");
    buttons.last().expect("a button").click_accesskit();
    window.run_steps(2);
    finish(window);
}

/// The same window with 800 × 540 pixels and a text of 200 %, and back.
fn in_a_narrow_window(
    window: &mut Harness<'static, Shell>,
    look: impl FnOnce(&mut Harness<'static, Shell>),
) {
    run(window, ViewCommand::FoldColumn(true));
    window.set_size(egui::vec2(400.0, 270.0));
    window.run_steps(4);
    look(window);
    window.set_size(egui::vec2(1400.0, 900.0));
    run(window, ViewCommand::FoldColumn(false));
}

/// Runs a command as a click on its button does.
fn run(window: &mut Harness<'static, Shell>, command: impl Into<shapematch::app::Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![command.into()], &ctx);
    finish(window);
}

/// Clicks a field of numbers, types, and goes on.
fn type_into(window: &mut Harness<'static, Shell>, field: &str, text: &str) {
    let role = egui::accesskit::Role::SpinButton;
    window.get_by_role_and_label(role, field).click();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    if text.is_empty() {
        window.key_press(egui::Key::Backspace);
    } else {
        window.event(egui::Event::Text(text.to_owned()));
    }
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(2);
}

#[test]
fn settings_of_a_mapping_are_changed_undone_and_mark_the_result() {
    use shapematch::app::Section;
    let mut window = matched();
    click(&mut window, "Map");
    finish(&mut window);
    let stale = |window: &Harness<'static, Shell>| {
        let state = window.state().state();
        state.stale(Section::Map).is_some()
    };
    let reach = |window: &Harness<'static, Shell>| {
        let document = &window.state().state().document;
        document.mapping.recipe.options.max_distance
    };
    assert!(!stale(&window));
    let is_there = |window: &Harness<'static, Shell>| {
        let all = window.query_all_by_label("Largest distance");
        all.count() > 0
    };
    assert!(!is_there(&window), "rarely used settings are folded");
    click(&mut window, "Mapping settings");
    assert!(is_there(&window));
    type_into(&mut window, "Largest distance", "0,5 in");
    assert_eq!(reach(&window), Some(12.7));
    assert!(stale(&window));
    // An empty field and the word say the same.
    for text in ["auto", "3", ""] {
        type_into(&mut window, "Largest distance", text);
        assert_eq!(reach(&window), (text == "3").then_some(3.0), "{text:?}");
    }
    assert!(!stale(&window));
    type_into(&mut window, "Largest distance", "3");
    // What was typed into the form is one step, the mapping another.
    let undo = Action::Undo.command(window.state().state());
    run(&mut window, undo.expect("a step"));
    assert_eq!(reach(&window), None);
    let redo = Action::Redo.command(window.state().state());
    run(&mut window, redo.expect("a step"));
    assert_eq!(reach(&window), Some(3.0));
    let project = window.state().state().to_project(0);
    assert_eq!(project.mapping.options.max_distance, Some(3.0));
    click(&mut window, "Map");
    finish(&mut window);
    assert!(!stale(&window));
    dismiss_toasts(&mut window);
    for size in [[1400.0, 900.0], [1280.0, 720.0], [853.0, 480.0]] {
        window.set_size(egui::Vec2::from(size));
        window.run_steps(3);
        let found = faults(&window);
        assert!(found.is_empty(), "{size:?}: {}", found.join("\n"));
    }
}

/// The bracket as decks in a folder, opened and matched.
fn matched_bracket(folder: &Path) -> Harness<'static, Shell> {
    matched_bracket_in(window(), folder)
}

/// The same in a window of one's own.
fn matched_bracket_in(
    mut window: Harness<'static, Shell>,
    folder: &Path,
) -> Harness<'static, Shell> {
    write_bracket(folder, SampleVariant::Plain);
    for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        let (paths, role) = (vec![folder.join(name)], Some(role));
        run(&mut window, FileCommand::Open { paths, role });
    }
    click(&mut window, "Match the parts");
    finish(&mut window);
    window
}

#[test]
fn what_the_window_writes_is_what_the_command_line_writes_byte_for_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let mut window = matched_bracket(folder.path());
    click(&mut window, "Strain");
    click(&mut window, "Stress");
    // Settings that are not the usual ones, as they are typed.
    click(&mut window, "Mapping settings");
    type_into(&mut window, "Largest distance", "7,5");
    type_into(&mut window, "Largest angle", "40");
    let document = &window.state().state().document;
    let options = &document.mapping.recipe.options;
    assert_eq!(options.max_distance, Some(7.5));
    assert_eq!(options.max_angle_deg, 40.0);
    click(&mut window, "Map");
    finish(&mut window);
    let document = &window.state().state().document;
    let line = document.map_command_line().expect("both parts");
    let usual = "--quantities thickness,plastic,strain,stress --max-distance 7.5 --max-angle 40.0";
    assert!(line.ends_with(usual), "{line}");
    let program = env!("CARGO_BIN_EXE_shapematch");
    let line = line.replacen("shapematch", program, 1);
    // All three stand beside each other in section 4 and in the palette.
    for name in ["Deck…", "Part…", "Include…"] {
        assert!(window.query_by_label(name).is_some(), "no {name}");
    }
    for kind in WriteKind::ALL {
        let of = |who: &str, end: &str| at(&format!("{who}/{}{end}", kind.name()));
        for who in ["window", "line"] {
            std::fs::create_dir_all(at(who)).expect("a folder");
        }
        let (here, there) = (of("window", ".k"), of("line", ".k"));
        let (output, path) = (Output::Mapped(kind), here.clone());
        run(&mut window, ExportCommand::Write { kind: output, path });
        let out = there.display();
        let line = format!("{line} --write {} --out '{out}'", kind.name());
        let status = Process::new("sh").args(["-c", &line]).status();
        assert!(status.is_ok_and(|status| status.success()), "{kind:?}");
        let mut files = vec![(here, there)];
        if kind == WriteKind::Include {
            files.push((of("window", "_elements.k"), of("line", "_elements.k")));
        }
        for (here, there) in files {
            let [a, b] = [&here, &there].map(|path| std::fs::read(path).expect("a file"));
            assert!(a == b && a.len() > 1000, "{here:?} is not {there:?}");
        }
    }
}

#[test]
fn several_stamped_files_stand_in_a_list_and_are_mapped_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let mut window = matched_bracket(folder.path());
    std::fs::copy(at("stamped.dynain"), at("second_blank.dynain")).expect("a folder");
    let n_files = |window: &Harness<'static, Shell>| window.state().state().stamped_rows().len();
    let has = |window: &Harness<'static, Shell>, label: &str| {
        let all = window.query_all_by_label(label);
        all.count() > 0
    };
    assert_eq!(n_files(&window), 1);
    assert!(has(&window, "Add file…") && !has(&window, "Remove stamped.dynain"));
    click(&mut window, "Mapping settings");
    assert!(!has(&window, "Overlap"), "one file overlaps no other");
    run(
        &mut window,
        MapCommand::AddFurther(at("second_blank.dynain")),
    );
    run(&mut window, MapCommand::AddFurther(at("not_there.dynain")));
    assert_eq!(n_files(&window), 3);
    for label in [
        "second_blank.dynain",
        "Pose of second_blank.dynain",
        "Remove second_blank.dynain",
        "GOOD",
        "not read",
        "Overlap",
    ] {
        assert!(has(&window, label), "no {label}");
    }
    click(&mut window, "Remove not_there.dynain");
    click(&mut window, "Pose of second_blank.dynain");
    window.run_steps(3);
    click(&mut window, "As the first");
    let pose = |window: &Harness<'static, Shell>| {
        let further = &window.state().state().document.mapping.further;
        further[0].pose
    };
    assert_eq!(pose(&window), FurtherPose::AsFirst);
    let undo = Action::Undo.command(window.state().state());
    run(&mut window, undo.expect("a step"));
    assert_eq!(pose(&window), FurtherPose::Matched);
    click(&mut window, "Map");
    finish(&mut window);
    assert!(window.state().state().document.current_mapping().is_some());
    // The probe names the file that gave the values.
    run(&mut window, MapCommand::Probe(Some(7)));
    window.run_steps(2);
    let named = window.query_all_by(|node| {
        let label = node.label().or_else(|| node.value());
        label.is_some_and(|label| label.contains(" of stamped.dynain · "))
    });
    assert!(named.count() > 0, "the probe names no file");
    dismiss_toasts(&mut window);
    for size in [[1400.0, 900.0], [1280.0, 720.0], [853.0, 480.0]] {
        window.set_size(egui::Vec2::from(size));
        window.run_steps(3);
        let found = faults(&window);
        assert!(found.is_empty(), "{size:?}: {}", found.join("\n"));
    }
    window.set_size(egui::vec2(1400.0, 900.0));
    window.run_steps(3);
    click(&mut window, "Remove second_blank.dynain");
    assert_eq!(n_files(&window), 1);
}

#[test]
fn the_menu_of_a_stamped_file_says_its_unit() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = matched_bracket(folder.path());
    let second = folder.path().join("second_blank.dynain");
    std::fs::copy(folder.path().join("stamped.dynain"), &second).expect("a folder");
    run(&mut window, MapCommand::AddFurther(second));
    let factor = |window: &Harness<'static, Shell>| {
        let further = &window.state().state().document.mapping.further;
        further[0].loaded.settings.length_factor
    };
    let first = window.state().state().units_of(Role::Stamped);
    let first = first.map_or("unknown", |known| known.units.label());
    let as_first = format!("As the first: {first}");
    for (unit, expected) in [("m, metres", 1000.0), (&*as_first, 1.0)] {
        click(&mut window, "Pose of second_blank.dynain");
        window.run_steps(3);
        click(&mut window, "Units");
        window.run_steps(3);
        click(&mut window, unit);
        finish(&mut window);
        assert_eq!(factor(&window), expected, "{unit}");
        // The row tells a unit that is not that of the first one.
        let is_told = window.query_by_label("m").is_some();
        assert_eq!(is_told, expected != 1.0, "{unit}");
    }
}

/// How much of the right 3D window has the green of the second stamped file.
fn green(window: &mut Harness<'static, Shell>) -> usize {
    finish(window);
    let picture = picture(window);
    let pixels = picture.rgba.chunks(4).enumerate();
    let right = pixels.filter(|(at, _)| at % picture.width > picture.width / 2);
    right.filter(|(_, pixel)| is_green(pixel)).count()
}

/// True if a pixel has the green of the second stamped file.
fn is_green(pixel: &[u8]) -> bool {
    let [r, g, b] = [0, 1, 2].map(|i| f32::from(pixel[i]));
    g > 50.0 && g > 2.0 * r && g > 1.1 * b && b > 0.5 * g
}

#[test]
fn the_section_cuts_every_stamped_file_that_is_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = drawn(1.0);
    window.set_size(egui::vec2(1400.0, 900.0));
    window.run_steps(3);
    let mut window = matched_bracket_in(window, folder.path());
    let second = folder.path().join("second_blank.dynain");
    std::fs::copy(folder.path().join("stamped.dynain"), &second).expect("a folder");
    run(&mut window, MapCommand::AddFurther(second));
    // Only the outlines have the colours of their files then.
    let mut display = window.state().state().view.display.clone();
    display.color_by = ColorBy::Deviation;
    run(&mut window, ViewCommand::SetDisplay(Box::new(display)));
    let before = green(&mut window);
    let section = Action::ToggleSection.command(window.state().state());
    run(&mut window, section.expect("parts to cut"));
    let shown = green(&mut window);
    assert!(shown > before + 50, "{before}, {shown} pixels");
    // The drawing names the colours.
    let swatches = |window: &Harness<'static, Shell>| {
        let named = window.query_all_by_label("second_blank.dynain");
        named.count()
    };
    let n_named = swatches(&window);
    click(&mut window, "Show second_blank.dynain");
    let hidden = green(&mut window);
    assert!(hidden < before + 10, "{before}, {hidden} pixels");
    assert_eq!(swatches(&window), n_named - 1);
}

#[test]
fn files_are_told_apart_in_both_windows_and_can_be_hidden() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let mut window = drawn(1.0);
    window.set_size(egui::vec2(1400.0, 900.0));
    window.run_steps(3);
    let mut window = matched_bracket_in(window, folder.path());
    std::fs::copy(at("stamped.dynain"), at("second_blank.dynain")).expect("a folder");
    click(&mut window, "Map");
    finish(&mut window);
    assert!(window.query_by_label("From file").is_none(), "one file");
    assert!(window.query_by_label("Show stamped.dynain").is_none());
    run(
        &mut window,
        MapCommand::AddFurther(at("second_blank.dynain")),
    );
    // So both lie in each other.
    click(&mut window, "Pose of second_blank.dynain");
    window.run_steps(3);
    click(&mut window, "As the first");
    click(&mut window, "Map");
    finish(&mut window);
    click(&mut window, "From file");
    assert_eq!(color_by(&window), ColorBy::MapFile);
    finish(&mut window);
    // The legend has a row for each file that gave something.
    for share in window.state().state().map_files() {
        let n = shapematch::text::grouped(share.n_elements);
        let begin = format!("{}: {n} elements, ", share.name);
        let row = window.query_by(|node| {
            let label = node.label();
            label.is_some_and(|label| label.starts_with(&begin))
        });
        assert_eq!(row.is_some(), share.first.is_some(), "{begin}");
    }
    // Where both lie in each other, the first is seen; without it the second is, in its colour.
    let behind = green(&mut window);
    click(&mut window, "Show stamped.dynain");
    let alone = green(&mut window);
    assert!(alone > 5000, "{alone} pixels");
    assert!(10 * behind < alone, "{behind} of {alone} pixels");
    // Beside the mapped part in one window as well.
    run(&mut window, ViewCommand::ToggleMoveOver);
    assert!(green(&mut window) > 5000);
    click(&mut window, "Show second_blank.dynain");
    let none = green(&mut window);
    assert!(none < 200, "{none} pixels");
    run(&mut window, ViewCommand::ToggleMoveOver);
    // The colours of a quantity are those of one legend.
    click(&mut window, "Show second_blank.dynain");
    click(&mut window, "Values");
    assert!(green(&mut window) < alone / 2);
    dismiss_toasts(&mut window);
    for name in ["From file", "Values"] {
        click(&mut window, name);
        for size in [[1400.0, 900.0], [1280.0, 720.0], [853.0, 480.0]] {
            window.set_size(egui::Vec2::from(size));
            window.run_steps(3);
            let found = faults(&window);
            assert!(found.is_empty(), "{size:?}: {}", found.join("\n"));
        }
        window.set_size(egui::vec2(1400.0, 900.0));
        window.run_steps(3);
    }
}

/// True of a shape, or of one within it.
pub(super) fn any_shape(shape: &egui::Shape, is_it: &dyn Fn(&egui::Shape) -> bool) -> bool {
    match shape {
        egui::Shape::Vec(shapes) => shapes.iter().any(|shape| any_shape(shape, is_it)),
        shape => is_it(shape),
    }
}

/// True if a line of a colour lies around a place.
pub(super) fn is_ringed<S>(
    window: &Harness<'static, S>,
    place: egui::Rect,
    color: egui::Color32,
) -> bool {
    let is_ring = |shape: &egui::Shape| match shape {
        egui::Shape::Rect(drawn) => {
            let corners = [drawn.rect.min - place.min, drawn.rect.max - place.max];
            let is_there = corners.iter().all(|corner| corner.length() < 1.0);
            is_there && drawn.stroke.color == color && drawn.stroke.width > 1.2
        }
        _ => false,
    };
    let shapes = &window.output().shapes;
    shapes.iter().any(|one| any_shape(&one.shape, &is_ring))
}

/// True if a rectangle in the one accent lies around the middle of a button.
fn is_primary(window: &Harness<'static, Shell>, button: &str) -> bool {
    let middle = window.get_by_label(button).rect().center();
    let accent = Palette::of_visuals(&window.ctx.global_style().visuals).accent;
    let is_below = |shape: &egui::Shape| match shape {
        egui::Shape::Rect(rect) => rect.fill == accent && rect.rect.contains(middle),
        _ => false,
    };
    let shapes = &window.output().shapes;
    shapes
        .iter()
        .any(|clipped| any_shape(&clipped.shape, &is_below))
}

#[test]
fn mapping_is_the_next_thing_to_do_only_at_a_pose_of_a_match() {
    let mut window = matched();
    let says = |window: &Harness<'static, Shell>, what: &str| {
        window.query_all_by_label_contains(what).next().is_some()
    };
    // Room for every section at once.
    window.set_size(egui::vec2(1400.0, 1800.0));
    window.run_steps(4);
    let primary = |window: &Harness<'static, Shell>| {
        ["Match the parts", "Map"].map(|button| is_primary(window, button))
    };
    assert_eq!(primary(&window), [false, true]);
    assert!(says(&window, "Pose: GOOD match"));
    run(&mut window, MoveCommand::Flip(Axis::X));
    window.run_steps(4);
    assert_eq!(primary(&window), [true, false]);
    assert!(says(&window, "Pose: moved by hand, "));
    // Nobody said yet where the part belongs: it is mapped there on purpose alone.
    run(&mut window, HistoryCommand::JumpTo(0));
    while window.state().state().document.has_both_parts().is_err() {
        run(&mut window, HistoryCommand::Redo);
    }
    window.run_steps(4);
    assert!(says(&window, "There is no match yet"));
    click(&mut window, "Map as loaded");
    finish(&mut window);
    assert!(says(&window, "Pose: as loaded, no match"));
}

#[test]
fn checks_of_a_mapping_that_is_out_of_date_say_so_in_the_tab() {
    let mut window = matched();
    click(&mut window, "Map");
    finish(&mut window);
    let says = |window: &Harness<'static, Shell>, what: &str| {
        window.query_all_by_label_contains(what).next().is_some()
    };
    assert!(!says(&window, "Checks out of date"));
    let document = &window.state().state().document;
    let mut options = document.mapping.recipe.options.clone();
    options.max_distance = Some(3.0);
    run(&mut window, MapCommand::SetOptions(Box::new(options)));
    window.run_steps(4);
    assert!(says(&window, "Checks out of date"));
    // So do the window with its values and their legend.
    let seen = texts_beside_crash(&window);
    let has = |text: &str| seen.iter().any(|seen| seen == text);
    assert!(has("mapped, out of date") && !has("mapped"), "{seen:?}");
    assert!(has("out of date") || has("out of"), "{seen:?}");
}

#[test]
fn the_left_window_says_that_its_values_are_mapped() {
    let mut window = matched();
    let titles = |window: &Harness<'static, Shell>| {
        let words = ["fixed", "mapped"];
        let seen: Vec<String> = texts(window).into_iter().map(|text| text.text).collect();
        words.map(|word| seen.iter().any(|text| text == word))
    };
    assert_eq!(titles(&window), [true, false]);
    click(&mut window, "Map");
    finish(&mut window);
    assert_eq!(titles(&window), [false, true]);
    // Of what was mapped the other pictures speak too.
    for picture in ["Difference", "Status"] {
        click(&mut window, picture);
        finish(&mut window);
        assert_eq!(titles(&window), [false, true], "{picture}");
    }
}

#[test]
fn a_section_beside_a_mapping_cuts_both_parts_and_an_empty_window_says_what_is_not_drawn() {
    let mut window = matched();
    click(&mut window, "Map");
    finish(&mut window);
    run(&mut window, ViewCommand::ToggleMoveOver);
    let says = |window: &Harness<'static, Shell>, what: &str| {
        window.query_all_by_label_contains(what).next().is_some()
    };
    run(&mut window, ViewCommand::SetFreeWindow(FreeWindow::Nothing));
    assert!(says(&window, "Not drawn: the left window shows the mapped"));
    run(&mut window, ViewCommand::SetFreeWindow(FreeWindow::Section));
    let begin = std::time::Instant::now();
    while !says(&window, "Widest gap") {
        assert!(!says(&window, "The plane meets the crash part alone"));
        assert!(begin.elapsed().as_secs() < 60, "no gap is measured");
        window.run_steps(1);
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

/// Frames until the values that are made off the frame are there.
fn draw(window: &mut Harness<'static, Shell>) {
    finish(window);
    for _ in 0..100 {
        window.run_steps(1);
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

/// The texts in the left 3D window.
fn texts_beside_crash(window: &Harness<'static, Shell>) -> Vec<String> {
    let is_crash = |label: String| label.starts_with("Crash part, ");
    let area = window.get_by(|node| node.label().is_some_and(is_crash));
    let area = area.rect();
    let seen = texts(window).into_iter();
    let inside = seen.filter(|text| area.contains_rect(text.rect));
    inside.map(|text| text.text).collect()
}

#[test]
fn a_window_without_a_part_says_nothing_of_the_colours_in_the_other() {
    let by_thickness = |window: &mut Harness<'static, Shell>| {
        let mut display = window.state().state().view.display.clone();
        display.color_by = ColorBy::Thickness;
        run(window, ViewCommand::SetDisplay(Box::new(display)));
        draw(window);
    };
    let close = FileCommand::Close(Role::Stamped);
    let mut seen = Vec::new();
    for is_closed_first in [true, false] {
        let mut window = window();
        click(&mut window, "Open the example pair");
        finish(&mut window);
        if is_closed_first {
            run(&mut window, close.clone());
            by_thickness(&mut window);
        } else {
            by_thickness(&mut window);
            run(&mut window, close.clone());
        }
        draw(&mut window);
        let mut numbers = texts_beside_crash(&window);
        numbers.retain(|text| text.parse::<f64>().is_ok());
        seen.push(numbers);
    }
    assert!(!seen[0].is_empty());
    assert_eq!(seen[0], seen[1]);
}

/// The handles stand where the part is that they move.
#[test]
fn no_handles_lie_over_a_mapped_crash_part_alone() {
    let mut window = matched();
    let act = |window: &mut Harness<'static, Shell>, action: Action| {
        let command = action.command(window.state().state()).expect("a command");
        let ctx = window.ctx.clone();
        window.state_mut().run_commands(vec![command], &ctx);
        finish(window);
        window.run_steps(4);
    };
    act(&mut window, Action::ToggleMoveOver);
    if !window.state().state().moving.has_gizmo {
        act(&mut window, Action::ToggleGizmo);
    }
    // The letters of the cube and of the buttons are smaller.
    let n_letters = |window: &Harness<'static, Shell>| {
        let letters = texts(window)
            .into_iter()
            .filter(|text| text.rect.height() > 15.0 && ["X", "Y", "Z"].contains(&&*text.text));
        letters.count()
    };
    assert!(n_letters(&window) > 0);
    act(&mut window, Action::MapOrCancel);
    assert!(window.state().state().is_mapped_alone());
    assert_eq!(n_letters(&window), 0);
}
