use super::RegistrationError;
use super::correspondence::PairWith;
use super::metric::Metric;
use super::select::{Floor, Selection};
use super::starts::StartSettings;
use super::umeyama::Motion;
use serde::{Deserialize, Serialize};

/// The methods by name; each is a choice of pairs, selection, metric and search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Closed form for meshes with the same node numbering.
    Umeyama,
    /// All pairs count.
    Icp,
    /// The given share of the pairs counts.
    Trimmed,
    /// A share found by itself counts, searched in 0.4 … 1.
    TrimmedSearch,
    /// Fractional ICP with a floor, the default.
    #[default]
    Fractional,
    /// Fractional ICP as in the paper: node to node, point to point, no floor, every start run to
    /// its end, λ 3 and then 0.95.
    Paper,
}

impl Method {
    /// Every method, in the order of menus.
    pub const ALL: [Self; 6] = [
        Self::Fractional,
        Self::Umeyama,
        Self::Icp,
        Self::Trimmed,
        Self::TrimmedSearch,
        Self::Paper,
    ];

    /// The word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Umeyama => "umeyama",
            Self::Icp => "icp",
            Self::Trimmed => "trimmed",
            Self::TrimmedSearch => "trimmed-search",
            Self::Fractional => "fractional",
            Self::Paper => "paper",
        }
    }

    /// Short name for menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Umeyama => "Umeyama",
            Self::Icp => "ICP",
            Self::Trimmed => "Trimmed ICP",
            Self::TrimmedSearch => "Trimmed ICP, overlap searched",
            Self::Fractional => "Fractional ICP",
            Self::Paper => "Fractional ICP as in the paper",
        }
    }

    /// One line of help.
    pub fn help(self) -> &'static str {
        match self {
            Self::Umeyama => "Closed form; both meshes must have the same nodes in the same order",
            Self::Icp => "Iterative closest point with all pairs; for parts that cover each other",
            Self::Trimmed => "Iterative closest point with a given share of the pairs",
            Self::TrimmedSearch => "Iterative closest point with a share found by itself",
            Self::Fractional => "Finds pose and overlap together; the default",
            Self::Paper => "Node to node, point to point, no floor, every start to its end",
        }
    }

    /// The method of that [`Method::name`].
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// Which hand of the source is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hand {
    /// As it is.
    #[default]
    Same,
    /// Mirrored: a left-hand part for a right-hand one.
    Mirrored,
    /// Both; the better one wins.
    Either,
}

impl Hand {
    /// Every choice, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Same, Self::Mirrored, Self::Either];

    /// The word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Mirrored => "opposite",
            Self::Either => "either",
        }
    }

    /// Short name for menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Same => "Same hand",
            Self::Mirrored => "Opposite hand",
            Self::Either => "Either hand",
        }
    }

    /// One line of help.
    pub fn help(self) -> &'static str {
        match self {
            Self::Same => "The part is matched as it is",
            Self::Mirrored => "The part is mirrored first: left-hand for right-hand",
            Self::Either => "Both are tried and the better one wins",
        }
    }
}

/// How the starts are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// All starts on few points, the best distinct ones on more, the winner refined.
    #[default]
    Race,
    /// Every start on all points to its end.
    EveryStart,
}

impl Search {
    /// Every choice, in the order of menus.
    pub const ALL: [Self; 2] = [Self::Race, Self::EveryStart];

    /// The word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Race => "race",
            Self::EveryStart => "every-start",
        }
    }

    /// Short name for menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Race => "Race",
            Self::EveryStart => "Every start to its end",
        }
    }

    /// One line of help.
    pub fn help(self) -> &'static str {
        match self {
            Self::Race => "All starts on few points; only the best distinct ones go on",
            Self::EveryStart => "All starts on all points, as in the paper; slow",
        }
    }
}

/// Which mesh supplies the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DataSide {
    /// The smaller one; of equal ones the coarser; both where both overhang.
    #[default]
    Auto,
    /// The source's nodes on the target's triangles.
    Source,
    /// The target's nodes on the source's triangles.
    Target,
}

impl DataSide {
    /// Every choice, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Source, Self::Target];

    /// The word for the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Source => "stamped",
            Self::Target => "crash",
        }
    }

    /// Short name for menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Auto => "Chosen by size",
            Self::Source => "Stamped nodes",
            Self::Target => "Crash nodes",
        }
    }

    /// One line of help.
    pub fn help(self) -> &'static str {
        match self {
            Self::Auto => {
                "The contained part supplies the points; where both overhang, both are tried"
            }
            Self::Source => "The moving part's nodes on the fixed part's triangles",
            Self::Target => "The fixed part's nodes on the moving part's triangles",
        }
    }
}

