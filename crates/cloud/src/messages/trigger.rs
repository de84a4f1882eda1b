//! `std_srvs/srv/Trigger`: a request without content, and a response with success or failure.

use super::cdr::Cdr;

/// Full name of the service, its definition (request, three dashes, response), and its type hash
/// over request, response and event.
pub const TRIGGER: super::MessageType = super::MessageType {
    name: "std_srvs/srv/Trigger",
    definition: "---\nbool success\nstring message\n",
    hash: "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
};

/// The response.
pub fn trigger_response(cdr: &mut Cdr, success: bool, message: &str) {
    cdr.clear();
    cdr.u8(success.into());
    cdr.string(message);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::cdr_reader::Reader;

    #[test]
    fn trigger_responses_round_trip() {
        let mut cdr = Cdr::new();
        trigger_response(&mut cdr, true, "scan-1");
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!((reader.u8(), reader.string()), (1, "scan-1".to_owned()));
        assert!(reader.is_done());
    }
}
