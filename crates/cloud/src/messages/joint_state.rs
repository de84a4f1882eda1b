//! `sensor_msgs/JointState` of the tilt joint.

use units::Degrees;

use super::cdr::Cdr;
use super::{TILT_JOINT, Time, header};

/// The tilt joint at `stamp`: its position in radians, as velocity and effort are not measured.
pub fn joint_state(cdr: &mut Cdr, stamp: Time, tilt: Degrees) {
    cdr.clear();
    header(cdr, stamp, "");
    cdr.length(1);
    cdr.string(TILT_JOINT);
    cdr.f64s(&[tilt.to_radians().0]);
    cdr.f64s(&[]);
    cdr.f64s(&[]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::cdr_reader::Reader;

    #[test]
    fn the_joint_is_in_radians() {
        let mut cdr = Cdr::new();
        let stamp = Time { sec: 5, nanosec: 6 };
        joint_state(&mut cdr, stamp, Degrees(-45.0));
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!(reader.header(), (5, 6, String::new()));
        assert_eq!((reader.u32(), reader.string()), (1, "tilt".to_owned()));
        assert_eq!(
            (reader.u32(), reader.f64()),
            (1, -std::f64::consts::FRAC_PI_4)
        );
        assert_eq!((reader.u32(), reader.u32()), (0, 0));
        assert!(reader.is_done());
    }
}
