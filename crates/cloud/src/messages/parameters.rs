//! The six services that read and change the parameters of a node (`rcl_interfaces`, Jazzy).

use super::MessageType;
use super::cdr::{Cdr, CdrError, CdrReader};

/// A service of a node about its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterService {
    /// Describes parameters.
    Describe,
    /// Reads values.
    Get,
    /// Reads the types of values.
    GetTypes,
    /// Lists the names.
    List,
    /// Changes values, each if it is accepted.
    Set,
    /// Changes all values or none.
    SetAtomically,
}

impl ParameterService {
    /// Every service.
    pub const ALL: [Self; 6] = [
        Self::Describe,
        Self::Get,
        Self::GetTypes,
        Self::List,
        Self::Set,
        Self::SetAtomically,
    ];

    /// Name below that of the node.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Describe => "describe_parameters",
            Self::Get => "get_parameters",
            Self::GetTypes => "get_parameter_types",
            Self::List => "list_parameters",
            Self::Set => "set_parameters",
            Self::SetAtomically => "set_parameters_atomically",
        }
    }

    /// Type. The hash is over request, response and event.
    #[must_use]
    pub const fn message_type(self) -> MessageType {
        let (name, definition, hash) = match self {
            Self::Describe => (
                "rcl_interfaces/srv/DescribeParameters",
                "string[] names\n---\nrcl_interfaces/ParameterDescriptor[] descriptors\n",
                "RIHS01_845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff",
            ),
            Self::Get => (
                "rcl_interfaces/srv/GetParameters",
                "string[] names\n---\nrcl_interfaces/ParameterValue[] values\n",
                "RIHS01_bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc",
            ),
            Self::GetTypes => (
                "rcl_interfaces/srv/GetParameterTypes",
                "string[] names\n---\nuint8[] types\n",
                "RIHS01_da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca",
            ),
            Self::List => (
                "rcl_interfaces/srv/ListParameters",
                "string[] prefixes\nuint64 depth\n---\nrcl_interfaces/ListParametersResult result\n",
                "RIHS01_3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d",
            ),
            Self::Set => (
                "rcl_interfaces/srv/SetParameters",
                "rcl_interfaces/Parameter[] parameters\n---\nrcl_interfaces/SetParametersResult[] results\n",
                "RIHS01_56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0",
            ),
            Self::SetAtomically => (
                "rcl_interfaces/srv/SetParametersAtomically",
                "rcl_interfaces/Parameter[] parameters\n---\nrcl_interfaces/SetParametersResult result\n",
                "RIHS01_0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd",
            ),
        };
        MessageType {
            name,
            definition,
            hash,
        }
    }
}

/// Value of a parameter (`rcl_interfaces/ParameterValue`).
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// No value.
    NotSet,
    /// A truth value.
    Bool(bool),
    /// A 64-bit integer.
    Integer(i64),
    /// A 64-bit floating-point number.
    Double(f64),
    /// A text.
    String(String),
    /// A list, whose content is not kept; its code in `rcl_interfaces/ParameterType`.
    List(u8),
}

impl ParameterValue {
    /// Code of the type (`rcl_interfaces/ParameterType`).
    #[must_use]
    pub const fn type_code(&self) -> u8 {
        match self {
            Self::NotSet => 0,
            Self::Bool(_) => 1,
            Self::Integer(_) => 2,
            Self::Double(_) => 3,
            Self::String(_) => 4,
            Self::List(code) => *code,
        }
    }

    /// Name of the type, as ROS 2's tools print it.
    #[must_use]
    pub const fn type_name(&self) -> &'static str {
        match self {
            Self::NotSet => "not set",
            Self::Bool(_) => "boolean",
            Self::Integer(_) => "integer",
            Self::Double(_) => "double",
            Self::String(_) => "string",
            Self::List(_) => "list",
        }
    }

    fn read(cdr: &mut CdrReader<'_>) -> Result<Self, CdrError> {
        let code = cdr.u8()?;
        let is_true = cdr.u8()? != 0;
        let (integer, double, text) = (cdr.i64()?, cdr.f64()?, cdr.string()?);
        // Lists of bytes, truth values, integers, doubles and texts.
        cdr.sequence()?;
        cdr.sequence()?;
        cdr.list(CdrReader::i64)?;
        cdr.list(CdrReader::f64)?;
        cdr.list(CdrReader::sequence)?;
        Ok(match code {
            0 => Self::NotSet,
            1 => Self::Bool(is_true),
            2 => Self::Integer(integer),
            3 => Self::Double(double),
            4 => Self::String(text),
            code => Self::List(code),
        })
    }

    fn write(&self, cdr: &mut Cdr) {
        let (mut is_true, mut integer, mut double, mut text) = (false, 0, 0.0, "");
        match self {
            Self::Bool(value) => is_true = *value,
            Self::Integer(value) => integer = *value,
            Self::Double(value) => double = *value,
            Self::String(value) => text = value,
            Self::NotSet | Self::List(_) => {}
        }
        cdr.u8(self.type_code());
        cdr.u8(is_true.into());
        cdr.i64(integer);
        cdr.f64(double);
        cdr.string(text);
        (0..5).for_each(|_| cdr.length(0));
    }
}

