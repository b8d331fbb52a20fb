//! `shapematch map` onto decks whose elements stand in a file that is included with offsets, units or a
//! motion: what is written has to be right when the solver reads it back through the include.

use std::path::Path;

use shapematch::formats::Model;

use crate::map_decks::{Pair, SECTION, crash, errors, model, square, stamped, stresses, strip};

/// A pair whose crash deck includes `part.k`, which holds part 7 (elements 101 and 102), by these cards.
fn pair(include: &str, part: &str) -> Pair {
    let deck = format!("*KEYWORD\n{include}*END\n");
    let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
    std::fs::write(pair.path("part.k"), part).unwrap();
    pair
}

/// An include of `part.k` with offsets of nodes, elements and parts, a unit of length and a motion.
fn include(offsets: [i64; 3], length: f64, motion: u64) -> String {
    let [node, element, part] = offsets;
    format!(
        "*INCLUDE_TRANSFORM\npart.k\n{node:>10}{element:>10}{part:>10}\n\n       1.0       1.0{length:>10}\n{motion:>10}\n"
    )
}

/// Elements with a thickness, and the ids of those with stresses of 100 along x.
fn thickness_and_stress(model: &Model) -> (Vec<(u64, f64)>, Vec<u64>) {
    let thickness = |extra: &shapematch::formats::model::ShellExtra| {
        (model.shells[extra.shell as usize].id, extra.thickness[0])
    };
    let stresses = model.forming.stresses();
    let stressed = stresses.filter(|card| (card.points[0].stress[0] - 100.0).abs() < 1e-6);
    (
        model.shell_extras.iter().map(thickness).collect(),
        stressed.map(|card| card.element_id).collect(),
    )
}

const FULL: &str = "thickness,plastic,strain,stress";

/// Options for what is written.
fn options<'a>(kind: &'a str, quantities: &'a str) -> [&'a str; 6] {
    [
        "--out",
        "out.k",
        "--write",
        kind,
        "--quantities",
        quantities,
    ]
}

/// Writes what is asked for; the text of the first file.
#[track_caller]
fn written(pair: &Pair, kind: &str, quantities: &str) -> String {
    let output = pair.map(&options(kind, quantities));
    assert!(output.status.success(), "{}", errors(&output));
    std::fs::read_to_string(pair.path("out.k")).unwrap()
}

/// Writes an include; the text of its file of elements.
#[track_caller]
fn written_elements(pair: &Pair) -> String {
    written(pair, "include", FULL);
    std::fs::read_to_string(pair.path("out_elements.k")).unwrap()
}

/// Why nothing is written.
#[track_caller]
fn refused(pair: &Pair, kind: &str) -> String {
    let output = pair.map(&options(kind, FULL));
    assert_eq!(output.status.code(), Some(1));
    assert!(!pair.path("out.k").exists());
    errors(&output).to_owned()
}

/// The crash deck with the copy in the place of the included file.
fn with_copy(pair: &Pair) -> Model {
    std::fs::rename(pair.path("out.k"), pair.path("part.k")).unwrap();
    model(&pair.path("crash.k"))
}

#[test]
fn a_file_with_offsets_keeps_its_own_numbers_in_a_copy() {
    let pair = pair(&include([500, 1000, 20], 1.0, 0), &crash(2, ""));
    let copy = written(&pair, "deck", FULL);
    assert!(
        copy.contains("*ELEMENT_SHELL_THICKNESS\n     101       7       1"),
        "{copy}"
    );
    assert!(copy.contains("*INITIAL_STRESS_SHELL\n       101"), "{copy}");
    let (thickness, stressed) = thickness_and_stress(&with_copy(&pair));
    assert_eq!(thickness, [(1101, 0.9), (1102, 0.9)]);
    assert_eq!(stressed, [1101, 1102]);
}

#[test]
fn what_stands_beside_the_deck_has_the_numbers_of_the_whole() {
    let pair = pair(&include([500, 1000, 20], 1.0, 0), &crash(2, ""));
    let states = written(&pair, "include", FULL);
    assert!(
        states.contains("*INITIAL_STRESS_SHELL\n      1101"),
        "{states}"
    );
    let elements = std::fs::read_to_string(pair.path("out_elements.k")).unwrap();
    let card = "*ELEMENT_SHELL_THICKNESS\n    1101      27     501     503     504     502\n";
    assert!(elements.contains(card), "{elements}");
    let part = written(&pair, "part", FULL);
    assert!(part.contains(card), "{part}");
    assert!(part.contains("*INITIAL_STRESS_SHELL\n      1101"), "{part}");
}

