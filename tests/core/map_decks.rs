//! `shapematch map` on decks made by hand: every form of card that is written is compared with lines
//! worked out by hand, and what cannot be carried is named.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use shapematch::formats::{Model, ReadOptions, read};
use shapematch::monitor::Monitor;

/// A folder with a crash and a stamped deck.
pub(crate) struct Pair {
    folder: tempfile::TempDir,
}

impl Pair {
    pub(crate) fn new(crash: &str, stamped: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("crash.k"), crash).unwrap();
        std::fs::write(folder.path().join("stamped.dynain"), stamped).unwrap();
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the program on both decks.
    pub(crate) fn run(&self, options: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_shapematch"))
            .current_dir(self.folder.path())
            .args(["map", "crash.k", "stamped.dynain"])
            .args(options)
            .output()
            .unwrap()
    }

    /// Runs any command of the program in the folder.
    pub(crate) fn shapematch(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
        command.current_dir(self.folder.path()).args(args);
        command.output().unwrap()
    }

    /// Runs the program on both decks as they lie.
    pub(crate) fn map(&self, options: &[&str]) -> Output {
        self.run(&[&["--identity"], options].concat())
    }

    /// The file that a successful run writes.
    #[track_caller]
    fn written(&self, options: &[&str]) -> String {
        let output = self.map(&[&["--out", "out.k"], options].concat());
        assert!(output.status.success(), "{}", errors(&output));
        std::fs::read_to_string(self.path("out.k")).unwrap()
    }

    /// The table of elements: id, status and thickness.
    #[track_caller]
    fn table(&self, options: &[&str]) -> Vec<(u64, String, String)> {
        let output = self.map(&[&["--csv", "table.csv"], options].concat());
        assert!(output.status.success(), "{}", errors(&output));
        let table = std::fs::read_to_string(self.path("table.csv")).unwrap();
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            (
                cells[0].parse().unwrap(),
                cells[2].to_owned(),
                cells[10].to_owned(),
            )
        };
        table.lines().skip(1).map(row).collect()
    }
}

pub(crate) fn errors(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

pub(crate) fn model(path: &Path) -> Model {
    read(path, &ReadOptions::default(), &Monitor::silent()).unwrap()
}

/// Nodes of a strip of `n` squares of 10, in fields of the given widths: 1 and 2 at x = 0, then 3 and 4.
pub(crate) fn strip(n: usize, widths: [usize; 2]) -> String {
    let mut deck = "*NODE\n".to_owned();
    for column in 0..=n {
        for row in 0..2 {
            let (id, x, y) = (2 * column + row + 1, 10 * column, 10 * row);
            let [i, f] = widths;
            deck += &format!(
                "{id:>i$}{:>f$}{:>f$}{:>f$}\n",
                format!("{x}.0"),
                format!("{y}.0"),
                "0.0"
            );
        }
    }
    deck
}

/// The card of the `n`-th square, counted from 0.
pub(crate) fn square(id: u64, part: u64, n: u64, width: usize) -> String {
    let first = 2 * n + 1;
    let fields = [id, part, first, first + 2, first + 3, first + 1];
    let fields = fields.map(|field| format!("{field:>width$}"));
    fields.concat() + "\n"
}

pub(crate) const SECTION: &str = "\
*PART
sheet
         7         7         5
*SECTION_SHELL
         7         2     0.833         3
       1.0       1.0       1.0       1.0
";

/// A crash deck of `n` squares (ids from 101) of part 7, with more cards before its elements.
pub(crate) fn crash(n: u64, cards: &str) -> String {
    let mut deck = format!("*KEYWORD\n{SECTION}{cards}{}", strip(n as usize, [8, 16]));
    deck += "*ELEMENT_SHELL\n";
    for i in 0..n {
        deck += &square(101 + i, 7, i, 8);
    }
    deck + "*END\n"
}

/// A stamped deck of `n` squares (ids from 1) of part 1, 0.9 thick, with the given results.
pub(crate) fn stamped(n: u64, results: &str) -> String {
    let mut deck = format!(
        "*KEYWORD\n{}*ELEMENT_SHELL_THICKNESS\n",
        strip(n as usize, [8, 16])
    );
    for i in 0..n {
        deck += &square(1 + i, 1, i, 8);
        deck += &"             0.9".repeat(4);
        deck += "\n";
    }
    deck + results + "*END\n"
}

/// Stresses of one element at three Gauss layers, all alike: xx 100, yy 50, plastic strain 0.1.
fn three_layers(id: u64) -> String {
    let mut card = format!("{id:>10}{:>10}{:>10}\n", 1, 3);
    for t in ["-.7745967", "0.0", ".77459667"] {
        card += &format!(
            "{t:>10}     100.0      50.0       0.0       0.0       0.0       0.0       0.1\n"
        );
    }
    card
}

pub(crate) fn stresses(ids: std::ops::RangeInclusive<u64>) -> String {
    let cards: Vec<String> = ids.map(three_layers).collect();
    format!("*INITIAL_STRESS_SHELL\n{}", cards.concat())
}

/// The same element as it is written, 16 columns a number.
fn three_layers_written(id: u64) -> String {
    let mut card =
        format!("{id:>10}         1         3         0         0         1         0         0\n");
    for t in [-0.774_596_669, 0.0, 0.774_596_669] {
        card += sixteen(t);
        card += "  1.00000000E+02  5.00000000E+01  0.00000000E+00  0.00000000E+00\n";
        card += "  0.00000000E+00  0.00000000E+00  1.00000000E-01\n";
    }
    card
}

fn sixteen(t: f64) -> &'static str {
    match t {
        t if t < 0.0 => " -7.74596669E-01",
        t if t > 0.0 => "  7.74596669E-01",
        _ => "  0.00000000E+00",
    }
}

