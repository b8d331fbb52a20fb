//! Ratios of two poses in words.

use crate::text::whole_percent;

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
    by_ratio(score_ratio, ["more likely", "as likely", "less likely"])
}

/// How an alternative that is shown fits beside the best pose, as a sentence. The error is what the match minimised,
/// which is not the RMS of all distances that stands beside it.
pub fn alternative_words(score_ratio: f64, by_shape: bool) -> String {
    let worse = whole_percent(score_ratio - 1.0);
    if worse == whole_percent(0.0) {
        "An alternative: it fits as well as the best pose.".to_owned()
    } else if by_shape {
        let likely = likely_beside(score_ratio);
        format!("An alternative: by its shape it is {likely} than the best pose.")
    } else {
        format!(
            "An alternative: the error that the match minimised is {worse} higher than at the best pose."
        )
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
    by_ratio(
        score_ratio,
        ["at least as well", "equally well", "nearly as well"],
    )
}

/// The words for a pose that is better than the best, equal to it, or worse. The difference of equal ones rounds to 0
/// %.
fn by_ratio(score_ratio: f64, [better, equal, worse]: [&'static str; 3]) -> &'static str {
    match score_ratio {
        ratio if (ratio - 1.0).abs() < 0.005 => equal,
        ratio if ratio < 1.0 => better,
        _ => worse,
    }
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
