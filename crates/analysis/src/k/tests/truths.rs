//! Counts of the VLP-16 and of RMBLs known beforehand.

use super::patterns::vlp16;
use crate::k::{Edges, plain};

#[test]
fn a_frame_of_the_vlp16_has_its_counts() {
    let edges = Edges::equal(151).unwrap();
    let truths = [
        (901, [37_900, 138_021, 45_100]),
        (900, [37_800, 137_700, 45_000]),
    ];
    for (azimuths, truth) in truths {
        let counts = plain(&vlp16(azimuths), &edges).unwrap();
        let of = [counts.counts[0], counts.counts[1], counts.counts[150]];
        assert_eq!(of, truth, "{azimuths} azimuths");
        assert_eq!(counts.counts.iter().sum::<u64>(), counts.pairs());
        assert!(counts.is_well_posed());
    }
}
