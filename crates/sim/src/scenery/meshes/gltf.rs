//! glTF 2.0, text and GLB, through `gltf`.
//!
//! The crate reads and checks the document. Accessors are read here, because the crate's own
//! readers trust offsets and counts. Sparse accessors and data URIs are errors.

use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::Source;
use ::gltf::json::Root;
use ::gltf::mesh::Mode;
use ::gltf::{Accessor, Document, Gltf, Node, Primitive};
use glam::{DMat4, DVec3};

use super::{Fault, ReadReferencedFile, TriangleSoup};

/// Length of a GLB's header, which the length in it counts.
const HEADER: u32 = 12;
/// Greatest depth of nested nodes.
const DEEPEST: usize = 64;
/// Greatest number of instances of meshes in a file: nodes can share children.
const MOST_NODES: usize = 1 << 20;

pub(super) fn read(
    bytes: &[u8],
    read_referenced: ReadReferencedFile<'_>,
) -> Result<TriangleSoup, Fault> {
    check_length(bytes)?;
    let Gltf { document, mut blob } =
        Gltf::from_slice_without_validation(bytes).map_err(|error| error.to_string())?;
    let json = document.into_json();
    check_positions(&json)?;
    let document = Document::from_json(json).map_err(|error| error.to_string())?;
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        buffers.push(match buffer.source() {
            Source::Bin => blob.take().ok_or("expected a binary chunk, got none")?,
            Source::Uri(uri) if uri.starts_with("data:") => {
                return Err("expected data in a binary chunk or a file, got a data URI".into());
            }
            Source::Uri(uri) => read_referenced(uri).map_err(Fault::ReferencedFile)?,
        });
    }
    let mut reader = Reader {
        buffers,
        soup: TriangleSoup::default(),
        nodes: 0,
    };
    reader.document(&document)?;
    Ok(reader.soup)
}

/// The crate takes it for granted that the length in a GLB's header counts that header.
fn check_length(bytes: &[u8]) -> Result<(), Fault> {
    let length = match bytes.first_chunk::<12>() {
        Some([b'g', b'l', b'T', b'F', _, _, _, _, length @ ..]) => u32::from_le_bytes(*length),
        _ => return Ok(()),
    };
    match length >= HEADER {
        true => Ok(()),
        false => Err(
            format!("GLB at byte 8: expected a length of 12 bytes or more, got {length}").into(),
        ),
    }
}

/// The crate's own checks take it for granted that accessors of positions are there.
fn check_positions(json: &Root) -> Result<(), Fault> {
    let accessors = json.accessors.len();
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for accessor in primitives.flat_map(|primitive| primitive.attributes.values()) {
        let got = accessor.value();
        if got >= accessors {
            return Err(format!("expected accessors below {accessors}, got {got}").into());
        }
    }
    Ok(())
}

struct Reader {
    buffers: Vec<Vec<u8>>,
    soup: TriangleSoup,
    nodes: usize,
}

impl Reader {
    /// The default scene, or the first; without one every mesh as it is.
    fn document(&mut self, document: &Document) -> Result<(), Fault> {
        let scene = document
            .default_scene()
            .or_else(|| document.scenes().next());
        let Some(scene) = scene else {
            for primitive in document.meshes().flat_map(|mesh| mesh.primitives()) {
                self.primitive(&primitive, DMat4::IDENTITY)?;
            }
            return Ok(());
        };
        for node in scene.nodes() {
            self.node(&node, DMat4::IDENTITY, 0)?;
        }
        Ok(())
    }

