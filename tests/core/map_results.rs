//! What `shapematch map` makes of results that are written in another way, that are not there, or that cannot
//! be.

use std::fmt::Write as _;

use super::map_decks::{Pair, crash, errors, model, stamped, stresses};

/// The stresses of shell `id` at the places T, xx = 100 T.
fn bent(id: u64, places: &[&str]) -> String {
    let mut card = format!("{id:>10}         1{:>10}\n", places.len());
    for t in places {
        let stress = format!("{}", 100.0 * t.parse::<f64>().unwrap());
        let _ = writeln!(
            card,
            "{t:>10}{stress:>10}{}{:>10}",
            "       0.0".repeat(5),
            "0.1"
        );
    }
    card
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn bending_is_kept_whatever_the_places_of_the_layers_are() {
    for places in [
        &["-1.0", "1.0"][..],
        &["-0.5", "0.5"],
        &["-1.0", "-0.5", "0.0", "0.5", "1.0"],
        &["-0.8", "-0.4", "0.0", "0.4", "0.8"],
        &["-0.906", "-0.538", "0.0", "0.538", "0.906"],
        &["-1.0", "-0.333333", "0.333333", "1.0"],
        &[
            "-1.0", "-.8", "-.6", "-.4", "-.2", "0.0", ".2", ".4", ".6", ".8", "1.0",
        ],
    ] {
        let results = format!("*INITIAL_STRESS_SHELL\n{}", bent(1, places));
        let pair = Pair::new(&crash(1, ""), &stamped(1, &results));
        let output = pair.map(&["--out", "out.k", "--layers", "5", "--quantities", "stress"]);
        assert!(output.status.success(), "{}", errors(&output));
        let written = model(&pair.path("out.k"));
        let outer = written.forming.stress(0).points[4].stress[0];
        assert!((outer - 90.618).abs() < 0.05, "{places:?}: {outer}");
    }
}

#[test]
fn a_section_of_equal_layers_gets_its_states_at_their_places() {
    let results = format!(
        "*INITIAL_STRESS_SHELL\n{}",
        bent(1, &["-.577350", ".577350"])
    );
    let equal = "     0.833         5         0         1\n";
    let deck = crash(1, "").replace("     0.833         3\n", equal);
    assert!(deck.contains(equal));
    let pair = Pair::new(&deck, &stamped(1, &results));
    let output = pair.map(&["--out", "out.k"]);
    assert!(output.status.success(), "{}", errors(&output));
    let written = model(&pair.path("out.k"));
    let points = written.forming.stress(0).points.iter();
    let places: Vec<f64> = points.map(|point| point.t).collect();
    assert_eq!(places, [-1.0, -0.5, 0.0, 0.5, 1.0]);
}

#[test]
fn figures_name_the_layer_that_both_sides_are_compared_in() {
    // Bent without a force: the stress is 100 T, so that its outermost points differ and its middle has none.
    let results = bent(1, &["-.7745967", "0.0", ".77459667"]);
    let pair = Pair::new(
        &crash(1, ""),
        &stamped(1, &format!("*INITIAL_STRESS_SHELL\n{results}")),
    );
    let options = [
        "--layers",
        "5",
        "--rule",
        "lobatto",
        "--quantities",
        "full",
        "--out",
        "out.k",
    ];
    let report = ["--report", "map.html", "--json", "map.json"];
    let output = pair.map(&[&options[..], &report].concat());
    assert!(output.status.success(), "{}", errors(&output));
    let compared = pair.map(
        &[
            &options[..6],
            &["--compare", "out.k", "--json", "other.json"],
        ]
        .concat(),
    );
    assert!(compared.status.success(), "{}", errors(&compared));
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(pair.path(name)).unwrap()).unwrap()
    };
    let record = read("map.json");
    assert_eq!(record["von_mises"]["layer"], "middle");
    assert_eq!(record["plastic_strain"]["layer"], "mean");
    assert!(record["thickness"]["layer"].is_null());
    for side in ["stamped", "crash"] {
        let most = record["von_mises"][side]["max"].as_f64().unwrap();
        assert!(most.abs() < 1e-6, "{side}: {most}");
    }
    let comparison = &read("other.json")["comparison"];
    assert_eq!(comparison["von_mises"]["layer"], "middle");
    assert_eq!(comparison["plastic_strain"]["layer"], "mean");
    let report = std::fs::read_to_string(pair.path("map.html")).unwrap();
    assert!(report.contains("Von Mises stress in the middle of the sheet"));
}

