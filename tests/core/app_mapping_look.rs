//! Looking at a mapping without a window: its settings, what is shown where a picture is not there, lists of
//! elements, and what is told after writing.

use shapematch::app::{
    Action, ColorBy, Effect, ExportCommand, FileCommand, FreeWindow, HistoryCommand, LogStep,
    MapCommand, MapPicture, Section, ViewCommand,
};
use shapematch::mapping::{MapMethod, Status};
use shapematch::monitor::Monitor;
use shapematch::pipeline::map::WriteKind;
use shapematch::pipeline::outputs::Output;
use shapematch::pipeline::project::Project;
use shapematch::role::Role;
use shapematch::samples::SampleVariant;

use super::app::{Window, beside_legend};
use super::app_mapping::{at_the_known_pose_of, mapped_in_full, output_input, thicker_deck};

/// A mapped bracket whose stamped part lacks the flanges of the crash part.
fn mapped_without_flanges() -> (Window, tempfile::TempDir) {
    let (mut window, folder) = at_the_known_pose_of(SampleVariant::MissingFlanges);
    window.act(Action::MapOrCancel);
    assert!(window.state.document.current_mapping().is_some());
    (window, folder)
}

#[test]
fn settings_are_one_step_mark_the_mapping_and_stand_in_its_command_line() {
    let (mut window, _folder) = mapped_without_flanges();
    let line = |window: &Window| window.state.document.map_command_line().unwrap();
    let usual = line(&window);
    assert!(
        usual.starts_with("shapematch map ") && usual.contains(" --pose "),
        "{usual}"
    );
    assert!(
        !usual.contains("--max-distance") && !usual.contains("--quantities"),
        "{usual}"
    );
    let mut options = window.state.document.mapping.recipe.options.clone();
    let usual_options = options.clone();
    options.method = MapMethod::Nearest;
    window.apply(MapCommand::SetOptions(Box::new(options.clone())));
    for reach in [3.0, 4.5] {
        options.max_distance = Some(reach);
        window.apply(MapCommand::SetOptions(Box::new(options.clone())));
    }
    let said = format!("{usual} --method nearest --max-distance 4.5");
    assert_eq!(line(&window), said);
    let stale = |window: &Window| window.state.stale(Section::Map).map(|stale| stale.reason);
    assert_eq!(
        stale(&window),
        Some("the options changed after the mapping")
    );
    window.act(Action::CopyMapCommandLine);
    let copied = window.effects.last();
    assert!(
        matches!(copied, Some(Effect::CopyText(text)) if *text == said),
        "{copied:?}"
    );
    window.act(Action::MapOrCancel);
    assert_eq!(stale(&window), None);
    // The mapping, what a slider sent, and the method.
    for name in ["Map", "Largest distance 4.50 mm", "Method "] {
        let undone = window.state.history.undo_name().unwrap();
        assert!(undone.starts_with(name), "{undone}");
        window.act(Action::Undo);
    }
    assert_eq!(window.state.document.mapping.recipe.options, usual_options);
    assert_eq!(stale(&window), None);
    window.apply(FileCommand::SetLengthFactor {
        role: Role::Crash,
        factor: 1000.0,
    });
    let reason = Action::CopyMapCommandLine.enabled(&window.state);
    assert!(reason.is_err_and(|reason| reason.0.contains("factor")));
}

#[test]
fn a_picture_that_is_not_there_gives_way_to_the_nearest_and_comes_back() {
    let (mut window, folder) = mapped_in_full();
    let file = folder.path().join("other.k");
    std::fs::write(&file, thicker_deck(&window)).unwrap();
    window.apply(MapCommand::CompareWith(file));
    let shown = |window: &Window| window.state.color_by(Role::Crash);
    assert_eq!(shown(&window), ColorBy::MapOther);
    // Without the other result: the difference to the stamped part.
    window.act(Action::EndMapComparison);
    assert_eq!(shown(&window), ColorBy::MapDifference);
    window.apply(HistoryCommand::Undo);
    assert_eq!(shown(&window), ColorBy::MapOther);
    window.apply(HistoryCommand::Undo);
    assert_eq!(shown(&window), ColorBy::MapDifference);
    // Without a mapping at this pose: the quantity itself, on both parts.
    window.act(Action::FlipX);
    for role in Role::ALL {
        assert_eq!(window.state.color_by(role), ColorBy::Thickness);
    }
    window.apply(HistoryCommand::Undo);
    assert_eq!(shown(&window), ColorBy::MapDifference);
}