const THICKNESS: &str = "  9.00000000E-01  9.00000000E-01  9.00000000E-01  9.00000000E-01";

#[test]
fn stresses_in_element_axes_are_refused_on_either_side() {
    let control =
        "*CONTROL_SHELL\n\n\n\n\n                   3\n*SET_PART\n         3\n         7\n";
    let results = stresses(1..=2);
    let pair = Pair::new(&crash(2, control), &stamped(2, &results));
    let refused = pair.map(&["--quantities", "full"]);
    assert_eq!(refused.status.code(), Some(1));
    let told = errors(&refused);
    assert!(
        told.contains("part 7 of crash.k is in part set 3"),
        "{told}"
    );
    assert!(told.contains("LISPSID"), "{told}");
    // Without stresses the frame does not matter, and other parts may be in the set.
    assert!(pair.map(&[]).status.success());
    let other = control.replace("         7\n", "         8\n");
    let pair = Pair::new(&crash(2, &other), &stamped(2, &results));
    assert!(pair.map(&["--quantities", "full"]).status.success());
    let set = "*CONTROL_SHELL\n\n\n\n\n                   3\n*SET_PART\n         3\n         1\n";
    let pair = Pair::new(&crash(2, ""), &stamped(2, &(set.to_owned() + &results)));
    let refused = pair.map(&["--quantities", "stress"]);
    let told = errors(&refused);
    assert!(
        told.contains("part 1 of stamped.dynain is in part set 3"),
        "{told}"
    );
}

/// One element with two layers, two history variables and one tensor at each.
const WITH_HISTORY: &str = "\
*INITIAL_STRESS_SHELL
         1         1         2         2         6
  -.577350     100.0       0.0       0.0       0.0       0.0       0.0       0.1
      11.0      12.0
       1.0       2.0       3.0       4.0       5.0       6.0
   .577350     -20.0       0.0       0.0       0.0       0.0       0.0       0.2
      21.0      22.0
       7.0       8.0       9.0      10.0      11.0      12.0
";

const BARLAT: &str = "*MAT_3-PARAMETER_BARLAT\n         5    7.8E-9  210000.0       0.3\n";

#[test]
fn history_keeps_its_numbers_where_stresses_are_multiplied_which_is_told() {
    let crash = crash(1, BARLAT).replace("     0.833         3\n", "     0.833         2\n");
    let sheet = stamped(1, WITH_HISTORY);
    let by_mass = "*KEYWORD\n*INCLUDE_TRANSFORM\nsheet.k\n\n\n       2.0\n\n*END\n";
    let told = |deck: &str, factor: &str| {
        let pair = Pair::new(&crash, deck);
        std::fs::write(pair.path("sheet.k"), &sheet).unwrap();
        let law = [
            "--stamped-material",
            "36",
            "--quantities",
            "full",
            "--out",
            "out.k",
        ];
        let output = pair.map(&[&law[..], &["--stress-factor", factor]].concat());
        assert!(output.status.success(), "{}", errors(&output));
        let written = model(&pair.path("out.k"));
        let card = written.forming.stresses().next().unwrap();
        let tensor = card.tensors_of(0)[0][0];
        let found = (
            card.points[0].stress[0].round(),
            card.history_of(0)[0],
            tensor.round(),
        );
        (
            found,
            errors(&output).contains("multiplied by 2; history variables"),
        )
    };
    assert_eq!(told(&sheet, "1"), ((100.0, 11.0, 1.0), false));
    assert_eq!(told(&sheet, "2"), ((200.0, 11.0, 1.0), true));
    assert_eq!(told(by_mass, "1"), ((200.0, 11.0, 1.0), true));
}

