//! The words of every choice: value => name, label, help. The compiler refuses a value without a row.

use super::{Choice, ChoiceWords};
use crate::mapping::{MapMethod, NormalSense, Overlap};
use crate::registration::{
    DataSide, Floor, Hand, Method, Metric, Motion, PairSelection, PairWith, Search, StartMethod,
};

/// One table: the value, with the parameters it has in menus, then name, label, help.
macro_rules! choices {
    ($type:ty: $(
        $variant:ident $({ $($field:ident: $value:expr),* })? =>
        $name:literal, $label:literal, $help:literal;
    )*) => {
        impl Choice for $type {
            const ALL: &'static [Self] = &[$(Self::$variant $({ $($field: $value),* })?),*];

            fn words(self) -> ChoiceWords {
                match self {
                    $(Self::$variant { .. } => ChoiceWords {
                        name: $name,
                        label: $label,
                        help: $help,
                    },)*
                }
            }
        }
    };
}

choices! { Method:
    Fractional => "fractional", "Fractional ICP",
        "Estimates pose and overlap together; the default";
    Umeyama => "umeyama", "Umeyama",
        "Closed form; both meshes must have the same nodes in the same order";
    Icp => "icp", "ICP",
        "Iterative closest point with all pairs; for parts that cover each other completely";
    Trimmed => "trimmed", "Trimmed ICP",
        "Iterative closest point with a given fraction of the pairs";
    TrimmedSearch => "trimmed-search", "Trimmed ICP, overlap estimated",
        "Iterative closest point that estimates the fraction of the pairs to keep";
    Paper => "paper", "Fractional ICP as in the paper",
        "Node to node, point to point, no floor, every start iterated to convergence";
}

choices! { StartMethod:
    SurfaceNormals => "surface-normal", "Align surface normals",
        "Aligns centroids and mean normals, then rotates in steps about the normal; where one part is \
         a piece of the other, the wide search does the same patch by patch";
    CurrentPose => "current", "Current pose",
        "Starts from the current pose, for example one set by hand";
    GivenPoses => "given", "Given poses",
        "Starts from a list of poses";
    All => "all", "All methods",
        "All of these, principal axes, and a uniform set of rotations";
}

choices! { DataSide:
    Auto => "auto", "Automatic",
        "The part that the other one contains; both are tried if neither contains the other";
    Source => "stamped", "Stamped part",
        "Nodes of the stamped part against the crash part";
    Target => "crash", "Crash part",
        "Nodes of the crash part against the stamped part";
}

choices! { PairWith:
    Node => "node", "Closest node",
        "Pairs nodes with nodes; only as accurate as the mesh is fine";
    Triangle => "triangle", "Closest point",
        "Pairs nodes with points on triangles; accurate on any mesh";
}

choices! { PairSelection:
    All => "all", "All pairs",
        "Keeps every pair; for parts that cover each other completely";
    Trimmed { overlap: PairSelection::USUAL_OVERLAP } => "trimmed", "Trimmed",
        "Keeps a given fraction of the pairs, the closest first";
    TrimmedSearch => "trimmed-search", "Trimmed, overlap estimated",
        "As trimmed, with the fraction estimated in each iteration";
    Fractional { lambda: PairSelection::USUAL_LAMBDA, floor: Floor::Auto } => "fractional", "Fractional",
        "Keeps the fraction with the least fractional RMS distance; the default";
}

choices! { Metric:
    PointToPoint => "point-to-point", "Point to point",
        "Distances between paired points; slow but robust, as in the paper";
    PointToPlane => "point-to-plane", "Point to plane",
        "Distances along the normals of one part; few iterations";
    Symmetric => "symmetric", "Symmetric",
        "Distances along the normals of both parts; few iterations, widest basin of convergence";
}

choices! { Motion:
    Rigid => "rigid", "Rigid",
        "Rotation and translation; lengths stay as they are";
    Similarity => "similarity", "Rigid with scale",
        "Also a scale factor c; a free scale shrinks parts that only partly overlap";
}

choices! { Hand:
    Same => "same", "Same hand",
        "The part as it is";
    Mirrored => "opposite", "Opposite hand",
        "The mirrored part: left-hand for right-hand";
    Either => "either", "Either hand",
        "Both; the better fit is kept";
}

choices! { Search:
    CoarseToFine => "coarse-to-fine", "Coarse to fine",
        "All starts on few points; only the best distinct ones are refined";
    EveryStart => "every-start", "Every start to convergence",
        "All starts on all points, as in the paper; slow";
}

choices! { MapMethod:
    Area => "area", "Area mean",
        "Mean over points of the crash element, each with the linear field around its stamped element";
    Nearest => "nearest", "Nearest",
        "Value of the stamped element nearest to the centre, as the solver does";
    Shape => "shape", "Shape",
        "Means at the stamped nodes, interpolated by shape functions; ridges become lower";
}

choices! { NormalSense:
    Auto => "auto", "Automatic",
        "The same side where at least 90 % of the area agree on it";
    Signed => "yes", "Same side",
        "Only sheets that face the same side";
    Either => "no", "Either side",
        "Both sides of the sheet";
}

choices! { Overlap:
    Nearest => "nearest", "Nearest",
        "The nearer sheet";
    First => "first", "First",
        "The stamped part named first";
    Thicker => "thicker", "Thicker",
        "The thicker sheet";
}
