//! What the process itself has used, for the benchmarks. Linux has it in `/proc`; elsewhere nothing is
//! known.

use std::fs::read_to_string;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// How often the memory is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(1);
/// Bytes of a page, and clock ticks of a second, on all systems that this is measured on.
const PAGE: usize = 4096;
const TICK_MS: f64 = 10.0;

/// Processor time of all threads so far, milliseconds.
pub(super) fn cpu_ms() -> Option<f64> {
    let text = read_to_string("/proc/self/stat").ok()?;
    // The name in brackets may hold blanks; user and system time are the 12th and 13th field after it.
    let fields = text.rsplit_once(')')?.1.split_whitespace().skip(11).take(2);
    let ticks: Option<Vec<f64>> = fields.map(|field| field.parse().ok()).collect();
    Some(ticks?.iter().sum::<f64>() * TICK_MS)
}

/// Memory in use, bytes.
pub(super) fn resident_bytes() -> Option<usize> {
    let text = read_to_string("/proc/self/statm").ok()?;
    let pages: usize = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * PAGE)
}

/// Set at the end of a scope, also where a panic ends it: the thread that waits for it ends too.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// What `work` returns, and the most memory that was in use meanwhile.
pub(super) fn with_peak<T>(work: impl FnOnce() -> T) -> (T, Option<usize>) {
    let is_done = AtomicBool::new(false);
    let peak = AtomicUsize::new(0);
    let result = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_done.load(Ordering::Relaxed) {
                peak.fetch_max(resident_bytes().unwrap_or(0), Ordering::Relaxed);
                std::thread::sleep(LOOK_EVERY);
            }
        });
        let _done = SetOnDrop(&is_done);
        work()
    });
    let peak = peak.into_inner();
    (result, (peak > 0).then_some(peak))
}
