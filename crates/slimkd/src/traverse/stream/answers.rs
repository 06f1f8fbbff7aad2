//! What is asked of a stream.

use crate::geometry::Hit;

/// Where the answers of a batch go.
pub(crate) trait Answers {
    /// Whether the first hit ends a ray.
    const ANY: bool;

    /// The answer of the ray at this place of the batch.
    fn put(&mut self, ray: usize, hit: Option<Hit>);
}

/// Closest hits.
impl Answers for &mut [Option<Hit>] {
    const ANY: bool = false;

    #[inline(always)]
    fn put(&mut self, ray: usize, hit: Option<Hit>) {
        self[ray] = hit;
    }
}

/// Any hits.
impl Answers for &mut [bool] {
    const ANY: bool = true;

    #[inline(always)]
    fn put(&mut self, ray: usize, hit: Option<Hit>) {
        self[ray] = hit.is_some();
    }
}
