//! The CAN bus of a unit, as its serial interfaces need it for their gateway.

use protocol::canopen::CanFrame;

use super::can::CanServer;
use super::node::Node;

/// The other nodes on a unit's CAN bus. `()` is a bus without any, a pair is the nodes of both.
pub trait CanBus {
    /// Sends a frame on the bus; the frames it triggers go to `answers`.
    fn send(&mut self, frame: &CanFrame, answers: &mut dyn FnMut(&CanFrame));
}

/// A second unit on the bus.
#[derive(Debug)]
pub struct Neighbour<'a> {
    /// The unit.
    pub node: &'a mut Node,
    /// Its CAN interface.
    pub server: &'a mut CanServer,
}

impl CanBus for () {
    fn send(&mut self, _: &CanFrame, _: &mut dyn FnMut(&CanFrame)) {}
}

impl CanBus for Neighbour<'_> {
    fn send(&mut self, frame: &CanFrame, answers: &mut dyn FnMut(&CanFrame)) {
        self.server
            .input(self.node, frame, &mut |answer| answers(answer));
    }
}

impl<A: CanBus, B: CanBus> CanBus for (A, B) {
    fn send(&mut self, frame: &CanFrame, answers: &mut dyn FnMut(&CanFrame)) {
        self.0.send(frame, answers);
        self.1.send(frame, answers);
    }
}