#[test]
fn mapped_and_stamped_are_wiped_and_blinked_between_where_both_show_one_quantity() {
    let (mut window, _folder) = mapped_in_full();
    if !window.state.view.is_moved_over {
        window.act(Action::ToggleMoveOver);
    }
    let show = |window: &mut Window, picture| {
        let display = window.state.with_map_picture(picture);
        window.apply(ViewCommand::SetDisplay(Box::new(display)));
    };
    show(&mut window, None);
    assert!(window.state.can_compare_mapped());
    assert_eq!(window.state.mapped_wipe(), None);
    window.act(Action::ToggleWipe);
    assert_eq!(window.state.mapped_wipe(), Some(0.5));
    window.apply(ViewCommand::SetBlinking(true));
    assert!(window.state.is_mapped_blinking());
    assert_eq!(window.state.mapped_wipe(), None);
    window.apply(ViewCommand::SetBlinking(false));
    assert_eq!(window.state.mapped_wipe(), Some(0.5));
    // The stamped part has no difference to itself.
    show(&mut window, Some(MapPicture::Difference));
    assert!(!window.state.can_compare_mapped());
    assert_eq!(window.state.mapped_wipe(), None);
    // Nothing would be seen of it: the key says why, and nothing is kept.
    assert!(Action::ToggleWipe.enabled(&window.state).is_err());
    window.act(Action::ToggleWipe);
    assert_eq!(window.state.view.display.wipe, Some(0.5));
    // The stamped part would hide the colours, whatever the other window is used for.
    window.act(Action::ToggleSection);
    for free in FreeWindow::ALL {
        window.apply(ViewCommand::SetFreeWindow(free));
        assert!(window.state.is_mapping_apart(), "{free:?}");
    }
    window.apply(ViewCommand::SetFreeWindow(FreeWindow::Section));
    assert_eq!(window.state.free_window(), Some(FreeWindow::Section));
    assert!(window.state.is_mapping_apart());
    window.act(Action::ToggleMoveOver);
    assert!(!window.state.is_mapping_apart());
}

#[test]
fn mapped_and_stamped_keep_one_scale_whatever_their_legends() {
    let (mut window, _folder) = mapped_in_full();
    if window.state.view.is_moved_over {
        window.act(Action::ToggleMoveOver);
    }
    assert!(window.state.is_mapping_shown());
    window.apply(ViewCommand::FitBoth);
    let legend = |window: &mut Window, role: Role, covered: [f64; 2]| {
        window.apply(ViewCommand::SetRoom(role, beside_legend(covered)));
    };
    let (slim, status) = ([0.16, 0.6], [0.45, 0.3]);
    for role in Role::ALL {
        legend(&mut window, role, slim);
    }
    let heights = |window: &Window| {
        let cameras = &window.state.view.cameras;
        [cameras.crash.height, cameras.stamped.height]
    };
    let first = window.state.view.cameras;
    assert_eq!(heights(&window)[0], heights(&window)[1]);
    legend(&mut window, Role::Crash, status);
    assert_eq!(heights(&window)[0], heights(&window)[1]);
    assert_ne!(heights(&window)[0], first.crash.height);
    legend(&mut window, Role::Crash, slim);
    assert_eq!(window.state.view.cameras, first);
    // A window that was brought closer by hand keeps that.
    let mut close = first.stamped;
    close.height *= 0.3;
    window.apply(ViewCommand::SetCamera(Role::Stamped, close));
    legend(&mut window, Role::Crash, status);
    assert_eq!(window.state.view.cameras.stamped, close);
}

#[test]
fn the_distance_of_the_sheets_has_its_unit() {
    let (window, _folder) = mapped_in_full();
    let checks = &window
        .state
        .document
        .current_mapping()
        .unwrap()
        .record
        .checks;
    let distance = checks.iter().find(|c| c.name == "Distance of the sheets");
    let found = &distance.unwrap().found;
    assert!(found.ends_with(" mm"), "{found}");
}

#[test]
fn the_elements_that_can_be_trusted_least_are_listed_worst_first() {
    let (window, _folder) = mapped_without_flanges();
    let listed = window.state.doubtful_elements();
    let result = window.state.document.current_mapping().unwrap();
    let run = &result.run;
    let crash = &window.part(Role::Crash).loaded;
    // The plain way: all of them, sorted.
    let elements = run.mapped.elements.iter().enumerate();
    let mut all: Vec<(f64, usize)> = elements
        .filter(|(_, report)| report.status.has_values() && report.confidence < 0.995)
        .map(|(element, report)| (report.confidence, element))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    assert!(all.len() > 40, "{}", all.len());
    all.truncate(40);
    let id = |element: usize| crash.model.shells[run.shells[element] as usize].id;
    let expected: Vec<(u64, f64)> = all.iter().map(|(c, element)| (id(*element), *c)).collect();
    let found: Vec<(u64, f64)> = listed.iter().map(|e| (e.id, e.confidence)).collect();
    assert_eq!(found, expected);
    assert!(found[0].1 < found[39].1);
    // The first of them is the worst of the check.
    let checks = &result.record.checks;
    let check = checks.iter().find(|c| c.name.starts_with("Confidence"));
    let check = check.unwrap();
    let worst = check.worst.unwrap();
    assert_eq!(check.worst_element, Some(id(worst)));
    assert_eq!(run.mapped.elements[worst].confidence, found[0].1);
    // Elements without values stand in their own list.
    let (without, _) = window.state.unmapped_elements();
    assert!(!without.is_empty());
    for element in without {
        assert_ne!(element.status, Status::Mapped);
        assert!(found.iter().all(|(id, _)| *id != element.id));
    }
}