#[test]
fn a_unit_of_the_include_counts_for_thicknesses() {
    // The file is in metres.
    let part = crash(2, "").replace(
        "       1.0       1.0       1.0       1.0",
        &"     0.001".repeat(4),
    );
    let in_metres = |line: &str| match line.len() {
        56 => {
            let x = line[8..24].trim().parse::<f64>().unwrap() / 1000.0;
            let y = line[24..40].trim().parse::<f64>().unwrap() / 1000.0;
            format!("{}{x:>16.3}{y:>16.3}{}\n", &line[..8], &line[40..])
        }
        _ => format!("{line}\n"),
    };
    let part: String = part.lines().map(in_metres).collect();
    let pair = pair(&include([0, 1000, 0], 1000.0, 0), &part);
    // Stresses would have another unit too.
    let told = refused(&pair, "deck");
    assert!(told.contains("has a unit of stress of its own"), "{told}");
    let usual = written(&pair, "deck", "thickness,plastic");
    assert!(
        usual.contains("*INITIAL_STRESS_SHELL\n       101"),
        "{usual}"
    );
    let copy = written(&pair, "deck", "thickness");
    assert!(copy.contains("  9.00000000E-04  9.00000000E-04"), "{copy}");
    let (thickness, _) = thickness_and_stress(&with_copy(&pair));
    assert_eq!(
        thickness.iter().map(|(id, _)| *id).collect::<Vec<_>>(),
        [1101, 1102]
    );
    assert!(thickness.iter().all(|(_, t)| (t - 0.9).abs() < 1e-12));
    // The first run changed the file: its elements have a thickness now, in their own unit.
    let elements = written_elements(&pair);
    assert!(
        elements.contains("  9.00000000E-01  9.00000000E-01"),
        "{elements}"
    );
}

#[test]
fn states_are_not_put_where_the_deck_would_turn_them() {
    let turn = "*DEFINE_TRANSFORMATION\n         5\nROTATE           0.0       0.0       1.0       0.0       0.0       0.0      90.0\nROTATE           0.0       0.0       1.0       0.0       0.0       0.0     -30.0\n";
    let back = "ROTATE           0.0       0.0       1.0       0.0       0.0       0.0     -60.0\n";
    let include = include([0, 0, 0], 1.0, 5);
    let lie = |cards: String| pair(&format!("{cards}{include}"), &crash(2, ""));
    // Two turns and a third one back: nothing is turned in the end but for rounding.
    let straight = lie(format!("{turn}{back}"));
    written(&straight, "deck", FULL);
    assert_eq!(thickness_and_stress(&with_copy(&straight)).1, [101, 102]);
    let turned = lie(turn.to_owned());
    // 60 degrees about z as rows.
    let pose = "0.5 -0.8660254037844386 0 0 0.8660254037844386 0.5 0 0 0 0 1 0 0 0 0 1";
    let map = |kind: &str| {
        let options = options(kind, FULL);
        turned.run(&[&options[..], &["--pose", pose]].concat())
    };
    let told = map("deck");
    assert_eq!(told.status.code(), Some(1));
    assert!(
        errors(&told).contains("*INCLUDE_TRANSFORM"),
        "{}",
        errors(&told)
    );
    let output = map("include");
    assert!(output.status.success(), "{}", errors(&output));
    let states = std::fs::read_to_string(turned.path("out.k")).unwrap();
    assert!(
        states.contains("*INITIAL_STRESS_SHELL\n       101"),
        "{states}"
    );
}

/// x → −x.
const MIRROR: &str = "*DEFINE_TRANSFORMATION\n         5\nMIRROR           0.0       0.0       0.0       1.0       0.0       0.0\n";

/// A deck with all x mirrored and its elements' corners as they were.
fn mirrored(deck: &str) -> String {
    let line = |line: &str| match line[8.min(line.len())..]
        .get(..16)
        .map(|x| x.trim().parse::<f64>())
    {
        Some(Ok(x)) if line.len() == 56 => {
            format!("{}{:>16.1}{}\n", &line[..8], 0.0 - x, &line[24..])
        }
        _ => format!("{line}\n"),
    };
    deck.lines().map(line).collect()
}

/// Bending: plastic strains 0.1, 0.2, 0.3 from the lower side to the upper one, and shear.
fn bent() -> String {
    let results = stresses(1..=2).replace("50.0       0.0       0.0", "50.0       0.0       7.0");
    let mut n = 0;
    let layer = |line: &str| match line.strip_suffix("0.1") {
        Some(rest) => {
            n += 1;
            format!("{rest}0.{}\n", (n - 1) % 3 + 1)
        }
        None => format!("{line}\n"),
    };
    results.lines().map(layer).collect()
}

