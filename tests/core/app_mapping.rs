//! Section 4 of the window without a window: mapping, its colours, undo, and what is written.

use shapematch::app::{
    Action, ColorBy, Effect, ExportCommand, FreeWindow, HistoryCommand, LogStep, MapCommand,
    MoveCommand, Quantity,
};
use shapematch::jobs::{JobKind, JobOutput, PipelineRunner, Runner as _};
use shapematch::mapping::Status;
use shapematch::monitor::Monitor;
use shapematch::pipeline::forming_values::{FormingValue, LayerChoice};
use shapematch::pipeline::map::{CheckReason, CheckRecord, MapRun, WriteKind};
use shapematch::pipeline::outputs::{Output, OutputInput};
use shapematch::pipeline::project::Project;
use shapematch::role::{PerRole, Role};
use shapematch::samples::SampleVariant;

use super::app::Window;
use super::bracket::write_bracket;

pub(super) fn real(kind: JobKind) -> Result<JobOutput, String> {
    let done = PipelineRunner.run(kind, &Monitor::silent());
    done.map_err(|error| error.to_string())
}

/// A window with a generated bracket at its known pose.
fn at_the_known_pose() -> (Window, tempfile::TempDir) {
    at_the_known_pose_of(SampleVariant::Plain)
}

pub(super) fn at_the_known_pose_of(variant: SampleVariant) -> (Window, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let pair = write_bracket(folder.path(), variant);
    let mut window = Window::with_files_of(folder.path(), real);
    window.apply(MoveCommand::SetPose {
        crash_from_stamped: pair.crash_from_stamped,
        name: "Known pose".to_owned(),
    });
    (window, folder)
}

#[test]
fn forming_results_are_mapped_shown_written_and_undone() {
    let (mut window, _folder) = at_the_known_pose();
    assert!(Action::SaveMappedDeck.enabled(&window.state).is_err());
    let reason = Action::CopyMapCommandLine
        .enabled(&window.state)
        .err()
        .unwrap();
    assert_eq!(reason.0, "Map the forming results first.");
    assert!(window.state.missing_for(ColorBy::PlasticStrain).is_none());
    assert!(window.state.mapped_for(ColorBy::PlasticStrain).is_none());
    window.act(Action::MapOrCancel);
    let result = window.state.document.current_mapping().unwrap();
    assert!(
        result.record.mapped_area > 0.95,
        "{:?}",
        result.record.statuses
    );
    assert!(window.state.mapped_for(ColorBy::PlasticStrain).is_some());
    assert!(window.state.mapped_for(ColorBy::Thickness).is_some());
    // Stresses were not asked for.
    assert!(window.state.mapped_for(ColorBy::VonMises).is_none());
    let (listed, n) = window.state.unmapped_elements();
    assert_eq!(
        n,
        result
            .run
            .mapped
            .elements
            .iter()
            .filter(|e| !e.status.has_values())
            .count()
    );
    assert!(listed.len() <= n);

    // What the window writes is what the command line writes.
    let document = &window.state.document;
    let input = OutputInput {
        parts: PerRole::from_fn(|role| document.part(role).map(|p| p.loaded.to_arc())),
        mapping: Some(result.run.to_arc()),
        ..OutputInput::default()
    };
    let monitor = Monitor::silent();
    let deck = Output::Mapped(WriteKind::Deck)
        .make(&input, None, &monitor)
        .unwrap();
    assert!(
        deck.notes[0].contains("read back within"),
        "{:?}",
        deck.notes
    );
    let text = String::from_utf8(deck.bytes).unwrap();
    assert!(text.contains("*ELEMENT_SHELL_THICKNESS") && text.contains("*INITIAL_STRESS_SHELL"));
    let page = Output::MapReport
        .make(&input, None, &monitor)
        .unwrap()
        .bytes;
    let page = String::from_utf8(page).unwrap();
    assert!(page.contains("What became of the elements"));
    // How the checks ended stands above the figures, and the figures write no hyphen for a minus.
    let (n_met, n_asked) = result.record.n_met();
    let head = &page[..page.find("<main>").unwrap()];
    assert!(head.contains(&format!("{n_met} of {n_asked} checks met")));
    assert!(head.contains("to stamped") && !head.contains(">-0."));
    let table = Output::MapTable.make(&input, None, &monitor).unwrap().bytes;
    let rows = String::from_utf8(table).unwrap().lines().count();
    assert_eq!(rows, result.run.shells.len() + 1);
    assert!(document.can_write(Output::MapReport));

    // A move makes it out of date, undo brings it back, and a second undo takes it away.
    window.act(Action::FlipX);
    assert!(window.state.document.current_mapping().is_none());
    assert!(window.state.stale(shapematch::app::Section::Map).is_some());
    window.apply(HistoryCommand::Undo);
    assert!(window.state.document.current_mapping().is_some());
    window.apply(HistoryCommand::Undo);
    assert!(window.state.document.mapping.result.is_none());
}

