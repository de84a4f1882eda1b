//! The node's parameters, with the answers of `rclcpp`'s `ParameterService` and `NodeParameters`.
//!
//! Parameters of the capture that `start_capture` begins can be set if `actions = true`, within the
//! limits of the axis, and keep their values until the daemon ends. The others are read-only.
//! Setting a parameter moves nothing.

use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};

use cloud::messages::cdr::Cdr;
use cloud::messages::parameters::{
    ParameterDescriptor, ParameterService, ParameterValue,
    ParameterValue::{Bool, Double, Integer, String as Text},
    SetResult, describe_response, get_response, list_response, read_names, read_prefixes,
    read_values, set_atomically_response, set_response, types_response,
};
use engine::capture_request::{CaptureRequest, MAX_SWEEPS};
use engine::config::ros2::Ros2;
use engine::config::{Config, Device};
use engine::failure::{Failure, Kind};
use engine::service::DeviceService;

use crate::bridge::STOP_POLL;
use crate::calls::text_of;
use crate::goal_request::read;
use crate::link::{Call, Declarer, Error};
use crate::rmw::{NODE, QualityOfService};
use crate::{Context, check_capture};

/// Calls that wait for their answers. Further ones are refused.
const WAITING: usize = 16;
/// Separator of the parts of a name.
const SEPARATOR: char = '.';
/// QoS of the services (`rmw_qos_profile_parameters`).
const QUALITY: QualityOfService = QualityOfService {
    reliable: true,
    latched: false,
    depth: 1000,
};

/// A call about parameters.
pub type ParameterCall = (ParameterService, Call);

/// The sending end of the queue of calls.
pub type Inbox = SyncSender<ParameterCall>;

/// A queue of calls.
pub fn queue() -> (Inbox, Receiver<ParameterCall>) {
    sync_channel(WAITING)
}

/// Offers the services.
pub fn declare(declarer: &mut Declarer<'_>, inbox: &Inbox) -> Result<(), Error> {
    for service in ParameterService::ALL {
        let name = format!("/{NODE}/{}", service.name());
        let name = declarer.settings().resolve(&name);
        let inbox = inbox.clone();
        declarer.service(&name, &service.message_type(), QUALITY, move |call| {
            let sent = inbox.try_send((service, call));
            if let Err(TrySendError::Full((_, call)) | TrySendError::Disconnected((_, call))) = sent
            {
                call.refuse("too many calls about parameters at once: try again");
            }
        })?;
    }
    Ok(())
}

/// Answers calls until the bridge ends.
pub(crate) fn run(context: &Context, calls: &Receiver<ParameterCall>) {
    while !context.stop.is_set() {
        let Ok((service, call)) = calls.recv_timeout(STOP_POLL) else {
            continue;
        };
        match context.parameters.serve(service, &call.payload()) {
            Ok(response) => call.answer(response.bytes()),
            Err(failure) => call.refuse(&text_of(failure)),
        }
        context.counts.calls.fetch_add(1, Ordering::Relaxed);
    }
}

/// Sets an option of the capture. An empty text is none.
#[derive(Clone, Copy)]
enum Setter {
    Bool(fn(&mut CaptureRequest, bool)),
    Count(fn(&mut CaptureRequest, u32)),
    Number(fn(&mut CaptureRequest, f64)),
    Text(fn(&mut CaptureRequest, Option<String>)),
}

impl Setter {
    /// Sets the option, which has the value `current`.
    fn set(
        self,
        capture: &mut CaptureRequest,
        current: &ParameterValue,
        value: ParameterValue,
    ) -> Result<(), Failure> {
        let usage = |text| Err(Failure::new(Kind::Usage, text));
        match (self, value) {
            (Self::Bool(set), ParameterValue::Bool(value)) => set(capture, value),
            (Self::Count(set), ParameterValue::Integer(value)) => match u32::try_from(value) {
                Ok(value) => set(capture, value),
                Err(_) => return usage(format!("expected 1 to {MAX_SWEEPS}, got {value}")),
            },
            (Self::Number(set), ParameterValue::Double(value)) => match value.is_finite() {
                true => set(capture, value),
                false => return usage(format!("expected a finite number, got {value}")),
            },
            (Self::Text(set), ParameterValue::String(value)) => {
                set(capture, Some(value).filter(|value| !value.is_empty()));
            }
            (_, value) => {
                let (expected, got) = (current.type_name(), value.type_name());
                return usage(format!("expected a value of type {expected}, got {got}"));
            }
        }
        Ok(())
    }
}

