//! Unit tests of parameters.

use proptest::prelude::*;

use super::*;

fn read(table: &mut ParameterTable, keyword: &str, text: &str) -> Vec<ParameterProblemAt> {
    let keyword = ParameterKeyword::parse(keyword).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    table.read_block(keyword, &lines, 10)
}

fn table(blocks: &[(&str, &str)]) -> ParameterTable {
    let mut table = ParameterTable::new();
    for (keyword, text) in blocks {
        assert_eq!(read(&mut table, keyword, text), [], "{text}");
    }
    table
}

#[test]
fn every_way_of_writing_a_pair() {
    let table = table(&[
        ("parameter", "rterm, 0.2, istaTES, 80 "),
        ("PARAMETER", "r E          12.3\nr pR          00.321"),
        (
            "PARAMETER_NOECHO",
            "R   thick      1.5-3I     pid         17",
        ),
        ("PARAMETER", "cpaR1, foo, CPar2, bar"),
        ("PARAMETER", "I    copy       &pidR     neg        -&e"),
        ("PARAMETER", "R loose 2.5"),
        ("PARAMETER_TYPE", "I      nid       100       NID"),
        ("parameter_expression", "rPlot, tErm/(States-30)"),
        (
            "PARAMETER_EXPRESSION",
            "R     both   max(plot,\n             4.0) + 1.0",
        ),
    ]);
    let expected = [
        ("term", Value::Real(0.2)),
        ("STATES", Value::Int(80)),
        ("e", Value::Real(12.3)),
        ("&pr", Value::Real(0.321)),
        ("thick", Value::Real(1.5e-3)),
        ("pid", Value::Int(17)),
        ("par1", Value::Text("foo".into())),
        ("Par2", Value::Text("bar".into())),
        ("copy", Value::Int(17)),
        ("neg", Value::Real(-12.3)),
        ("loose", Value::Real(2.5)),
        ("nid", Value::Int(100)),
        ("plot", Value::Real(0.004)),
        ("both", Value::Real(5.0)),
    ];
    for (name, value) in expected {
        assert_eq!(table.resolve(name), Some(&value), "{name}");
    }
}

#[test]
fn long_fields_are_twenty_wide() {
    let mut table = ParameterTable::new();
    let line = format!("{:<20}{:>20}{:<20}{:>20}", "R a", "1.25", "I b", "7");
    let keyword = ParameterKeyword::parse("PARAMETER").unwrap();
    assert_eq!(table.read_block(keyword, &[&line], 20), []);
    assert_eq!(table.resolve("a"), Some(&Value::Real(1.25)));
    assert_eq!(table.resolve("b"), Some(&Value::Int(7)));
}

#[test]
fn fields_with_parameters() {
    let table = table(&[("PARAMETER", "rthk, 1.5, ipid, 3, cname, door")]);
    let value = |text| table.field(text).transpose();
    assert_eq!(value("1.5"), Ok(None));
    assert_eq!(value(" &THK "), Ok(Some(Value::Real(1.5))));
    assert_eq!(value("-&pid"), Ok(Some(Value::Int(-3))));
    assert_eq!(value("&thk/3."), Ok(Some(Value::Real(0.5))));
    assert_eq!(value("<thk*pid>"), Ok(Some(Value::Real(4.5))));
    assert_eq!(
        value("&nope"),
        Err(ParameterError::Unresolved("nope".into()))
    );
    assert_eq!(
        value("-&name"),
        Err(ParameterError::NotANumber("name".into()))
    );
    assert!(matches!(value("&"), Err(ParameterError::Expression(_))));
    assert_eq!(table.substitute("a/&name^_&pid.k"), "a/door_3.k");
    assert_eq!(table.substitute("&&x &"), "&&x &");
}

#[test]
fn a_local_parameter_ends_with_its_file() {
    let mut table = table(&[("PARAMETER", "rgbl, 200., rloc, 1.")]);
    table.push_scope();
    table.push_scope();
    assert_eq!(
        read(&mut table, "PARAMETER_LOCAL", "Rloc          999.0"),
        []
    );
    assert_eq!(table.resolve("loc"), Some(&Value::Real(999.0)));
    table.push_scope();
    assert_eq!(
        table.resolve("loc"),
        Some(&Value::Real(999.0)),
        "seen below"
    );
    table.pop_scope();
    table.pop_scope();
    assert_eq!(table.resolve("loc"), Some(&Value::Real(1.0)));
    assert_eq!(table.resolve("gbl"), Some(&Value::Real(200.0)));
    table.pop_scope();
    table.pop_scope();
}

#[test]
fn second_definitions() {
    let case = |flag: Option<i64>, first: &str| {
        let mut table = ParameterTable::new();
        if let Some(flag) = flag {
            assert!(table.set_duplication(Duplication::from_flag(flag)));
            assert!(!table.set_duplication(Duplication::TakeLater));
        }
        read(&mut table, first, "rx, 1.0");
        let diagnostics = read(&mut table, "PARAMETER", "rx, 2.0");
        (table.resolve("x").cloned(), diagnostics.len())
    };
    assert_eq!(case(None, "PARAMETER"), (Some(Value::Real(1.0)), 1));
    assert_eq!(case(Some(1), "PARAMETER"), (Some(Value::Real(1.0)), 1));
    assert_eq!(case(Some(2), "PARAMETER"), (Some(Value::Real(2.0)), 1));
    assert_eq!(case(Some(4), "PARAMETER"), (Some(Value::Real(2.0)), 0));
    assert_eq!(case(Some(5), "PARAMETER"), (Some(Value::Real(1.0)), 0));
    assert_eq!(case(None, "PARAMETER_MUTABLE"), (Some(Value::Real(2.0)), 0));
}

#[test]
fn findings_have_a_place() {
    let mut table = ParameterTable::new();
    let diagnostics = read(
        &mut table,
        "PARAMETER",
        "rok, 1, ibad, x1\n1abc, 3\nrtime, 1",
    );
    let places: Vec<_> = diagnostics.iter().map(|f| (f.line_idx, f.column)).collect();
    assert_eq!(places, [(0, 15), (1, 1), (2, 1)]);
    let text = "R        x2.0*\n          (1.0 + nope)";
    let diagnostics = read(&mut table, "PARAMETER_EXPRESSION", text);
    assert_eq!((diagnostics[0].line_idx, diagnostics[0].column), (1, 18));
    assert_eq!(ParameterKeyword::parse("PARAMETER_DUPLICATION"), None);
    assert_eq!(ParameterKeyword::parse("PARAMETERS"), None);
}

proptest! {
    #[test]
    fn never_panics(
        lines in proptest::collection::vec("[-+*/()., &a-zé0-9<>]{0,60}", 0..5),
        expression: bool,
    ) {
        let mut table = ParameterTable::new();
        let keyword = if expression { "PARAMETER_EXPRESSION" } else { "PARAMETER_LOCAL" };
        let keyword = ParameterKeyword::parse(keyword).unwrap();
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        table.read_block(keyword, &lines, 10);
        for line in lines {
            table.field(line);
            table.substitute(line);
        }
    }
}
