//! Values that survive power-off and values that do not, and the configuration of process data.

use protocol::canopen::nmt::NmtCommand;
use protocol::canopen::nmt::NmtState;
use protocol::epos2::objects::{self, Address};

use super::super::{AbortCode, SimulatedDrive};
use super::{get, healthy, set};

fn raw(node: &SimulatedDrive, index: u16, sub: u8) -> u32 {
    node.read(Address::new(index, sub)).unwrap().raw().unwrap()
}

fn write(node: &mut SimulatedDrive, index: u16, sub: u8, raw: u32) -> Result<(), AbortCode> {
    node.write(Address::new(index, sub), raw)
}

#[test]
fn only_saved_values_survive_power_off() {
    let mut node = healthy();
    set(&mut node, objects::PROFILE_VELOCITY, 77);
    set(&mut node, objects::TARGET_POSITION, 1234);
    write(&mut node, 0x200C, 3, 0xCAFE_F00D).unwrap();
    assert_eq!(
        write(&mut node, 0x1010, 1, objects::LOAD),
        Err(AbortCode::STORE)
    );
    assert_eq!(
        write(&mut node, 0x1011, 1, objects::SAVE),
        Err(AbortCode::STORE)
    );
    set(&mut node, objects::STORE_ALL, objects::SAVE);
    assert_eq!(raw(&node, 0x1010, 1), 1, "saves on command");
    set(&mut node, objects::PROFILE_ACCELERATION, 88);
    node.power_cycle();
    assert_eq!(get(&node, objects::PROFILE_VELOCITY), 77);
    assert_eq!(raw(&node, 0x200C, 3), 0xCAFE_F00D);
    assert_eq!(
        get(&node, objects::PROFILE_ACCELERATION),
        10_000,
        "not saved"
    );
    assert_eq!(
        get(&node, objects::TARGET_POSITION),
        0,
        "not a stored parameter"
    );
}

#[test]
fn restored_defaults_apply_at_once_and_after_power_off() {
    for sub in [1, 4] {
        let mut node = healthy();
        set(&mut node, objects::PROFILE_VELOCITY, 77);
        set(&mut node, objects::STORE_ALL, objects::SAVE);
        write(&mut node, 0x1011, sub, objects::LOAD).unwrap();
        assert_eq!(get(&node, objects::PROFILE_VELOCITY), 1000);
        node.power_cycle();
        assert_eq!(get(&node, objects::PROFILE_VELOCITY), 1000, "CiA 301");
    }
}

#[test]
fn a_node_id_takes_effect_at_power_on() {
    let mut node = healthy();
    assert_eq!(write(&mut node, 0x2000, 0, 0), Err(AbortCode::RANGE));
    assert_eq!(write(&mut node, 0x2000, 0, 128), Err(AbortCode::RANGE));
    set(&mut node, objects::NODE_ID, 5);
    assert_eq!(node.node_id(), 1);
    node.power_cycle();
    assert_eq!(node.node_id(), 1, "not saved");
    set(&mut node, objects::NODE_ID, 5);
    set(&mut node, objects::STORE_ALL, objects::SAVE);
    node.power_cycle();
    assert_eq!(node.node_id(), 5);
    assert_eq!(
        raw(&node, 0x1800, 1),
        0x4000_0181,
        "identifiers do not follow"
    );
    write(&mut node, 0x1011, 5, objects::LOAD).unwrap();
    assert_eq!(raw(&node, 0x1800, 1), 0x4000_0185);
    assert_eq!(raw(&node, 0x1403, 1), 0x0000_0505);
    assert_eq!(raw(&node, 0x1801, 1), 0xC000_0285);
}

#[test]
fn a_communication_reset_leaves_other_objects_unchanged() {
    let mut node = healthy();
    set(&mut node, objects::PRODUCER_HEARTBEAT, 100);
    set(&mut node, objects::PROFILE_VELOCITY, 77);
    node.nmt(NmtCommand::Start);
    assert_eq!(node.nmt_state(), NmtState::Operational);
    node.nmt(NmtCommand::ResetCommunication);
    assert_eq!(node.nmt_state(), NmtState::PreOperational);
    assert_eq!(get(&node, objects::PRODUCER_HEARTBEAT), 0);
    assert_eq!(get(&node, objects::PROFILE_VELOCITY), 77);
}

