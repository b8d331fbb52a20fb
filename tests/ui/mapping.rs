//! Section 4 through the real window: map, look at each picture, follow a check, probe an element.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use shapematch::app::{BottomTab, ColorBy, MapCommand};
use shapematch::role::Role;
use shapematch::ui::Shell;

use super::layout::faults;
use super::story::{click, finish, window};

fn color_by(window: &Harness<'static, Shell>) -> ColorBy {
    window.state().state().color_by(Role::Crash)
}

#[test]
fn a_mapping_is_made_looked_at_and_followed_to_its_worst_place() {
    let mut window = window();
    click(&mut window, "Open the example pair");
    finish(&mut window);
    click(&mut window, "Match the parts");
    finish(&mut window);
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