/// Description of a parameter (`rcl_interfaces/ParameterDescriptor`), whose type never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterDescriptor<'a> {
    /// Name.
    pub name: &'a str,
    /// Meaning and unit.
    pub description: &'a str,
    /// Whether it cannot be set.
    pub is_read_only: bool,
    /// Value.
    pub value: ParameterValue,
}

/// A changed value, or why it was refused (`rcl_interfaces/SetParametersResult`).
pub type SetResult = Result<(), String>;

/// Reads the names in the request of [`ParameterService::Describe`], [`ParameterService::Get`] or
/// [`ParameterService::GetTypes`].
///
/// # Errors
/// [`CdrError`].
pub fn read_names(cdr: &mut CdrReader<'_>) -> Result<Vec<String>, CdrError> {
    cdr.list(CdrReader::string)
}

/// Reads the request of [`ParameterService::List`]: prefixes, and the depth below them, 0 for any.
///
/// # Errors
/// [`CdrError`].
pub fn read_prefixes(cdr: &mut CdrReader<'_>) -> Result<(Vec<String>, u64), CdrError> {
    Ok((cdr.list(CdrReader::string)?, cdr.u64()?))
}

/// Reads the names and values in the request of [`ParameterService::Set`] or
/// [`ParameterService::SetAtomically`].
///
/// # Errors
/// [`CdrError`].
pub fn read_values(cdr: &mut CdrReader<'_>) -> Result<Vec<(String, ParameterValue)>, CdrError> {
    cdr.list(|cdr| Ok((cdr.string()?, ParameterValue::read(cdr)?)))
}

/// A response that is a sequence.
fn sequence<T>(elements: &[T], write: impl Fn(&mut Cdr, &T)) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.length(elements.len());
    elements.iter().for_each(|element| write(&mut cdr, element));
    cdr
}