    fn node(&mut self, node: &Node<'_>, outer: DMat4, depth: usize) -> Result<(), Fault> {
        self.nodes += 1;
        if depth > DEEPEST || self.nodes > MOST_NODES {
            return Err(
                format!("expected nodes at most {DEEPEST} deep and {MOST_NODES} of them").into(),
            );
        }
        let columns = node
            .transform()
            .matrix()
            .map(|column| column.map(f64::from));
        let matrix = outer * DMat4::from_cols_array_2d(&columns);
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            self.primitive(&primitive, matrix)?;
        }
        for child in node.children() {
            self.node(&child, matrix, depth + 1)?;
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive<'_>, matrix: DMat4) -> Result<(), Fault> {
        let fan: fn(usize) -> [usize; 3] = match primitive.mode() {
            Mode::Triangles => |at| [3 * at, 3 * at + 1, 3 * at + 2],
            // Every other triangle of a strip goes round the other way.
            Mode::TriangleStrip => |at| [at, at + 1 + at % 2, at + 2 - at % 2],
            Mode::TriangleFan => |at| [0, at + 1, at + 2],
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return Ok(()),
        };
        let positions = primitive
            .get(&::gltf::Semantic::Positions)
            .ok_or("expected positions")?;
        let points = self.points(&positions)?;
        let numbers: Vec<u32> = match primitive.indices() {
            Some(indices) => self.numbers(&indices)?,
            None => (0_u32..).take(points.len()).collect(),
        };
        let triangles = match primitive.mode() {
            Mode::Triangles => numbers.len() / 3,
            _ => numbers.len().saturating_sub(2),
        };
        let first = u32::try_from(self.soup.vertices.len()).map_err(|_| "too many vertices")?;
        // A reflection reverses the orientation of triangles.
        let mirrored = matrix.determinant() < 0.0;
        for at in 0..triangles {
            let [a, b, c] = fan(at).map(|corner| numbers.get(corner).copied());
            if let (Some(a), Some(b), Some(c)) = (a, b, c) {
                if let Some(beyond) = [a, b, c].into_iter().find(|n| *n as usize >= points.len()) {
                    return Err(
                        format!("expected vertices below {}, got {beyond}", points.len()).into(),
                    );
                }
                let corners = if mirrored { [a, c, b] } else { [a, b, c] };
                self.soup
                    .triangles
                    .push(corners.map(|n| n.saturating_add(first)));
            }
        }
        let moved = points
            .into_iter()
            .map(|point| matrix.transform_point3(point));
        self.soup.vertices.extend(moved);
        Ok(())
    }

    fn points(&self, accessor: &Accessor<'_>) -> Result<Vec<DVec3>, Fault> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
            return Err("expected positions of three f32".into());
        }
        let of = |item: &[u8]| {
            let (numbers, _) = item.as_chunks::<4>();
            match numbers {
                [x, y, z, ..] => Some(DVec3::from_array(
                    [x, y, z].map(|bytes| f64::from(f32::from_le_bytes(*bytes))),
                )),
                _ => None,
            }
        };
        Ok(self.items(accessor, 12)?.filter_map(of).collect())
    }

    fn numbers(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, Fault> {
        let size = match (accessor.data_type(), accessor.dimensions()) {
            (DataType::U8, Dimensions::Scalar) => 1,
            (DataType::U16, Dimensions::Scalar) => 2,
            (DataType::U32, Dimensions::Scalar) => 4,
            _ => return Err("expected indices of u8, u16 or u32".into()),
        };
        let of = |item: &[u8]| {
            let mut whole = [0; 4];
            for (to, from) in whole.iter_mut().zip(item) {
                *to = *from;
            }
            u32::from_le_bytes(whole)
        };
        Ok(self.items(accessor, size)?.map(of).collect())
    }

    /// The bytes of each item of an accessor.
    fn items(
        &self,
        accessor: &Accessor<'_>,
        size: usize,
    ) -> Result<impl Iterator<Item = &[u8]>, Fault> {
        let view = match (accessor.view(), accessor.sparse()) {
            (Some(view), None) => view,
            _ => return Err("expected an accessor with a view that is not sparse".into()),
        };
        let (stride, count) = (view.stride().unwrap_or(size), accessor.count());
        let within = || {
            let buffer = self.buffers.get(view.buffer().index())?;
            let end = view.offset().checked_add(view.length())?;
            let view = buffer.get(view.offset()..end)?;
            let needed = count
                .checked_sub(1)?
                .checked_mul(stride)?
                .checked_add(size)?;
            view.get(accessor.offset()..accessor.offset().checked_add(needed)?)
        };
        let number = accessor.index();
        let bytes = within().ok_or(format!("accessor {number} reaches beyond its buffer"))?;
        if stride < size {
            return Err(format!(
                "accessor {number}: expected a stride of {size} or more, got {stride}"
            )
            .into());
        }
        Ok((0..count).filter_map(move |at| bytes.get(at * stride..at * stride + size)))
    }
}