/// Everything a match depends on besides the meshes. The defaults just work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MatchSettings {
    /// The method by name; sets the fields below through [`MatchSettings::of`]. Only
    /// [`Method::Umeyama`] is asked for again later, because it needs no search.
    pub method: Method,
    /// What a data point is paired with.
    pub pair_with: PairWith,
    /// Which pairs are kept.
    pub selection: Selection,
    /// What is minimised.
    pub metric: Metric,
    /// What may move.
    pub motion: Motion,
    /// Which hand of the source is tried.
    pub hand: Hand,
    /// First poses.
    pub starts: StartSettings,
    /// How they are searched.
    pub search: Search,
    /// Refine the winner on the full meshes (else only on the reduced ones, if there are any).
    pub finish: bool,
    /// Which mesh supplies the points.
    pub data_side: DataSide,
    /// Deviation of the real shapes that is to be expected besides faceting, such as springback;
    /// added to the floor. In length units.
    pub allowance: f64,
    /// Largest angle between normals of a pair in the later stages, degrees; 180 lets all through.
    pub max_normal_angle_deg: f64,
    /// Data points of the first stage of the race.
    pub n_race_points: usize,
    /// Data points of its second stage.
    pub n_refine_points: usize,
    /// Iteration cap where a run goes to its end.
    pub max_iterations: usize,
    /// A run has settled when a step moves no corner of the box by more than this share of the
    /// mean edge length.
    pub motion_tolerance: f64,
}

impl Default for MatchSettings {
    fn default() -> Self {
        Self {
            method: Method::Fractional,
            pair_with: PairWith::Triangle,
            selection: Selection::default(),
            metric: Metric::Symmetric,
            motion: Motion::Rigid,
            hand: Hand::Same,
            starts: StartSettings::default(),
            search: Search::Race,
            finish: true,
            data_side: DataSide::Auto,
            allowance: 0.0,
            max_normal_angle_deg: 60.0,
            n_race_points: 500,
            n_refine_points: 3000,
            max_iterations: 200,
            motion_tolerance: 1e-3,
        }
    }
}

impl MatchSettings {
    /// The settings that a method's name stands for.
    pub fn of(method: Method) -> Self {
        let base = Self {
            method,
            ..Self::default()
        };
        match method {
            Method::Umeyama | Method::Fractional => base,
            Method::Icp => Self {
                selection: Selection::All,
                ..base
            },
            Method::Trimmed => Self {
                selection: Selection::Trimmed { overlap: 0.8 },
                ..base
            },
            Method::TrimmedSearch => Self {
                selection: Selection::TrimmedSearch,
                ..base
            },
            Method::Paper => Self {
                pair_with: PairWith::Node,
                selection: Selection::Fractional {
                    lambda: 0.95,
                    floor: Floor::None,
                },
                metric: Metric::PointToPoint,
                search: Search::EveryStart,
                finish: false,
                data_side: DataSide::Source,
                max_normal_angle_deg: 180.0,
                starts: StartSettings {
                    both_signs: false,
                    widen: false,
                    ..StartSettings::default()
                },
                ..base
            },
        }
    }

    /// Says which setting lies outside its range.
    pub(crate) fn check(&self) -> Result<(), RegistrationError> {
        self.starts.n_rotations()?;
        let within = |name, value: f64, low: f64, high: f64, range| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(RegistrationError::Setting { name, value, range })
            }
        };
        match self.selection {
            Selection::Trimmed { overlap } => {
                within("the overlap", overlap, 1e-3, 1.0, "0.001 to 1")?;
            }
            Selection::Fractional { lambda, floor } => {
                within("λ", lambda, 0.01, 100.0, "0.01 to 100")?;
                if let Floor::Length(length) = floor {
                    within("the floor", length, 0.0, f64::MAX, "0 and above")?;
                }
            }
            Selection::All | Selection::TrimmedSearch => {}
        }
        within(
            "the allowance",
            self.allowance,
            0.0,
            f64::MAX,
            "0 and above",
        )?;
        let angle = self.max_normal_angle_deg;
        within("the normal angle", angle, 1.0, 180.0, "1° to 180°")?;
        let tolerance = self.motion_tolerance;
        within(
            "the motion tolerance",
            tolerance,
            0.0,
            1.0,
            "0 to 1 edge length",
        )?;
        let at_least = |name, value: usize| within(name, value as f64, 1.0, 1e9, "1 and above");
        at_least("the number of race points", self.n_race_points)?;
        at_least("the number of refinement points", self.n_refine_points)?;
        at_least("the iteration limit", self.max_iterations)
    }
}
