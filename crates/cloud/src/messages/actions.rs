//! The actions of `velomotion_msgs` (packaging/ros/velomotion_msgs), with the services and topics
//! that every action has (`rcl_action`, `action_msgs`).

use super::cdr::{Cdr, CdrError, CdrReader};
use super::{MessageType, Time};

/// Identity of a goal, chosen by its client: a UUID.
pub type GoalId = [u8; 16];

/// The types of an action's own services and topic. Services hash request, response and event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ActionType {
    /// Service that begins a goal.
    pub send_goal: MessageType,
    /// Service that answers at the end of a goal.
    pub get_result: MessageType,
    /// Messages about a goal's progress.
    pub feedback: MessageType,
}

macro_rules! action_type {
    ($name:literal, $definition:expr, $send_goal:literal, $get_result:literal, $feedback:literal) => {
        ActionType {
            send_goal: MessageType {
                name: concat!("velomotion_msgs/action/", $name, "_SendGoal"),
                definition: $definition,
                hash: $send_goal,
            },
            get_result: MessageType {
                name: concat!("velomotion_msgs/action/", $name, "_GetResult"),
                definition: $definition,
                hash: $get_result,
            },
            feedback: MessageType {
                name: concat!("velomotion_msgs/action/", $name, "_FeedbackMessage"),
                definition: $definition,
                hash: $feedback,
            },
        }
    };
}

/// `velomotion_msgs/action/Capture`.
pub const CAPTURE: ActionType = action_type!(
    "Capture",
    "float64[<=1] speed_deg_s\nfloat64[<=1] from_deg\nfloat64[<=1] to_deg\nfloat64[<=1] accel_deg_s2\n\
     uint32[<=1] sweeps\nbool[<=1] both_ways\nstring[<=1] tolerance\nstring[<=1] name\n---\n\
     string scan_id\nstring state\nuint64 points\nstring message\n---\n\
     uint32 step\nuint32 steps\nfloat64 angle_deg\nfloat64 left_s\n",
    "RIHS01_475c6507cf9cdd9f563b6332059d7a5f1f8e37d5c72cfbaa992895b99f54d996",
    "RIHS01_ef1823e83a30e59dea5ec023b80480442147a977850043a5e49a1671f3fa00af",
    "RIHS01_80951e0c6fc67ef64cdb27e956db602d08cadd6d4cee3660b1be39a4b8539d46"
);

/// `velomotion_msgs/action/MoveTilt`.
pub const MOVE_TILT: ActionType = action_type!(
    "MoveTilt",
    "bool home\nfloat64[<=1] to_deg\nfloat64[<=1] speed_deg_s\n---\n\
     float64 angle_deg\nstring message\n---\n\
     float64 angle_deg\nfloat64 left_s\n",
    "RIHS01_143caf737131a8366c841b9cdf3042c1d5834af797fa60f38ab40387a878d975",
    "RIHS01_9843ee28e218e7f1e635c00e5738d8aca058b82b3c9cf344af0f3c98f9c60955",
    "RIHS01_9b105b6bf50414b37d59ae43d19778066ee42d991282d9b2b01bec78c617b66b"
);

/// Service that cancels goals of any action.
pub const CANCEL_GOAL: MessageType = MessageType {
    name: "action_msgs/srv/CancelGoal",
    definition: "action_msgs/GoalInfo goal_info\n---\nint8 return_code\naction_msgs/GoalInfo[] goals_canceling\n",
    hash: "RIHS01_573d8b0a534451d7bc2ac8c5ffde8ac14b8593b7001175d0cd6516dcbeb8689a",
};

/// Messages with the states of all goals of an action.
pub const GOAL_STATUS_ARRAY: MessageType = MessageType {
    name: "action_msgs/msg/GoalStatusArray",
    definition: super::definitions::GOAL_STATUS_ARRAY,
    hash: "RIHS01_6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e",
};

/// State of a goal (`action_msgs/GoalStatus`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum GoalStatus {
    /// The goal is not known.
    #[default]
    Unknown = 0,
    /// Under way.
    Executing = 2,
    /// To be cancelled.
    Canceling = 3,
    /// Reached.
    Succeeded = 4,
    /// Ended on request.
    Canceled = 5,
    /// Ended for another reason.
    Aborted = 6,
}

impl GoalStatus {
    /// Whether the goal has not ended.
    #[must_use]
    pub const fn is_active(self) -> bool {
        matches!(self, Self::Executing | Self::Canceling)
    }
}