#[test]
fn quantities_are_one_step_each_and_a_running_mapping_can_be_given_up() {
    let (mut window, _folder) = at_the_known_pose();
    let mut recipe = window.state.document.mapping.recipe.clone();
    *Quantity::Stress.switch(&mut recipe.options.quantities) = true;
    window.apply(MapCommand::SetRecipe(Box::new(recipe)));
    assert_eq!(window.state.history.undo_name(), Some("Mapped quantities"));
    assert!(
        window
            .state
            .document
            .mapping
            .recipe
            .options
            .quantities
            .stress
    );
    // The samples have no history variables, and say so.
    assert!(
        window
            .state
            .document
            .lacks_quantity(Quantity::History)
            .is_some()
    );
    assert!(
        window
            .state
            .document
            .lacks_quantity(Quantity::Strain)
            .is_none()
    );
    window.holds = true;
    window.act(Action::MapOrCancel);
    assert_eq!(window.held.len(), 1);
    window.act(Action::MapOrCancel);
    assert!(window.held.is_empty());
    assert!(window.state.document.mapping.result.is_none());
    window.holds = false;
    window.act(Action::MapOrCancel);
    assert!(window.state.mapped_for(ColorBy::VonMises).is_some());
    // Choices are part of a project.
    let project = window.state.to_project(0);
    assert!(project.mapping.options.quantities.stress);
    // Without parts there is nothing to map, and the reason is told.
    let bare = Window::new();
    let reason = Action::MapOrCancel.enabled(&bare.state).unwrap_err();
    assert_eq!(reason.0, "Load both parts first.");
}

/// Plastic strain of each layer of an element, mean of its points in the plane.
fn plastic_by_layer(run: &MapRun, element: usize) -> Vec<f64> {
    let states = run.mapped.states.as_ref().unwrap().of(element);
    let n_layers = run.target.rules[run.target.rule_of[element] as usize].len();
    let n_plane = states.len() / n_layers;
    let layers = states.chunks(n_plane);
    let mean = |layer: &[[f64; 7]]| layer.iter().map(|s| s[6]).sum::<f64>() / n_plane as f64;
    layers.map(mean).collect()
}

/// A window whose bracket was mapped with stresses and strains.
pub(super) fn mapped_in_full() -> (Window, tempfile::TempDir) {
    let (mut window, folder) = at_the_known_pose();
    let mut recipe = window.state.document.mapping.recipe.clone();
    for quantity in [Quantity::Stress, Quantity::Strain] {
        *quantity.switch(&mut recipe.options.quantities) = true;
    }
    window.apply(MapCommand::SetRecipe(Box::new(recipe)));
    window.act(Action::MapOrCancel);
    assert!(window.state.document.current_mapping().is_some());
    (window, folder)
}