/// A parameter; read-only without a setter.
struct NodeParameter {
    name: &'static str,
    description: &'static str,
    get: fn(&NodeParameters, &CaptureRequest) -> ParameterValue,
    set: Option<Setter>,
}

/// Every parameter, in the order of the names.
static PARAMETERS: [NodeParameter; 13] = [
    NodeParameter {
        name: "axis.max_accel_deg_s2",
        description: "Largest acceleration of the axis, deg/s2",
        get: |node, _| Double(node.config.axis.max_accel_deg_s2),
        set: None,
    },
    NodeParameter {
        name: "axis.max_deg",
        description: "Largest angle of the axis, deg",
        get: |node, _| Double(node.config.axis.max_deg),
        set: None,
    },
    NodeParameter {
        name: "axis.max_speed_deg_s",
        description: "Largest speed of the axis, deg/s",
        get: |node, _| Double(node.config.axis.max_speed_deg_s),
        set: None,
    },
    NodeParameter {
        name: "axis.min_deg",
        description: "Smallest angle of the axis, deg",
        get: |node, _| Double(node.config.axis.min_deg),
        set: None,
    },
    NodeParameter {
        name: "capture.accel_deg_s2",
        description: "Acceleration, deg/s2",
        get: |node, capture| Double(capture.accel_deg_s2.unwrap_or(node.device.1.accel_deg_s2)),
        set: Some(Setter::Number(|capture, value| {
            capture.accel_deg_s2 = Some(value)
        })),
    },
    NodeParameter {
        name: "capture.both_ways",
        description: "Whether the return move is a sweep too",
        get: |_, capture| Bool(capture.both_ways),
        set: Some(Setter::Bool(|capture, value| capture.both_ways = value)),
    },
    NodeParameter {
        name: "capture.from_deg",
        description: "Angle where the sweep starts, deg",
        get: |node, capture| Double(capture.from_deg.unwrap_or(node.config.axis.max_deg)),
        set: Some(Setter::Number(|capture, value| {
            capture.from_deg = Some(value)
        })),
    },
    NodeParameter {
        name: "capture.name",
        description: "Name of the scan; empty for one after its time",
        get: |_, capture| Text(capture.name.clone().unwrap_or_default()),
        set: Some(Setter::Text(|capture, value| capture.name = value)),
    },
    NodeParameter {
        name: "capture.speed_deg_s",
        description: "Cruise speed of the axis, deg/s",
        get: |_, capture| Double(capture.speed_deg_s),
        set: Some(Setter::Number(|capture, value| capture.speed_deg_s = value)),
    },
    NodeParameter {
        name: "capture.sweeps",
        description: "Number of sweeps",
        get: |_, capture| Integer(capture.sweep_count().into()),
        set: Some(Setter::Count(|capture, value| capture.sweeps = Some(value))),
    },
    NodeParameter {
        name: "capture.to_deg",
        description: "Angle where the sweep ends, deg",
        get: |node, capture| Double(capture.to_deg.unwrap_or(node.config.axis.min_deg)),
        set: Some(Setter::Number(|capture, value| {
            capture.to_deg = Some(value)
        })),
    },
    NodeParameter {
        name: "capture.tolerance",
        description: "Tolerated point error at a distance, such as 2mm@20m; empty for the best",
        get: |_, capture| Text(capture.tolerance.clone().unwrap_or_default()),
        set: Some(Setter::Text(|capture, value| capture.tolerance = value)),
    },
    NodeParameter {
        name: "frame_prefix",
        description: "Prefix of the scanner's coordinate frames",
        get: |node, _| Text(node.frame_prefix.clone()),
        set: None,
    },
];

/// The parameters of a node, and the values of those that can be set.
pub(crate) struct NodeParameters {
    config: Config,
    device: (String, Device),
    frame_prefix: String,
    /// Whether nodes may set the capture's parameters (`actions = true`).
    can_set: bool,
    /// The capture that `start_capture` begins.
    capture: Option<Mutex<CaptureRequest>>,
}

