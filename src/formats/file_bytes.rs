//! The bytes of a file in memory.

use std::io;
use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// From this size on bytes lie in pages of their own. An allocator hands out memory in small pages,
/// whose set-up costs about as much as copying a file into them.
const MANY: usize = 4 << 20;

/// The bytes of a file: a vector, or pages of the system where there are many.
#[derive(Debug)]
pub struct FileBytes(Storage);

#[derive(Debug)]
enum Storage {
    Few(Vec<u8>),
    Many(MmapMut),
}

impl FileBytes {
    /// `n` zeros, to be written over. [`io::ErrorKind::OutOfMemory`] if there is no room.
    pub(super) fn zeroed(n: usize) -> io::Result<Self> {
        if n >= MANY {
            let pages = MmapMut::map_anon(n)?;
            // Without large pages it only takes longer.
            #[cfg(target_os = "linux")]
            let _ = pages.advise(memmap2::Advice::HugePage);
            return Ok(Self(Storage::Many(pages)));
        }
        let mut bytes = Vec::new();
        bytes
            .try_reserve_exact(n)
            .map_err(|_| io::ErrorKind::OutOfMemory)?;
        bytes.resize(n, 0);
        Ok(Self(Storage::Few(bytes)))
    }

    /// The bytes as a vector; copied where they lie in pages.
    pub fn into_vec(self) -> Vec<u8> {
        match self.0 {
            Storage::Few(bytes) => bytes,
            Storage::Many(pages) => pages.to_vec(),
        }
    }
}

impl<T: Into<Vec<u8>>> From<T> for FileBytes {
    fn from(bytes: T) -> Self {
        Self(Storage::Few(bytes.into()))
    }
}

impl Deref for FileBytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match &self.0 {
            Storage::Few(bytes) => bytes,
            Storage::Many(pages) => pages,
        }
    }
}

impl DerefMut for FileBytes {
    fn deref_mut(&mut self) -> &mut [u8] {
        match &mut self.0 {
            Storage::Few(bytes) => bytes,
            Storage::Many(pages) => pages,
        }
    }
}