/// What was mapped, pinned and compared belongs to the crash part.
#[test]
fn another_crash_part_takes_the_mapping_with_it() {
    let (mut window, folder) = mapped_in_full();
    let id = window.part(Role::Crash).loaded.model.shells[0].id;
    window.apply(MapCommand::TogglePin(id));
    assert_eq!(window.state.document.mapping.pins, [id]);
    let stamped = window.part(Role::Stamped).loaded.path.clone();
    let other = folder.path().join("another.k");
    std::fs::copy(&window.part(Role::Crash).loaded.path, &other).unwrap();
    window.apply(shapematch::app::FileCommand::Open {
        paths: vec![other],
        role: Some(Role::Crash),
    });
    let mapping = &window.state.document.mapping;
    assert!(mapping.result.is_none() && mapping.pins.is_empty());
    window.act(Action::Undo);
    assert_eq!(window.state.document.mapping.pins, [id]);
    // Another stamped part leaves the pins.
    let another = folder.path().join("another.dynain");
    std::fs::copy(stamped, &another).unwrap();
    window.apply(shapematch::app::FileCommand::Open {
        paths: vec![another],
        role: Some(Role::Stamped),
    });
    let mapping = &window.state.document.mapping;
    assert!(mapping.result.is_none());
    assert_eq!(mapping.pins, [id]);
}

#[test]
fn pictures_of_a_mapping_are_chosen_and_say_what_the_values_say() {
    let (mut window, _folder) = mapped_in_full();
    // The mapping is looked at by itself.
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::Thickness);
    assert!(window.state.is_mapping_shown());
    for (action, by) in [
        (Action::ShowMapDifference, ColorBy::MapDifference),
        (Action::ShowMapDistance, ColorBy::MapDistance),
        (Action::ShowMapAngle, ColorBy::MapAngle),
        (Action::ShowMapConfidence, ColorBy::MapConfidence),
        (Action::ShowMapStatus, ColorBy::MapStatus),
    ] {
        window.act(action);
        assert_eq!(window.state.color_by(Role::Crash), by);
        // The stamped part shows the quantity itself beside it.
        assert_eq!(window.state.color_by(Role::Stamped), ColorBy::Thickness);
    }
    // Another quantity keeps the kind of picture where it speaks of one.
    window.act(Action::ShowMapDifference);
    let all = window.state.mapped_quantities();
    assert!(all.contains(&ColorBy::VonMises) && all.contains(&ColorBy::MinorStrain));
    while window.state.map_quantity() != ColorBy::PlasticStrain {
        window.act(Action::NextMapQuantity);
    }
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::MapDifference);
    assert_eq!(window.state.color_by(Role::Stamped), ColorBy::PlasticStrain);

    // Layers: by itself the mean, then each, then the mean by itself again.
    let layer = |window: &Window| window.state.shown_layer(ColorBy::PlasticStrain);
    assert_eq!(layer(&window), Some(LayerChoice::Mean));
    let result = window.state.document.current_mapping().unwrap();
    let run = result.run.to_arc();
    let element = (0..run.shells.len())
        .find(|&e| run.mapped.elements[e].status == Status::Mapped)
        .unwrap();
    let plastic = plastic_by_layer(&run, element);
    let partner = run.mapped.elements[element].partner.unwrap();
    let source = &run.sources[0];
    let (_, of_partner) = source.states.of(partner.element as usize).unwrap();
    assert!(!partner.is_flipped);
    let expect = |window: &Window, own: f64, theirs: f64| {
        let shown = window.state.shown_value(ColorBy::PlasticStrain);
        assert!((run.shown(element, &shown) - own).abs() < 1e-12);
        let difference = run.difference(element, &shown);
        assert!((difference - (own - theirs)).abs() < 1e-12, "{difference}");
    };
    expect(
        &window,
        run.plastic_strain(element),
        source.mean_plastic_strain(partner.element as usize),
    );
    window.act(Action::NextLayer);
    window.act(Action::NextLayer);
    assert_eq!(layer(&window), Some(LayerChoice::Extreme));
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NAN, f64::max);
    let theirs = largest(&mut of_partner.iter().map(|state| state[6]));
    expect(&window, largest(&mut plastic.iter().copied()), theirs);
    window.act(Action::NextLayer);
    assert_eq!(layer(&window), Some(LayerChoice::Bottom));
    expect(&window, plastic[0], of_partner[0][6]);
    window.act(Action::NextLayer);
    window.act(Action::NextLayer);
    assert_eq!(layer(&window), Some(LayerChoice::Top));
    expect(&window, plastic[plastic.len() - 1], of_partner[1][6]);

    // Picture and layer are kept with the window in a project.
    let text = serde_json::to_string(&window.state.view.display).unwrap();
    let back: shapematch::app::Display = serde_json::from_str(&text).unwrap();
    assert_eq!(back, window.state.view.display);
    // Limits of the difference are those of the quantity and layer that they were set for.
    let limits = [
        (ColorBy::MapDifference, [-0.1, 0.1]),
        (ColorBy::Thickness, [0.5, 1.0]),
    ];
    window.state.view.display.limits = limits.into_iter().collect();
    window.act(Action::NextLayer);
    assert_eq!(window.state.view.display.mapped.layer, None);
    let kept: Vec<_> = window.state.view.display.limits.keys().collect();
    assert_eq!(kept, [&ColorBy::Thickness]);

    // In one window the parts would hide each other: the stamped one stands beside.
    window.act(Action::ToggleMoveOver);
    assert_eq!(window.state.free_window(), Some(FreeWindow::Stamped));
    assert!(window.state.is_mapping_apart());
    // A move takes the mapping away, and with it its pictures.
    window.act(Action::FlipX);
    assert!(!window.state.is_mapping_shown());
    assert_ne!(window.state.free_window(), Some(FreeWindow::Stamped));
    assert!(Action::ShowMapStatus.enabled(&window.state).is_err());
    assert!(window.state.missing_for(ColorBy::MapStatus).is_some());
}

