//! PLY: text, little-endian or big-endian, any properties of the vertices.

use super::{Number, Positions, ReadError, Text, shown};
use crate::formats::Format;

/// What the header says.
struct Header {
    data: Data,
    /// Where the data begins.
    start: usize,
    elements: Vec<Element>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Data {
    Text,
    Little,
    Big,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<(String, Property)>,
}

#[derive(Clone, Copy)]
enum Property {
    One(Number),
    /// So many of the second as the first says.
    List(Number, Number),
}

pub(super) fn positions(bytes: &[u8]) -> Result<Positions, ReadError> {
    let text = Text {
        format: Format::Ply,
        bytes,
    };
    let header = header(&text)?;
    let mut offset = header.start;
    for element in &header.elements {
        if element.name == "vertex" {
            return match header.data {
                Data::Text => text_vertices(&text, element, offset),
                Data::Little | Data::Big => {
                    vertices(&text, element, offset, header.data == Data::Big)
                }
            };
        }
        // So many as nothing has no end.
        let is_nothing = element.properties.is_empty() && header.data != Data::Text;
        let count = if is_nothing { 0 } else { element.count };
        for _ in 0..count {
            offset = match header.data {
                Data::Text => text.line(offset)?.map(|(_, next)| next),
                Data::Little | Data::Big => skip(bytes, element, offset, header.data == Data::Big),
            }
            .ok_or_else(|| text.wrong(bytes.len(), format!("a {}", element.name), "the end"))?;
        }
    }
    Err(text.wrong(0, "an element vertex", "none"))
}

fn header(text: &Text<'_>) -> Result<Header, ReadError> {
    let mut offset = 0;
    let mut data = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let end = || text.wrong(text.bytes.len(), "end_header", "the end of the file");
        let (line, next) = text.line(offset)?.ok_or_else(end)?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let wrong = |expected: &str| text.wrong(offset, expected, shown(line));
        match (offset, words.as_slice()) {
            (0, ["ply"]) | (_, ["comment" | "obj_info", ..] | []) => {}
            (0, _) => return Err(wrong("ply")),
            (_, ["format", kind, _]) => {
                data = Some(match *kind {
                    "ascii" => Data::Text,
                    "binary_little_endian" => Data::Little,
                    "binary_big_endian" => Data::Big,
                    _ => {
                        return Err(wrong(
                            "format ascii, binary_little_endian or binary_big_endian",
                        ));
                    }
                });
            }
            (_, ["element", name, count]) => elements.push(Element {
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
                return Ok(Header {
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

fn property(words: &[&str]) -> Option<Property> {
    match words {
        [one] => Some(Property::One(number(one)?)),
        ["list", count, item] => Some(Property::List(number(count)?, number(item)?)),
        _ => None,
    }
}

fn number(name: &str) -> Option<Number> {
    Some(match name {
        "char" | "int8" => Number::I8,
        "uchar" | "uint8" => Number::U8,
        "short" | "int16" => Number::I16,
        "ushort" | "uint16" => Number::U16,
        "int" | "int32" => Number::I32,
        "uint" | "uint32" => Number::U32,
        "float" | "float32" => Number::F32,
        "double" | "float64" => Number::F64,
        _ => return None,
    })
}

/// Where what follows one of an element begins.
fn skip(bytes: &[u8], element: &Element, mut offset: usize, big_endian: bool) -> Option<usize> {
    for (_, property) in &element.properties {
        offset = match property {
            Property::One(number) => offset.checked_add(number.bytes())?,
            Property::List(count, item) => {
                let items = count.read(bytes.get(offset..)?, big_endian)?;
                let size = (items as usize).checked_mul(item.bytes())?;
                offset.checked_add(count.bytes())?.checked_add(size)?
            }
        };
    }
    (offset <= bytes.len()).then_some(offset)
}

/// Which property is this one.
fn place(text: &Text<'_>, element: &Element, name: &str) -> Result<usize, ReadError> {
    let found = element.properties.iter().position(|(own, _)| own == name);
    found.ok_or_else(|| text.wrong(0, format!("a property {name} of the vertices"), "none"))
}

fn text_vertices(
    text: &Text<'_>,
    element: &Element,
    offset: usize,
) -> Result<Positions, ReadError> {
    let at = |name: &str| place(text, element, name);
    let places = [at("x")?, at("y")?, at("z")?];
    let positions = text.rows(offset, places, |c| c.is_ascii_whitespace(), element.count)?;
    if positions.len() < element.count {
        let expected = format!("{} vertices", element.count);
        return Err(text.wrong(text.bytes.len(), expected, positions.len().to_string()));
    }
    Ok(positions)
}

fn vertices(
    text: &Text<'_>,
    element: &Element,
    start: usize,
    big_endian: bool,
) -> Result<Positions, ReadError> {
    let mut columns = [(0, Number::F32); 3];
    for (column, name) in columns.iter_mut().zip(["x", "y", "z"]) {
        let mut offset = 0;
        for (own, property) in element
            .properties
            .iter()
            .take(place(text, element, name)? + 1)
        {
            let Property::One(number) = property else {
                return Err(text.wrong(0, "vertices without lists", format!("a list {own}")));
            };
            *column = (offset, *number);
            offset += number.bytes();
        }
    }
    let mut row = 0_usize;
    for (own, property) in &element.properties {
        let Property::One(number) = property else {
            return Err(text.wrong(0, "vertices without lists", format!("a list {own}")));
        };
        row += number.bytes();
    }
    let rows = text.bytes.get(start..).unwrap_or_default();
    if element
        .count
        .checked_mul(row)
        .is_none_or(|size| size > rows.len())
    {
        let expected = format!("{} vertices of {row} bytes", element.count);
        return Err(text.wrong(start, expected, format!("{} bytes", rows.len())));
    }
    let read = |row: &[u8], (offset, number): (usize, Number)| {
        let bytes = row.get(offset..).unwrap_or_default();
        number.read(bytes, big_endian).unwrap_or(f64::NAN)
    };
    let rows = rows.chunks_exact(row.max(1)).take(element.count);
    Ok(rows
        .map(|bytes| columns.map(|column| read(bytes, column)))
        .collect())
}
