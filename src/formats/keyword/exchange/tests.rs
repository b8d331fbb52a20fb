//! Tests of the exchange of element cards.

use super::*;

fn exchange(deck: &str, ids: &[u64]) -> ExchangedDeck {
    let file = SourceFile::new("a.k", deck);
    let exchange = |id: u64| match id {
        id if ids.contains(&id) => Exchange::Thickness([1.0, 1.25, 1.5, 1.75]),
        4 => Exchange::Listed,
        _ => Exchange::Other,
    };
    exchanged(&file, IncludedAs::default(), &exchange)
}

fn exchanged(
    file: &SourceFile,
    included_as: IncludedAs,
    exchange_of: &dyn Fn(u64) -> Exchange,
) -> ExchangedDeck {
    let rules = ExchangeRules {
        included_as,
        list_layout: Some(Layout::Standard),
        exchange_of,
        leaves_out: None,
        states: &|_| Ok(vec![b"*INITIAL_STRESS_SHELL\n".to_vec()]),
    };
    exchange_thickness(file, &rules, &Monitor::silent()).unwrap()
}

fn text(deck: &ExchangedDeck) -> String {
    String::from_utf8(deck.bytes.clone()).unwrap()
}

const CARD: &str = "  1.00000000E+00  1.25000000E+00  1.50000000E+00  1.75000000E+00";

#[test]
fn runs_change_their_keyword_and_all_else_stays() {
    let deck = "*KEYWORD\n$ a comment\n*ELEMENT_SHELL\n\
$#   eid     pid      n1      n2      n3      n4\n\
\x20      1       1       1       2       3       4\n\
\x20      2       7       1       2       3       4\n\
$ between\n\
\x20      3       7       1       2       3       3\n\
\x20      4       1       1       2       3       4\n\
*NODE\n       1             0.0             0.0             0.0\n*END\nafter the end\n";
    let found = exchange(deck, &[2, 3]);
    let expected = format!(
        "*KEYWORD\n$ a comment\n*ELEMENT_SHELL\n\
$#   eid     pid      n1      n2      n3      n4\n\
\x20      1       1       1       2       3       4\n\
*ELEMENT_SHELL_THICKNESS\n\
\x20      2       7       1       2       3       4\n{CARD}\n\
$ between\n\
\x20      3       7       1       2       3       3\n{CARD}\n\
*ELEMENT_SHELL\n\
\x20      4       1       1       2       3       4\n\
*NODE\n       1             0.0             0.0             0.0\n\
*INITIAL_STRESS_SHELL\n*END\nafter the end\n"
    );
    assert_eq!(text(&found), expected);
    assert_eq!(
        (found.n_exchanged, found.n_composite, found.n_unknown),
        (2, 0, 0)
    );
    let elements = String::from_utf8(found.elements).unwrap();
    assert!(elements.starts_with("*ELEMENT_SHELL_THICKNESS\n       2"));
    assert!(
        elements.ends_with("*ELEMENT_SHELL\n       4       1       1       2       3       4\n")
    );
    assert_eq!(elements.lines().count(), 7);
}

#[test]
fn other_options_and_material_angles_survive() {
    let deck = "*ELEMENT_SHELL_BETA\n\
\x20      1       1       1       2       3       4\n\
\x20            0.9             0.9             0.9             0.9            45.0\n\
*ELEMENT_SHELL_OFFSET\n\
\x20      2       1       1       2       3       4\n\
\x20            0.3\n";
    let found = text(&exchange(deck, &[1, 2]));
    let expected = format!(
        "*ELEMENT_SHELL_BETA\n\
\x20      1       1       1       2       3       4\n\
{CARD}            45.0\n\
*ELEMENT_SHELL_OFFSET\n\
*ELEMENT_SHELL_THICKNESS_OFFSET\n\
\x20      2       1       1       2       3       4\n{CARD}\n\
\x20            0.3\n\
*INITIAL_STRESS_SHELL\n"
    );
    assert_eq!(found, expected);
}