impl NodeParameters {
    pub(crate) fn new(settings: &Ros2, devices: &DeviceService) -> Self {
        let (name, device) = devices.device();
        Self {
            config: devices.config().clone(),
            device: (name.to_owned(), device.clone()),
            frame_prefix: settings.frame_prefix.clone(),
            can_set: settings.actions,
            capture: settings.capture.clone().map(Mutex::new),
        }
    }

    fn locked(&self) -> Option<MutexGuard<'_, CaptureRequest>> {
        let capture = self.capture.as_ref()?;
        Some(capture.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The capture that `start_capture` begins, if one is configured.
    pub(crate) fn capture(&self) -> Option<CaptureRequest> {
        self.locked().map(|capture| capture.clone())
    }

    /// The parameters of this configuration.
    fn offered(&self) -> impl Iterator<Item = &'static NodeParameter> {
        let has_capture = self.capture.is_some();
        PARAMETERS
            .iter()
            .filter(move |parameter| has_capture || parameter.set.is_none())
    }

    /// Answers a call.
    ///
    /// # Errors
    /// [`Kind::Usage`] where the request cannot be read.
    fn serve(&self, service: ParameterService, request: &[u8]) -> Result<Cdr, Failure> {
        let described = || Ok::<_, Failure>(self.describe(&read(request, read_names)?));
        let values = |described: Vec<ParameterDescriptor<'_>>| -> Vec<ParameterValue> {
            described.into_iter().map(|one| one.value).collect()
        };
        Ok(match service {
            ParameterService::Describe => describe_response(&described()?),
            ParameterService::Get => get_response(&values(described()?)),
            ParameterService::GetTypes => types_response(&values(described()?)),
            ParameterService::List => {
                let (prefixes, depth) = read(request, read_prefixes)?;
                self.list(&prefixes, depth)
            }
            ParameterService::Set => {
                let values = read(request, read_values)?.into_iter();
                let results: Vec<_> = values.map(|value| self.set(vec![value])).collect();
                set_response(&results)
            }
            ParameterService::SetAtomically => {
                set_atomically_response(&self.set(read(request, read_values)?))
            }
        })
    }

    /// Descriptions of the named parameters; none if one of them does not exist.
    fn describe(&self, names: &[String]) -> Vec<ParameterDescriptor<'static>> {
        let capture = self.capture().unwrap_or_default();
        let described = names.iter().map(|name| {
            let parameter = self.offered().find(|parameter| parameter.name == name)?;
            Some(ParameterDescriptor {
                name: parameter.name,
                description: parameter.description,
                is_read_only: parameter.set.is_none() || !self.can_set,
                value: (parameter.get)(self, &capture),
            })
        });
        described.collect::<Option<_>>().unwrap_or_default()
    }

    fn list(&self, prefixes: &[String], depth: u64) -> Cdr {
        let is_near = |rest: &str| depth == 0 || (rest.matches(SEPARATOR).count() as u64) < depth;
        let is_below = |name: &str, prefix: &String| match name.strip_prefix(prefix.as_str()) {
            Some(rest) => rest.is_empty() || rest.strip_prefix(SEPARATOR).is_some_and(is_near),
            None => false,
        };
        let names = self.offered().map(|parameter| parameter.name);
        let names = names.filter(|name| match prefixes {
            [] => is_near(name),
            _ => prefixes.iter().any(|prefix| is_below(name, prefix)),
        });
        let names: Vec<_> = names.collect();
        let parts = names.iter().filter_map(|name| name.rsplit_once(SEPARATOR));
        let mut name_prefixes: Vec<_> = parts.map(|(prefix, _)| prefix).collect();
        name_prefixes.dedup();
        list_response(&names, &name_prefixes)
    }

    /// Sets all values or none.
    fn set(&self, values: Vec<(String, ParameterValue)>) -> SetResult {
        let mut changed = self.capture();
        for (name, value) in values {
            let refused = |text| Err(format!("parameter {name:?} {text}"));
            let Some(parameter) = self.offered().find(|parameter| parameter.name == name) else {
                return refused("does not exist");
            };
            let (Some(setter), Some(changed)) = (parameter.set, &mut changed) else {
                return refused("is read-only: velomotion.toml configures it");
            };
            if !self.can_set {
                return refused("is read-only without actions = true in [daemon.ros2]");
            }
            let current = (parameter.get)(self, changed);
            let set = setter.set(changed, &current, value);
            set.map_err(|failure| format!("parameter {name:?}: {}", text_of(failure)))?;
        }
        if let Some(changed) = changed {
            let (name, device) = &self.device;
            check_capture(&changed, &self.config, (name, device)).map_err(text_of)?;
            tracing::info!("ROS 2: parameters of start_capture: {changed:?}");
            // One thread sets parameters, so nothing has changed since they were read.
            if let Some(mut capture) = self.locked() {
                *capture = changed;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goal_request::LONGEST;

    fn node(capture: Option<CaptureRequest>) -> NodeParameters {
        NodeParameters {
            config: Config::default(),
            device: ("sim".to_owned(), Device::simulator()),
            frame_prefix: "left/".to_owned(),
            can_set: true,
            capture: capture.map(Mutex::new),
        }
    }

    fn configured() -> NodeParameters {
        node(Some(CaptureRequest {
            speed_deg_s: 20.0,
            ..CaptureRequest::default()
        }))
    }

    fn get(node: &NodeParameters, name: &str) -> Option<ParameterValue> {
        let described = node.describe(&[name.to_owned()]);
        described.into_iter().next().map(|one| one.value)
    }

    fn set(node: &NodeParameters, values: &[(&str, ParameterValue)]) -> SetResult {
        let values = values.iter();
        node.set(
            values
                .map(|(name, value)| ((*name).to_owned(), value.clone()))
                .collect(),
        )
    }

    #[test]
    fn parameters_are_named_once_and_keep_their_own_values() {
        assert!(PARAMETERS.is_sorted_by(|a, b| a.name < b.name));
        let node = configured();
        for parameter in &PARAMETERS {
            let value = get(&node, parameter.name).unwrap();
            let result = set(&node, &[(parameter.name, value.clone())]);
            assert_eq!(result.is_ok(), parameter.set.is_some(), "{result:?}");
            assert_eq!(get(&node, parameter.name), Some(value));
        }
    }

    #[test]
    fn set_values_are_those_of_the_next_capture() {
        let node = configured();
        for (name, value) in [
            ("capture.accel_deg_s2", Double(100.0)),
            ("capture.both_ways", Bool(true)),
            ("capture.from_deg", Double(-10.0)),
            ("capture.name", Text("hall".to_owned())),
            ("capture.speed_deg_s", Double(30.0)),
            ("capture.sweeps", Integer(4)),
            ("capture.to_deg", Double(-40.0)),
            ("capture.tolerance", Text("2mm@20m".to_owned())),
        ] {
            assert_ne!(get(&node, name).as_ref(), Some(&value));
            assert_eq!(set(&node, &[(name, value.clone())]), Ok(()));
            assert_eq!(get(&node, name), Some(value));
        }
        let expected = CaptureRequest {
            speed_deg_s: 30.0,
            from_deg: Some(-10.0),
            to_deg: Some(-40.0),
            accel_deg_s2: Some(100.0),
            sweeps: Some(4),
            both_ways: true,
            tolerance: Some("2mm@20m".to_owned()),
            name: Some("hall".to_owned()),
        };
        assert_eq!(node.capture(), Some(expected));
    }

    #[test]
    fn refused_values_change_nothing_and_have_a_reason() {
        let node = configured();
        let before = node.capture();
        for (name, value, reason) in [
            ("capture.speed_deg_s", Double(1e4), "98"),
            ("capture.speed_deg_s", Double(f64::NAN), "finite"),
            ("capture.to_deg", Double(f64::NEG_INFINITY), "finite"),
            ("capture.to_deg", Double(-80.0), "-45"),
            (
                "capture.speed_deg_s",
                Integer(20),
                "type double, got integer",
            ),
            ("capture.sweeps", Double(2.0), "type integer, got double"),
            ("capture.sweeps", Integer(-1), "1 to 10000, got -1"),
            ("capture.sweeps", Integer(0), "1 to 10000, got 0"),
            ("capture.sweeps", Integer(1 << 32), "1 to 10000"),
            ("capture.both_ways", ParameterValue::NotSet, "got not set"),
            ("capture.name", Text("a b".to_owned()), "letters"),
            ("capture.name", ParameterValue::List(9), "got list"),
            ("capture.tolerance", Text("2mm".to_owned()), "tolerance"),
            ("axis.max_deg", Double(10.0), "read-only"),
            ("frame_prefix", Text("a/".to_owned()), "read-only"),
            ("capture.speed", Double(10.0), "does not exist"),
        ] {
            let refused = set(&node, &[(name, value)]).unwrap_err();
            assert!(refused.contains(reason), "{name}: {refused}");
            assert_eq!(node.capture(), before);
        }
    }

    #[test]
    fn several_values_are_set_together_or_not_at_all() {
        let node = configured();
        let before = node.capture();
        let values = |speed| {
            [
                ("capture.to_deg", Double(-20.0)),
                ("capture.speed_deg_s", Double(speed)),
            ]
        };
        assert!(set(&node, &values(1e4)).is_err());
        assert_eq!(node.capture(), before);
        assert_eq!(set(&node, &values(30.0)), Ok(()));
        let capture = node.capture().unwrap();
        assert_eq!((capture.to_deg, capture.speed_deg_s), (Some(-20.0), 30.0));
    }

    /// Without actions a node has no angles and speeds of its own.
    #[test]
    fn without_actions_all_parameters_are_read_only() {
        let node = NodeParameters {
            can_set: false,
            ..configured()
        };
        let before = node.capture();
        let refused = set(&node, &[("capture.speed_deg_s", Double(30.0))]);
        assert!(refused.unwrap_err().contains("actions = true"));
        assert_eq!(node.capture(), before);
        let names = ["capture.speed_deg_s".to_owned()];
        assert!(node.describe(&names)[0].is_read_only);
    }

    /// A node without a configured capture has nothing to set.
    #[test]
    fn without_a_capture_all_parameters_are_read_only() {
        let node = node(None);
        assert_eq!(get(&node, "axis.min_deg"), Some(Double(-45.0)));
        assert_eq!(get(&node, "capture.speed_deg_s"), None);
        let refused = set(&node, &[("capture.speed_deg_s", Double(20.0))]);
        assert!(refused.unwrap_err().contains("does not exist"));
        assert_eq!(node.capture(), None);
    }

    /// As `NodeParameters::list_parameters` of `rclcpp`.
    #[test]
    fn names_are_listed_by_prefix_and_depth() {
        let node = node(None);
        let axis = PARAMETERS.iter().map(|parameter| parameter.name);
        let axis: Vec<_> = axis.filter(|name| name.starts_with("axis.")).collect();
        let all = [&axis[..], &["frame_prefix"]].concat();
        let check = |prefixes: &[&str], depth, names: &[&str], found: &[&str]| {
            let prefixes: Vec<_> = prefixes.iter().map(|&prefix| prefix.to_owned()).collect();
            let listed = node.list(&prefixes, depth);
            assert_eq!(listed, list_response(names, found), "{prefixes:?} {depth}");
        };
        check(&[], 0, &all, &["axis"]);
        check(&[], 1, &["frame_prefix"], &[]);
        check(&[], 2, &all, &["axis"]);
        check(&["axis"], 0, &axis, &["axis"]);
        check(&["axis"], 1, &axis, &["axis"]);
        check(&["ax"], 0, &[], &[]);
        let two = ["axis.min_deg", "frame_prefix"];
        check(&two, 1, &two, &["axis"]);
    }

    #[test]
    fn an_unknown_name_empties_the_answer_and_a_damaged_request_has_none() {
        let node = configured();
        let mut cdr = Cdr::new();
        cdr.length(2);
        cdr.string("axis.min_deg");
        cdr.string("axis.middle_deg");
        let answer = node.serve(ParameterService::Get, cdr.bytes()).unwrap();
        assert_eq!(answer, get_response(&[]));
        for service in ParameterService::ALL {
            for request in [&cdr.bytes()[..30], &[][..], &[0; LONGEST + 1][..]] {
                assert!(node.serve(service, request).is_err(), "{service:?}");
            }
        }
    }
}
