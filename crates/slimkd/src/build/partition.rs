//! Splitting the sorted event lists of a node without sorting them again.
//!
//! Source: Wald & Havran 2006 §4.3 ("splicing"): one-sided events keep their order; only the straddling triangles' new
//! events are sorted, and merged in.
//!
//! Deviation: the right child's list replaces its parent's in place, since a child never has more events of a
//! triangle than its parent had. The left child's list is new.

use super::clip::{clipped_bounds, split_bounds};
use super::event::{Event, Kind, ordered, push_events};
use super::options::Clipping;
use super::sweep::Split;
use crate::geometry::{Aabb, TriangleMesh};

const LEFT: u8 = 0;
const RIGHT: u8 = 1;
const BOTH: u8 = 2;

/// Buffers that one worker reuses from node to node.
#[derive(Default)]
pub(crate) struct Scratch {
    /// Side of each triangle, by id; valid only for the triangles of the node at hand.
    pub(crate) sides: Vec<u8>,
    straddlers: Vec<u32>,
    new_left: [Vec<Event>; 3],
    new_right: [Vec<Event>; 3],
    filtered: Vec<Event>,
}

/// How many triangles went where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) left: u32,
    pub(crate) right: u32,
}

/// Decides every triangle's side from the split axis' list and clips the straddlers. Returns the children's counts.
pub(crate) fn classify(
    events: &[Event],
    split: &Split,
    voxel: &Aabb,
    mesh: &TriangleMesh,
    clipping: Clipping,
    scratch: &mut Scratch,
) -> Counts {
    let plane = ordered(split.position);
    let mut counts = Counts { left: 0, right: 0 };
    let in_plane = if split.planar_left { LEFT } else { RIGHT };
    let mut total = 0;
    for event in events {
        let key = event.key();
        let side = &mut scratch.sides[event.triangle() as usize];
        match event.kind() {
            Kind::Start => {
                total += 1;
                *side = if key >= plane { RIGHT } else { BOTH };
                counts.right += u32::from(key >= plane);
            }
            Kind::End if key <= plane => {
                *side = LEFT;
                counts.left += 1;
            }
            Kind::End => {}
            Kind::Planar => {
                total += 1;
                *side = match key.cmp(&plane) {
                    std::cmp::Ordering::Less => LEFT,
                    std::cmp::Ordering::Equal => in_plane,
                    std::cmp::Ordering::Greater => RIGHT,
                };
                counts.left += u32::from(*side == LEFT);
                counts.right += u32::from(*side == RIGHT);
            }
        }
    }
    scratch.straddlers.clear();
    if counts.left + counts.right < total {
        let starts =
            events.iter().take_while(|event| event.key() < plane).filter(|event| event.kind() == Kind::Start);
        let sides = &scratch.sides;
        scratch
            .straddlers
            .extend(starts.map(|event| event.triangle()).filter(|&id| sides[id as usize] == BOTH));
    }
    clip_straddlers(split, voxel, mesh, clipping.is_exact_for(total), scratch, &mut counts);
    counts
}

fn clip_straddlers(
    split: &Split,
    voxel: &Aabb,
    mesh: &TriangleMesh,
    exact: bool,
    scratch: &mut Scratch,
    counts: &mut Counts,
) {
    for list in scratch.new_left.iter_mut().chain(&mut scratch.new_right) {
        list.clear();
    }
    let (left_voxel, right_voxel) = voxel.split(split.axis, split.position);
    for &id in &scratch.straddlers {
        let (left, right) = if exact {
            split_bounds(&mesh.corners(id), voxel, split.axis, split.position)
        } else {
            let bounds = triangle_bounds(mesh, id);
            (Some(bounds.cut_to(&left_voxel)), Some(bounds.cut_to(&right_voxel)))
        };
        for (bounds, lists, count) in [
            (left, &mut scratch.new_left, &mut counts.left),
            (right, &mut scratch.new_right, &mut counts.right),
        ] {
            if let Some(bounds) = bounds {
                *count += 1;
                for (axis, list) in lists.iter_mut().enumerate() {
                    push_events(list, &bounds, axis, id);
                }
            }
        }
    }
    for list in scratch.new_left.iter_mut().chain(&mut scratch.new_right) {
        list.sort_unstable();
    }
}

/// Bounds of a whole triangle.
pub(crate) fn triangle_bounds(mesh: &TriangleMesh, id: u32) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    mesh.corners(id).into_iter().for_each(|corner| bounds.include(corner));
    bounds
}

/// Bounds of what a voxel holds of a triangle that is in it.
pub(crate) fn bounds_in(mesh: &TriangleMesh, id: u32, voxel: &Aabb, exact: bool) -> Aabb {
    if exact { clipped_bounds(&mesh.corners(id), voxel) } else { triangle_bounds(mesh, id).cut_to(voxel) }
}

/// Splits one axis' list, which is `list[start..]`: afterwards the right child's is `list[start..start + n]`, with n
/// returned, and the left child's follows it to the end of `list`.
pub(crate) fn split_list(list: &mut Vec<Event>, start: usize, axis: usize, scratch: &mut Scratch) -> usize {
    let Scratch { sides, new_left, new_right, filtered, .. } = scratch;
    let length = list.len() - start;
    if filtered.len() < length {
        filtered.resize(length, Event::default());
    }
    let (mut lefts, mut rights) = (0, 0);
    let events = &mut list[start..];
    for i in 0..length {
        let event = events[i];
        let side = sides[event.triangle() as usize];
        // Both writes always, one of them counts: no branch to mispredict.
        filtered[lefts] = event;
        events[rights] = event;
        lefts += usize::from(side == LEFT);
        rights += usize::from(side == RIGHT);
    }
    let right_end = rights + new_right[axis].len();
    if right_end > length {
        list.resize(start + right_end, Event::default()); // rounding made a flat piece thick
    }
    let events = &mut list[start..];
    merge_in_place(&mut events[..right_end], rights, &new_right[axis]);
    list.truncate(start + right_end);
    merge_onto(list, &filtered[..lefts], &new_left[axis]);
    right_end
}

/// Merges sorted `new` into `list`, whose first `old` entries are sorted and whose rest is room for `new`.
fn merge_in_place(list: &mut [Event], old: usize, new: &[Event]) {
    let (mut i, mut j) = (old, new.len());
    while j > 0 {
        if i > 0 && list[i - 1] > new[j - 1] {
            list[i + j - 1] = list[i - 1];
            i -= 1;
        } else {
            list[i + j - 1] = new[j - 1];
            j -= 1;
        }
    }
}

/// Appends the merge of two sorted lists.
fn merge_onto(list: &mut Vec<Event>, old: &[Event], new: &[Event]) {
    list.reserve(old.len() + new.len());
    let mut rest = old;
    for &event in new {
        let before = rest.partition_point(|&other| other < event);
        list.extend_from_slice(&rest[..before]);
        list.push(event);
        rest = &rest[before..];
    }
    list.extend_from_slice(rest);
}