#[test]
fn a_probe_tells_both_sides_of_an_element_and_is_no_step() {
    let (mut window, _folder) = mapped_in_full();
    let result = window.state.document.current_mapping().unwrap();
    let run = result.run.to_arc();
    let crash = window.part(Role::Crash).loaded.to_arc();
    let stamped = window.part(Role::Stamped).loaded.to_arc();
    let element = run.shells.len() / 2;
    let id = crash.model.shells[run.shells[element] as usize].id;
    let document = &window.state.document;
    assert_eq!(document.mapped_element(id), Some(element));
    assert_eq!(document.mapped_element(u64::MAX), None);
    let partner = run.mapped.elements[element].partner.unwrap();
    let shell = run.source_shells[0][partner.element as usize] as usize;
    let stamped_id = stamped.model.shells[shell].id;
    // A stamped element leads to an element that took its values from it.
    let found = document.element_mapped_from(&stamped, stamped_id).unwrap();
    let of_found = run.mapped.elements[found].partner.unwrap();
    assert_eq!(of_found.element, partner.element);

    assert!(window.state.probe().is_none());
    let before = (document.clone(), window.state.history.n_done());
    window.apply(MapCommand::Probe(Some(element)));
    let after = (window.state.document.clone(), window.state.history.n_done());
    assert!(before == after, "looking is no step");
    let probe = window.state.probe().unwrap();
    assert_eq!((probe.id, probe.stamped_id), (id, Some(stamped_id)));
    let of = |by: ColorBy| probe.values.iter().find(|row| row.0 == by).unwrap().1;
    assert_eq!(of(ColorBy::Thickness)[1], run.mapped.thickness[element]);
    let source = &run.sources[0];
    let theirs = source.mean_thickness(partner.element as usize);
    assert_eq!(of(ColorBy::Thickness)[0], theirs);
    // The profile is that of the plastic strain, the first quantity with layers.
    assert_eq!(probe.profile_of, Some(ColorBy::PlasticStrain));
    let rule = &run.target.rules[run.target.rule_of[element] as usize];
    let places: Vec<f64> = probe.profile.crash.iter().map(|point| point[0]).collect();
    assert_eq!(places, rule.places());
    let values: Vec<f64> = probe.profile.crash.iter().map(|point| point[1]).collect();
    for (value, expected) in values.iter().zip(plastic_by_layer(&run, element)) {
        assert!((value - expected).abs() < 1e-15);
    }
    assert_eq!(probe.profile.stamped.len(), 2);
    // Every mapping of the same elements keeps it, and what was undone can be brought back after it.
    window.act(Action::MapOrCancel);
    assert!(window.state.probe().is_some());
    window.apply(HistoryCommand::Undo);
    assert!(window.state.probe().is_some());
    window.apply(MapCommand::Probe(Some(element + 1)));
    assert_eq!(window.state.history.n_undone(), 1);
    assert_eq!(window.state.probe().unwrap().element, element + 1);
    window.apply(HistoryCommand::Undo);
    assert!(window.state.probe().is_none(), "of no mapping");
    window.apply(HistoryCommand::Redo);
    window.apply(HistoryCommand::Redo);
    assert_eq!(window.state.probe().unwrap().element, element + 1);
    window.act(Action::EndProbe);
    assert!(window.state.probe().is_none());
    assert!(Action::EndProbe.enabled(&window.state).is_err());
}

