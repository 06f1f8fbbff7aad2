//! The best split of a node, whatever its size.

use super::bins::{Candidates, Histogram, Search};
use super::pairs;
use super::sah::VoxelSah;
use super::sweep::Split;
use crate::construct::grow::Fragment;
use crate::geometry::Aabb;
use crate::job::Progress;
use crate::options::{BuildError, BuildOptions};
use crate::threads;

/// Buffers that one worker reuses from node to node.
#[derive(Default)]
pub(crate) struct Scratch {
    pub(crate) left: Vec<Fragment>,
    pub(crate) straddlers: Vec<Fragment>,
    search: Search,
    candidates: Candidates,
}

impl Scratch {
    /// The split to make, or `None` for a leaf. A split must be cheaper than a leaf by more than `margin`.
    pub(crate) fn best_split(
        &mut self,
        fragments: &[Fragment],
        voxel: &Aabb,
        options: &BuildOptions,
        margin: f64,
    ) -> Result<Option<Split>, BuildError> {
        let count = fragments.len();
        if count <= options.leaf_at_most as usize {
            return Ok(None);
        }
        let sah = VoxelSah::new(&options.sah, voxel);
        let best = if count <= pairs::MOST {
            pairs::best_split(fragments, voxel, &sah)
        } else {
            self.by_bins(fragments, voxel, &sah)?
        };
        Ok(best.filter(|split| split.cost + margin < sah.leaf(count)))
    }

    fn by_bins(
        &mut self,
        fragments: &[Fragment],
        voxel: &Aabb,
        sah: &VoxelSah,
    ) -> Result<Option<Split>, BuildError> {
        let count = fragments.len();
        let binner = self.search.begin(voxel, count);
        self.search.histogram.count(fragments, &binner);
        self.search.open(sah, count as i32);
        self.candidates.clear();
        self.search.gather(fragments, voxel, &mut self.candidates)?;
        Ok(self.search.sweep(&mut self.candidates, sah, count as i32))
    }

    /// [`Scratch::best_split`] of a large node in pieces, by all threads.
    pub(crate) fn best_split_parallel(
        &mut self,
        pieces: &[Vec<Fragment>],
        count: usize,
        voxel: &Aabb,
        options: &BuildOptions,
        progress: &Progress,
    ) -> Result<Option<Split>, BuildError> {
        let sah = VoxelSah::new(&options.sah, voxel);
        let search = &mut self.search;
        let binner = search.begin(voxel, count);
        let count_piece = |mut histogram: Box<Histogram>, piece: &Vec<Fragment>| {
            progress.check()?;
            histogram.count(piece, &binner);
            Ok(histogram)
        };
        let add = |mut a: Box<Histogram>, b: Box<Histogram>| {
            a.add(&b, binner.bins());
            Ok(a)
        };
        if let Some(histogram) = threads::fold(pieces, Box::default, count_piece, add)? {
            search.histogram.add(&histogram, binner.bins());
        }
        search.open(&sah, count as i32);
        let gather = |mut candidates: Candidates, piece: &Vec<Fragment>| {
            progress.check()?;
            search.gather(piece, voxel, &mut candidates)?;
            Ok(candidates)
        };
        let append = |mut a: Candidates, b: Candidates| {
            a.append(b)?;
            Ok(a)
        };
        let gathered = threads::fold(pieces, Candidates::default, gather, append)?;
        let best = search.sweep(&mut gathered.unwrap_or_default(), &sah, count as i32);
        Ok(best.filter(|split| split.cost < sah.leaf(count)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweep::{Event, best_of, cheaper};
    use super::*;
    use crate::options::SahConstants;
    use proptest::prelude::*;

    /// Every plane of every axis, by one sweep over all events.
    fn exhaustive(fragments: &[Fragment], voxel: &Aabb, sah: &VoxelSah) -> Option<Split> {
        (0..3).fold(None, |best, axis| {
            let (least, most) = (voxel.min[axis], voxel.max[axis]);
            let inside = |x: f32| least < x && x < most;
            let mut events = Vec::new();
            let (mut left, mut right) = (0, fragments.len() as i32);
            for Fragment { low, high } in fragments {
                let (low, high) = (low[axis], high[axis]);
                left += i32::from(low <= least);
                right -= i32::from(high <= least);
                events.extend(inside(low).then(|| Event::low(low, high)));
                events.extend((low < high && inside(high)).then(|| Event::high(high)));
            }
            events.sort_unstable();
            cheaper(best, best_of(&events, axis, sah, left, right))
        })
    }

    fn fragment(voxel: Aabb) -> impl Strategy<Value = Fragment> {
        // Round coordinates collide, those beyond the voxel come to lie on its faces.
        let x = || prop_oneof![(-1i8..10).prop_map(|x| f32::from(x) / 8.0), -0.2f32..1.2];
        (prop::array::uniform3(x()), prop::array::uniform3(x()), any::<u32>()).prop_map(
            move |(a, b, flat)| {
                let mut bounds = Aabb::EMPTY;
                let stretched =
                    |p: [f32; 3]| std::array::from_fn(|k| voxel.min[k] + p[k] * voxel.extent()[k] as f32);
                bounds.include(stretched(a));
                bounds.include(stretched(b));
                for k in (0..3).filter(|k| flat >> (2 * k) & 3 == 0) {
                    bounds.max[k] = bounds.min[k];
                }
                Fragment::new(flat, &bounds.cut_to(&voxel))
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn bins_and_pairs_find_the_exact_sweeps_split(
            (voxel, fragments) in prop::sample::select(vec![
                Aabb { min: [0.0; 3], max: [1.0; 3] },
                Aabb { min: [-0.5, 3.0, 1e6], max: [0.5, 3.0, 1.1e6] },
                Aabb { min: [-3e38, 1e-40, -1e-30], max: [3e38, 3e-40, 1e-30] },
            ]).prop_flat_map(|voxel| (Just(voxel), prop::collection::vec(fragment(voxel), 1..300))),
            empty_bonus in prop::sample::select(vec![0.8f32, 1.0, 1.5]),
        ) {
            let constants = SahConstants { traversal: 15.0, intersection: 20.0, empty_bonus };
            let sah = VoxelSah::new(&constants, &voxel);
            let mut scratch = Scratch::default();
            let expected = exhaustive(&fragments, &voxel, &sah);
            prop_assert_eq!(scratch.by_bins(&fragments, &voxel, &sah).unwrap(), expected);
            let few = &fragments[..fragments.len().min(pairs::MOST)];
            prop_assert_eq!(pairs::best_split(few, &voxel, &sah), exhaustive(few, &voxel, &sah));
        }
    }
}