#[test]
fn nothing_exchanged_is_a_copy_with_the_states_before_the_end() {
    let deck = "*KEYWORD\r\n*ELEMENT_SHELL\r\n1,1,1,2,3,4\r\n*END";
    let found = text(&exchange(deck, &[9]));
    assert_eq!(found, deck.replace("*END", "*INITIAL_STRESS_SHELL\r\n*END"));
}

#[test]
fn what_is_put_at_the_end_is_chosen_by_what_was_found() {
    let deck = "*KEYWORD I10=Y\n*ELEMENT_SHELL\n1,1,1,2,3,4\n*END\n";
    let seen = |id: u64| {
        let file = SourceFile::new("a.k", deck);
        let seen = std::cell::Cell::new(None);
        let rules = ExchangeRules {
            included_as: IncludedAs::default(),
            list_layout: None,
            exchange_of: &|found| {
                if found == id {
                    Exchange::Listed
                } else {
                    Exchange::Other
                }
            },
            leaves_out: None,
            states: &|found| {
                seen.set(Some((found.layout, found.n_found)));
                Ok(Vec::new())
            },
        };
        exchange_thickness(&file, &rules, &Monitor::silent()).unwrap();
        seen.get()
    };
    assert_eq!(seen(1), Some((Layout::I10, 1)));
    assert_eq!(seen(9), Some((Layout::I10, 0)));
}

#[test]
fn composites_are_left_and_counted() {
    let deck = "*ELEMENT_SHELL_COMPOSITE\n       1       1       1       2       3       4\n";
    let found = exchange(deck, &[1]);
    assert_eq!((found.n_exchanged, found.n_composite), (0, 1));
}

#[test]
fn results_that_are_left_out_take_their_keyword_along_and_nothing_else() {
    let head = "*KEYWORD\r\n*INITIAL_STRESS_SHELL\r\n$ of two shells\r\n";
    let first = "         1         1         2\r\n-.577\r\n$ between\r\n0.577\r\n";
    let second = "         2         1         1\r\n  0.0\r\n";
    let free = "*INITIAL_STRAIN_SHELL\r\n1,1,1,1\r\n1.,2.,3.,4.,5.\r\n6.,0.\r\n$ last\r\n";
    let set = "*INITIAL_STRESS_SHELL_SET\r\n         1\r\n  0.0\r\n";
    let deck = [head, first, "$ next\r\n", second, free, set, "*END\r\n"].concat();
    let file = SourceFile::new("a.k", &deck[..]);
    let left_out = |leaves_out: &dyn Fn(&ResultCards) -> bool| {
        let rules = ExchangeRules {
            included_as: IncludedAs {
                element_offset: 10,
                ..IncludedAs::default()
            },
            list_layout: None,
            exchange_of: &|_| Exchange::Other,
            leaves_out: Some(leaves_out),
            states: &|_| Ok(Vec::new()),
        };
        let found = exchange_thickness(&file, &rules, &Monitor::silent()).unwrap();
        assert_eq!(found.unread_results, None);
        (text(&found), found.n_left_out)
    };
    assert_eq!(left_out(&|_| false), (deck.clone(), 0));
    let of_shell = |cards: &ResultCards| cards.id == 11 && !cards.is_of_set;
    let rest = [head, "$ next\r\n", second, "$ last\r\n", set, "*END\r\n"].concat();
    assert_eq!(left_out(&of_shell), (rest, 2));
    let strains = |cards: &ResultCards| !cards.is_stress;
    assert_eq!(
        left_out(&strains).0,
        deck.replace(&free[..free.len() - 8], "")
    );
    let of_set = |cards: &ResultCards| cards.is_of_set && cards.id == 1;
    assert_eq!(left_out(&of_set).0, deck.replace(set, ""));
}

#[test]
fn results_that_are_out_of_step_stay_and_are_told() {
    let deck = "*KEYWORD\n*INITIAL_STRESS_SHELL\n         1         1         2\n  0.0\n*END\n";
    let file = SourceFile::new("a.k", deck);
    let rules = ExchangeRules {
        included_as: IncludedAs::default(),
        list_layout: None,
        exchange_of: &|_| Exchange::Other,
        leaves_out: Some(&|_| true),
        states: &|_| Ok(Vec::new()),
    };
    let found = exchange_thickness(&file, &rules, &Monitor::silent()).unwrap();
    assert_eq!(
        (text(&found), found.unread_results),
        (deck.to_owned(), Some(3))
    );
}