#[test]
fn quantities_that_no_file_holds_are_told_and_not_written() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    for quantity in ["history", "strain"] {
        let alone = pair.map(&["--quantities", quantity, "--out", "out.k"]);
        assert_eq!(alone.status.code(), Some(1));
        let told = "none of the results that were asked for are in stamped.dynain";
        assert!(errors(&alone).contains(told), "{}", errors(&alone));
        let quantities = format!("thickness,{quantity}");
        let both = pair.map(&["--quantities", &quantities, "--out", "out.k"]);
        assert!(both.status.success(), "{}", errors(&both));
        assert!(
            errors(&both).contains("were asked for, and no stamped file holds any"),
            "{}",
            errors(&both)
        );
        let written = model(&pair.path("out.k"));
        assert!(written.forming.is_empty(), "{quantity}");
    }
    let full = pair.map(&["--quantities", "full"]);
    assert!(!errors(&full).contains("asked for"), "{}", errors(&full));
}

#[test]
fn a_plastic_strain_that_nobody_asked_for_is_not_judged() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    let output = pair.map(&[
        "--quantities",
        "stress",
        "--csv",
        "table.csv",
        "--json",
        "map.json",
    ]);
    assert!(output.status.success(), "{}", errors(&output));
    let told = text(&output.stdout).to_lowercase();
    assert!(!told.contains("plastic"), "{told}");
    let table = std::fs::read_to_string(pair.path("table.csv")).unwrap();
    assert!(
        table.lines().skip(1).all(|line| line.ends_with(',')),
        "{table}"
    );
    let record = std::fs::read_to_string(pair.path("map.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&record).unwrap();
    assert!(record["plastic_strain"].is_null(), "{record}");
    assert_eq!(record["map_back"]["plastic_range"], 0.0);
    assert!(record["von_mises"].is_object(), "{record}");
}

/// What a run on one square with these results prints as warnings.
fn warned(results: &str, quantities: &str) -> String {
    let pair = Pair::new(&crash(1, ""), &stamped(1, results));
    let output = pair.map(&["--quantities", quantities]);
    assert!(output.status.success(), "{}", errors(&output));
    errors(&output).to_owned()
}

#[test]
fn results_that_cannot_be_are_told() {
    let shell = "*INITIAL_STRESS_SHELL\n";
    let good = warned(
        &(shell.to_owned() + &bent(1, &["-.57735", ".57735"])),
        "full",
    );
    assert!(!good.contains("stamped.dynain"), "{good}");
    let told = warned(
        &(shell.to_owned() + &bent(1, &["0.0", "0.0", "0.0"])),
        "usual",
    );
    assert!(
        told.contains("stamped.dynain: 1 doubtful result (") && told.contains("lie in one place"),
        "{told}"
    );
    let told = warned(
        &(shell.to_owned() + &bent(1, &["1.0", "2.0", "3.0"])),
        "usual",
    );
    assert!(
        told.contains("lie outside of its sheet")
            && told
                .contains("1 element gets other values but neither stresses nor plastic strains"),
        "{told}"
    );
    let negative = bent(1, &["-.57735", ".57735"]).replace("       0.1\n", "      -0.1\n");
    let told = warned(&(shell.to_owned() + &negative), "usual");
    assert!(
        told.contains("a plastic strain below 0 counts as 0"),
        "{told}"
    );
}

#[test]
fn strains_in_element_axes_are_told_where_strains_are_mapped() {
    let head = format!("{:>10}{:>10}{:>10}{:>10}{:>40}\n", 1, 1, 2, 0, 1);
    let row = |t: &str| {
        format!(
            "       0.1       0.0      -0.1{}{t:>10}\n",
            "       0.0".repeat(3)
        )
    };
    let results = format!("*INITIAL_STRAIN_SHELL\n{head}{}{}", row("-1.0"), row("1.0"));
    let told = warned(&results, "full");
    assert!(
        told.contains("stamped.dynain: 1 strain in axes of its element is left out"),
        "{told}"
    );
    let told = warned(&results, "thickness");
    assert!(!told.contains("axes"), "{told}");
    // Where nothing else is asked for, they are the reason why there is nothing.
    let pair = Pair::new(&crash(1, ""), &stamped(1, &results));
    let output = pair.map(&["--quantities", "strain"]);
    assert_eq!(output.status.code(), Some(1));
    let reason = "stamped.dynain; stamped.dynain: 1 strain in axes of its element is left out";
    assert!(errors(&output).contains(reason), "{}", errors(&output));
}

#[test]
fn stamped_elements_without_a_thickness_are_told() {
    let all = stamped(3, &stresses(1..=3));
    let thick = "             0.9".repeat(4);
    for none in ["             0.0", "            -0.9"] {
        let deck = all.replacen(&thick, &none.repeat(4), 1);
        let pair = Pair::new(&crash(3, ""), &deck);
        let output = pair.map(&["--out", "out.k"]);
        assert!(output.status.success(), "{}", errors(&output));
        assert!(
            errors(&output).contains(
                "1 element gets other values but no thickness: the stamped elements there have none above 0; the first is shell 1 of stamped.dynain"
            ),
            "{}",
            errors(&output)
        );
    }
    let silent = Pair::new(&crash(3, ""), &all).map(&[]);
    assert!(
        !errors(&silent).contains("no thickness"),
        "{}",
        errors(&silent)
    );
}

/// The form that gives an inner and an outer surface needs no T.
#[test]
fn strains_of_two_surfaces_without_places_are_mapped() {
    let row = |xx: &str| format!("{xx:>10}{}\n", "       0.0".repeat(5));
    let of = |id: u64| format!("{id:>10}\n{}{}", row("0.03"), row("0.07"));
    let results = format!("*INITIAL_STRAIN_SHELL\n{}{}", of(1), of(2));
    let pair = Pair::new(&crash(2, ""), &stamped(2, &results));
    let output = pair.map(&["--out", "out.k", "--quantities", "strain"]);
    assert!(output.status.success(), "{}", errors(&output));
    let written = model(&pair.path("out.k"));
    assert_eq!(written.forming.n_strain(), 2);
    for shell in written.forming.strains() {
        let found: Vec<[f64; 2]> = shell.points.iter().map(|p| [p.t, p.strain[0]]).collect();
        assert_eq!(found, [[-1.0, 0.03], [1.0, 0.07]]);
    }
}

/// Parameters are those of the deck that includes what is written.
#[test]
fn elements_whose_cards_hold_parameters_are_read_back_with_them() {
    let cards = "*PARAMETER\nI      pid         7\n";
    let deck = crash(2, cards).replace("     101       7", "     101    &pid");
    assert!(deck.contains("&pid"));
    let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
    for kind in ["include", "part", "deck"] {
        let output = pair.map(&["--out", "out.k", "--write", kind]);
        assert!(output.status.success(), "{kind}: {}", errors(&output));
        let told = text(&output.stdout);
        assert!(told.contains("2 thicknesses, 2 stress"), "{told}");
    }
}

#[test]
fn elements_of_one_id_are_named() {
    let twice = crash(2, "").replace("     102       7", "     101       7");
    let output = Pair::new(&twice, &stamped(2, &stresses(1..=2))).map(&["--out", "out.k"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("shell 101 is defined twice"),
        "{}",
        errors(&output)
    );
    let deck = stamped(2, &stresses(1..=1)).replace("       2       1", "       1       1");
    let output = Pair::new(&crash(2, ""), &deck).map(&[]);
    assert!(
        errors(&output).contains("stamped.dynain: 1 element with an id that another one has"),
        "{}",
        errors(&output)
    );
}

/// A dynain whose elements stand in it without their thickness too, and a deck likewise.
#[test]
fn an_element_that_is_listed_again_with_its_thickness_is_one() {
    let sheet = stamped(2, &stresses(1..=2));
    let plain = crash(2, "")
        .replace("     10", "       ")
        .replace("       7", "       1");
    let plain = &plain[plain.find("*ELEMENT_SHELL").unwrap()..plain.find("*END").unwrap()];
    for cards in [
        sheet.replace(
            "*ELEMENT_SHELL_THICKNESS",
            &format!("{plain}*ELEMENT_SHELL_THICKNESS"),
        ),
        sheet.replace(
            "*ELEMENT_SHELL_THICKNESS",
            &format!("{plain}{plain}*ELEMENT_SHELL_THICKNESS"),
        ),
    ] {
        let pair = Pair::new(&crash(2, ""), &cards);
        let output = pair.map(&["--out", "out.k", "--quantities", "full"]);
        assert!(output.status.success());
        assert_eq!(errors(&output), "");
        let told = text(&output.stdout);
        assert!(told.contains("2 thicknesses, 2 stress"), "{told}");
        let read = model(&pair.path("stamped.dynain"));
        assert_eq!(read.shells.len(), 2);
        assert_eq!(read.shell_thickness(1), Some([0.9; 4]));
    }
    // In the crash deck one card alone can be exchanged.
    let first = "     101       7       1       3       4       2\n";
    let twice = crash(2, "").replace(first, &format!("{first}{first}"));
    let output = Pair::new(&twice, &sheet).map(&["--out", "out.k"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("more than once (1 card too many)"),
        "{}",
        errors(&output)
    );
}

#[test]
fn a_given_pose_of_a_file_in_another_unit_is_asked_about() {
    let in_metres = |line: &str| match line.len() {
        56 if !line.contains('E') => {
            let at = |range: std::ops::Range<usize>| line[range].trim().parse::<f64>();
            match (at(8..24), at(24..40)) {
                (Ok(x), Ok(y)) => {
                    format!("{}{:>16}{:>16}{:>16}\n", &line[..8], x / 1e3, y / 1e3, 0)
                }
                _ => format!("{line}\n"),
            }
        }
        _ => format!("{line}\n"),
    };
    let sheet: String = stamped(2, "")
        .replace("  0.9", " 9E-4")
        .lines()
        .map(in_metres)
        .collect();
    let pair = Pair::new(&crash(2, ""), &sheet);
    let told = pair.map(&["--quantities", "thickness"]);
    assert!(
        errors(&told).contains("--stamped-length-factor 1000.0 would convert it"),
        "{}",
        errors(&told)
    );
    let told = pair.map(&[
        "--quantities",
        "thickness",
        "--stamped-length-factor",
        "1000",
    ]);
    assert_eq!(errors(&told), "");
}

/// A number that does not fit its columns costs its element alone, also where it begins the line.
#[test]
fn stars_in_place_of_a_number_cost_one_element() {
    let results = stresses(1..=2).replacen(" -.7745967", "**********", 1);
    let pair = Pair::new(&crash(2, ""), &stamped(2, &results));
    let output = pair.map(&["--out", "out.k", "--quantities", "plastic,stress"]);
    assert!(output.status.success());
    assert!(
        errors(&output).contains("found \"**********\""),
        "{}",
        errors(&output)
    );
    assert_eq!(model(&pair.path("out.k")).forming.n_stress(), 1);
}

#[test]
fn results_of_no_shell_and_doubled_ones_are_told_and_not_counted() {
    let results = stresses(1..=3) + &stresses(2..=2);
    let pair = Pair::new(&crash(2, ""), &stamped(2, &results));
    let output = pair.map(&[]);
    let told = errors(&output);
    assert!(
        told.contains("stamped.dynain: 2 doubtful results"),
        "{told}"
    );
    // The first is named with its file and line.
    let deck = std::fs::read_to_string(pair.path("stamped.dynain")).unwrap();
    let is_third = |line: &str| line.starts_with("         3 ");
    let results = deck.find("*INITIAL_STRESS_SHELL").unwrap();
    let before = deck[..results].lines().count();
    let line = 1 + before + deck[results..].lines().position(is_third).unwrap();
    assert!(
        told.contains(&format!("stamped.dynain:{line}:1: warning: shell 3 has")),
        "{told}"
    );
    let info = std::process::Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .arg("info")
        .arg(pair.path("stamped.dynain"))
        .output()
        .unwrap();
    let info = text(&info.stdout);
    assert!(
        info.contains("(0.1000) on 2 shells") || info.contains("on 2 shells"),
        "{info}"
    );
    assert!(
        !info.contains("on 4 shells") && !info.contains("on 3 shells"),
        "{info}"
    );
    assert!(
        info.contains("shell 3 has stresses and is not defined"),
        "{info}"
    );
    assert!(
        info.contains("shell 2 has stresses more than once"),
        "{info}"
    );
}

#[test]
fn filled_rings_say_what_they_lack() {
    let pair = Pair::new(&crash(4, ""), &stamped(2, &stresses(1..=2)));
    let told = |quantities: &str| {
        let options = ["--fill", "1", "--out", "out.k", "--quantities", quantities];
        let output = pair.map(&options);
        assert!(output.status.success(), "{}", errors(&output));
        (errors(&output).to_owned(), model(&pair.path("out.k")))
    };
    let (usual, written) = told("usual");
    assert!(!usual.contains("filled"), "{usual}");
    assert_eq!(written.forming.n_stress(), 3);
    let (stress, written) = told("thickness,stress");
    assert!(
        stress.contains("1 element filled from neighbours: thickness and plastic strain alone"),
        "{stress}"
    );
    assert_eq!(written.forming.n_stress(), 2);
}

#[test]
fn a_copy_in_another_folder_says_which_includes_it_loses() {
    let deck = crash(2, "").replace("*END\n", "*INCLUDE\nmore.k\n*INCLUDE\nleast.k\n*END\n");
    let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
    for name in ["more.k", "least.k"] {
        std::fs::write(pair.path(name), "*KEYWORD\n*END\n").unwrap();
    }
    std::fs::create_dir(pair.path("away")).unwrap();
    let told = |out: &str| {
        let output = pair.map(&["--out", out, "--write", "deck"]);
        assert!(output.status.success(), "{}", errors(&output));
        errors(&output).to_owned()
    };
    let away = told("away/out.k");
    assert!(
        away.contains("includes more.k and 1 more, not found from its folder"),
        "{away}"
    );
    let beside = told("out.k");
    assert!(!beside.contains("not found"), "{beside}");
    // Folders of includes are relative to the deck, or are not; names run over lines.
    std::fs::create_dir(pair.path("lib")).unwrap();
    std::fs::rename(pair.path("more.k"), pair.path("lib/more.k")).unwrap();
    let lib = pair.path("lib").display().to_string();
    let deeper = "*INCLUDE\nleast +\n.k\n";
    std::fs::write(pair.path("lib/more.k"), format!("*KEYWORD\n{deeper}*END\n")).unwrap();
    for (folder, lost) in [
        (
            "*INCLUDE_PATH_RELATIVE\nli +\nb\n".to_owned(),
            Some("crash.k"),
        ),
        (format!("*INCLUDE_PATH\n{lib}\n"), Some("more.k")),
        (
            format!("*INCLUDE_PATH\n{lib}\n{}\n", lib.replace("lib", "")),
            None,
        ),
    ] {
        let deck = crash(2, "").replace("*END\n", &format!("{folder}*INCLUDE\nmore.k\n*END\n"));
        std::fs::write(pair.path("crash.k"), deck).unwrap();
        let away = told("away/out.k");
        match lost {
            Some("crash.k") => assert!(away.contains("out.k includes more.k, not found"), "{away}"),
            Some(_) => assert!(
                away.contains("more.k includes least.k, not found from the folder of away/out.k"),
                "{away}"
            ),
            None => assert!(!away.contains("not found"), "{away}"),
        }
        let beside = told("out.k");
        assert!(!beside.contains("not found"), "{beside}");
    }
}

#[test]
fn what_standard_output_gets_is_one_deck_and_nothing_else() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    let refused = pair.map(&["--out", "-"]);
    assert_eq!(refused.status.code(), Some(2), "{}", errors(&refused));
    assert!(!pair.path("-_elements").exists());
    let deck = pair.map(&["--out", "-", "--write", "deck"]);
    assert!(deck.status.success(), "{}", errors(&deck));
    let printed = text(&deck.stdout);
    assert!(
        printed.starts_with("*KEYWORD") && printed.ends_with("*END\n"),
        "{printed}"
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_file_that_could_not_be_written_is_not_among_those_that_were() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    let output = pair.map(&["--out", "/dev/full", "--write", "deck"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("/dev/full"), "{}", errors(&output));
    assert!(
        !text(&output.stdout).contains("Wrote"),
        "{}",
        text(&output.stdout)
    );
}

#[test]
fn a_crash_part_without_cards_says_why_nothing_is_written() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    let stl = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 20 0 0\nvertex 20 10 0\n\
               endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 20 10 0\n\
               vertex 0 10 0\nendloop\nendfacet\nendsolid s\n";
    std::fs::write(pair.path("crash.k"), stl).unwrap();
    for kind in ["deck", "include", "part"] {
        let output = pair.map(&["--layers", "2", "--out", "out.k", "--write", kind]);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            errors(&output).contains("crash.k holds no cards of the elements"),
            "{kind}: {}",
            errors(&output)
        );
    }
}
