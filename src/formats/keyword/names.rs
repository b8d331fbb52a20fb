//! The names of LS-DYNA's keywords, as far as they tell a deck from another text.

/// First words of the keywords of the manual's three volumes, of restart decks and of the forming
/// tools, in alphabetical order.
const FAMILIES: &[&str] = &[
    "AIRBAG",
    "ALE",
    "BATTERY",
    "BOUNDARY",
    "CASE",
    "CESE",
    "CHANGE",
    "CHEMISTRY",
    "COMMENT",
    "COMPONENT",
    "CONSTRAINED",
    "CONTACT",
    "CONTROL",
    "COSIM",
    "CPG",
    "DAMPING",
    "DATABASE",
    "DEFINE",
    "DEFORMABLE",
    "DELETE",
    "DUALCESE",
    "EF",
    "ELEMENT",
    "EM",
    "END",
    "EOS",
    "FATIGUE",
    "FREQUENCY",
    "HOURGLASS",
    "ICFD",
    "IGA",
    "INCLUDE",
    "INITIAL",
    "INTEGRATION",
    "INTERFACE",
    "ISPG",
    "KEYWORD",
    "LOAD",
    "LSO",
    "MAT",
    "MESH",
    "MODULE",
    "NODE",
    "PARAMETER",
    "PART",
    "PARTICLE",
    "PERTURBATION",
    "RAIL",
    "RIGID",
    "RIGIDWALL",
    "RVE",
    "SECTION",
    "SENSOR",
    "SET",
    "STOCHASTIC",
    "STRESS",
    "TERMINATION",
    "TITLE",
    "TRANSLATE",
    "UNIT",
    "USER",
];

/// Keywords that make, move or thicken parts besides those that hold a mesh, with or without options.
const SHAPING: &[&str] = &[
    "DEFINE_FORMING_BLANKMESH",
    "IGA_SHELL",
    "PART_DUPLICATE",
    "PART_MOVE",
    "PART_STACKED_ELEMENTS",
    "PERTURBATION_NODE",
    "PERTURBATION_SHELL_THICKNESS",
];

/// The name of a keyword line without its `*`, in upper case; `None` if no letter follows.
pub(crate) fn keyword_name(line: &[u8]) -> Option<String> {
    let line = line.trim_ascii_start();
    let is_part = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_';
    let end = line.iter().position(|b| !is_part(b)).unwrap_or(line.len());
    let name = &line[..end];
    let begins = name.first().is_some_and(u8::is_ascii_alphabetic);
    begins.then(|| String::from_utf8_lossy(name).to_ascii_uppercase())
}

fn family(name: &str) -> &str {
    name.split('_').next().unwrap_or_default()
}

/// True if LS-DYNA has keywords that begin so. `name` is in upper case, with or without options.
pub(crate) fn is_known(name: &str) -> bool {
    FAMILIES.binary_search(&family(name)).is_ok()
}

/// True of a keyword without elements and nodes that changes the shape or the thickness of parts.
pub(crate) fn shapes_parts(name: &str) -> bool {
    let is_one = |known: &&str| {
        let options = name.strip_prefix(*known);
        options.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    };
    SHAPING.iter().any(is_one)
}

/// The known name that was probably meant, if one letter too many was written.
pub(crate) fn probably_meant(name: &str) -> Option<&'static str> {
    let family = family(name);
    let is_near = |known: &&&str| {
        if family.len() != known.len() + 1 {
            return false;
        }
        let mut shorter = (0..family.len()).map(|at| {
            let mut text = family.to_owned();
            text.remove(at);
            text
        });
        family.is_ascii() && shorter.any(|text| text == **known)
    };
    FAMILIES.iter().find(is_near).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_by_their_first_word() {
        assert!(FAMILIES.is_sorted());
        let name = |line: &str| keyword_name(line.as_bytes());
        assert_eq!(name("element_shell+ x"), Some("ELEMENT_SHELL".into()));
        assert_eq!(name(" NODE %"), Some("NODE".into()));
        assert_eq!(name("* text"), None);
        assert!(is_known("ELEMENT_SHELL") && is_known("END"));
        assert!(!is_known("NODES") && !is_known("HEADING"));
        assert!(shapes_parts("PART_MOVE") && shapes_parts("IGA_SHELL_TITLE"));
        assert!(!shapes_parts("PART") && !shapes_parts("PART_MOVED"));
        assert_eq!(probably_meant("NODES"), Some("NODE"));
        assert_eq!(probably_meant("HEADING"), None);
        // Of any length.
        assert_eq!(probably_meant(&"A".repeat(10_000_000)), None);
    }
}