#[test]
fn the_list_has_the_numbers_of_the_whole_deck() {
    let deck = "*ELEMENT_SHELL_MCID\n\
\x20      1       2       3       4       5       6\n\
\x20            0.5             0.5             0.5            0.75               9\n\
*ELEMENT_SHELL_OFFSET\n\
\x20      2       2       3       4       5       5\n\
\x20            0.3\n";
    let file = SourceFile::new("a.k", deck);
    let included_as = IncludedAs {
        element_offset: 1_000,
        part_offset: 20,
        node_offset: 300_000_000,
        system_offset: 40,
        ..IncludedAs::default()
    };
    let of = |id: u64| match id {
        1_001 => Exchange::Listed,
        1_002 => Exchange::Thickness([1.0, 1.25, 1.5, 1.75]),
        _ => Exchange::Other,
    };
    let found = exchanged(&file, included_as, &of);
    assert_eq!(
        (found.n_exchanged, found.n_found, found.n_unlisted),
        (1, 2, 0)
    );
    // Nine digits do not fit into eight columns.
    let expected = format!(
        "*ELEMENT_SHELL_MCID%\n\
\x20     1001        22 300000003 300000004 300000005 300000006\n\
\x20 5.00000000E-01  5.00000000E-01  5.00000000E-01  7.50000000E-01              49\n\
*ELEMENT_SHELL_THICKNESS_OFFSET%\n\
\x20     1002        22 300000003 300000004 300000005 300000005\n{CARD}\n\
\x20            0.3\n"
    );
    assert_eq!(String::from_utf8(found.elements).unwrap(), expected);
    // The copy of the file keeps its own numbers.
    let copy = String::from_utf8(found.bytes).unwrap();
    let own = "*ELEMENT_SHELL_OFFSET\n*ELEMENT_SHELL_THICKNESS_OFFSET\n       2       2";
    assert!(copy.contains(own), "{copy}");
}

#[test]
fn a_unit_of_the_include_counts_in_the_copy_and_not_in_the_list() {
    let deck = "*ELEMENT_SHELL+\n                   1                   2                   3                   4                   5                   6\n";
    let file = SourceFile::new("a.k", deck);
    let included_as = IncludedAs {
        length_factor: 1000.0,
        ..IncludedAs::default()
    };
    let of = |_| Exchange::Thickness([1.0, 1.25, 1.5, 1.75]);
    let found = exchanged(&file, included_as, &of);
    let copy = String::from_utf8(found.bytes).unwrap();
    assert!(
        copy.contains("      1.00000000E-03      1.25000000E-03"),
        "{copy}"
    );
    let list = String::from_utf8(found.elements).unwrap();
    assert!(list.starts_with("*ELEMENT_SHELL_THICKNESS+\n"), "{list}");
    assert!(
        list.contains("      1.00000000E+00      1.25000000E+00"),
        "{list}"
    );
    let with_offset = SourceFile::new("b.k", &deck.replace("SHELL+", "SHELL_OFFSET+")[..]);
    assert_eq!(exchanged(&with_offset, included_as, &of).n_unlisted, 1);
}

/// The card of the mid-side nodes has the means of the corners beside them, whether there was one or not.
#[test]
fn shells_with_mid_side_nodes_get_both_cards() {
    let row = |id: u64| {
        format!("{id:>8}       1       1       2       3       4       5       6       7       8\n")
    };
    let old = format!(
        "{}\n$ middles\n{}    tail\n",
        "             0.9".repeat(4),
        "             0.8".repeat(4)
    );
    let middles = "  1.12500000E+00  1.37500000E+00  1.62500000E+00  1.37500000E+00";
    let thick = format!("*ELEMENT_SHELL_THICKNESS\n{}{old}{}{old}", row(2), row(4));
    let found = exchange(&thick, &[2]);
    let written = format!("{}{CARD}\n$ middles\n{middles}    tail\n", row(2));
    let kept = format!("{}{old}", row(4));
    let states = "*INITIAL_STRESS_SHELL\n";
    assert_eq!(
        text(&found),
        format!("*ELEMENT_SHELL_THICKNESS\n{written}{kept}{states}")
    );
    let listed = String::from_utf8(found.elements).unwrap();
    let without_comment = |text: &str| text.replace("$ middles\n", "");
    assert_eq!(
        listed,
        without_comment(&format!("*ELEMENT_SHELL_THICKNESS\n{written}{kept}"))
    );
    let plain = format!("*ELEMENT_SHELL\n{}", row(2));
    assert_eq!(
        text(&exchange(&plain, &[2])),
        format!(
            "*ELEMENT_SHELL\n*ELEMENT_SHELL_THICKNESS\n{}{CARD}\n{middles}\n{states}",
            row(2)
        )
    );
}

