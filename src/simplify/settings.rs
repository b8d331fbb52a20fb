//! What a caller can choose, and what comes back.

use crate::geometry::TriMesh;
use crate::monitor::Cancelled;

/// Where the vertex that replaces an edge goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Placement {
    /// Where the quadric is least: the smaller error.
    #[default]
    Optimal,
    /// To the better end of the edge: the simplified vertices are a subset of the original ones.
    Endpoint,
}

/// How much is kept up to date after each collapse. Figures for the car floor sample, 34,808
/// triangles, as in `tests/bench/RESULTS.md`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Speed {
    /// The quadrics of the merged vertex and of all its neighbours. Two-sided rms 0.0054 mm at
    /// 20,000 triangles, 0.041 at 10,000, 0.22 at 1,000.
    #[default]
    Exact,
    /// The merged vertex's quadric only, as long as some 8,000 triangles or more are left; below it
    /// is `Exact`. 0.0056, 0.044 and 0.23 mm, for 6 to 9 % less time.
    Fast,
}

/// Choices of a simplification. `Default` is the exact one with everything protected.
#[derive(Debug, Clone, PartialEq)]
pub struct SimplifySettings {
    /// The maximum: the result has at most so many triangles, unless nothing legal is left.
    pub max_triangles: usize,
    /// Where merged vertices go.
    pub placement: Placement,
    /// Exactness against time.
    pub speed: Speed,
    /// Weight of the squared distance to a border or seam edge, times the edge's squared length,
    /// against the area-weighted squared distance to the triangles' planes. 0 leaves borders to
    /// the planes alone.
    pub boundary_weight: f64,
    /// Weight of the squared distance to the merged vertices themselves, against the planes'. It
    /// decides where the planes do not: in flat and in straight regions. Must be above 0.
    pub stiffness: f64,
    /// No triangle turns by more than this angle in one collapse, degrees, below 90.
    pub max_turn_deg: f64,
    /// Border loops may be closed once nothing else can be collapsed. Components never vanish.
    pub may_close_loops: bool,
}

impl Default for SimplifySettings {
    fn default() -> Self {
        Self {
            max_triangles: 1000,
            placement: Placement::Optimal,
            speed: Speed::Exact,
            boundary_weight: 5.0,
            stiffness: 1e-8,
            max_turn_deg: 75.0,
            may_close_loops: true,
        }
    }
}

impl SimplifySettings {
    /// The default settings with this maximum.
    pub fn to_triangles(max_triangles: usize) -> Self {
        Self {
            max_triangles,
            ..Self::default()
        }
    }

    pub(super) fn validate(&self) -> Result<(), SimplifyError> {
        let refuse = |name, value| Err(SimplifyError::BadSetting { name, value });
        if !(self.boundary_weight >= 0.0 && self.boundary_weight.is_finite()) {
            return refuse("boundary_weight", self.boundary_weight);
        }
        if !(self.stiffness > 0.0 && self.stiffness.is_finite()) {
            return refuse("stiffness", self.stiffness);
        }
        if !(self.max_turn_deg > 0.0 && self.max_turn_deg < 90.0) {
            return refuse("max_turn_deg", self.max_turn_deg);
        }
        Ok(())
    }
}

/// Why a simplification ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The maximum was reached, or the mesh was below it from the start.
    Reached,
    /// Every edge that is left is protected.
    NothingLegal {
        /// Edges whose collapse would pinch the surface, double a triangle, remove a component,
        /// or, where that is forbidden, close a border loop.
        link: usize,
        /// Edges whose collapse would turn a triangle over.
        flip: usize,
        /// Edges that run from one border or seam to another, or between two corners of such.
        feature: usize,
    },
    /// The monitor asked to stop; the result so far was kept.
    StopRequested,
}

impl std::fmt::Display for StopReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Reached => write!(f, "the maximum was reached"),
            Self::NothingLegal {
                link,
                flip,
                feature,
            } => write!(
                f,
                "nothing legal is left: of the edges {link} hold the surface together, {flip} \
                 would turn a triangle over, {feature} join borders or seams"
            ),
            Self::StopRequested => write!(f, "stopped on request"),
        }
    }
}

/// What a simplification did.
#[derive(Debug, Clone, PartialEq)]
pub struct SimplifyReport {
    /// Triangles of the mesh that came in.
    pub triangles_before: usize,
    /// Triangles of the result.
    pub triangles_after: usize,
    /// Why it ended.
    pub stop_reason: StopReason,
}

/// A simplified mesh with its ties to the original.
#[derive(Debug, Clone, PartialEq)]
pub struct Simplified {
    /// The mesh. Its triangles are survivors of the original in their order, with original
    /// orientation; there are no unused vertices.
    pub mesh: TriMesh,
    /// For each triangle of `mesh`, the triangle of the original it descends from.
    pub triangle_of: Vec<u32>,
    /// For each vertex of the original, the vertex of `mesh` it was merged into; `u32::MAX` if the
    /// original vertex has no triangle.
    pub vertex_of: Vec<u32>,
    /// What was done.
    pub report: SimplifyReport,
}

/// Why there is no result.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SimplifyError {
    /// A setting is out of its range.
    #[error("the setting {name} cannot be {value}")]
    BadSetting {
        /// The setting's name.
        name: &'static str,
        /// Value it was given.
        value: f64,
    },
    /// The list of parts does not fit the mesh.
    #[error("{n_labels} part labels were given for {n_triangles} triangles")]
    LabelCount {
        /// Number of labels given.
        n_labels: usize,
        /// Triangles of the mesh.
        n_triangles: usize,
    },
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