/// The nodes of a deck turned by 90° about z.
fn quarter_turned(deck: &str) -> String {
    let line = |line: &str| {
        let is_node = line.len() == 56 && line[8..24].trim().parse::<f64>().is_ok();
        if !is_node {
            return format!("{line}\n");
        }
        let [x, y]: [f64; 2] = [8..24, 24..40].map(|field| line[field].trim().parse().unwrap());
        let (x, y) = (format!("{:.1}", 0.0 - y), format!("{x:.1}"));
        format!("{}{x:>16}{y:>16}{}\n", &line[..8], &line[40..])
    };
    deck.lines().map(line).collect()
}

#[test]
fn history_and_its_tensors_go_to_the_same_law_alone() {
    let crash = crash(1, BARLAT).replace("     0.833         3\n", "     0.833         2\n");
    let pair = Pair::new(&crash, &stamped(1, WITH_HISTORY));
    // The file says nothing of its material, so its history is left out, with a hint.
    let output = pair.map(&["--out", "out.k", "--quantities", "full"]);
    assert!(output.status.success(), "{}", errors(&output));
    let told = errors(&output);
    assert!(
        told.contains("history variables of 1 element are left out"),
        "{told}"
    );
    assert!(
        told.contains("--stamped-material") && told.contains("material 36"),
        "{told}"
    );
    let plain = std::fs::read_to_string(pair.path("out.k")).unwrap();
    assert!(plain.contains("       101         1         2         0         0         1"));
    // Another law is told and left out too.
    let other = pair.map(&["--quantities", "full", "--stamped-material", "MAT_024"]);
    assert!(
        errors(&other).contains("belong to material 24"),
        "{}",
        errors(&other)
    );

    // A quarter turn about z: xx and yy of tensors change places, xy changes its sign, yz and zx turn
    // like a vector; plain numbers stay.
    let turned = quarter_turned(&crash);
    let pair = Pair::new(&turned, &stamped(1, WITH_HISTORY));
    let output = Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .current_dir(pair.folder.path())
        .args([
            "map",
            "crash.k",
            "stamped.dynain",
            "--out",
            "out.k",
            "--quantities",
            "full",
        ])
        .args([
            "--stamped-material",
            "36",
            "--pose",
            "0 -1 0 0 1 0 0 0 0 0 1 0 0 0 0 1",
        ])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", errors(&output));
    let written = std::fs::read_to_string(pair.path("out.k")).unwrap();
    let expected = "\
*INITIAL_STRESS_SHELL
       101         1         2         2         6         1         0         0
 -5.77350000E-01  0.00000000E+00  1.00000000E+02  0.00000000E+00  0.00000000E+00
  0.00000000E+00  0.00000000E+00  1.00000000E-01
  1.10000000E+01  1.20000000E+01
  2.00000000E+00  1.00000000E+00  3.00000000E+00 -4.00000000E+00  6.00000000E+00
 -5.00000000E+00
  5.77350000E-01  0.00000000E+00 -2.00000000E+01  0.00000000E+00  0.00000000E+00
  0.00000000E+00  0.00000000E+00  2.00000000E-01
  2.10000000E+01  2.20000000E+01
  8.00000000E+00  7.00000000E+00  9.00000000E+00 -1.00000000E+01  1.20000000E+01
 -1.10000000E+01
";
    // The places of the layers are those of the crash deck's rule.
    let written = written.replace("5.77350269E-01", "5.77350000E-01");
    assert!(written.contains(expected), "{written}");
    let back = model(&pair.path("crash.k"));
    assert_eq!(back.materials[0].law, "36");
}

