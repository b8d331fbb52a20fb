//! Distances between two points: commands in, what is stated and when it goes away.

use shapematch::app::*;
use shapematch::geometry::Point3;
use shapematch::role::Role;
use shapematch::units::UnitSystem;

use super::app::Window;

fn measure(window: &mut Window, ends: [(Role, [f64; 3]); 2]) {
    for (role, point) in ends {
        window.apply(InspectCommand::MeasureTo(role, Point3::from(point)));
    }
}

/// Both parts in millimetres with the tool on.
fn with_tool() -> Window {
    let mut window = Window::with_both();
    window.apply(FileCommand::SetUnits {
        role: Role::Crash,
        units: Some(UnitSystem::TonMmS.into()),
    });
    window.act(Action::MeasureDistance);
    window
}

/// The distance and the way along the axes.
fn stated(window: &Window) -> Option<[String; 2]> {
    let texts = window.state.measured_distance()?;
    Some(texts.map(|text| text.replace('\u{a0}', " ")))
}

fn expected(distance: &str, axes: &str) -> Option<[String; 2]> {
    Some([distance.to_owned(), axes.to_owned()])
}

#[test]
fn two_clicks_state_a_distance_in_the_unit_of_the_crash_deck_and_change_nothing_else() {
    let mut window = with_tool();
    let before = window.state.document.clone();
    let n_steps = window.state.history.n_done();
    assert_eq!(Action::MeasureDistance.is_on(&window.state), Some(true));
    assert_eq!(
        Action::CopyDistance.enabled(&window.state),
        Err(Reason("Measure the distance between two points first."))
    );
    assert_eq!(
        window.state.distance_prompt(),
        Some("Click the first point")
    );
    let ends = [
        (Role::Crash, [1.0, 1.0, 0.0]),
        (Role::Crash, [4.0, -3.0, 0.0]),
    ];
    window.apply(InspectCommand::MeasureTo(ends[0].0, ends[0].1.into()));
    assert_eq!(
        window.state.distance_prompt(),
        Some("Click the second point")
    );
    assert_eq!(stated(&window), None);
    window.apply(InspectCommand::MeasureTo(ends[1].0, ends[1].1.into()));
    let axes = "Δx +3.00  Δy −4.00  Δz 0 mm";
    assert_eq!(stated(&window), expected("5.00 mm", axes));
    window.act(Action::CopyDistance);
    let copied = window.effects.iter().find_map(|effect| match effect {
        Effect::CopyText(text) => Some(text.replace('\u{a0}', " ")),
        _ => None,
    });
    assert_eq!(copied.unwrap(), format!("5.00 mm, {axes}"));
    // The decimals of the preferences hold here too.
    window.state.settings.decimals = Some(1);
    let axes = "Δx +3.0  Δy −4.0  Δz 0.0 mm";
    assert_eq!(stated(&window), expected("5.0 mm", axes));
    // A third click begins anew.
    window.apply(InspectCommand::MeasureTo(ends[0].0, ends[0].1.into()));
    assert_eq!(stated(&window), None);
    assert_eq!(window.state.distance_ends().len(), 1);
    assert_eq!(window.state.document, before);
    assert_eq!(window.state.history.n_done(), n_steps);
}

#[test]
fn a_distance_is_in_the_unit_that_the_deck_names() {
    let mut window = Window::new();
    window.open("says_m.k", Role::Crash);
    window.act(Action::MeasureDistance);
    let ends = [
        (Role::Crash, [0.0, 0.0, 0.0]),
        (Role::Crash, [0.003, 0.0, 0.004]),
    ];
    measure(&mut window, ends);
    let axes = "Δx +0.00300  Δy 0  Δz +0.00400 m";
    assert_eq!(stated(&window), expected("0.00500 m", axes));
}

