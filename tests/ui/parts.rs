//! A deck of five thousand parts: only what is seen is laid out, and the keys reach the rest.

use std::fmt::Write as _;

use egui::Key;
use egui::accesskit::Role as Kind;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use shapematch::app::{FileCommand, PartCommand, PartRef};
use shapematch::assess::Verdict;
use shapematch::role::Role;
use shapematch::text::sentence;
use shapematch::ui::Shell;

use super::bracket::write_twice;
use super::layout::texts;
use super::story::{click, finish, window};

const N_PARTS: u64 = 5_000;
const FIRST: u64 = 2_000_000;

/// Squares in a row, each a part of its own; every tenth is thicker.
fn car() -> String {
    let mut deck = String::from(
        "*KEYWORD\n*SECTION_SHELL\n1,2\n1.,1.,1.,1.\n*SECTION_SHELL\n2,2\n2.,2.,2.,2.\n",
    );
    for k in 0..N_PARTS {
        let (id, section) = (FIRST + k, if k % 10 == 0 { 2 } else { 1 });
        let _ = writeln!(deck, "*PART\npanel {k}\n{id},{section},1");
        let (x, n) = (20.0 * k as f64, 4 * k);
        let _ = writeln!(deck, "*NODE");
        for (i, (dx, dy)) in [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .iter()
            .enumerate()
        {
            let _ = writeln!(deck, "{},{},{dy},0.", n + 1 + i as u64, x + dx);
        }
        let corners = format!("{},{},{},{}", n + 1, n + 2, n + 3, n + 4);
        let _ = writeln!(deck, "*ELEMENT_SHELL\n{},{id},{corners}", k + 1);
    }
    deck + "*END\n"
}

type Window = Harness<'static, Shell>;

/// Ids of the parts whose rows are there.
fn rows(window: &Window) -> Vec<u64> {
    let mut found = Vec::new();
    let mut queue = vec![window.root()];
    while let Some(node) = queue.pop() {
        queue.extend(node.children());
        let label = node.accesskit_node().label().unwrap_or_default();
        let id = label
            .strip_prefix("Show Part ")
            .and_then(|rest| rest.split(' ').next());
        found.extend(id.and_then(|id| id.parse::<u64>().ok()));
    }
    found.sort_unstable();
    found
}

/// The titles of the columns are there.
fn has_titles(window: &Window) -> bool {
    let texts = texts(window);
    let has = |title: &&str| texts.iter().any(|text| text.text == *title);
    ["elem.", "use"].iter().all(has)
}

#[test]
fn five_thousand_parts_are_listed_filtered_and_walked_through() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("car.k");
    std::fs::write(&path, car()).unwrap();
    let mut window = window();
    let ctx = window.ctx.clone();
    let open = FileCommand::Open {
        paths: vec![path],
        role: Some(Role::Crash),
    };
    window.state_mut().run_commands(vec![open.into()], &ctx);
    finish(&mut window);
    let part = window
        .state()
        .state()
        .document
        .part(Role::Crash)
        .expect("loaded");
    assert_eq!(part.facts.parts.len() as u64, N_PARTS);

    let shown = rows(&window);
    assert!(
        (6..=14).contains(&shown.len()),
        "{} rows are laid out",
        shown.len()
    );
    assert_eq!(shown[0], FIRST);

    // Arrow keys walk past the edge of what is shown.
    window
        .get_by_label(&format!("Part {FIRST} panel 0"))
        .focus();
    window.run_steps(2);
    for _ in 0..30 {
        window.key_press(Key::ArrowDown);
        window.run_steps(3);
    }
    let reached = format!("Part {} panel 30", FIRST + 30);
    assert!(window.get_by_label(&reached).is_focused());
    window.key_press(Key::Enter);
    window.run_steps(2);
    let selected = PartRef {
        role: Role::Crash,
        id: FIRST + 30,
    };
    assert!(window.state().state().parts.selected.contains(&selected));

    // Letters typed one after the other all go into the field, the × comes and goes beside it.
    window.get_by_label("Filter parts").focus();
    window.run_steps(2);
    for letter in ["p", "a", "n"] {
        window.event(egui::Event::Text(letter.to_owned()));
        window.run_steps(2);
    }
    assert!(window.get_by_label("Filter parts").is_focused());
    let value = window.get_by_label("Filter parts").value();
    assert_eq!(value.as_deref(), Some("pan"));

    // The filter of the specification.
    for (text, n) in [
        ("2000012", 1),
        ("2000000-2000003", 4),
        ("panel 4999", 1),
        ("t>1.4", 9),
    ] {
        let field = window.get_by_label("Filter parts");
        field.focus();
        window.run_steps(1);
        window.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
        window.get_by_label("Filter parts").type_text(text);
        window.run_steps(4);
        let shown = rows(&window);
        assert!(
            shown.len() >= n && shown.len() <= n + 4,
            "{text}: {shown:?}"
        );
        assert!(has_titles(&window), "{text}: one row of many has them too");
    }

    // One click makes a part the one that is matched.
    let use_only = PartCommand::UseOnly(selected);
    window.state_mut().run_commands(vec![use_only.into()], &ctx);
    finish(&mut window);
    let part = window
        .state()
        .state()
        .document
        .part(Role::Crash)
        .expect("loaded");
    assert_eq!(part.facts.used.len(), 1);
}

#[test]
fn a_result_that_fits_several_parts_has_a_button_for_each() {
    let folder = tempfile::tempdir().unwrap();
    write_twice(folder.path());
    let mut window = window();
    let ctx = window.ctx.clone();
    for (name, role) in [("twice.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        let open = FileCommand::Open {
            paths: vec![folder.path().join(name)],
            role: Some(role),
        };
        window.state_mut().run_commands(vec![open.into()], &ctx);
        finish(&mut window);
    }
    // Of two that are equally alike none is proposed.
    assert!(window.query_by_label("Match all as one").is_some());
    assert!(window.query_by_label("Match only this").is_none());
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    finish(&mut window);
    let verdict = |window: &Window| {
        let result = window.state().state().document.current_result();
        result.expect("a result").verdict()
    };
    assert_eq!(verdict(&window), Verdict::Check);
    // Section 4 says why in the words of the card. There is room for it.
    window.set_size(egui::vec2(1400.0, 1800.0));
    window.run_steps(4);
    let state = window.state().state();
    let reasons = &state
        .document
        .current_result()
        .unwrap()
        .run
        .assessment
        .reasons;
    let why = sentence(&state.reason_words(&reasons[0]));
    assert!(window.query_by_label(&why).is_some(), "{why}");
    assert_eq!(
        state.match_doubt(0).map(|why| sentence(&why)),
        Some(why.clone())
    );
    let pose = format!("Pose: CHECK match. {why}");
    assert!(window.query_by_label(&pose).is_some(), "{pose}");
    let (role, ids) = (Role::Crash, [2_000_040, 52_000_040]);
    let document = &window.state().state().document;
    let titles = ids.map(|id| document.part_title(PartRef { role, id }));
    for title in &titles {
        window.get_by_role_and_label(Kind::Button, title);
    }
    click(&mut window, &titles[1]);
    finish(&mut window);
    assert_eq!(verdict(&window), Verdict::Good);
    let crash = window.state().state().document.part(role).unwrap();
    assert!(crash.facts.used.iter().eq(&[ids[1]]));
    assert!(window.query_by_label(&titles[0]).is_none());
}
