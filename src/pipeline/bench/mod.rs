//! Benchmarks on generated pairs: how often matches are right, how times grow with the size, and how exact the
//! mapping is.

pub mod growth;
pub mod growth_page;
pub mod map;
pub mod robustness;
pub mod robustness_page;
pub mod robustness_table;