#[test]
fn the_mapping_procedure_requires_its_order() {
    let mut node = healthy();
    // The mapping of an enabled PDO cannot be changed.
    assert_eq!(write(&mut node, 0x1A00, 0, 0), Err(AbortCode::STATE));
    write(&mut node, 0x1800, 1, 0xC000_0181).unwrap();
    // Entries cannot be changed while the mapping counts them.
    assert_eq!(
        write(&mut node, 0x1A00, 1, 0x6064_0020),
        Err(AbortCode::STATE)
    );
    write(&mut node, 0x1A00, 0, 0).unwrap();
    write(&mut node, 0x1A00, 1, 0x6064_0020).unwrap();
    write(&mut node, 0x1A00, 2, 0x1013_0020).unwrap();
    // A ninth byte.
    write(&mut node, 0x1A00, 3, 0x6061_0008).unwrap();
    assert_eq!(write(&mut node, 0x1A00, 0, 3), Err(AbortCode::PDO_LENGTH));
    assert_eq!(write(&mut node, 0x1A00, 0, 9), Err(AbortCode::TOO_HIGH));
    assert_eq!(
        write(&mut node, 0x1A00, 0, 4),
        Err(AbortCode::PDO_MAPPING),
        "the fourth entry is empty"
    );
    write(&mut node, 0x1A00, 0, 2).unwrap();
    write(&mut node, 0x1800, 2, 1).unwrap();
    write(&mut node, 0x1800, 1, 0x4000_0181).unwrap();
    assert_eq!(raw(&node, 0x1A00, 0), 2);
}

#[test]
fn unmappable_objects_are_refused() {
    let mut node = healthy();
    for (comm, map) in [(0x1800, 0x1A00), (0x1400, 0x1600)] {
        let id = raw(&node, comm, 1);
        write(&mut node, comm, 1, id | 0x8000_0000).unwrap();
        write(&mut node, map, 0, 0).unwrap();
    }
    for (index, entry, expected) in [
        (0x1A00, 0x6099_0120, Ok(())),
        (0x1A00, 0x2222_0010, Err(AbortCode::NO_OBJECT)),
        (0x1A00, 0x6041_0110, Err(AbortCode::NO_SUB)),
        (0x1A00, 0x1018_0120, Err(AbortCode::PDO_MAPPING)),
        (0x1A00, 0x6041_0008, Err(AbortCode::PDO_MAPPING)),
        (0x1A00, 0x20C1_0040, Err(AbortCode::PDO_MAPPING)),
        (0x1600, 0x20C1_0040, Ok(())),
        (0x1600, 0x6041_0010, Err(AbortCode::PDO_MAPPING)),
        (0x1600, 0x607A_0020, Ok(())),
        (0x1600, 0, Ok(())),
    ] {
        assert_eq!(
            write(&mut node, index, 1, entry),
            expected,
            "{index:04X} {entry:08X}"
        );
    }
}

#[test]
fn pdo_identifiers_are_validated() {
    let mut node = healthy();
    for (raw, expected) in [
        (0x4000_0182, Err(AbortCode::RANGE)), // another identifier while enabled
        (0x2000_0181, Err(AbortCode::RANGE)), // 29 bits
        (0x4000_1181, Err(AbortCode::RANGE)), // 12 bits
        (0x0000_0181, Ok(())),
        (0x8000_0000, Ok(())),
        (0x0000_0601, Err(AbortCode::RANGE)),
        (0x0000_0080, Err(AbortCode::RANGE)),
        (0x0000_0701, Err(AbortCode::RANGE)),
        (0x0000_0182, Ok(())),
    ] {
        assert_eq!(write(&mut node, 0x1800, 1, raw), expected, "{raw:08X}");
    }
    assert_eq!(write(&mut node, 0x1800, 2, 245), Err(AbortCode::RANGE));
}

#[test]
fn process_data_is_configurable_only_in_pre_operational() {
    let mut node = healthy();
    for command in [NmtCommand::Start, NmtCommand::Stop] {
        node.nmt(command);
        for (index, sub, raw) in [(0x1800, 1, 0xC000_0181), (0x1800, 2, 1), (0x1A00, 0, 0)] {
            assert_eq!(write(&mut node, index, sub, raw), Err(AbortCode::NMT_STATE));
        }
        assert_eq!(
            write(&mut node, 0x1011, 5, objects::LOAD),
            Err(AbortCode::NMT_STATE)
        );
        assert_eq!(write(&mut node, 0x1017, 0, 100), Ok(()));
    }
}

#[test]
fn entries_without_a_value_are_refused_with_a_reason() {
    let mut node = healthy();
    assert_eq!(
        node.read(Address::new(0x20C1, 0)),
        Err(AbortCode::WRITE_ONLY)
    );
    assert_eq!(write(&mut node, 0x20C1, 0, 0), Err(AbortCode::STATE));
    assert_eq!(node.read(Address::new(0x201B, 0)), Err(AbortCode::STATE));
    assert_eq!(write(&mut node, 0x2FFF, 1, 0), Err(AbortCode::SERVICE_MODE));
    assert_eq!(write(&mut node, 0x1008, 0, 0), Err(AbortCode::READ_ONLY));
    let bytes = |node: &mut SimulatedDrive, n| {
        node.write_bytes(objects::TARGET_POSITION.address, &[1, 2, 3, 4, 5][..n])
    };
    assert_eq!(bytes(&mut node, 3), Err(AbortCode::TOO_SHORT));
    assert_eq!(bytes(&mut node, 5), Err(AbortCode::TOO_LONG));
    assert_eq!(bytes(&mut node, 4), Ok(()));
    assert_eq!(get(&node, objects::TARGET_POSITION), 0x0403_0201);
}
