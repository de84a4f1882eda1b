//! PLY: source, little-endian or big-endian, any properties of the vertices.

use super::source::{ReadError, SourceField, SourceFile, SourceNumber, SourceRow, shown};
use super::stored_cloud::StoredCloud;
use crate::formats::Format;

/// The header.
struct PlyHeader {
    data: PlyEncoding,
    /// Offset of the data, bytes.
    start: usize,
    elements: Vec<PlyElement>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum PlyEncoding {
    Text,
    Little,
    Big,
}

struct PlyElement {
    name: String,
    count: usize,
    properties: Vec<(String, PlyProperty)>,
}

#[derive(Clone, Copy)]
enum PlyProperty {
    One(SourceNumber),
    /// A count, and that many items: the types of both.
    List(SourceNumber, SourceNumber),
}

pub(super) fn read(bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
    let source = SourceFile {
        format: Format::Ply,
        bytes,
    };
    let header = header(&source)?;
    let mut offset = header.start;
    for element in &header.elements {
        if element.name == "vertex" {
            return vertices(&source, element, offset, header.data, cloud);
        }
        // Elements without bytes: a forged count of them would take forever.
        let is_nothing = element.properties.is_empty() && header.data != PlyEncoding::Text;
        let count = if is_nothing { 0 } else { element.count };
        for _ in 0..count {
            offset = match header.data {
                PlyEncoding::Text => source.line(offset)?.map(|(_, next)| next),
                PlyEncoding::Little | PlyEncoding::Big => {
                    skip(bytes, element, offset, header.data == PlyEncoding::Big)
                }
            }
            .ok_or_else(|| source.wrong(bytes.len(), format!("a {}", element.name), "the end"))?;
        }
    }
    Err(source.wrong(0, "an element vertex", "none"))
}

fn header(source: &SourceFile<'_>) -> Result<PlyHeader, ReadError> {
    let mut offset = 0;
    let mut data = None;
    let mut elements: Vec<PlyElement> = Vec::new();
    loop {
        let end = || source.wrong(source.bytes.len(), "end_header", "the end of the file");
        let (line, next) = source.line(offset)?.ok_or_else(end)?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let wrong = |expected: &str| source.wrong(offset, expected, shown(line));
        match (offset, words.as_slice()) {
            (0, ["ply"]) | (_, ["comment" | "obj_info", ..] | []) => {}
            (0, _) => return Err(wrong("ply")),
            (_, ["format", kind, _]) => {
                data = Some(match *kind {
                    "ascii" => PlyEncoding::Text,
                    "binary_little_endian" => PlyEncoding::Little,
                    "binary_big_endian" => PlyEncoding::Big,
                    _ => {
                        return Err(wrong(
                            "format ascii, binary_little_endian or binary_big_endian",
                        ));
                    }
                });
            }
            (_, ["element", name, count]) => elements.push(PlyElement {
                name: (*name).to_owned(),
                count: count.parse().map_err(|_| wrong("a number of elements"))?,
                properties: Vec::new(),
            }),
            (_, ["property", rest @ .., name]) => {
                let property = property(rest).ok_or_else(|| wrong("a type of number"))?;
                let element = elements.last_mut().ok_or_else(|| wrong("an element"))?;
                element.properties.push(((*name).to_owned(), property));
            }
            (_, ["end_header"]) => {
                let data = data.ok_or_else(|| wrong("format before end_header"))?;
                return Ok(PlyHeader {
                    data,
                    start: next,
                    elements,
                });
            }
            _ => return Err(wrong("a line of a PLY header")),
        }
        offset = next;
    }
}

fn property(words: &[&str]) -> Option<PlyProperty> {
    match words {
        [one] => Some(PlyProperty::One(number(one)?)),
        ["list", count, item] => Some(PlyProperty::List(number(count)?, number(item)?)),
        _ => None,
    }
}

fn number(name: &str) -> Option<SourceNumber> {
    Some(match name {
        "char" | "int8" => SourceNumber::I8,
        "uchar" | "uint8" => SourceNumber::U8,
        "short" | "int16" => SourceNumber::I16,
        "ushort" | "uint16" => SourceNumber::U16,
        "int" | "int32" => SourceNumber::I32,
        "uint" | "uint32" => SourceNumber::U32,
        "float" | "float32" => SourceNumber::F32,
        "double" | "float64" => SourceNumber::F64,
        _ => return None,
    })
}

/// Offset after one element.
fn skip(bytes: &[u8], element: &PlyElement, mut offset: usize, big_endian: bool) -> Option<usize> {
    for (_, property) in &element.properties {
        offset = match property {
            PlyProperty::One(number) => offset.checked_add(number.bytes())?,
            PlyProperty::List(count, item) => {
                let items = count.read(bytes.get(offset..)?, big_endian)?;
                let size = (items as usize).checked_mul(item.bytes())?;
                offset.checked_add(count.bytes())?.checked_add(size)?
            }
        };
    }
    (offset <= bytes.len()).then_some(offset)
}

fn vertices(
    source: &SourceFile<'_>,
    element: &PlyElement,
    start: usize,
    data: PlyEncoding,
    cloud: &mut StoredCloud,
) -> Result<(), ReadError> {
    let mut fields = Vec::new();
    let mut byte = 0;
    for (word, (name, property)) in element.properties.iter().enumerate() {
        let number = match property {
            PlyProperty::One(number) => *number,
            // Words after a list have no fixed place.
            PlyProperty::List(..) if data == PlyEncoding::Text => break,
            PlyProperty::List(..) => {
                return Err(source.wrong(0, "vertices without lists", format!("a list {name}")));
            }
        };
        fields.push((name.as_str(), SourceField { word, byte, number }));
        byte += number.bytes();
    }
    let row = SourceRow::of(fields)
        .map_err(|axis| source.wrong(0, format!("a property {axis} of the vertices"), "none"))?;
    let count = element.count;
    if data == PlyEncoding::Text {
        let got = source.rows(start, &row, count, cloud)?;
        return match got < count {
            true => {
                let expected = format!("{count} vertices");
                Err(source.wrong(source.bytes.len(), expected, got.to_string()))
            }
            false => Ok(()),
        };
    }
    let table = source.table(start, (count, byte), &row, data == PlyEncoding::Big, cloud);
    table.map_err(|got| {
        let expected = format!("{count} vertices of {byte} bytes");
        source.wrong(start, expected, format!("{got} bytes"))
    })
}
