//! How several stamped files are seen, without a window: which are drawn, where, in which colours, and what
//! each gave to the mapping.

use std::collections::BTreeSet;

use shapematch::app::{
    Action, ColorBy, FurtherPose, HistoryCommand, MapCommand, MoveCommand, ViewCommand,
};
use shapematch::geometry::{Aabb, Similarity};
use shapematch::role::Role;

use super::app::Window;
use super::app_further::{Halves, first_further};

fn numbers(window: &Window) -> Vec<usize> {
    let shown = window.state.shown_further().into_iter();
    shown.map(|file| file.number).collect()
}

fn show(window: &mut Window, file: usize, is_shown: bool) {
    let path = window.state.stamped_rows()[file].path.clone();
    window.apply(ViewCommand::ShowFile(path, is_shown));
}

#[test]
fn each_further_file_is_seen_at_its_own_pose_unless_it_is_hidden() {
    let halves = Halves::new();
    let mut window = halves.window();
    assert!(window.state.shown_further().is_empty());
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    let shown = window.state.shown_further();
    let further = &window.state.document.mapping.further[0];
    let own = further.placing.as_ref().unwrap().crash_from_stamped;
    assert_eq!(shown[0].own_pose, Some(own));
    assert_eq!((shown.len(), shown[0].number), (1, 1));
    // The camera is fitted to it too.
    let points = shown[0].loaded.mesh.positions().iter();
    let placed: Vec<_> = points.map(|point| own.apply(point)).collect();
    let bounds = window.state.visible_bounds(Role::Stamped);
    let both = bounds.union(&Aabb::of_points(&placed));
    assert!((both.diagonal() - bounds.diagonal()).abs() < 1e-9);

    let rows = window.state.stamped_rows();
    assert!(rows.iter().all(|row| row.is_shown));
    let row_numbers: Vec<_> = rows.iter().map(|row| row.number).collect();
    assert_eq!(row_numbers, [Some(0), Some(1)]);
    let step = window.state.history.undo_name().map(str::to_owned);
    show(&mut window, 1, false);
    assert!(window.state.shown_further().is_empty());
    assert!(!window.state.stamped_rows()[1].is_shown);
    let without = window.state.visible_bounds(Role::Stamped);
    assert!(without.diagonal() < bounds.diagonal());
    show(&mut window, 1, true);
    assert_eq!(numbers(&window), [1]);
    let after = window.state.history.undo_name();
    assert_eq!(after, step.as_deref(), "no step");

    // As the first one it goes where that goes.
    let revision = first_further(&window);
    window.apply(MapCommand::SetFurtherPose(revision, FurtherPose::AsFirst));
    assert_eq!(window.state.shown_further()[0].own_pose, None);
    window.apply(HistoryCommand::Undo);
    // One file alone has no list in which it could be shown again.
    show(&mut window, 0, false);
    assert!(window.state.is_first_file_hidden());
    window.apply(MapCommand::RemoveFurther(revision));
    assert!(!window.state.is_first_file_hidden());
}

#[test]
fn a_window_that_showed_the_whole_shows_a_file_that_comes_too() {
    let halves = Halves::new();
    let right = || MapCommand::AddFurther(halves.stamped[1].clone());
    let height = |window: &Window| window.state.view.cameras.stamped.height;
    let mut window = halves.window();
    window.apply(ViewCommand::FitAll(Role::Stamped));
    let alone = height(&window);
    window.apply(right());
    assert!(height(&window) > 1.2 * alone, "{alone}");
    // Where one has gone closer, the view stays.
    let mut window = halves.window();
    window.apply(ViewCommand::FitAll(Role::Stamped));
    let mut camera = window.state.view.cameras.stamped;
    camera.height *= 0.5;
    window.apply(ViewCommand::SetCamera(Role::Stamped, camera));
    window.apply(right());
    assert_eq!(window.state.view.cameras.stamped, camera);
}

#[test]
fn further_files_are_not_seen_before_the_first_one_was_brought_to_the_crash_part() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    assert_eq!(numbers(&window), [1]);
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: Similarity::identity(),
        name: "As loaded".to_owned(),
    });
    assert!(!window.state.document.is_stamped_placed());
    assert!(window.state.shown_further().is_empty());
}

#[test]
fn the_picture_of_the_files_tells_what_each_gave() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    assert!(window.state.missing_for(ColorBy::MapFile).is_some());
    assert!(Action::ShowMapFile.enabled(&window.state).is_err());
    assert!(window.state.map_files().is_empty());
    window.act(Action::MapOrCancel);
    assert_eq!(window.state.missing_for(ColorBy::MapFile), None);
    let result = window.state.document.current_mapping().unwrap();
    let run = result.run.to_arc();
    let mapped_area = result.record.mapped_area;
    let files = window.state.map_files();
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["left.dynain", "right.dynain"]);
    let gave = |number: usize| {
        let has_values = |e: &usize| run.mapped.elements[*e].status.has_values();
        let source = |e: &usize| run.giver(*e).map(|(source, _)| source);
        let elements = (0..run.shells.len()).filter(has_values);
        let given = elements.filter(|e| source(e) == Some(number));
        given.collect::<Vec<_>>()
    };
    for file in &files {
        assert_eq!(file.n_elements, gave(file.number).len());
        assert_eq!(file.first, gave(file.number).first().copied());
        assert!(file.area_share > 0.2, "{}", file.area_share);
    }
    let whole: f64 = files.iter().map(|file| file.area_share).sum();
    assert!((whole - mapped_area).abs() < 1e-9, "{whole}");

    // Beside the picture the files stand in the same colours.
    window.act(Action::ShowMapFile);
    for role in Role::ALL {
        assert_eq!(window.state.color_by(role), ColorBy::MapFile);
    }
    assert!(window.state.is_mapping_shown());
    // A file keeps its colour until the next mapping; a new one takes another.
    let revision = first_further(&window);
    window.apply(MapCommand::RemoveFurther(revision));
    window.apply(MapCommand::AddFurther(halves.stamped[1].clone()));
    assert_eq!(numbers(&window), [2]);
    assert_eq!(window.state.map_files().len(), 2);
    window.act(Action::MapOrCancel);
    assert_eq!(numbers(&window), [1]);
    // From one file alone the quantity itself is shown.
    let revision = first_further(&window);
    window.apply(MapCommand::RemoveFurther(revision));
    window.act(Action::MapOrCancel);
    assert!(Action::ShowMapFile.enabled(&window.state).is_err());
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::Thickness);
    assert!(window.state.map_files().is_empty());
}

#[test]
fn an_element_of_a_further_file_leads_to_what_took_its_values() {
    let halves = Halves::new();
    let mut window = halves.with_both();
    window.act(Action::MapOrCancel);
    let document = &window.state.document;
    let run = document.current_mapping().unwrap().run.to_arc();
    let mut files = BTreeSet::new();
    for number in [0, 1] {
        let part = document.mapped_file(number).unwrap();
        let mut elements = 0..run.shells.len();
        let element = elements.find(|&element| run.values_from(element) == Some(number));
        let (_, shell) = run.giver(element.unwrap()).unwrap();
        let id = part.model.shells[shell].id;
        let found = document.element_mapped_from(part, id).unwrap();
        assert_eq!(run.giver(found), Some((number, shell)));
        files.insert(part.file_name());
    }
    assert_eq!(files.len(), 2);
    assert!(document.mapped_file(2).is_none());
}
