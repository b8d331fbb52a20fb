//! `shapematch map` onto crash decks that have initial stresses and strains of the mapped elements already:
//! copies of the deck are compared with those of a deck from which the old cards were taken by hand.

use crate::map_decks::{Pair, crash, errors, model, square, stamped, stresses, strip};

/// A strain card of an element of the stamped part.
const STRAINS: &str = "*INITIAL_STRAIN_SHELL
         1
      0.01      0.02     -0.03       0.0       0.0       0.0      -1.0
      0.01      0.02     -0.03       0.0       0.0       0.0       1.0
";

/// Stamped strips of two squares with stresses, and strains of the first.
fn two_squares() -> String {
    stamped(2, &(stresses(1..=2) + STRAINS))
}

/// Cards of stresses of one point, in fields of a width.
fn old_stress(id: u64, width: usize) -> String {
    let row = |fields: &[&str]| {
        let fields = fields.iter().map(|field| format!("{field:>width$}"));
        fields.collect::<String>() + "\n"
    };
    let point = ["0.0", "7.0", "7.0", "0.0", "0.0", "0.0", "0.0", "0.3"];
    row(&[&id.to_string(), "1", "1"]) + "$ of old\n" + &row(&point)
}

fn options<'a>(kind: &'a str, replace: &'a [&'a str]) -> Vec<&'a str> {
    let all = ["--out", "out.k", "--write", kind, "--quantities", "full"];
    [&all[..], replace].concat()
}

const REPLACE: &[&str] = &["--replace-states", "yes"];

#[track_caller]
fn written(pair: &Pair, kind: &str, replace: &[&str]) -> String {
    let output = pair.map(&options(kind, replace));
    assert!(output.status.success(), "{}", errors(&output));
    std::fs::read_to_string(pair.path("out.k")).unwrap()
}

/// Why nothing is written.
#[track_caller]
fn refused(pair: &Pair, kind: &str, replace: &[&str]) -> String {
    let output = pair.map(&options(kind, replace));
    assert_eq!(output.status.code(), Some(1));
    assert!(!pair.path("out.k").exists());
    errors(&output).to_owned()
}

/// What stands of 101, which has new stresses and strains, 102, which has new stresses, 103, which lies beside
/// the stamped part, and 999, which is of no part.
fn old_states(width: usize) -> [String; 2] {
    let one = |id| old_stress(id, width);
    let local = |id: u64| {
        let head = [id, 0, 0, 0, 0, 0, 0, 1].map(|field| format!("{field:>width$}"));
        head.concat() + "\n" + &"0.01\n".repeat(2)
    };
    let stress = "*INITIAL_STRESS_SHELL\n";
    let strain = "*initial_strain_shell $ by the last run\n";
    let with = [
        stress,
        &one(103),
        "$ next\n",
        &one(101),
        &one(999),
        &one(102),
        stress,
        &one(102),
        "*PARAMETER\nr t, 1.0\n",
        strain,
        "101,,,\n.1,.2\n.1,.2\n",
        // In the element's own axes, which is not read.
        &local(101),
        strain,
        "102,,,\n.1,.2\n.1,.2\n",
    ];
    let rest = [
        stress,
        &one(103),
        "$ next\n",
        &one(999),
        "*PARAMETER\nr t, 1.0\n",
        strain,
        "102,,,\n.1,.2\n.1,.2\n",
    ];
    [with.concat(), rest.concat()]
}

#[test]
fn old_states_of_mapped_elements_are_left_out_of_a_copy_and_nothing_else() {
    let plain = crash(3, "");
    let [with, rest] = old_states(10).map(|old| plain.replace("*END\n", &(old + "*END\n")));
    let i10 = |deck: &str| {
        let (head, elements) = deck.split_once("*ELEMENT_SHELL\n").unwrap();
        let (_, after) = elements.split_once("*INITIAL").unwrap();
        let head = head.split("*NODE\n").next().unwrap();
        let head = head.replace("*KEYWORD\n", "*KEYWORD I10=Y\n") + &strip(3, [10, 16]);
        let squares = (0..3).map(|n| square(101 + n, 7, n, 10));
        let squares: String = squares.collect();
        format!("{head}*ELEMENT_SHELL\n{squares}*INITIAL{after}")
    };
    let crlf = |deck: &str| deck.replace('\n', "\r\n");
    for [with, rest] in [
        [with.clone(), rest.clone()],
        [i10(&with), i10(&rest)],
        [crlf(&with), crlf(&rest)],
    ] {
        let pair = Pair::new(&with, &two_squares());
        let told = refused(&pair, "deck", &[]);
        assert!(
            told.contains("2 of the elements have initial stresses or strains"),
            "{told}"
        );
        assert!(told.contains("(--replace-states yes)"), "{told}");
        let copy = written(&pair, "deck", REPLACE);
        let by_hand = Pair::new(&rest, &two_squares());
        assert_eq!(copy, written(&by_hand, "deck", &[]));
        // Again, onto what was written.
        std::fs::rename(pair.path("out.k"), pair.path("crash.k")).unwrap();
        assert_eq!(copy, written(&pair, "deck", REPLACE));
    }
    let told = Pair::new(&with, &two_squares()).map(&options("deck", REPLACE));
    assert!(
        errors(&told).contains("2 elements keep the initial stresses or strains"),
        "{}",
        errors(&told)
    );
}

