//! Files that are refused: what they are instead of a mesh, and what to do about it.

use std::fmt;

/// A kind of file that is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Foreign {
    /// Nothing, or only blanks.
    Empty,
    /// A web page.
    Html,
    /// What Git Large File Storage leaves in place of a file.
    GitLfs,
    /// A ZIP archive.
    Zip,
    /// An archive or a packed file other than gzip and ZIP.
    Packed,
    /// Ansys archive (`.cdb`).
    Ansys,
    /// Nastran bulk data (`.bdf`, `.nas`, `.dat`).
    Nastran,
    /// Abaqus input (`.inp`).
    Abaqus,
    /// Radioss starter input (`.rad`).
    Radioss,
    /// Pam-Crash input (`.pc`).
    PamCrash,
    /// STEP geometry.
    Step,
    /// IGES geometry.
    Iges,
    /// A d3plot database.
    D3plot,
    /// A binary dynain.
    Lsda,
    /// A mesh format that has no reader here.
    OtherMesh,
    /// A project of this program.
    Project,
    /// A record of a match, a mapping or another work of this program.
    Record,
    /// Any other binary file.
    Binary,
    /// Text with lines that begin with `*` and none of LS-DYNA's keywords.
    NoKeyword,
    /// Any other text.
    Text,
}

/// What to do with a mesh of another program.
const EXPORT: &str = "export the mesh as an LS-DYNA keyword deck, STL, OBJ or PLY";
/// What to do with geometry that has no mesh.
const MESH: &str = "mesh the surface and export it as an LS-DYNA keyword deck, STL, OBJ or PLY";

impl Foreign {
    /// Every kind, in the order they are tried.
    pub const ALL: &[Self] = &[
        Self::Empty,
        Self::Html,
        Self::GitLfs,
        Self::Zip,
        Self::Packed,
        Self::Ansys,
        Self::Nastran,
        Self::Abaqus,
        Self::Radioss,
        Self::PamCrash,
        Self::Step,
        Self::Iges,
        Self::D3plot,
        Self::Lsda,
        Self::OtherMesh,
        Self::Project,
        Self::Record,
        Self::Binary,
        Self::NoKeyword,
        Self::Text,
    ];

    /// What the file is, to follow "the file is".
    pub fn label(self) -> &'static str {
        self.words().0
    }

    /// What the user can do about it.
    pub fn advice(self) -> &'static str {
        self.words().1
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Empty => ("empty", "check that its export or download was completed"),
            Self::Html => (
                "a web page (HTML)",
                "it is probably the login or error page of a download; download the file again",
            ),
            Self::GitLfs => (
                "a Git LFS pointer, not the file itself",
                "run \"git lfs pull\" in its repository",
            ),
            Self::Zip => ("a ZIP archive", "unpack it first"),
            Self::Packed => (
                "packed (xz, zstd, bzip2, 7z, compress or tar)",
                "unpack it first; of packed files only gzip is read",
            ),
            Self::Ansys => ("an Ansys archive (CDB)", EXPORT),
            Self::Nastran => ("a Nastran bulk data file", EXPORT),
            Self::Abaqus => ("an Abaqus input file", EXPORT),
            Self::Radioss => ("a Radioss input file", EXPORT),
            Self::PamCrash => ("a Pam-Crash input file", EXPORT),
            Self::Step => ("STEP geometry without a mesh", MESH),
            Self::Iges => ("IGES geometry without a mesh", MESH),
            Self::D3plot => (
                "an LS-DYNA result database (d3plot)",
                "write a dynain of the last state, in LS-PrePost or by *INTERFACE_SPRINGBACK_LSDYNA",
            ),
            Self::Lsda => (
                "a binary dynain (LSDA)",
                "write it in ASCII (FTYPE 0 of *INTERFACE_SPRINGBACK_LSDYNA)",
            ),
            Self::OtherMesh => (
                "a mesh in a format that is not read (glTF, FBX, OFF, VTK, Gmsh or HDF5)",
                EXPORT,
            ),
            Self::Project => (
                "a shapematch project",
                "open it by itself, under a name that ends in .shapematch, and not as a part; map takes it as --project",
            ),
            Self::Record => (
                "a JSON record of shapematch",
                "give the decks themselves; the record names them",
            ),
            Self::Binary => (
                "binary and neither STL nor PLY",
                "check that it is the right file and was transferred unchanged",
            ),
            Self::NoKeyword => (
                "text without any LS-DYNA keyword",
                "check that it is the right file; keywords begin with * in the first column",
            ),
            Self::Text => (
                "text that is neither an LS-DYNA deck nor STL, OBJ or PLY",
                "check that it is the right file",
            ),
        }
    }
}

impl fmt::Display for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.label())
    }
}
