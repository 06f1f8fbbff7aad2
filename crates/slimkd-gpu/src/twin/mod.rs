//! Every kernel again in Rust, over the same words and with the same arithmetic. Not for speed: it says whether a difference
//! between CPU and GPU is the kernel's or the data's.

mod exact;
mod nodes;
#[cfg(feature = "render")]
mod picture;
mod prepared;
#[cfg(feature = "render")]
mod shade;
#[cfg(feature = "render")]
mod surface;

#[cfg(feature = "render")]
pub use picture::Picture;

use crate::image::Image;
use nodes::Inner;
use prepared::Prepared;
use slimkd::{Hit, Ray};

/// An image, traced by the CPU as a GPU would.
#[derive(Clone, Copy, Debug)]
pub struct Twin<'i> {
    image: &'i Image,
    /// Entries of the short stack.
    stack: usize,
}

/// A far child to come back to.
#[derive(Clone, Copy)]
struct Far {
    node: u32,
    enter: f32,
    exit: f32,
    level: usize,
}

/// Which levels above the present node are done: a bit each, set where only one child was to be visited or the far one is
/// being visited. The restart trail of Laine, *Restart Trail for Stackless BVH Traversal*, HPG 2010, for a kd-tree.
struct Trail(Vec<bool>);

impl Trail {
    /// The deepest level above `level` whose far child waits.
    fn waiting(&self, level: usize) -> Option<usize> {
        self.0[..level].iter().rposition(|done| !done)
    }
}

impl<'i> Twin<'i> {
    /// `stack` is the number of entries of the short stack, 1 and up.
    pub fn new(image: &'i Image, stack: u32) -> Self {
        Self { image, stack: stack.max(1) as usize }
    }

    /// The nearest hit.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.trace(ray, false)
    }

    /// Whether there is a hit.
    pub fn any(&self, ray: &Ray) -> bool {
        self.trace(ray, true).is_some()
    }

    /// `trace` of `shaders/walk.wgsl`: a short stack that forgets its oldest entry when it is full. What it forgot is found
    /// again from the root along the trail. Restarting by t, as is usual, would lose hits: slabs of neighbouring
    /// planes overlap, so that a far child may begin before its near sibling ends.
    pub(super) fn trace(&self, ray: &Ray, any: bool) -> Option<Hit> {
        let ray = Prepared::new(ray, &self.image.params)?;
        let mut best = Hit { t: ray.t_max, u: 0.0, v: 0.0, triangle: u32::MAX };
        let test = |triangle: u32, best: &mut Hit| {
            let Some(found) = ray.intersect(self.corners(triangle), triangle) else { return false };
            let nearer = found.t < best.t || (found.t == best.t && found.triangle < best.triangle);
            let better = ray.t_min <= found.t && found.t <= ray.t_max && nearer;
            if better {
                *best = found;
            }
            better && any
        };
        let mut trail = Trail(vec![false; self.image.depth as usize + 1]);
        let mut stack: Vec<Far> = Vec::with_capacity(self.stack);
        let (mut at, mut level, mut resume) = (0, 0, 0);
        let (mut enter, mut exit) = (ray.enter, ray.exit);
        loop {
            let mut lower = self.lower(at);
            let mut skip = false;
            while lower & 3 != 3 {
                let Inner { axis, split, left, right, triangle } = self.inner(at, lower);
                if triangle.is_some_and(|triangle| test(triangle, &mut best)) {
                    return Some(best);
                }
                let middle = (split - ray.start[axis]) * ray.inverse[axis];
                let (first, last) = match ray.wild {
                    true => (f32::MIN, f32::MAX),
                    false => (middle - ray.slack[axis], middle + ray.slack[axis]),
                };
                let turned = ray.inverse[axis].is_sign_negative();
                let (near, far) = if turned { (right, left) } else { (left, right) };
                if exit < first {
                    trail.0[level] = true;
                    at = near;
                } else if last < enter {
                    trail.0[level] = true;
                    at = far;
                } else if level < resume && trail.0[level] {
                    at = far;
                    enter = first.max(enter);
                    if level + 1 == resume && enter > best.t * ray.scale {
                        level += 1;
                        skip = true;
                        break;
                    }
                } else {
                    trail.0[level] = false;
                    if stack.len() == self.stack {
                        stack.remove(0);
                    }
                    stack.push(Far { node: far, enter: first.max(enter), exit, level });
                    at = near;
                    exit = last.min(exit);
                }
                level += 1;
                lower = self.lower(at);
            }
            if !skip {
                let mut ended = false;
                self.leaf(at, lower, |id| {
                    ended = test(id, &mut best);
                    ended
                });
                if ended {
                    return Some(best);
                }
            }
            let limit = best.t * ray.scale;
            let mut next = None;
            while let Some(entry) = stack.pop() {
                level = entry.level;
                trail.0[level] = true;
                level += 1;
                if entry.enter <= limit {
                    next = Some(entry);
                    break;
                }
            }
            if let Some(entry) = next {
                (at, enter, exit, resume) = (entry.node, entry.enter, entry.exit, 0);
            } else if let Some(waiting) = trail.waiting(level) {
                trail.0[waiting] = true;
                (resume, level, at) = (waiting + 1, 0, 0);
                (enter, exit) = (ray.enter, ray.exit);
            } else {
                return (best.triangle != u32::MAX).then_some(best);
            }
        }
    }
}