#[test]
fn old_states_in_long_fields_are_left_out() {
    let field = |text: &str| format!("{text:>20}");
    let row = |fields: &[&str]| fields.iter().map(|f| field(f)).collect::<String>() + "\n";
    let mut deck = "*KEYWORD LONG=Y\n*PART\nsheet\n".to_owned() + &row(&["7", "7", "5"]);
    deck += "*SECTION_SHELL\n";
    deck += &(row(&["7", "2", "0.833", "3"]) + &row(&["1.0"; 4]) + &strip(2, [20, 20]));
    deck += "*ELEMENT_SHELL\n";
    deck += &(square(101, 7, 0, 20) + &square(102, 7, 1, 20));
    let with = format!("{deck}*INITIAL_STRESS_SHELL\n{}*END\n", old_stress(102, 20));
    let copy = written(&Pair::new(&with, &two_squares()), "deck", REPLACE);
    let by_hand = Pair::new(&(deck + "*END\n"), &two_squares());
    assert_eq!(copy, written(&by_hand, "deck", &[]));
}

#[test]
fn old_states_in_included_files_are_left_out_of_copies_of_these() {
    let [with, rest] = old_states(10);
    let deck = crash(3, "").replace("*END\n", "*INCLUDE_TRANSFORM\nold.k\n\n\n\n\n*END\n");
    for kind in ["deck", "include", "part"] {
        let pair = Pair::new(&deck, &two_squares());
        // An included file without end, whose last line has none either.
        std::fs::write(pair.path("old.k"), with.trim_end()).unwrap();
        let text = written(&pair, kind, REPLACE);
        let copy = std::fs::read_to_string(pair.path("out_old.k")).unwrap();
        assert_eq!(copy, rest.trim_end(), "{kind}");
        if kind == "deck" {
            // As it stands, it holds the new states alone.
            assert!(text.contains("*INCLUDE_TRANSFORM\nout_old.k\n"), "{text}");
            let read = model(&pair.path("out.k"));
            let ids: Vec<u64> = read
                .forming
                .stresses()
                .map(|card| card.element_id)
                .collect();
            assert_eq!(ids, [103, 999, 101, 102]);
            let ids: Vec<u64> = read.forming.strains().map(|card| card.element_id).collect();
            assert_eq!(ids, [102, 101]);
        } else {
            assert!(text.contains("$ 2 of them have initial states"), "{text}");
        }
    }
}

/// The copy of a packed file is not packed, and its name says so.
#[test]
fn a_packed_file_has_an_unpacked_copy() {
    let [with, rest] = old_states(10);
    let deck = crash(3, "").replace("*END\n", "*INCLUDE\nold.k.gz\n*END\n");
    let pair = Pair::new(&deck, &two_squares());
    let file = std::fs::File::create(pair.path("old.k.gz")).unwrap();
    let mut packer = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    std::io::Write::write_all(&mut packer, with.as_bytes()).unwrap();
    packer.finish().unwrap();
    let text = written(&pair, "deck", REPLACE);
    assert!(text.contains("*INCLUDE\nout_old.k\n"), "{text}");
    let copy = std::fs::read_to_string(pair.path("out_old.k")).unwrap();
    assert_eq!(copy, rest);
}

#[test]
fn an_include_says_what_to_do_with_old_states_and_a_copy_is_made_on_request() {
    let plain = crash(3, "");
    let [with, rest] = old_states(10).map(|old| plain.replace("*END\n", &(old + "*END\n")));
    let pair = Pair::new(&with, &two_squares());
    let states = written(&pair, "include", &[]);
    assert!(
        states.contains("$ 2 of them have initial states in the crash deck already: take"),
        "{states}"
    );
    assert!(states.contains("--replace-states yes"), "{states}");
    assert!(!pair.path("out_crash.k").exists());
    let output = pair.map(&options("include", &[]));
    assert!(
        errors(&output).contains("2 initial states of mapped elements are in the crash deck"),
        "{}",
        errors(&output)
    );
    written(&pair, "include", REPLACE);
    let copy = std::fs::read_to_string(pair.path("out_crash.k")).unwrap();
    assert_eq!(copy, rest);
    // Thickness alone needs no other deck.
    let thickness = ["--out", "out.k", "--write", "deck"];
    assert!(pair.map(&thickness).status.code() == Some(1));
    let output = pair.map(&[&thickness[..], &["--quantities", "thickness"]].concat());
    assert!(output.status.success(), "{}", errors(&output));
}