#[test]
fn every_spelling_of_an_element_survives() {
    let mut deck = format!("*KEYWORD\n{SECTION}{}", strip(5, [8, 16]));
    deck += &format!("*ELEMENT_SHELL_BETA\n{}", square(101, 7, 0, 8));
    deck += "             1.0             1.0             1.0             1.0            45.0\n";
    deck += &format!(
        "*ELEMENT_SHELL_OFFSET\n{}            0.25\n",
        square(102, 7, 1, 8)
    );
    deck += &format!("*ELEMENT_SHELL_MCID\n{}", square(103, 7, 2, 8));
    deck += "             1.0             1.0             1.0             1.0              12\n";
    deck += &format!("*ELEMENT_SHELL_COMPOSITE\n{}", square(104, 7, 3, 8));
    deck += "         5       0.5       0.0                   5       0.5      90.0\n";
    deck += &format!("*ELEMENT_SHELL\n{}*END\n", square(105, 7, 4, 8));
    let pair = Pair::new(&deck, &stamped(5, &stresses(1..=5)));
    let written = pair.written(&[
        "--write",
        "deck",
        "--quantities",
        "thickness,plastic,stress",
    ]);
    let mut expected = format!("*KEYWORD\n{SECTION}{}", strip(5, [8, 16]));
    expected += &format!(
        "*ELEMENT_SHELL_BETA\n{}{THICKNESS}            45.0\n",
        square(101, 7, 0, 8)
    );
    expected += &format!(
        "*ELEMENT_SHELL_OFFSET\n*ELEMENT_SHELL_THICKNESS_OFFSET\n{}{THICKNESS}\n            0.25\n",
        square(102, 7, 1, 8)
    );
    expected += &format!(
        "*ELEMENT_SHELL_MCID\n{}{THICKNESS}              12\n",
        square(103, 7, 2, 8)
    );
    expected += &format!("*ELEMENT_SHELL_COMPOSITE\n{}", square(104, 7, 3, 8));
    expected += "         5       0.5       0.0                   5       0.5      90.0\n";
    expected += &format!(
        "*ELEMENT_SHELL\n*ELEMENT_SHELL_THICKNESS\n{}{THICKNESS}\n",
        square(105, 7, 4, 8)
    );
    expected += "*INITIAL_STRESS_SHELL\n";
    for id in [101, 102, 103] {
        expected += &three_layers_written(id);
    }
    // The layers of a shell with plies are these.
    let card = three_layers_written(104).replace("         3", "         2");
    let lines: Vec<&str> = card.lines().collect();
    expected += &format!("{}\n", lines[0]);
    for t in [" -5.00000000E-01", "  5.00000000E-01"] {
        expected += &format!("{t}{}\n{}\n", &lines[1][16..], lines[2]);
    }
    expected += &three_layers_written(105);
    expected += "*END\n";
    assert_eq!(written, expected);
    let back = model(&pair.path("out.k"));
    assert_eq!(back.forming.n_stress(), 5);
    let own: Vec<(f64, f64, Option<u32>)> = back
        .shell_extras
        .iter()
        .map(|e| (e.thickness[3], e.beta, e.plies))
        .collect();
    let plain = (0.9, 0.0, None);
    let with_plies = (1.0, 0.0, Some(0));
    assert_eq!(own, [(0.9, 45.0, None), plain, plain, with_plies, plain]);
    assert_eq!(back.ply_stacks, [[0.5, 0.5]]);
    // The same is told, and a file of all elements is refused because it would lose one.
    let told = pair.map(&["--out", "out.k"]);
    assert!(
        errors(&told).contains("no thickness is written for 1 element with plies"),
        "{}",
        errors(&told)
    );
    let told = pair.map(&["--out", "out.k", "--quantities", "plastic"]);
    let lines: Vec<&str> = errors(&told).lines().collect();
    assert!(
        matches!(lines[..], [line] if line.contains("nodes lie off the mid-surface")),
        "{lines:?}"
    );
    let part = pair.map(&["--out", "out.k", "--write", "part"]);
    assert_eq!(part.status.code(), Some(1));
    assert!(errors(&part).contains("would lose"), "{}", errors(&part));
}

#[test]
fn missing_partial_and_other_layers_are_kept_apart() {
    // Element 1 has three layers, 2 has none, 3 has five, 4 is four points in one layer.
    let mut results = stresses(1..=1);
    results += "         3         1         5\n";
    for t in ["-.906180", "-.538469", "0.0", ".538469", ".906180"] {
        results += &format!(
            "{t:>10}     100.0      50.0       0.0       0.0       0.0       0.0       0.1\n"
        );
    }
    results += "         4         4         1\n";
    for plastic in ["0.05", "0.15", "0.05", "0.15"] {
        results += &format!(
            "       0.0     100.0      50.0       0.0       0.0       0.0       0.0{plastic:>10}\n"
        );
    }
    let pair = Pair::new(&crash(4, ""), &stamped(4, &results));
    let written = pair.written(&["--quantities", "thickness,plastic,stress"]);
    let mut expected = "*INITIAL_STRESS_SHELL\n".to_owned();
    for id in [101, 103, 104] {
        expected += &three_layers_written(id);
    }
    assert!(written.ends_with(&(expected + "*END\n")), "{written}");
    let told = pair.map(&[]);
    assert!(
        errors(&told)
            .contains("1 element gets other values but neither stresses nor plastic strains"),
        "{}",
        errors(&told)
    );
    // The one without stresses still has its thickness; without any result it says so.
    let statuses = |options: &[&str]| -> Vec<String> {
        pair.table(options).into_iter().map(|row| row.1).collect()
    };
    assert_eq!(statuses(&[]), ["mapped"; 4]);
    assert_eq!(
        statuses(&["--quantities", "plastic"]),
        ["mapped", "no-data", "mapped", "mapped"]
    );
    // A file without any results has nothing to map but its thickness.
    let bare = Pair::new(&crash(4, ""), &stamped(4, ""));
    let none = bare.map(&["--quantities", "stress"]);
    assert_eq!(none.status.code(), Some(1));
    assert!(
        errors(&none).contains("none of the results that were asked for are in stamped.dynain"),
        "{}",
        errors(&none)
    );
    assert_eq!(
        bare.table(&[])[0],
        (101, "mapped".to_owned(), "0.9".to_owned())
    );
}

