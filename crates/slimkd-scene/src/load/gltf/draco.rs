//! Primitives that Draco compressed: `KHR_draco_mesh_compression`, decoded by `draco-core`.

use super::{
    accessor::Number,
    json,
    reader::{DAMAGED, Reader},
};
use crate::load::{LoadError, Place};
use draco_core::{DataType, DecodeLimits, DecoderBuffer, MeshDecoder, PointIndex};

/// Bytes that decoding takes for a triangle beside its attributes: Draco's tables of corners and the triangle itself.
const TRIANGLE: u64 = 128;

/// A decoded primitive.
pub(super) struct Mesh(draco_core::Mesh);

impl Reader<'_> {
    /// Decodes a primitive's geometry.
    pub(super) fn draco(&self, packed: &json::Draco) -> Result<Mesh, LoadError> {
        let (bytes, _) = self.view(packed.buffer_view.0)?;
        let budget = self.decoding_budget();
        let mut limits = DecodeLimits::default();
        (limits.max_faces, limits.max_points, limits.max_decoded_bytes) =
            (budget / TRIANGLE, budget / 16, budget);
        let mut mesh = draco_core::Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|error| {
            let why = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            let place = Place::Entry("bufferViews", packed.buffer_view.0);
            self.invalid(place, format!("Draco: {why}"), "export it again, without Draco compression")
        })?;
        let attributes: u64 =
            (0..mesh.num_attributes()).map(|k| mesh.attribute(k).buffer().data_size() as u64).sum();
        self.spend_decoding(mesh.num_faces() as u64 * TRIANGLE + attributes)?;
        Ok(Mesh(mesh))
    }
}

impl Mesh {
    pub(super) fn vertices(&self) -> usize {
        self.0.num_points()
    }

    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.0.faces().iter().map(|face| face.map(|point| point.0))
    }

    /// Calls `each` with the components of the attribute with that unique id, for every vertex.
    pub(super) fn read<const N: usize, T>(
        &self,
        reader: &Reader<'_>,
        place: Place,
        id: usize,
        normalized: bool,
        each: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, LoadError> {
        let wrong = |what: String| reader.invalid(place, what, DAMAGED);
        let attribute = u32::try_from(id).ok().and_then(|id| self.0.attribute_by_unique_id(id));
        let attribute = attribute.ok_or_else(|| wrong(format!("Draco has no attribute {id}")))?;
        let number = match attribute.data_type() {
            DataType::Int8 => Number::I8,
            DataType::Uint8 | DataType::Bool => Number::U8,
            DataType::Int16 => Number::I16,
            DataType::Uint16 => Number::U16,
            DataType::Int32 => Number::I32,
            DataType::Uint32 => Number::U32,
            DataType::Float32 => Number::F32,
            DataType::Float64 => Number::F64,
            other => return Err(wrong(format!("Draco's attribute {id} is of type {other:?}"))),
        };
        let (width, stride) = (usize::from(attribute.num_components()), attribute.byte_stride() as usize);
        if width < N {
            return Err(wrong(format!("Draco's attribute {id} has {width} components where {N} are needed")));
        }
        let data = attribute.buffer().data();
        let vertex = |point: u32| {
            let entry = attribute.mapped_index(PointIndex(point)).0 as usize;
            let raw = data.get(entry.checked_mul(stride)?..)?.get(..N * number.size())?;
            Some(each(std::array::from_fn(|k| number.value(&raw[k * number.size()..], normalized))))
        };
        let values = (0..self.vertices() as u32).map(vertex).collect::<Option<Vec<T>>>();
        values.ok_or_else(|| wrong(format!("Draco's attribute {id} has too few values")))
    }
}
