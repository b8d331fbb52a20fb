//! A model written as a deck and read again is the same model, in every width of columns.

use std::path::Path;

use proptest::prelude::*;
use shapematch::formats::keyword::write::{WriteOptions, write};
use shapematch::formats::model::{
    Material, Nodes, Part, Plies, Section, Set, Shell, ShellControl, ShellExtra, ShellFormulation,
    Solid, SolidKind, StrainPoint, StressPoint,
};
use shapematch::formats::moved::moved;
use shapematch::formats::{Memory, Model, ReadOptions, read_from};
use shapematch::geometry::{Point3, Pose, Similarity, Vector3};
use shapematch::monitor::Monitor;

fn again(model: &Model) -> Model {
    let (back, findings) = read_back(model);
    assert!(findings.is_empty(), "{}", findings.join("\n"));
    back
}

/// A model written and read again, and what is told of it.
fn read_back(model: &Model) -> (Model, Vec<String>) {
    let bytes = write(model, &WriteOptions::default(), &Monitor::silent()).unwrap();
    let source = Memory::new().with("out.k", bytes);
    let options = ReadOptions::default();
    let back = read_from(&source, Path::new("out.k"), &options, &Monitor::silent()).unwrap();
    let findings = back.diagnostics.iter().map(ToString::to_string).collect();
    (back, findings)
}

/// One of everything; ids begin at `first`.
fn everything(first: u64) -> Model {
    let ids = (first..first + 16).collect();
    let mut model = Model {
        title: "all there is".into(),
        nodes: Nodes::new(ids, positions()).0,
        ..Model::default()
    };
    add_parts(&mut model);
    add_elements(&mut model, first);
    add_sets(&mut model, first);
    add_forming(&mut model, first);
    model
}

fn positions() -> Vec<Point3> {
    let at = |i: i32| {
        Point3::new(
            f64::from(i) * 0.1,
            f64::from(i * i) * 1e-3,
            1.0 / f64::from(i + 3),
        )
    };
    (0..16).map(at).collect()
}

fn add_parts(model: &mut Model) {
    let part = |id: u64| Part {
        id,
        title: format!("part {id}"),
        section_id: 3,
        material_id: 0,
        thickness: Some([1.25, 1.25, 1.5, 1.25]),
        plies: None,
        is_defined: true,
    };
    model.parts = vec![part(1), part(2)];
    model.parts[1].section_id = 0;
    model.parts[1].thickness = None;
    model.sections = vec![Section {
        id: 3,
        thickness: [1.25, 1.25, 1.5, 1.25],
        nloc: 0.0,
        formulation: ShellFormulation {
            elform: -16,
            n_layers: 5,
            own_rule: None,
            is_trapezoidal: false,
        },
    }];
}

fn add_elements(model: &mut Model, first: u64) {
    let shell = |n: u64, nodes: [u32; 4]| Shell {
        id: first + n,
        nodes,
        part: 0,
    };
    model.shells = vec![
        shell(0, [0, 1, 2, 3]),
        shell(1, [4, 5, 6, 6]),
        shell(2, [8, 9, 10, 11]),
        shell(3, [1, 2, 3, 3]),
    ];
    model.mid_side = vec![(2, [12, 13, 14, 15])];
    let extra = |shell: u32, beta: f64| ShellExtra {
        shell,
        thickness: [1.1, 1.2, 1.3, 1.4],
        beta,
        plies: None,
    };
    model.shell_extras = vec![extra(0, 0.0), extra(2, 30.0)];
    let solid = |n: u64, kind: SolidKind| Solid {
        id: first + n,
        nodes: [0, 1, 2, 3, 4, 5, 6, 7],
        part: 1,
        kind,
    };
    model.solids = vec![
        solid(10, SolidKind::Solid),
        solid(11, SolidKind::ThickShell),
    ];
}

fn add_sets(model: &mut Model, first: u64) {
    let set = |ids: &[u64]| Set {
        title: "a set".into(),
        ids: ids.to_vec(),
    };
    model.sets.parts.insert(5, set(&[1, 2]));
    model
        .sets
        .nodes
        .insert(6, set(&(first..first + 11).collect::<Vec<_>>()));
    model.sets.shells.insert(7, set(&[first, first + 1]));
}

fn add_forming(model: &mut Model, first: u64) {
    let stress = |t: f64| StressPoint {
        t,
        stress: [1.5, -2.25e-4, 3e7, 0.1, 1.0 / 3.0, -1e-12],
        plastic_strain: 0.123,
    };
    let history: Vec<f64> = (0..14).map(|i| f64::from(i) / 7.0).collect();
    model
        .forming
        .add_state(first, 1, &[stress(-1.0), stress(1.0)], &history, &[])
        .unwrap();
    let strain = |t: f64| StrainPoint {
        t,
        strain: [0.01, 0.02, -0.03, 1e-5, 0.0, 0.5],
    };
    model
        .forming
        .add_strain(first + 1, 1, &[-1.0, 0.0, 1.0].map(strain));
}