#[test]
fn ids_that_have_no_room_get_wide_cards() {
    let far = 900_000_000_000_000;
    let deck = crash(2, "");
    let (head, _) = deck.split_once("*ELEMENT_SHELL\n").unwrap();
    let elements = square(far + 1, 7, 0, 20) + &square(far + 2, 7, 1, 20);
    let deck = format!("{head}*ELEMENT_SHELL +\n{elements}*END\n");
    let pair = Pair::new(&deck, &stamped(2, &(stresses(1..=2))));
    for kind in ["deck", "part", "include"] {
        let written = pair.written(&["--write", kind, "--quantities", "full"]);
        assert!(
            written.contains("*INITIAL_STRESS_SHELL+\n     900000000000001"),
            "{written}"
        );
        let read = model(&pair.path("out.k"));
        let ids: Vec<u64> = read
            .forming
            .stresses()
            .map(|card| card.element_id)
            .collect();
        if kind != "include" {
            assert_eq!(ids, [far + 1, far + 2]);
        }
    }
}

#[test]
fn wide_decks_get_wide_cards() {
    for (keyword, ints, floats) in [("*KEYWORD I10=Y\n", 10, 16), ("*KEYWORD LONG=Y\n", 20, 20)] {
        let field = |text: &str| format!("{text:>ints$}");
        let row = |fields: &[&str]| fields.iter().map(|f| field(f)).collect::<String>() + "\n";
        let mut deck = keyword.to_owned() + "*PART\nsheet\n";
        // Fields of ten stay ten in an I10 deck, all fields are twenty in a long one.
        deck += &row(&["7", "7", "5"]);
        deck += "*SECTION_SHELL\n";
        deck += &(row(&["7", "2", "0.833", "3"]) + &row(&["1.0"; 4]));
        deck += &strip(2, [ints, floats]);
        deck += "*ELEMENT_SHELL\n";
        deck += &(square(101, 7, 0, ints) + &square(102, 7, 1, ints) + "*END\n");
        let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
        let written = pair.written(&[
            "--write",
            "deck",
            "--quantities",
            "thickness,plastic,stress",
        ]);
        let wide = |number: &str| format!("{number:>floats$}");
        let thickness = wide("9.00000000E-01").repeat(4) + "\n";
        let head = |id: &str| row(&[id, "1", "3", "0", "0", "1", "0", "0"]);
        let mut expected = "*ELEMENT_SHELL\n*ELEMENT_SHELL_THICKNESS\n".to_owned();
        expected += &(square(101, 7, 0, ints) + &thickness + &square(102, 7, 1, ints) + &thickness);
        expected += "*INITIAL_STRESS_SHELL\n";
        for id in ["101", "102"] {
            expected += &head(id);
            for t in ["-7.74596669E-01", "0.00000000E+00", "7.74596669E-01"] {
                let first = [
                    t,
                    "1.00000000E+02",
                    "5.00000000E+01",
                    "0.00000000E+00",
                    "0.00000000E+00",
                ];
                let second = ["0.00000000E+00", "0.00000000E+00", "1.00000000E-01"];
                expected += &(first.map(wide).concat() + "\n" + &second.map(wide).concat() + "\n");
            }
        }
        expected += "*END\n";
        assert!(written.ends_with(&expected), "{keyword}{written}");
        assert_eq!(model(&pair.path("out.k")).forming.n_stress(), 2);
        for quantities in ["full", "plastic,stress"] {
            let include = pair.written(&["--quantities", quantities]);
            assert!(include.starts_with(keyword), "{quantities}: {include}");
        }
    }
}