#[test]
fn a_node_that_a_card_names_twice_gets_its_thickness_twice() {
    // Triangles of the corners 1 2 3 of the model with 1.0, 1.25 and 1.5.
    let cards = [
        ("       1       1       2       3", [1.0, 1.0, 1.25, 1.5]),
        ("       1       2       2       3", [1.0, 1.25, 1.25, 1.5]),
        ("       1       2       3       1", [1.0, 1.25, 1.5, 1.0]),
    ];
    let read = |card: &str| -> Vec<f64> {
        let fields = card.split_whitespace();
        fields.map(|t| t.parse().unwrap()).collect()
    };
    for (nodes, expected) in cards {
        let deck = format!("*ELEMENT_SHELL\n       1       1{nodes}\n*END\n");
        let found = exchange(&deck, &[1]);
        let written = text(&found);
        let card = written.lines().nth(3).unwrap();
        assert_eq!(read(card), expected, "{nodes}");
        let listed = String::from_utf8(found.elements).unwrap();
        assert!(listed.contains(card), "{listed}");
    }
    // An include that is mirrored has the corners 2 1 3, and its card keeps its order.
    let deck = "*ELEMENT_SHELL\n       1       1       1       1       2       3\n*END\n";
    let mirrored = IncludedAs {
        is_mirrored: true,
        ..IncludedAs::default()
    };
    let file = SourceFile::new("a.k", deck);
    let exchange = |_| Exchange::Thickness([1.25, 1.0, 1.5, 1.375]);
    let found = exchanged(&file, mirrored, &exchange);
    let written = text(&found);
    let card = written.lines().nth(3).unwrap();
    assert_eq!(read(card), [1.0, 1.0, 1.25, 1.5]);
    let listed = String::from_utf8(found.elements).unwrap();
    let listed: Vec<&str> = listed.lines().collect();
    let nodes = "       1       1       1       1       3       2";
    assert_eq!(listed[1], nodes);
    assert_eq!(read(listed[2]), [1.0, 1.0, 1.5, 1.25]);
}

#[test]
fn a_missing_thickness_card_takes_no_other_shell() {
    let deck = "*ELEMENT_SHELL_THICKNESS\n\
\x20      1       1       1       2       3       4\n\
\x20      2       1       2       3       4       5\n\
\x20            0.9             0.9             0.9             0.9\n\
\x20      3       1       3       4       5       6\n*END\n";
    let found = exchange(deck, &[1, 2, 3]);
    let expected = format!(
        "*ELEMENT_SHELL_THICKNESS\n\
\x20      1       1       1       2       3       4\n{CARD}\n\
\x20      2       1       2       3       4       5\n{CARD}\n\
\x20      3       1       3       4       5       6\n{CARD}\n*INITIAL_STRESS_SHELL\n*END\n"
    );
    assert_eq!(text(&found), expected);
    assert_eq!((found.n_exchanged, found.n_found), (3, 3));
}

#[test]
fn states_stand_before_the_mark_that_ends_files_of_dos() {
    for end in ["\u{1a}", "\u{1a}\r\n", "\u{1a}\u{1a}"] {
        let deck = format!("*NODE\n       1             0.0\n{end}");
        let found = exchange(&deck, &[]);
        let expected = format!("*NODE\n       1             0.0\n*INITIAL_STRESS_SHELL\n{end}");
        assert_eq!(text(&found), expected);
    }
}