#[test]
fn checks_name_their_picture_and_add_up_with_the_mapping() {
    let (window, _folder) = mapped_in_full();
    let result = window.state.document.current_mapping().unwrap();
    let (run, record) = (&result.run, &result.record);
    assert!(record.checks.len() >= 9, "{:?}", record.checks);
    let of = |name: &str| record.checks.iter().find(|c| c.name == name).unwrap();
    let area = of("Area with values");
    assert!(area.is_met == Some(true) && record.mapped_area > 0.95);
    // After the pose those that are not met are seen first.
    let is_met = |check: &CheckRecord| check.is_met != Some(false);
    assert_eq!(record.checks[0].name, "Pose");
    assert!(record.checks[1..].iter().is_sorted_by_key(is_met));
    // The ways back, the volume and the forces are told and not judged.
    assert_eq!(of("Thickness there and back").is_met, None);
    assert_eq!(of("Volume of the sheet").is_met, None);
    let forces = of("Forces left at nodes");
    assert_eq!(forces.is_met, None);
    assert!(forces.found.contains("(stamped "), "{}", forces.found);
    let display = window.state.with_check(forces.picture);
    assert_eq!(display.mapped.quantity, ColorBy::VonMises);
    let (n_met, n_judged) = record.n_met();
    assert_eq!(n_judged, record.checks.len() - 4);
    let met = record.checks.iter().filter(|c| c.is_met == Some(true));
    assert_eq!(n_met, met.count());
    // The bracket's radii are as small as its crash elements, whose peak is too low for the stamped one.
    let pair = record.plastic_strain.as_ref().unwrap();
    let peak = pair.crash.max / pair.stamped.max - 1.0;
    assert!(peak < -0.1, "{peak}");
    // It is judged against the stamped mean over such an element, which is as low.
    let check = of("Largest plastic strain");
    assert_eq!(check.is_met, Some(true), "{check:?}");
    assert_eq!(check.reason, Some(CheckReason::PeakNarrowerThanElement));
    assert!(
        check.limit.ends_with("of the mean there"),
        "{}",
        check.limit
    );
    assert!(of("Mean thickness").reason.is_none());
    let display = window.state.with_check(area.picture);
    assert_eq!(display.color_by, ColorBy::MapStatus);
    let thickness = of("Mean thickness");
    let display = window.state.with_check(thickness.picture);
    assert_eq!(display.color_by, ColorBy::MapDifference);
    assert_eq!(display.mapped.quantity, ColorBy::Thickness);
    // The worst place is worse than all others.
    let shown = window.state.shown_value(ColorBy::Thickness);
    let off = |element: usize| run.difference(element, &shown).abs();
    let worst = off(thickness.worst.unwrap());
    assert!((0..run.shells.len()).all(|e| off(e).is_nan() || off(e) <= worst));
    // Statuses cover all elements, histograms all of the area.
    let statuses = window.state.map_statuses();
    let n: usize = statuses.iter().map(|row| row.1).sum();
    assert_eq!(n, run.shells.len());
    let share: f64 = statuses.iter().map(|row| row.2).sum();
    assert!((share - 1.0).abs() < 1e-12);
    for pair in [&record.thickness, &record.plastic_strain, &record.von_mises] {
        for shares in &pair.as_ref().unwrap().histograms {
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
    }
}

/// What the window's outputs are made from.
pub(super) fn output_input(window: &Window) -> OutputInput {
    let document = &window.state.document;
    let result = document.current_mapping().unwrap();
    OutputInput {
        parts: PerRole::from_fn(|role| document.part(role).map(|p| p.loaded.to_arc())),
        mapping: Some(result.run.to_arc()),
        other: result.other.as_ref().map(|other| other.to_arc()),
        pins: document.mapping.pins.clone(),
        ..OutputInput::default()
    }
}

/// The mapped deck as the window writes it, with every thickness larger by a tenth of a millimetre.
pub(super) fn thicker_deck(window: &Window) -> String {
    let input = output_input(window);
    let deck = Output::Mapped(WriteKind::Deck).make(&input, None, &Monitor::silent());
    let text = String::from_utf8(deck.unwrap().bytes).unwrap();
    let mut lines = Vec::new();
    // 0 outside, 1 before an element, 2 before its thickness.
    let mut place = 0;
    for line in text.lines() {
        if line.starts_with('*') {
            place = usize::from(line.starts_with("*ELEMENT_SHELL_THICKNESS"));
        } else if place == 2 && !line.starts_with('$') {
            let fields = (0..4).map(|i| line[16 * i..16 * (i + 1)].trim().parse::<f64>().unwrap());
            lines.push(
                fields
                    .map(|t| format!("{:16.8E}", t + 0.1))
                    .collect::<String>(),
            );
            place = 1;
            continue;
        } else if place == 1 && !line.starts_with('$') {
            place = 2;
        }
        lines.push(line.to_owned());
    }
    lines.join("\n")
}

#[test]
fn a_mapping_is_compared_with_another_result_element_by_element() {
    let (mut window, folder) = mapped_in_full();
    assert!(
        Action::CompareMapping
            .enabled(&Window::new().state)
            .is_err()
    );
    assert!(Action::ShowMapOther.enabled(&window.state).is_err());
    window.act(Action::CompareMapping);
    assert!(matches!(
        window.effects.last(),
        Some(Effect::AskOtherMapping)
    ));
    let file = folder.path().join("other.k");
    std::fs::write(&file, thicker_deck(&window)).unwrap();
    window.apply(MapCommand::CompareWith(file));
    let result = window.state.document.current_mapping().unwrap();
    let record = result.record.comparison.as_ref().unwrap();
    let n_mapped = result.run.mapped.elements.iter();
    let n_mapped = n_mapped.filter(|e| e.status.has_values()).count();
    assert_eq!((record.n_both, record.n_only_here), (n_mapped, 0));
    let thickness = record.thickness.as_ref().unwrap();
    assert!((thickness.mean + 0.1).abs() < 1e-8, "{thickness:?}");
    assert!((thickness.max - 0.1).abs() < 1e-8, "{thickness:?}");
    assert!(record.plastic_strain.as_ref().unwrap().max < 1e-9);
    assert!(record.von_mises.as_ref().unwrap().max < 1e-5);
    // The picture says the same, of each quantity that both have.
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::MapOther);
    let other = result.other.as_ref().unwrap();
    let first = result.run.mapped.elements.iter();
    let element = first
        .clone()
        .position(|e| e.status == Status::Mapped)
        .unwrap();
    let off = |by| {
        let shown = window.state.shown_value(by);
        result.run.difference_to(other, element, &shown)
    };
    assert!((off(ColorBy::Thickness) + 0.1).abs() < 1e-8);
    assert!(off(ColorBy::PlasticStrain).abs() < 1e-9);
    assert!(off(ColorBy::MajorStress).abs() < 1e-5);
    for (by, record) in [
        (ColorBy::MajorStrain, &record.major_strain),
        (ColorBy::MinorStrain, &record.minor_strain),
    ] {
        assert!(off(by).abs() < 1e-8, "{by:?}");
        let record = record.as_ref().unwrap();
        assert!(record.max < 1e-8 && record.n_elements == n_mapped, "{by:?}");
        let spread = record.here.max - record.here.min;
        assert!(spread > 0.01, "{by:?} {spread}");
    }
    // The report tells of both results in pictures, the table of both thicknesses.
    let input = output_input(&window);
    let page = Output::MapReport.make(&input, None, &Monitor::silent());
    let page = String::from_utf8(page.unwrap().bytes).unwrap();
    assert!(page.contains("Beside another result"));
    assert_eq!(page.matches("<b>■ The other result,</b>").count(), 5);
    let table = Output::MapTable.make(&input, None, &Monitor::silent());
    let table = String::from_utf8(table.unwrap().bytes).unwrap();
    assert!(table.lines().next().unwrap().contains("other_thickness"));
    // One step back takes it away, and another mapping is compared with the same file.
    window.apply(HistoryCommand::Undo);
    assert!(Action::ShowMapOther.enabled(&window.state).is_err());
    window.apply(HistoryCommand::Redo);
    window.act(Action::MapOrCancel);
    let result = window.state.document.current_mapping().unwrap();
    assert!(result.record.comparison.is_some());
    // What follows from a mapping is undone with it.
    window.act(Action::ShowMapped);
    let mut recipe = window.state.document.mapping.recipe.clone();
    *Quantity::Stress.switch(&mut recipe.options.quantities) = false;
    window.apply(MapCommand::SetRecipe(recipe.into()));
    window.act(Action::MapOrCancel);
    assert_eq!(
        window.state.history.undo_name(),
        Some("Map forming results")
    );
    assert_ne!(window.state.color_by(Role::Crash), ColorBy::MapOther);
    window.apply(HistoryCommand::Undo);
    let result = window.state.document.mapping.result.as_ref().unwrap();
    assert!(result.record.comparison.is_some() && result.other.is_some());
}

