//! A piece of the work of drawing: what a long picture takes in one frame.

use std::ops::Range;

/// How many things (triangles, lines, nodes) are left out because they are drawn, and how many are
/// drawn now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Slice {
    skip: u64,
    left: u64,
}

impl Slice {
    /// Everything at once.
    pub(super) fn all() -> Self {
        Self::new(0, u64::MAX)
    }

    /// `n` things after the first `skip`.
    pub(super) fn new(skip: u64, n: u64) -> Self {
        Self { skip, left: n }
    }

    /// Which of the next `count` things are drawn now.
    pub(super) fn take(&mut self, count: u32) -> Range<u32> {
        let begin = self.skip.min(u64::from(count));
        self.skip -= begin;
        let n = (u64::from(count) - begin).min(self.left);
        self.left -= n;
        begin as u32..(begin + n) as u32
    }

    /// True while nothing was drawn before.
    pub(super) fn is_first(self) -> bool {
        self.skip == 0
    }

    /// What may still be drawn now; zero if something may have been left out.
    pub(super) fn left(self) -> u64 {
        self.left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_cover_everything_once() {
        let counts = [5, 0, 3, 7];
        let mut seen = vec![0; 15];
        let mut skip = 0;
        loop {
            let mut slice = Slice::new(skip, 4);
            let mut first = 0;
            for count in counts {
                for i in slice.take(count) {
                    seen[(first + i) as usize] += 1;
                }
                first += count;
            }
            if slice.left() > 0 {
                break;
            }
            skip += 4;
        }
        assert_eq!(seen, [1; 15]);
        assert_eq!(Slice::all().take(9), 0..9);
    }
}
