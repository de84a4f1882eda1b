//! Findings about a scan, for sinks that keep them.

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum DiagnosticLevel {
    /// No problem.
    Ok = 0,
    /// A limitation that users of the cloud have to know.
    Warn = 1,
    /// The cloud is not the requested one.
    Error = 2,
}

/// A finding about a scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Subject.
    pub name: String,
    /// Severity.
    pub level: DiagnosticLevel,
    /// Finding, in a sentence.
    pub message: String,
    /// Names and values of the finding, in order.
    pub values: Vec<(String, String)>,
}
