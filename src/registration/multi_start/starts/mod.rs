//! First poses. Each is a motion of the source (already mirrored, if so asked) to the target.

mod covering;
mod frames;
mod surface_normals;

use serde::{Deserialize, Serialize};

pub use covering::super_fibonacci;
pub(crate) use frames::axes_on_axes;
pub use surface_normals::align_surface_normals;

use crate::geometry::{Point3, Pose, Rotation, Similarity};
use crate::registration::surface::Surface;
use crate::registration::{RegistrationError, limits};

/// Where first poses come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartMethod {
    /// Centroids and mean normals aligned, then rotated in steps about the normal.
    #[default]
    SurfaceNormals,
    /// Both parts as they lie.
    CurrentPose,
    /// The poses of [`StartSettings::poses`].
    GivenPoses,
    /// All of these, principal frames, and a covering of all rotations.
    All,
}

/// Which first poses are tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StartSettings {
    /// Where they come from.
    pub method: StartMethod,
    /// Largest angle between neighbouring rotations about the mean normal, 1° to 60°; 40° gives
    /// nine rotations.
    pub angle_segment_deg: f64,
    /// Try both directions of the mean normal, for parts whose elements are oriented oppositely.
    pub both_signs: bool,
    /// Poses `target_from_source` for [`StartMethod::GivenPoses`].
    pub poses: Vec<Similarity>,
    /// Search all rotations, both directions of the normals and, where the sizes differ, all places of
    /// the larger part, and run what survives like the other starts. Where poses are given, only if
    /// none of them gives an acceptable fit.
    pub wide_search: bool,
}

impl Default for StartSettings {
    fn default() -> Self {
        Self {
            method: StartMethod::default(),
            angle_segment_deg: 40.0,
            both_signs: true,
            poses: Vec::new(),
            wide_search: true,
        }
    }
}

impl StartSettings {
    /// How many rotations the angle segment stands for, or why it is refused.
    pub fn n_rotations(&self) -> Result<usize, RegistrationError> {
        let degrees = self.angle_segment_deg;
        if !limits::ANGLE_SEGMENT_DEG.contains(&degrees) {
            return Err(RegistrationError::AngleSegment { degrees });
        }
        Ok((360.0 / degrees - 1e-9).ceil() as usize)
    }

    /// Whether the source's normals count reversed, in each of the directions that are tried.
    fn signs(&self) -> &'static [bool] {
        if self.both_signs {
            BOTH_SIGNS
        } else {
            &[false]
        }
    }
}

/// How a start came to be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartKind {
    /// Mean normals aligned, then rotated by `angle_deg`.
    SurfaceNormal {
        /// Rotation about the mean normal, in degrees.
        angle_deg: f64,
    },
    /// "Align surface normals" in its local form, from the wide search: the mean normal around the
    /// middle of the smaller part on that of a patch as large of the larger part.
    Patch {
        /// Number of the patch.
        patch: usize,
        /// Rotation about the patch's mean normal, in degrees.
        angle_deg: f64,
    },
    /// Principal axes aligned, one of four choices of signs.
    PrincipalFrame {
        /// Number of the choice.
        signs: usize,
    },
    /// One rotation of a covering of all rotations, centroids aligned.
    Covering {
        /// Number of the rotation.
        index: usize,
    },
    /// One rotation of the wide search's covering, at one place of the larger part.
    Wide {
        /// Number of the rotation.
        rotation: usize,
        /// Number of the place; at the first the centroids lie on each other.
        place: usize,
    },
    /// Where the parts lay.
    CurrentPose,
    /// A pose passed in.
    Given {
        /// Number in the list.
        index: usize,
    },
    /// A good pose moved to another place of the larger part that is shaped alike, to find rivals.
    Alike {
        /// Number of the place, the most alike first.
        index: usize,
    },
    /// A good pose rotated by 180° about one of the part's principal axes, to find twins.
    Twin {
        /// Number of the axis.
        axis: usize,
    },
    /// A good pose of a part with like sectors, turned by a share of a full turn.
    Turned {
        /// Number of the angle, from the smallest on.
        index: usize,
    },
}

/// A first pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// How it came to be.
    pub kind: StartKind,
    /// True if the source's normals count reversed.
    pub flipped: bool,
    /// The pose it starts from.
    pub target_from_source: Similarity,
}

/// The source's normals as they are, and reversed.
const BOTH_SIGNS: &[bool] = &[false, true];
/// Number of rotations in the covering: 60 lie within 45° of every rotation.
const N_COVERING: usize = 60;

/// The starts that `settings` ask for.
pub(crate) fn starts(
    source: &Surface,
    target: &Surface,
    settings: &StartSettings,
) -> Result<Vec<Start>, RegistrationError> {
    let n_rotations = settings.n_rotations()?;
    let mut found = Vec::new();
    let all = settings.method == StartMethod::All;
    if all || settings.method == StartMethod::CurrentPose {
        let here = [(StartKind::CurrentPose, Similarity::identity())];
        found.extend(with_signs(here, settings.signs()));
    }
    if all || settings.method == StartMethod::GivenPoses {
        let given = settings.poses.iter().enumerate();
        let given = given.map(|(index, pose)| (StartKind::Given { index }, *pose));
        found.extend(with_signs(given, settings.signs()));
    }
    if all || settings.method == StartMethod::SurfaceNormals {
        found.extend(surface_normals::starts(
            source,
            target,
            n_rotations,
            settings.signs(),
        ));
    }
    if all {
        found.extend(with_signs(frames::poses(source, target), BOTH_SIGNS));
        found.extend(with_signs(
            covering::poses(source, target, N_COVERING),
            BOTH_SIGNS,
        ));
    }
    if found.is_empty() {
        return Err(RegistrationError::NoStarts);
    }
    Ok(found)
}

fn with_signs(
    poses: impl IntoIterator<Item = (StartKind, Similarity)>,
    signs: &[bool],
) -> Vec<Start> {
    poses
        .into_iter()
        .flat_map(|(kind, target_from_source)| {
            signs.iter().map(move |&flipped| Start {
                kind,
                flipped,
                target_from_source,
            })
        })
        .collect()
}

/// The motion that rotates by `rotation` and moves `from` to `to`.
fn rotation_about(rotation: Rotation, from: &Point3, to: &Point3) -> Similarity {
    let translation = to.coords - rotation * from.coords;
    Pose::from_parts(translation.into(), rotation).into()
}