#[track_caller]
fn same(a: &Model, b: &Model) {
    assert_eq!(a.title, b.title);
    assert_eq!(a.nodes.ids(), b.nodes.ids());
    for (a, b) in a.nodes.positions().iter().zip(b.nodes.positions()) {
        assert!(
            (a - b).norm() <= 1e-14 * a.coords.norm().max(1.0),
            "{a} {b}"
        );
    }
    assert_eq!(a.shells, b.shells);
    assert_eq!(a.shell_extras, b.shell_extras);
    assert_eq!(a.mid_side, b.mid_side);
    assert_eq!(a.solids, b.solids);
    assert_eq!(a.parts, b.parts);
    assert_eq!(a.sets, b.sets);
    assert_eq!(a.forming.n_stress(), b.forming.n_stress());
    assert_eq!(a.forming.n_strain(), b.forming.n_strain());
    for (a, b) in a.forming.stresses().zip(b.forming.stresses()) {
        assert_eq!(
            (a.element_id, a.n_plane, a.n_history),
            (b.element_id, b.n_plane, b.n_history)
        );
        for (a, b) in a.points.iter().zip(b.points) {
            assert_eq!((a.t, a.plastic_strain), (b.t, b.plastic_strain));
            for (a, b) in a.stress.iter().zip(b.stress) {
                assert!((a - b).abs() <= 1e-14 * a.abs().max(1.0), "{a} {b}");
            }
        }
        for (a, b) in a.history.iter().zip(b.history) {
            assert!((a - b).abs() <= 1e-14, "{a} {b}");
        }
    }
    for (a, b) in a.forming.strains().zip(b.forming.strains()) {
        assert_eq!(a, b);
    }
}

#[test]
fn everything_comes_back_in_every_width() {
    for first in [1, 100_000_000, 20_000_000_000] {
        let model = everything(first);
        same(&model, &again(&model));
    }
}

#[test]
fn formulation_and_layers_of_plies_and_what_is_known_of_materials_are_kept() {
    let mut model = everything(1);
    model.parts[0].plies = Some(Plies {
        thickness: vec![0.5, 0.25, 0.5],
        elform: 16,
        nloc: 1.0,
    });
    (model.parts[0].section_id, model.parts[0].material_id) = (0, 4);
    let material = |id: u64, law: &str, density: f64| Material {
        id,
        law: law.to_owned(),
        density,
        modulus: 2.1e5,
    };
    model.materials = vec![
        material(4, "24", 7.85e-9),
        material(5, "36E", 0.0),
        material(6, "CUSTOM_ONE", 0.0),
    ];
    let bytes = write(&model, &WriteOptions::default(), &Monitor::silent()).unwrap();
    let source = Memory::new().with("out.k", bytes);
    let options = ReadOptions::default();
    let back = read_from(&source, Path::new("out.k"), &options, &Monitor::silent()).unwrap();
    assert_eq!(back.materials, model.materials);
    assert_eq!(back.parts[0].material_id, 4);
    assert_eq!(back.parts[0].thickness, model.parts[0].thickness);
    let id = back.parts[0].section_id;
    let section = back
        .sections
        .iter()
        .find(|section| section.id == id)
        .unwrap();
    assert_eq!(
        (section.formulation.elform, section.formulation.n_layers),
        (16, 3)
    );
    assert_eq!(section.nloc, 1.0);
    // In another unit of lengths the numbers of the materials are others.
    let scaled = moved(&model, &Similarity::from_scale(25.4), 25.4);
    assert_eq!(scaled.materials[0].law, "24");
    assert_eq!(
        (scaled.materials[0].density, scaled.materials[0].modulus),
        (0.0, 0.0)
    );
}

/// What says how sections and stresses are read is kept with them.
#[test]
fn axes_and_integration_rules_are_kept() {
    let mut model = everything(1);
    model.shell_control = ShellControl {
        elform: 16,
        is_lobatto: true,
        element_axes_set: 5,
    };
    model.sections[0].formulation.own_rule = Some(77);
    let back = again(&model);
    assert_eq!(back.shell_control, model.shell_control);
    assert_eq!(back.sections, model.sections);
    let stress = |model: &Model| model.forming.stresses().next().unwrap().points[0].stress;
    let [xx, yy, zz, xy, yz, zx] = stress(&model);
    // Element axes turn with the elements; in the order 2 1 4 3 the first one points the other way.
    let turn = Similarity::from(Pose::new(Vector3::x(), Vector3::new(0.3, -1.0, 2.0)));
    assert_eq!(stress(&moved(&model, &turn, 1.0)), stress(&model));
    let mirrored = moved(&model, &turn.after(&Similarity::mirror_x()), 1.0);
    assert_eq!(stress(&mirrored), [xx, yy, zz, -xy, yz, -zx]);
    // Of another set the stresses are global.
    model.sets.parts.get_mut(&5).unwrap().ids = vec![2];
    assert_ne!(stress(&moved(&model, &turn, 1.0)), stress(&model));
}

