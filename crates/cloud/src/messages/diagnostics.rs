//! `diagnostic_msgs/DiagnosticArray`: the quality of a scan.

use super::cdr::Cdr;
use super::{Time, header};
use crate::Diagnostic;

/// Findings at `stamp` about the device `hardware`.
pub fn diagnostic_array(cdr: &mut Cdr, stamp: Time, hardware: &str, diagnostics: &[Diagnostic]) {
    cdr.clear();
    header(cdr, stamp, "");
    cdr.length(diagnostics.len());
    for diagnostic in diagnostics {
        cdr.u8(diagnostic.level as u8);
        cdr.string(&diagnostic.name);
        cdr.string(&diagnostic.message);
        cdr.string(hardware);
        cdr.length(diagnostic.values.len());
        for (key, value) in &diagnostic.values {
            cdr.string(key);
            cdr.string(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DiagnosticLevel;
    use crate::tests::cdr_reader::Reader;

    #[test]
    fn diagnostics_round_trip() {
        let check = |level, values| Diagnostic {
            name: "clock".into(),
            level,
            message: "steps".into(),
            values,
        };
        let diagnostics = [
            check(DiagnosticLevel::Warn, vec![("by".into(), "1 s".into())]),
            check(DiagnosticLevel::Ok, vec![]),
        ];
        let mut cdr = Cdr::new();
        diagnostic_array(
            &mut cdr,
            Time { sec: 1, nanosec: 2 },
            "VLP-16",
            &diagnostics,
        );
        let mut reader = Reader::new(cdr.bytes());
        assert_eq!(reader.header(), (1, 2, String::new()));
        assert_eq!(reader.u32(), 2);
        for (level, values) in [(1, 1), (0, 0)] {
            assert_eq!(reader.u8(), level);
            let texts = [reader.string(), reader.string(), reader.string()];
            assert_eq!(texts, ["clock", "steps", "VLP-16"]);
            assert_eq!(reader.u32(), values);
            for _ in 0..values {
                assert_eq!([reader.string(), reader.string()], ["by", "1 s"]);
            }
        }
        assert!(reader.is_done());
    }
}
