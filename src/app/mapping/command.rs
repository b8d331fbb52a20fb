//! Commands of section 4.

use std::path::PathBuf;

use super::FurtherPose;
use crate::mapping::MapOptions;
use crate::pipeline::map::MapRecipe;
use crate::units::Units;

/// Commands of section 4.
#[derive(Debug, Clone)]
pub enum MapCommand {
    /// Other quantities.
    SetRecipe(Box<MapRecipe>),
    /// Another method or limit; several in a row are one step, as a drag sends them.
    SetOptions(Box<MapOptions>),
    /// Ask for a further stamped file.
    AskFurther,
    /// Read a further stamped file and match it with the crash part.
    AddFurther(PathBuf),
    /// Take a further stamped file out of the list, or give its reading up.
    RemoveFurther(u64),
    /// Where the pose of a further stamped file comes from.
    SetFurtherPose(u64, FurtherPose),
    /// The units of a further stamped file, or that its lengths are those of the first one.
    SetFurtherUnits(u64, Option<Units>),
    /// Match a further stamped file anew.
    MatchFurther(u64),
    /// End the running match of a further stamped file with the best pose so far.
    StopFurther,
    /// Map, or give the running mapping up.
    MapOrCancel,
    /// Map where the stamped file has its part, without a match.
    MapAsLoaded,
    /// Look at an element of the current mapping closely, or no longer.
    Probe(Option<usize>),
    /// Pin an element of the crash part for the report, or take its pin away.
    TogglePin(u64),
    /// Ask for another mapper's result, or give the running comparison up.
    AskOther,
    /// Compare the current mapping with another mapper's result.
    CompareWith(PathBuf),
    /// Compare no longer.
    EndComparison,
}
