//! What a setting with a few named values is made of.

/// How one of the values is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChoiceWords {
    /// Name on the command line and in records.
    pub name: &'static str,
    /// Short name for menus and reports.
    pub label: &'static str,
    /// One line of help, without a full stop.
    pub help: &'static str,
}

/// An enum that the user chooses from.
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// One of each kind with its usual parameters, in the order of menus.
    const ALL: &'static [Self];

    /// All its words.
    fn words(self) -> ChoiceWords;

    /// Name on the command line and in records.
    fn name(self) -> &'static str {
        self.words().name
    }

    /// Short name for menus and reports.
    fn label(self) -> &'static str {
        self.words().label
    }

    /// One line of help.
    fn help(self) -> &'static str {
        self.words().help
    }

    /// The value of a name, with its usual parameters.
    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|one| one.name() == name)
    }

    /// The words of every value.
    fn all_words() -> Vec<ChoiceWords> {
        Self::ALL.iter().map(|choice| choice.words()).collect()
    }
}
