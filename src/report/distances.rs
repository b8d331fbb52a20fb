//! Distances and shares that stand in several places: one name for each quantity, and what it is measured over.

/// A quantity under its one name.
#[derive(Debug, Clone, Copy)]
pub struct MeasureName {
    /// As it is shown.
    pub name: &'static str,
    /// Over what it is measured.
    pub help: &'static str,
}

/// The spread of [`Coverage`](crate::assess::Coverage).
pub const OVERLAP_SPREAD: MeasureName = MeasureName {
    name: "RMS · P95 of the overlap",
    help: "Distances of the nodes of the full meshes that lie within the overlap limit, weighted by area; the larger \
           of both directions",
};

/// What [`Coverage`](crate::assess::Coverage) calls overlap.
pub const OVERLAP_HELP: &str = "Share of this part's area whose nodes lie within the limit of the other part, full \
                                meshes, whatever their normals; the verdict's sentence counts places with like \
                                normals alone";

/// Root mean square of [`DeviationStats`](crate::assess::deviation::DeviationStats).
pub const COMPARED_RMS: MeasureName = MeasureName {
    name: "RMS (compared)",
    help: "Of all the area that has a counterpart, also beyond the overlap limit; full meshes, one direction",
};

/// What 95 % of the same stay below.
pub const COMPARED_P95: MeasureName = MeasureName {
    name: "P95 (compared)",
    help: "What 95 % of the area that has a counterpart stay below, also beyond the overlap limit; full meshes, one \
           direction",
};

/// How far the pairs of an iteration lie apart: `rmse` in registration and in records.
pub const RESIDUAL: MeasureName = MeasureName {
    name: "residual",
    help: "RMS of the pairs that the last iteration of the start kept, on the points and meshes it ran on",
};

/// What 95 % of the same stay below.
pub const PAIRS_P95: MeasureName = MeasureName {
    name: "P95 (pairs)",
    help: "What 95 % of the pairs that the last iteration of the start kept stay below, on the points and meshes it \
           ran on",
};

/// Which share of the stamped part an iteration stands on.
pub const KEPT: MeasureName = MeasureName {
    name: "kept",
    help: "Share of the stamped area whose pairs the last iteration of the start kept; no overlap, which the verdict \
           states",
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_quantities_have_one_name() {
        let all = [
            OVERLAP_SPREAD,
            COMPARED_RMS,
            COMPARED_P95,
            RESIDUAL,
            PAIRS_P95,
            KEPT,
        ];
        for (k, one) in all.iter().enumerate() {
            let others = &all[k + 1..];
            assert!(others.iter().all(|other| other.name != one.name));
            assert!(others.iter().all(|other| other.help != one.help));
        }
    }
}
