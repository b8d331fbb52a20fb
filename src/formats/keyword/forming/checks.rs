//! Results that can be read and make no sense.

use super::super::super::diagnostic::DiagnosticKind;
use super::super::card::{Card, FieldError};
use super::Reader;

/// Layers farther out than this are no places in a sheet; T has three digits or more.
const MOST_T: f64 = 1.001;

/// A plastic strain below this is no rounding of zero.
const LEAST_PLASTIC_STRAIN: f64 = -1e-6;

/// The square of a larger stress or strain is still a number, and so is its turned tensor.
const MAX_TENSOR: f64 = 1e100;

impl Reader<'_, '_> {
    /// Names a tensor that cannot be turned without leaving the range of numbers.
    pub(super) fn check_size(&mut self, head: &Card<'_>, tensor: &[f64; 6]) {
        let largest = tensor.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if largest <= MAX_TENSOR || self.bad_field.is_some() {
            return;
        }
        let error = FieldError {
            kind: DiagnosticKind::NumberTooLarge,
            column: 0,
            found: format!("{largest:e}"),
            expected: "stresses and strains of at most 1e100",
        };
        let what = "the element's result";
        self.diagnostics
            .push_with(error.kind, || head.diagnose(&error, what));
        self.bad_field = Some(error);
    }

    /// Names layers that lie nowhere in a sheet, whose element is left out, and layers that all lie in one
    /// place, of which a mapping can take the mean alone.
    pub(super) fn check_places(
        &mut self,
        head: &Card<'_>,
        n_thick: usize,
        places: impl Iterator<Item = f64>,
    ) {
        let ends = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
            (low.min(t), high.max(t))
        });
        if self.bad_field.is_some() {
            return;
        }
        if let Some(t) = [ends.0, ends.1].into_iter().find(|t| t.abs() > MOST_T) {
            let error = FieldError {
                kind: DiagnosticKind::BadForming,
                column: 0,
                found: format!("T = {t}"),
                expected: "places of the layers from -1 to 1",
            };
            let message =
                "the layers of an element lie outside of its sheet, and its results are left out";
            self.tell(head, error.kind, message, &error.found, error.expected);
            self.bad_field = Some(error);
        } else if n_thick > 1 && ends.0 == ends.1 {
            let message = "all layers of an element lie in one place and are mapped as their mean";
            let found = format!("T = {}", ends.0);
            self.tell(
                head,
                DiagnosticKind::DoubtfulForming,
                message,
                &found,
                "different T",
            );
        }
    }

    fn tell(
        &mut self,
        head: &Card<'_>,
        kind: DiagnosticKind,
        message: &str,
        found: &str,
        expected: &str,
    ) {
        self.diagnostics.push_with(kind, || {
            let finding = self.block.diagnose(kind, message).at(head.position(0));
            finding.found(found).expected(expected)
        });
    }

    /// Names a plastic strain that cannot be.
    pub(super) fn check_plastic_strain(
        &mut self,
        head: &Card<'_>,
        values: impl Iterator<Item = f64>,
    ) {
        let least = values.fold(0.0, f64::min);
        if least < LEAST_PLASTIC_STRAIN {
            let message = "a plastic strain below 0 counts as 0 when it is mapped";
            let (kind, found) = (DiagnosticKind::DoubtfulForming, format!("{least:e}"));
            self.tell(head, kind, message, &found, "0 or more");
        }
    }
}
