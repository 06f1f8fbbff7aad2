//! Rays that did not go along with their neighbours: gathered from the whole batch and traced as one, whatever they are.

use crate::geometry::Ray;

/// Places in the batch whose hits are still to be found.
pub(crate) type Strays = Vec<usize>;

/// Rays gathered at once: what streams were measured with, and what their buffers are bounded by.
const PIECE: usize = 4096;

/// Finds the hits of `strays` by `trace`.
pub(crate) fn finish<H: Copy + Default>(
    rays: &[Ray],
    hits: &mut [H],
    except: Option<&[u32]>,
    strays: &[usize],
    trace: impl Fn(&[Ray], Option<&[u32]>, &mut [H]),
) {
    for strays in strays.chunks(PIECE) {
        let gathered: Vec<Ray> = strays.iter().map(|&at| rays[at]).collect();
        let mut found = vec![H::default(); gathered.len()];
        let left_out: Option<Vec<u32>> = except.map(|except| strays.iter().map(|&at| except[at]).collect());
        trace(&gathered, left_out.as_deref(), &mut found);
        strays.iter().zip(found).for_each(|(&at, hit)| hits[at] = hit);
    }
}