#[test]
fn mixed_formulations_get_the_layers_of_their_sections() {
    let mut deck = "*KEYWORD\n*CONTROL_SHELL\n                                                  16\n         0         1\n".to_owned();
    // Part 7 leaves its formulation to the control card and has three Lobatto layers of four points;
    // part 8 has one point in each of two Gauss layers.
    deck +=
        "*PART\nfirst\n         7         7\n*PART\nsecond\n         8         8\n*SECTION_SHELL\n";
    deck += "         7         0     0.833         3\n       1.0\n         8         2     0.833         2\n       1.0\n";
    deck += &format!("{}*ELEMENT_SHELL\n", strip(2, [8, 16]));
    deck += &(square(101, 7, 0, 8) + &square(102, 8, 1, 8) + "*END\n");
    let deck = deck.replace(
        "                                                  16\n",
        &format!("{:>50}\n", 16),
    );
    let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
    let written = pair.written(&["--quantities", "plastic,stress", "--large", "no"]);
    let mut expected = "*INITIAL_STRESS_SHELL\n".to_owned();
    let rest = " 1.000E+02 5.000E+01 0.000E+00 0.000E+00 0.000E+00 0.000E+00 1.000E-01\n";
    expected +=
        "       101         4         3         0         0         0         0         0\n";
    for t in ["-1.000E+00", " 0.000E+00", " 1.000E+00"] {
        expected += &format!("{t}{rest}").repeat(4);
    }
    expected +=
        "       102         1         2         0         0         0         0         0\n";
    for t in ["-5.774E-01", " 5.774E-01"] {
        expected += &format!("{t}{rest}");
    }
    assert!(written.ends_with(&(expected + "*END\n")), "{written}");
    // Sections with a rule of their own, and none at all, are named.
    let own = deck.replace(
        "     0.833         3\n",
        "     0.833         3                  -5\n",
    );
    let told = Pair::new(&own, &stamped(2, &stresses(1..=2))).map(&[]);
    assert!(
        errors(&told).contains("part 7 has an integration rule of its own"),
        "{}",
        errors(&told)
    );
    let none = deck.replace("*SECTION_SHELL\n", "*SECTION_NONE\n");
    let told = Pair::new(&none, &stamped(2, &stresses(1..=2))).map(&[]);
    assert!(
        errors(&told).contains("part 7 does not say how many layers"),
        "{}",
        errors(&told)
    );
}

#[test]
fn plies_are_the_layers_of_their_part() {
    let ply = |thickness: &str| format!("         1{thickness:>10}       0.0          ");
    for (option, plies) in [
        (
            "",
            format!("{}{}\n{}\n", ply("0.2"), ply("0.6"), ply("0.2")),
        ),
        (
            "_LONG",
            ["0.2", "0.6", "0.2"].map(|t| ply(t) + "\n").concat(),
        ),
    ] {
        let part = format!("*PART_COMPOSITE{option}\nfirst\n         7        16\n{plies}");
        let of_plies = |deck: String| {
            let section = "*PART\nsheet\n         7         7         5\n";
            assert!(deck.contains(section));
            deck.replace(section, &part)
        };
        // In the middle of each ply, four points.
        let pair = Pair::new(&of_plies(crash(2, "")), &stamped(2, &stresses(1..=2)));
        let written = pair.written(&["--quantities", "plastic,stress", "--large", "no"]);
        let rest = " 1.000E+02 5.000E+01 0.000E+00 0.000E+00 0.000E+00 0.000E+00 1.000E-01\n";
        let mut card =
            "       101         4         3         0         0         0         0         0\n"
                .to_owned();
        for t in ["-8.000E-01", " 0.000E+00", " 8.000E-01"] {
            card += &format!("{t}{rest}").repeat(4);
        }
        assert!(written.contains(&card), "{written}");
        // Those who name layers get them.
        let written = pair.written(&["--layers", "2", "--large", "no"]);
        assert!(
            written.contains("       101         4         2"),
            "{written}"
        );
        // A stamped part has means that weigh its plies: (0.2 * 0.3 + 0.6 * 0.1 + 0.2 * 0.2) / 1.0.
        let state =
            |t: f64, strain: f64| format!("{t:>10}{}{strain:>10}\n", "       0.0".repeat(6));
        let layers = state(-0.8, 0.3) + &state(0.0, 0.1) + &state(0.8, 0.2);
        let states = |id| format!("*INITIAL_STRESS_SHELL\n{id:>10}         1         3\n{layers}");
        let dynain = stamped(2, &(states(1) + &states(2)));
        let dynain = dynain.replacen(
            "*KEYWORD\n",
            &format!(
                "*KEYWORD\n{}",
                part.replace("\n         7 ", "\n         1 ")
            ),
            1,
        );
        let json =
            Pair::new(&crash(2, ""), &dynain).map(&["--quantities", "plastic", "--json", "-"]);
        let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        let mean = &json["plastic_strain"]["stamped"]["mean"];
        assert!((mean.as_f64().unwrap() - 0.16).abs() < 1e-12, "{json:#}");
    }
}

