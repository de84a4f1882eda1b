//! Parameters that survive power-off: save (1010) and the three restore commands (1011).

use protocol::epos2::objects::{self, Address};

use super::AbortCode;
use super::config::SimulatedDriveConfig;
use super::dictionary::Dictionary;
use super::fixed::MAX_QC_PER_TURN;
use super::node::SimulatedDrive;

/// Restore of factory defaults, as 1011:1.
pub(super) const RESTORE_FACTORY: Address = Address::new(0x1011, 4);
/// Restore of the default PDO identifiers.
pub(super) const RESTORE_COB_IDS: Address = Address::new(0x1011, 5);

/// Process values, which are not saved.
const VOLATILE: [Address; 8] = [
    objects::TIMESTAMP.address,
    // Setting values of the current, position and velocity modes.
    Address::new(0x2030, 0),
    Address::new(0x2062, 0),
    Address::new(0x206B, 0),
    objects::OUTPUT_STATE.address,
    objects::CONTROLWORD.address,
    objects::TARGET_POSITION.address,
    objects::TARGET_VELOCITY.address,
];

/// Factory values, with the configured encoder.
pub(super) fn factory(config: &SimulatedDriveConfig) -> Dictionary {
    let mut dictionary = Dictionary::factory(config.node_id);
    let qc_per_turn = config.qc_per_turn.clamp(4, MAX_QC_PER_TURN);
    dictionary.set(objects::ENCODER_LINES.address, qc_per_turn / 4);
    dictionary
}

/// Checks the signature in a write to one of these objects.
pub(super) fn check_signature(address: Address, number: i64) -> Option<Result<(), AbortCode>> {
    const SAVES: Address = objects::STORE_ALL.address;
    const LOADS: [Address; 3] = [
        objects::RESTORE_ALL.address,
        RESTORE_FACTORY,
        RESTORE_COB_IDS,
    ];
    let signature = match address {
        SAVES => objects::SAVE,
        a if LOADS.contains(&a) => objects::LOAD,
        _ => return None,
    };
    Some(if number == i64::from(signature) {
        Ok(())
    } else {
        Err(AbortCode::STORE)
    })
}

impl SimulatedDrive {
    /// 1010:1.
    pub(super) fn save(&mut self) {
        self.saved = self.dictionary.clone();
        for address in VOLATILE {
            self.saved.reset(address, self.node_id());
        }
    }

    /// 1011:1 and 1011:4: restores factory values, saved ones too, at once. In CiA 301 they apply
    /// after the next reset; the maxon guides do not say when.
    pub(super) fn restore(&mut self) {
        self.dictionary = factory(&self.config);
        self.saved = self.dictionary.clone();
        self.mode = self.dictionary.get(objects::MODE);
        let lines = self.dictionary.get(objects::ENCODER_LINES);
        self.generator.qc_per_turn = lines.saturating_mul(4);
    }

    /// 1011:5: restores the identifiers of all PDOs from the predefined connection set for the
    /// present node id.
    pub(super) fn restore_cob_ids(&mut self) {
        let id = self.node_id();
        for index in (0x1400..0x1404).chain(0x1800..0x1804) {
            self.dictionary.reset(Address::new(index, 1), id);
        }
    }
}