#[test]
fn states_of_a_set_go_when_all_of_it_is_mapped() {
    let set = |ids: &str| {
        format!(
            "*SET_SHELL_LIST\n         5\n{ids}\n*INITIAL_STRESS_SHELL_SET\n         5         1         1\n       0.0      10.0      10.0\n"
        )
    };
    let deck = |ids: &str| crash(3, "").replace("*END\n", &(set(ids) + "*END\n"));
    let whole = Pair::new(&deck("       101       102"), &two_squares());
    assert!(refused(&whole, "deck", &[]).contains("--replace-states yes"));
    let copy = written(&whole, "deck", REPLACE);
    assert!(!copy.contains("INITIAL_STRESS_SHELL_SET"), "{copy}");
    assert!(copy.contains("*SET_SHELL_LIST"), "{copy}");
    // Ids without an element are nothing that would have to be mapped.
    let gaps = Pair::new(&deck("       101       102       777"), &two_squares());
    let copy = written(&gaps, "deck", REPLACE);
    assert!(!copy.contains("INITIAL_STRESS_SHELL_SET"), "{copy}");
    let some = Pair::new(&deck("       101       103"), &two_squares());
    let told = refused(&some, "deck", REPLACE);
    assert!(
        told.contains("crash.k gives all elements of shell set 5 one initial state"),
        "{told}"
    );
}

#[test]
fn old_states_that_cannot_be_read_are_not_passed_over() {
    let cut_off = "*INITIAL_STRESS_SHELL\n       101         1         2\n       0.0      10.0\n";
    let deck = crash(3, "").replace("*END\n", &format!("{cut_off}*END\n"));
    let line = deck
        .lines()
        .position(|line| line.starts_with("*INITIAL"))
        .unwrap()
        + 2;
    let told = refused(&Pair::new(&deck, &two_squares()), "deck", REPLACE);
    assert!(told.contains(&format!("crash.k, line {line}: ")), "{told}");
}

#[test]
fn a_card_that_lets_the_solver_map_onto_the_part_is_told() {
    let card = |name: &str, onto: u64| {
        format!("*INCLUDE_STAMPED_{name}\n$ by the solver\nold.dynain\n{onto:>10}         0\n")
    };
    let told = |cards: &str| {
        let pair = Pair::new(&crash(2, cards), &two_squares());
        let output = pair.map(&[]);
        assert!(output.status.success());
        errors(&output).to_owned()
    };
    let set = "*SET_PART_LIST\n         4\n         3         7\n";
    for cards in [
        card("PART", 7),
        card("PART_MATRIX", 7),
        set.to_owned() + &card("SET_MATRIX", 4),
        card("PART_SET", 4) + set,
    ] {
        let told = told(&cards);
        assert!(
            told.contains(": the crash deck lets the solver map old.dynain onto part 7 too"),
            "{cards}{told}"
        );
        assert!(told.contains("crash.k:"), "{told}");
    }
    for cards in [card("PART", 8), card("SET", 7) + set] {
        assert_eq!(told(&cards), "", "{cards}");
    }
}

#[test]
fn what_could_not_be_read_is_told() {
    let cut_off = two_squares().replace(
        "       0.0     100.0      50.0",
        "       0.0     1x0.0      50.0",
    );
    let told = Pair::new(&crash(2, ""), &cut_off).map(&[]);
    assert!(told.status.success());
    let told = errors(&told);
    assert!(
        told.contains("stamped.dynain: 2 pieces of what the file holds could not be read"),
        "{told}"
    );
    assert!(told.contains("found \"1x0.0\""), "{told}");
}

#[test]
fn a_file_without_its_end_and_nodes_at_two_places_are_told() {
    let without_end = two_squares().replace("*END\n", "");
    let told = Pair::new(&crash(2, ""), &without_end).map(&[]);
    let told = errors(&told);
    assert!(
        told.contains("stamped.dynain: its end may be missing ("),
        "{told}"
    );
    assert!(!told.contains("could not be read"), "{told}");
    let twice = "*NODE\n       1           500.0             0.0             0.0\n*END\n";
    let [moved, other] = [two_squares(), crash(2, "")].map(|deck| deck.replace("*END\n", twice));
    let told = Pair::new(&other, &moved).map(&[]);
    for file in ["crash.k", "stamped.dynain"] {
        let line = format!("{file}: 1 node is defined again at another place");
        assert!(errors(&told).contains(&line), "{}", errors(&told));
    }
}

#[test]
fn a_copy_that_nothing_includes_says_so() {
    let [with, _] = old_states(10);
    let deck = crash(3, "").replace("*END\n", "*INCLUDE\nold.k\n*END\n");
    let pair = Pair::new(&deck, &two_squares());
    std::fs::write(pair.path("old.k"), with).unwrap();
    let told = |kind: &str| {
        let output = pair.map(&options(kind, REPLACE));
        assert!(output.status.success(), "{}", errors(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let deck = told("deck");
    assert!(
        deck.contains("out.k includes it instead of old.k"),
        "{deck}"
    );
    let include = told("include");
    assert!(
        include.contains("to be included instead of old.k"),
        "{include}"
    );
}