#[test]
fn a_comparison_begins_with_a_quantity_that_both_have() {
    let (mut window, folder) = mapped_in_full();
    // The states of an include; the thickness stands in the file beside it.
    let made =
        Output::Mapped(WriteKind::Include).make(&output_input(&window), None, &Monitor::silent());
    let file = folder.path().join("states.k");
    std::fs::write(&file, made.unwrap().bytes).unwrap();
    assert_eq!(window.state.map_quantity(), ColorBy::Thickness);
    window.apply(MapCommand::CompareWith(file));
    let in_both = window.state.compared_quantities();
    assert!(!in_both.contains(&ColorBy::Thickness), "{in_both:?}");
    assert_eq!(window.state.map_quantity(), in_both[0]);
    assert_eq!(window.state.color_by(Role::Crash), ColorBy::MapOther);
}

#[test]
fn stresses_of_a_mapping_are_compared_where_both_sheets_have_a_layer() {
    let (window, _folder) = mapped_in_full();
    let state = &window.state;
    assert_eq!(
        state.shown_layer(ColorBy::VonMises),
        Some(LayerChoice::Middle)
    );
    assert_eq!(
        state.shown_layer(ColorBy::PlasticStrain),
        Some(LayerChoice::Mean)
    );
    assert!(state.layers_differ(ColorBy::VonMises).is_none());
    let mut window = window;
    while window.state.shown_layer(ColorBy::VonMises) != Some(LayerChoice::Top) {
        window.act(Action::NextLayer);
    }
    let run = &window.state.document.current_mapping().unwrap().run;
    let [stamped, crash] = run.outermost_layers(FormingValue::VonMises).unwrap();
    let note = window.state.layers_differ(ColorBy::VonMises);
    assert_eq!(
        note.is_some(),
        (stamped - crash).abs() > 0.01,
        "{stamped} {crash}"
    );
    // Thinning has figures as the thickness has.
    let record = &window.state.document.current_mapping().unwrap().record;
    let (thickness, thinning) = (record.thickness.as_ref(), record.thinning.as_ref());
    let flat = window.state.flat_thickness().unwrap();
    let [thickness, thinning] = [thickness, thinning].map(|pair| pair.unwrap().crash);
    assert!((thinning.mean - (1.0 - thickness.mean / flat)).abs() < 1e-9);
    assert!((thinning.max - (1.0 - thickness.min / flat)).abs() < 1e-9);
}