/// Response of [`ParameterService::Describe`].
#[must_use]
pub fn describe_response(descriptors: &[ParameterDescriptor<'_>]) -> Cdr {
    sequence(descriptors, |cdr, descriptor| {
        cdr.string(descriptor.name);
        cdr.u8(descriptor.value.type_code());
        cdr.string(descriptor.description);
        // No additional constraints, no dynamic typing, no ranges.
        cdr.string("");
        cdr.u8(descriptor.is_read_only.into());
        cdr.u8(0);
        cdr.length(0);
        cdr.length(0);
    })
}

/// Response of [`ParameterService::Get`].
#[must_use]
pub fn get_response(values: &[ParameterValue]) -> Cdr {
    sequence(values, |cdr, value| value.write(cdr))
}

/// Response of [`ParameterService::GetTypes`].
#[must_use]
pub fn types_response(values: &[ParameterValue]) -> Cdr {
    sequence(values, |cdr, value| cdr.u8(value.type_code()))
}

/// Response of [`ParameterService::List`]: names, and the prefixes of names.
#[must_use]
pub fn list_response(names: &[&str], prefixes: &[&str]) -> Cdr {
    let mut cdr = Cdr::new();
    for texts in [names, prefixes] {
        cdr.length(texts.len());
        texts.iter().for_each(|text| cdr.string(text));
    }
    cdr
}

fn write_result(cdr: &mut Cdr, result: &SetResult) {
    cdr.u8(result.is_ok().into());
    cdr.string(result.as_ref().err().map_or("", String::as_str));
}

/// Response of [`ParameterService::Set`].
#[must_use]
pub fn set_response(results: &[SetResult]) -> Cdr {
    sequence(results, write_result)
}

/// Response of [`ParameterService::SetAtomically`].
#[must_use]
pub fn set_atomically_response(result: &SetResult) -> Cdr {
    let mut cdr = Cdr::new();
    write_result(&mut cdr, result);
    cdr
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [fn() -> ParameterValue; 6] = [
        || ParameterValue::NotSet,
        || ParameterValue::Bool(true),
        || ParameterValue::Integer(-3),
        || ParameterValue::Double(56.25),
        || ParameterValue::String("2mm@20m".to_owned()),
        || ParameterValue::List(8),
    ];

    #[test]
    fn values_of_every_type_are_read_as_written() {
        let mut cdr = Cdr::new();
        cdr.length(VALUES.len());
        for (value, name) in VALUES.iter().zip(["", "a", "ab", "abc", "abcd", "abcde"]) {
            cdr.string(name);
            value().write(&mut cdr);
        }
        let read = read_values(&mut CdrReader::new(cdr.bytes()).unwrap()).unwrap();
        let names: Vec<_> = read.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["", "a", "ab", "abc", "abcd", "abcde"]);
        for ((_, read), value) in read.iter().zip(VALUES) {
            assert_eq!(*read, value());
        }
        for end in 4..cdr.bytes().len() {
            let mut reader = CdrReader::new(&cdr.bytes()[..end]).unwrap();
            assert!(read_values(&mut reader).is_err(), "{end}");
        }
    }

    /// The content of lists is skipped, with its alignment.
    #[test]
    fn lists_are_read_as_values_without_content() {
        let mut cdr = Cdr::new();
        cdr.length(2);
        for _ in 0..2 {
            cdr.string("list");
            cdr.u8(9);
            cdr.u8(0);
            cdr.i64(0);
            cdr.f64(0.0);
            cdr.string("");
            cdr.length(3);
            cdr.array(&[1, 2, 3]);
            cdr.length(1);
            cdr.u8(1);
            cdr.length(1);
            cdr.i64(5);
            cdr.f64s(&[1.5, 2.5]);
            cdr.length(2);
            cdr.string("a");
            cdr.string("b");
        }
        let mut reader = CdrReader::new(cdr.bytes()).unwrap();
        let list = ("list".to_owned(), ParameterValue::List(9));
        assert_eq!(read_values(&mut reader), Ok(vec![list.clone(), list]));
        assert_eq!(reader.offset(), cdr.bytes().len());
    }

    #[test]
    fn forged_lengths_are_errors() {
        let mut cdr = Cdr::new();
        cdr.length(usize::MAX);
        cdr.string("name");
        let reader = || CdrReader::new(cdr.bytes()).unwrap();
        assert!(read_names(&mut reader()).is_err());
        assert!(read_prefixes(&mut reader()).is_err());
        assert!(read_values(&mut reader()).is_err());
    }

    #[test]
    fn responses_have_the_fields_of_their_definitions() {
        let descriptor = ParameterDescriptor {
            name: "axis.min_deg",
            description: "smallest angle",
            is_read_only: true,
            value: ParameterValue::Double(-45.0),
        };
        let cdr = describe_response(&[descriptor]);
        let mut reader = CdrReader::new(cdr.bytes()).unwrap();
        assert_eq!(reader.u32(), Ok(1));
        assert_eq!(reader.string().as_deref(), Ok("axis.min_deg"));
        assert_eq!(reader.u8(), Ok(3));
        assert_eq!(reader.string().as_deref(), Ok("smallest angle"));
        assert_eq!(reader.string().as_deref(), Ok(""));
        assert_eq!((reader.u8(), reader.u8()), (Ok(1), Ok(0)));
        assert_eq!((reader.u32(), reader.u32()), (Ok(0), Ok(0)));
        assert_eq!(reader.offset(), cdr.bytes().len());

        let values = VALUES.map(|value| value());
        let cdr = get_response(&values);
        let mut reader = CdrReader::new(cdr.bytes()).unwrap();
        assert_eq!(
            reader.list(ParameterValue::read).as_deref(),
            Ok(&values[..])
        );
        let cdr = types_response(&values);
        assert_eq!(cdr.bytes()[4..], [6, 0, 0, 0, 0, 1, 2, 3, 4, 8]);

        let cdr = list_response(&["a.b"], &["a"]);
        let mut reader = CdrReader::new(cdr.bytes()).unwrap();
        let names = [
            reader.list(CdrReader::string),
            reader.list(CdrReader::string),
        ];
        assert_eq!(names, [Ok(vec!["a.b".into()]), Ok(vec!["a".into()])]);

        let refused = Err("no".to_owned());
        let cdr = set_response(&[Ok(()), refused.clone()]);
        let mut reader = CdrReader::new(cdr.bytes()).unwrap();
        assert_eq!(reader.u32(), Ok(2));
        for (code, reason) in [(1, ""), (0, "no")] {
            assert_eq!(reader.u8(), Ok(code));
            assert_eq!(reader.string().as_deref(), Ok(reason));
        }
        let cdr = set_atomically_response(&refused);
        assert_eq!(cdr.bytes()[4..], [0, 0, 0, 0, 3, 0, 0, 0, b'n', b'o', 0]);
    }
}
