//! The work of the program as one call each: load, reduce, match, map, export, and the benchmarks.
//!
//! From here up the two meshes have roles: the *crash* part is fixed (target), the *stamped* part
//! moves (source). Each stage returns what it did and how long it took; nothing here prints.

pub mod autosave;
pub mod bench;
pub mod file_watch;
pub mod find_parts;
pub mod forming_values;
pub mod id_map;
pub mod inspect;
pub mod joined_parts;
pub mod likeness;
pub mod load;
pub mod map;
pub mod map_car;
pub mod match_parts;
pub mod names;
pub mod outputs;
pub mod preferences;
mod process;
pub mod project;
mod read_again;
pub mod reduce;
pub mod sweep;
mod sweep_record;
mod tools;
pub mod units;
pub mod write_file;

mod error;

pub use error::PipelineError;
pub use sweep_record::SweepRecord;

/// Milliseconds since `start`, for reports; no result depends on it.
fn millis_since(start: std::time::Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
