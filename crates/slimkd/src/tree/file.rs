//! The `.skd` file: a mesh and its tree, little-endian.
//!
//! ```text
//! "SKDTREE\0"  version u32  length of the options u32  options (see `put_options`)
//! six u64: vertices, triangles, nodes, 4-byte indices, 2-byte indices, degenerate triangles
//! the arrays in this order
//! ```
//!
//! The same bytes from any build of the same scene with the same options: no thread count, time or path is inside.
//! Everything is proved on reading, so a damaged file is an error and never a wrong access.

use super::encode::Encoded;
use super::layout::Packed;
use super::{KdTree, walk};
use crate::build::{BuildOptions, Clipping, Preset};
use crate::geometry::{MeshError, TriangleMesh};
use crate::reduce::{CountedLeaves, HoistAlgorithm, Hoisting, OccupancyBase, WhenLeafRemains};
use std::io::{Read, Write};
use std::sync::Arc;
use thiserror::Error;

const MAGIC: &[u8; 8] = b"SKDTREE\0";
const VERSION: u32 = 1;
/// Largest options block that is believed, bytes.
const OPTIONS_LIMIT: u32 = 4096;
/// An array is read in pieces of that many bytes, so that a lying count ends at the file's end instead of memory's.
const PIECE: usize = 1 << 22;

/// Why a `.skd` file could not be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// The first bytes are not a `.skd` file's: build one with `slimkd build SCENE -o tree.skd`.
    #[error("not a .skd tree; make one with `slimkd build SCENE -o tree.skd`")]
    NotATree,
    /// Written by another version of the format: build it again from the scene.
    #[error("format version {found}, this build reads {expected}; build the tree again from its scene")]
    Version {
        /// What the file says.
        found: u32,
        /// What is understood.
        expected: u32,
    },
    /// The contents contradict themselves: the file is damaged, build it again from the scene.
    #[error("damaged tree: {0}; build it again from its scene")]
    Damaged(String),
    /// The operating system refused: see the source.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

impl From<MeshError> for FileError {
    fn from(error: MeshError) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl KdTree {
    /// Writes the mesh and the tree. Give it a buffered writer.
    ///
    /// # Errors
    /// [`FileError::Io`].
    pub fn write(&self, to: &mut impl Write) -> Result<(), FileError> {
        let options = put_options(&self.options);
        to.write_all(MAGIC)?;
        to.write_all(&VERSION.to_le_bytes())?;
        to.write_all(&(options.len() as u32).to_le_bytes())?;
        to.write_all(&options)?;
        let (mesh, tree) = (&self.mesh, &self.encoded);
        for count in [
            mesh.vertices().len(),
            mesh.len(),
            tree.nodes.len(),
            tree.indices_4byte.len(),
            tree.indices_2byte.len(),
            self.degenerate as usize,
        ] {
            to.write_all(&(count as u64).to_le_bytes())?;
        }
        put(to, mesh.vertices().as_flattened(), |x: f32| x.to_le_bytes())?;
        put(to, mesh.triangles().as_flattened(), |x: u32| x.to_le_bytes())?;
        put(to, &tree.nodes, |x: Packed| x.0.to_le_bytes())?;
        put(to, &tree.indices_4byte, |x: u32| x.to_le_bytes())?;
        put(to, &tree.indices_2byte, |x: u16| x.to_le_bytes())?;
        to.flush()?;
        Ok(())
    }

    /// Reads and proves what [`KdTree::write`] wrote.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let mut bytes = Vec::new();
    /// tree.write(&mut bytes)?;
    /// assert_eq!(KdTree::read(&mut &bytes[..])?.memory(), tree.memory());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Any [`FileError`].
    pub fn read(from: &mut impl Read) -> Result<Self, FileError> {
        let mut magic = [0; 8];
        from.read_exact(&mut magic).map_err(|_| FileError::NotATree)?;
        if &magic != MAGIC {
            return Err(FileError::NotATree);
        }
        let version = u32::from_le_bytes(bytes(from)?);
        if version != VERSION {
            return Err(FileError::Version { found: version, expected: VERSION });
        }
        let length = u32::from_le_bytes(bytes(from)?);
        if length > OPTIONS_LIMIT {
            return Err(FileError::Damaged("the options are too long".into()));
        }
        let mut block = vec![0; length as usize];
        from.read_exact(&mut block).map_err(truncated)?;
        let options =
            get_options(&block).ok_or_else(|| FileError::Damaged("the options make no sense".into()))?;
        let mut counts = [0u64; 6];
        for count in &mut counts {
            *count = u64::from_le_bytes(bytes(from)?);
        }
        let [vertices, triangles, nodes, wide, narrow, degenerate] = counts;
        let vertices: Vec<f32> = get(from, vertices.checked_mul(3), f32::from_le_bytes)?;
        let corners: Vec<u32> = get(from, triangles.checked_mul(3), u32::from_le_bytes)?;
        let encoded = Encoded {
            nodes: get(from, Some(nodes), |bytes| Packed(u64::from_le_bytes(bytes)))?,
            indices_4byte: get(from, Some(wide), u32::from_le_bytes)?,
            indices_2byte: get(from, Some(narrow), u16::from_le_bytes)?,
        };
        if from.read(&mut [0])? != 0 {
            return Err(FileError::Damaged("there are bytes behind the end".into()));
        }
        let mesh = TriangleMesh::new(vertices.as_chunks().0.to_vec(), corners.as_chunks().0.to_vec())?;
        let depth = walk::validate(&encoded, mesh.len())?;
        let (valid, bounds) = mesh.valid_triangles();
        if (mesh.len() - valid.len()) as u64 != degenerate {
            return Err(FileError::Damaged("the count of degenerate triangles is wrong".into()));
        }
        Ok(Self { mesh: Arc::new(mesh), options, bounds, encoded, depth, degenerate })
    }
}

fn truncated(error: std::io::Error) -> FileError {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => FileError::Damaged("the file ends too early".into()),
        _ => FileError::Io(error),
    }
}

