//! Options of a mapping that have no effect beside the others: told, as whoever types them expects one.

use super::map::MapValues;
use crate::mapping::Quantities;

/// What the options about values depend on besides each other.
pub(super) struct Beside {
    /// How many stamped files there are.
    pub(super) n_stamped: usize,
    /// Whether factors on stresses are given.
    pub(super) has_stress_factors: bool,
    /// Whether a stamped law is given.
    pub(super) has_stamped_law: bool,
    /// Whether a deck is written.
    pub(super) is_written: bool,
}

/// Tells the options without effect.
pub(super) fn warn_of_unused(values: &MapValues, beside: &Beside) {
    for (option, why) in unused(values, beside) {
        log::warn!("--{option} has no effect: {why}");
    }
}

/// The options that were typed and have no effect, each with the reason.
fn unused(values: &MapValues, beside: &Beside) -> Vec<(&'static str, &'static str)> {
    let Quantities {
        thickness,
        plastic_strain,
        strain,
        stress,
        history,
    } = values.quantities;
    let no_layers = !(plastic_strain || strain || stress || history);
    let at_layers = "nothing that lies at layers is mapped (plastic, strain, stress, history)";
    let typed = |option: &str| values.options.is_typed(option);
    [
        ("layers", values.layers.is_some() && no_layers, at_layers),
        ("rule", values.rule.is_some() && no_layers, at_layers),
        ("n-plane", values.n_plane.is_some() && no_layers, at_layers),
        (
            "stress-factor",
            beside.has_stress_factors && !stress,
            "no stresses are mapped",
        ),
        (
            "layer-balance",
            typed("layer-balance") && !stress,
            "no stresses are mapped",
        ),
        (
            "stamped-material",
            beside.has_stamped_law && !history,
            "no history variables are mapped",
        ),
        (
            "thickness-scale",
            typed("thickness-scale") && !thickness,
            "no thickness is mapped",
        ),
        (
            "corner-thickness",
            typed("corner-thickness") && !thickness,
            "no thickness is mapped",
        ),
        (
            "fill",
            typed("fill") && !(thickness || plastic_strain),
            "neither thickness nor plastic strain is mapped",
        ),
        (
            "overlap",
            typed("overlap") && beside.n_stamped < 2,
            "there is one stamped file",
        ),
        (
            "replace-states",
            typed("replace-states") && !beside.is_written,
            "no deck is written without --out",
        ),
    ]
    .into_iter()
    .filter_map(|(option, is_unused, why)| is_unused.then_some((option, why)))
    .collect()
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::cli::{Cli, Task};

    /// The options without effect of `map` with these words.
    fn of(words: &str) -> Vec<&'static str> {
        let line = format!("shapematch map crash.k stamped.dynain {words}");
        let cli = Cli::parse_from(line.split_whitespace());
        let Some(Task::Map(args)) = cli.command else {
            panic!("{line}");
        };
        let (values, beside) = args.values_beside();
        unused(values, &beside)
            .into_iter()
            .map(|(option, _)| option)
            .collect()
    }

    #[test]
    fn options_about_what_is_not_mapped_have_no_effect() {
        for (words, expected) in [
            ("", &[][..]),
            ("--layers 5 --thickness-scale 1.1 --fill 2", &[]),
            ("--quantities thickness --layers 5", &["layers"]),
            (
                "--quantities stress --corner-thickness yes --fill 1",
                &["corner-thickness", "fill"],
            ),
            (
                "--stress-factor 1000 --stamped-material 24 --layer-balance no",
                &["stress-factor", "layer-balance", "stamped-material"],
            ),
            (
                "--quantities full --stress-factor 1000 --stamped-material 24",
                &[],
            ),
            (
                "--overlap first --replace-states yes",
                &["overlap", "replace-states"],
            ),
            ("b.dynain --overlap first", &[]),
            ("--replace-states yes --out a.k", &[]),
        ] {
            assert_eq!(of(words), expected, "{words}");
        }
    }
}