#[test]
fn plies_of_an_element_are_its_layers() {
    let ply = |thickness: &str| format!("         1{thickness:>10}       0.0          ");
    let three = [
        (
            "",
            format!("{}{}\n{}\n", ply("0.2"), ply("0.6"), ply("0.2")),
        ),
        (
            "_LONG",
            ["0.2", "0.6", "0.2"].map(|t| ply(t) + "\n").concat(),
        ),
    ];
    let rest = " 1.000E+02 5.000E+01 0.000E+00 0.000E+00 0.000E+00 0.000E+00 1.000E-01\n";
    for (option, plies) in three {
        let composite = |deck: String, first: &str| {
            let card = deck
                .lines()
                .find(|line| line.starts_with(first))
                .unwrap()
                .to_owned()
                + "\n";
            let others = deck.replace("*END\n", "").replacen(&card, "", 1);
            format!("{others}*ELEMENT_SHELL_COMPOSITE{option}\n{card}{plies}")
        };
        // The second element has the layers of its section, which a part of plies alone does without.
        let deck = composite(crash(2, ""), "     101       7");
        let pair = Pair::new(&deck, &stamped(2, &stresses(1..=2)));
        let written = pair.written(&["--quantities", "plastic,stress", "--large", "no"]);
        let card = |n: u32| {
            format!(
                "       101         1{n:>10}         0         0         0         0         0\n"
            )
        };
        let layers = ["-8.000E-01", " 0.000E+00", " 8.000E-01"].map(|t| format!("{t}{rest}"));
        let expected = card(3) + &layers.concat();
        assert!(written.contains(&expected), "{written}");
        assert!(written.contains("-7.746E-01"), "{written}");
        let bare = deck.replace(&deck[..deck.find("*NODE").unwrap()], "*KEYWORD\n");
        let both = composite(bare, "     102       7");
        let pair = Pair::new(&both, &stamped(2, &stresses(1..=2)));
        let written = pair.written(&["--quantities", "plastic,stress", "--large", "no"]);
        assert!(written.contains(&expected), "{written}");
        // Those who name layers get them.
        let written = pair.written(&["--layers", "2", "--large", "no"]);
        assert!(written.contains(&card(2)), "{written}");
        // In a stamped file they weigh the layers, and their sum is the thickness.
        let state =
            |t: f64, strain: f64| format!("{t:>10}{}{strain:>10}\n", "       0.0".repeat(6));
        let layers = state(-0.8, 0.3) + &state(0.0, 0.1) + &state(0.8, 0.2);
        let states = |id| format!("*INITIAL_STRESS_SHELL\n{id:>10}         1         3\n{layers}");
        let plain = crash(2, "")
            .replace("     101 ", "       1 ")
            .replace("     102 ", "       2 ");
        let first = composite(plain, "       1       7");
        let dynain = composite(first, "       2       7");
        let dynain = dynain + &states(1) + &states(2);
        let json = Pair::new(&crash(2, ""), &dynain).map(&["--json", "-"]);
        let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
        for (quantity, expected) in [("plastic_strain", 0.16), ("thickness", 1.0)] {
            let mean = &json[quantity]["stamped"]["mean"];
            assert!(
                (mean.as_f64().unwrap() - expected).abs() < 1e-12,
                "{json:#}"
            );
        }
    }
}

#[test]
fn stresses_in_another_unit_are_asked_about() {
    let pascal = stresses(1..=2).replace("     100.0      50.0", "     1.0E8     5.0E7");
    let pair = Pair::new(&crash(2, BARLAT), &stamped(2, &pascal));
    let asked = pair.map(&["--quantities", "stress"]);
    assert_eq!(asked.status.code(), Some(1));
    let told = errors(&asked);
    assert!(
        told.contains("--stress-factor 1e-6") && told.contains("another unit"),
        "{told}"
    );
    // Answered, and not of interest without stresses.
    let written = pair.written(&["--quantities", "plastic,stress", "--stress-factor", "1e-6"]);
    assert!(written.contains(&three_layers_written(101)), "{written}");
    assert!(
        pair.map(&["--quantities", "stress", "--stress-factor", "1"])
            .status
            .success()
    );
    assert!(pair.map(&[]).status.success());
    // What both decks name counts more than sizes.
    let named = crash(2, "*CONTROL_UNITS\n        MM         S      MTON\n")
        .replace("*KEYWORD\n", "*KEYWORD\n$ units ton-mm-s\n");
    let other = stamped(2, &stresses(1..=2)).replace("*KEYWORD\n", "*KEYWORD\n$ units kg-mm-ms\n");
    let asked = Pair::new(&named, &other).map(&["--quantities", "stress"]);
    let told = errors(&asked);
    assert!(told.contains("it names GPa, the crash deck MPa"), "{told}");
    assert!(told.contains("--stress-factor 1e3"), "{told}");
}

/// The elements of a deck with all x mirrored, so that their normals point to the other side.
fn mirrored(deck: &str) -> String {
    let line = |line: &str| {
        let is_node = line.len() == 56 && line[8..24].trim().parse::<f64>().is_ok();
        if is_node {
            let x: f64 = line[8..24].trim().parse().unwrap();
            format!(
                "{}{:>16}{}\n",
                &line[..8],
                format!("{:.1}", 0.0 - x),
                &line[24..]
            )
        } else {
            format!("{line}\n")
        }
    };
    deck.lines().map(line).collect()
}

