//! The way through section 4 with the window as large as a small laptop's: everything that is asked for is
//! seen, nothing moves that was not asked to, numbers have their own unit.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{ColorBy, ExportCommand, MapCommand, Theme, ViewCommand};
use shapematch::pipeline::map::WriteKind;
use shapematch::pipeline::outputs::Output;
use shapematch::role::Role;
use shapematch::ui::Shell;

use super::layout::{Painted, faults, set, texts};
use super::story::{click, finish, matched};

const SIZE: egui::Vec2 = egui::vec2(1280.0, 800.0);

fn mapped() -> Harness<'static, Shell> {
    let mut window = matched();
    click(&mut window, "Map");
    finish(&mut window);
    window.set_size(SIZE);
    window.run_steps(4);
    assert!(window.state().state().document.current_mapping().is_some());
    window
}

/// Runs a command as a click on its button does.
fn run(window: &mut Harness<'static, Shell>, command: impl Into<shapematch::app::Command>) {
    let ctx = window.ctx.clone();
    window.state_mut().run_commands(vec![command.into()], &ctx);
    finish(window);
}

/// How often the unit of lengths stands in a legend.
fn n_units(window: &Harness<'static, Shell>) -> usize {
    let painted = texts(window);
    painted.iter().filter(|text| text.text == "mm").count()
}

#[test]
fn legends_have_the_unit_of_their_numbers() {
    let mut window = mapped();
    // The stamped part shows its thickness all the while.
    for (name, n) in [
        ("Values", 2),
        ("Difference", 2),
        ("Distance", 2),
        ("Angle", 1),
        ("Confidence", 1),
        ("Status", 1),
    ] {
        click(&mut window, name);
        finish(&mut window);
        // Colours are made beside the jobs, however long that takes.
        let begin = std::time::Instant::now();
        while n_units(&window) != n && begin.elapsed().as_secs() < 60 {
            std::thread::sleep(std::time::Duration::from_millis(5));
            window.run_steps(1);
        }
        assert_eq!(n_units(&window), n, "{name}");
        let degrees = texts(&window)
            .iter()
            .filter(|text| text.text == "°")
            .count();
        assert_eq!(degrees, usize::from(name == "Angle"), "{name}");
    }
    let color = |window: &Harness<'static, Shell>| window.state().state().color_by(Role::Crash);
    assert_eq!(color(&window), ColorBy::MapStatus);
    // Strains and their differences have none.
    click(&mut window, "Difference");
    let display = window
        .state()
        .state()
        .with_map_quantity(ColorBy::PlasticStrain);
    run(&mut window, ViewCommand::SetDisplay(Box::new(display)));
    assert_eq!(n_units(&window), 0);
}

#[test]
fn the_title_of_an_open_legend_lies_beside_its_buttons() {
    let mut window = mapped();
    click(&mut window, "Difference");
    finish(&mut window);
    let unfold = "Unfold the legend (crash)";
    let begin = std::time::Instant::now();
    while window.query_by_label(unfold).is_none() && begin.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(5));
        window.run_steps(1);
    }
    click(&mut window, unfold);
    window.run_steps(4);
    let title = window.get_by(|node| {
        let text = node.value();
        text.is_some_and(|text| text.starts_with("Difference of thickness"))
    });
    let title = title.rect();
    let whole = window.get_by_label("Fold the legend (crash)").rect();
    let button = window.get_by_label("Colour map (crash)").rect();
    assert!(title.right() <= button.left(), "{title} {button}");
    assert!(title.height() > button.height(), "in several lines");
    assert!(button.right() <= whole.left() && button.top() == whole.top());
}

#[test]
fn checks_are_read_whole_and_a_comparison_leaves_the_pane_as_it_is() {
    let mut window = mapped();
    for name in [
        "Distance of the sheets",
        "Confidence below 0.5",
        "Mean plastic strain",
        "Volume of the sheet",
    ] {
        let is_it = |text: &super::layout::Painted| text.text == name;
        assert!(texts(&window).iter().any(is_it), "{name} is cut");
    }
    let tabs = |window: &Harness<'static, Shell>| window.get_by_label("Timings").rect().top();
    let before = tabs(&window);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("other.k");
    let kind = Output::Mapped(WriteKind::Deck);
    run(
        &mut window,
        ExportCommand::Write {
            kind,
            path: path.clone(),
        },
    );
    run(&mut window, MapCommand::CompareWith(path));
    assert_eq!(
        window.state().state().color_by(Role::Crash),
        ColorBy::MapOther
    );
    assert!((tabs(&window) - before).abs() < 0.5, "the pane has grown");
    let largest = window.get_by(|node| {
        let label = node.label();
        label.is_some_and(|label| label.starts_with("largest "))
    });
    assert!(largest.rect().bottom() < SIZE.y - 4.0, "{}", largest.rect());
    run(&mut window, MapCommand::Probe(Some(7)));
    assert!((tabs(&window) - before).abs() < 0.5, "the pane has grown");
    // It is pinned for the report, and the pin has its way out.
    click(&mut window, "Pin the probe");
    let pins =
        |window: &Harness<'static, Shell>| window.state().state().document.mapping.pins.clone();
    let id = window.state().state().probe().map(|probe| probe.id);
    assert_eq!(pins(&window), [id.unwrap_or(0)]);
    let mut found = faults(&window);
    // A clipped row of the checks is told wider than it is drawn.
    found.retain(|fault| !fault.contains("\"largest "));
    assert!(found.is_empty(), "{}", found.join("\n"));
    click(&mut window, "Pinned elements");
    click(
        &mut window,
        &format!("Remove the pin of element {}", id.unwrap_or(0)),
    );
    assert!(pins(&window).is_empty());
}

