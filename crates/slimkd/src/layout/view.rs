//! A tree's view in its own layout.

use super::Encoded;
use super::dense::DenseView;
use super::mesh::MeshView;
use super::plain::PlainView;
use super::wide::WideView;
use crate::geometry::TriangleMesh;

/// A tree's view in its own layout: what every query dispatches on, once.
pub(crate) enum View<'a> {
    Plain(PlainView<'a>),
    Dense(DenseView<'a>),
    Wide(WideView<'a>),
}

impl<'a> View<'a> {
    /// Of a tree that was encoded here or proved, over its mesh.
    pub(crate) fn new(encoded: &'a Encoded, mesh: &'a TriangleMesh) -> Self {
        let mesh = MeshView::new(mesh);
        match encoded {
            Encoded::Plain(plain) => Self::Plain(PlainView::new(plain, mesh)),
            Encoded::Dense(dense) => Self::Dense(DenseView::new(dense, mesh)),
            Encoded::Wide(wide) => Self::Wide(WideView::new(wide, mesh)),
        }
    }
}

/// Runs `$body` with `$nodes` bound to the tree's view where it is a tree of planes, `$other` with `$wide` where it is one of boxes.
macro_rules! with_nodes {
    ($tree:expr, $nodes:ident => $body:expr, $wide:ident => $other:expr $(,)?) => {
        match $tree.view() {
            $crate::layout::View::Plain($nodes) => $body,
            $crate::layout::View::Dense($nodes) => $body,
            $crate::layout::View::Wide($wide) => $other,
        }
    };
}
pub(crate) use with_nodes;