#[test]
fn a_left_hand_part_serves_the_right_hand_side() {
    // Shear xy 7 beside tension: under the mirror x → −x it changes its sign.
    let results = stresses(1..=2).replace(
        "     100.0      50.0       0.0       0.0",
        "     100.0      50.0       0.0       7.0",
    );
    let pair = Pair::new(&mirrored(&crash(2, "")), &stamped(2, &results));
    let output = Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .current_dir(pair.folder.path())
        .args([
            "map",
            "crash.k",
            "stamped.dynain",
            "--out",
            "out.k",
            "--quantities",
            "plastic,stress",
        ])
        .args(["--pose", "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", errors(&output));
    let written = std::fs::read_to_string(pair.path("out.k")).unwrap();
    let line = "  1.00000000E+02  5.00000000E+01  0.00000000E+00 -7.00000000E+00\n";
    assert_eq!(written.matches(line).count(), 6, "{written}");
}

#[test]
fn several_stamped_files_and_several_crash_parts() {
    // Two stamped strips of two squares side by side, the second thicker and moved by 20, onto one
    // crash part of four squares.
    let thick = stamped(2, &stresses(1..=2)).replace("             0.9", "             1.5");
    let pair = Pair::new(&crash(4, ""), &stamped(2, &stresses(1..=2)));
    std::fs::write(pair.path("second.dynain"), thick).unwrap();
    let run = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_shapematch"))
            .current_dir(pair.folder.path())
            .args(args)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", errors(&output));
        let table = std::fs::read_to_string(pair.path("table.csv")).unwrap();
        let cells = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{} {} {} {}", cells[0], cells[1], cells[2], cells[10])
        };
        table.lines().skip(1).map(cells).collect::<Vec<String>>()
    };
    let still = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
    let moved = "1 0 0 20 0 1 0 0 0 0 1 0 0 0 0 1";
    let rows = run(&[
        "map",
        "crash.k",
        "stamped.dynain",
        "second.dynain",
        "--pose",
        still,
        "--pose",
        moved,
        "--csv",
        "table.csv",
    ]);
    let expected = [
        "101 7 mapped 0.9",
        "102 7 mapped 0.9",
        "103 7 mapped 1.5",
        "104 7 mapped 1.5",
    ];
    assert_eq!(rows, expected);
    // One stamped file onto two crash parts: the second has another section.
    let mut two = crash(
        2,
        "*PART\nsecond\n         8         8\n*SECTION_SHELL\n         8         2     0.833         2\n       1.0\n",
    );
    two = two.replace(&square(102, 7, 1, 8), &square(102, 8, 1, 8));
    std::fs::write(pair.path("crash.k"), two).unwrap();
    let rows = run(&[
        "map",
        "crash.k",
        "stamped.dynain",
        "--identity",
        "--crash-part",
        "7,8",
        "--csv",
        "table.csv",
    ]);
    assert_eq!(rows, ["101 7 mapped 0.9", "102 8 mapped 0.9"]);
    let rows = run(&[
        "map",
        "crash.k",
        "stamped.dynain",
        "--identity",
        "--crash-part",
        "8",
        "--csv",
        "table.csv",
    ]);
    assert_eq!(rows, ["102 8 mapped 0.9"]);
}

#[test]
fn sets_of_elements_have_the_format_of_the_crash_deck() {
    for (keyword, width) in [
        ("*KEYWORD\n", 10),
        ("*KEYWORD I10=Y\n", 10),
        ("*KEYWORD LONG=Y\n", 20),
    ] {
        let mut deck = keyword.to_owned();
        deck += &format!("*PART-\nsheet\n{:>10}{:>10}\n", 7, 7);
        deck += &format!(
            "*SECTION_SHELL-\n{:>10}{:>10}\n{}\n",
            7,
            2,
            "       1.0".repeat(4)
        );
        deck += "*NODE-\n";
        for (id, x, y) in [
            (1, 0, 0),
            (2, 10, 0),
            (3, 10, 10),
            (4, 0, 10),
            (5, 90, 0),
            (6, 90, 10),
        ] {
            deck += &format!("{id:>8}{x:>16}{y:>16}{:>16}\n", 0);
        }
        deck += "*ELEMENT_SHELL-\n";
        for (id, nodes) in [(101, [1, 2, 3, 4]), (102, [2, 5, 6, 3])] {
            let [a, b, c, d] = nodes;
            deck += &format!("{id:>8}{:>8}{a:>8}{b:>8}{c:>8}{d:>8}\n", 7);
        }
        let pair = Pair::new(&(deck + "*END\n"), &stamped(1, ""));
        let output = pair.map(&["--quantities", "thickness", "--unmapped", "sets.k"]);
        assert!(output.status.success(), "{}", errors(&output));
        let sets = std::fs::read_to_string(pair.path("sets.k")).unwrap();
        assert!(sets.starts_with(keyword), "{sets}");
        assert!(
            sets.contains(&format!("\n{:>width$}\n{:>width$}\n", 1, 102)),
            "{sets}"
        );
    }
}