#[test]
fn points_of_the_stamped_part_go_with_it() {
    let mut window = with_tool();
    let (crash, stamped) = (
        (Role::Crash, [0.0, 0.0, 0.0]),
        (Role::Stamped, [3.0, 0.0, 0.0]),
    );
    measure(&mut window, [crash, stamped]);
    let axes = "Δx +3.00  Δy 0  Δz 0 mm";
    assert_eq!(stated(&window), expected("3.00 mm", axes));
    window.apply(MoveCommand::Translate {
        axis: Axis::Y,
        frame: AxisFrame::Global,
        distance: -4.0,
    });
    let axes = "Δx +3.00  Δy −4.00  Δz 0 mm";
    assert_eq!(stated(&window), expected("5.00 mm", axes));
    window.act(Action::Undo);
    assert_eq!(stated(&window).unwrap()[0], "3.00 mm");
    // Turned, the part keeps its lengths, and they are stated along the axes of the crash part.
    measure(&mut window, [stamped, (Role::Stamped, [3.0, 2.0, 0.0])]);
    window.apply(MoveCommand::Rotate {
        axis: Axis::Z,
        frame: AxisFrame::Global,
        degrees: 90.0,
    });
    let axes = "Δx −2.00  Δy 0  Δz 0 mm";
    assert_eq!(stated(&window), expected("2.00 mm", axes));
    window.apply(FileCommand::Swap);
    let ends = window.state.distance_ends();
    let roles: Vec<Role> = ends.iter().map(|(role, _)| *role).collect();
    assert_eq!(roles, [Role::Crash; 2], "they went with their part");
}

#[test]
fn escape_ends_the_tool_with_its_distance_after_what_lies_over_it() {
    let mut window = with_tool();
    let ends = [
        (Role::Crash, [0.0, 0.0, 0.0]),
        (Role::Crash, [3.0, 4.0, 0.0]),
    ];
    measure(&mut window, ends);
    window.act(Action::Help);
    window.apply(Command::Escape);
    assert_eq!(window.state.view.dialog, None);
    assert!(stated(&window).is_some());
    window.apply(Command::Escape);
    assert_eq!(window.state.inspect.distance, None);
    assert_eq!(stated(&window), None);
    // Without the tool a point is none.
    measure(&mut window, ends);
    window.act(Action::MeasureDistance);
    assert_eq!(window.state.distance_ends(), []);
}

#[test]
fn a_click_has_one_meaning() {
    let mut window = with_tool();
    window.act(Action::PairTool);
    assert!(window.state.pairs.tool.is_some());
    assert_eq!(window.state.inspect.distance, None);
    window.act(Action::MeasureDistance);
    assert_eq!(window.state.pairs.tool, None);
    assert!(window.state.inspect.distance.is_some());
}

#[test]
fn a_distance_goes_away_with_a_part_it_is_measured_on() {
    let mut window = with_tool();
    let across = [
        (Role::Crash, [0.0, 0.0, 0.0]),
        (Role::Stamped, [3.0, 4.0, 0.0]),
    ];
    measure(&mut window, across);
    window.open("panel_stamped.k", Role::Stamped);
    assert_eq!(stated(&window), None);
    assert_eq!(
        window.state.distance_prompt(),
        Some("Click the first point")
    );
    // The first point goes with its part, too.
    let [_, stamped] = across;
    window.apply(InspectCommand::MeasureTo(stamped.0, stamped.1.into()));
    window.act(Action::CloseStamped);
    assert_eq!(window.state.distance_ends(), []);
    // It does not come back with the part.
    window.act(Action::Undo);
    assert_eq!(window.state.distance_ends(), []);
    // On the other part it stays.
    let on_crash = [
        (Role::Crash, [0.0, 0.0, 0.0]),
        (Role::Crash, [3.0, 4.0, 0.0]),
    ];
    measure(&mut window, on_crash);
    window.act(Action::CloseStamped);
    assert_eq!(stated(&window).unwrap()[0], "5.00 mm");
    window.act(Action::CloseCrash);
    assert_eq!(window.state.inspect.distance, None, "nothing to measure");
    assert!(Action::MeasureDistance.enabled(&window.state).is_err());
}
