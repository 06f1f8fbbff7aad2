//! Which triangles of a node go to which side of its plane.
//!
//! Source: Wald & Havran 2006 §4.3: `end ≤ plane` is left and `start ≥ plane` is right, so triangles that only touch the
//! plane are not doubled.

use super::fragment::{Fragment, triangle_bounds};
use crate::construct::split::Split;
use crate::geometry::{Aabb, Clipper, TriangleMesh};
use crate::job::memory::stretch;
use crate::options::BuildError;

/// How a node is split into its children.
pub(crate) struct Partition<'a> {
    pub(crate) split: Split,
    pub(crate) voxel: Aabb,
    pub(crate) mesh: &'a TriangleMesh,
    /// Whether straddlers are clipped, or bounded by their box.
    pub(crate) exact: bool,
}

impl Partition<'_> {
    #[inline(always)]
    fn sort(
        &self,
        fragments: &mut [Fragment],
        left: &mut [Fragment],
        straddlers: &mut [Fragment],
    ) -> (usize, usize, usize) {
        let split = &self.split;
        let (axis, plane) = (split.axis, split.position);
        let (left, straddlers) = (&mut left[..fragments.len()], &mut straddlers[..fragments.len()]);
        let (mut lefts, mut rights, mut boths) = (0, 0, 0);
        for i in 0..fragments.len() {
            let fragment = fragments[i];
            let (ends, starts) = (fragment.high[axis] <= plane, fragment.low[axis] >= plane);
            // Only what lies in the plane does both.
            let is_left = ends & (!starts | split.planar_left);
            let is_right = starts & (!ends | !split.planar_left);
            // All writes always, one of them counts: no branch to mispredict.
            left[lefts] = fragment;
            fragments[rights] = fragment;
            straddlers[boths] = fragment;
            lefts += usize::from(is_left);
            rights += usize::from(is_right);
            boths += usize::from(!(is_left | is_right));
        }
        (lefts, rights, boths)
    }

    /// Splits `fragments`, a node's or a part of them: the right child's come to the front, the left child's to the front of
    /// `left`, which has room for as many. Returns how many went left and right. `straddlers` is a buffer to reuse.
    pub(crate) fn run(
        &self,
        fragments: &mut [Fragment],
        left: &mut [Fragment],
        straddlers: &mut Vec<Fragment>,
    ) -> Result<(usize, usize), BuildError> {
        stretch(straddlers, fragments.len())?;
        let (mut lefts, mut rights, boths) = self.sort(fragments, left, straddlers);
        let Self { split: Split { axis, position, .. }, voxel, mesh, exact } = *self;
        let (left_voxel, right_voxel) = voxel.split(axis, position);
        let mut clipper = Clipper::default();
        for straddler in &straddlers[..boths] {
            let id = straddler.triangle();
            let (in_left, in_right) = if exact {
                clipper.split_bounds(&mesh.corners(id), &voxel, axis, position)
            } else {
                let bounds = triangle_bounds(mesh, id);
                (Some(bounds.cut_to(&left_voxel)), Some(bounds.cut_to(&right_voxel)))
            };
            if let Some(bounds) = in_left {
                left[lefts] = Fragment::new(id, &bounds);
                lefts += 1;
            }
            if let Some(bounds) = in_right {
                fragments[rights] = Fragment::new(id, &bounds);
                rights += 1;
            }
        }
        Ok((lefts, rights))
    }
}