/// Stress xy and plastic strain of the layers of each shell.
fn layers(model: &Model) -> Vec<Vec<(f64, f64)>> {
    let of_points = model.forming.stresses().map(|card| card.points);
    of_points
        .map(|points| {
            points
                .iter()
                .map(|p| (p.stress[3], p.plastic_strain))
                .collect()
        })
        .collect()
}

#[test]
fn a_mirrored_include_of_a_stamped_file_is_what_a_mirrored_pose_makes_of_it() {
    let sheet = mirrored(&stamped(2, &bent()));
    let main = format!("*KEYWORD\n{MIRROR}*INCLUDE_TRANSFORM\nhalf.k\n\n\n\n         5\n*END\n");
    let states = |deck: &str, pose: &[&str]| {
        let pair = Pair::new(&crash(2, ""), deck);
        std::fs::write(pair.path("half.k"), &sheet).unwrap();
        let output = pair.run(&[&options("include", FULL)[..], pose].concat());
        assert!(output.status.success(), "{}", errors(&output));
        layers(&model(&pair.path("out.k")))
    };
    let included = states(&main, &["--identity"]);
    let posed = states(&sheet, &["--pose", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"]);
    assert_eq!(included, posed);
    // The corners go the other way round in the mirrored file, so the crash part's upper side is its lower one.
    let layer = |plastic: f64| (-7.0, plastic);
    assert_eq!(included, vec![vec![layer(0.3), layer(0.2), layer(0.1)]; 2]);
}

#[test]
fn a_crash_part_that_an_include_mirrors_keeps_its_sides() {
    // Both have the material angle in the fifth field.
    for keyword in ["*ELEMENT_SHELL_BETA\n", "*ELEMENT_SHELL_THICKNESS\n"] {
        mirrored_part_keeps_its_sides(keyword);
    }
}

#[track_caller]
fn mirrored_part_keeps_its_sides(keyword: &str) {
    let sheet = stamped(2, &bent());
    let part = mirrored(&crash(2, "")).replace("*ELEMENT_SHELL\n", keyword);
    let cards =
        "             1.0             1.0             1.0             1.0            30.0\n";
    let with_angle = |line: &str| match line.starts_with("     10") {
        true => format!("{line}\n{cards}"),
        false => format!("{line}\n"),
    };
    let part: String = part.lines().map(with_angle).collect();
    let deck = format!("*KEYWORD\n{MIRROR}{}*END\n", include([0, 1000, 0], 1.0, 5));
    let pair = Pair::new(&deck, &sheet);
    std::fs::write(pair.path("part.k"), &part).unwrap();
    let read = model(&pair.path("crash.k"));
    // The card has 1 3 4 2.
    let ids = read.shells[0]
        .nodes
        .map(|node| read.nodes.ids()[node as usize]);
    assert_eq!(ids, [3, 1, 2, 4]);
    assert_eq!(read.shell_extras[0].beta, -30.0);
    assert!(read.files[1].included_as.is_mirrored && !read.files[0].included_as.is_mirrored);
    // Seen in the mirror the sheet's normals are opposite to those of the stamped part.
    for kind in ["include", "part"] {
        let states = written(&pair, kind, FULL);
        let file = if kind == "part" {
            "out.k"
        } else {
            "out_elements.k"
        };
        let elements = std::fs::read_to_string(pair.path(file)).unwrap();
        let card = format!("{keyword}    1101       7       3       1       2       4\n");
        assert!(elements.contains(&card), "{elements}");
        assert!(
            elements.contains("  9.00000000E-01 -3.00000000E+01\n"),
            "{elements}"
        );
        assert!(states.contains("*INITIAL_STRESS_SHELL"), "{states}");
        let layer = |plastic: f64| (7.0, plastic);
        let expected = vec![vec![layer(0.3), layer(0.2), layer(0.1)]; 2];
        assert_eq!(layers(&model(&pair.path("out.k"))), expected);
    }
    // Stresses in a copy of the file would be mirrored with it.
    let told = pair.map(&options("deck", FULL));
    assert!(
        errors(&told).contains(
            "part.k is turned or mirrored by the deck (*INCLUDE_TRANSFORM), which would turn the stresses and \
             strains in its copy too; write an include of the whole deck instead (--write include)"
        ),
        "{}",
        errors(&told)
    );
    // A copy of the file has its own order, which the deck mirrors.
    let corners = &options("deck", "thickness")[..];
    let output = pair.map(&[corners, &["--corner-thickness", "yes"]].concat());
    assert!(output.status.success(), "{}", errors(&output));
    let copy = std::fs::read_to_string(pair.path("out.k")).unwrap();
    assert!(
        copy.contains("     101       7       1       3       4       2\n"),
        "{copy}"
    );
}

#[test]
fn a_mirrored_include_keeps_the_thickness_of_a_section_at_each_node() {
    let section = SECTION.replace(
        "       1.0       1.0       1.0       1.0",
        "       1.0       2.0       3.0       4.0",
    );
    let cards = format!(
        "*ELEMENT_SHELL\n{}{}*ELEMENT_SHELL_THICKNESS\n{}             9.0             0.0\n",
        square(101, 7, 0, 8),
        "     102       7       3       5       6       6\n",
        "     103       7       3       6       4       4\n",
    );
    let part = format!("*KEYWORD\n{section}{}{cards}*END\n", strip(2, [8, 16]));
    let deck = format!("*KEYWORD\n{MIRROR}{}*END\n", include([0, 0, 0], 1.0, 5));
    let pair = Pair::new(&deck, "");
    std::fs::write(pair.path("part.k"), part).unwrap();
    let read = model(&pair.path("crash.k"));
    let expected: [&[(u64, f64)]; 3] = [
        &[(1, 1.0), (3, 2.0), (4, 3.0), (2, 4.0)],
        &[(3, 1.0), (5, 2.0), (6, 3.0)],
        &[(3, 9.0), (6, 2.0), (4, 3.0)],
    ];
    for (shell, (index, expected)) in read.shells.iter().zip((0..).zip(expected)) {
        let thickness = read.shell_thickness(index).unwrap();
        let nodes = shell.corners().iter();
        let ids = nodes.map(|&node| read.nodes.ids()[node as usize]);
        let mut found: Vec<(u64, f64)> = ids.zip(thickness).collect();
        // The corners go the other way round.
        found.reverse();
        let first = found.iter().position(|corner| *corner == expected[0]);
        found.rotate_left(first.unwrap());
        assert_eq!(found, expected);
    }
}

#[test]
fn plies_are_no_elements_of_their_file() {
    // Eight columns of the material's id are the id of a mapped element.
    let other = "*KEYWORD\n*ELEMENT_SHELL_COMPOSITE\n     901       8       1       3       4       2\n     10100       0.5       0.0\n*END\n";
    let deck = crash(2, "*INCLUDE\nother.k\n");
    let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
    std::fs::write(pair.path("other.k"), other).unwrap();
    let options = options("deck", FULL);
    let output = pair.map(&[&options[..], &["--crash-part", "7"]].concat());
    assert!(output.status.success(), "{}", errors(&output));
}

#[test]
fn a_file_that_is_included_twice_has_no_copy() {
    let twice = include([0, 0, 0], 1.0, 0) + &include([500, 1000, 20], 1.0, 5);
    let move_away =
        "*DEFINE_TRANSFORMATION\n         5\nTRANSL           0.0       0.0     300.0\n";
    let pair = pair(&format!("{move_away}{twice}"), &crash(2, ""));
    let told = refused(&pair, "deck");
    assert!(told.contains("part.k is included 2 times"), "{told}");
    let elements = written_elements(&pair);
    assert!(elements.contains("     101       7       1"), "{elements}");
    assert!(!elements.contains("1101"), "{elements}");
}

#[test]
fn a_file_is_read_with_the_width_of_the_deck_around_it() {
    // The fields of the part are 20 wide because those of the deck are.
    let wide = |line: &str| {
        if line.starts_with('*') || line.starts_with("sheet") {
            return format!("{line}\n");
        }
        let fields = line.split_whitespace();
        fields
            .map(|field| format!("{field:>20}"))
            .collect::<String>()
            + "\n"
    };
    let part = crash(2, "").replace("*KEYWORD\n", "");
    let part: String = part.lines().map(wide).collect();
    let deck = "*KEYWORD LONG=Y\n*INCLUDE\npart.k\n*END\n";
    let pair = Pair::new(deck, &stamped(2, &stresses(1..=2)));
    std::fs::write(pair.path("part.k"), part).unwrap();
    let elements = written_elements(&pair);
    assert!(elements.starts_with("*KEYWORD LONG=Y\n"), "{elements}");
    assert!(
        elements.contains("*ELEMENT_SHELL_THICKNESS\n                 101"),
        "{elements}"
    );
    written(&pair, "deck", FULL);
    let (thickness, stressed) = thickness_and_stress(&with_copy(&pair));
    assert_eq!(thickness, [(101, 0.9), (102, 0.9)]);
    assert_eq!(stressed, [101, 102]);
}

/// What is written is read back beside the nodes of the deck, whose ids may ask for wider fields.
#[test]
fn nodes_of_wider_ids_do_not_change_how_a_file_is_read() {
    let offset = "*INCLUDE_TRANSFORM\nother.k\n 200000000 200000000\n\n\n\n*END\n";
    let ten = "*NODE%\n1234567890             0.0             0.0            99.0\n*END\n";
    let long = "*NODE+\n         12345678901                 0.0                 0.0                99.0\n*END\n";
    for cards in [offset, ten, long] {
        let deck = crash(2, "").replace("*END\n", cards);
        let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
        std::fs::write(pair.path("other.k"), strip(1, [8, 16])).unwrap();
        for kind in ["include", "part", "deck"] {
            written(&pair, kind, FULL);
        }
        // Another mapper's file without nodes has the format of the deck, too.
        std::fs::write(pair.path("other_mapper.k"), stamped(2, "").split_off(8)).unwrap();
        written(&pair, "part", FULL);
        let output = pair.map(&["--compare", "out.k"]);
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(told.contains("2 elements in both"), "{told}");
        let compared = told.split("2 elements in both").nth(1).unwrap();
        assert!(compared.contains("hickness"), "{told}");
    }
}

/// The rest of a thickness card stays, and a keyword may have blanks behind its star.
#[test]
fn tabs_on_a_thickness_card_and_blanks_in_a_keyword_are_kept_or_read() {
    let elements = |deck: &str| {
        let at = deck.find("*ELEMENT_SHELL\n").unwrap();
        deck.split_at(at).0.to_owned()
    };
    let deck = crash(1, "");
    let tabs = format!(
        "{}*ELEMENT_SHELL_BETA\n{}\t     1.0\t     1.0\t     1.0\t     1.0\t    30.0\n*END\n",
        elements(&deck),
        square(101, 7, 0, 8)
    );
    let pair = Pair::new(&tabs, &stamped(1, ""));
    written(&pair, "deck", "thickness");
    let read = model(&pair.path("out.k"));
    let extra = &read.shell_extras[0];
    assert_eq!((extra.beta, extra.thickness), (30.0, [0.9; 4]));
    let blank = deck.replace("*ELEMENT_SHELL\n", "* ELEMENT_SHELL\n");
    for kind in ["include", "part", "deck"] {
        let pair = Pair::new(&blank, &stamped(1, ""));
        written(&pair, kind, "thickness");
    }
}

#[test]
fn a_file_of_another_width_is_listed_with_the_width_of_its_cards() {
    let part = crash(2, "").replace("*ELEMENT_SHELL\n", "*ELEMENT_SHELL%\n");
    let ten = |line: &str| {
        let is_element = line.starts_with("     10") && line.len() == 48;
        let fields = line.split_whitespace();
        match is_element {
            true => {
                fields
                    .map(|field| format!("{field:>10}"))
                    .collect::<String>()
                    + "\n"
            }
            false => format!("{line}\n"),
        }
    };
    let part: String = part.lines().map(ten).collect();
    let pair = pair("*INCLUDE\npart.k\n", &part);
    let elements = written_elements(&pair);
    let card = "*ELEMENT_SHELL_THICKNESS%\n       101         7         1";
    assert!(elements.contains(card), "{elements}");
}

#[test]
fn a_copy_without_thickness_is_that_of_the_file_with_the_elements() {
    let pair = pair(&include([500, 1000, 20], 1.0, 0), &crash(2, ""));
    written(&pair, "deck", "stress,plastic");
    let (thickness, stressed) = thickness_and_stress(&with_copy(&pair));
    assert_eq!(thickness, []);
    assert_eq!(stressed, [1101, 1102]);
    assert!(Path::new(&pair.path("crash.k")).exists());
}

#[test]
fn lines_that_are_put_into_a_copy_end_as_its_own_do() {
    let deck = crash(2, "").replace('\n', "\r\n");
    let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
    let copy = written(&pair, "deck", FULL);
    assert!(copy.contains("*INITIAL_STRESS_SHELL\r\n"), "{copy}");
    assert_eq!(copy.matches('\n').count(), copy.matches("\r\n").count());
}

#[test]
fn factors_that_are_none_are_wrong_usage() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    for factor in ["0", "-1", "nan", "inf", "x"] {
        let output = pair.map(&[&format!("--stress-factor={factor}")]);
        assert_eq!(output.status.code(), Some(2), "{factor}");
    }
}
