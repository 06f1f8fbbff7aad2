//! Work on several threads, by rayon; without the feature `rayon`, the same work on one.
//!
//! Every result is in the order of its items, so that nothing depends on the number of threads.

#[cfg(feature = "rayon")]
pub(crate) use with_rayon::*;
#[cfg(not(feature = "rayon"))]
pub(crate) use without_rayon::*;

/// No threads could be started for this work.
pub(crate) struct Refused<W> {
    pub(crate) why: String,
    pub(crate) work: W,
}

#[cfg(feature = "rayon")]
mod with_rayon {
    use super::Refused;
    use rayon::prelude::*;

    /// Threads of the current pool.
    pub(crate) fn count() -> usize {
        rayon::current_num_threads()
    }

    /// Runs `work` with a pool of that many threads of its own.
    pub(crate) fn with<R: Send, W: FnOnce() -> R + Send>(threads: usize, work: W) -> Result<R, Refused<W>> {
        match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => Ok(pool.install(work)),
            Err(error) => Err(Refused { why: error.to_string(), work }),
        }
    }

    /// Runs both, at the same time if there is a thread for it.
    pub(crate) fn join<A: Send, B: Send>(
        a: impl FnOnce() -> A + Send,
        b: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        rayon::join(a, b)
    }

    /// What `work` makes of each item, or an error of one.
    pub(crate) fn map<T: Send, R: Send, E: Send>(
        items: impl IntoIterator<Item = T, IntoIter: Send>,
        work: impl Fn(T) -> Result<R, E> + Sync + Send,
    ) -> Result<Vec<R>, E> {
        let items: Vec<T> = items.into_iter().collect();
        items.into_par_iter().with_max_len(1).map(work).collect()
    }

    /// Adds up items, a sum a thread at first; `None` where there is no item.
    pub(crate) fn fold<T: Sync, A: Send, E: Send>(
        items: &[T],
        none: impl Fn() -> A + Sync + Send,
        add: impl Fn(A, &T) -> Result<A, E> + Sync + Send,
        join: impl Fn(A, A) -> Result<A, E> + Sync + Send,
    ) -> Result<Option<A>, E> {
        items.par_iter().try_fold(none, add).try_reduce_with(join).transpose()
    }
}

#[cfg(not(feature = "rayon"))]
mod without_rayon {
    use super::Refused;

    pub(crate) fn count() -> usize {
        1
    }

    pub(crate) fn with<R, W: FnOnce() -> R>(_: usize, work: W) -> Result<R, Refused<W>> {
        Ok(work())
    }

    pub(crate) fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
        (a(), b())
    }

    pub(crate) fn map<T, R, E>(
        items: impl IntoIterator<Item = T>,
        work: impl Fn(T) -> Result<R, E>,
    ) -> Result<Vec<R>, E> {
        items.into_iter().map(work).collect()
    }

    pub(crate) fn fold<T, A, E>(
        items: &[T],
        none: impl Fn() -> A,
        add: impl Fn(A, &T) -> Result<A, E>,
        _: impl Fn(A, A) -> Result<A, E>,
    ) -> Result<Option<A>, E> {
        items.iter().try_fold(None, |sum, item| add(sum.unwrap_or_else(&none), item).map(Some))
    }
}