fn bytes<const N: usize>(from: &mut impl Read) -> Result<[u8; N], FileError> {
    let mut out = [0; N];
    from.read_exact(&mut out).map_err(truncated)?;
    Ok(out)
}

fn put<T: Copy, const N: usize>(
    to: &mut impl Write,
    items: &[T],
    encode: impl Fn(T) -> [u8; N],
) -> std::io::Result<()> {
    let mut piece = Vec::with_capacity(PIECE.min(items.len() * N));
    for items in items.chunks(PIECE / N) {
        piece.clear();
        items.iter().for_each(|&item| piece.extend_from_slice(&encode(item)));
        to.write_all(&piece)?;
    }
    Ok(())
}

fn get<T, const N: usize>(
    from: &mut impl Read,
    count: Option<u64>,
    decode: impl Fn([u8; N]) -> T,
) -> Result<Vec<T>, FileError> {
    let count = count
        .filter(|&count| count <= 1 << 33)
        .ok_or_else(|| FileError::Damaged("a count is absurd".into()))?;
    let mut left = count as usize;
    let mut out = Vec::new();
    let mut piece = Vec::new();
    while left > 0 {
        let now = left.min(PIECE / N);
        piece.resize(now * N, 0);
        from.read_exact(&mut piece).map_err(truncated)?;
        out.extend(piece.as_chunks::<N>().0.iter().map(|&item| decode(item)));
        left -= now;
    }
    out.shrink_to_fit();
    Ok(out)
}

/// Options as bytes: the preset's name with its length, then 4-byte words.
fn put_options(options: &BuildOptions) -> Vec<u8> {
    let name = options.preset.name().as_bytes();
    let mut out = vec![name.len() as u8];
    out.extend_from_slice(name);
    let sah = options.sah;
    let clipping = match options.clipping {
        Clipping::Exact => 0,
        Clipping::ExactFrom(least) => least.max(1),
        Clipping::Box => u32::MAX,
    };
    let mut words = vec![
        sah.traversal.to_bits(),
        sah.intersection.to_bits(),
        sah.empty_bonus.to_bits(),
        options.leaf_at_most,
        clipping,
        options.two_byte_leaves.into(),
        options.collapse.into(),
        options.byte_weight.to_bits(),
        options.hoisting.is_some().into(),
    ];
    if let Some(hoisting) = &options.hoisting {
        words.extend([
            hoisting.occupancy.to_bits(),
            hoisting.frequency.to_bits(),
            match hoisting.algorithm {
                HoistAlgorithm::Strip => 0,
                HoistAlgorithm::Rebuild => 1,
                HoistAlgorithm::Predict => 2,
            },
            (hoisting.occupancy_base == OccupancyBase::NodeArea).into(),
            (hoisting.leaves == CountedLeaves::NotEmpty).into(),
            (hoisting.when_leaf_remains == WhenLeafRemains::DropPick).into(),
        ]);
    }
    words.iter().for_each(|word| out.extend_from_slice(&word.to_le_bytes()));
    out
}

fn get_options(block: &[u8]) -> Option<BuildOptions> {
    let (&length, rest) = block.split_first()?;
    let (name, numbers) = rest.split_at_checked(length.into())?;
    let mut options = BuildOptions::from(Preset::from_name(std::str::from_utf8(name).ok()?)?);
    let (words, []) = numbers.as_chunks::<4>() else { return None };
    let words: Vec<u32> = words.iter().map(|&word| u32::from_le_bytes(word)).collect();
    let (
        &[
            traversal,
            intersection,
            empty_bonus,
            leaf_at_most,
            clipping,
            two_byte,
            collapse,
            byte_weight,
            hoists,
        ],
        rest,
    ) = words.split_first_chunk::<9>()?;
    let choose = |word: u32| (word <= 1).then_some(word == 1);
    options.sah.traversal = f32::from_bits(traversal);
    options.sah.intersection = f32::from_bits(intersection);
    options.sah.empty_bonus = f32::from_bits(empty_bonus);
    options.leaf_at_most = leaf_at_most;
    options.clipping = match clipping {
        0 => Clipping::Exact,
        u32::MAX => Clipping::Box,
        least => Clipping::ExactFrom(least),
    };
    options.two_byte_leaves = choose(two_byte)?;
    options.collapse = choose(collapse)?;
    options.byte_weight = f32::from_bits(byte_weight);
    options.hoisting = match (choose(hoists)?, rest) {
        (false, []) => None,
        (true, &[occupancy, frequency, algorithm, node_area, not_empty, drop_pick]) => {
            let mut hoisting = Hoisting::new(f32::from_bits(occupancy), f32::from_bits(frequency));
            hoisting.algorithm = match algorithm {
                0 => HoistAlgorithm::Strip,
                1 => HoistAlgorithm::Rebuild,
                2 => HoistAlgorithm::Predict,
                _ => return None,
            };
            if choose(node_area)? {
                hoisting.occupancy_base = OccupancyBase::NodeArea;
            }
            if choose(not_empty)? {
                hoisting.leaves = CountedLeaves::NotEmpty;
            }
            if choose(drop_pick)? {
                hoisting.when_leaf_remains = WhenLeafRemains::DropPick;
            }
            Some(hoisting)
        }
        _ => return None,
    };
    options.validate().ok()?;
    Some(options)
}