/// The widest id decides, whatever has it.
#[test]
fn ids_of_sets_and_results_have_room() {
    let wide = 12_345_678_901;
    let mut of_set = everything(1);
    let members = Set {
        ids: vec![wide + 1, 2],
        ..Set::default()
    };
    of_set.sets.nodes.insert(8, members);
    let mut of_key = everything(1);
    of_key.sets.shells.insert(wide, Set::default());
    for model in [of_set, of_key] {
        same(&model, &again(&model));
    }
    // Results may be those of a shell that the file does not hold, which is told.
    let mut of_results = everything(1);
    of_results
        .forming
        .add_strain(wide, 1, &[StrainPoint::default()]);
    let (back, findings) = read_back(&of_results);
    same(&of_results, &back);
    assert_eq!(findings.len(), 1, "{findings:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_moved_deck_read_again_is_the_moved_model(
        shift in proptest::array::uniform3(-5000.0..5000.0f64),
        turn in proptest::array::uniform3(-3.0..3.0f64),
    ) {
        let motion = Similarity::from(Pose::new(Vector3::from(shift), Vector3::from(turn)));
        let expected = moved(&everything(1), &motion, 1.0);
        let back = again(&expected);
        prop_assert_eq!(expected.nodes.ids(), back.nodes.ids());
        for (a, b) in expected.nodes.positions().iter().zip(back.nodes.positions()) {
            prop_assert!((a - b).norm() <= 1e-10, "{} {}", a, b);
        }
        let home = moved(&back, &motion.inverse(), 1.0);
        let before = everything(1);
        for (a, b) in home.forming.stresses().zip(before.forming.stresses()) {
            for (a, b) in a.points.iter().zip(b.points) {
                for (a, b) in a.stress.iter().zip(b.stress) {
                    prop_assert!((a - b).abs() <= 1e-6, "{} {}", a, b);
                }
            }
        }
    }

    #[test]
    fn a_deck_included_under_a_transformation_is_the_moved_model(
        shift in proptest::array::uniform3(-5000.0..5000.0f64),
        axis in proptest::array::uniform3(0.1..1.0f64),
        angle in -180.0..180.0f64,
        toward in proptest::array::uniform3(0.1..1.0f64),
        is_mirrored: bool,
    ) {
        let model = everything(1);
        let deck = write(&model, &WriteOptions::default(), &Monitor::silent()).unwrap();
        let list = |v: [f64; 3]| format!("{},{},{}", v[0], v[1], v[2]);
        let mut rows = format!("TRANSL,{}\nROTATE,{},0,0,1.5,{angle}\n", list(shift), list(axis));
        if is_mirrored {
            rows += &format!("MIRROR,0,0,0,{}\n", list(toward));
        }
        let master = format!(
            "*KEYWORD\n*DEFINE_TRANSFORMATION+\n7\n{rows}*INCLUDE_TRANSFORM\nout.k\n,-0\n\n\n7\n"
        );
        let source = Memory::new().with("main.k", master).with("out.k", deck);
        let options = ReadOptions::default();
        let found = read_from(&source, Path::new("main.k"), &options, &Monitor::silent()).unwrap();
        prop_assert_eq!(found.motions.len(), 1);
        let motion = Similarity::from_matrix4(&found.motions[0].matrix, 1e-9).unwrap();
        prop_assert_eq!(motion.is_mirrored(), is_mirrored);
        let expected = moved(&model, &motion, 1.0);
        for (a, b) in expected.nodes.positions().iter().zip(found.nodes.positions()) {
            prop_assert!((a - b).norm() <= 1e-8, "{} {}", a, b);
        }
        prop_assert_eq!(&expected.shells, &found.shells);
        prop_assert_eq!(&expected.shell_extras, &found.shell_extras);
        prop_assert_eq!(&expected.solids, &found.solids);
        prop_assert_eq!(&expected.mid_side, &found.mid_side);
        let stresses = |model: &Model| -> Vec<[f64; 6]> {
            let shells = model.forming.stresses();
            shells.flat_map(|shell| shell.points.iter().map(|p| p.stress)).collect()
        };
        let strains = |model: &Model| -> Vec<[f64; 6]> {
            let shells = model.forming.strains();
            shells.flat_map(|shell| shell.points.iter().map(|p| p.strain)).collect()
        };
        let expected = [stresses(&expected), strains(&expected)].concat();
        let found = [stresses(&found), strains(&found)].concat();
        prop_assert_eq!(expected.len(), found.len());
        for (a, b) in expected.iter().flatten().zip(found.iter().flatten()) {
            prop_assert!((a - b).abs() <= 1e-6, "{} {}", a, b);
        }
    }
}
