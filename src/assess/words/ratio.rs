//! Ratios of two poses in words.

/// How another pose fits beside the best, by its error, or by what its shape says of it: "error 8 % higher",
/// "less likely by its shape".
pub fn fit_beside(score_ratio: f64, by_shape: bool) -> String {
    if by_shape {
        format!("{} by its shape", likely_beside(score_ratio))
    } else {
        error_beside(score_ratio)
    }
}

/// How likely another pose is beside the best, where the shapes say so: "as likely".
pub fn likely_beside(score_ratio: f64) -> &'static str {
    match score_ratio {
        ratio if is_equal(ratio) => "as likely",
        ratio if ratio < 1.0 => "more likely",
        _ => "less likely",
    }
}

/// The error of another pose beside that of the best: "error 8 % higher", "error 5.6 × lower".
pub(super) fn error_beside(score_ratio: f64) -> String {
    match beside(score_ratio) {
        equal if equal == EQUAL => format!("{equal} error"),
        differs => format!("error {differs}"),
    }
}

/// How the opposite hand fits better.
pub fn fit_of_hand(score_ratio: f64, by_borders: bool) -> String {
    if by_borders {
        "more borders and holes lie together".to_owned()
    } else {
        error_beside(score_ratio)
    }
}

/// How well another pose fits beside the best: "equally well", "nearly as well".
pub fn as_well(score_ratio: f64) -> &'static str {
    match score_ratio {
        ratio if is_equal(ratio) => "equally well",
        ratio if ratio < 1.0 => "at least as well",
        _ => "nearly as well",
    }
}

/// Whether the difference rounds to 0 %.
fn is_equal(score_ratio: f64) -> bool {
    (score_ratio - 1.0).abs() < 0.005
}

const EQUAL: &str = "equal";

/// The same without what it is said of: "8 % higher", "5.6 × lower", "equal".
pub fn beside(score_ratio: f64) -> String {
    let (times, how) = if score_ratio < 1.0 {
        (score_ratio.recip(), "lower")
    } else {
        (score_ratio, "higher")
    };
    match times {
        t if t < 1.0005 => EQUAL.to_owned(),
        // Less than half a percent is said with the digit that tells it from none.
        t if t < 1.005 => format!("{:.1} % {how}", 100.0 * (score_ratio - 1.0).abs()),
        t if t < 2.0 => format!("{:.0} % {how}", 100.0 * (score_ratio - 1.0).abs()),
        t if t.is_finite() => format!("{t:.1} × {how}"),
        _ => format!("far {how}"),
    }
}