#[test]
fn a_project_keeps_the_file_that_mappings_are_compared_with() {
    let (mut window, folder) = mapped_in_full();
    let file = folder.path().join("other.k");
    std::fs::write(&file, thicker_deck(&window)).unwrap();
    window.apply(MapCommand::CompareWith(file));
    // Its path is seen from the folder of the project.
    let project = window.state.to_project(0);
    let at = folder.path().join("work.shapematch");
    let text = project.to_text(&at).unwrap();
    assert!(text.contains(r#""mapping_compared_with": "other.k""#));
    let (again, notes) = Project::parse(&text, &at).unwrap();
    assert_eq!(notes, [""; 0]);
    assert_eq!(again.mapping_compared_with, project.mapping_compared_with);
    assert_eq!(
        again.mapping_compared_with,
        Some(folder.path().join("other.k"))
    );
    // It is compared no longer, as one step.
    window.act(Action::EndMapComparison);
    assert!(Action::EndMapComparison.enabled(&window.state).is_err());
    assert!(Action::ShowMapOther.enabled(&window.state).is_err());
    window.act(Action::MapOrCancel);
    let result = window.state.document.current_mapping().unwrap();
    assert!(result.record.comparison.is_none());
    window.apply(HistoryCommand::Undo);
    window.apply(HistoryCommand::Undo);
    assert!(Action::ShowMapOther.enabled(&window.state).is_ok());
}

#[test]
fn an_include_of_the_window_never_replaces_a_file_that_is_read() {
    let (mut window, folder) = mapped_in_full();
    // The file of the elements beside it would be the stamped one.
    let beside = folder.path().join("stamped_elements.k");
    std::fs::hard_link(folder.path().join("stamped.dynain"), &beside).unwrap();
    let path = folder.path().join("stamped.k");
    let kind = Output::Mapped(WriteKind::Include);
    window.apply(ExportCommand::Write {
        kind,
        path: path.clone(),
    });
    assert!(!path.exists());
    let toasts = window.state.log.notices.toasts();
    let told: Vec<String> = toasts.map(|notice| notice.text.clone()).collect();
    let told = told.join("\n").to_lowercase();
    let words = "the file of elements beside it would overwrite";
    assert!(told.contains(words), "{told}");
    std::fs::remove_file(&beside).unwrap();
    window.apply(ExportCommand::Write {
        kind,
        path: path.clone(),
    });
    assert!(path.exists() && beside.exists());
    assert!(window.state.log.latest(LogStep::Export).is_some());
}

#[test]
fn a_comparison_is_given_up_or_fails_without_a_trace() {
    let (mut window, folder) = mapped_in_full();
    let nothing = folder.path().join("nothing.k");
    std::fs::write(&nothing, "*KEYWORD\n*END\n").unwrap();
    window.apply(MapCommand::CompareWith(nothing));
    let result = window.state.document.current_mapping().unwrap();
    assert!(result.other.is_none() && result.record.comparison.is_none());
    window.holds = true;
    window.apply(MapCommand::CompareWith(folder.path().join("crash.k")));
    assert_eq!(window.held.len(), 1);
    window.act(Action::CompareMapping);
    assert!(window.held.is_empty());
}
