//! The two parts of every job: the crash part and the stamped part.
//!
//! Known from `report` up. Below it there are only source and target: the stamped part is the
//! source, the crash part the target.

use std::ops::Deref;

use serde::{Deserialize, Serialize, Serializer};

/// Which of the two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Role {
    /// The part of the crash model: fixed, shown left, the target of the match.
    Crash,
    /// The part of the stamping simulation: moves, shown right, the source of the match.
    Stamped,
}

impl Role {
    /// Both, crash first.
    pub const ALL: [Self; 2] = [Self::Crash, Self::Stamped];

    /// The other part.
    pub fn other(self) -> Self {
        match self {
            Self::Crash => Self::Stamped,
            Self::Stamped => Self::Crash,
        }
    }

    /// Lower-case word for sentences and for file names.
    pub fn word(self) -> &'static str {
        match self {
            Self::Crash => "crash",
            Self::Stamped => "stamped",
        }
    }

    /// The mark shown beside everything that belongs to this part: colour is never the only sign.
    pub fn mark(self) -> &'static str {
        match self {
            Self::Crash => "■",
            Self::Stamped => "▲",
        }
    }
}

/// One value for each part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct PerRole<T> {
    /// For the crash part.
    pub crash: T,
    /// For the stamped part.
    pub stamped: T,
}

impl<T> PerRole<T> {
    /// The values of the crash part and of the stamped part.
    pub const fn new(crash: T, stamped: T) -> Self {
        Self { crash, stamped }
    }

    /// The same value for both parts.
    pub fn both(value: T) -> Self
    where
        T: Clone,
    {
        Self::new(value.clone(), value)
    }

    /// Makes both values, the crash part's first.
    pub fn from_fn(mut make: impl FnMut(Role) -> T) -> Self {
        Self::new(make(Role::Crash), make(Role::Stamped))
    }

    /// Both values turned into others, the crash part's first.
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> PerRole<U> {
        PerRole::new(f(self.crash), f(self.stamped))
    }

    /// References to both values.
    pub const fn as_ref(&self) -> PerRole<&T> {
        PerRole::new(&self.crash, &self.stamped)
    }

    /// What both values point to.
    pub fn as_deref(&self) -> PerRole<&T::Target>
    where
        T: Deref,
    {
        PerRole::new(&*self.crash, &*self.stamped)
    }

    /// The value of one part.
    pub fn get(&self, role: Role) -> &T {
        match role {
            Role::Crash => &self.crash,
            Role::Stamped => &self.stamped,
        }
    }

    /// The value of one part, to be changed.
    pub fn get_mut(&mut self, role: Role) -> &mut T {
        match role {
            Role::Crash => &mut self.crash,
            Role::Stamped => &mut self.stamped,
        }
    }

    /// Both values, crash first.
    pub fn iter(&self) -> impl Iterator<Item = (Role, &T)> {
        [(Role::Crash, &self.crash), (Role::Stamped, &self.stamped)].into_iter()
    }

    /// Exchanges the two values.
    pub fn swap(&mut self) {
        std::mem::swap(&mut self.crash, &mut self.stamped);
    }

    /// Serializes as the list `[crash, stamped]`, the form of the file formats; it is read back
    /// like the form with names.
    pub fn as_list<S: Serializer>(values: &Self, serializer: S) -> Result<S::Ok, S::Error>
    where
        T: Serialize,
    {
        [&values.crash, &values.stamped].serialize(serializer)
    }
}

impl<T> PerRole<Option<T>> {
    /// Both values, where both are there.
    pub fn all(self) -> Option<PerRole<T>> {
        Some(PerRole::new(self.crash?, self.stamped?))
    }
}

impl<T, E> PerRole<Result<T, E>> {
    /// Both values, or the first error, the crash part's before the stamped part's.
    pub fn transpose(self) -> Result<PerRole<T>, E> {
        Ok(PerRole::new(self.crash?, self.stamped?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_and_names_read_back_as_the_same_values() {
        #[derive(Serialize, Deserialize)]
        struct Row(#[serde(serialize_with = "PerRole::as_list")] PerRole<u8>);
        let written = serde_json::to_string(&Row(PerRole::new(1, 2))).unwrap();
        assert_eq!(written, "[1,2]");
        for text in ["[1,2]", r#"{"stamped":2,"crash":1}"#] {
            let Row(read) = serde_json::from_str(text).unwrap();
            assert_eq!(read, PerRole::new(1, 2));
        }
    }

    #[test]
    fn both_values_are_needed_for_a_whole() {
        assert_eq!(
            PerRole::new(Some(1), Some(2)).all(),
            Some(PerRole::new(1, 2))
        );
        assert_eq!(PerRole::new(Some(1), None).all(), None);
        let failed: PerRole<Result<u8, &str>> = PerRole::new(Err("crash"), Err("stamped"));
        assert_eq!(failed.transpose(), Err("crash"));
    }
}