/// Answer to a cancellation (`action_msgs/srv/CancelGoal`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum CancelCode {
    /// At least one goal is cancelled.
    Accepted = 0,
    /// No goal can be cancelled.
    Rejected = 1,
    /// There is no such goal.
    UnknownGoal = 2,
    /// The goal has ended.
    Ended = 3,
}

/// A goal and the time of its acceptance (`action_msgs/GoalInfo`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GoalInfo {
    /// The goal.
    pub id: GoalId,
    /// Time of its acceptance.
    pub accepted: Time,
}

impl GoalInfo {
    /// Reads the request of [`CANCEL_GOAL`].
    ///
    /// # Errors
    /// [`CdrError`].
    pub fn read(cdr: &mut CdrReader<'_>) -> Result<Self, CdrError> {
        let id = cdr.array()?;
        let (sec, nanosec) = (cdr.i32()?, cdr.u32()?);
        let accepted = Time { sec, nanosec };
        Ok(Self { id, accepted })
    }

    fn write(&self, cdr: &mut Cdr) {
        cdr.array(&self.id);
        cdr.i32(self.accepted.sec);
        cdr.u32(self.accepted.nanosec);
    }

    /// Whether a request of [`CANCEL_GOAL`] with this content is about `goal`: the one with its
    /// id, those accepted until its time, or with neither all.
    #[must_use]
    pub fn cancels(&self, goal: &Self) -> bool {
        let of = |info: &Self| (info.accepted.sec, info.accepted.nanosec);
        let (is_id, is_time) = (self.id != [0; 16], self.accepted != Time::default());
        match (is_id, is_time) {
            (false, false) => true,
            _ => is_id && goal.id == self.id || is_time && of(goal) <= of(self),
        }
    }
}

/// Response of [`ActionType::send_goal`].
#[must_use]
pub fn goal_response(accepted: bool, at: Time) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.u8(accepted.into());
    cdr.i32(at.sec);
    cdr.u32(at.nanosec);
    cdr
}

/// Response of [`CANCEL_GOAL`].
#[must_use]
pub fn cancel_response(code: CancelCode, goals: &[GoalInfo]) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.u8(code as u8);
    cdr.length(goals.len());
    goals.iter().for_each(|goal| goal.write(&mut cdr));
    cdr
}

/// A [`GOAL_STATUS_ARRAY`].
#[must_use]
pub fn goal_status_array(goals: &[(GoalInfo, GoalStatus)]) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.length(goals.len());
    for (goal, status) in goals {
        goal.write(&mut cdr);
        cdr.u8(*status as u8);
    }
    cdr
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::cdr_reader::Reader;

    fn info(first: u8, sec: i32, nanosec: u32) -> GoalInfo {
        let mut id = [0; 16];
        id[0] = first;
        let accepted = Time { sec, nanosec };
        GoalInfo { id, accepted }
    }

    /// The policy that `action_msgs/srv/CancelGoal.srv` states.
    #[test]
    fn cancellations_are_by_id_by_time_or_of_all() {
        let goal = info(7, 100, 5);
        for (request, is_cancelled) in [
            (info(0, 0, 0), true),
            (info(7, 0, 0), true),
            (info(8, 0, 0), false),
            (info(0, 100, 4), false),
            (info(0, 100, 5), true),
            (info(0, 101, 0), true),
            (info(7, 1, 0), true),
            (info(8, 1, 0), false),
            (info(8, 200, 0), true),
        ] {
            assert_eq!(request.cancels(&goal), is_cancelled, "{request:?}");
        }
    }

    #[test]
    fn answers_and_messages_have_the_fields_of_their_definitions() {
        let goal = info(1, 2, 3);
        let cdr = goal_response(true, goal.accepted);
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!((reader.u8(), reader.u32(), reader.u32()), (1, 2, 3));
        assert!(reader.is_done());

        let cdr = cancel_response(CancelCode::Accepted, &[goal, goal]);
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!((reader.u8(), reader.u32()), (0, 2));
        for _ in 0..2 {
            assert_eq!(reader.take(16), goal.id);
            assert_eq!((reader.u32(), reader.u32()), (2, 3));
        }
        assert!(reader.is_done());

        let cdr = goal_status_array(&[(goal, GoalStatus::Canceled)]);
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!((reader.u32(), reader.take(16)), (1, &goal.id[..]));
        assert_eq!((reader.u32(), reader.u32(), reader.u8()), (2, 3, 5));
        assert!(reader.is_done());
    }
}