#[test]
fn a_section_that_is_opened_is_seen_and_doubtful_elements_are_a_click_away() {
    let mut window = matched();
    window.set_size(SIZE);
    window.run_steps(3);
    // Who works in the column folds nothing by opening more.
    let at = window.get_by_label("Copy matrix").rect().center() - egui::vec2(0.0, 30.0);
    for pressed in [true, false] {
        window.event(egui::Event::PointerMoved(at));
        window.event(egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        });
        window.run_steps(2);
    }
    for _ in 0..2 {
        if window
            .query_by_label("Map")
            .is_none_or(|map| map.rect().bottom() > SIZE.y)
        {
            click(&mut window, "4 Map");
            window.run_steps(8);
        }
    }
    let map = window.get_by_label("Map").rect();
    assert!(map.bottom() < SIZE.y && map.top() > 0.0, "{map}");
    click(&mut window, "Map");
    finish(&mut window);
    click(&mut window, "Confidence");
    finish(&mut window);
    let listed = window.state().state().doubtful_elements();
    let Some(first) = listed.first() else {
        return;
    };
    let name = format!("{}  confidence {:.2}", first.id, first.confidence);
    click(&mut window, &name);
    let place = window
        .state()
        .state()
        .looked_at()
        .map(|(_, place)| place.point);
    assert_eq!(place, Some(first.center));
}

/// The charts of the pane at its first height in a window of 1280 × 720 pixels: numbers along each axis, all
/// of them whole and on no other.
#[test]
fn a_low_pane_has_whole_axes_at_every_scale() {
    let mut window = mapped();
    run(&mut window, MapCommand::Probe(Some(7)));
    for scale in [1.0, 1.5] {
        set(&mut window, Theme::Dark, scale);
        window.set_size(egui::vec2(1280.0, 720.0) / scale);
        window.run_steps(6);
        for (view, least) in [("Probe", 2), ("Distribution", 2)] {
            click(&mut window, view);
            window.run_steps(3);
            let pane = window.get_by_label(view).rect();
            let is_number = |text: &&Painted| {
                let number = text
                    .text
                    .replace(['\u{a0}', '%', ' '], "")
                    .replace('−', "-");
                number.parse::<f64>().is_ok() && text.rect.top() > pane.top() - 60.0
            };
            let all = texts(&window);
            let numbers: Vec<&Painted> = all.iter().filter(is_number).collect();
            let lowest = numbers
                .iter()
                .map(|text| text.rect.bottom())
                .fold(0.0, f32::max);
            // Those along the values stand in one row at the bottom of the chart.
            let along = numbers
                .iter()
                .filter(|text| text.rect.bottom() > lowest - 3.0);
            let along: Vec<_> = along.map(|text| (&text.text, text.rect)).collect();
            assert!(along.len() >= 2, "{view} at {scale}: {along:?}");
            let height = 720.0 / scale;
            assert!(
                lowest <= height - 1.0,
                "{view} at {scale}: {lowest} of {height}"
            );
            for text in &numbers {
                let is_whole = text.clip.expand(1.0).contains_rect(text.rect);
                let is_of_chart = text.rect.left() > along[0].1.left() - 60.0;
                assert!(
                    is_whole || !is_of_chart,
                    "{view} at {scale}: {:?} {} of {}",
                    text.text,
                    text.rect,
                    text.clip
                );
            }
            // Those upright stand right of the percentiles, and above the others.
            let beside = all.iter().find(|text| text.text == "max");
            let left = beside.map_or(pane.right(), |text| text.rect.right() - 1.0);
            let is_upright =
                |text: &&&Painted| text.rect.left() > left && text.rect.center().y < lowest - 16.0;
            let upright = numbers.iter().filter(is_upright).count();
            assert!(
                upright >= least,
                "{view} at {scale}: {upright} numbers upright"
            );
            let found = faults(&window);
            assert!(found.is_empty(), "{view} at {scale}: {}", found.join("\n"));
        }
    }
}
