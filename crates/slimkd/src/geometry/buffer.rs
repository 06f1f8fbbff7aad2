//! The arrays of a mesh: owned, or somebody else's memory that stays where it is.

use std::sync::Arc;

/// An array that never changes, and its owner.
#[derive(Clone)]
pub(super) struct Buffer<T: 'static> {
    /// Lies in what `owner` keeps alive.
    items: &'static [T],
    owner: Arc<dyn AsRef<[T]> + Send + Sync>,
}

impl<T> Buffer<T> {
    pub(super) fn new(owner: Arc<dyn AsRef<[T]> + Send + Sync>) -> Self {
        let items: *const [T] = AsRef::<[T]>::as_ref(&*owner);
        // SAFETY: the slice borrows from what the `Arc` holds. That is neither moved nor dropped nor borrowed mutably while this
        // `Arc` exists, and the slice is given out only for as long as `self` is borrowed. It is asked for once, so an owner that would
        // answer otherwise the next time changes nothing.
        let items: &'static [T] = unsafe { &*items };
        Self { items, owner }
    }

    pub(super) fn as_slice(&self) -> &[T] {
        debug_assert!(Arc::strong_count(&self.owner) > 0);
        self.items
    }
}

impl<T: Send + Sync> From<Vec<T>> for Buffer<T> {
    fn from(items: Vec<T>) -> Self {
        Self::new(Arc::new(items))
    }
}
