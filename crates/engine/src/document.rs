//! The JSON objects that commands print, and their schemas (docs/src/schema).

use analysis::tradeoff::TradeoffReport;
use scanner::trajectory::Method;
use serde::Serialize;
use serde_json::{Map, Value, json};
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, SchemaType, Type};
use utoipa::openapi::{RefOr, Schema};

use crate::accuracy::AccuracyReport;
use crate::calibrate::CalibrateReport;
use crate::capture::scan_planner::PlanReport;
use crate::failure::Failure;
use crate::reconstruct::lidar_copy::LidarCopyReport;
use crate::reconstruct::report::{InfoReport, ScanReport};
#[cfg(devices)]
use crate::service::axis_report::{AxisReport, StoppedCommand};
use crate::simulate::SimulationReport;

/// An object that a command prints with `--json`.
pub trait Document: Serialize + ToSchema {
    /// Name and version of the schema: the value of the key `schema`. A key that goes or changes
    /// its meaning makes a new version; new keys do not.
    const SCHEMA: &'static str;

    /// The object, with its schema's name.
    #[must_use]
    fn to_json(&self) -> Value {
        match serde_json::to_value(self) {
            Ok(Value::Object(mut object)) => {
                object.insert("schema".to_owned(), Self::SCHEMA.into());
                Value::Object(object)
            }
            // Documents are structs of numbers and strings, which cannot fail.
            Ok(other) => other,
            Err(error) => json!({ "schema": Self::SCHEMA, "error": error.to_string() }),
        }
    }
}

impl Document for ScanReport {
    const SCHEMA: &'static str = "scan-1";
}

impl Document for InfoReport {
    const SCHEMA: &'static str = "info-1";
}

impl Document for AccuracyReport {
    const SCHEMA: &'static str = "accuracy-1";
}

impl Document for LidarCopyReport {
    const SCHEMA: &'static str = "pcap-1";
}

#[cfg(devices)]
impl Document for AxisReport {
    const SCHEMA: &'static str = "axis-1";
}

#[cfg(devices)]
impl Document for StoppedCommand {
    const SCHEMA: &'static str = "stopped-1";
}

impl Document for PlanReport {
    const SCHEMA: &'static str = "plan-1";
}

impl Document for CalibrateReport {
    const SCHEMA: &'static str = "calibrate-1";
}

impl Document for SimulationReport {
    const SCHEMA: &'static str = "simulate-1";
}

impl Document for TradeoffReport {
    const SCHEMA: &'static str = "tradeoff-1";
}

/// The object of a command or request that failed without a result.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(example = json!({"error": {
    "kind": "not-found", "exit_code": 4, "message": "there is no scan hall-2",
    "help": "GET /api/v1/scans lists all",
}}))]
pub struct ErrorReport {
    /// The failure.
    pub error: Failure,
}

impl Document for ErrorReport {
    const SCHEMA: &'static str = "error-1";
}

const LINKS: [&str; 3] = ["usb", "rs232", "can"];

/// Schema of a text that is one of these names, or null where it is unknown.
fn names(description: &str, names: &[&str], may_be_unknown: bool) -> Schema {
    let known = names.iter().map(|&name| Value::from(name));
    let unknown = may_be_unknown.then_some(Value::Null);
    let mut types = vec![Type::String];
    types.extend(may_be_unknown.then_some(Type::Null));
    ObjectBuilder::new()
        .description(Some(description))
        .schema_type(SchemaType::from_iter(types))
        .enum_values(Some(known.chain(unknown)))
        .build()
        .into()
}

pub(crate) fn return_modes() -> Schema {
    names("Return mode.", &["strongest", "last", "dual"], true)
}

#[cfg(devices)]
pub(crate) fn links() -> Schema {
    names("Link of the drive.", &LINKS, true)
}

pub(crate) fn transports() -> Schema {
    names("Link of the drive.", &LINKS, false)
}

pub(crate) fn pps_states() -> Schema {
    let states = ["absent", "synchronising", "locked", "error"];
    names("State of the pulse per second.", &states, false)
}

pub(crate) fn angle_methods() -> Schema {
    let with_samples = Method::ALL.iter().map(|method| method.name());
    let all: Vec<_> = [Method::None.name()]
        .into_iter()
        .chain(with_samples)
        .collect();
    names("Method of the trajectory.", &all, false)
}

/// The schema of a document, in JSON Schema 2020-12. A command that fails with a result adds
/// `error` to it. Objects may have keys that the schema does not list.
#[must_use]
pub fn schema<T: Document>() -> Value {
    let mut parts: Vec<(String, RefOr<Schema>)> = Vec::new();
    T::schemas(&mut parts);
    parts.push((T::name().into_owned(), T::schema()));
    parts.push((
        Failure::name().into_owned(),
        <Failure as utoipa::PartialSchema>::schema(),
    ));
    <Failure as ToSchema>::schemas(&mut parts);
    let definitions: Map<String, Value> = parts
        .into_iter()
        .filter_map(|(name, part)| Some((name, serde_json::to_value(part).ok()?)))
        .collect();
    let mut schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": T::SCHEMA,
        "type": "object",
        "allOf": [{ "$ref": format!("#/components/schemas/{}", T::name()) }],
        "properties": {
            "schema": { "const": T::SCHEMA },
            "error": { "$ref": "#/components/schemas/Failure" },
        },
        "required": ["schema"],
        "$defs": definitions,
    });
    refer_to_definitions(&mut schema);
    open(&mut schema);
    schema
}

/// Lets the objects of a schema have new keys. Some are also read from files, where an unknown key
/// is an error.
pub fn open(schema: &mut Value) {
    match schema {
        Value::Object(object) => {
            if object.get("additionalProperties") == Some(&Value::Bool(false)) {
                object.remove("additionalProperties");
            }
            object.values_mut().for_each(open);
        }
        Value::Array(array) => array.iter_mut().for_each(open),
        _ => {}
    }
}

/// Rewrites the references of OpenAPI.
fn refer_to_definitions(value: &mut Value) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                match value {
                    Value::String(text) if key == "$ref" => {
                        *text = text.replace("#/components/schemas/", "#/$defs/");
                    }
                    value => refer_to_definitions(value),
                }
            }
        }
        Value::Array(array) => array.iter_mut().for_each(refer_to_definitions),
        _ => {}
    }
}