#[test]
fn the_message_after_writing_says_what_was_written_and_what_it_replaces() {
    let (mut window, folder) = mapped_in_full();
    let result = window.state.document.current_mapping().unwrap();
    let elements = &result.run.mapped.elements;
    let n = elements.iter().filter(|e| e.status.has_values()).count();
    let n = shapematch::text::grouped(n);
    let path = folder.path().join("mapped.k");
    let told = |window: &Window| {
        let toasts = window.state.log.notices.toasts();
        let texts: Vec<String> = toasts.map(|notice| notice.text.clone()).collect();
        texts.join("\n")
    };
    window.apply(ExportCommand::Write {
        kind: Output::Mapped(WriteKind::Deck),
        path: path.clone(),
    });
    let text = told(&window);
    for words in [
        format!("saved: mapped.k; {n} thicknesses, "),
        "read back within".to_owned(),
        "to be used instead of crash.k".to_owned(),
        // The folder is whole, and last, where a toast is cut.
        format!("; in {}", folder.path().display()),
    ] {
        assert!(text.contains(&words), "{words} is not in {text}");
    }
    // The row of the log still names the file alone, which it opens.
    let row = window.state.log.latest(LogStep::Export).unwrap();
    assert_eq!(row.text, format!("saved: {}", path.display()));
    window.apply(ExportCommand::Write {
        kind: Output::Mapped(WriteKind::Include),
        path: folder.path().join("include.k"),
    });
    let text = told(&window);
    let beside = folder.path().join("include_elements.k");
    let words = format!("written beside: {}, with the elements", beside.display());
    assert!(text.contains(&words), "{text}");
}

#[test]
fn pinned_elements_are_told_in_the_report_kept_in_the_project_and_undone() {
    let (mut window, folder) = mapped_in_full();
    assert!(Action::PinProbe.enabled(&window.state).is_err());
    let run = window
        .state
        .document
        .current_mapping()
        .unwrap()
        .run
        .to_arc();
    let crash = window.part(Role::Crash).loaded.to_arc();
    let id = |element: usize| crash.model.shells[run.shells[element] as usize].id;
    let elements = [run.shells.len() / 2, 3];
    for element in elements {
        window.apply(MapCommand::Probe(Some(element)));
        window.act(Action::PinProbe);
    }
    let pins = |window: &Window| window.state.document.mapping.pins.clone();
    assert_eq!(pins(&window), elements.map(id));
    // One step each; the same key takes the pin away.
    window.act(Action::PinProbe);
    assert_eq!(pins(&window), [id(elements[0])]);
    window.apply(HistoryCommand::Undo);
    assert_eq!(pins(&window), elements.map(id));

    // The report has both values, distance and ids, as the probe tells them.
    let probe = window.state.probe().unwrap();
    let input = output_input(&window);
    assert_eq!(input.pins, elements.map(id));
    let page = Output::MapReport.make(&input, None, &Monitor::silent());
    let page = String::from_utf8(page.unwrap().bytes).unwrap();
    let (_, told) = page.split_once("Pinned elements with both values").unwrap();
    let rows: Vec<&str> = told.split("<tr").collect();
    let stamped_id = probe.stamped_id.unwrap().to_string();
    for (by, [stamped, mapped]) in &probe.values {
        if *by == ColorBy::Thinning {
            continue;
        }
        let cells = [
            probe.id.to_string(),
            stamped_id.clone(),
            by.label().to_owned(),
            shapematch::text::length(*stamped),
            shapematch::text::length(*mapped),
            shapematch::text::signed(*mapped - *stamped),
        ];
        let has_all = |row: &&str| cells.iter().all(|text| row.contains(&format!(">{text}<")));
        assert!(rows.iter().any(has_all), "{cells:?}");
    }

    // A project keeps them, and one without them is written as ever.
    let project = window.state.to_project(0);
    let at = folder.path().join("work.shapematch");
    let (again, notes) = Project::parse(&project.to_text(&at).unwrap(), &at).unwrap();
    assert_eq!(
        (again.mapping_pins, notes.len()),
        (elements.map(id).to_vec(), 0)
    );
    for element in elements {
        window.apply(MapCommand::TogglePin(id(element)));
    }
    assert!(
        !window
            .state
            .to_project(0)
            .to_text(&at)
            .unwrap()
            .contains("mapping_pins")
    );
    let page = Output::MapReport.make(&output_input(&window), None, &Monitor::silent());
    let page = String::from_utf8(page.unwrap().bytes).unwrap();
    assert!(!page.contains("Pinned elements"));
}
